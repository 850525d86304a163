//! What is left out together: whole soaks and ramps.

use tempco_log::median::median;

use crate::least_squares::Blocks;

/// Rates below this are a soak: the sensor's noise is not a ramp \[degC/min\].
pub(crate) const SOAK_C_PER_MIN: f64 = 0.1;

/// A soak or ramp shorter than this belongs to the one before it \[s\].
const LEAST_S: f64 = 600.0;

/// The most folds; with more soaks and ramps, every so-many-th goes into the same fold.
const MOST_FOLDS: usize = 16;

/// Ramps are of one rate up to this factor: a chamber does not hold its rate, and a part in it
/// less.
const SAME_RATE: f64 = 1.3;

/// With fewer soaks and ramps than this, time is cut into [`MOST_FOLDS`] equal parts instead, and
/// nothing that depends on the rate can be judged: no temperature was passed twice at two rates.
/// Logs of one soak or ramp each are cut as well, however many.
pub(crate) const LEAST_FOLDS: usize = 4;

/// For each block the fold in which it is left out, and the number of folds.
///
/// A soak or ramp is a stretch of a log that heats, cools or soaks throughout, judged by `rates`
/// \[degC/min\]. Each log is divided by itself, so that the order of logs does not matter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Folds {
    pub(crate) of_block: Vec<usize>,
    pub(crate) count: usize,
    /// Soaks and ramps found in all logs.
    pub(crate) soaks_and_ramps: usize,
    /// Speeds of the ramps that differ, ascending \[degC/min\].
    pub(crate) ramp_rates: Vec<f64>,
}

impl Folds {
    pub(crate) fn new(blocks: &Blocks, rates: &[f64]) -> Self {
        let mut of_logs = Vec::new();
        let mut speeds = Vec::new();
        for log in 0..blocks.logs() {
            let of_log: Vec<usize> = (0..rates.len())
                .filter(|&i| blocks.blocks[i].log == log)
                .collect();
            let Some(&first) = of_log.first() else {
                continue;
            };
            let times: Vec<f64> = of_log.iter().map(|&i| blocks.blocks[i].time_s).collect();
            let rates = &rates[first..first + of_log.len()];
            let found = numbers_of(&times, rates);
            speeds.extend(ramp_speeds(&found, rates));
            of_logs.push(found);
        }
        let count_of = |numbers: &Vec<usize>| numbers.last().map_or(0, |last| last + 1);
        let total = of_logs.iter().map(count_of).sum();
        // All of them would be left out at once.
        let one_each = of_logs.iter().all(|numbers| count_of(numbers) == 1);
        let mut numbers = Vec::with_capacity(rates.len());
        let mut most = 0;
        for mut found in of_logs {
            let mut count = count_of(&found);
            if one_each || count < LEAST_FOLDS && blocks.logs() < LEAST_FOLDS {
                let n = found.len();
                found = (0..n).map(|i| i * MOST_FOLDS / n).collect();
                count = MOST_FOLDS;
            }
            most = most.max(count);
            numbers.extend(found);
        }
        let count = most.clamp(1, MOST_FOLDS);
        Self {
            of_block: numbers.into_iter().map(|number| number % count).collect(),
            count,
            soaks_and_ramps: total,
            ramp_rates: distinct(speeds),
        }
    }
}

/// The median speed of each ramp.
fn ramp_speeds(numbers: &[usize], rates: &[f64]) -> Vec<f64> {
    let count = numbers.last().map_or(0, |last| last + 1);
    let mut of_number = vec![Vec::new(); count];
    for (&number, rate) in numbers.iter().zip(rates) {
        of_number[number].push(rate.abs());
    }
    let medians = of_number
        .iter_mut()
        .map(|speeds: &mut Vec<f64>| median(speeds));
    medians.filter(|&median| median >= SOAK_C_PER_MIN).collect()
}

/// The slowest of each group that are of one rate.
fn distinct(mut speeds: Vec<f64>) -> Vec<f64> {
    speeds.sort_by(f64::total_cmp);
    let mut found: Vec<f64> = Vec::new();
    for speed in speeds {
        if found
            .last()
            .is_none_or(|slowest| speed > SAME_RATE * slowest)
        {
            found.push(speed);
        }
    }
    found
}

/// Numbers the soaks and ramps of one log.
fn numbers_of(times_s: &[f64], rates: &[f64]) -> Vec<usize> {
    let kind = |rate: f64| {
        if rate.abs() < SOAK_C_PER_MIN {
            0
        } else {
            rate.signum() as i32
        }
    };
    // Stretches of one kind, then the short ones joined to what is before them.
    let mut starts: Vec<(usize, i32)> = Vec::new();
    for (i, &rate) in rates.iter().enumerate() {
        if starts.last().is_none_or(|&(_, of)| of != kind(rate)) {
            starts.push((i, kind(rate)));
        }
    }
    let end_s = times_s[times_s.len() - 1];
    let mut kept: Vec<(usize, i32)> = Vec::new();
    for (number, &(start, of)) in starts.iter().enumerate() {
        let stop_s = starts
            .get(number + 1)
            .map_or(end_s, |&(next, _)| times_s[next]);
        let short = stop_s - times_s[start] < LEAST_S;
        if kept
            .last()
            .is_none_or(|&(_, before)| !short && before != of)
        {
            kept.push((start, of));
        }
    }
    let mut numbers = vec![0; rates.len()];
    for (number, &(start, _)) in kept.iter().enumerate() {
        numbers[start..].fill(number);
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_and_soaks_are_legs_and_short_ones_are_not() {
        let rates = [
            (0.0, 100),
            (1.0, 200),
            (0.02, 30),
            (1.0, 50),
            (-0.5, 300),
            (0.0, 80),
        ];
        let rates: Vec<f64> = rates
            .iter()
            .flat_map(|&(rate, count)| std::iter::repeat_n(rate, count))
            .collect();
        let times: Vec<f64> = (0..rates.len()).map(|i| 10.0 * i as f64).collect();
        let numbers = numbers_of(&times, &rates);
        let at = [0, 99, 100, 310, 379, 380, 679, 680].map(|i| numbers[i]);
        assert_eq!(at, [0, 0, 1, 1, 1, 2, 2, 3]);
    }
}
