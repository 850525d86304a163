//! The step that host and firmware share.

use tempco::{Compensator, Interval, Output, Status, Table, Validity};

use crate::{Outcome, Sample};

/// One compensator per temperature channel, fed with a log.
///
/// The first sample is a thermal update in any case and starts every channel at its temperature; that
/// one and all later updates are stepped with the time they bring along. A sample in between gets
/// the bias and the flags of the last update.
#[derive(Clone, Debug)]
pub struct Replay<'t, const C: usize, const A: usize> {
    tables: &'t [Table<'t, A>; C],
    units: [Compensator<'t, A>; C],
    /// The last update of each channel; none before the first sample.
    last: Option<[Output<A>; C]>,
    samples: u32,
    not_valid: u32,
    seen: Status,
}

impl<'t, const C: usize, const A: usize> Replay<'t, C, A> {
    /// A replay before its first sample; one table per temperature channel.
    pub fn new(tables: &'t [Table<'t, A>; C]) -> Self {
        Self {
            tables,
            units: tables.each_ref().map(Compensator::new),
            last: None,
            samples: 0,
            not_valid: 0,
            seen: Status::OK,
        }
    }

    /// Takes one sample through every channel.
    pub fn step(&mut self, sample: &Sample<C, A>) -> Outcome<C, A> {
        let updated = match (self.last, sample.update_s) {
            (Some(last), None) => last,
            (_, update_s) => self.update(update_s.unwrap_or(0.0), &sample.temps_c),
        };
        let mut seen = Status::OK;
        let channels = core::array::from_fn(|channel| {
            let (last, raw) = (updated[channel], &sample.raw[channel]);
            let status = last.status | Status::of_raw(raw);
            seen |= status;
            let compensated = core::array::from_fn(|axis| raw[axis] - last.bias[axis]);
            let output = Output {
                compensated,
                status,
                ..last
            };
            output.into()
        });
        self.samples = self.samples.saturating_add(1);
        let not_valid = u32::from(seen.validity() != Validity::Valid);
        self.not_valid = self.not_valid.saturating_add(not_valid);
        self.seen |= seen;
        Outcome { channels }
    }

    /// Takes the temperatures, `dt_s` after the last ones, with gyro samples of 0.
    fn update(&mut self, dt_s: f32, temps_c: &[f32; C]) -> [Output<A>; C] {
        let is_first = self.last.is_none();
        let updated = core::array::from_fn(|channel| {
            let unit = &mut self.units[channel];
            let interval = Interval::new(self.tables[channel].thermal(), dt_s);
            if is_first {
                unit.start(temps_c[channel]);
            }
            unit.step(&interval, temps_c[channel], [0.0; A])
        });
        *self.last.insert(updated)
    }

    /// What happened so far.
    pub fn summary(&self) -> Summary {
        let total = |count: fn(&Compensator<'t, A>) -> u32| {
            self.units
                .iter()
                .fold(0, |sum: u32, unit| sum.saturating_add(count(unit)))
        };
        Summary {
            samples: self.samples,
            not_valid: self.not_valid,
            rejected: total(|unit| unit.thermal_state().rejected()),
            restarts: total(|unit| unit.thermal_state().restarts()),
            seen: self.seen,
        }
    }
}

/// What happened during a replay. The counters stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Summary {
    /// Samples taken.
    pub samples: u32,
    /// Samples with any flag in any channel.
    pub not_valid: u32,
    /// Temperatures rejected, over all channels.
    pub rejected: u32,
    /// Starts and restarts of the rate estimator, over all channels.
    pub restarts: u32,
    /// Every flag that was ever set.
    pub seen: Status,
}

impl Summary {
    /// The worst class any sample was in.
    pub const fn worst(&self) -> Validity {
        // The class of a set of flags is the worst of its flags, so the union has the worst of all.
        self.seen.validity()
    }
}
