//! The terms of the thermal history of a channel, with their gains.

use crate::{AxisSet, ChannelSet, GainSet};

/// A term of the history, all but its gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HistoryTerm {
    /// A play (backlash).
    Play {
        /// Half width \[degC\].
        half_width_c: f32,
    },
    /// The second lag, which has one gain over the whole range.
    SecondLag {
        /// Time constant \[s\].
        tau2_s: f32,
        /// The largest lag that was calibrated \[degC\].
        limit_c: f32,
    },
}

impl ChannelSet {
    /// The history terms of an axis of the channel that are in use, plays first.
    pub fn history<'a>(
        &'a self,
        axis: &'a AxisSet,
    ) -> impl Iterator<Item = (HistoryTerm, GainSet)> + 'a {
        let widths = self.table.half_widths_c().into_iter();
        let plays = widths.zip(&axis.gains).map(|(half_width_c, gain)| {
            let play = HistoryTerm::Play { half_width_c };
            (play, *gain)
        });
        let plays = plays.filter(|(play, _)| *play != HistoryTerm::Play { half_width_c: 0.0 });
        let thermal = &self.table.thermal;
        let lag = HistoryTerm::SecondLag {
            tau2_s: thermal.tau2_s,
            limit_c: thermal.lag2_max_c.max(-thermal.lag2_min_c),
        };
        let gain = GainSet {
            gain: axis.polynomials.first().map_or(0.0, |of| of.s[0]),
            sigma: axis.sigmas.first().map_or(0.0, |of| of.s[0]),
        };
        plays.chain(self.table.has_second_lag().then_some((lag, gain)))
    }
}
