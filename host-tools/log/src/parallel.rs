//! Work on all cores. Where there is one, or no threads, it is done in turn.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

use super::LogError;

/// The cores of this machine; one in a browser, which gives a program no threads.
fn cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// How much is read at a time, and by how many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    /// Bytes of text.
    pub(super) block_bytes: usize,
    /// Rows of a table.
    pub(super) table_rows: usize,
    pub(super) cores: usize,
}

impl Parts {
    /// A block of text is small enough for the cache of a core, and large enough to make handing over
    /// cheap.
    pub(super) fn usual() -> Self {
        Self {
            block_bytes: 1 << 18,
            table_rows: 1 << 13,
            cores: cores(),
        }
    }
}

/// Applies `work` to every item, on as many threads as there are cores; the results are in the
/// order of the items.
///
/// # Panics
/// If `work` does.
pub fn map<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = cores().min(items.len());
    if threads < 2 {
        return items.iter().map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::with_capacity(items.len()));
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(number) else { break };
                    let result = work(item);
                    let mut done = done.lock().expect("another thread panicked");
                    done.push((number, result));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("a thread panicked");
    done.sort_by_key(|&(number, _)| number);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Work whose result is wanted later: it begins at once if there is a core for it.
///
/// # Panics
/// If `work` does.
pub(crate) fn later<R: Send + 'static>(
    cores: usize,
    work: impl FnOnce() -> R + Send + 'static,
) -> Box<dyn FnOnce() -> R + Send> {
    if cores < 2 {
        return Box::new(work);
    }
    let thread = thread::spawn(work);
    Box::new(|| thread.join().expect("the work panicked"))
}

/// A part of a file, or the hash of the file at its end.
pub(crate) type Part<T> = Result<Result<T, String>, LogError>;

/// The parts of a file, made ahead if there is a core for it.
pub(crate) enum Ahead<T> {
    OnThread(Receiver<Part<T>>),
    InTurn(Box<dyn FnMut() -> Part<T> + Send>),
}

impl<T: Send + 'static> Ahead<T> {
    /// At most `depth` parts wait.
    pub(crate) fn new(
        cores: usize,
        depth: usize,
        mut next: impl FnMut() -> Part<T> + Send + 'static,
    ) -> Self {
        if cores < 2 {
            return Self::InTurn(Box::new(next));
        }
        let (parts_in, parts) = sync_channel(depth);
        thread::spawn(move || {
            loop {
                let part = next();
                let is_last = !matches!(part, Ok(Ok(_)));
                // Nobody waits any more if a row before was refused.
                if parts_in.send(part).is_err() || is_last {
                    break;
                }
            }
        });
        Self::OnThread(parts)
    }

    /// The next part; none may be asked for after the hash or an error.
    pub(crate) fn next(&mut self) -> Part<T> {
        match self {
            Self::OnThread(parts) => parts.recv().expect("nothing comes after the last part"),
            Self::InTurn(next) => next(),
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<u32> = (0..100).collect();
        let squares: Vec<u32> = items.iter().map(|n| n * n).collect();
        assert_eq!(super::map(&items, |n| n * n), squares);
        assert!(super::map(&[(); 0], |()| ()).is_empty());
    }
}
