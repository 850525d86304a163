//! Checks of a set that was read: what the types cannot hold back.

mod numbers;
mod ranges;
#[cfg(test)]
mod tests;

use tempco::{PLAYS, Table, Terms};

use crate::model::{AxisModel, horner};
use crate::segment::Overlap;
use crate::tabulate::{self, Limits};
use crate::{ChannelSet, CoefficientSet, FORMAT_VERSION, TableData, TableUse, use_axis};

pub use ranges::SCALE_FACTORS_ARCSEC;

/// Largest difference of a table from the polynomials, as a share of the axis's largest value: that
/// of some roundings in f32.
const ROUNDING: f64 = 4e-6;

impl CoefficientSet {
    /// Checks what the types cannot.
    pub(crate) fn check(&self) -> Result<(), String> {
        if self.format != "tempco-coefficients" || self.format_version != FORMAT_VERSION {
            return Err(format!(
                "format {} version {}: expected tempco-coefficients version {FORMAT_VERSION}",
                self.format, self.format_version
            ));
        }
        // Shape: as many axes, polynomials and history terms as belong together.
        let axes = self
            .channels
            .first()
            .map_or(0, |channel| channel.axes.len());
        if axes == 0 || self.axes().count() > 6 {
            return Err(format!("{} axes: expected 1 to 6", self.axes().count()));
        }
        for channel in &self.channels {
            if channel.axes.len() != axes {
                return Err("the temperature channels have different numbers of axes".to_owned());
            }
            channel.segmentation().map_err(|error| error.to_string())?;
            for axis in &channel.axes {
                if axis.polynomials.len() != channel.segments.len() {
                    return Err(format!(
                        "axis {} has {} polynomials for {} segments",
                        axis.name,
                        axis.polynomials.len(),
                        channel.segments.len()
                    ));
                }
                if ![0, PLAYS].contains(&axis.gains.len()) {
                    return Err(format!(
                        "axis {} has {} gains: expected {PLAYS}, or none without plays",
                        axis.name,
                        axis.gains.len()
                    ));
                }
            }
            channel
                .table
                .check(axes)
                .map_err(|error| error.to_string())?;
        }
        // The CRC says whether the table is the one that was written.
        let crc = self.crc32();
        if self.table_crc32 != format!("{crc:08x}") {
            return Err(format!(
                "the CRC of the tables is {crc:08x}, but the file says {}: it was damaged or \
                 changed by hand",
                self.table_crc32
            ));
        }
        // Then the numbers, and whether table and polynomials agree.
        self.check_numbers()?;
        for (number, channel) in self.channels.iter().enumerate() {
            channel.check_agreement(&format!("channels[{number}]"), self.settings.overlap)?;
        }
        // What is left is a small change that no other rule finds.
        let crc = self.polynomial_crc32();
        if self.set_crc32 != format!("{crc:08x}") {
            return Err(format!(
                "the CRC of polynomials, scale factor and mapping is {crc:08x}, but the file says \
                 {:?}: it was damaged or changed by hand",
                self.set_crc32
            ));
        }
        Ok(())
    }
}

impl ChannelSet {
    /// Checks that the table, whose form is known to be right, is the one that its polynomials make.
    fn check_agreement(&self, key: &str, overlap: Overlap) -> Result<(), String> {
        let segmentation = self.segmentation().map_err(|error| error.to_string())?;
        let table = &self.table;
        let (first_c, last_c) = segmentation.range_c();
        let edges = [
            ("first_edge_c", table.first_edge_c, first_c),
            ("last_edge_c", table.last_edge_c, last_c),
        ];
        for (name, edge_c, end_c) in edges {
            if edge_c != end_c as f32 {
                return Err(format!(
                    "{key}.table.{name} is {edge_c:?}: expected {end_c:?}, the end of the segments"
                ));
            }
        }
        let axes = self.axes.iter().map(|axis| AxisModel {
            polynomials: &axis.polynomials,
            overlap,
        });
        let axes: Vec<AxisModel> = axes.collect();
        let limits = Limits::of(&table.thermal);
        let made = tabulate::in_cells(table.cells.len(), &segmentation, &axes, &limits);
        if made.deviation > self.table_deviation + tabulate::TOLERANCE {
            return Err(format!(
                "{key}.table_deviation is {:?}: expected {:.1e}, which {} cells are off the \
                 polynomials",
                self.table_deviation,
                made.deviation,
                table.cells.len()
            ));
        }
        for (number, axis) in self.axes.iter().enumerate() {
            let pairs = table.cells.iter().zip(&made.cells);
            let pairs: Vec<_> = pairs.map(|(a, b)| (a[number], b[number])).collect();
            let (far, unit) = (
                |message| format!("{key}.table: axis {}, {message}", axis.name),
                axis.unit,
            );
            same(&pairs, |terms| &terms.a, unit.symbol()).map_err(far)?;
            let per_rate = format!("{unit} per degC/min");
            same(&pairs, |terms| &terms.r, &per_rate).map_err(far)?;
            same(&pairs, |terms| &terms.s, &format!("{unit} per degC")).map_err(far)?;
        }
        Ok(())
    }
}

impl TableData {
    /// Checks the form of the table, and that the core accepts it.
    fn check(&self, axes: usize) -> Result<(), String> {
        if self.cells.iter().any(|cell| cell.len() != axes) {
            return Err(format!("a cell of the table does not have {axes} axes"));
        }
        if self.play_gains.len() != axes {
            return Err(format!(
                "a table does not have the gains of the plays of {axes} axes"
            ));
        }
        (0..axes)
            .try_for_each(|axis| use_axis(self, axis, Accept).map_err(|error| error.to_string()))
    }
}

/// That the core accepts tables.
struct Accept;

impl TableUse for Accept {
    type Output = ();

    fn with<const CHANNELS: usize, const AXES: usize>(self, _: &[Table<AXES>; CHANNELS]) {}
}

/// Compares cells, as found and as made of polynomials, by the polynomial that `part` takes of them.
fn same(pairs: &[(Terms, Terms)], part: fn(&Terms) -> &[f32], unit: &str) -> Result<(), String> {
    // At the cold edge, in the middle and at the hot edge of the cell.
    let values = |terms: &Terms| {
        let coefficients: Vec<f64> = part(terms).iter().copied().map(f64::from).collect();
        [0.0, 0.5, 1.0].map(|z| horner(&coefficients, z))
    };
    let all = pairs.iter().flat_map(|(_, made)| values(made));
    let allowed = ROUNDING * all.fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for (cell, (found, made)) in pairs.iter().enumerate() {
        let differences = values(found).into_iter().zip(values(made));
        let difference = differences.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if difference > allowed {
            return Err(format!(
                "cell {} of {}: {difference:.3e} {unit} off its polynomial: expected {allowed:.1e} \
                 at most, by rounding",
                cell + 1,
                pairs.len()
            ));
        }
    }
    Ok(())
}
