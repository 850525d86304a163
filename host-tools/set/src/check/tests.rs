//! Every number has a range, and what is out of it is named.

use std::path::Path;

use serde_json::{Value, json};
use tempco_log::signals::{Fault, Finding};

use crate::import::static_coefficients;
use crate::{CoefficientSet, Coverage, GainSet, NoiseSet, SignOff};

const PRINTED: &str = "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
     X,1,-15,40,0.0173,-0.0014,0.00001\nX,2,30,80,0.0173,-0.0014,0.00002\n";

/// A set in which as many numbers as can be are there.
fn example() -> Value {
    let mut set = static_coefficients(Path::new("printed.csv"), PRINTED).unwrap();
    set.settings.scale_factor_arcsec = Some(0.5);
    set.provenance.inputs[0].findings = vec![Finding {
        fault: Fault::FullScale,
        column: String::new(),
        rows: 1,
        share: 0.5,
        from_s: -1.0,
        to_s: 1.0,
        detail: String::new(),
    }];
    set.sign_offs = vec![SignOff {
        file: String::new(),
        sha256: String::new(),
        judged: String::new(),
        tau_s: 100.0,
        accepted: true,
        worse_axes: Vec::new(),
        rejections: Vec::new(),
        warnings: Vec::new(),
    }];
    let channel = &mut set.channels[0];
    channel.segments[0].coverage = Some(Coverage {
        time_s: 1.0,
        width: 1.0,
        rate_min_c_per_min: -1.0,
        rate_max_c_per_min: 1.0,
        rate_independent_c_per_min: 0.5,
    });
    channel.table.thermal.half_width1_c = 2.5;
    channel.table.play_gains = vec![[0.1, 0.0]];
    let axis = &mut channel.axes[0];
    let gain = |gain, sigma| GainSet { gain, sigma };
    axis.gains = vec![gain(0.1, 0.01), gain(0.0, 0.0)];
    axis.noise = Some(NoiseSet {
        white: 0.1,
        walk: 0.2,
    });
    set.seal();
    let mut value = serde_json::to_value(&set).unwrap();
    let axis = &mut value["channels"][0]["axes"][0];
    let sigmas = json!({"a": [0.1, 0.1, 0.1], "r": [0.0, 0.0], "s": [0.0, 0.0]});
    axis["sigmas"] = json!([sigmas, sigmas]);
    axis["held_out"] = json!({"soaks_and_ramps": 1, "folds": 1, "none": 1.0, "cubic": 1.0, "static": 1.0,
        "composite": 1.0, "chosen": 1.0, "excess_sigma": 0.1, "left_out": 1.0,
        "surpassed": {"by": "static", "rmse": 0.5, "excess": 3.0, "excess_sigma": 1.0}});
    axis["reference_c"] = json!(25.0);
    axis["statistics"] = json!({"rows": 1, "rmse_raw": 1.0, "rmse_cubic": 1.0,
        "rmse_compensated": 1.0, "tau_s": 100.0, "n": 1, "sigma_raw": 1.0, "sigma_cubic": 1.0,
        "sigma_compensated": 1.0, "serial_factor": 1.0});
    let candidate = json!({"model": "spline", "segments": 1, "place": "given",
        "rate_columns": 1, "columns": 1, "tau_s": 60.0, "kappa": -1.0, "half_widths_c": [1.0],
        "tau2_s": 900.0, "kappa2": -0.5,
        "play_kappa": 1.5, "play_kappa2": -1.5, "rmse": [1.0], "excess": -0.5, "excess_sigma": 0.1});
    let channel = &mut value["channels"][0];
    channel["outliers"] = json!({"excluded_rows": 0, "spike_rows": 0, "disturbed_rows": 0,
        "steps": [{"file": "", "axis": "x", "time_s": 1.0, "size": -1.0}],
        "constants": [[-0.5], [0.5]]});
    channel["selection"] = json!({"soaks_and_ramps": 1, "folds": 1, "ramp_rates_c_per_min": [1.0],
        "chosen": candidate, "others": [candidate]});
    value
}

fn read(value: &Value) -> Result<CoefficientSet, String> {
    CoefficientSet::from_json(&value.to_string())
}

/// JSON pointers of all numbers.
fn numbers(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(at.to_owned()),
        Value::Array(list) => {
            for (number, value) in list.iter().enumerate() {
                numbers(value, &format!("{at}/{number}"), found);
            }
        }
        Value::Object(fields) => {
            for (name, value) in fields {
                numbers(value, &format!("{at}/{name}"), found);
            }
        }
        _ => {}
    }
}

#[test]
fn every_number_has_a_range() {
    let good = example();
    read(&good).unwrap();
    let mut found = Vec::new();
    numbers(&good, "", &mut found);
    assert!(found.len() > 100, "{}", found.len());
    for at in found {
        for absurd in [-1e300, 1e300] {
            let mut bad = good.clone();
            *bad.pointer_mut(&at).unwrap() = absurd.into();
            let error = read(&bad).expect_err(&at);
            assert!(
                error.contains("xpected") || error.contains("CRC") || error.contains("range"),
                "{at}: {error}"
            );
        }
    }
}

#[test]
fn the_key_and_what_was_expected_are_named() {
    for (at, value, message) in [
        (
            "/settings/scale_factor_arcsec",
            -1.0,
            "settings.scale_factor_arcsec is -1.0: expected 1e-6 to 1000000.0",
        ),
        (
            "/settings/scale_factor_arcsec",
            0.0,
            "settings.scale_factor_arcsec is 0.0: expected",
        ),
        (
            "/settings/scale_factor_arcsec",
            1e308,
            "settings.scale_factor_arcsec is 1e308: expected",
        ),
        (
            "/channels/0/segments/1/condition",
            -1.0,
            "channels[0].segments[1].condition is -1.0",
        ),
        (
            "/channels/0/axes/0/sigmas/1/a/2",
            -1.0,
            "channels[0].axes[0].sigmas[1].a[2] is -1.0",
        ),
        (
            "/channels/0/axes/0/gains/0/gain",
            0.2,
            "gains[0].gain is 0.2: expected 0.1, the gain in the table",
        ),
        (
            "/channels/0/axes/0/polynomials/1/centre_c",
            0.0,
            "polynomials[1].centre_c is 0.0",
        ),
        ("/channels/0/segments/0/t_min_c", -14.0, "expected"),
        (
            "/channels/0/selection/chosen/kappa",
            2.1,
            "selection.chosen.kappa is 2.1: expected -2.0 to 2.0",
        ),
        (
            "/channels/0/selection/chosen/kappa2",
            -2.1,
            "selection.chosen.kappa2 is -2.1: expected -2.0 to 2.0",
        ),
        (
            "/channels/0/selection/others/0/play_kappa",
            2.1,
            "selection.others[0].play_kappa is 2.1: expected -2.0 to 2.0",
        ),
        (
            "/channels/0/selection/others/0/play_kappa2",
            -2.1,
            "selection.others[0].play_kappa2 is -2.1: expected -2.0 to 2.0",
        ),
        (
            "/channels/0/axes/0/held_out/surpassed/rmse",
            -0.1,
            "held_out.surpassed.rmse is -0.1: expected 0.0",
        ),
        (
            "/channels/0/axes/0/held_out/surpassed/excess",
            -0.1,
            "held_out.surpassed.excess is -0.1: expected 0.0",
        ),
        (
            "/channels/0/axes/0/held_out/surpassed/excess_sigma",
            -0.1,
            "held_out.surpassed.excess_sigma is -0.1: expected 0.0",
        ),
    ] {
        let mut bad = example();
        *bad.pointer_mut(at).unwrap() = value.into();
        let error = read(&bad).expect_err(at);
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn polynomials_that_contradict_the_table_are_refused_by_axis_and_cell() {
    for (part, place) in [("a", 0), ("a", 2), ("r", 0), ("r", 1), ("s", 0)] {
        let mut bad = example();
        let polynomial = &mut bad["channels"][0]["axes"][0]["polynomials"][1];
        let number = &mut polynomial[part][place];
        *number = (number.as_f64().unwrap() + 1e-5).into();
        let error = read(&bad).unwrap_err();
        assert!(
            error.contains("channels[0].table: axis x, cell "),
            "{error}"
        );
        assert!(error.contains("pulses/s"), "{error}");
    }
}

/// Version 2 as it was before it knew of two lags and of simpler models.
#[test]
fn sets_without_the_newer_numbers_are_read() {
    let mut old = example();
    let channel = &mut old["channels"][0];
    let held_out = channel["axes"][0]["held_out"].as_object_mut().unwrap();
    held_out.remove("surpassed").unwrap();
    let chosen = channel["selection"]["chosen"].as_object_mut().unwrap();
    for key in ["kappa2", "play_kappa", "play_kappa2"] {
        chosen.remove(key).unwrap();
    }
    let set = read(&old).unwrap();
    let selection = set.channels[0].selection.as_ref().unwrap();
    assert_eq!(selection.chosen.kappa2, 0.0);
    assert_eq!(selection.others[0].play_kappa, 1.5);
    let held_out = set.channels[0].axes[0].held_out.unwrap();
    assert_eq!(held_out.surpassed, None);
    assert_eq!(read(&serde_json::to_value(&set).unwrap()).unwrap(), set);
}

#[test]
fn an_unknown_simpler_model_is_refused() {
    let mut bad = example();
    bad["channels"][0]["axes"][0]["held_out"]["surpassed"]["by"] = "spline".into();
    let error = read(&bad).unwrap_err();
    assert!(error.contains("unknown variant `spline`"), "{error}");
}

/// Rounding is not a contradiction, and so is left to the CRC.
#[test]
fn small_changes_are_found_by_the_crc() {
    for (at, factor) in [
        ("/channels/0/axes/0/polynomials/1/a/0", 1.0 + 1e-8),
        ("/settings/scale_factor_arcsec", 2.0),
    ] {
        let mut bad = example();
        let number = bad.pointer_mut(at).unwrap();
        *number = (number.as_f64().unwrap() * factor).into();
        let error = read(&bad).unwrap_err();
        assert!(error.contains("polynomials, scale factor"), "{error}");
    }
}
