//! What is wrong with the signals of a log, of one that was fitted or of one that is evaluated.

use tempco_log::signals::{Fault, Finding};
use tempco_set::{Rejection, RejectionCode, Warning, WarningCode};

/// Smaller shares of a log are given as a number of rows.
const LEAST_SHARE: f64 = 1e-3;

/// What a fault means for a set.
enum Code {
    Rejects(RejectionCode),
    Warns(WarningCode),
}

/// The code of a fault, and what to do in a few words.
const fn meaning(fault: Fault) -> (Code, &'static str) {
    use Code::{Rejects, Warns};
    match fault {
        Fault::FullScale => (
            Rejects(RejectionCode::FullScale),
            "exclude these times, or measure within the range",
        ),
        Fault::IdenticalValues => (
            Rejects(RejectionCode::IdenticalValues),
            "exclude these times, or leave out the axis",
        ),
        Fault::FrozenTemperature => (
            Rejects(RejectionCode::FrozenTemperature),
            "exclude these times, or check the sensor",
        ),
        Fault::RunningTotal => (
            Rejects(RejectionCode::RunningTotal),
            "log the difference from row to row",
        ),
        Fault::TemperatureJump => (
            Rejects(RejectionCode::TemperatureJump),
            "check how the temperature is converted",
        ),
        Fault::AlternatingSources => (
            Rejects(RejectionCode::AlternatingSources),
            "write a log for each source",
        ),
        Fault::StandingTemperature => (
            Warns(WarningCode::StandingTemperature),
            "check the sensor, and exclude these times if it hung",
        ),
        Fault::Fahrenheit => (
            Warns(WarningCode::Fahrenheit),
            "convert to degC if it is degF",
        ),
    }
}

/// Rejections and warnings of the findings in the log `file`; `is_axis` says which columns are axes.
pub(super) fn reasons(
    file: &str,
    findings: &[Finding],
    is_axis: impl Fn(&str) -> bool,
) -> (Vec<Rejection>, Vec<Warning>) {
    let (mut rejections, mut warnings) = (Vec::new(), Vec::new());
    for finding in findings {
        let (code, action) = meaning(finding.fault);
        let found = format!("{}; {action}", place(file, finding));
        let column = &finding.column;
        let axis = is_axis(column).then(|| column.clone());
        let message = match axis {
            Some(_) => format!("axis {column}: {found}"),
            None => format!("{column}: {found}"),
        };
        match code {
            Code::Rejects(code) => rejections.push(Rejection {
                code,
                axis,
                message,
            }),
            Code::Warns(code) => warnings.push(Warning {
                code,
                axis,
                message,
            }),
        }
    }
    (rejections, warnings)
}

fn place(file: &str, finding: &Finding) -> String {
    let Finding {
        rows,
        share,
        from_s,
        to_s,
        detail,
        ..
    } = finding;
    let much = match *share < LEAST_SHARE {
        true => format!("{rows} rows"),
        false => format!("{:.1} % of the rows", 100.0 * share),
    };
    format!("{file}: {detail}; {much}, from {from_s:.1} to {to_s:.1} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_names_axis_share_times_and_what_to_do() {
        let finding = |fault, column: &str, rows| Finding {
            fault,
            column: column.to_owned(),
            rows,
            share: rows as f64 / 22500.0,
            from_s: 1500.2,
            to_s: 1859.8,
            detail: "the value is 0 for 360 s on end".to_owned(),
        };
        let findings = [
            finding(Fault::IdenticalValues, "gy", 1798),
            finding(Fault::Fahrenheit, "temp_c", 20),
        ];
        let (rejections, warnings) = reasons("a.csv", &findings, |column| column == "gy");
        let [rejection] = &rejections[..] else {
            panic!("{rejections:?}");
        };
        assert_eq!(rejection.code, RejectionCode::IdenticalValues);
        assert_eq!(rejection.axis.as_deref(), Some("gy"));
        assert_eq!(
            rejection.message,
            "axis gy: a.csv: the value is 0 for 360 s on end; 8.0 % of the rows, from 1500.2 to \
             1859.8 s; exclude these times, or leave out the axis"
        );
        let [warning] = &warnings[..] else {
            panic!("{warnings:?}");
        };
        assert_eq!(
            (warning.code, &warning.axis),
            (WarningCode::Fahrenheit, &None)
        );
        assert!(
            warning.message.starts_with("temp_c: a.csv: "),
            "{warning:?}"
        );
        assert!(warning.message.contains("; 20 rows, from "), "{warning:?}");
    }
}
