//! Bad input: exit code 2, a message that says where and what was expected, nothing written.

use tempco_tests::{Bench, shared};

/// Runs `fit` on a log that must be refused and returns the message.
fn refused(contents: &str) -> String {
    let bench = Bench::new();
    bench.write("log.csv", contents);
    let ran = bench.run("fit log.csv --serial S1 --out set");
    assert_eq!(ran.code, 2, "{}{}", ran.out, ran.err);
    assert_eq!(bench.files(), ["log.csv"], "nothing may be written");
    assert!(ran.out.is_empty(), "{}", ran.out);
    ran.err
}

/// A good log of 600 rows between 10 and 40 degC, with row 300 (line 302) replaced.
fn with_row_300(header: &str, row: &str) -> String {
    let mut log = format!("{header}\n");
    for i in 0..600 {
        let temp_c = 25.0 + 15.0 * (f64::from(i) * 0.01).sin();
        match i {
            300 => log.push_str(row),
            _ => log.push_str(&format!("{i},{temp_c:.3},{:.4}", 0.01 * temp_c)),
        }
        log.push('\n');
    }
    log
}

const HEADER: &str = "time_s,temp_c,x_dph";

#[test]
fn the_good_log_is_fitted() {
    let bench = Bench::new();
    bench.write("log.csv", &with_row_300(HEADER, "300,28.1,0.281"));
    bench.ok("fit log.csv --serial S1 --out set");
    assert_eq!(bench.files(), ["log.csv", "set"]);
}

#[test]
fn bad_rows_are_named() {
    for (row, expected) in [
        (
            "300,warm,0.2",
            "log.csv:302:2: column `temp_c`: `warm`: expected a finite number",
        ),
        (
            "300,28.1,NaN",
            "log.csv:302:3: column `x_dph`: `NaN`: expected a finite number",
        ),
        (
            "299,28.1,0.2",
            "log.csv:302:1: column `time_s`: 299 s after 299 s: expected time to",
        ),
        (
            "7,28.1,0.2",
            "log.csv:302:1: column `time_s`: 7 s after 299 s: expected time to",
        ),
        (
            "300,301.2,0.2",
            "301.2: expected -100 to 200 degC (is it in kelvin?)",
        ),
        (
            "300,28,1,0,2",
            "log.csv:302: 5 cells, but the header has 3 (a decimal comma",
        ),
        ("300,28.1,", "log.csv:302:3: column `x_dph`: an empty cell"),
    ] {
        let message = refused(&with_row_300(HEADER, row));
        assert!(message.starts_with("error: "), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn bad_files_and_headers_are_named() {
    let good = "300,28.1,0.2";
    for (contents, expected) in [
        (String::new(), "log.csv: the file is empty"),
        (format!("{HEADER}\n"), "log.csv: 0 usable rows"),
        (
            with_row_300("time_s,temp_c,x_rpm", good),
            "log.csv:1: column `x_rpm` has the unknown unit `rpm`",
        ),
        (
            with_row_300("time_s,temp_c,temp_case_c", good),
            "log.csv:1: no axis column",
        ),
        (
            with_row_300("time,temp_c,x_dph", good),
            "`time` has no unit: expected --time time:s",
        ),
        (
            with_row_300("time_s,temp,x_dph", good),
            "`temp` has no unit: expected --temp temp:degc",
        ),
    ] {
        let message = refused(&contents);
        assert!(message.contains(expected), "{message}");
    }
    let two: String = with_row_300(HEADER, good)
        .lines()
        .enumerate()
        .map(|(line, row)| match line {
            0 => format!("{row},temp_case_c\n"),
            _ => format!("{row},20.0\n"),
        })
        .collect();
    let message = refused(&two);
    assert!(message.contains("2 temperature columns"), "{message}");
    assert!(message.contains("--temp COLUMN"), "{message}");

    // With the mapping it asks for, the same file is fitted.
    let bench = Bench::new();
    bench.write("log.csv", &two);
    bench.ok("fit log.csv --serial S1 --out set --temp temp_c");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let rows = |first_s: u32, temp: fn(f64) -> f64| {
        let mut log = format!("{HEADER}\n");
        for i in 0..600 {
            log.push_str(&format!("{},{:.3},0.1\n", first_s + i, temp(f64::from(i))));
        }
        log
    };
    let message = refused(&rows(0, |i| 25.0 + 4.9 * (i * 0.01).sin()));
    assert!(
        message.contains("log.csv: the temperature `temp_c` spans 9.8 degC only: expected 10 degC"),
        "{message}"
    );

    let bench = Bench::new();
    let swing = |i: f64| 25.0 + 15.0 * (i * 0.01).sin();
    bench.write("log.csv", &rows(0, swing));
    for (args, expected) in [
        ("--segments 10:30,50:80", "leave a gap"),
        (
            "--model composite --segments 10:30,25:60,55:80",
            "segment 55.0000..80.0000 degC holds 0 usable rows",
        ),
        ("--rate-tau 1.5", "half the rate estimator's time constant"),
        (
            "--model static --segments 10:45,40:80",
            "segment 40.0000..80.0000 degC holds 0 usable rows, too few to fit",
        ),
        ("--kappa 3", "setting kappa"),
        ("--tau nan", "expected seconds, 1e-4 to 1e9"),
        ("--tau inf", "expected seconds, 1e-4 to 1e9"),
        ("--tau 1e300", "expected seconds, 1e-4 to 1e9"),
        ("--tau 1e-300", "expected seconds, 1e-4 to 1e9"),
        (
            "--exclude 0:1e9",
            "log.csv: no row is left to fit: of 600, 600 lie in excluded stretches",
        ),
        (
            "--exclude -inf:inf --model composite",
            "log.csv: no row is left to fit: of 600, 600 lie in excluded stretches",
        ),
        ("--axis x=x_dph:rpm", "unknown unit `rpm`"),
        ("--scale-factor -1", "expected arcsec per pulse"),
        (
            "--scale-factor 1e300",
            "expected arcsec per pulse, 1e-6 to 1e6",
        ),
        ("--model cubic", "invalid value 'cubic'"),
        (
            "--model spline",
            "was removed: auto, the default, has all that it had; leave the option out",
        ),
        (
            "--overlap spline",
            "was removed: auto, the default, has no overlaps; leave the option out",
        ),
        (
            "--states none",
            "was removed: auto finds history terms where the logs show them; leave the option out",
        ),
    ] {
        let ran = bench.run_to_its_end(&format!("fit log.csv --serial S1 --out set {args}"));
        assert_eq!(ran.code, 2, "{args}");
        assert!(ran.err.contains(expected), "{args}: {}", ran.err);
        assert_eq!(bench.files(), ["log.csv"], "{args}");
    }
    // Of two logs, the one is named of which nothing is left.
    bench.write("late.csv", &rows(1000, swing));
    let ran = bench.run("fit late.csv log.csv --serial S1 --out set --exclude 0:999");
    assert_eq!(ran.code, 2, "{}", ran.err);
    let expected = "error: log.csv: no row is left to fit";
    assert!(ran.err.starts_with(expected), "{}", ran.err);
}

#[test]
fn skipping_bad_rows_must_be_asked_for_and_is_counted() {
    let bench = Bench::new();
    bench.write("log.csv", &with_row_300(HEADER, "300,NaN,0.2"));
    let ran = bench.run("fit log.csv --serial S1 --out set --skip-bad-rows");
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(
        ran.err.contains("1 bad rows left out: not a number 1"),
        "{}",
        ran.err
    );
}

#[test]
fn a_real_log_without_temperature_is_refused() {
    let Some(path) = shared("data/ln100_rlg_static_x_up.csv") else {
        return;
    };
    let bench = Bench::new();
    let ran = bench.run(&format!("fit {} --serial LN100 --out set", path.display()));
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains("no temperature column: expected `temp_c`"),
        "{}",
        ran.err
    );
    assert!(bench.files().is_empty());
}

#[test]
fn a_set_and_a_log_that_do_not_belong_together_are_refused() {
    let bench = Bench::new();
    bench.write("log.csv", &with_row_300(HEADER, "300,28.1,0.281"));
    bench.ok("fit log.csv --serial S1 --out set");
    bench.write(
        "dps.csv",
        &with_row_300("time_s,temp_c,x_dps", "300,28.1,0.281"),
    );
    bench.write(
        "y.csv",
        &with_row_300("time_s,temp_c,y_dph", "300,28.1,0.281"),
    );
    for (log, expected) in [
        ("dps.csv", "axis `x` is in dps, but the set expects dph"),
        ("y.csv", "no axis `x`, which the set of S1 compensates"),
    ] {
        let ran = bench.run(&format!("apply set/coefficients.json {log} --out out.csv"));
        assert_eq!(ran.code, 2);
        assert!(ran.err.contains(expected), "{}", ran.err);
        assert!(!bench.path("out.csv").exists());
    }
    let ran = bench.run("fit log.csv dps.csv --serial S1 --out both");
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("do not belong together"), "{}", ran.err);
}

#[test]
fn units_and_profiles_that_cannot_be_simulated_are_refused() {
    let bench = Bench::new();
    let unit = bench.ok("simulate --show paper");
    bench.write(
        "unit.toml",
        &unit.replace("step_c = 0.0625", "step_k = 0.0625"),
    );
    let profile = bench.ok("simulate --show short");
    bench.write("fast.toml", &profile.replacen("= 1.0 }", "= 1000 }", 1));
    let before = bench.files();
    for (args, expected) in [
        (
            "--unit unit.toml --profile short --out a.csv",
            "unit.toml:15:1: unknown field `step_k`, expected one of `sigma_c`, `step_c`",
        ),
        (
            "--unit paper --profile fast.toml --out a.csv",
            "fast.toml:6:46: `step[2].ramp.rate_c_per_min` is 1000, expected 0.0001 to 100",
        ),
        (
            "--unit none.toml --profile short --out a.csv",
            "none.toml: No such file",
        ),
        (
            "--unit papr --profile short --out a.csv",
            "unknown unit `papr`, expected one of: paper, smooth",
        ),
        (
            "--unit paper --profile shrt --out a.csv",
            "unknown profile `shrt`, expected one of: calibration",
        ),
        (
            "--unit paper --profile short --rate -1 --out a.csv",
            "sample rate -1 Hz is outside 0.01..10000 Hz",
        ),
        (
            "--unit paper --profile short --out a.csv --truth a.csv",
            "--out and --truth: expected two files",
        ),
        ("--unit paper --profile short", "--out <LOG.csv>"),
        ("--show papr", "neither a named unit nor a named profile"),
    ] {
        let ran = bench.run(&format!("simulate {args}"));
        assert_eq!(ran.code, 2, "{args}");
        assert!(ran.err.contains(expected), "{args}: {}", ran.err);
        assert_eq!(bench.files(), before, "{args}");
    }
}

#[test]
fn a_folder_is_not_replaced_by_a_file() {
    let bench = Bench::new();
    bench.write("log.csv", &with_row_300(HEADER, "300,28.1,0.281"));
    bench.ok("fit log.csv --serial S1 --out set");
    let ran = bench.run("apply set/coefficients.json log.csv --out set");
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains("set is there and is not a regular file"),
        "{}",
        ran.err
    );
    assert_eq!(bench.files(), ["log.csv", "set"]);
}
