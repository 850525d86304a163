//! The coefficient set: everything that was fitted, in f64, and the table that flies, in f32.

use serde::{Deserialize, Serialize};
use tempco::{PLAYS, Terms, ThermalSettings};
use tempco_image::CRC;

use crate::model::{Mismatch, mismatches};
use crate::run::thermal_period_s;
use crate::segment::{Overlap, Segment, SegmentError, Segmentation};
use crate::table::{self, TableData, without_history};
use crate::{AxisSet, Model, Outliers, Provenance, Selection, SignOff, version1};

/// Version of the JSON format; a reader refuses another one.
pub const FORMAT_VERSION: u32 = 2;

/// An overlap mismatch beyond this share of the axis's own bias range raises the alarm: the
/// neighbours then disagree about more than half of what they are there to remove.
pub const MISMATCH_ALARM: f64 = 0.5;

/// Coefficients of a unit with their provenance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoefficientSet {
    /// Always `tempco-coefficients`.
    pub format: String,
    /// [`FORMAT_VERSION`].
    pub format_version: u32,
    /// Serial number of the unit.
    pub serial: String,
    /// What made this set, from what, and when.
    pub provenance: Provenance,
    /// What was asked of the fit.
    pub settings: Settings,
    /// One per temperature channel.
    pub channels: Vec<ChannelSet>,
    /// CRC-32P4 over the numbers of all tables, in hexadecimal.
    pub table_crc32: String,
    /// CRC-32P4 over the polynomials, the scale factor and the mapping of columns, in hexadecimal.
    #[serde(default)]
    pub set_crc32: String,
    /// Verdicts of verification logs, oldest first; the last one counts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sign_offs: Vec<SignOff>,
}

/// What was asked of the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// `static`, `composite`, `spline` or `auto`.
    pub model: Model,
    /// What is applied where segments overlap.
    pub overlap: Overlap,
    /// Angle per pulse \[arcsec\], if pulse counts were turned into deg/h.
    pub scale_factor_arcsec: Option<f64>,
    /// Time between two temperatures of the core \[s\]: the longest of the fitted logs, see
    /// [`thermal_period_s`](crate::run::thermal_period_s); 0 in an imported set.
    pub thermal_period_s: f64,
}

/// The axes that share a temperature, and their table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSet {
    /// Name of the temperature column.
    pub temperature: String,
    /// The segments and what was found in each.
    pub segments: Vec<SegmentSet>,
    /// The axes.
    pub axes: Vec<AxisSet>,
    /// The table that flies.
    pub table: TableData,
    /// Largest deviation of the table from the segments, as a share of an axis's bias range.
    pub table_deviation: f64,
    /// How far a boundary between segments had to be moved to fall on an edge of a cell \[degC\].
    pub boundary_moved_c: f64,
    /// What was left out of the fit, and what was found in the logs; none in an imported set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outliers: Option<Outliers>,
    /// What the model was chosen from; none where it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub selection: Option<Selection>,
}

/// One segment as fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentSet {
    /// Cold end \[degC\].
    pub t_min_c: f64,
    /// Hot end \[degC\].
    pub t_max_c: f64,
    /// The terms that were fitted, out of `1, T, T^2, T', T T'`.
    pub terms: Vec<String>,
    /// Rows that entered the fit; 0 in an imported set.
    pub rows: u64,
    /// Condition number of the fit; 0 in an imported set.
    pub condition: f64,
    /// What the rows cover; none in an imported set.
    #[serde(default)]
    pub coverage: Option<Coverage>,
}

impl SegmentSet {
    pub(crate) fn range(&self) -> Segment {
        Segment {
            t_min_c: self.t_min_c,
            t_max_c: self.t_max_c,
        }
    }
}

/// What the rows of a segment cover.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// Time that the rows stand for \[s\].
    pub time_s: f64,
    /// Share of the segment's width from the coldest row to the hottest, 0 to 1.
    pub width: f64,
    /// Lowest rate \[degC/min\].
    pub rate_min_c_per_min: f64,
    /// Highest rate \[degC/min\].
    pub rate_max_c_per_min: f64,
    /// Spread of the rate: root mean square of the part that the temperature does not tell
    /// \[degC/min\]. This is what the rate terms are found from.
    pub rate_independent_c_per_min: f64,
}

impl CoefficientSet {
    /// The same set without its use of the rate and the history of temperature. None where it makes
    /// no use of them.
    pub fn static_part(&self) -> Option<Self> {
        let mut part = self.clone();
        for channel in &mut part.channels {
            let table = &mut channel.table;
            table.thermal = ThermalSettings {
                kappa: 0.0,
                ..without_history(&table.thermal)
            };
            table.play_gains.fill([0.0; PLAYS]);
            for terms in table.cells.iter_mut().flatten() {
                *terms = Terms::new(terms.a, []);
            }
            for axis in &mut channel.axes {
                axis.gains.clear();
                for polynomial in &mut axis.polynomials {
                    polynomial.r = [0.0; Terms::RATE];
                    polynomial.s = [0.0; Terms::LAG];
                }
            }
        }
        part.settings.model = Model::Static;
        part.seal();
        (part.table_crc32 != self.table_crc32).then_some(part)
    }

    /// Reads a set from the text of `coefficients.json`.
    ///
    /// # Errors
    /// Says what is wrong and what was expected: not the format, another version, a number out of
    /// its range, a table that the core refuses or that is not the one of the polynomials, or a CRC
    /// that does not belong to the numbers.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let expected = |error: serde_json::Error| {
            format!(
                "line {}, column {}: {error}; expected a coefficient set written by `tempco fit`",
                error.line(),
                error.column()
            )
        };
        let set: Self = match version1::converted(text)? {
            Some(converted) => {
                // A place in the converted text is of no use to anyone.
                let mut set: Self = serde_json::from_str(&converted).map_err(|error| {
                    let place = format!(" at line {} column {}", error.line(), error.column());
                    let error = error.to_string().replace(&place, "");
                    format!("{error}; expected a coefficient set of version 1")
                })?;
                // Version 1 had the CRC of the tables only.
                set.set_crc32 = format!("{:08x}", set.polynomial_crc32());
                set
            }
            None => serde_json::from_str(text).map_err(expected)?,
        };
        set.check()?;
        Ok(set)
    }

    /// The text of `coefficients.json`.
    ///
    /// # Panics
    /// Never: all keys are texts.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("keys that are texts") + "\n"
    }

    /// CRC-32P4 over the numbers of all tables.
    pub fn crc32(&self) -> u32 {
        table::crc32(self.channels.iter().map(|channel| &channel.table))
    }

    /// CRC-32P4 over what makes the tables and their use: the numbers of all polynomials in f64,
    /// little-endian, then scale factor and mappings as in `coefficients.json`, without blanks.
    pub(crate) fn polynomial_crc32(&self) -> u32 {
        let mut digest = CRC.digest();
        let polynomials = self.axes().flat_map(|(_, axis)| &axis.polynomials);
        for of in polynomials {
            let coefficients = of.a.iter().chain(&of.r).chain(&of.s);
            for value in [of.centre_c, of.half_width_c].iter().chain(coefficients) {
                digest.update(&value.to_le_bytes());
            }
        }
        let mappings = self.provenance.inputs.iter().map(|input| &input.mapping);
        let rest = (
            self.settings.scale_factor_arcsec,
            mappings.collect::<Vec<_>>(),
        );
        let text = serde_json::to_string(&rest).expect("keys that are texts");
        digest.update(text.as_bytes());
        digest.finalize()
    }

    /// Writes both CRCs, of the numbers as they are.
    pub fn seal(&mut self) {
        self.table_crc32 = format!("{:08x}", self.crc32());
        self.set_crc32 = format!("{:08x}", self.polynomial_crc32());
    }

    /// Time between two temperatures when the set is run over a log whose rows are `interval_s` apart
    /// \[s\].
    pub fn thermal_period_s(&self, interval_s: f64) -> f64 {
        thermal_period_s(interval_s).max(self.settings.thermal_period_s)
    }

    /// All axes, channel by channel, each with the position of its channel.
    pub fn axes(&self) -> impl Iterator<Item = (usize, &AxisSet)> {
        let channels = self.channels.iter().enumerate();
        channels
            .flat_map(|(position, channel)| channel.axes.iter().map(move |axis| (position, axis)))
    }
}

impl ChannelSet {
    /// The segments as a checked list.
    ///
    /// # Errors
    /// Segments that no fit makes; not in a set that was read.
    pub fn segmentation(&self) -> Result<Segmentation, SegmentError> {
        let ranges = self.segments.iter().map(SegmentSet::range);
        Segmentation::new(ranges.collect())
    }

    /// The axes whose bias is taken out as its change about a temperature, and that temperature, in
    /// a sentence; none without accelerometers.
    pub fn about_reference(&self) -> Option<String> {
        let accelerometers = self.axes.iter().filter(|axis| axis.reference_c.is_some());
        let names: Vec<&str> = accelerometers.clone().map(|axis| &axis.name[..]).collect();
        let reference_c = accelerometers.filter_map(|axis| axis.reference_c).next()?;
        Some(format!(
            "{}: the change about {reference_c:.1} degC is taken out, so that gravity stays",
            names.join(", ")
        ))
    }

    /// How far neighbouring segments disagree, for one axis.
    pub fn mismatches(&self, axis: usize) -> Vec<Mismatch> {
        self.segmentation().map_or_else(
            |_| Vec::new(),
            |segmentation| mismatches(&segmentation, &self.axes[axis].polynomials),
        )
    }

    /// Whether a mismatch of an axis raises the alarm.
    pub fn mismatch_alarm(&self, axis: usize) -> bool {
        let limit = MISMATCH_ALARM * self.table.static_range(axis);
        self.mismatches(axis)
            .iter()
            .any(|mismatch| mismatch.overlap_mismatch > limit)
    }
}
