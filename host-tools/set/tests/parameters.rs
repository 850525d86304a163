//! Parameters of autopilots: what a set of them computes is what the autopilot computes, by its own
//! formula in its own arithmetic.

use std::fs;
use std::path::PathBuf;

use tempco::ThermalPoint;
use tempco_log::AxisUnit;
use tempco_set::CoefficientSet;
use tempco_set::parameters::{Autopilot, export_parameters, import_parameters};

const PX4: &str = "\
# Vehicle-Id Component-Id Name Value Type
1\t1\tSYS_AUTOSTART\t4001\t6
1\t1\tTC_G1_ID\t2293768\t6
1\t1\tTC_G1_TMIN\t-10\t9
1\t1\tTC_G1_TMAX\t70\t9
1\t1\tTC_G1_TREF\t25\t9
1\t1\tTC_G1_X0_0\t0.01\t9
1\t1\tTC_G1_X1_0\t-0.0002\t9
1\t1\tTC_G1_X2_0\t0.000003\t9
1\t1\tTC_G1_X3_0\t0.00000004\t9
1\t1\tTC_G1_X0_1\t-0.002\t9
1\t1\tTC_G1_X1_1\t0.0001\t9
1\t1\tTC_G1_X2_1\t0\t9
1\t1\tTC_G1_X3_1\t-0.00000002\t9
1\t1\tTC_G1_X0_2\t0.005\t9
1\t1\tTC_G1_X1_2\t0\t9
1\t1\tTC_G1_X2_2\t0\t9
1\t1\tTC_G1_X3_2\t0\t9
";

const ARDUPILOT: &str = "\
INS_TCAL2_ENABLE,1
INS_TCAL2_TMIN,-5
INS_TCAL2_TMAX,65.5
INS_TCAL2_GYR1_X,120
INS_TCAL2_GYR1_Y,-80
INS_TCAL2_GYR1_Z,0.5
INS_TCAL2_GYR2_X,-2
INS_TCAL2_GYR2_Y,0.4
INS_TCAL2_GYR2_Z,0
INS_TCAL2_GYR3_X,0.05
INS_TCAL2_GYR3_Y,0.02
INS_TCAL2_GYR3_Z,0
";

fn value(text: &str, separator: char, name: &str) -> f32 {
    let mut lines = text.lines().map(|line| line.split(separator));
    lines
        .find_map(|mut cells| {
            cells.find(|cell| *cell == name)?;
            cells.next()?.parse().ok()
        })
        .unwrap_or_else(|| panic!("no {name}"))
}

/// The offset that PX4 takes out \[rad/s\].
fn px4(axis: usize, temp_c: f32) -> f32 {
    let of = |name: &str| value(PX4, '\t', &format!("TC_G1_{name}"));
    let x = |power: usize| of(&format!("X{power}_{axis}"));
    let d = temp_c.clamp(of("TMIN"), of("TMAX")) - of("TREF");
    let mut offset = x(0);
    let mut power = d;
    offset += x(1) * power;
    power *= d;
    offset += x(2) * power;
    power *= d;
    offset + x(3) * power
}

/// What ArduPilot takes out, but for its own offset \[rad/s\].
fn ardupilot(axis: usize, temp_c: f32) -> f32 {
    let of = |name: &str| value(ARDUPILOT, ',', &format!("INS_TCAL2_{name}"));
    let c = |power: usize| of(&format!("GYR{power}_{}", ["X", "Y", "Z"][axis]));
    let d = temp_c.clamp(of("TMIN"), of("TMAX")) - 35.0;
    (c(1) + (c(2) + c(3) * d) * d) * d * 1e-6
}

fn written(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parameters");
    fs::write(&path, text).unwrap();
    (folder, path)
}

fn imported(text: &str, autopilot: Autopilot, instance: u32, unit: AxisUnit) -> CoefficientSet {
    let (_folder, path) = written(text);
    import_parameters(&path, autopilot, instance, unit, "S1")
        .unwrap()
        .set
}

/// The bias of an axis of a set, at rest, by the core.
fn bias(set: &CoefficientSet, axis: usize, temp_c: f32) -> f32 {
    let data = &set.channels[0].table;
    let cells = data.terms::<1>(axis);
    let table = data.table_over(axis, &cells).unwrap();
    let point = ThermalPoint {
        effective_c: temp_c.clamp(data.t_min_c, data.t_max_c),
        ..ThermalPoint::default()
    };
    table.bias(&point).0[0]
}

#[test]
fn a_set_of_parameters_computes_what_the_autopilot_computes() {
    type Peer = fn(usize, f32) -> f32;
    for (text, autopilot, instance, peer) in [
        (PX4, Autopilot::Px4, 1, px4 as Peer),
        (ARDUPILOT, Autopilot::ArduPilot, 2, ardupilot),
    ] {
        for (unit, per_rad) in [(AxisUnit::Radps, 1.0), (AxisUnit::Dps, 1_f32.to_degrees())] {
            let set = imported(text, autopilot, instance, unit);
            for axis in 0..3 {
                let temps_c = (-300..=1000).map(|tenths| tenths as f32 / 10.0);
                let expected: Vec<f32> = temps_c.clone().map(|t| per_rad * peer(axis, t)).collect();
                let range = expected.iter().copied().fold(f32::MIN, f32::max)
                    - expected.iter().copied().fold(f32::MAX, f32::min);
                let largest = expected.iter().map(|of| of.abs()).fold(0.0, f32::max);
                for (temp_c, expected) in temps_c.zip(expected) {
                    let off = (bias(&set, axis, temp_c) - expected).abs();
                    let allowed = 1e-4 * range + 1e-6 * largest;
                    assert!(
                        off <= allowed,
                        "{autopilot:?} {axis} {temp_c}: {off} {allowed}"
                    );
                }
            }
        }
    }
}

#[test]
fn parameters_come_back_as_they_were() {
    for (text, autopilot, instance, separator) in [
        (PX4, Autopilot::Px4, 1, '\t'),
        (ARDUPILOT, Autopilot::ArduPilot, 2, ','),
    ] {
        let set = imported(text, autopilot, instance, AxisUnit::Dph);
        let exported = export_parameters(&set, autopilot, instance, 2_293_768).unwrap();
        let (_folder, path) = written(&exported.text);
        let again = import_parameters(&path, autopilot, instance, AxisUnit::Dph, "S1").unwrap();
        for axis in 0..3 {
            let loss = &exported.losses[axis];
            assert!(loss.largest <= 2e-4 * loss.static_range + 1e-9, "{loss:?}");
            assert_eq!(loss.rate_and_history, 0.0);
            for temp_c in (-10..=70).map(|t| t as f32) {
                let (found, expected) = (bias(&again.set, axis, temp_c), bias(&set, axis, temp_c));
                let allowed = 3e-4 * loss.static_range as f32 + 1e-5 * expected.abs();
                assert!(
                    (found - expected).abs() <= allowed,
                    "{axis} {temp_c}: {found} {expected}"
                );
            }
        }
        for name in ["TMIN", "TMAX"] {
            let name = match autopilot {
                Autopilot::Px4 => format!("TC_G1_{name}"),
                Autopilot::ArduPilot => format!("INS_TCAL2_{name}"),
            };
            let [found, expected] =
                [&exported.text[..], text].map(|of| value(of, separator, &name));
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn what_is_lost_is_what_the_cubic_does_not_say() {
    let mut set = imported(PX4, Autopilot::Px4, 1, AxisUnit::Dps);
    let table = &mut set.channels[0].table;
    table.thermal.rate_max_c_per_min = 2.0;
    // A step of 0.1 deg/s in one cell, and a rate term.
    table.cells[1][0].a[0] += 0.1;
    table.cells[1][1].r = [0.03, 0.01];
    let losses = export_parameters(&set, Autopilot::Px4, 0, 1)
        .unwrap()
        .losses;
    assert!(
        losses[0].largest > 0.05 && losses[0].largest < 0.12,
        "{losses:?}"
    );
    assert!(losses[0].rms < losses[0].largest && losses[0].rms > 0.01);
    assert!(
        (losses[1].rate_and_history - 0.08).abs() < 1e-6,
        "{losses:?}"
    );
    assert_eq!(losses[0].rate_and_history, 0.0);
}

#[test]
fn what_cannot_be_is_refused() {
    let refused = |text: &str, autopilot, instance| {
        let (_folder, path) = written(text);
        import_parameters(&path, autopilot, instance, AxisUnit::Radps, "S1")
            .unwrap_err()
            .to_string()
    };
    for (text, autopilot, instance, words) in [
        (PX4, Autopilot::Px4, 0, "no parameter TC_G0_X0_0"),
        (
            ARDUPILOT,
            Autopilot::ArduPilot,
            1,
            "no parameter INS_TCAL1_GYR1_X",
        ),
        (
            "time_s,temp_c\n",
            Autopilot::Px4,
            0,
            "line 1: `time_s,temp_c`",
        ),
        (
            &PX4.replace("\t70\t", "\tnan\t"),
            Autopilot::Px4,
            1,
            "line 5",
        ),
        (
            &PX4.replace("\t70\t", "\t-10\t"),
            Autopilot::Px4,
            1,
            "0.1 to 1000 degC wide",
        ),
        (
            &PX4.replace("\t0.01\t", "\t1e30\t"),
            Autopilot::Px4,
            1,
            "beyond 1e20",
        ),
    ] {
        let message = refused(text, autopilot, instance);
        assert!(message.contains(words), "{message}");
    }
    let (_folder, path) = written(PX4);
    for unit in [AxisUnit::PulsesPerS, AxisUnit::G] {
        assert!(import_parameters(&path, Autopilot::Px4, 1, unit, "S1").is_err());
    }

    let set = imported(PX4, Autopilot::Px4, 1, AxisUnit::Dps);
    for (autopilot, instance) in [(Autopilot::Px4, 4), (Autopilot::ArduPilot, 0)] {
        let error = export_parameters(&set, autopilot, instance, 1).unwrap_err();
        assert!(error.contains("expected"), "{error}");
    }
    let changed = |change: fn(&mut CoefficientSet)| {
        let mut set = set.clone();
        change(&mut set);
        export_parameters(&set, Autopilot::ArduPilot, 1, 1).unwrap_err()
    };
    assert!(changed(|set| set.channels[0].axes[2].name = "w".to_owned()).contains("ends with z"));
    assert!(changed(|set| set.channels[0].axes[0].name = "gy".to_owned()).contains("ends with x"));
    assert!(changed(|set| set.channels.push(set.channels[0].clone())).contains("of their own"));
    assert!(changed(|set| set.channels[0].axes[1].unit = AxisUnit::PulsesPerS).contains("scale"));
    assert!(changed(|set| set.channels[0].table.t_max_c = -5.0).contains("10 degC"));
}
