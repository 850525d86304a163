//! Rows of two or three sources that take turns, such as those of two sensors in one file.
//!
//! Turns of 2, 3, 4, 6 or 12 rows all repeat after 12. So the rows are seen as 12 columns: within a
//! column a value differs by noise from the one before, between columns by the sources.

use super::windows::{Judged, Windows};

/// All turns that are looked for repeat after so many rows.
const TURN: usize = 12;

/// Turns are judged window by window, each of so many rows. A tone that is coherent over all of a
/// window is within 1/240 of the sampling frequency of such a turn.
const WINDOW_ROWS: usize = 20 * TURN;

/// The means of sources differ by more than so many standard deviations of single rows. Of one
/// source, the means of a window differ by 0.7 of them ...
const SIGMAS: f64 = 3.0;

/// ... and by more than so many of the smallest steps: whole pulses at an even rate make patterns
/// of one step, such as 3, 4, 3, 4.
const STEPS: f64 = 3.0;

/// Compares the rows of each turn.
pub(super) type Alternating = Windows<Turns>;

/// A column as 12 columns, each with sums over the window.
#[derive(Clone, Debug)]
pub(super) struct Turns {
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

/// The window in which the sources differ most.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    differ_by: f64,
    /// Standard deviation of a row.
    sigma: f64,
    /// Rows after which the pattern repeats.
    turn: usize,
}

impl Default for Turns {
    fn default() -> Self {
        Self {
            before: [0.0; TURN],
            sums: [0.0; TURN],
            base: 0.0,
            squares: [0.0; TURN],
            steps: [f64::INFINITY; TURN],
            found: Found::default(),
        }
    }
}

impl Turns {
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
}

impl Judged for Turns {
    const ROWS: usize = WINDOW_ROWS;
    const ALL: usize = 64;
    const SOME: usize = 8;

    #[inline]
    fn rows(&mut self, place: usize, mut values: impl Iterator<Item = f64>) {
        for (place, value) in (place..TURN).zip(values.by_ref()) {
            self.begin(place, value);
        }
        let numbered = (place.max(TURN)..).zip(values);
        numbered.for_each(|(place, value)| self.row(place % TURN, value));
    }

    fn end_window(&mut self) -> bool {
        let means = self
            .sums
            .map(|sum| sum * (TURN as f64 / WINDOW_ROWS as f64));
        let squares: f64 = self.squares.iter().sum();
        let sigma = (squares / (2 * (WINDOW_ROWS - TURN)) as f64).sqrt();
        let step = self.steps.iter().copied().fold(f64::INFINITY, f64::min);
        let differ_by = range(means.into_iter());
        // Of values that all repeat, no step is known.
        let takes_turns = differ_by > SIGMAS * sigma && differ_by > STEPS * step;
        if takes_turns && differ_by > self.found.differ_by {
            let repeats = |&turn: &usize| {
                let of_place = |place| means.into_iter().skip(place).step_by(turn);
                (0..turn).all(|place| range(of_place(place)) < 0.3 * differ_by)
            };
            let turn = [2, 3, 4, 6].into_iter().find(repeats).unwrap_or(TURN);
            self.found = Found {
                differ_by,
                sigma,
                turn,
            };
        }
        takes_turns
    }

    fn detail(&self, columns: usize) -> String {
        let found = self.found;
        let others = match columns {
            1 => "no other column does".to_owned(),
            columns => format!("{columns} columns do"),
        };
        format!(
            "every {} rows repeat, {:.4} apart with a noise of {:.4}; {others}",
            found.turn, found.differ_by, found.sigma
        )
    }
}

/// Greatest less smallest value.
fn range(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let highest = values.clone().fold(f64::NEG_INFINITY, f64::max);
    highest - values.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::signals::Place;
    use crate::signals::made::{Made, Noise, rounded, three_axes};

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
        three_axes(seed, 7000, (step_c, sigma), |axis, row| match axis {
            None => more_c(row),
            Some(axis) => more(axis, row),
        })
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
