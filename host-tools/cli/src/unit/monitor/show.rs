//! Telemetry for people.

use std::io::{Write, stdout};

use anyhow::Result;
use tempco::Status;
use tempco_hil::Identity;
use tempco_link::{ChannelTelemetry, Telemetry};

use crate::output::{figure, print, table};
use crate::status::status_text;
use crate::unit::port_args::bank_name;

/// How messages are shown.
pub(super) struct View<'a> {
    identity: &'a Identity,
    is_live: bool,
    /// Lines of the last message, which the next one overwrites.
    lines: usize,
}

impl<'a> View<'a> {
    pub(super) const fn new(identity: &'a Identity, is_live: bool) -> Self {
        Self {
            identity,
            is_live,
            lines: 0,
        }
    }

    /// What stays the same.
    pub(super) fn begin(&self) -> Result<()> {
        let unit = self.identity;
        let table = match unit.bank {
            Some(bank) => format!("table {:08x}{}", unit.table_crc, bank_name(bank)),
            None => "no table: it runs uncompensated".to_owned(),
        };
        print(format_args!(
            "unit {}, {}, {} Hz, {} samples per temperature, {table}",
            unit.serial,
            unit.firmware,
            unit.schedule.sample_rate_hz,
            unit.schedule.samples_per_update
        ))
    }

    pub(super) fn show(&mut self, telemetry: &Telemetry) -> Result<()> {
        if !self.is_live {
            return print(line(telemetry));
        }
        let text = self.block(telemetry);
        let mut out = stdout().lock();
        if self.lines > 0 {
            // Up to the beginning of the last message, and erase it.
            write!(out, "\x1b[{}A\x1b[J", self.lines)?;
        }
        writeln!(out, "{text}")?;
        self.lines = text.lines().count();
        Ok(())
    }

    /// A message as tables.
    fn block(&self, telemetry: &Telemetry) -> String {
        let channels = telemetry.outcome.channels.iter().enumerate();
        let channels = channels.map(|(number, channel)| {
            let measured_c = telemetry.temps_c.get(number).copied().unwrap_or(f32::NAN);
            vec![
                number.to_string(),
                format!("{measured_c:.3}"),
                format!("{:.3}", channel.effective_c),
                format!("{:+.3}", channel.rate_c_per_min),
                status_text(Status::from_bits(channel.status)),
            ]
        });
        let header = [
            "channel",
            "T [degC]",
            "effective",
            "T' [degC/min]",
            "status",
        ];
        let thermal = table(&header, channels);
        let value = |of: &[f32], axis: usize| of.get(axis).map_or(f64::NAN, |v| f64::from(*v));
        let axes = (0..telemetry.raw.len()).map(|axis| {
            let outcome = &telemetry.outcome;
            let values = [
                value(&telemetry.raw, axis),
                value(&outcome.bias, axis),
                value(&telemetry.offset, axis),
                value(&outcome.compensated, axis),
            ];
            let mut row = vec![axis.to_string()];
            row.extend(values.map(figure));
            row
        });
        let axes = table(&["axis", "raw", "bias", "re-zero", "compensated"], axes);
        format!("{thermal}\n{axes}\n{}", state(telemetry))
    }
}

/// The state of the unit.
fn state(telemetry: &Telemetry) -> String {
    format!(
        "faults: {}\nmessage {}, {:.1} s after power-on; {} samples, {} temperatures rejected, {} \
         overruns, {} frames dropped\nload {:.1} %, longest latency {:.1} us",
        telemetry.faults,
        telemetry.index,
        f64::from(telemetry.uptime_ms) / 1000.0,
        telemetry.samples,
        telemetry.rejected,
        telemetry.overruns,
        telemetry.dropped_frames,
        f64::from(telemetry.load_permille) / 10.0,
        f64::from(telemetry.latency_ns) / 1000.0,
    )
}

/// A message on one line.
fn line(telemetry: &Telemetry) -> String {
    let list = |values: &[f32]| {
        let values: Vec<String> = values.iter().map(|v| figure(f64::from(*v))).collect();
        values.join(" ")
    };
    let channels = &telemetry.outcome.channels;
    let rate = |channel: &ChannelTelemetry| format!("{:+.3}", channel.rate_c_per_min);
    let status = |channel: &ChannelTelemetry| status_text(Status::from_bits(channel.status));
    let each = |text: &dyn Fn(&ChannelTelemetry) -> String| {
        let texts: Vec<String> = channels.iter().map(text).collect();
        texts.join(" ")
    };
    format!(
        "{} {:.1} s: T {} degC, T' {} degC/min, raw {}, bias {}, compensated {}, status {}, \
         faults: {}, overruns {}, rejected {}, dropped {}, load {:.1} %, latency {:.1} us",
        telemetry.index,
        f64::from(telemetry.uptime_ms) / 1000.0,
        list(&telemetry.temps_c),
        each(&rate),
        list(&telemetry.raw),
        list(&telemetry.outcome.bias),
        list(&telemetry.outcome.compensated),
        each(&status),
        telemetry.faults,
        telemetry.overruns,
        telemetry.rejected,
        telemetry.dropped_frames,
        f64::from(telemetry.load_permille) / 10.0,
        f64::from(telemetry.latency_ns) / 1000.0,
    )
}

#[cfg(test)]
mod tests {
    use tempco_link::{Fault, FaultSet, Outcome};

    use super::*;
    use crate::unit::port_args::tests::identity;

    #[test]
    fn a_message_is_shown_with_units_status_and_faults() {
        let identity = identity(1, 2);
        let channel = ChannelTelemetry {
            effective_c: 24.5,
            rate_c_per_min: -0.25,
            status: Status::SETTLING.bits(),
        };
        let telemetry = Telemetry {
            index: 7,
            uptime_ms: 12_345,
            temps_c: [f32::NAN].into_iter().collect(),
            raw: [1.5, -2.5].into_iter().collect(),
            outcome: Outcome {
                channels: [channel].into_iter().collect(),
                bias: [0.5, 0.25].into_iter().collect(),
                compensated: [1.0, -2.75].into_iter().collect(),
            },
            faults: FaultSet::from(Fault::SensorOpen),
            load_permille: 123,
            latency_ns: 35_500,
            ..Telemetry::default()
        };
        let block = View::new(&identity, true).block(&telemetry);
        let line = line(&telemetry);
        for part in [
            "NaN",
            "-0.250",
            "settling",
            "-2.75",
            "faults: sensor open",
            "12.3 %",
        ] {
            assert!(block.contains(part), "{part}: {block}");
            assert!(line.contains(part), "{part}: {line}");
        }
        assert!(block.contains("24.500"), "{block}");
        assert!(block.contains("12.3 s after power-on"), "{block}");
        assert!(line.starts_with("7 12.3 s: "), "{line}");
    }
}
