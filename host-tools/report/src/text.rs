//! How numbers are written.

use comfy_table::{CellAlignment, Table, presets};
use tempco_evaluate::figure;
use tempco_set::{Candidate, ChannelSet, HeldOutErrors, HistoryGain, escape};

/// A time in seconds, with the decimals it needs, at most two.
pub(crate) fn seconds(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    format!("{short} s")
}

/// Half widths and time constant of the history terms, such as `3 degC + 4500 s`.
pub fn states(of: &Candidate) -> String {
    let plays = of
        .half_widths_c
        .iter()
        .map(|&width| format!("{} degC", figure(width)));
    let slow = of.tau2_s.map(|tau2_s| format!("{tau2_s:.0} s"));
    let all: Vec<String> = plays.chain(slow).collect();
    if all.is_empty() {
        "-".to_owned()
    } else {
        all.join(" + ")
    }
}

/// The gain of a history term, from its lowest to its highest where it is a range; `None` without
/// the term.
pub fn gain(of: &HistoryGain) -> Option<String> {
    if of.is_zero() {
        None
    } else if of.low == of.high {
        Some(figure(of.low))
    } else {
        Some(format!("{} to {}", figure(of.low), figure(of.high)))
    }
}

/// Head of the table of [`lags`].
pub const LAGS: [&str; 4] = ["lag", "tau", "kappa of the curve", "kappa of the plays"];

/// The lags of a channel: time constants, and the share of each in the temperature that the curve
/// and the plays see.
pub fn lags(channel: &ChannelSet) -> Vec<[String; 4]> {
    let thermal = &channel.table.thermal;
    let has_plays = channel.table.half_widths_c().iter().any(|&of| of > 0.0);
    let of_plays = |share: f32| match has_plays {
        true => format!("{share:.2}"),
        false => "-".to_owned(),
    };
    let row = |name: &str, tau_s: f32, shares: [f32; 2]| {
        let [kappa, play_kappa] = shares;
        let tau = format!("{tau_s:.0} s");
        let kappa = format!("{kappa:.2}");
        [name.to_owned(), tau, kappa, of_plays(play_kappa)]
    };
    let mut rows = vec![row(
        "first",
        thermal.tau_s,
        [thermal.kappa, thermal.play_kappa],
    )];
    if channel.table.has_second_lag() {
        let shares = [thermal.kappa2, thermal.play_kappa2];
        rows.push(row("second", thermal.tau2_s, shares));
    }
    rows
}

/// What the table of held-out errors holds.
pub fn held_out_caption(errors: &HeldOutErrors) -> String {
    format!(
        "RMS error of means over 100 s, less their white noise, that were left out of the fit, in {} \
         parts of {} soaks and ramps",
        errors.folds, errors.soaks_and_ramps
    )
}

/// A table for a terminal, with the first column to the left and all others, being numbers, to the right.
/// Whatever texts from elsewhere are in its cells, nothing in them acts on the terminal.
pub fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(header.iter().map(|cell| escape::line(cell)));
    for row in rows {
        table.add_row(row.iter().map(|cell| escape::line(cell)));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_a_number_a_range_or_absent() {
        let of = |low: f64, high: f64| HistoryGain {
            low,
            high,
            sigma: 0.1,
        };
        assert_eq!(gain(&of(0.25, 0.25)).unwrap(), "0.2500");
        assert_eq!(gain(&of(-0.25, 3.0)).unwrap(), "-0.2500 to 3.000");
        assert_eq!(gain(&of(0.0, 0.0)), None);
        assert_eq!(gain(&of(-1.0, 0.0)).unwrap(), "-1.000 to 0");
    }
}
