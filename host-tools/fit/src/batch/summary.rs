//! The summary of a batch, as CSV and HTML.

use std::collections::BTreeMap;

use maud::{DOCTYPE, PreEscaped, html};
use tempco_set::{Judgement, Verdict, escape};

use super::figures::{AxisFigures, Outcome};
use super::outlier::{LEAST_UNITS, OUTLIER_Z, robust_z};

/// The columns of the summary, for reading by machines.
const HEADER: [&str; 15] = [
    "serial",
    "verdict",
    "outlier",
    "logs",
    "rows",
    "axis",
    "unit",
    "n",
    "sigma_before",
    "sigma_after",
    "improvement",
    "z_before",
    "z_after",
    "message",
    "codes",
];

/// Number of a unit, and of an axis in it.
type Place = (usize, usize);

/// All units of a batch, compared.
#[derive(Debug)]
pub struct Summary {
    units: Vec<Outcome>,
    /// For unit and axis, the robust z-scores of ln sigma before and after compensation.
    scores: BTreeMap<Place, [Option<f64>; 2]>,
}

impl Summary {
    /// Compares the units, axis by axis of the same name and unit.
    ///
    /// The scores are of ln sigma, since sigmas differ by factors: a unit that is ten times worse is
    /// as far off as one that is ten times better.
    pub fn new(units: Vec<Outcome>) -> Self {
        let mut scores: BTreeMap<Place, [Option<f64>; 2]> = BTreeMap::new();
        let figures: [fn(&AxisFigures) -> f64; 2] =
            [|axis| axis.sigma_before, |axis| axis.sigma_after];
        for (which, figure) in figures.into_iter().enumerate() {
            let mut groups: BTreeMap<(&str, &str), Vec<(Place, f64)>> = BTreeMap::new();
            for (place, axis) in all_axes(&units) {
                let value = figure(axis).ln();
                if value.is_finite() {
                    let group = groups.entry((&axis.axis, axis.unit)).or_default();
                    group.push((place, value));
                }
            }
            for group in groups.into_values() {
                let values: Vec<f64> = group.iter().map(|&(_, value)| value).collect();
                for ((place, _), z) in group.iter().zip(robust_z(&values).unwrap_or_default()) {
                    scores.entry(*place).or_default()[which] = Some(z);
                }
            }
        }
        Self { units, scores }
    }

    /// The units, in the order given.
    pub fn units(&self) -> &[Outcome] {
        &self.units
    }

    /// Whether every unit has an acceptable set.
    pub fn is_acceptable(&self) -> bool {
        let accepted = |of: &Outcome| {
            let figures = of.result.as_ref();
            figures.is_ok_and(|figures| figures.judgement.is_accepted())
        };
        self.units.iter().all(accepted)
    }

    /// The verdict on the set of a unit; `failed` without a set.
    pub fn verdict(&self, unit: usize) -> &'static str {
        let result = &self.units[unit].result;
        result
            .as_ref()
            .map_or("failed", |figures| figures.judgement.verdict().name())
    }

    /// Whether some robust z-score of the unit is beyond [`OUTLIER_Z`].
    pub fn is_outlier(&self, unit: usize) -> bool {
        let scores = self.scores.range((unit, 0)..(unit + 1, 0));
        let mut scores = scores.flat_map(|(_, scores)| scores.iter().flatten());
        scores.any(|z| z.abs() > OUTLIER_Z)
    }

    /// One row per unit and axis; one row of a unit that failed.
    fn rows(&self) -> Vec<(usize, [String; HEADER.len()])> {
        let mut rows = Vec::new();
        for (number, unit) in self.units.iter().enumerate() {
            let outlier = if self.is_outlier(number) { "yes" } else { "no" };
            let mut row: [String; HEADER.len()] = Default::default();
            row[0].clone_from(&unit.serial);
            row[1] = self.verdict(number).to_owned();
            row[3] = unit.logs.to_string();
            match &unit.result {
                Err(message) => {
                    row[13].clone_from(message);
                    rows.push((number, row));
                }
                Ok(figures) => {
                    row[2] = outlier.to_owned();
                    row[4] = figures.rows.to_string();
                    [row[13], row[14]] = reasons(&figures.judgement);
                    for (position, axis) in figures.axes.iter().enumerate() {
                        let scores = self.scores.get(&(number, position)).copied();
                        fill(&mut row, axis, scores.unwrap_or_default());
                        rows.push((number, row.clone()));
                    }
                }
            }
        }
        rows
    }

    /// The summary as CSV.
    pub fn csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let cannot_fail = "writing to memory cannot fail";
        writer.write_record(HEADER).expect(cannot_fail);
        for (_, row) in self.rows() {
            let cells = row.iter().map(|cell| escape::csv_cell(cell));
            writer.write_record(cells).expect(cannot_fail);
        }
        writer.into_inner().expect(cannot_fail)
    }

    /// The summary as a page that needs nothing else.
    pub fn html(&self) -> String {
        let count = |verdict: &str| {
            let units = 0..self.units.len();
            units.filter(|&unit| self.verdict(unit) == verdict).count()
        };
        let with_warnings = count(Verdict::AcceptedWithWarnings.name());
        let accepted = count(Verdict::Accepted.name()) + with_warnings;
        let rejected = count(Verdict::Rejected.name());
        let outliers = (0..self.units.len()).filter(|&unit| self.is_outlier(unit));
        let units = self.units.len();
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    title { "tempco: " (units) " units" }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (units) " units" }
                    p { (accepted) " accepted, " (with_warnings) " of them with warnings; "
                        (rejected) " rejected, " (count("failed")) " failed; "
                        (outliers.count()) " outliers." }
                    p { "Sigma: standard deviation of means on the fitted logs. Outlier: |z| of ln "
                        "sigma, before or after compensation, above " (OUTLIER_Z) ", where z is the "
                        "distance from the median of all units in 1.4826 median absolute "
                        "deviations; from " (LEAST_UNITS) " units on." }
                    table {
                        tr { @for name in HEADER { th { (name.replace('_', " ")) } } }
                        @for (unit, row) in self.rows() {
                            tr class={ (self.verdict(unit))
                                @if self.is_outlier(unit) { " outlier" } } {
                                @for cell in row { td { (escape::line(&cell)) } }
                            }
                        }
                    }
                }
            }
        };
        page.into_string() + "\n"
    }
}

fn all_axes(units: &[Outcome]) -> impl Iterator<Item = (Place, &AxisFigures)> {
    let units = units.iter().enumerate();
    units.flat_map(|(number, unit)| {
        let axes = unit.result.iter().flat_map(|figures| &figures.axes);
        axes.enumerate()
            .map(move |(position, axis)| ((number, position), axis))
    })
}

fn fill(row: &mut [String; HEADER.len()], axis: &AxisFigures, scores: [Option<f64>; 2]) {
    let score = |z: Option<f64>| z.map_or_else(String::new, |z| format!("{z:.2}"));
    row[5].clone_from(&axis.axis);
    row[6] = axis.unit.to_owned();
    row[7] = axis.n.to_string();
    let measured = axis.n > 1;
    for (cell, value) in [(8, axis.sigma_before), (9, axis.sigma_after)] {
        row[cell] = if measured {
            format!("{value:.4e}")
        } else {
            String::new()
        };
    }
    let improvement = 1.0 - axis.sigma_after / axis.sigma_before;
    row[10] = match measured && improvement.is_finite() {
        true => format!("{improvement:.4}"),
        false => String::new(),
    };
    row[11] = score(scores[0]);
    row[12] = score(scores[1]);
}

/// What rejects a set and what it warns of: the messages, and the codes without repetition.
fn reasons(judgement: &Judgement) -> [String; 2] {
    let rejections = judgement.rejections.iter();
    let rejections = rejections.map(|of| (of.code.name(), &of.message));
    let warnings = judgement.warnings.iter();
    let warnings = warnings.map(|of| (of.code.name(), &of.message));
    let (mut codes, messages): (Vec<_>, Vec<_>) = rejections
        .chain(warnings)
        .map(|(code, message)| (code, message.as_str()))
        .unzip();
    codes.sort_unstable();
    codes.dedup();
    [messages.join("; "), codes.join("; ")]
}

const STYLE: &str = "body{font:14px sans-serif;margin:2em}table{border-collapse:collapse}\
    th,td{border:1px solid #ccc;padding:.2em .5em;text-align:left}\
    .rejected td{background:#fff3cd}.failed td{background:#f8d7da}\
    .outlier td:nth-child(3){font-weight:bold;color:#b00}";

#[cfg(test)]
mod tests {
    use tempco_set::{Rejection, RejectionCode, Warning, WarningCode};

    use super::super::figures::UnitFigures;
    use super::*;

    fn unit(serial: &str, sigma_after: f64) -> Outcome {
        let axis = AxisFigures {
            axis: "x".to_owned(),
            unit: "dph",
            n: 50,
            sigma_before: 1.0,
            sigma_after,
        };
        Outcome {
            serial: serial.to_owned(),
            logs: 1,
            result: Ok(UnitFigures {
                rows: 100,
                axes: vec![axis],
                judgement: Judgement::default(),
            }),
        }
    }

    #[test]
    fn the_far_unit_and_the_bad_one_stand_out() {
        let sigmas = [0.1, 0.11, 0.09, 0.105, 0.095, 0.9];
        let mut units: Vec<Outcome> = (0..)
            .zip(sigmas)
            .map(|(i, s)| unit(&format!("S{i}"), s))
            .collect();
        units.push(Outcome {
            result: Err("a,b.csv:1: <no> \"column\"".to_owned()),
            ..unit("BAD", 0.0)
        });
        let summary = Summary::new(units);
        let outliers: Vec<usize> = (0..7).filter(|&unit| summary.is_outlier(unit)).collect();
        assert_eq!(outliers, [5]);
        assert!(!summary.is_acceptable());

        let csv = String::from_utf8(summary.csv()).unwrap();
        assert_eq!(csv.lines().count(), 1 + 7);
        assert!(
            csv.lines()
                .nth(6)
                .unwrap()
                .starts_with("S5,accepted,yes,1,100,x,dph,50,1.0000e0,9.0000e-1,0.1000,0.00,")
        );
        assert!(
            csv.ends_with("BAD,failed,,1,,,,,,,,,,\"a,b.csv:1: <no> \"\"column\"\"\",\n"),
            "{csv}"
        );
        let html = summary.html();
        assert!(
            html.contains("6 accepted, 0 of them with warnings; 0 rejected, 1 failed; 1 outliers.")
        );
        assert!(html.contains("a,b.csv:1: &lt;no&gt; &quot;column&quot;"));
    }

    #[test]
    fn texts_are_neither_formulas_nor_markup() {
        let hostile = "=HYPERLINK(\"http://x\")<script>\u{1b}[2J\u{202e}";
        let mut units = vec![unit(hostile, 0.1), unit("-1+1|x", 0.1), unit("-5", 2.0)];
        units[0].result.as_mut().unwrap().axes[0].axis = "@x".to_owned();
        units[1].result = Err("+cmd\r\n\t<img>".to_owned());
        let summary = Summary::new(units);
        let csv = summary.csv();
        let mut reader = csv::Reader::from_reader(&csv[..]);
        for cell in reader.records().flat_map(|row| {
            let row = row.unwrap();
            row.iter().map(str::to_owned).collect::<Vec<_>>()
        }) {
            assert!(
                !cell.starts_with(['=', '+', '-', '@', '\t', '\r']) || cell.parse::<f64>().is_ok(),
                "{cell}"
            );
        }
        let html = summary.html();
        assert!(
            !html.contains("<script") && !html.contains("<img"),
            "{html}"
        );
        for text in [&String::from_utf8(csv).unwrap(), &html] {
            assert!(!text.contains(['\u{1b}', '\u{202e}', '\r', '\t']), "{text}");
        }
    }

    #[test]
    fn what_is_judged_is_written_once() {
        let mut rejected = unit("S", 0.1);
        let judgement = &mut rejected.result.as_mut().unwrap().judgement;
        for axis in ["x", "y"] {
            let code = RejectionCode::SegmentsDisagree;
            judgement
                .rejections
                .push(Rejection::of_axis(code, axis, "segments disagree"));
        }
        judgement
            .warnings
            .push(Warning::new(WarningCode::Spikes, "3 rows".to_owned()));
        let summary = Summary::new(vec![rejected]);
        assert_eq!(
            (summary.verdict(0), summary.is_acceptable()),
            ("rejected", false)
        );
        assert!(!summary.is_outlier(0));
        let csv = String::from_utf8(summary.csv()).unwrap();
        let reasons = "axis x: segments disagree; axis y: segments disagree; 3 rows,\
                       segments_disagree; spikes\n";
        assert!(csv.ends_with(reasons), "{csv}");
    }
}
