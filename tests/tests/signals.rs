//! A log whose signals are spoilt is rejected with its place, whatever it is used for.

use std::fs;
use std::ops::Range;

use serde_json::Value;
use tempco_tests::Bench;

const ROWS: usize = 4000;

/// 10 to 40 degC and back twice, a row each second, with some of the rows of a column spoilt.
fn log(seed: u32, spoilt: Option<(usize, Range<usize>, &str)>) -> String {
    let mut random = seed;
    let mut noise = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(random >> 8) / f64::from(1 << 24) - 0.5
    };
    let mut log = String::from("time_s,temp_c,x_dps,y_dps\n");
    for row in 0..ROWS {
        let phase = row as f64 * std::f64::consts::TAU / (ROWS / 2) as f64;
        let temp_c = 25.0 - 15.0 * phase.cos();
        let (x, y) = (
            0.01 * temp_c + 0.02 * noise(),
            0.3 - 0.02 * temp_c + 0.02 * noise(),
        );
        let mut cells = [
            row.to_string(),
            format!("{temp_c:.3}"),
            format!("{x:.4}"),
            format!("{y:.4}"),
        ];
        if let Some((column, rows, value)) = &spoilt
            && rows.contains(&row)
        {
            cells[*column] = (*value).to_owned();
        }
        log.push_str(&(cells.join(",") + "\n"));
    }
    log
}

fn has(list: &Value, code: &str, parts: &[&str]) -> bool {
    list.as_array().unwrap().iter().any(|of| {
        let message = of["message"].as_str().unwrap();
        of["code"] == code && parts.iter().all(|part| message.contains(part))
    })
}

#[test]
fn a_spoilt_log_is_rejected_by_fit_and_evaluate_and_cannot_sign_off() {
    let bench = Bench::new();
    bench.write("good.csv", &log(1, None));
    let fit = "--serial S1 --model static --tau 10 --no-report";
    let ran = bench.run(&format!("fit good.csv {fit} --out good --json"));
    let good: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(
        (ran.code, &good["rejections"]),
        (0, &Value::Array(Vec::new()))
    );

    for (spoilt, code, column, share) in [
        ((2, 1000..1400, "99.5"), "full_scale", "axis x: ", "10.0 %"),
        (
            (3, 1000..1400, "-0.1234"),
            "identical_values",
            "axis y: ",
            "10.0 %",
        ),
        (
            (1, 1000..2600, "25.000"),
            "frozen_temperature",
            "temp_c: ",
            "40.0 %",
        ),
    ] {
        let (from, to) = (spoilt.1.start, spoilt.1.end - 1);
        let place = format!("from {from}.0 to {to}.0 s; ");
        let parts = [column, share, &place, "exclude these times"];
        bench.write("bad.csv", &log(2, Some(spoilt)));

        let ran = bench.run(&format!("fit bad.csv {fit} --out bad --json"));
        let fitted: Value = serde_json::from_str(&ran.out).unwrap();
        assert!(has(&fitted["rejections"], code, &parts), "{}", ran.out);
        assert_eq!(ran.code, 1, "{code}");
        let finding = &fitted["set"]["provenance"]["inputs"][0]["findings"][0];
        assert_eq!(finding["fault"], code, "{}", ran.out);

        // What was cut out is no fault.
        let ran = bench.run(&format!(
            "fit bad.csv {fit} --out cut --exclude {from}:{to} --json"
        ));
        let cut: Value = serde_json::from_str(&ran.out).unwrap();
        assert!(!has(&cut["rejections"], code, &[]), "{}", ran.out);

        let set = fs::read_to_string(bench.path("good/coefficients.json")).unwrap();
        bench.write("set.json", &set);
        let ran = bench.run("evaluate set.json bad.csv --tau 10 --sign-off --json");
        let evaluated: Value = serde_json::from_str(&ran.out).unwrap();
        assert!(has(&evaluated["rejections"], code, &parts), "{}", ran.out);
        assert_eq!((ran.code, &evaluated["verified"]), (1, &Value::Bool(false)));
        let ran = bench.run("inspect set.json --json");
        let inspected: Value = serde_json::from_str(&ran.out).unwrap();
        assert!(has(&inspected["rejections"], code, &parts), "{}", ran.out);
        assert_eq!(ran.code, 1, "{code}");
    }
}
