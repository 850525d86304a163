//! How far accepted temperatures may go in a time, and what the status says of a reading that
//! jumps within the sensor's range and stays.

mod common;

use common::*;
use tempco::{Interval, Status, Thermal, ThermalPoint, ThermalSettings, ThermalState};

const JUMPED: Status = Status::TEMPERATURE_JUMPED;
const SPIKE: Status = Status::TEMPERATURE_SPIKE;
const SLEW_PER_S: f64 = 0.5;

/// A thermal path at a fixed interval.
struct Path {
    thermal: Thermal,
    state: ThermalState,
    interval: Interval,
}

impl Path {
    fn new(settings: ThermalSettings, dt_s: f32, temp_c: f32) -> Self {
        let thermal = thermal(settings);
        let mut state = ThermalState::new(&thermal);
        state.start(&thermal, temp_c);
        let interval = Interval::new(&thermal, dt_s);
        Self {
            thermal,
            state,
            interval,
        }
    }

    fn take(&mut self, temp_c: f32) -> ThermalPoint {
        self.state.update(&self.thermal, &self.interval, temp_c)
    }

    fn takes_and_accepts(&mut self, temp_c: f32) -> bool {
        let rejected = self.state.rejected();
        self.take(temp_c);
        self.state.rejected() == rejected
    }

    fn has_jumped(&mut self, temps: impl IntoIterator<Item = f32>) -> bool {
        let temps = temps.into_iter();
        temps.fold(false, |_, temp| self.take(temp).status.contains(JUMPED))
    }
}

/// At every size and place: each reading is a spike until one is accepted, and from then on the
/// flag is there for good.
#[test]
fn a_jump_that_stays_is_flagged_until_the_next_start() {
    let sizes = [
        2.7, 3.0, 5.0, 12.0, 31.0, 32.4, 32.7, 33.1, 60.0, 120.0, 209.0,
    ];
    for &dt_s in first(&[1.0, 0.1, 0.01], 1) {
        for place in [-60.0_f32, -45.3, 0.0, 25.0, 80.0, 150.0] {
            let ends = sizes.iter().flat_map(|size| [place - size, place + size]);
            for end in ends.filter(|end| (-60.0..=150.0).contains(end)) {
                let mut path = Path::new(SETTINGS, dt_s, place);
                assert!(!path.has_jumped([place; 50]));
                let mut updates = 0;
                while !path.takes_and_accepts(end) {
                    updates += 1;
                    assert!(path.take(f32::NAN).status.bits() & JUMPED.bits() == 0);
                }
                let waited_s = 2.0 * updates as f32 * dt_s;
                let size = (end - place).abs();
                let needed_s = ((size - 2.0) / 0.5).min(60.0);
                assert!(
                    (waited_s - needed_s).abs() <= 3.0 * dt_s + 1e-3,
                    "{size} {waited_s}"
                );
                for _ in 0..(1000.0 / dt_s) as usize {
                    assert!(path.take(end).status.contains(JUMPED), "{place} to {end}");
                }
                assert_eq!(path.take(end).status, JUMPED);
                path.state.start(&path.thermal, end);
                assert!(!path.has_jumped([end; 50]));
            }
        }
    }
}

/// A jump in the middle of a ramp, and one that is hidden between readings that are none.
#[test]
fn a_jump_in_a_ramp_is_flagged() {
    for gap in [0, 1, 3] {
        for rate in [-10.0_f32, 5.0, 25.0] {
            let mut path = Path::new(SETTINGS, 1.0, 40.0);
            let temp = |s: i32| 40.0 + rate / 60.0 * s as f32;
            assert!(!path.has_jumped((1..60).map(temp)));
            let readings = (60..200).flat_map(|s| {
                let jumped = temp(s) + if rate > 0.0 { -20.0 } else { 20.0 };
                std::iter::once(jumped).chain(std::iter::repeat_n(f32::NAN, gap))
            });
            assert!(path.has_jumped(readings), "{rate}");
        }
    }
}

#[test]
fn what_the_part_can_do_is_no_jump() {
    // Ramps at the limit, with the noise of a sensor on them.
    for &(dt_s, noise_c) in first(&[(1.0, 0.5), (0.1, 0.9), (0.01, 0.9), (0.001, 0.5)], 1) {
        let mut noise = Noise(7);
        let mut path = Path::new(SETTINGS, dt_s, -55.0);
        let count = (200.0 / 0.5 / dt_s) as usize;
        for i in (0..count).chain((0..count).rev()) {
            let temp = (-55.0 + SLEW_PER_S * f64::from(dt_s) * i as f64) as f32;
            let read = temp + noise.between(-noise_c, noise_c);
            assert!(path.takes_and_accepts(read), "{i} of {dt_s} s");
        }
        assert!(!path.has_jumped([-55.0]));
    }
}

#[test]
fn faults_after_which_the_sensor_is_right_again_are_no_jump() {
    let missing = |count| std::iter::repeat_n(f32::NAN, count);
    // A return anywhere after a loss that was long enough.
    for back in [-60.0, -10.0, 21.0, 150.0] {
        let mut path = Path::new(SETTINGS, 1.0, 20.0);
        assert!(!path.has_jumped(missing(400).chain([back; 300])), "{back}");
    }
    // Garbage first, soon after the loss, and a part that has moved meanwhile.
    for garbage in [&[140.0][..], &[140.0, 90.0], &[-55.0, f32::NAN, 140.0]] {
        for moved in [0.0, 4.0, -8.0] {
            let mut path = Path::new(SETTINGS, 1.0, 20.0);
            let readings = missing(61).chain(garbage.iter().copied());
            assert!(!path.has_jumped(readings.chain([20.0 + moved; 300])));
        }
    }
    // A spike before the loss, and a part that has moved meanwhile.
    let mut path = Path::new(SETTINGS, 1.0, 20.0);
    let spike = std::iter::once(120.0);
    assert!(!path.has_jumped(spike.chain(missing(90)).chain([40.0; 300])));
    // Spikes, one or several, on a ramp.
    let mut path = Path::new(SETTINGS, 1.0, 20.0);
    let spoilt = |s: i32| {
        if s % 30 < 4 {
            120.0
        } else {
            20.0 + 0.1 * s as f32
        }
    };
    assert!(!path.has_jumped((1..400).map(spoilt)));
    // Readings that come without time.
    let mut path = Path::new(SETTINGS, 1.0, 20.0);
    let none = Interval::new(&path.thermal, 0.0);
    for _ in 0..100 {
        path.state.update(&path.thermal, &none, 90.0);
        assert!(!path.has_jumped([22.4]));
        assert!(!path.has_jumped([20.0]));
    }
    // The same before the part has moved unseen.
    path.state.update(&path.thermal, &none, 90.0);
    assert!(!path.has_jumped(missing(20).chain([26.0; 100])));
}

/// A jump from one side of the noise past the other: the anchor allows it before the last accepted
/// reading does, which makes it no less of a jump.
#[test]
fn a_jump_from_the_edge_of_the_noise_is_flagged() {
    for &dt_s in first(&[1.0, 0.01], 1) {
        let mut path = Path::new(SETTINGS, dt_s, 20.0);
        path.has_jumped([20.0; 20].into_iter().chain([18.2]));
        assert!(path.has_jumped(vec![24.5; (20.0 / dt_s) as usize]));
    }
}

/// Where the first temperature comes late there was none before it to jump from, however slow the
/// part is.
#[test]
fn the_first_temperature_of_all_is_no_jump() {
    let settings = ThermalSettings {
        max_slew_c_per_min: 1e-3,
        ..SETTINGS
    };
    for never in [1, 100] {
        let mut path = Path::new(settings, 1.0, f32::NAN);
        assert!(!path.has_jumped(vec![f32::NAN; never]));
        assert!(!path.has_jumped([70.0; 300]));
        assert!(path.has_jumped([90.0; 300]));
    }
}

/// Once a jump was flagged, good readings do not clear it.
#[test]
fn a_loss_after_a_jump_does_not_clear_the_flag() {
    let mut path = Path::new(SETTINGS, 1.0, 20.0);
    assert!(path.has_jumped([50.0; 100]));
    assert!(path.has_jumped([f32::NAN; 300]));
    assert!(path.has_jumped([20.0; 300]));
    path.state.start(&path.thermal, f32::NAN);
    assert!(!path.has_jumped([f32::NAN]));
}

/// Whatever the readings, between two accepted ones lies no more than what the part can have gone
/// and the gate on either side.
#[test]
fn the_gate_holds_per_time_whatever_the_readings() {
    let settings = ThermalSettings {
        hold_s: 2e4,
        ..SETTINGS
    };
    for &dt_s in first(&[0.01, 0.001, 1.0], 1) {
        let steps = |noise: &mut Noise, kind| match kind {
            0 => 0.5,
            1 => noise.between(-2.0, 2.4),
            2 => noise.between(1.9, 2.1),
            3 => [f32::NAN, 2.004][noise.bits() as usize % 2],
            4 => [-1.9, 3.8][noise.bits() as usize % 2],
            _ => noise.between(-100.0, 100.0),
        };
        for kind in 0..6 {
            let mut noise = Noise(11 + kind);
            let mut path = Path::new(settings, dt_s, 0.0);
            let mut accepted = vec![(0.0_f64, 0.0_f64)];
            let mut last = 0.0_f32;
            for i in 1..=fewer(20_000, 200) {
                let temp = last + steps(&mut noise, kind);
                let time_s = i as f64 * f64::from(dt_s);
                if path.takes_and_accepts(temp) {
                    last = temp;
                    accepted.push((time_s, f64::from(temp)));
                } else if noise.bits().is_multiple_of(64) {
                    last = last.clamp(-50.0, 50.0) * 0.9;
                }
            }
            // What is above the line of the slew, less the least so far, is what was gained.
            for direction in [-1.0, 1.0] {
                let mut least = f64::INFINITY;
                for (time_s, temp) in &accepted {
                    let above = direction * temp - SLEW_PER_S * time_s;
                    let gained = above - least;
                    least = least.min(above);
                    assert!(
                        gained <= 4.0 + 0.01 * SLEW_PER_S * time_s + 1e-3,
                        "kind {kind}, {dt_s} s: {gained} degC at {time_s} s"
                    );
                }
            }
            assert!(accepted.len() > 50, "kind {kind}: {}", accepted.len());
        }
    }
}

/// Small jumps that come faster than the part can move are spikes, not a ramp.
#[test]
fn many_small_jumps_are_rejected() {
    for &dt_s in first(&[0.01, 0.001], 1) {
        let mut path = Path::new(SETTINGS, dt_s, 20.0);
        let outs: Vec<Status> = (1..20).map(|i| path.take(20.0 + i as f32).status).collect();
        assert!(outs[..2].iter().all(|status| !status.contains(SPIKE)));
        assert!(outs[2..].iter().all(|status| status.contains(SPIKE)));
    }
}

/// A reading must be within reach of the last accepted one, too, and not of the anchor alone.
#[test]
fn from_one_side_of_the_anchor_to_the_other_is_a_spike() {
    for &dt_s in first(&[0.01, 1.0], 1) {
        for side in [1.4, -1.9] {
            let mut path = Path::new(SETTINGS, dt_s, 20.0);
            assert!(path.takes_and_accepts(20.0 + side));
            assert_eq!(path.take(20.0 - side).status, SPIKE | Status::SETTLING);
            assert!(!path.has_jumped([20.0; 100]));
        }
    }
}

/// After readings were missing the gate is about where the part is by then, so that nothing that
/// follows is rejected.
#[test]
fn the_gate_follows_over_missing_readings() {
    for &dt_s in first(&[0.01, 1.0, 0.1], 1) {
        for missing_s in [3.0_f32, 10.0, 50.0] {
            for rate in [2.0_f32, 20.0, 29.0] {
                let mut path = Path::new(SETTINGS, dt_s, 0.0);
                let temp = |i: usize| rate / 60.0 * dt_s * i as f32;
                let lost = (missing_s / dt_s) as usize;
                assert!((1..100).all(|i| path.takes_and_accepts(temp(i))));
                path.has_jumped(vec![f32::NAN; lost]);
                let after = 100 + lost..100 + lost + (20.0 / dt_s) as usize;
                // Noise of three quarters of the gate.
                let read = |i: usize| temp(i) + [0.75, -0.75][i % 2];
                assert!(after.into_iter().all(|i| path.takes_and_accepts(read(i))));
                assert!(!path.has_jumped([f32::NAN]));
            }
        }
    }
    // Two jumps of nearly the gate: the second is taken once the part can have got there, and
    // then stays taken.
    let mut path = Path::new(SETTINGS, 0.01, 0.0);
    assert!(path.takes_and_accepts(1.9));
    let waited = (0..1000).position(|_| path.takes_and_accepts(3.8));
    assert!((350..370).contains(&waited.unwrap()), "{waited:?}");
    assert!((0..1000).all(|_| path.takes_and_accepts(3.8)));
    assert!(path.has_jumped([3.8]));
}
