//! Sets of version 1, which tempco 0.1 wrote, are read as what they were.

use tempco_log::{ReadOptions, read_log};
use tempco_set::run::apply;
use tempco_set::{CoefficientSet, FORMAT_VERSION};

/// A spline with a play and a lag shift, as tempco 0.1 wrote it but for most of its candidates.
const VERSION_1: &str = include_str!("version1.json");

/// Rows of [`log`] with the biases that 0.1 took out of them.
const BIASES: [(usize, [f32; 3]); 13] = [
    (0, [-0.032884285, -0.035974506, 0.03578617]),
    (500, [0.017970776, -0.04716377, 0.04374803]),
    (1000, [0.07224399, -0.076402344, 0.046784576]),
    (1500, [0.0051236013, -0.06430962, 0.033786755]),
    (2000, [-0.122538656, -0.016338486, 0.03517741]),
    (2500, [-0.16633327, 0.006546043, 0.026655752]),
    (3000, [-0.021935837, -0.01763597, 0.013178752]),
    (3500, [0.09820935, -0.070222996, 0.041300997]),
    (4000, [0.043096766, -0.0656178, 0.04566901]),
    (4500, [-0.04188928, -0.035294496, 0.05043097]),
    (5000, [-0.09892138, -0.025089284, 0.029585257]),
    (5500, [-0.091988325, -0.0015478886, 0.012054288]),
    (6000, [-0.07503412, -0.0033097756, 0.007748591]),
];

/// A row a second, with cycles of 11 and 50 minutes.
fn log() -> String {
    let mut text = "time_s,temp_c,x_pulses_per_s,y_pulses_per_s,z_pulses_per_s\n".to_owned();
    for row in 0..=6000 {
        let time_s = f64::from(row);
        let temp_c = 25.0 * (time_s * 0.0021).sin() + 12.0 * (time_s * 0.0093).sin();
        text += &format!("{row},{:.4},0,0,0\n", 20.0 + temp_c);
    }
    text
}

#[test]
fn a_set_of_version_1_keeps_its_table_and_its_biases() {
    let set = CoefficientSet::from_json(VERSION_1).unwrap();
    assert_eq!(
        (set.format_version, &set.table_crc32[..]),
        (FORMAT_VERSION, "1e682231")
    );
    let table = &set.channels[0].table;
    assert_eq!(table.thermal.half_width1_c, 5.23233);
    assert_eq!(table.thermal.play_kappa, table.thermal.kappa);
    assert!(!table.has_second_lag());
    assert_eq!(CoefficientSet::from_json(&set.to_json()).unwrap(), set);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, log()).unwrap();
    let log = read_log(&path, &ReadOptions::default()).unwrap();
    let applied = apply(&set, &log).unwrap();
    for (row, biases) in BIASES {
        let found: Vec<f32> = applied.axes.iter().map(|axis| axis.bias[row]).collect();
        assert_eq!(found, biases, "row {row}");
    }
}

/// The second lag of 0.1 depended on the lag-compensated temperature.
#[test]
fn a_set_of_version_1_with_a_second_lag_is_refused() {
    let lag =
        r#""slow_parts": [{"tau_s": 4500.0, "limit_c": 9.0, "gain": [1.0, 1.0, 1.0]}], "cells""#;
    let text = VERSION_1.replace("\"cells\"", lag);
    assert_ne!(text, VERSION_1);
    let error = CoefficientSet::from_json(&text).unwrap_err();
    assert!(error.contains("fit again"), "{error}");
}

#[test]
fn a_damaged_set_of_version_1_is_refused() {
    for (from, to, said) in [
        ("5.23233", "5.33", "CRC"),
        ("\"kappa\": 1.2352275", "\"kappa\": 1.3", "CRC"),
        (
            "\"format_version\": 1",
            "\"format_version\": 3",
            "version 3 of the format: expected 2",
        ),
        ("\"hold_s\"", "\"hold\"", "unknown field `hold`"),
    ] {
        let text = VERSION_1.replacen(from, to, 1);
        assert_ne!(text, VERSION_1, "{from}");
        let error = CoefficientSet::from_json(&text).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}
