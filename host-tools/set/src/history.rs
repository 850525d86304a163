//! The terms of the thermal history of a channel, with their gains.

use crate::{AxisSet, ChannelSet, GainSet};

/// A term of the history, all but its gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HistoryTerm {
    /// A play (backlash), which has one gain over the whole range.
    Play {
        /// Half width \[degC\].
        half_width_c: f32,
    },
    /// The second lag, whose gain runs straight from edge to edge of each segment.
    SecondLag {
        /// Time constant \[s\].
        tau2_s: f32,
        /// The largest lag that was calibrated \[degC\].
        limit_c: f32,
    },
}

/// The gain of a term over all segments \[unit of the axis per degC\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HistoryGain {
    /// Lowest gain at the edges of the segments.
    pub low: f64,
    /// Highest gain at the edges of the segments.
    pub high: f64,
    /// Standard deviation (1 sigma): of the gain of a play, or the largest in the middle of a
    /// segment. 0 where it is not known.
    pub sigma: f64,
}

impl HistoryGain {
    /// Whether the axis does without the term.
    pub fn is_zero(&self) -> bool {
        self.low == 0.0 && self.high == 0.0
    }

    /// The gain of the second lag of an axis: in the basis of a segment, `s[0] + s[1] z` with z
    /// from -1 to 1.
    fn of_second_lag(axis: &AxisSet) -> Self {
        let ends = axis.polynomials.iter().map(|of| of.s);
        let ends = ends.flat_map(|[middle, slope]| [middle - slope, middle + slope]);
        let sigmas = axis.sigmas.iter().map(|of| of.s[0]);
        let range = ends.fold(None, |range, gain| {
            let (low, high) = range.unwrap_or((gain, gain));
            Some((gain.min(low), gain.max(high)))
        });
        let (low, high) = range.unwrap_or_default();
        Self {
            low,
            high,
            sigma: sigmas.fold(0.0, f64::max),
        }
    }
}

impl From<GainSet> for HistoryGain {
    fn from(GainSet { gain, sigma }: GainSet) -> Self {
        Self {
            low: gain,
            high: gain,
            sigma,
        }
    }
}

impl ChannelSet {
    /// The history terms of an axis of the channel that are in use, plays first.
    pub fn history<'a>(
        &'a self,
        axis: &'a AxisSet,
    ) -> impl Iterator<Item = (HistoryTerm, HistoryGain)> + 'a {
        let widths = self.table.half_widths_c().into_iter();
        let plays = widths.zip(&axis.gains).map(|(half_width_c, gain)| {
            let play = HistoryTerm::Play { half_width_c };
            (play, HistoryGain::from(*gain))
        });
        let plays = plays.filter(|(play, _)| *play != HistoryTerm::Play { half_width_c: 0.0 });
        let thermal = &self.table.thermal;
        let lag = HistoryTerm::SecondLag {
            tau2_s: thermal.tau2_s,
            limit_c: thermal.lag2_max_c.max(-thermal.lag2_min_c),
        };
        let lag = (lag, HistoryGain::of_second_lag(axis));
        plays.chain(self.table.has_second_lag().then_some(lag))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::static_coefficients;

    const PRINTED: &str = "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
         X,1,-15,40,0.0173,-0.0014,0.00001\nX,2,30,80,0.0173,-0.0014,0.00002\n";

    #[test]
    fn the_gain_of_the_second_lag_is_a_range_over_all_segments() {
        let path = std::path::Path::new("printed.csv");
        let mut set = static_coefficients(path, PRINTED).unwrap();
        let channel = &mut set.channels[0];
        channel.table.thermal.half_width2_c = 12.0;
        channel.table.thermal.lag2_max_c = 3.0;
        let axis = &mut channel.axes[0];
        axis.gains = vec![
            GainSet::default(),
            GainSet {
                gain: -0.2,
                sigma: 0.01,
            },
        ];
        axis.polynomials[0].s = [0.1, 0.3];
        axis.polynomials[1].s = [0.5, 0.25];
        let channel = &set.channels[0];
        let found: Vec<_> = channel.history(&channel.axes[0]).collect();
        let play = HistoryTerm::Play { half_width_c: 12.0 };
        let lag = HistoryTerm::SecondLag {
            tau2_s: channel.table.thermal.tau2_s,
            limit_c: 3.0,
        };
        let gain = |low: f64, high: f64, sigma: f64| HistoryGain { low, high, sigma };
        assert_eq!(
            found,
            [
                (play, gain(-0.2, -0.2, 0.01)),
                (lag, gain(0.1 - 0.3, 0.75, 0.0))
            ]
        );
        assert!(!found[1].1.is_zero() && HistoryGain::default().is_zero());
    }
}
