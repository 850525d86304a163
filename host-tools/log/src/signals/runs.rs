//! Runs of bit-identical values of one column, and which of them are too long to be chance.

use std::ops::RangeBounds;

/// Shorter runs are counted, but not kept.
const LEAST_ROWS: usize = 8;

/// Rows that are compared at once.
const BLOCK: usize = 64;

/// Of such rows so many are looked at closely, if all differ.
const LOOKED_AT: usize = 8;

/// Lengths are kept by powers of two up to this one.
const LENGTHS: usize = 48;

/// Share of the changes that are wider than one step, from which the column has noise of its own:
/// normal noise of four tenths of a step or more.
const NOISY: f64 = 0.05;

/// Chance makes runs of a length in one of `exp(12)` logs; longer than twice this is no chance.
const SURELY: f64 = 12.0;

/// A column is constant if one run is this share of its rows.
const CONSTANT: f64 = 0.99;

/// Runs are worth a finding from this share of the rows ...
const LEAST_SHARE: f64 = 0.02;

/// ... or if one is this long \[s\].
const LEAST_S: f64 = 60.0;

/// Some rows with the same value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) value: f64,
    pub(super) rows: usize,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// Temperatures at its ends, and at some rows between \[degC\].
    temps_c: (f32, f32),
}

/// Runs that stand out of the rest of their column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standing {
    /// Rows of all of them.
    pub(super) rows: usize,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    pub(super) longest: Run,
}

/// All runs of a column.
#[derive(Clone, Debug)]
pub(super) struct Runs {
    rows: usize,
    runs: usize,
    /// Changes that were looked at, and those that turn round without a return to the value
    /// before.
    changes: usize,
    wide: usize,
    /// The value of the last row, and the one before it that differs.
    value: f64,
    before: f64,
    present: Run,
    longest: Run,
    lengths: [OfLength; LENGTHS],
}

/// All runs whose length has the same power of two.
#[derive(Clone, Copy, Debug)]
struct OfLength {
    runs: usize,
    rows: usize,
    from_s: f64,
    to_s: f64,
}

impl Runs {
    pub(super) fn new() -> Self {
        let none = Run {
            value: f64::NAN,
            rows: 0,
            from_s: 0.0,
            to_s: 0.0,
            temps_c: (0.0, 0.0),
        };
        let of_length = OfLength {
            runs: 0,
            rows: 0,
            from_s: f64::INFINITY,
            to_s: f64::NEG_INFINITY,
        };
        Self {
            rows: 0,
            runs: 0,
            changes: 0,
            wide: 0,
            value: f64::NAN,
            before: f64::NAN,
            present: none,
            longest: none,
            lengths: [of_length; LENGTHS],
        }
    }

    /// Takes in the next rows.
    ///
    /// Most rows of most columns differ from the one before. Blocks of such rows are seen by one
    /// comparison each, without a branch. In others the changes are found first, without a branch,
    /// and counted then.
    pub(super) fn take<V: Copy + PartialEq + Into<f64>>(
        &mut self,
        time_s: &[f64],
        temp_c: &[f32],
        values: &[V],
    ) {
        let Some(last) = values.len().checked_sub(1) else {
            return;
        };
        // Where the present run starts, if that is in these rows; rows of it before them.
        let (mut start, earlier) = (None, self.present.rows);
        for (number, block) in values.chunks(BLOCK).enumerate() {
            let first = number * BLOCK;
            let differs = block[0].into() != self.value && are_all_different(block);
            // A part of the rows says as much of the noise.
            let mut changes = match differs {
                true => (2 << LOOKED_AT.min(block.len() - 1)) - 1,
                false => changes(block, self.value),
            };
            while changes != 0 {
                let row = first + changes.trailing_zeros() as usize;
                changes &= changes - 1;
                let next: f64 = values[row].into();
                let rows = start.map_or(earlier + row, |start| row - start);
                if rows >= LEAST_ROWS {
                    self.extend(start, row, (time_s, temp_c));
                    self.close();
                }
                let turns = (next > self.value) != (self.value > self.before);
                self.wide += usize::from(turns & (next != self.before));
                self.changes += 1;
                self.runs += 1;
                (self.before, self.value) = (self.value, next);
                start = Some(row);
            }
            if differs && block.len() > LOOKED_AT + 1 {
                let end = block.len() - 1;
                self.runs += end - LOOKED_AT;
                (self.before, self.value) = (block[end - 1].into(), block[end].into());
                start = Some(first + end);
            }
        }
        self.extend(start, last + 1, (time_s, temp_c));
        self.rows += values.len();
    }

    /// Brings the present run up to `end`; it starts at `start` of these rows, or before them.
    fn extend(&mut self, start: Option<usize>, end: usize, (time_s, temp_c): (&[f64], &[f32])) {
        if let Some(start) = start {
            self.present = Run {
                value: self.value,
                rows: 0,
                from_s: time_s[start],
                to_s: time_s[start],
                temps_c: (temp_c[start], temp_c[start]),
            };
        }
        let run = &mut self.present;
        if let Some(last) = end.checked_sub(1) {
            run.rows += end - start.unwrap_or(0);
            run.to_s = time_s[last];
            run.temps_c.0 = run.temps_c.0.min(temp_c[last]);
            run.temps_c.1 = run.temps_c.1.max(temp_c[last]);
        }
    }

    /// Counts the present run.
    fn close(&mut self) {
        let run = self.present;
        if run.rows > self.longest.rows {
            self.longest = run;
        }
        if run.rows >= LEAST_ROWS {
            let of_length = &mut self.lengths[(run.rows.ilog2() as usize).min(LENGTHS - 1)];
            of_length.runs += 1;
            of_length.rows += run.rows;
            of_length.from_s = of_length.from_s.min(run.from_s);
            of_length.to_s = of_length.to_s.max(run.to_s);
        }
    }

    /// Counts the last run too.
    pub(super) fn finish(&mut self) {
        self.close();
    }

    /// The longest run.
    pub(super) const fn longest(&self) -> &Run {
        &self.longest
    }

    /// Whether the column has noise that is wider than its steps.
    pub(super) fn is_noisy(&self) -> bool {
        self.wide >= LEAST_ROWS && self.wide as f64 >= NOISY * self.changes as f64
    }

    /// Whether the column is one value, with a few exceptions at most.
    pub(super) fn is_constant(&self) -> bool {
        self.longest.rows as f64 >= CONSTANT * self.rows as f64 && self.rows >= 2 * LEAST_ROWS
    }

    /// Runs that the noise of the column cannot explain. None if it has no noise of its own.
    pub(super) fn without_noise(&self) -> Option<Standing> {
        self.is_noisy().then(|| self.standing(1.0))?
    }

    /// Runs that are far longer than all others and that last while the temperature moves through a
    /// quarter of the log's range or more; for columns without noise of their own.
    pub(super) fn while_temperature_moves(&self, log_c: (f32, f32)) -> Option<Standing> {
        let standing = self.standing(8.0)?;
        let (low, high) = standing.longest.temps_c;
        let is_moving = high - low >= 0.25 * (log_c.1 - log_c.0);
        let usual_rows = self.rows - standing.rows;
        (is_moving && usual_rows >= self.rows / 4).then_some(standing)
    }

    /// The runs that are `factor` times longer than chance makes them, and well apart from others.
    fn standing(&self, factor: f64) -> Option<Standing> {
        // The longer the runs that count as usual, the longer are those that chance can make.
        let mut length = 4;
        loop {
            let next = self.beyond_chance(length, factor)?.max(length);
            if next == length {
                break;
            }
            length = next;
        }
        let standing = self.sum(length..)?;
        // A column that is at times quiet and at times not has runs of all lengths.
        let almost = self.sum(length.saturating_sub(2)..length);
        let is_apart = almost.is_none_or(|of| (of.rows as f64) < 0.1 * standing.rows as f64);
        let is_long = standing.rows as f64 >= LEAST_SHARE * self.rows as f64
            || self.longest.to_s - self.longest.from_s >= LEAST_S;
        (is_apart && is_long).then_some(Standing {
            rows: standing.rows,
            from_s: standing.from_s,
            to_s: standing.to_s,
            longest: self.longest,
        })
    }

    /// The power of two from which on runs are no chance, if those below `length` are usual. None
    /// if the usual rows never change.
    fn beyond_chance(&self, length: usize, factor: f64) -> Option<usize> {
        let (long_rows, long_runs) = self.sum(length..).map_or((0, 0), |of| (of.rows, of.runs));
        let usual_rows = (self.rows - long_rows) as f64;
        let same = 1.0 - (self.runs - long_runs) as f64 / usual_rows;
        // `same` is a mean over how the noise lies to the steps; its root is about the highest.
        let decay = -0.5 * same.clamp(1e-3, 1.0).ln();
        let rows = 2.0 * factor * ((self.rows as f64).ln() + SURELY) / decay;
        rows.is_finite().then(|| rows.log2().ceil() as usize)
    }

    /// All runs of some powers of two; none if there are none.
    fn sum(&self, lengths: impl RangeBounds<usize>) -> Option<OfLength> {
        let of_lengths = self.lengths.iter().enumerate();
        let of_lengths = of_lengths.filter(|(length, of)| lengths.contains(length) && of.runs > 0);
        of_lengths.map(|(_, of)| *of).reduce(|a, b| OfLength {
            runs: a.runs + b.runs,
            rows: a.rows + b.rows,
            from_s: a.from_s.min(b.from_s),
            to_s: a.to_s.max(b.to_s),
        })
    }
}

/// A bit for each row that differs from the one before it; `before` stands before the first.
fn changes<V: Copy + PartialEq + Into<f64>>(block: &[V], before: f64) -> u64 {
    let first = u64::from(block[0].into() != before);
    let others = (1..).zip(block.windows(2));
    others.fold(first, |bits, (row, pair)| {
        bits | u64::from(pair[0] != pair[1]) << row
    })
}

fn are_all_different<V: Copy + PartialEq>(values: &[V]) -> bool {
    let pairs = values.iter().zip(&values[1..]);
    pairs.map(|(a, b)| usize::from(a == b)).sum::<usize>() == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::made::Noise;

    fn is_noisy(in_steps: f64, seed: u64) -> bool {
        let mut noise = Noise::new(seed);
        let value = |row: u32| (0.002 * f64::from(row) + in_steps * noise.next()).round();
        let values: Vec<f64> = (0..20_000).map(value).collect();
        let time_s: Vec<f64> = (0..20_000).map(f64::from).collect();
        let mut runs = Runs::new();
        runs.take(&time_s, &vec![20.0; values.len()], &values);
        runs.finish();
        runs.is_noisy()
    }

    #[test]
    fn noise_from_four_tenths_of_a_step_is_seen() {
        for seed in 1..=20 {
            for in_steps in [0.4, 0.5, 1.0, 4.0] {
                assert!(is_noisy(in_steps, seed), "{in_steps}");
            }
            for in_steps in [0.0, 0.1, 0.2, 0.3] {
                assert!(!is_noisy(in_steps, seed), "{in_steps}");
            }
        }
    }
}
