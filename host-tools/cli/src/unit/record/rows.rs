//! Rows of a recorded log.

use std::fmt::Write;

use tempco::Status;
use tempco_hil::Identity;
use tempco_link::Telemetry;
use tempco_set::axis_unit;

use super::timeline::Gap;
use crate::status::status_text;

/// Axes of a unit without names.
const AXES: [&str; 6] = ["x", "y", "z", "u", "v", "w"];

/// Makes the rows of a unit, and remembers what was in them.
pub(super) struct Rows {
    header: String,
    has_table: bool,
    count: u64,
    /// Lowest and highest temperature \[degC\].
    range_c: (f32, f32),
}

impl Rows {
    pub(super) fn new(identity: &Identity) -> Self {
        Self {
            header: header(identity),
            has_table: identity.bank.is_some(),
            count: 0,
            range_c: (f32::NAN, f32::NAN),
        }
    }

    /// The first line.
    pub(super) fn header(&self) -> &str {
        &self.header
    }

    /// A row. Numbers are the shortest ones that give the unit's single precision again; a temperature
    /// that there is not is empty.
    pub(super) fn row(&mut self, time_ms: u64, message: &Telemetry, gap: Option<Gap>) -> String {
        self.count += 1;
        let mut row = format!("{}.{:03}", time_ms / 1000, time_ms % 1000);
        for temp_c in &message.temps_c {
            let (low, high) = self.range_c;
            self.range_c = (low.min(*temp_c), high.max(*temp_c));
            row.push(',');
            if temp_c.is_finite() {
                // Writing to a string cannot fail.
                _ = write!(row, "{temp_c}");
            }
        }
        for raw in &message.raw {
            _ = write!(row, ",{raw}");
        }
        let gap = gap.map_or("", Gap::name);
        _ = writeln!(row, ",{},{gap}", self.status(message));
        row
    }

    /// The flags of all channels.
    fn status(&self, message: &Telemetry) -> String {
        if !self.has_table {
            return "no_table".to_owned();
        }
        let channels = message.outcome.channels.iter();
        let bits = channels.fold(0, |bits, channel| bits | channel.status);
        status_text(Status::from_bits(bits))
    }

    /// Rows so far.
    pub(super) const fn count(&self) -> u64 {
        self.count
    }

    /// Lowest and highest temperature; NaN without any \[degC\].
    pub(super) const fn range_c(&self) -> (f32, f32) {
        self.range_c
    }
}

/// Names that a log is read by. The temperature of a channel has the end of its axes' names: `x` of
/// a channel with one axis, else the channel's number.
fn header(identity: &Identity) -> String {
    let (channels, axes) = (usize::from(identity.channels), usize::from(identity.axes));
    let end = |channel: usize| match axes {
        1 => AXES[channel].to_owned(),
        _ => (channel + 1).to_string(),
    };
    let mut header = "time_s".to_owned();
    if channels == 1 {
        header += ",temp_c";
    } else {
        for channel in 0..channels {
            header = header + ",temp_" + &end(channel) + "_c";
        }
    }
    for (number, fit) in identity.fits.iter().enumerate() {
        let (channel, axis) = (number / axes, number % axes);
        let name = match (channels, axes) {
            (1, _) => AXES[axis].to_owned(),
            (_, 1) => end(channel),
            _ => AXES[axis].to_owned() + &end(channel),
        };
        header = header + "," + &name + "_" + axis_unit(fit.unit).name();
    }
    header + ",status,gap\n"
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempco_log::{ReadOptions, read_log};
    use tempco_set::files::ScratchFolder;

    use super::*;
    use crate::unit::port_args::tests::identity;

    /// Every shape is read as it was written: each axis with the temperature of its channel.
    #[test]
    fn a_log_of_any_shape_can_be_read() {
        let folder = ScratchFolder::new().unwrap();
        let path = folder.path().join("log.csv");
        for (channels, axes) in [(1, 1), (1, 3), (1, 6), (2, 3), (3, 1), (6, 1), (3, 2)] {
            let mut rows = Rows::new(&identity(channels, axes));
            let mut text = rows.header().to_owned();
            for index in 0..5_u64 {
                let message = Telemetry {
                    temps_c: (0..channels)
                        .map(|channel| 20.0 + f32::from(channel))
                        .collect(),
                    raw: (0..channels * axes).map(f32::from).collect(),
                    ..Telemetry::default()
                };
                text += &rows.row(100 * index, &message, None);
            }
            fs::write(&path, text).unwrap();
            let log = read_log(&path, &ReadOptions::default()).unwrap();
            assert_eq!(log.channels.len(), usize::from(channels));
            let axes = log
                .channels
                .iter()
                .enumerate()
                .flat_map(|(number, channel)| {
                    assert_eq!(channel.temp_c[0], 20.0 + number as f32);
                    &channel.axes
                });
            for (number, axis) in axes.enumerate() {
                assert_eq!(axis.raw[0], number as f64, "{}", axis.name);
            }
        }
    }
}
