//! Numbers of rows, by which messages name them.

use std::collections::VecDeque;

/// Numbers of consecutive rows. Nearly all follow one another, so runs of them are kept.
#[derive(Debug, Default)]
pub(super) struct RowNumbers {
    /// How many rows a run has, and the number of its first one.
    runs: VecDeque<(usize, u64)>,
}

impl RowNumbers {
    /// Adds the number of the next row.
    #[inline]
    pub(super) fn push(&mut self, number: u64) {
        self.push_run(1, number);
    }

    /// Adds consecutive numbers.
    #[inline]
    pub(super) fn push_run(&mut self, count: usize, first: u64) {
        match self.runs.back_mut() {
            Some((rows, number)) if *number + *rows as u64 == first => *rows += count,
            _ => self.runs.push_back((count, first)),
        }
    }

    /// Adds those of later rows.
    pub(super) fn append(&mut self, later: &Self) {
        for &(rows, first) in &later.runs {
            self.push_run(rows, first);
        }
    }

    /// The number of a row, counted from 0.
    pub(super) fn of(&self, row: usize) -> u64 {
        let mut before = 0;
        for &(rows, first) in &self.runs {
            if row < before + rows {
                return first + (row - before) as u64;
            }
            before += rows;
        }
        unreachable!("each row has a number")
    }

    /// Leaves out the first rows.
    pub(super) fn skip(&mut self, mut count: usize) {
        while let Some((rows, first)) = self.runs.front_mut() {
            if *rows > count {
                *rows -= count;
                *first += count as u64;
                return;
            }
            count -= *rows;
            self.runs.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_has_its_number_whatever_was_left_out() {
        let numbers = [2, 3, 4, 7, 9, 10, 11, 15];
        let (mut all, mut later) = (RowNumbers::default(), RowNumbers::default());
        numbers[..5].iter().for_each(|&number| all.push(number));
        numbers[5..].iter().for_each(|&number| later.push(number));
        all.append(&later);
        for skipped in 0..numbers.len() {
            for (row, number) in numbers[skipped..].iter().enumerate() {
                assert_eq!(all.of(row), *number);
            }
            all.skip(1);
        }
        all.push(1);
        assert_eq!(all.of(0), 1);
    }
}
