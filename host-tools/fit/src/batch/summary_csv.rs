//! The summary of a batch as CSV: a row per unit and axis, for reading by machines.

use tempco_set::{Judgement, escape};

use super::outcome::AxisResult;
use super::summary::Summary;

/// The columns.
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

impl Summary {
    /// One row per unit and axis; one row of a unit that failed.
    fn rows(&self) -> Vec<[String; HEADER.len()]> {
        let mut rows = Vec::new();
        for (number, unit) in self.units().iter().enumerate() {
            let outlier = if self.is_outlier(number) { "yes" } else { "no" };
            let mut row: [String; HEADER.len()] = Default::default();
            row[0].clone_from(&unit.serial);
            row[1] = self.verdict(number).to_owned();
            row[3] = unit.logs.to_string();
            match &unit.result {
                Err(message) => {
                    row[13].clone_from(message);
                    rows.push(row);
                }
                Ok(result) => {
                    row[2] = outlier.to_owned();
                    row[4] = result.rows.to_string();
                    [row[13], row[14]] = reasons(&result.judgement);
                    for (position, axis) in result.axes.iter().enumerate() {
                        fill(&mut row, axis, self.scores((number, position)));
                        rows.push(row.clone());
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
        for row in self.rows() {
            let cells = row.iter().map(|cell| escape::csv_cell(cell));
            writer.write_record(cells).expect(cannot_fail);
        }
        writer.into_inner().expect(cannot_fail)
    }
}

fn fill(row: &mut [String; HEADER.len()], axis: &AxisResult, scores: [Option<f64>; 2]) {
    let score = |z: Option<f64>| z.map_or_else(String::new, |z| format!("{z:.2}"));
    row[5].clone_from(&axis.axis);
    row[6] = axis.unit.name().to_owned();
    row[7] = axis.n.to_string();
    let measured = axis.n > 1;
    for (cell, value) in [(8, axis.sigma_before), (9, axis.sigma_after)] {
        row[cell] = if measured {
            format!("{value:.4e}")
        } else {
            String::new()
        };
    }
    let improvement = axis.improvement();
    row[10] = improvement.map_or_else(String::new, |share| format!("{share:.4}"));
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

#[cfg(test)]
mod tests {
    use tempco_set::{Rejection, RejectionCode, Warning, WarningCode};

    use super::super::outcome::Outcome;
    use super::super::outcome::example::unit;
    use super::*;

    #[test]
    fn rows_are_of_units_and_axes() {
        let sigmas = [0.1, 0.11, 0.09, 0.105, 0.095, 0.9];
        let mut units: Vec<Outcome> = (0..)
            .zip(sigmas)
            .map(|(i, s)| unit(&format!("S{i}"), &[("x", s)]))
            .collect();
        units.push(Outcome {
            result: Err("a,b.csv:1: <no> \"column\"".to_owned()),
            ..unit("BAD", &[])
        });
        let summary = Summary::new(units);
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
    }

    #[test]
    fn texts_are_no_formulas() {
        let hostile = "=HYPERLINK(\"http://x\")<script>\u{1b}[2J\u{202e}";
        let mut units = vec![
            unit(hostile, &[("x", 0.1)]),
            unit("-1+1|x", &[("x", 0.1)]),
            unit("-5", &[("x", 2.0)]),
        ];
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
        let text = String::from_utf8(csv).unwrap();
        assert!(!text.contains(['\u{1b}', '\u{202e}', '\r', '\t']), "{text}");
    }

    #[test]
    fn what_is_judged_is_written_once() {
        let mut rejected = unit("S", &[("x", 0.1)]);
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
