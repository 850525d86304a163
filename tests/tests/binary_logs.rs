//! Binary logs of autopilots: from the file to a set for each sensor, and to a verdict.

use std::fs;

use tempco_tests::Bench;
use tempco_tests::autopilot::{Row, dataflash, ulog};

/// A simulated unit as two sensors: the second one turns the other way, a degree warmer.
fn rows(bench: &Bench) -> Vec<Row> {
    bench.ok("simulate --unit fog --profile calibration --rate 0.5 --seed 3 --out twin.csv");
    let log = fs::read_to_string(bench.path("twin.csv")).unwrap();
    let (header, lines) = log.split_once('\n').unwrap();
    assert!(header.starts_with("time_s,temp_c,x_"), "{header}");
    let rows = lines.lines().flat_map(|line| {
        let mut cells = line.split(',').map(|cell| cell.parse::<f64>().unwrap());
        let (time_s, temp_c) = (cells.next().unwrap(), cells.next().unwrap() as f32);
        let rate = cells.next().unwrap() / 3600.0;
        let us = (time_s * 1e6) as u64 + 5_000_000;
        let rates = [1.0, 0.5, -2.0].map(|scale| (scale * rate).to_radians() as f32);
        let second = rates.map(|rate| -rate);
        [(0, us, rates, temp_c), (1, us + 40, second, temp_c + 1.0)]
    });
    rows.collect()
}

#[test]
fn each_sensor_gets_a_set() {
    let bench = Bench::new();
    let rows = rows(&bench);
    fs::write(bench.path("log.ulg"), ulog(&rows)).unwrap();
    fs::write(bench.path("log.bin"), dataflash(&rows, false)).unwrap();
    for file in ["log.ulg", "log.bin"] {
        let fitted = bench.run(&format!(
            "fit {file} --serial SN --out {file}.sets --no-report"
        ));
        assert_eq!(fitted.code, 0, "{}{}", fitted.out, fitted.err);
        for sensor in [0, 1] {
            assert!(
                fitted.out.contains(&format!("unit SN-{sensor}")),
                "{}",
                fitted.out
            );
            // The instance is kept.
            let set = format!("{file}.sets/imu{sensor}/coefficients.json");
            let judged = bench.run(&format!("evaluate {set} {file}"));
            assert_eq!(judged.code, 0, "{}{}", judged.out, judged.err);
            assert!(
                judged.err.contains(&format!("--instance {sensor}")),
                "{}",
                judged.err
            );
            assert!(judged.out.contains("a training log"), "{}", judged.out);
            bench.ok(&format!("apply {set} {file} --out out.csv"));
            let out = fs::read_to_string(bench.path("out.csv")).unwrap();
            let (_, us, rates, _) = rows[sensor];
            let first = out.lines().nth(1).unwrap();
            let cells: Vec<&str> = first.split(',').collect();
            assert_eq!(cells[0], (us as f64 / 1e6).to_string());
            assert_eq!(cells[2].parse(), Ok(rates[0]));
        }
        // An image keeps nothing.
        let refused = bench.run(&format!("evaluate {file}.sets/imu1/table.bin {file}"));
        assert_eq!(refused.code, 2);
        let expected = "the instances 0, 1 of the sensor are in it: choose one by --instance 0";
        assert!(refused.err.contains(expected), "{}", refused.err);
        bench.ok(&format!(
            "evaluate {file}.sets/imu1/table.bin {file} --instance 1"
        ));
    }
    // The same rows, the same tables.
    for sensor in [0, 1] {
        let table = |file| fs::read(bench.path(&format!("{file}.sets/imu{sensor}/table.bin")));
        assert_eq!(table("log.ulg").unwrap(), table("log.bin").unwrap());
    }
    // One of them alone.
    bench.ok("fit log.ulg --serial SN --out one --instance 1 --no-report");
    let kept = fs::read_to_string(bench.path("one/coefficients.json")).unwrap();
    assert!(kept.contains("\"instance\": 1"), "{kept}");
    let refused = bench.run("fit log.ulg --serial SN --out none --instance 2 --no-report");
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("no instance 2; there are 0, 1"),
        "{}",
        refused.err
    );
    assert!(!bench.path("none").exists());
}

#[test]
fn a_sensor_that_is_corrected_or_a_damaged_file_is_refused() {
    let bench = Bench::new();
    let rows = rows(&bench);
    fs::write(bench.path("log.bin"), dataflash(&rows, true)).unwrap();
    let fitted = bench.run("fit log.bin --serial SN --out sets --no-report");
    assert_eq!(fitted.code, 2, "{}", fitted.out);
    assert!(
        fitted.err.contains("imu1: log.bin: INS_TCAL2_ENABLE is 1"),
        "{}",
        fitted.err
    );
    assert!(
        fitted.err.contains("error: no set was made of imu1"),
        "{}",
        fitted.err
    );
    assert!(bench.path("sets/imu0/coefficients.json").exists());
    assert!(!bench.path("sets/imu1").exists());

    let mut file = ulog(&rows);
    file.truncate(file.len() - 9);
    fs::write(bench.path("cut.ulg"), &file).unwrap();
    let fit = "fit cut.ulg --serial SN --out cut --no-report";
    let refused = bench.run(fit);
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("cut.ulg: damaged at byte "),
        "{}",
        refused.err
    );
    assert!(
        refused.err.contains("--skip-bad-rows reads"),
        "{}",
        refused.err
    );
    let fitted = bench.run(&format!("{fit} --skip-bad-rows"));
    assert_eq!(fitted.code, 0, "{}{}", fitted.out, fitted.err);
    assert!(fitted.err.contains("damaged at byte "), "{}", fitted.err);
    assert!(
        fitted.err.contains("1 bad rows left out: damaged part 1"),
        "{}",
        fitted.err
    );
}
