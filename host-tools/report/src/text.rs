//! How numbers are written.

use comfy_table::{CellAlignment, Table, presets};
use tempco_evaluate::figure;
use tempco_set::{Candidate, escape};

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
