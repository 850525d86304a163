//! Rows of two sources that come in packets, such as those of two sensors with a FIFO each.
//!
//! Between packets a value jumps, from one level to the other and back. Within them it has noise.
//! Rows of two sources that take turns row by row are in `alternating`.

use super::windows::{Judged, Windows};
use crate::median::median;

/// A jump is this many times the median change from row to row, and the smallest change.
const JUMP: f64 = 8.0;

/// A window needs so many jumps.
const LEAST_JUMPS: usize = 4;

/// Jumps are of one size if they scatter by less than this share of it.
const SCATTER: f64 = 0.3;

/// Either level holds this share of the rows at least: spikes return at once.
const LEAST_HOLD: f64 = 0.2;

/// Looks for jumps between two levels.
pub(super) type Packets = Windows<Levels>;

/// A column that may jump.
#[derive(Clone, Debug, Default)]
pub(super) struct Levels {
    /// Values of the window.
    values: Vec<f64>,
    /// Of the first window with packets: the size of the jumps, and the mean rows of a packet.
    found: Option<(f64, f64)>,
}

impl Judged for Levels {
    const ROWS: usize = 256;
    const ALL: usize = 16;
    const SOME: usize = 32;

    fn rows(&mut self, _place: usize, values: impl Iterator<Item = f64>) {
        self.values.extend(values);
    }

    fn end_window(&mut self) -> bool {
        let packets = packets(&self.values);
        self.values.clear();
        self.found = self.found.or(packets);
        packets.is_some()
    }

    fn detail(&self, _columns: usize) -> String {
        let (size, rows) = self.found.unwrap_or_default();
        format!("packets of {rows:.0} rows are {size:.4} apart")
    }
}

/// Whether a column jumps between two levels: the size of the jumps, and the mean rows between.
fn packets(values: &[f64]) -> Option<(f64, f64)> {
    let changes: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sizes: Vec<f64> = changes.iter().map(|change| change.abs()).collect();
    let steps = sizes.iter().filter(|size| **size > 0.0);
    let step = steps.fold(f64::INFINITY, |least, &size| least.min(size));
    let limit = JUMP * median(&mut sizes).max(step);
    // Where a value jumps, and by how much.
    let numbered = changes.iter().enumerate();
    let jumps: Vec<(usize, f64)> = numbered
        .filter(|(_, change)| change.abs() > limit)
        .map(|(row, change)| (row, *change))
        .collect();
    let (Some(first), Some(last)) = (jumps.first(), jumps.last()) else {
        return None;
    };
    if jumps.len() < LEAST_JUMPS || jumps.windows(2).any(|pair| pair[0].1 * pair[1].1 > 0.0) {
        return None;
    }
    let count = jumps.len() as f64;
    let size = jumps.iter().map(|(_, jump)| jump.abs()).sum::<f64>() / count;
    let squares: f64 = jumps
        .iter()
        .map(|(_, jump)| (jump.abs() - size).powi(2))
        .sum();
    // Rows on the level to which the first jump leads.
    let mut held = [0.0; 2];
    for (number, pair) in jumps.windows(2).enumerate() {
        held[number % 2] += (pair[1].0 - pair[0].0) as f64;
    }
    let rows = (last.0 - first.0) as f64;
    let is_one_size = (squares / count).sqrt() < SCATTER * size;
    (is_one_size && held[0].min(held[1]) >= LEAST_HOLD * rows).then(|| (size, rows / (count - 1.0)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::signals::Place;
    use crate::signals::made::{Made, rounded, three_axes};

    fn found(log: &Made) -> Vec<Place> {
        let mut detector = Packets::new(log.axes.len());
        log.parts(|time_s, temp_c, axes| detector.take(time_s, temp_c, axes));
        detector.finish()
    }

    proptest! {
        #[test]
        fn packets_of_two_sources_are_found(
            seed in 0_u64..1000,
            rows in 4_usize..40,
            size in 1.0..100.0_f64,
            column in 0_usize..4,
            other in 0.7..1.4_f64,
        ) {
            // The packets of the second source may be longer or shorter.
            let period = rows + (rows as f64 * other) as usize;
            let log = three_axes(seed, 9000, (0.0, 0.05), |axis, row| {
                if axis.unwrap_or(3) == column && row % period < rows { size } else { 0.0 }
            });
            let found = found(&log);
            prop_assert_eq!(found.len(), 1);
            prop_assert_eq!(found[0].axis, (column < 3).then_some(column));
            prop_assert!(found[0].rows >= 8000, "{:?}", found);
        }

        #[test]
        fn one_source_is_silent(
            seed in 0_u64..1000,
            step_c in prop::sample::select(vec![0.0, 0.0625, 0.5, 1.0]),
            sigma in prop::sample::select(vec![0.0, 0.001, 0.05]),
            step in prop::sample::select(vec![0.0, 0.01, 0.2]),
            spikes in 13_usize..2000,
            frequency in 0.0..0.5_f64,
        ) {
            let mut log = three_axes(seed, 9000, (step_c, sigma), |axis, row| match axis {
                Some(0) if row % spikes == 0 => 80.0,
                Some(1) => (std::f64::consts::TAU * frequency * row as f64).sin(),
                _ => 0.0,
            });
            for value in log.axes.iter_mut().flatten() {
                *value = rounded(*value, step);
            }
            prop_assert_eq!(found(&log), []);
        }

        #[test]
        fn whole_pulses_are_silent(rate in 0.0..9.0_f64, slope in prop::sample::select(vec![0.0, 1e-6, 1e-4])) {
            let angle = |row: usize| rate * row as f64 + slope * (row * row) as f64;
            let log = Made::new(9000, 0.5, |_| 25.0)
                .with_axis(|row, _| angle(row + 1).floor() - angle(row).floor());
            prop_assert_eq!(found(&log), []);
        }
    }
}
