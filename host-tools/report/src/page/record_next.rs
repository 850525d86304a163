//! What the logs of a calibration do not cover: what to record next.

use maud::{Markup, html};
use tempco_log::turns::turns;
use tempco_set::{ChannelSet, CoefficientSet};

use crate::gather::{Gathered, GatheredChannel};

/// A turn of less is noise of a sensor, or a chamber that overshoots \[degC\].
const LEAST_TURN_C: f64 = 5.0;

/// Temperatures further apart than this without a turn between them are worth loops \[degC\]. Loops that
/// pay are narrower.
const MOST_WITHOUT_TURN_C: f64 = 30.0;

/// A direction is that of a rate beyond this \[degC/min\].
const LEAST_RATE: f64 = 0.1;

/// A temperature was passed in a direction for this long, and bands less wide are not named \[s, degC\].
const LEAST_TIME_S: f64 = 10.0;
const LEAST_BAND_C: f64 = 5.0;

/// What each channel lacks.
pub(super) fn record_next(set: &CoefficientSet, gathered: &Gathered) -> Markup {
    let channels = set.channels.iter().zip(&gathered.channels);
    let advice = channels.flat_map(|(channel, gathered)| {
        let sentences = missing(channel, gathered).into_iter();
        sentences.map(|sentence| (&channel.temperature, sentence))
    });
    let advice: Vec<_> = advice.collect();
    html! {
        h3 { "What to record next" }
        @if advice.is_empty() {
            p { "The logs have ramps of several rates, both directions and loops over the whole range." }
        }
        ul { @for (name, sentence) in &advice { li { (name) ": " (sentence) } } }
    }
}

/// Sentences that say what is missing, the most useful first; none if nothing is.
fn missing(channel: &ChannelSet, gathered: &GatheredChannel) -> Vec<String> {
    let range_c = (
        f64::from(channel.table.t_min_c),
        f64::from(channel.table.t_max_c),
    );
    let rates = channel.selection.as_ref();
    let rates = rates.map(|of| of.ramp_rates_c_per_min.as_slice());
    let mut found = Vec::new();
    if let Some([rate]) = rates {
        found.push(format!(
            "Ramps at another rate. All are near {rate:.2} degC/min, at which hysteresis and lag look \
             the same."
        ));
    }
    for (heats, from_c, to_c) in one_way(gathered, range_c) {
        found.push(match heats {
            true => format!(
                "Cool from {to_c:.0} to {from_c:.0} degC. There the temperature only rises."
            ),
            false => format!(
                "Heat from {from_c:.0} to {to_c:.0} degC. There the temperature only falls."
            ),
        });
    }
    let means = gathered.temps_c.iter();
    let means = means.filter_map(|(_, spread)| spread.mean());
    if let Some((from_c, to_c)) = without_turn(means, range_c) {
        found.push(format!(
            "Loops of 10 to 30 degC. Between {from_c:.0} and {to_c:.0} degC the temperature never \
             turns back, and hysteresis shows where it does."
        ));
    }
    found
}

/// The widest band without a turn \[degC\], if it is too wide.
fn without_turn(
    temps_c: impl Iterator<Item = f64>,
    (low_c, high_c): (f64, f64),
) -> Option<(f64, f64)> {
    let mut turns_c = vec![low_c, high_c];
    // Where the logs begin and end is no turn.
    if let [_, inner @ .., _] = turns(temps_c, LEAST_TURN_C).as_slice() {
        turns_c.extend(inner);
    }
    turns_c.sort_unstable_by(f64::total_cmp);
    let bands = turns_c.windows(2).map(|pair| (pair[0], pair[1]));
    let widest = bands.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    widest.filter(|(from_c, to_c)| to_c - from_c > MOST_WITHOUT_TURN_C)
}

/// Bands that were passed in one direction alone: whether that is heating, and their ends \[degC\].
fn one_way(gathered: &GatheredChannel, range_c: (f64, f64)) -> Vec<(bool, f64, f64)> {
    let map = &gathered.map;
    let first = (range_c.0 / map.cell_c).ceil() as i32;
    let last = (range_c.1 / map.cell_c).floor() as i32;
    let direction = |i: i32| {
        let in_cells = |chosen: fn(f64) -> bool| -> f64 {
            let cells = map.time_s.range((i, i32::MIN)..=(i, i32::MAX));
            let cells =
                cells.filter(|((_, j), _)| chosen((f64::from(*j) + 0.5) * map.cell_c_per_min));
            cells.map(|(_, time_s)| time_s).sum()
        };
        let heated = in_cells(|rate| rate > LEAST_RATE) > LEAST_TIME_S;
        let cooled = in_cells(|rate| rate < -LEAST_RATE) > LEAST_TIME_S;
        (heated != cooled).then_some(heated)
    };
    let columns: Vec<i32> = (first..last).collect();
    let bands = columns.chunk_by(|&a, &b| direction(a) == direction(b));
    let bands = bands.filter_map(|band| {
        let heats = direction(band[0])?;
        let end = |i: i32| f64::from(i) * map.cell_c;
        Some((heats, end(band[0]), end(band[band.len() - 1] + 1)))
    });
    bands
        .filter(|(_, from_c, to_c)| to_c - from_c >= LEAST_BAND_C)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(points: &[f64]) -> impl Iterator<Item = f64> {
        points.windows(2).flat_map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            (0..=100).map(move |i| from + (to - from) * f64::from(i) / 100.0)
        })
    }

    #[test]
    fn a_full_cycle_lacks_loops_and_loops_lack_none() {
        let range_c = (-10.0, 60.0);
        let full = without_turn(way(&[25.0, -10.0, 60.0, -10.0]), range_c);
        assert_eq!(full, Some((-10.0, 60.0)));
        let loops = [25.0, -10.0, 15.0, 0.0, 40.0, 20.0, 60.0, -10.0];
        assert_eq!(without_turn(way(&loops), range_c), None);
    }
}
