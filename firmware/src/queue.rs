//! Queues from one writer to one reader, such as an interrupt and the main loop, which cannot panic.
//!
//! They are those of `heapless`. Its ends keep the length of the queue in memory, and the remainder
//! by it could be one by zero, as far as the compiler knows. Here the length is part of the type. The
//! ends compare it first, so that the compiler sees it: a mask takes the place of a division and its
//! check.

use heapless::spsc;

/// A queue for `N - 1` items.
pub struct Queue<T, const N: usize>(spsc::Queue<T, N>);

/// The writer's end.
pub struct Producer<'q, T, const N: usize>(spsc::Producer<'q, T>);

/// The reader's end.
pub struct Consumer<'q, T, const N: usize>(spsc::Consumer<'q, T>);

impl<T, const N: usize> Queue<T, N> {
    /// An empty queue.
    pub const fn new() -> Self {
        Self(spsc::Queue::new())
    }

    /// The two ends.
    pub fn split(&mut self) -> (Producer<'_, T, N>, Consumer<'_, T, N>) {
        let (producer, consumer) = self.0.split();
        (Producer(producer), Consumer(consumer))
    }
}

impl<T, const N: usize> Default for Queue<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T, const N: usize> Producer<'_, T, N> {
    /// Adds an item.
    ///
    /// # Errors
    /// The queue is full: the item comes back.
    #[inline]
    pub fn enqueue(&mut self, item: T) -> Result<(), T> {
        if self.0.capacity() != N - 1 {
            return Err(item);
        }
        self.0.enqueue(item)
    }
}

impl<T, const N: usize> Consumer<'_, T, N> {
    /// Takes the oldest item.
    #[inline]
    pub fn dequeue(&mut self) -> Option<T> {
        if self.0.capacity() != N - 1 {
            return None;
        }
        self.0.dequeue()
    }

    /// Whether there is an item.
    pub fn ready(&self) -> bool {
        self.0.ready()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_come_in_order_and_come_back_where_the_queue_is_full() {
        let mut queue = Queue::<u32, 4>::new();
        let (mut producer, mut consumer) = queue.split();
        assert!(!consumer.ready());
        for round in 0..9 {
            for item in 0..3 {
                assert_eq!(producer.enqueue(10 * round + item), Ok(()));
            }
            assert_eq!(producer.enqueue(99), Err(99));
            assert!(consumer.ready());
            for item in 0..3 {
                assert_eq!(consumer.dequeue(), Some(10 * round + item));
            }
            assert_eq!(consumer.dequeue(), None);
        }
    }
}
