//! One judge: every command gives a set the same verdict, for the same reasons.

use std::collections::BTreeSet;
use std::fs;

use serde_json::{Value, json};
use tempco_evaluate::judge;
use tempco_fit::batch::{Outcome, Summary, UnitResult};
use tempco_set::{CoefficientSet, RejectionCode, WarningCode};
use tempco_tests::Bench;

const ROWS: u32 = 2000;

/// Rows between 10 and 40 degC, twice up and down, with noise of up to 0.02 deg/h.
fn log(seed: u32, x: impl Fn(f64, u32) -> f64, y: impl Fn(f64, u32) -> f64) -> String {
    let mut log = String::from("time_s,temp_c,x_dph,y_dph\n");
    let mut random = seed;
    let mut noise = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.04 * (f64::from(random >> 8) / f64::from(1 << 24) - 0.5)
    };
    for row in 0..ROWS {
        let phase = f64::from(row) * std::f64::consts::TAU / f64::from(ROWS / 2);
        let temp_c = 25.0 - 15.0 * phase.cos();
        let (x, y) = (x(temp_c, row) + noise(), y(temp_c, row) + noise());
        log.push_str(&format!("{row},{temp_c:.3},{x:.4},{y:.4}\n"));
    }
    log
}

fn line(temp_c: f64, _row: u32) -> f64 {
    0.01 * temp_c
}

/// Rises twice over the range: the segments of its halves disagree in the middle. It leaps there,
/// which the screen takes for steps of the bias.
fn saw_tooth(temp_c: f64, _row: u32) -> f64 {
    0.02 * (temp_c - if temp_c < 25.0 { 10.0 } else { 25.0 })
}

fn turned(temp_c: f64, row: u32) -> f64 {
    -line(temp_c, row)
}

/// Verdict, whether it is verified, and the codes of its reasons.
type Said = (String, bool, BTreeSet<String>);

fn said(object: &Value) -> Said {
    let codes = ["rejections", "warnings"]
        .into_iter()
        .flat_map(|key| object[key].as_array().unwrap())
        .map(|reason| reason["code"].as_str().unwrap().to_owned());
    (
        object["verdict"].as_str().unwrap().to_owned(),
        object["verified"].as_bool().unwrap(),
        codes.collect(),
    )
}

/// The same from the page of a report.
fn said_on_page(page: &str) -> Said {
    let section = page.split("</section>").next().unwrap();
    let word = section.split("class=\"word\">").nth(1).unwrap();
    let codes = section.split("<code>").skip(1);
    (
        word.split('<').next().unwrap().replace(' ', "_"),
        section.contains("Verified on"),
        codes
            .map(|code| code.split('<').next().unwrap().to_owned())
            .collect(),
    )
}

/// Verdict and codes from a row of the summary of a batch.
fn said_in_summary(csv: &[u8], serial: &str) -> (String, BTreeSet<String>) {
    let mut reader = csv::Reader::from_reader(csv);
    let mut rows = reader.records().map(Result::unwrap);
    let row = rows.find(|row| &row[0] == serial).unwrap();
    let codes = row[14].split("; ").filter(|code| !code.is_empty());
    (row[1].to_owned(), codes.map(str::to_owned).collect())
}

struct Case {
    name: &'static str,
    /// The set that is changed: `line` or `saw`.
    set: &'static str,
    change: fn(&mut Value),
    /// The log it is evaluated on, which is signed off unless the set has a sign-off.
    log: &'static str,
    verified: bool,
    codes: &'static [&'static str],
}

const PLAIN: Case = Case {
    name: "plain",
    set: "line",
    change: |_| (),
    log: "verify.csv",
    verified: true,
    codes: &[],
};

fn statistics(set: &mut Value, figures: &[(&str, f64)]) {
    let axis = &mut set["channels"][0]["axes"][1]["statistics"];
    for (key, value) in figures {
        axis[key] = json!(value);
    }
}

fn held_out(set: &mut Value, figures: &[(&str, f64)]) {
    let axis = &mut set["channels"][0]["axes"][0]["held_out"];
    *axis = json!({"soaks_and_ramps": 4, "folds": 2, "none": 1.0, "cubic": 0.5, "static": 0.5,
        "composite": 0.5, "chosen": 0.5});
    for (key, value) in figures {
        axis[key] = json!(value);
    }
}

/// Another model that does better than the fitted one by more than one standard error.
fn surpassed(set: &mut Value, by: &str) {
    held_out(set, &[(by, 0.4)]);
    set["channels"][0]["axes"][0]["held_out"]["surpassed"] =
        json!({"by": by, "rmse": 0.4, "excess": 0.56, "excess_sigma": 0.2});
}

fn signed_off(accepted: bool, worse_axes: &[&str]) -> Value {
    json!({"file": "old.csv", "sha256": "00", "judged": "2020-01-01T00:00:00Z", "tau_s": 10.0,
        "accepted": accepted, "worse_axes": worse_axes})
}

fn chosen(model: &str, rate_columns: usize, rates: &[f64]) -> Value {
    json!({"soaks_and_ramps": 4, "folds": 2, "ramp_rates_c_per_min": rates, "others": [],
        "chosen": {"model": model, "segments": 2, "place": "uniform", "rate_columns": rate_columns,
            "columns": 7, "tau_s": 60.0, "kappa": 0.0, "rmse": [0.1, 0.1], "excess": 0.0,
            "excess_sigma": 0.1}})
}

const CASES: [Case; 47] = [
    PLAIN,
    Case {
        name: "segments that disagree",
        set: "saw",
        log: "saw.verify.csv",
        codes: &["segments_disagree"],
        ..PLAIN
    },
    Case {
        name: "rejected by an old sign-off",
        change: |set| set["sign_offs"] = json!([signed_off(false, &["x"])]),
        verified: false,
        codes: &["no_better_than_none"],
        ..PLAIN
    },
    Case {
        name: "rejected by an old sign-off that names no axis",
        change: |set| set["sign_offs"] = json!([signed_off(false, &[])]),
        verified: false,
        codes: &["no_better_than_none"],
        ..PLAIN
    },
    Case {
        name: "rejected once, then accepted",
        change: |set| {
            set["sign_offs"] = json!([signed_off(false, &["x"]), signed_off(true, &[])]);
        },
        ..PLAIN
    },
    Case {
        name: "worse on one axis of the log",
        log: "turned.csv",
        verified: false,
        codes: &["no_better_than_none", "trend_with_temperature"],
        ..PLAIN
    },
    Case {
        name: "worse on both axes of the log",
        log: "both.csv",
        verified: false,
        codes: &["no_better_than_none", "trend_with_temperature"],
        ..PLAIN
    },
    Case {
        name: "worse by rmse only",
        change: |set| statistics(set, &[("rmse_raw", 0.1), ("rmse_compensated", 0.2)]),
        codes: &["no_better_than_none"],
        ..PLAIN
    },
    Case {
        name: "worse by sigma only",
        change: |set| statistics(set, &[("sigma_raw", 0.1), ("sigma_compensated", 0.2)]),
        codes: &["no_better_than_none", "residual_above_noise"],
        ..PLAIN
    },
    Case {
        name: "neither better nor worse",
        change: |set| statistics(set, &[("rmse_raw", 0.1), ("rmse_compensated", 0.1)]),
        codes: &["no_better_than_none"],
        ..PLAIN
    },
    Case {
        name: "too short for means",
        change: |set| {
            statistics(set, &[("sigma_raw", 0.0), ("sigma_compensated", 0.0)]);
            set["channels"][0]["axes"][1]["statistics"]["n"] = json!(1);
        },
        ..PLAIN
    },
    Case {
        name: "thin",
        change: |set| set["channels"][0]["segments"][0]["coverage"]["width"] = json!(0.7),
        codes: &["thin_segment"],
        ..PLAIN
    },
    Case {
        name: "ill-conditioned",
        change: |set| set["channels"][0]["segments"][1]["condition"] = json!(1000.0),
        codes: &["ill_conditioned"],
        ..PLAIN
    },
    Case {
        name: "no help where it was left out",
        change: |set| held_out(set, &[("chosen", 1.0)]),
        codes: &["held_out_no_better"],
        ..PLAIN
    },
    Case {
        name: "a cubic is better where it was left out",
        change: |set| surpassed(set, "cubic"),
        codes: &["simpler_model_better"],
        ..PLAIN
    },
    Case {
        name: "a cubic is better where it was left out, within a standard error",
        change: |set| held_out(set, &[("cubic", 0.4)]),
        ..PLAIN
    },
    Case {
        name: "a cubic is better where it was left out, by less than 5 %",
        change: |set| {
            surpassed(set, "cubic");
            set["channels"][0]["axes"][0]["held_out"]["chosen"] = json!(0.42);
        },
        ..PLAIN
    },
    Case {
        name: "no help where it was left out, and a cubic is better",
        change: |set| {
            surpassed(set, "cubic");
            set["channels"][0]["axes"][0]["held_out"]["chosen"] = json!(1.0);
        },
        codes: &["held_out_no_better"],
        ..PLAIN
    },
    Case {
        name: "spikes",
        change: |set| set["channels"][0]["outliers"]["spike_rows"] = json!(7),
        codes: &["spikes"],
        ..PLAIN
    },
    Case {
        name: "rows left out",
        change: |set| {
            set["channels"][0]["outliers"]["excluded_rows"] = json!(7);
            set["channels"][0]["outliers"]["disturbed_rows"] = json!(7);
        },
        codes: &["disturbed_rows", "excluded_rows"],
        ..PLAIN
    },
    Case {
        name: "a step",
        change: |set| {
            let step = json!({"file": "a.csv", "axis": "x", "time_s": 9.0, "size": 1.0});
            set["channels"][0]["outliers"]["steps"] = json!([step]);
        },
        codes: &["bias_step"],
        ..PLAIN
    },
    Case {
        name: "a step beyond rest",
        change: |set| {
            let step = json!({"file": "a.csv", "axis": "x", "time_s": 9.0, "size": 1.0,
                "levelled": true, "large": true});
            set["channels"][0]["outliers"]["steps"] = json!([step]);
        },
        codes: &["bias_step", "large_bias_step"],
        ..PLAIN
    },
    Case {
        name: "too much that is disturbed",
        change: |set| {
            let place = json!({"file": "a.csv", "axis": "x", "rows": 9, "share": 0.04,
                "from_s": 1.0, "to_s": 9.0, "left_out": false});
            set["channels"][0]["outliers"]["disturbances"] = json!([place]);
        },
        codes: &["disturbed_share"],
        ..PLAIN
    },
    Case {
        name: "too many spikes",
        change: |set| {
            let place = json!({"file": "a.csv", "axis": "x", "rows": 99, "share": 0.06,
                "from_s": 1.0, "to_s": 9.0, "left_out": true});
            set["channels"][0]["outliers"]["spike_rows"] = json!(99);
            set["channels"][0]["outliers"]["spikes"] = json!([place]);
        },
        codes: &["disturbed_share", "spikes"],
        ..PLAIN
    },
    Case {
        name: "a thin run",
        change: |set| {
            set["channels"][0]["outliers"]["extent"] = json!({"covered_c": 12, "means": 59,
                "heated_c": 12.0, "cooled_c": 0.0, "too_fast": {"file": "a.csv",
                "rate_c_per_min": 40.0, "limit_c_per_min": 30.0, "share": 0.5, "from_s": 1.0,
                "to_s": 9.0}});
        },
        codes: &["fast_temperature", "few_means", "one_direction", "thin_run"],
        ..PLAIN
    },
    Case {
        name: "a residual far above the noise of rows",
        change: |set| {
            let residual = [("rmse_compensated", 0.05), ("sigma_compensated", 0.0499)];
            statistics(set, &residual);
            set["channels"][0]["axes"][1]["statistics"]["n"] = json!(10);
        },
        codes: &["residual_above_noise"],
        ..PLAIN
    },
    Case {
        name: "rows that were not usable",
        change: |set| set["provenance"]["inputs"][0]["unusable_rows"] = json!(3),
        codes: &["unusable_rows"],
        ..PLAIN
    },
    Case {
        name: "a boundary that was moved",
        change: |set| set["channels"][0]["boundary_moved_c"] = json!(0.02),
        codes: &["boundary_moved"],
        ..PLAIN
    },
    Case {
        name: "terms that were dropped",
        change: |set| set["settings"]["model"] = json!("composite"),
        codes: &["terms_dropped"],
        ..PLAIN
    },
    Case {
        name: "no rate terms",
        change: |set| set["channels"][0]["selection"] = chosen("static", 0, &[1.0, 2.0]),
        codes: &["no_rate_terms"],
        ..PLAIN
    },
    Case {
        name: "one rate, and axes without rate terms",
        change: |set| set["channels"][0]["selection"] = chosen("spline", 2, &[1.0]),
        codes: &["history_terms_not_tried", "rate_terms_dropped"],
        ..PLAIN
    },
    Case {
        name: "a lag that is too short to be one",
        change: |set| {
            set["channels"][0]["selection"] = chosen("spline", 2, &[1.0, 2.0]);
            set["channels"][0]["selection"]["chosen"]["tau_s"] = json!(11.0);
        },
        codes: &["rate_terms_dropped", "sensor_lags"],
        ..PLAIN
    },
    Case {
        name: "a second lag that runs ahead",
        change: |set| {
            set["channels"][0]["selection"] = chosen("spline", 2, &[1.0, 2.0]);
            set["channels"][0]["selection"]["chosen"]["kappa2"] = json!(-0.06);
        },
        codes: &["rate_terms_dropped", "sensor_lags"],
        ..PLAIN
    },
    Case {
        name: "a second lag that runs ahead of a first one that does not",
        change: |set| {
            set["channels"][0]["selection"] = chosen("spline", 2, &[1.0, 2.0]);
            set["channels"][0]["selection"]["chosen"]["kappa"] = json!(0.1);
            set["channels"][0]["selection"]["chosen"]["kappa2"] = json!(-0.06);
        },
        codes: &["rate_terms_dropped"],
        ..PLAIN
    },
    Case {
        name: "rounding that is not small",
        change: |set| statistics(set, &[("sigma_compensated", 1e-7)]),
        codes: &["rounding"],
        ..PLAIN
    },
    Case {
        name: "a residual that follows the temperature",
        log: "steeper.csv",
        verified: false,
        codes: &["trend_with_temperature"],
        ..PLAIN
    },
    Case {
        name: "a log beyond the segments",
        log: "beyond.csv",
        codes: &["flagged_rows", "residual_follows_temperature"],
        ..PLAIN
    },
    Case {
        name: "a log mostly beyond the segments",
        log: "far.csv",
        verified: false,
        codes: &["outside_calibrated_range"],
        ..PLAIN
    },
    Case {
        name: "worse where it was left out",
        change: |set| held_out(set, &[("chosen", 1.5), ("excess_sigma", 1.2)]),
        codes: &["held_out_worse"],
        ..PLAIN
    },
    Case {
        name: "worse where it was left out, within a standard error",
        change: |set| held_out(set, &[("chosen", 1.5), ("excess_sigma", 1.3)]),
        codes: &["held_out_no_better"],
        ..PLAIN
    },
    Case {
        name: "a little worse where it was left out",
        change: |set| held_out(set, &[("chosen", 1.2), ("excess_sigma", 0.1)]),
        codes: &["held_out_no_better"],
        ..PLAIN
    },
    Case {
        name: "terms that were left out",
        change: |set| held_out(set, &[("chosen", 1.0), ("left_out", 1.1)]),
        codes: &["constant_alone"],
        ..PLAIN
    },
    Case {
        name: "bad rows",
        change: |set| set["provenance"]["inputs"][0]["skipped"] = json!({"empty_cell": 110}),
        codes: &["too_many_bad_rows"],
        ..PLAIN
    },
    Case {
        name: "a few bad rows",
        change: |set| set["provenance"]["inputs"][0]["skipped"] = json!({"empty_cell": 90}),
        ..PLAIN
    },
    Case {
        name: "signals that were spoilt in the fitted log",
        change: |set| {
            let found = |fault: &str, column: &str| {
                json!({"fault": fault, "column": column, "rows": 9, "share": 0.1, "from_s": 1.0,
                    "to_s": 9.0, "detail": "it is so"})
            };
            set["provenance"]["inputs"][0]["findings"] =
                json!([found("full_scale", "x"), found("fahrenheit", "temp_c")]);
        },
        codes: &["fahrenheit", "full_scale"],
        ..PLAIN
    },
    Case {
        name: "doubts about how the fitted log was read",
        change: |set| {
            let doubt = |kind: &str| json!({"kind": kind, "detail": "it is so"});
            let kinds = ["own_correction", "time_restarts", "long_bursts"];
            set["provenance"]["inputs"][0]["doubts"] = json!(kinds.map(doubt));
        },
        codes: &["long_bursts", "own_correction", "time_restarts"],
        ..PLAIN
    },
    Case {
        name: "signals that are spoilt in the log",
        log: "dead.csv",
        verified: false,
        codes: &["identical_values"],
        ..PLAIN
    },
];

#[test]
fn a_set_is_judged_alike_by_all_commands() {
    let bench = Bench::new();
    bench.write("line.csv", &log(1, line, line));
    bench.write("saw.csv", &log(1, saw_tooth, line));
    for set in ["line", "saw"] {
        let fit = format!("fit {set}.csv --serial S1 --model static --tau 10 --out {set}");
        let options = "--segments 10:25.5,24.5:40 --keep-outliers --no-report";
        bench.run(&format!("{fit} {options}"));
    }
    bench.write("verify.csv", &log(2, line, line));
    bench.write("saw.verify.csv", &log(2, saw_tooth, line));
    bench.write("turned.csv", &log(2, turned, line));
    bench.write("both.csv", &log(2, turned, turned));
    bench.write("steeper.csv", &log(2, |t, _| 0.015 * t, line));
    let beyond = log(2, line, line);
    let hot = |row: &str| row.replacen(",39.", ",41.", 1);
    let beyond: Vec<String> = beyond.lines().map(hot).collect();
    bench.write("beyond.csv", &(beyond.join("\n") + "\n"));
    // Around the highest temperature, so that the values are about right.
    let dead = log(2, line, line);
    let dead = dead.lines().enumerate().map(|(row, text)| match row {
        450..550 => format!("{},0.4", text.rsplit_once(',').unwrap().0),
        _ => text.to_owned(),
    });
    let dead: Vec<String> = dead.collect();
    bench.write("dead.csv", &(dead.join("\n") + "\n"));
    // The bias stays as the table holds it beyond its range, so that nothing is left of it.
    let wider = |temp_c: f64| 25.0 + 1.4 * (temp_c - 25.0);
    let held = |temp_c: f64, row| line(wider(temp_c).clamp(10.0, 40.0), row);
    let mut far = String::new();
    for row in log(2, held, held).lines() {
        let cells: Vec<&str> = row.split(',').collect();
        let temp_c = cells[1].parse().map(wider);
        let temp_c = temp_c.map_or_else(|_| cells[1].to_owned(), |temp_c| temp_c.to_string());
        far += &format!("{},{temp_c},{},{}\n", cells[0], cells[2], cells[3]);
    }
    bench.write("far.csv", &far);

    for case in CASES {
        let name = case.name;
        let text = fs::read_to_string(bench.path(case.set).join("coefficients.json")).unwrap();
        let mut set: Value = serde_json::from_str(&text).unwrap();
        (case.change)(&mut set);
        bench.write("set.json", &set.to_string());
        if set.get("sign_offs").is_none() {
            bench.run(&format!(
                "evaluate set.json {} --tau 10 --sign-off",
                case.log
            ));
        }

        let ran = bench.run(&format!(
            "evaluate set.json {} --tau 10 --json --report page.html",
            case.log
        ));
        let evaluated = said(&serde_json::from_str(&ran.out).unwrap());
        let expected: BTreeSet<String> = case.codes.iter().map(|&code| code.to_owned()).collect();
        let is_rejection = |code: &&str| RejectionCode::ALL.iter().any(|of| of.name() == *code);
        let verdict = match case.codes {
            [] => "accepted",
            codes if codes.iter().any(is_rejection) => "rejected",
            _ => "accepted_with_warnings",
        };
        assert_eq!(
            evaluated,
            (verdict.to_owned(), case.verified, expected),
            "{name}"
        );
        let code = i32::from(verdict == "rejected");
        assert_eq!(ran.code, code, "{name}: evaluate");

        let page = fs::read_to_string(bench.path("page.html")).unwrap();
        assert_eq!(said_on_page(&page), evaluated, "{name}: report");

        let ran = bench.run("inspect set.json --json");
        let inspected = said(&serde_json::from_str(&ran.out).unwrap());
        assert_eq!(
            (ran.code, inspected),
            (code, evaluated.clone()),
            "{name}: inspect"
        );

        let text = fs::read_to_string(bench.path("set.json")).unwrap();
        let set = CoefficientSet::from_json(&text).unwrap();
        let summary = Summary::new(vec![Outcome {
            serial: "S1".to_owned(),
            logs: 1,
            result: Ok(UnitResult::new(&set, judge(&set, None))),
        }]);
        let in_summary = said_in_summary(&summary.csv(), "S1");
        assert_eq!(in_summary, (evaluated.0, evaluated.2), "{name}: batch");
        assert_eq!(summary.is_acceptable(), code == 0, "{name}: batch");
    }
}

#[test]
fn fit_and_batch_judge_training_logs_alike() {
    let bench = Bench::new();
    let spikes = |temp_c: f64, row| line(temp_c, row) + if row % 500 == 250 { 9.0 } else { 0.0 };
    fs::create_dir(bench.path("logs")).unwrap();
    let logs = [
        ("plain", log(1, line, line)),
        ("saw", log(1, saw_tooth, line)),
        ("spikes", log(1, spikes, line)),
        ("noise", log(1, |_, _| 0.0, |_, _| 0.0)),
    ];
    for (serial, log) in &logs {
        bench.write(&format!("logs/{serial}.csv"), log);
    }
    let mut seen = BTreeSet::new();
    for model in ["static", "composite", "auto"] {
        let options = format!("--model {model} --tau 10 --segments 10:25.5,24.5:38 --no-report");
        let batch = bench.run(&format!("fit --batch logs --out units {options}"));
        let summary = fs::read(bench.path("units/summary.csv")).unwrap();
        let mut worst = 0;
        for (serial, _) in &logs {
            let fit = format!("fit logs/{serial}.csv --serial {serial} --out alone");
            let ran = bench.run(&format!("{fit} {options} --json"));
            let (verdict, verified, codes) = said(&serde_json::from_str(&ran.out).unwrap());
            assert_eq!(ran.code, i32::from(verdict == "rejected"), "{serial}");
            assert!(!verified);
            let in_summary = said_in_summary(&summary, serial);
            assert_eq!(in_summary, (verdict, codes.clone()), "{serial}");
            worst = worst.max(ran.code);
            seen.extend(codes);
        }
        assert_eq!(batch.code, worst);
    }
    println!("{seen:?}");
    for code in ["bias_step", "spikes", "rows_outside_segments"] {
        assert!(seen.contains(code), "{code}");
    }
}

/// A code that a program may look for is described where people look for it.
#[test]
fn every_code_is_documented() {
    let page = include_str!("../../docs/report.md");
    let rejections = RejectionCode::ALL.iter();
    let rejections = rejections.map(|code| (code.name(), code.meaning(), code.advice()));
    let warnings = WarningCode::ALL.iter();
    let warnings = warnings.map(|code| (code.name(), code.meaning(), code.advice()));
    for (code, meaning, advice) in rejections.chain(warnings) {
        let row = format!("| `{code}` | {meaning} | {advice} |\n");
        assert!(page.contains(&row), "{row}");
    }
}
