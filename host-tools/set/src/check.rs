//! Checks of a set that was read: what the types cannot hold back.

use std::fmt::Display;
use std::ops::RangeInclusive;

use tempco::{Table, Terms};

use crate::history::MOST;
use crate::model::{AxisModel, horner};
use crate::segment::Overlap;
use crate::tabulate;
use crate::{
    AxisSet, AxisStatistics, Candidate, ChannelSet, CoefficientSet, CoefficientSigmas,
    FORMAT_VERSION, HeldOutErrors, NoiseSet, Screening, SegmentSet, Selection, TableData, TableUse,
    use_axis,
};

/// Angles per pulse that a gyro can have \[arcsec\].
pub const SCALE_FACTORS_ARCSEC: RangeInclusive<f64> = 1e-6..=1e6;

/// No figure of a set is larger.
const LARGEST: f64 = 1e30;
const ANY: RangeInclusive<f64> = -LARGEST..=LARGEST;
const AT_LEAST_0: RangeInclusive<f64> = 0.0..=LARGEST;

/// Shares and correlations may be beyond 1 by rounding.
const ONE: f64 = 1.0 + 1e-3;

/// Largest difference of a table from the polynomials, as a share of the axis's largest value: that
/// of some roundings in f32.
const ROUNDING: f64 = 4e-6;

/// A number in its range, or a message with its key.
fn within(key: impl Display, value: f64, range: RangeInclusive<f64>) -> Result<(), String> {
    if range.contains(&value) {
        return Ok(());
    }
    let (low, high) = range.into_inner();
    Err(format!("{key} is {value:?}: expected {low:?} to {high:?}"))
}

/// Numbers with their names in `parent`, all in one range.
fn all_within(
    parent: &str,
    numbers: &[(&str, f64)],
    range: &RangeInclusive<f64>,
) -> Result<(), String> {
    let mut numbers = numbers.iter();
    numbers.try_for_each(|(name, value)| {
        within(format_args!("{parent}.{name}"), *value, range.clone())
    })
}

/// Numbers of a list, all in one range.
fn all_in(
    parent: &str,
    name: &str,
    list: &[f64],
    range: &RangeInclusive<f64>,
) -> Result<(), String> {
    let mut list = list.iter().enumerate();
    list.try_for_each(|(i, value)| {
        within(format_args!("{parent}.{name}[{i}]"), *value, range.clone())
    })
}

impl CoefficientSet {
    /// Checks what the types cannot.
    pub(crate) fn check(&self) -> Result<(), String> {
        if self.format != "tempco-coefficients" || self.format_version != FORMAT_VERSION {
            return Err(format!(
                "format {} version {}: expected tempco-coefficients version {FORMAT_VERSION}",
                self.format, self.format_version
            ));
        }
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
                let terms = channel.table.plays.len() + channel.table.slow_parts.len();
                if axis.gains.len() != terms {
                    return Err(format!(
                        "axis {} has {} gains for {terms} plays and second thermal lags",
                        axis.name,
                        axis.gains.len()
                    ));
                }
            }
            let history =
                |channel: &ChannelSet| (channel.table.plays.len(), channel.table.slow_parts.len());
            if history(channel) != history(&self.channels[0]) {
                return Err(
                    "the temperature channels have different numbers of plays or second \
                            thermal lags"
                        .to_owned(),
                );
            }
            channel
                .table
                .check(axes)
                .map_err(|error| error.to_string())?;
        }
        let crc = self.crc32();
        if self.table_crc32 != format!("{crc:08x}") {
            return Err(format!(
                "the CRC of the tables is {crc:08x}, but the file says {}: it was damaged or \
                 changed by hand",
                self.table_crc32
            ));
        }
        self.check_numbers()?;
        for (number, channel) in self.channels.iter().enumerate() {
            channel.check_agreement(&format!("channels[{number}]"), self.settings.overlap)?;
        }
        Ok(())
    }

    fn check_numbers(&self) -> Result<(), String> {
        if let Some(scale_factor) = self.settings.scale_factor_arcsec {
            let key = "settings.scale_factor_arcsec";
            within(key, scale_factor, SCALE_FACTORS_ARCSEC)?;
        }
        for (number, input) in self.provenance.inputs.iter().enumerate() {
            let key = format!("provenance.inputs[{number}]");
            let times = [
                ("interval_s", input.interval_s),
                ("duration_s", input.duration_s),
            ];
            all_within(&key, &times, &AT_LEAST_0)?;
        }
        for (number, sign_off) in self.sign_offs.iter().enumerate() {
            let key = format!("sign_offs[{number}].tau_s");
            within(key, sign_off.tau_s, AT_LEAST_0)?;
        }
        for (number, channel) in self.channels.iter().enumerate() {
            channel.check_numbers(&format!("channels[{number}]"))?;
        }
        Ok(())
    }
}

impl ChannelSet {
    fn check_numbers(&self, key: &str) -> Result<(), String> {
        let of_table = [
            ("table_deviation", self.table_deviation),
            ("boundary_moved_c", self.boundary_moved_c),
        ];
        all_within(key, &of_table, &AT_LEAST_0)?;
        for (number, segment) in self.segments.iter().enumerate() {
            segment.check(&format!("{key}.segments[{number}]"))?;
        }
        for (number, axis) in self.axes.iter().enumerate() {
            axis.check(&format!("{key}.axes[{number}]"), (self, number))?;
        }
        if let Some(screening) = &self.screening {
            screening.check(&format!("{key}.screening"))?;
        }
        if let Some(selection) = &self.selection {
            selection.check(&format!("{key}.selection"))?;
        }
        Ok(())
    }

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
        let rates = (
            f64::from(table.thermal.rate_min_c_per_min),
            f64::from(table.thermal.rate_max_c_per_min),
        );
        let made = tabulate::in_cells(table.cells.len(), &segmentation, &axes, rates);
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
        let (plays, slow_parts) = MOST;
        if self.plays.len() > plays || self.slow_parts.len() > slow_parts {
            return Err(format!(
                "{} plays and {} second thermal lags: expected {plays} and {slow_parts} at most",
                self.plays.len(),
                self.slow_parts.len()
            ));
        }
        let gains = self.plays.iter().map(|play| &play.gain);
        let mut gains = gains.chain(self.slow_parts.iter().map(|part| &part.gain));
        if gains.any(|gain| gain.len() != axes) {
            return Err(format!(
                "a play or second thermal lag does not have {axes} gains"
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

    fn with<const CHANNELS: usize, const AXES: usize, const PLAYS: usize, const SLOW: usize>(
        self,
        _: &[Table<AXES, PLAYS, SLOW>; CHANNELS],
    ) {
    }
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

impl SegmentSet {
    fn check(&self, key: &str) -> Result<(), String> {
        within(format_args!("{key}.condition"), self.condition, AT_LEAST_0)?;
        let Some(coverage) = &self.coverage else {
            return Ok(());
        };
        let key = format!("{key}.coverage");
        let (slowest, fastest) = (coverage.rate_min_c_per_min, coverage.rate_max_c_per_min);
        let sizes = [
            ("time_s", coverage.time_s),
            (
                "rate_independent_c_per_min",
                coverage.rate_independent_c_per_min,
            ),
        ];
        all_within(&key, &sizes, &AT_LEAST_0)?;
        within(format_args!("{key}.width"), coverage.width, 0.0..=ONE)?;
        within(format_args!("{key}.rate_min_c_per_min"), slowest, ANY)?;
        within(
            format_args!("{key}.rate_max_c_per_min"),
            fastest,
            slowest..=LARGEST,
        )
    }
}

impl AxisSet {
    /// Checks an axis by its number in its channel.
    fn check(&self, key: &str, place: (&ChannelSet, usize)) -> Result<(), String> {
        let (channel, _) = place;
        let polynomials = self.polynomials.iter().zip(&channel.segments);
        for (number, (polynomial, segment)) in polynomials.enumerate() {
            let key = format!("{key}.polynomials[{number}]");
            let segment = segment.range();
            let places = [
                ("centre_c", polynomial.centre_c, segment.centre_c()),
                (
                    "half_width_c",
                    polynomial.half_width_c,
                    segment.half_width_c(),
                ),
            ];
            for (name, found, expected) in places {
                within(
                    format_args!("{key}.{name}"),
                    found,
                    expected - 1e-6..=expected + 1e-6,
                )?;
            }
            all_in(&key, "a", &polynomial.a, &ANY)?;
            all_in(&key, "r", &polynomial.r, &ANY)?;
        }
        let (sigmas, segments) = (self.sigmas.len(), channel.segments.len());
        if sigmas != 0 && sigmas != segments {
            return Err(format!(
                "{key}.sigmas: {sigmas} for {segments} segments: expected one for each, or none"
            ));
        }
        for (number, sigmas) in self.sigmas.iter().enumerate() {
            sigmas.check(&format!("{key}.sigmas[{number}]"))?;
        }
        self.check_gains(key, place)?;
        if let Some(NoiseSet { white, walk }) = self.noise {
            let noise = [("white", white), ("walk", walk)];
            all_within(&format!("{key}.noise"), &noise, &AT_LEAST_0)?;
        }
        if let Some(held_out) = &self.held_out {
            held_out.check(&format!("{key}.held_out"))?;
        }
        if let Some(statistics) = &self.statistics {
            statistics.check(&format!("{key}.statistics"))?;
        }
        Ok(())
    }

    /// The gains are those of the table, of which there are as many.
    fn check_gains(&self, key: &str, (channel, axis): (&ChannelSet, usize)) -> Result<(), String> {
        let table = &channel.table;
        let of_table = table.plays.iter().map(|play| &play.gain);
        let of_table = of_table.chain(table.slow_parts.iter().map(|part| &part.gain));
        for (number, (gain, of_table)) in self.gains.iter().zip(of_table).enumerate() {
            let key = format!("{key}.gains[{number}]");
            within(format_args!("{key}.sigma"), gain.sigma, AT_LEAST_0)?;
            let expected = of_table[axis];
            if gain.gain as f32 != expected {
                return Err(format!(
                    "{key}.gain is {:?}: expected {expected:?}, the gain in the table",
                    gain.gain
                ));
            }
        }
        Ok(())
    }
}

impl CoefficientSigmas {
    fn check(&self, key: &str) -> Result<(), String> {
        all_in(key, "a", &self.a, &AT_LEAST_0)?;
        all_in(key, "r", &self.r, &AT_LEAST_0)?;
        let rows = self.correlation.iter();
        rows.enumerate().try_for_each(|(row, values)| {
            all_in(key, &format!("correlation[{row}]"), values, &(-ONE..=ONE))
        })
    }
}

impl HeldOutErrors {
    fn check(&self, key: &str) -> Result<(), String> {
        let errors = [
            ("none", Some(self.none)),
            ("cubic", self.cubic),
            ("static", self.static_model),
            ("composite", self.composite),
            ("chosen", self.chosen),
        ];
        let errors = errors.into_iter();
        let found: Vec<_> = errors
            .filter_map(|(name, error)| Some((name, error?)))
            .collect();
        all_within(key, &found, &AT_LEAST_0)
    }
}

impl AxisStatistics {
    fn check(&self, key: &str) -> Result<(), String> {
        let figures = [
            ("rmse_raw", self.rmse_raw),
            ("rmse_cubic", self.rmse_cubic),
            ("rmse_compensated", self.rmse_compensated),
            ("tau_s", self.tau_s),
            ("sigma_raw", self.sigma_raw),
            ("sigma_cubic", self.sigma_cubic),
            ("sigma_compensated", self.sigma_compensated),
            ("serial_factor", self.serial_factor.unwrap_or(0.0)),
        ];
        all_within(key, &figures, &AT_LEAST_0)
    }
}

impl Screening {
    fn check(&self, key: &str) -> Result<(), String> {
        for (number, step) in self.steps.iter().enumerate() {
            let step_key = format!("{key}.steps[{number}]");
            all_within(
                &step_key,
                &[("time_s", step.time_s), ("size", step.size)],
                &ANY,
            )?;
        }
        let logs = self.constants.iter().enumerate();
        logs.into_iter()
            .try_for_each(|(log, values)| all_in(key, &format!("constants[{log}]"), values, &ANY))
    }
}

impl Selection {
    fn check(&self, key: &str) -> Result<(), String> {
        let rates = &self.ramp_rates_c_per_min;
        all_in(key, "ramp_rates_c_per_min", rates, &AT_LEAST_0)?;
        self.chosen.check(&format!("{key}.chosen"))?;
        let others = self.others.iter().enumerate();
        others
            .into_iter()
            .try_for_each(|(number, other)| other.check(&format!("{key}.others[{number}]")))
    }
}

impl Candidate {
    fn check(&self, key: &str) -> Result<(), String> {
        let sizes = [
            ("tau_s", self.tau_s),
            ("slow_tau_s", self.slow_tau_s.unwrap_or(0.0)),
            ("excess_sigma", self.excess_sigma),
        ];
        all_within(key, &sizes, &AT_LEAST_0)?;
        all_within(key, &[("kappa", self.kappa), ("excess", self.excess)], &ANY)?;
        all_in(key, "half_widths_c", &self.half_widths_c, &AT_LEAST_0)?;
        all_in(key, "rmse", &self.rmse, &AT_LEAST_0)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::{Value, json};

    use crate::import::static_coefficients;
    use crate::{CoefficientSet, Coverage, GainSet, NoiseSet, PlayData, SignOff};

    const PRINTED: &str = "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
         X,1,-15,40,0.0173,-0.0014,0.00001\nX,2,30,80,0.0173,-0.0014,0.00002\n";

    /// A set in which as many numbers as can be are there.
    fn example() -> Value {
        let mut set = static_coefficients(Path::new("printed.csv"), PRINTED).unwrap();
        set.settings.scale_factor_arcsec = Some(0.5);
        set.sign_offs = vec![SignOff {
            file: String::new(),
            sha256: String::new(),
            judged: String::new(),
            tau_s: 100.0,
            accepted: true,
            worse_axes: Vec::new(),
            warnings: Vec::new(),
        }];
        let channel = &mut set.channels[0];
        channel.segments[0].coverage = Some(Coverage {
            time_s: 1.0,
            width: 1.0,
            rate_min_c_per_min: -1.0,
            rate_max_c_per_min: 1.0,
            rate_independent_c_per_min: 0.5,
        });
        channel.table.plays = vec![PlayData {
            half_width_c: 2.5,
            gain: vec![0.1],
        }];
        let axis = &mut channel.axes[0];
        axis.gains = vec![GainSet {
            gain: 0.1,
            sigma: 0.01,
        }];
        axis.noise = Some(NoiseSet {
            white: 0.1,
            walk: 0.2,
        });
        set.table_crc32 = format!("{:08x}", set.crc32());
        let mut value = serde_json::to_value(&set).unwrap();
        let axis = &mut value["channels"][0]["axes"][0];
        let sigmas = json!({"a": [0.1, 0.1, 0.1], "r": [0.0, 0.0]});
        axis["sigmas"] = json!([sigmas, sigmas]);
        axis["held_out"] = json!({"legs": 1, "folds": 1, "none": 1.0, "cubic": 1.0, "static": 1.0,
            "composite": 1.0, "chosen": 1.0});
        axis["statistics"] = json!({"rows": 1, "rmse_raw": 1.0, "rmse_cubic": 1.0,
            "rmse_compensated": 1.0, "tau_s": 100.0, "n": 1, "sigma_raw": 1.0, "sigma_cubic": 1.0,
            "sigma_compensated": 1.0, "serial_factor": 1.0});
        let candidate = json!({"model": "spline", "segments": 1, "place": "given",
            "rate_columns": 1, "columns": 1, "tau_s": 60.0, "kappa": -1.0, "half_widths_c": [1.0],
            "slow_tau_s": 900.0, "rmse": [1.0], "excess": -0.5, "excess_sigma": 0.1});
        let channel = &mut value["channels"][0];
        channel["screening"] = json!({"excluded_rows": 0, "spike_rows": 0, "disturbed_rows": 0,
            "steps": [{"file": "", "axis": "x", "time_s": 1.0, "size": -1.0}],
            "constants": [[-0.5], [0.5]]});
        channel["selection"] = json!({"legs": 1, "folds": 1, "ramp_rates_c_per_min": [1.0],
            "chosen": candidate, "others": [candidate]});
        value
    }

    fn read(value: &Value) -> Result<CoefficientSet, String> {
        CoefficientSet::from_json(&value.to_string())
    }

    /// JSON pointers of all numbers.
    fn numbers(value: &Value, at: &str, found: &mut Vec<String>) {
        match value {
            Value::Number(_) => found.push(at.to_owned()),
            Value::Array(list) => {
                for (number, value) in list.iter().enumerate() {
                    numbers(value, &format!("{at}/{number}"), found);
                }
            }
            Value::Object(fields) => {
                for (name, value) in fields {
                    numbers(value, &format!("{at}/{name}"), found);
                }
            }
            _ => {}
        }
    }

    #[test]
    fn every_number_has_a_range() {
        let good = example();
        read(&good).unwrap();
        let mut found = Vec::new();
        numbers(&good, "", &mut found);
        assert!(found.len() > 100, "{}", found.len());
        for at in found {
            for absurd in [-1e300, 1e300] {
                let mut bad = good.clone();
                *bad.pointer_mut(&at).unwrap() = absurd.into();
                let error = read(&bad).expect_err(&at);
                assert!(
                    error.contains("xpected") || error.contains("CRC") || error.contains("range"),
                    "{at}: {error}"
                );
            }
        }
    }

    #[test]
    fn the_key_and_what_was_expected_are_named() {
        for (at, value, message) in [
            (
                "/settings/scale_factor_arcsec",
                -1.0,
                "settings.scale_factor_arcsec is -1.0: expected 1e-6 to 1000000.0",
            ),
            (
                "/settings/scale_factor_arcsec",
                0.0,
                "settings.scale_factor_arcsec is 0.0: expected",
            ),
            (
                "/settings/scale_factor_arcsec",
                1e308,
                "settings.scale_factor_arcsec is 1e308: expected",
            ),
            (
                "/channels/0/segments/1/condition",
                -1.0,
                "channels[0].segments[1].condition is -1.0",
            ),
            (
                "/channels/0/axes/0/sigmas/1/a/2",
                -1.0,
                "channels[0].axes[0].sigmas[1].a[2] is -1.0",
            ),
            (
                "/channels/0/axes/0/gains/0/gain",
                0.2,
                "gains[0].gain is 0.2: expected 0.1, the gain in the table",
            ),
            (
                "/channels/0/axes/0/polynomials/1/centre_c",
                0.0,
                "polynomials[1].centre_c is 0.0",
            ),
            ("/channels/0/segments/0/t_min_c", -14.0, "expected"),
        ] {
            let mut bad = example();
            *bad.pointer_mut(at).unwrap() = value.into();
            let error = read(&bad).expect_err(at);
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn polynomials_that_contradict_the_table_are_refused_by_axis_and_cell() {
        for (part, place) in [("a", 0), ("a", 2), ("r", 0), ("r", 1)] {
            let mut bad = example();
            let polynomial = &mut bad["channels"][0]["axes"][0]["polynomials"][1];
            let number = &mut polynomial[part][place];
            *number = (number.as_f64().unwrap() + 1e-5).into();
            let error = read(&bad).unwrap_err();
            assert!(
                error.contains("channels[0].table: axis x, cell "),
                "{error}"
            );
            assert!(error.contains("pulses/s"), "{error}");
        }
        // Rounding is not a contradiction.
        let mut good = example();
        let number = &mut good["channels"][0]["axes"][0]["polynomials"][1]["a"][0];
        *number = (number.as_f64().unwrap() * (1.0 + 1e-8)).into();
        read(&good).unwrap();
    }
}
