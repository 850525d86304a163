//! What is accepted and refused at the very limits, and what the refusals and flags say.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{
    Interval, MAX_CELLS, Status, Table, TableError, Terms, Thermal, ThermalSettings, ThermalState,
};

const CELL: [Terms; 1] = [Terms::new([1.0, 2.0, 3.0], [4.0, 5.0])];

/// A range of a sensor whose middle is no round number.
fn sensor(sensor_min_c: f32, sensor_max_c: f32) -> Thermal {
    thermal(ThermalSettings {
        sensor_min_c,
        sensor_max_c,
        reference_c: sensor_min_c,
        ..SETTINGS
    })
}

fn believes(thermal: &Thermal, temp_c: f32) -> bool {
    let mut state = ThermalState::new(thermal);
    let point = state.start(thermal, temp_c);
    assert_eq!(state.restarts() == 1, point.status == Status::SETTLING);
    state.restarts() == 1
}

/// Each name belongs to the setting in its place, in both directions.
#[test]
fn settings_are_an_array_with_names_and_back() {
    let values = SETTINGS.to_array();
    assert_eq!(ThermalSettings::from_array(values), SETTINGS);
    for (place, name) in ThermalSettings::NAMES.into_iter().enumerate() {
        let mut spoilt = values;
        spoilt[place] = f32::NAN;
        let settings = ThermalSettings::from_array(spoilt);
        assert!(settings.to_array()[place].is_nan());
        assert_eq!(Thermal::new(settings), Err(TableError::Setting(name)));
    }
}

#[test]
fn each_setting_is_accepted_up_to_its_limits_and_not_beyond() {
    macro_rules! limits {
        ($($name:ident: $low:expr, $high:expr;)+) => {$(
            for (limit, beyond) in [($low, f32::next_down($low)), ($high, f32::next_up($high))] {
                let at = ThermalSettings { $name: limit, ..SETTINGS };
                assert_eq!(Thermal::new(at).map(|thermal| *thermal.settings()), Ok(at));
                let refused = Thermal::new(ThermalSettings { $name: beyond, ..SETTINGS });
                assert_eq!(refused, Err(TableError::Setting(stringify!($name))));
            }
        )+};
    }
    limits! {
        spike_gate_c: 1e-3, 1e3;
        max_slew_c_per_min: 1e-3, 1e4;
        hold_s: 0.0, 2e4;
        heal_s: 0.0, 2e4;
        tau_s: 0.1, 6e3;
        kappa: 0.0, 2.0;
        rate_min_c_per_min: -1e4, 0.0;
        rate_max_c_per_min: 0.0, 1e4;
        reference_c: -60.0, 150.0;
        tau2_s: 0.1, 6e4;
        kappa2: -2.0, 2.0;
        lag2_min_c: -1e3, 0.0;
        lag2_max_c: 0.0, 1e3;
        half_width1_c: 0.0, 1e3;
        half_width2_c: 0.0, 1e3;
        play_kappa: -2.0, 2.0;
        play_kappa2: -2.0, 2.0;
        least_divisor: 0.0, 1.0;
        rate_start: 0.0, 1e2;
        lag2_start_min: -1e3, 1e3;
        play_start_min: -1e3, 1e3;
    }
    let range = |sensor_min_c, sensor_max_c| {
        let thermal = Thermal::new(ThermalSettings {
            sensor_min_c,
            sensor_max_c,
            reference_c: sensor_min_c,
            ..SETTINGS
        });
        thermal.map(|_| ())
    };
    let refused = |name| Err(TableError::Setting(name));
    assert_eq!(range(-273.15, 1e3), Ok(()));
    assert_eq!(range(20.0, 20.0), Ok(()));
    assert_eq!(range(1e3, 1e3), Ok(()));
    let below = f32::next_down(-273.15);
    assert_eq!(range(below, 1e3), refused("sensor_min_c"));
    assert_eq!(range(f32::next_up(1e3), 2e3), refused("sensor_min_c"));
    assert_eq!(range(0.0, f32::next_up(1e3)), refused("sensor_max_c"));
    assert_eq!(range(20.0, f32::next_down(20.0)), refused("sensor_max_c"));
}

#[test]
fn a_table_is_accepted_up_to_its_limits_and_not_beyond() {
    let edges = |first, last| Table::new(THERMAL, first, last, &[CELL]).map(|_| ());
    let refused = |name| Err(TableError::Setting(name));
    assert_eq!(edges(-273.15, 1e3), Ok(()));
    assert_eq!(edges(f32::next_down(-273.15), 1e3), refused("first_edge_c"));
    assert_eq!(edges(0.0, f32::next_up(1e3)), refused("last_edge_c"));
    assert_eq!(edges(0.0, 1e-3), Ok(()));
    assert_eq!(edges(0.0, f32::next_down(1e-3)), refused("last_edge_c"));
    assert_eq!(edges(10.0, 9.9995), refused("last_edge_c"));

    let cells = |count| Table::new(THERMAL, 0.0, 1.0, &vec![CELL; count]).map(|_| ());
    assert_eq!(cells(0), Err(TableError::CellCount));
    assert_eq!(cells(1), Ok(()));
    assert_eq!(cells(MAX_CELLS), Ok(()));
    assert_eq!(cells(MAX_CELLS + 1), Err(TableError::CellCount));

    for (coefficient, accepted) in [
        (1e20, true),
        (-1e20, true),
        (f32::next_up(1e20), false),
        (f32::next_down(-1e20), false),
    ] {
        for place in 0..Terms::COUNT {
            let mut values = CELL[0].to_array();
            values[place] = coefficient;
            let cell = [Terms::from_array(values)];
            let found = Table::new(THERMAL, 0.0, 1.0, &[CELL, cell]).map(|_| ());
            let error = TableError::Coefficient { cell: 1, axis: 0 };
            assert_eq!(found, if accepted { Ok(()) } else { Err(error) });
        }
    }
}

#[test]
fn a_table_returns_what_it_was_made_of() {
    let cells = [CELL; 4];
    let table = Table::new(THERMAL, -20.5, 59.5, &cells).unwrap();
    assert_eq!((table.t_min_c(), table.t_max_c()), (-20.5, 59.5));
    let narrow = table.calibrated(-10.0, 50.0).unwrap();
    assert_eq!((narrow.t_min_c(), narrow.t_max_c()), (-10.0, 50.0));
    for table in [table, narrow] {
        assert_eq!(table.thermal(), &THERMAL);
        assert_eq!(table.first_edge_c(), -20.5);
        assert_eq!(table.cells(), &cells);
        // Four cells over 80 degC, less one rounding.
        assert_eq!(table.cells_per_c(), f32::next_down(0.05));
    }
    // The whole range and a single temperature are calibrated ranges.
    assert_eq!(table.calibrated(-20.5, 59.5), Ok(table));
    let one = table.calibrated(59.5, 59.5).unwrap();
    assert_eq!(one.place(59.5).status, Status::OK);
}

#[test]
fn refusals_say_what_was_wrong() {
    for (error, message, display) in [
        (
            TableError::Setting("tau_s"),
            "tau_s",
            "setting tau_s is not finite or out of range",
        ),
        (
            TableError::CellCount,
            "a table needs 1 to 1024 cells",
            "a table needs 1 to 1024 cells",
        ),
        (
            TableError::Coefficient { cell: 3, axis: 2 },
            "a coefficient is not finite or beyond 1e20",
            "a coefficient is not finite or beyond 1e20 (cell 3, axis 2)",
        ),
    ] {
        assert_eq!(error.message(), message);
        assert_eq!(error.to_string(), display);
    }
}

/// Flags are independent bits: a set of them contains its parts and meets what shares one.
#[test]
fn flags_are_sets() {
    for bits in (0..=u16::MAX).step_by(if cfg!(miri) { 251 } else { 1 }) {
        let set = Status::from_bits(bits);
        assert_eq!(set.bits(), bits);
        for (flag, _) in Status::NAMES {
            let present = bits & flag.bits() != 0;
            assert_eq!(set.contains(flag), present);
            assert_eq!(set.intersects(flag), present);
            assert_eq!((set & flag).bits(), bits & flag.bits());
            let mut with = set;
            with |= flag;
            assert_eq!(with, set | flag);
            assert_eq!(with.bits(), bits | flag.bits());
            assert!(with.contains(set) && with.contains(flag));
        }
        assert!(set.contains(Status::OK) && !set.intersects(Status::OK));
    }
    let two = Status::SETTLING | Status::RATE_CLAMPED;
    assert!(two.intersects(Status::SETTLING | Status::RAW_INVALID));
    assert!(!two.contains(Status::SETTLING | Status::RAW_INVALID));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(2000), failure_persistence: None, ..Default::default() })]

    /// The rails belong to the range also where its middle is rounded.
    #[test]
    fn the_rails_of_any_sensor_are_good_and_a_little_beyond_is_not(
        min in -273.0_f32..150.0,
        width in prop_oneof![0.001_f32..1.0, 1.0_f32..800.0],
    ) {
        let max = min + width;
        let sensor = sensor(min, max);
        prop_assert!(believes(&sensor, min) && believes(&sensor, max));
        for beyond in [min - 1e-3, max + 1e-3, f32::NAN] {
            prop_assert!(!believes(&sensor, beyond), "{}", beyond);
        }
    }
}

#[test]
fn the_rails_of_a_range_that_rounds_to_either_side_are_good() {
    // The middle is rounded towards the hot end, so that the cold one is farther, and reversed.
    let mut farther = [0; 2];
    for step in 0..2000 {
        let (min, max) = (-0.1 - 0.003 * step as f32, 37.3 + 0.07 * step as f32);
        let middle = 0.5 * (min + max);
        let (below, above) = ((min - middle).abs(), (max - middle).abs());
        farther[usize::from(above > below)] += usize::from(above != below);
        let sensor = sensor(min, max);
        assert!(believes(&sensor, min) && believes(&sensor, max), "{step}");
    }
    assert!(farther.iter().all(|&count| count > 0), "{farther:?}");
}

/// Each border of the interval, and that an update of the least time moves what f32 can resolve.
#[test]
fn intervals_at_their_limits() {
    let status = |dt_s: f32| {
        let mut state = ThermalState::new(&THERMAL);
        state.start(&THERMAL, 20.0);
        let point = state.update(&THERMAL, &Interval::new(&THERMAL, dt_s), 20.0);
        point.status.contains(Status::INTERVAL_INVALID)
    };
    assert_eq!(THERMAL.longest_interval_s(), 30.0);
    for valid in [f32::from_bits(1), 1e-6, 30.0] {
        assert!(!status(valid), "{valid}");
    }
    for invalid in [
        0.0,
        -0.0,
        -1e-6,
        f32::next_up(30.0),
        f32::INFINITY,
        f32::NAN,
    ] {
        assert!(status(invalid), "{invalid}");
    }
}

/// However short the time, the lag-compensated temperature moves by what f32 can resolve: else it would
/// never arrive.
#[test]
fn the_shortest_updates_move_the_effective_temperature() {
    for (start, ends) in [(20.0, 20.002), (140.0, 140.001_53)] {
        let shortest = Interval::new(&THERMAL, 1e-6);
        let mut state = ThermalState::new(&THERMAL);
        state.start(&THERMAL, start);
        let points = (0..100).map(|_| state.update(&THERMAL, &shortest, start + 1.0));
        let last = points.last().unwrap();
        // By the slew alone it would be 5e-7 degC each, which vanishes.
        assert!((last.effective_c - ends).abs() < 1e-4, "{last:?}");
    }
}

/// That no time has passed since power-on is no flag.
#[test]
fn a_start_without_a_temperature_says_what_is_missing() {
    for missing in [f32::NAN, -60.1, f32::INFINITY] {
        let mut state = ThermalState::new(&THERMAL);
        let point = state.start(&THERMAL, missing);
        let expected = Status::TEMPERATURE_INVALID | Status::TEMPERATURE_LOST | Status::SETTLING;
        assert_eq!(point.status, expected);
        assert_eq!(point.effective_c, SETTINGS.reference_c);
        assert_eq!((state.rejected(), state.restarts()), (1, 0));
    }
}
