//! Signals that are not what they are said to be: each kind of fault has a detector.
//!
//! ```text
//! rows of a channel, in order of time -> detectors (one pass, fixed memory) -> findings
//! ```
//!
//! A detector judges a column against the rest of the same column, so that units and scale do not
//! matter. It must stay silent on a sound log, however coarse its steps.

mod alternating;
mod fahrenheit;
mod finding;
mod frozen_temperature;
mod full_scale;
mod identical;
#[cfg(test)]
mod made;
mod packets;
mod running_total;
mod runs;
mod temperature_jump;
mod windows;

use crate::log::Log;

pub use finding::{Fault, Finding};

use alternating::Alternating;
use fahrenheit::Fahrenheit;
use frozen_temperature::FrozenTemperature;
use full_scale::FullScale;
use identical::Identical;
use packets::Packets;
use running_total::RunningTotal;
use temperature_jump::TemperatureJump;

/// Rows that all detectors look at before the next ones: they stay in the processor's first cache.
const ROWS_AT_A_TIME: usize = 512;

/// Where a detector found its fault.
#[derive(Clone, Debug, PartialEq)]
struct Place {
    /// Number of the axis in its channel; none for the temperature.
    axis: Option<usize>,
    /// Rows that show it.
    rows: usize,
    /// Time of the first of them \[s\].
    from_s: f64,
    /// Time of the last of them \[s\].
    to_s: f64,
    /// What stands there, for a person.
    detail: String,
}

/// All detectors of one channel, over rows in order of time.
#[derive(Clone, Debug)]
pub struct Signals {
    rows: usize,
    full_scale: FullScale,
    identical: Identical,
    frozen_temperature: FrozenTemperature,
    running_total: RunningTotal,
    temperature_jump: TemperatureJump,
    alternating: Alternating,
    packets: Packets,
    fahrenheit: Fahrenheit,
}

impl Signals {
    /// Of a channel with so many axes.
    pub fn new(axes: usize) -> Self {
        Self {
            rows: 0,
            full_scale: FullScale::new(axes),
            identical: Identical::new(axes),
            frozen_temperature: FrozenTemperature::new(axes),
            running_total: RunningTotal::new(axes),
            temperature_jump: TemperatureJump::new(axes),
            alternating: Alternating::new(axes),
            packets: Packets::new(axes),
            fahrenheit: Fahrenheit::new(axes),
        }
    }

    /// Takes in the next rows: times \[s\], temperatures \[degC\], and the axes in any unit.
    pub fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        for start in (0..time_s.len()).step_by(ROWS_AT_A_TIME) {
            let rows = start..time_s.len().min(start + ROWS_AT_A_TIME);
            let axes: Vec<&[f64]> = axes.iter().map(|axis| &axis[rows.clone()]).collect();
            self.take_some(&time_s[rows.clone()], &temp_c[rows], &axes);
        }
    }

    fn take_some(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        self.rows += time_s.len();
        self.full_scale.take(time_s, temp_c, axes);
        self.identical.take(time_s, temp_c, axes);
        self.frozen_temperature.take(time_s, temp_c, axes);
        self.running_total.take(time_s, temp_c, axes);
        self.temperature_jump.take(time_s, temp_c, axes);
        self.alternating.take(time_s, temp_c, axes);
        self.packets.take(time_s, temp_c, axes);
        self.fahrenheit.take(time_s, temp_c, axes);
    }

    /// What was found; `temperature` and `axes` are the names of the columns.
    pub fn finish(self, temperature: &str, axes: &[&str]) -> Vec<Finding> {
        let (frozen, standing) = self.frozen_temperature.finish();
        // Row by row, or packet by packet.
        let mut alternating = self.alternating.finish();
        if alternating.is_empty() {
            alternating = self.packets.finish();
        }
        let found = [
            (Fault::FullScale, self.full_scale.finish()),
            (Fault::IdenticalValues, self.identical.finish()),
            (Fault::FrozenTemperature, frozen),
            (Fault::StandingTemperature, standing),
            (Fault::RunningTotal, self.running_total.finish()),
            (Fault::TemperatureJump, self.temperature_jump.finish()),
            (Fault::AlternatingSources, alternating),
            (Fault::Fahrenheit, self.fahrenheit.finish()),
        ];
        let rows = self.rows;
        let of_fault = |(fault, places): (Fault, Vec<Place>)| {
            places.into_iter().map(move |place| Finding {
                fault,
                column: place.axis.map_or(temperature, |axis| axes[axis]).to_owned(),
                rows: place.rows,
                share: place.rows as f64 / rows as f64,
                from_s: place.from_s,
                to_s: place.to_s,
                detail: place.detail,
            })
        };
        found.into_iter().flat_map(of_fault).collect()
    }
}

/// What is wrong with the signals of a log in memory.
pub fn find(log: &Log) -> Vec<Finding> {
    let channels = log.channels.iter().flat_map(|channel| {
        let mut signals = Signals::new(channel.axes.len());
        let axes: Vec<&[f64]> = channel.axes.iter().map(|axis| &axis.raw[..]).collect();
        signals.take(&log.time_s, &channel.temp_c, &axes);
        let names: Vec<&str> = channel.axes.iter().map(|axis| &axis.name[..]).collect();
        signals.finish(&channel.column, &names)
    });
    channels.collect()
}
