//! Logs as loggers write them: from the file to a set, and to a verdict, without an option again.

use serde_json::Value;
use tempco_tests::{Bench, root};

/// Rows of a chamber log: time \[s\], temperature \[degC\] and three axes \[deg/s\].
fn rows() -> impl Iterator<Item = (f64, f64, [f64; 3])> {
    let mut state = 1_u64;
    let mut noise = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    (0..9000).map(move |row| {
        let time_s = f64::from(row) * 0.5;
        let temp_c = 20.0 - 30.0 * (time_s / 4500.0 * std::f64::consts::TAU).cos();
        let axes = [0.01, -0.02, 0.03].map(|slope| slope * temp_c + 0.1 * noise());
        (time_s, temp_c, axes)
    })
}

fn log(header: &str, row: impl Fn(f64, f64, [f64; 3]) -> String) -> String {
    let rows = rows().map(|(time_s, temp_c, axes)| row(time_s, temp_c, axes) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}

/// The log of each logger, its file, and the options of `fit`.
fn logs() -> Vec<(&'static str, &'static str, String)> {
    let us = |time_s: f64| (time_s * 1e6) as u64 + 12_345_678;
    let rad = f64::to_radians;
    vec![
        (
            "plain.csv",
            "",
            log("time_s,temp_c,gx_dps,gy_dps,gz_dps", |t, c, [x, y, z]| {
                format!("{t},{c:.4},{x:.4},{y:.4},{z:.4}")
            }),
        ),
        (
            "log_sensor_gyro_0.csv",
            "",
            log(
                "timestamp,device_id,x,y,z,temperature,error_count",
                |t, c, [x, y, z]| {
                    format!(
                        "{},7,{:.7},{:.7},{:.7},{c:.4},0",
                        us(t),
                        rad(x),
                        rad(y),
                        rad(z)
                    )
                },
            ),
        ),
        (
            "ardupilot.csv",
            "--instance 0",
            log("TimeUS,I,GyrX,GyrY,GyrZ,T", |t, c, [x, y, z]| {
                let (us, x, y, z) = (us(t), rad(x), rad(y), rad(z));
                format!("{us},0,{x:.7},{y:.7},{z:.7},{c:.2}\n{us},1,1,2,3,30")
            }),
        ),
        (
            "european.csv",
            "",
            log(
                "Zeit [s];Temperatur [\u{b0}C];Gyro X [\u{b0}/s];Gyro Y [\u{b0}/s];Gyro Z [\u{b0}/s]",
                |t, c, [x, y, z]| format!("{t:.1};{c:.4};{x:.4};{y:.4};{z:.4}").replace('.', ","),
            ),
        ),
        (
            "counts.csv",
            "--time millis --temp tmp*0.00294+36.53 --axis gx=gyx*0.001:dps --axis gy=gyy*0.001:dps --axis gz=gyz*0.001:dps",
            log("millis,tmp,gyx,gyy,gyz", |t, c, axes| {
                let [x, y, z] = axes.map(|value| (value / 0.001).round());
                format!(
                    "{},{},{x},{y},{z}",
                    t * 1e3,
                    ((c - 36.53) / 0.00294).round()
                )
            }),
        ),
        (
            "iso.csv",
            "--map iso.toml",
            log("timestamp,gx,gy,gz,temperature", |t, c, [x, y, z]| {
                let (h, m, s) = ((t / 3600.0) as u32 + 9, (t / 60.0) as u32 % 60, t % 60.0);
                format!("2023-03-04 {h:02}:{m:02}:{s:04.1},{x:.4},{y:.4},{z:.4},{c:.4}")
            }),
        ),
        (
            "gyro.csv",
            "--join temp.csv",
            log("time_s,gx_dps,gy_dps,gz_dps", |t, _, [x, y, z]| {
                format!("{t},{x:.4},{y:.4},{z:.4}")
            }),
        ),
    ]
}

#[test]
fn every_log_is_fitted_and_judged_with_the_columns_that_were_kept() {
    let bench = Bench::new();
    bench.write(
        "temp.csv",
        &log("time_s,temp_c", |t, c, _| format!("{t},{c:.4}")),
    );
    bench.write("iso.toml", "time = \"timestamp:iso\"\ntemp = [\"temperature:degc\"]\naxis = [\"gx=gx:dps\", \"gy=gy:dps\", \"gz=gz:dps\"]\n");
    for (file, options, text) in logs() {
        bench.write(file, &text);
        let set = file.split('.').next().unwrap();
        let fitted = bench.run(&format!(
            "fit {file} --serial S1 --out {set} --no-report {options}"
        ));
        assert_eq!(fitted.code, 0, "{file}: {}{}", fitted.out, fitted.err);
        let is_plain = file == "plain.csv";
        assert_eq!(
            fitted.err.contains("read as: "),
            !is_plain,
            "{}",
            fitted.err
        );
        let kept =
            std::fs::read_to_string(bench.path(&format!("{set}/coefficients.json"))).unwrap();
        assert_eq!(kept.contains("\"mapping\""), !is_plain);
        // The same log needs no option again.
        let judged = bench.run(&format!("evaluate {set}/coefficients.json {file}"));
        assert_eq!(judged.code, 0, "{file}: {}{}", judged.out, judged.err);
        bench.ok(&format!(
            "apply {set}/coefficients.json {file} --out out.csv"
        ));
    }
    // Neither does a plain log, whatever was kept.
    let judged = bench.run("evaluate european/coefficients.json plain.csv");
    assert_eq!(judged.code, 2, "{}", judged.err);
    assert!(judged.err.contains("gyro_x"), "{}", judged.err);
    bench.ok("evaluate counts/coefficients.json plain.csv");
    bench.ok("evaluate gyro/coefficients.json plain.csv");
    // A joined log is not taken for another log than the fitted one.
    let other = log("time_s,gx_dps,gy_dps,gz_dps", |t, _, [x, y, z]| {
        format!("{t},{x:.3},{y:.3},{z:.3}")
    });
    bench.write("other.csv", &other);
    let refused = bench.run("evaluate gyro/coefficients.json other.csv");
    assert_eq!(refused.code, 2, "{}", refused.out);
    assert!(
        refused
            .err
            .contains("expected --join FILE, with those of this log"),
        "{}",
        refused.err
    );
    bench.ok("evaluate gyro/coefficients.json other.csv --join temp.csv");
    // An image keeps no columns.
    let refused = bench.run("evaluate counts/table.bin counts.csv");
    assert_eq!(refused.code, 2, "{}", refused.out);
}

/// Codes of the warnings in what a command printed as JSON.
fn warned(out: &str) -> Vec<String> {
    let said: Value = serde_json::from_str(out).expect("JSON");
    let warnings = said["warnings"].as_array().expect("warnings");
    let code = |warning: &Value| warning["code"].as_str().expect("a code").to_owned();
    warnings.iter().map(code).collect()
}

/// What a person must judge of a log is printed, kept, and said again wherever the set is judged.
#[test]
fn doubts_about_a_log_are_warnings() {
    let bench = Bench::new();
    let plain = |t: f64, c: f64, [x, y, z]: [f64; 3]| format!("{t},{c:.4},{x:.4},{y:.4},{z:.4}");
    let again = log("", plain);
    let restarted = log("time_s,temp_c,gx_dps,gy_dps,gz_dps", plain) + again.trim_start();
    let temps: String = restarted
        .lines()
        .map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            format!("{},{}\n", cells[0], cells[1])
        })
        .collect();
    bench.write("temps.csv", &temps);
    let own = log("TimeUS,GyrX,GyrY,GyrZ,T", |t, c, axes| {
        let [x, y, z] = axes.map(f64::to_radians);
        format!("{},{x:.7},{y:.7},{z:.7},{c:.2}", (t * 1e6) as u64)
    });
    let alone = log("time_s,gx_dps,gy_dps,gz_dps", |t, _, [x, y, z]| {
        format!("{t},{x:.4},{y:.4},{z:.4}")
    });
    for (file, text, options, code, part) in [
        ("own.csv", own, "", "own_correction", "INS_TCALn_ENABLE"),
        (
            "restarted.csv",
            restarted,
            "",
            "time_restarts",
            "from 8099.5 s on",
        ),
        (
            "alone.csv",
            alone,
            "--join temps.csv",
            "time_restarts",
            "in temps.csv: the recorder",
        ),
    ] {
        bench.write(file, &text);
        let ran = bench.run(&format!(
            "fit {file} --serial S1 --out set --no-report {options}"
        ));
        let said = ran.out + &ran.err;
        assert!(ran.code == 0 && said.contains(part), "{file}: {said}");
        let ran = bench.run(&format!(
            "fit {file} --serial S1 --out set {options} --json"
        ));
        assert_eq!(warned(&ran.out)[0], code, "{file}: {}", ran.out);
        let page = std::fs::read_to_string(bench.path("set/report.html")).unwrap();
        assert!(page.contains(code) && page.contains(part), "{file}");
        let ran = bench.run("inspect set/coefficients.json --json");
        assert_eq!(warned(&ran.out)[0], code, "{file}: {}", ran.out);
    }
    // A clean set is warned of by the log that it is judged on, and a clean log leaves no doubt.
    bench.write("plain.csv", &logs()[0].2);
    let ran =
        bench.run("fit plain.csv --serial S1 --model composite --out clean --no-report --json");
    assert_eq!(warned(&ran.out), Vec::<String>::new(), "{}", ran.out);
    let ran = bench.run("evaluate clean/coefficients.json restarted.csv --json");
    let codes = warned(&ran.out);
    assert!(codes.contains(&"time_restarts".to_owned()), "{codes:?}");
}

/// The cases next to the project, where they can be made.
#[test]
fn cases_are_read_as_they_should_be() {
    let script = root()
        .parent()
        .map(|folder| folder.join("shared/cases/make.py"));
    let Some(script) = script.filter(|script| script.is_file()) else {
        println!("skipped: shared/cases is not there");
        return;
    };
    let bench = Bench::new();
    let mut made = std::process::Command::new("python3");
    made.arg(script).arg(bench.path("cases")).args([
        "european_spreadsheet",
        "px4_csv",
        "ardupilot_csv",
        "clock_times",
        "blank_temperatures",
        "two_imus_wide",
        "temperature_in_another_file",
        "milliseconds",
    ]);
    if !made.output().is_ok_and(|made| made.status.success()) {
        println!("skipped: the cases need python3 with numpy");
        return;
    }
    for (log, options, refusal) in [
        ("european_spreadsheet/log.csv", "", ""),
        ("european_spreadsheet/brackets.csv", "", ""),
        ("px4_csv/log_sensor_gyro_0.csv", "", ""),
        ("ardupilot_csv/log.csv", "", ""),
        ("ardupilot_csv/log.csv", "--where I=1", ""),
        ("ardupilot_csv/log.csv", "--instance 1", ""),
        (
            "px4_csv/log_sensor_gyro_0.csv",
            "--instance 1",
            "no column numbers the sources",
        ),
        ("clock_times/iso.csv", "", "column `gx` has no unit"),
        ("blank_temperatures/log.csv", "", ""),
        ("two_imus_wide/log.csv", "", ""),
        ("temperature_in_another_file/gyroscope.csv", "", "--join"),
        (
            "temperature_in_another_file/gyroscope.csv",
            "--join cases/temperature_in_another_file/temperature.csv",
            "",
        ),
        ("milliseconds/millis.csv", "", "`GyX` has no unit"),
    ] {
        let ran = bench.run(&format!(
            "fit cases/{log} --serial S1 --out set --no-report {options}"
        ));
        let expected = if refusal.is_empty() { 0 } else { 2 };
        assert_eq!(ran.code, expected, "{log}: {}{}", ran.out, ran.err);
        assert!(ran.err.contains(refusal), "{log}: {}", ran.err);
    }
}
