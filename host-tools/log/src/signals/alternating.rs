//! Rows of two or three sources that take turns, such as those of two sensors in one file.
//!
//! Turns of 2, 3, 4, 6 or 12 rows all repeat after 12. So the rows are seen as 12 columns: within a
//! column a value differs by noise from the one before, between columns by the sources.

use super::Place;

/// All turns that are looked for repeat after so many rows.
const TURN: usize = 12;

/// Turns are judged window by window, each of so many rows. A tone that is coherent over all of a
/// window is within 1/240 of the sampling frequency of such a turn.
const WINDOW_ROWS: usize = 20 * TURN;

/// All of so many windows are judged, then every so many one.
const ALL_WINDOWS: usize = 64;
const SOME_WINDOWS: usize = 8;

/// The means of sources differ by more than so many standard deviations of single rows. Of one
/// source, the means of a window differ by 0.7 of them ...
const SIGMAS: f64 = 3.0;

/// ... and by more than so many of the smallest steps: whole pulses at an even rate make patterns
/// of one step, such as 3, 4, 3, 4.
const STEPS: f64 = 3.0;

/// Rows take turns if the windows do that make up this share of the log ...
const SHARE: f64 = 1.0 / 3.0;

/// ... and are so many at least.
const LEAST_WINDOWS: usize = 2;

/// Compares the rows of each turn.
#[derive(Clone, Debug)]
pub(super) struct Alternating {
    /// The temperature, then the axes.
    columns: Vec<Column>,
    rows: usize,
    /// Windows that were judged.
    judged: usize,
    /// Time of the first row of the window \[s\].
    from_s: f64,
}

/// A column as 12 columns, each with sums over the window.
#[derive(Clone, Debug)]
struct Column {
    /// The values one turn ago.
    before: [f64; TURN],
    /// Sums of the values, counted from `base`, the first of the window.
    sums: [f64; TURN],
    base: f64,
    /// Sums of the squared changes from turn to turn.
    squares: [f64; TURN],
    /// The smallest changes from turn to turn in the log so far.
    steps: [f64; TURN],
    found: Found,
}

/// Windows in which rows take turns.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    windows: usize,
    /// Times of the first row of the first, and of the last row of the last \[s\].
    from_s: f64,
    to_s: f64,
    /// Of the window in which the sources differ most: by how much they do, the standard deviation
    /// of a row, and the rows after which the pattern repeats.
    differ_by: f64,
    sigma: f64,
    turn: usize,
}

impl Column {
    fn new() -> Self {
        Self {
            before: [0.0; TURN],
            sums: [0.0; TURN],
            base: 0.0,
            squares: [0.0; TURN],
            steps: [f64::INFINITY; TURN],
            found: Found::default(),
        }
    }

    /// Some rows of a window, the first at a place.
    #[inline]
    fn rows(&mut self, place: usize, is_first_turn: bool, values: impl Iterator<Item = f64>) {
        let numbered = (place..).zip(values);
        match is_first_turn {
            true => numbered.for_each(|(place, value)| self.begin(place, value)),
            false => numbered.for_each(|(place, value)| self.row(place % TURN, value)),
        }
    }

    /// A row of the window's first turn.
    fn begin(&mut self, place: usize, value: f64) {
        if place == 0 {
            (self.sums, self.squares, self.base) = ([0.0; TURN], [0.0; TURN], value);
        }
        self.before[place] = value;
        self.sums[place] = value - self.base;
    }

    #[inline]
    fn row(&mut self, place: usize, value: f64) {
        let change = value - self.before[place];
        self.before[place] = value;
        self.sums[place] += value - self.base;
        self.squares[place] += change * change;
        let size = match change == 0.0 {
            true => f64::INFINITY,
            false => change.abs(),
        };
        self.steps[place] = self.steps[place].min(size);
    }

    /// Judges the window.
    fn end_window(&mut self, from_s: f64, to_s: f64) {
        let means = self
            .sums
            .map(|sum| sum * (TURN as f64 / WINDOW_ROWS as f64));
        let squares: f64 = self.squares.iter().sum();
        let sigma = (squares / (2 * (WINDOW_ROWS - TURN)) as f64).sqrt();
        let step = self.steps.iter().copied().fold(f64::INFINITY, f64::min);
        let differ_by = range(means.into_iter());
        // Of values that all repeat, no step is known.
        if differ_by > SIGMAS * sigma && differ_by > STEPS * step {
            let found = &mut self.found;
            if found.windows == 0 {
                found.from_s = from_s;
            }
            found.windows += 1;
            found.to_s = to_s;
            if differ_by > found.differ_by {
                let repeats = |&turn: &usize| {
                    let of_place = |place| means.into_iter().skip(place).step_by(turn);
                    (0..turn).all(|place| range(of_place(place)) < 0.3 * differ_by)
                };
                found.turn = [2, 3, 4, 6].into_iter().find(repeats).unwrap_or(TURN);
                (found.differ_by, found.sigma) = (differ_by, sigma);
            }
        }
    }
}

/// Greatest less smallest value.
fn range(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let highest = values.clone().fold(f64::NEG_INFINITY, f64::max);
    highest - values.fold(f64::INFINITY, f64::min)
}

impl Alternating {
    pub(super) fn new(axes: usize) -> Self {
        Self {
            columns: vec![Column::new(); 1 + axes],
            rows: 0,
            judged: 0,
            from_s: 0.0,
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        let mut start = 0;
        while start < time_s.len() {
            // Up to the end of the window's first turn, of the window, or of the chunk.
            let place = self.rows % WINDOW_ROWS;
            let is_first_turn = place < TURN;
            let wanted = if is_first_turn { TURN } else { WINDOW_ROWS };
            let end = time_s.len().min(start + wanted - place);
            let window = self.rows / WINDOW_ROWS;
            let is_judged = window < ALL_WINDOWS || window.is_multiple_of(SOME_WINDOWS);
            self.rows += end - start;
            if is_judged {
                if place == 0 {
                    self.from_s = time_s[start];
                }
                let (temperature, others) = self.columns.split_first_mut().expect("a temperature");
                let temps_c = temp_c[start..end].iter().map(|&temp_c| f64::from(temp_c));
                temperature.rows(place, is_first_turn, temps_c);
                for (column, values) in others.iter_mut().zip(axes) {
                    column.rows(place, is_first_turn, values[start..end].iter().copied());
                }
                if self.rows.is_multiple_of(WINDOW_ROWS) {
                    self.judged += 1;
                    for column in &mut self.columns {
                        column.end_window(self.from_s, time_s[end - 1]);
                    }
                }
            }
            start = end;
        }
    }

    /// The temperature if its rows take turns, otherwise the axis with the most such windows.
    pub(super) fn finish(self) -> Vec<Place> {
        let least = (SHARE * self.judged as f64).max(LEAST_WINDOWS as f64);
        let takes_turns = |column: &&Column| column.found.windows as f64 >= least;
        let columns = self.columns.iter().filter(takes_turns).count();
        let numbered = self.columns.iter().enumerate();
        let most = numbered
            .filter(|(_, column)| takes_turns(column))
            .max_by_key(|&(number, column)| (number == 0, column.found.windows));
        let place = |(number, column): (usize, &Column)| {
            let found = column.found;
            let others = match columns {
                1 => "no other column does".to_owned(),
                columns => format!("{columns} columns do"),
            };
            Place {
                axis: number.checked_sub(1),
                rows: self.rows * found.windows / self.judged,
                from_s: found.from_s,
                to_s: found.to_s,
                detail: format!(
                    "every {} rows repeat, {:.4} apart with a noise of {:.4}; {others}",
                    found.turn, found.differ_by, found.sigma
                ),
            }
        };
        most.into_iter().map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::signals::made::{Made, Noise, rounded, up_and_down};

    fn found(log: &Made) -> Vec<Place> {
        let mut detector = Alternating::new(log.axes.len());
        log.parts(|time_s, temp_c, axes| detector.take(time_s, temp_c, axes));
        detector.finish()
    }

    /// Three axes with noise of 0.05 and a bias of the temperature; what each row has more.
    fn log(
        seed: u64,
        step_c: f64,
        sigma: f64,
        more_c: impl Fn(usize) -> f64,
        more: impl Fn(usize, usize) -> f64,
    ) -> Made {
        let mut noise = Noise::new(seed);
        let mut row = 0;
        let mut log = Made::new(7000, 0.5, |share| {
            row += 1;
            let temp_c = up_and_down(share, -10.0, 50.0) + 0.02 * noise.next();
            rounded(temp_c + more_c(row - 1), step_c)
        });
        for axis in 0..3 {
            let slope = [0.012, -0.008, 0.005][axis];
            log = log.with_axis(|row, temp_c| {
                slope * (temp_c - 25.0) + sigma * noise.next() + more(axis, row)
            });
        }
        log
    }

    proptest! {
        #[test]
        fn sources_that_take_turns_are_found(
            seed in 0_u64..1000,
            (sources, rows_each) in prop::sample::select(
                vec![(2, 1), (3, 1), (2, 2), (3, 2), (2, 3), (3, 4), (2, 6)]
            ),
            step_c in prop::sample::select(vec![0.0, 0.0625, 0.5]),
            size_c in prop::sample::select(vec![-8.0, 0.0, 5.0]),
            size in 0.35..100.0_f64,
            axis in 0_usize..3,
            lost in 200_usize..3000,
        ) {
            let source = |row: usize| (row / rows_each % sources) as f64;
            let mut log = log(seed, step_c, 0.05, |row| size_c * source(row), |which, row| {
                if which == axis { size * source(row) } else { 0.0 }
            });
            // A row that is lost changes the turns.
            log.time_s.remove(lost);
            log.temp_c.remove(lost);
            for axis in &mut log.axes {
                axis.remove(lost);
            }
            let found = found(&log);
            prop_assert_eq!(found.len(), 1);
            prop_assert_eq!(found[0].axis, (size_c == 0.0).then_some(axis));
            prop_assert!(found[0].rows >= 6000, "{:?}", found);
            let turn = format!("every {} rows repeat", sources * rows_each);
            prop_assert!(found[0].detail.starts_with(&turn), "{:?}", found);
        }

        #[test]
        fn one_source_is_silent(
            seed in 0_u64..1000,
            step_c in prop::sample::select(vec![0.0, 0.0625, 0.5, 1.0]),
            sigma in prop::sample::select(vec![0.0, 0.001, 0.05]),
            step in prop::sample::select(vec![0.0, 0.01, 0.2]),
            spikes in 13_usize..2000,
        ) {
            let mut log = log(seed, step_c, sigma, |_| 0.0, |_, row| {
                if row % spikes == 0 { 80.0 } else { 0.0 }
            });
            for value in log.axes.iter_mut().flatten() {
                *value = rounded(*value, step);
            }
            prop_assert_eq!(found(&log), []);
        }

        #[test]
        fn whole_pulses_and_tones_are_silent(
            rate in 0.0..9.0_f64,
            slope in prop::sample::select(vec![0.0, 1e-6, 1e-4]),
            amplitude in 0.0..3.0_f64,
            frequency in 0.0..0.5_f64,
            near in prop::sample::select(vec![1.0, 2.0, 3.0, 4.0, 6.0, 12.0]),
        ) {
            let mut noise = Noise::new(1);
            let turns = |row: usize, frequency: f64| std::f64::consts::TAU * frequency * row as f64;
            let angle = |row: usize| rate * row as f64 + slope * (row * row) as f64;
            let log = Made::new(7000, 0.5, |_| 25.0)
                .with_axis(|row, _| angle(row + 1).floor() - angle(row).floor())
                .with_axis(|row, _| amplitude * turns(row, frequency).sin() + 0.2 * noise.next())
                .with_axis(|row, _| amplitude * turns(row, 1.0 / near + 0.004).sin());
            let found = found(&log);
            // Only a tone at a turn itself, within the width of a window, is like sources.
            let is_near = (1..=6).any(|n| (frequency - f64::from(n) / 12.0).abs() < 0.004);
            prop_assert!(found.is_empty() || (is_near && found[0].axis == Some(1)), "{:?}", found);
        }
    }

    #[test]
    fn the_second_source_may_come_later_or_agree_at_times() {
        let turns = |row: usize| (row % 2) as f64;
        let late = log(
            1,
            0.0,
            0.05,
            |_| 0.0,
            |_, row| {
                if row > 3500 { turns(row) } else { 0.0 }
            },
        );
        let crossing = log(
            1,
            0.0,
            0.05,
            |_| 0.0,
            |_, row| turns(row) * (row as f64 / 3500.0 - 1.0),
        );
        for log in [late, crossing] {
            assert_eq!(found(&log).len(), 1);
        }
    }
}
