//! Units and profiles as TOML: what is read, and what is refused.

use std::path::PathBuf;

use tempco_twin::{PROFILES, Profile, UNITS, Unit};

/// A file in a folder of its own.
fn file(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

#[test]
fn named_units_and_profiles_are_files_that_read_the_same() {
    for name in UNITS {
        let (_folder, path) = file(&format!("{name}.toml"), Unit::source(name).unwrap());
        assert_eq!(Unit::read(&path).unwrap(), Unit::named(name).unwrap());
    }
    for name in PROFILES {
        let (_folder, path) = file(&format!("{name}.toml"), Profile::source(name).unwrap());
        assert_eq!(Profile::read(&path).unwrap(), Profile::named(name).unwrap());
    }
}

/// The message about the unit `hysteretic` with one piece of text replaced; the file is `u.toml`.
fn unit_error(from: &str, to: &str) -> String {
    let source = Unit::source("hysteretic").unwrap();
    assert!(source.contains(from), "{from}");
    let (_folder, path) = file("u.toml", &source.replacen(from, to, 1));
    let message = Unit::read(&path).unwrap_err().to_string();
    let folder = path.parent().unwrap().display().to_string();
    message.replace(&format!("{folder}/"), "")
}

#[test]
fn units_that_cannot_be_are_refused_with_line_and_column() {
    for (from, to, expected) in [
        (
            "rate_unit = \"dph\"",
            "rate_unit = \"rpm\"",
            "u.toml:5:13: unknown variant `rpm`, expected one of `pulses_per_s`, `dph`, `dps`",
        ),
        (
            "[temperature]",
            "[temperatur]",
            "unknown field `temperatur`, expected one of",
        ),
        (
            "half_width_c = 2.0",
            "half_width_k = 2.0",
            "unknown field `half_width_k`, expected `half_width_c` or `gain`",
        ),
        (
            "case_time_constant_s = 360.0\n",
            "",
            "u.toml:8:1: missing field `case_time_constant_s`",
        ),
        (
            "case_time_constant_s = 360.0",
            "case_time_constant_s = 0",
            "u.toml:9:24: `thermal.case_time_constant_s` is 0, expected 0.001 to 10000000",
        ),
        (
            "case_time_constant_s = 360.0",
            "case_time_constant_s = \"6 min\"",
            "u.toml:9:24: invalid type: string \"6 min\", expected f64",
        ),
        (
            "sensor_time_constant_s = 20.0",
            "sensor_time_constant_s = -20.0",
            "`thermal.sensor_time_constant_s` is -20, expected 0 or 0.001 to 10000000",
        ),
        (
            "step_c = 0.0625",
            "step_c = nan",
            "`temperature.step_c` is NaN, expected 0 to 50",
        ),
        (
            "range_c = [-40.0, 85.0]",
            "range_c = [233.15, 358.15]",
            "`axis.x.static_curve.legendre.range_c` is 233.15, expected -100 to 200",
        ),
        (
            "gain = 0.0004",
            "gain = inf",
            "u.toml:30:34: `axis.x.play[2].gain` is inf, expected -1000000000 to 1000000000",
        ),
        (
            "overlap_c = 3.0",
            "overlap_c = 30.0",
            "`axis.x.modes.overlap_c` is 30, expected 0 to",
        ),
        (
            "scale_factor_arcsec = 0.5",
            "scale_factor_arcsec = 0.0",
            "`output.pulses.scale_factor_arcsec` is 0, expected 0.000001 to 1000000",
        ),
        ("[axis.z]", "[axis.w]", "unknown field `w`, expected one of"),
        (
            "rate_unit = ",
            "rate_unit ",
            "u.toml:5:11: key with no value",
        ),
    ] {
        let message = unit_error(from, to);
        assert!(message.contains(expected), "{message}\nexpected {expected}");
        assert!(message.starts_with("u.toml:"), "{message}");
    }
}

#[test]
fn profiles_that_cannot_be_are_refused_with_line_and_column() {
    for (text, expected) in [
        (
            "start_c = 20\nstep = [\n  { ramp = { to_c = 60, rate_c_per_min = 500 } },\n]\n",
            "p.toml:3:42: `step[1].ramp.rate_c_per_min` is 500, expected 0.0001 to 100",
        ),
        (
            "start_c = 20\nstep = [{ soak = { air_k = 293, duration_min = 5 } }]\n",
            "p.toml:2:20: unexpected keys in table: air_k, available keys: air_c, duration_min",
        ),
        (
            "start_c = 20\nstep = [{ jump = { to_c = 30 } }]\n",
            "unknown variant `jump`, expected one of `soak`, `ramp`, `cycle`, `sine`, `door`",
        ),
        (
            "start_c = 293.15\nstep = [{ soak = { air_c = 20, duration_min = 5 } }]\n",
            "p.toml:1:11: `start_c` is 293.15, expected -100 to 200",
        ),
        (
            "start_c = 20\nstep = []\n",
            "p.toml:2:8: `step` is an empty list",
        ),
        ("start_c = 20\n", "missing field `step`"),
        (
            "start_c = 20\nstep = [{ soak = { air_c = 20, duration_min = 5 } }]\n\
             fault = [{ at_min = 1, duration_min = 1, what = \"stuck\" }]\n",
            "unknown variant `stuck`, expected one of `temperature_stuck`",
        ),
        (
            "start_c = 20\nstep = [{ soak = { air_c = 20, duration_min = 5 } }]\n\
             [[fault]]\nat_min = 1\nwhat = \"rows_lost\"\n",
            "p.toml:3:1: `fault[1].duration_min` is 0, expected 0.0001 to 600000",
        ),
        (
            "start_c = 20\nstep = [{ soak = { air_c = 20, duration_min = 5 } }]\n\
             [[motion]]\nat_min = 1\nduration_min = 1\n\
             what = { turn = { rate_dps = [0, 0, 1e9] } }\n",
            "p.toml:6:30: `motion[1].what.turn.rate_dps` is 1000000000, expected -10000 to 10000",
        ),
    ] {
        let (_folder, path) = file("p.toml", text);
        let message = Profile::read(&path).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}\nexpected {expected}");
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = Unit::read(&PathBuf::from("no/such.toml")).unwrap_err();
    assert!(error.to_string().starts_with("no/such.toml: "), "{error}");
}
