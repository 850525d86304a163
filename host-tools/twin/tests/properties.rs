//! Any valid unit on any valid profile gives finite output; what is not valid is refused.

use proptest::prelude::*;
use tempco_twin::{
    Axis, Drift, GyroNoise, LegendreSeries, ModeSteps, Output, Part, Play, Profile, ProfileParts,
    RateUnit, Simulation, StaticCurve, Step, TemperatureReading, ThermalNetwork, Tone, Unit,
};

/// Both ends of a range, and what lies between.
fn between(low: f64, high: f64) -> BoxedStrategy<f64> {
    prop_oneof![1 => Just(low), 1 => Just(high), 4 => low..high].boxed()
}

fn signed() -> BoxedStrategy<f64> {
    prop_oneof![2 => -1.0..1.0, 1 => between(-1e9, 1e9)].boxed()
}

fn magnitude() -> BoxedStrategy<f64> {
    prop_oneof![Just(0.0), 0.0..1.0, between(0.0, 1e9)].boxed()
}

fn time_constant() -> BoxedStrategy<f64> {
    prop_oneof![1.0..1000.0, between(0.001, 1e7)].boxed()
}

prop_compose! {
    fn axis()(
        coefficients in prop::collection::vec(signed(), 1..=32),
        [rate, gradient, gain, step, slope_per_c] in
            [signed(), signed(), signed(), signed(), signed()],
        slope in between(-1.0, 1.0),
        half_width_c in between(1e-6, 300.0),
        spacing_c in between(0.1, 300.0),
        [turn_on_sigma, bias_instability, rate_random_walk, walk, white] in
            [magnitude(), magnitude(), magnitude(), magnitude(), magnitude()],
    ) -> Axis {
        Axis {
            static_curve: StaticCurve::Legendre(LegendreSeries {
                range_c: [-40.0, 85.0],
                coefficients,
            }),
            rate_sensitivity: rate,
            rate_sensitivity_slope_per_c: slope,
            gradient_sensitivity: gradient,
            play: vec![Play { half_width_c, gain }; 2],
            modes: Some(ModeSteps { spacing_c, overlap_c: 0.2 * spacing_c, step, slope_per_c }),
            drift: Drift { turn_on_sigma, bias_instability, rate_random_walk },
            noise: GyroNoise { angle_random_walk: walk, angle_white_noise: white },
        }
    }
}

prop_compose! {
    fn output()(kind in 0..4, scale in between(1e-6, 1e6), step in between(1e-5, 1e6))
        -> (RateUnit, Output)
    {
        let pulses = Output::Pulses { scale_factor_arcsec: scale };
        let rate = Output::Rate { step, full_scale: 1e9 };
        match kind {
            0 => (RateUnit::PulsesPerS, pulses),
            1 => (RateUnit::Dph, pulses),
            2 => (RateUnit::Dph, rate),
            _ => (RateUnit::Dps, rate),
        }
    }
}

prop_compose! {
    fn unit()(
        (rate_unit, output) in output(),
        [case, cavity, sensor, block] in
            [time_constant(), time_constant(), time_constant(), time_constant()],
        solid in any::<bool>(),
        on_block in any::<bool>(),
        rise in between(-50.0, 50.0),
        sigma_c in between(0.0, 100.0),
        step_c in between(0.0, 50.0),
        frequency_hz in between(1e-6, 1e5),
        amplitude in signed(),
        lost_rows in between(0.0, 0.5),
        axes in [axis(), axis(), axis()],
    ) -> Unit {
        Unit {
            name: "any".to_owned(),
            description: String::new(),
            rate_unit,
            output,
            thermal: ThermalNetwork {
                case_time_constant_s: case,
                block_time_constant_s: if solid { 0.0 } else { block },
                cavity_time_constant_s: [cavity, case, cavity],
                sensor_time_constant_s: if solid { sensor } else { 0.0 },
                sensor_on: if on_block { Part::Block } else { Part::Case },
                case_rise_c: rise,
                block_rise_c: if solid { 0.0 } else { rise },
                cavity_rise_c: [rise; 3],
            },
            temperature: TemperatureReading { sigma_c, step_c, rails_c: [-99.0, 199.0] },
            tone: vec![Tone {
                frequency_hz,
                amplitude: [amplitude; 3],
                wander_hz: 0.1 * frequency_hz,
                wander_time_s: 10.0,
            }],
            lost_rows,
            axes,
        }
    }
}

fn parts() -> ProfileParts {
    ProfileParts {
        start_c: 20.0,
        cold_start: true,
        step: vec![
            Step::Ramp {
                to_c: 200.0,
                rate_c_per_min: 100.0,
            },
            Step::Soak {
                air_c: -100.0,
                duration_min: 0.5,
            },
            Step::Sine {
                mean_c: 20.0,
                amplitude_c: 30.0,
                period_min: 2.0,
                count: 2,
            },
        ],
        ..ProfileParts::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_valid_unit_gives_finite_output(unit in unit(), rate_hz in between(0.01, 100.0)) {
        unit.check().unwrap();
        let profile = Profile::from_parts("any", parts()).unwrap();
        for sample in Simulation::new(&unit, &profile, 1, rate_hz).unwrap().take(2000) {
            prop_assert!(sample.time_s.is_finite() && sample.temp_c.is_finite());
            prop_assert!((-99.0..=199.0).contains(&sample.temp_c));
            for axis in 0..3 {
                prop_assert!(sample.truth.cavity_c[axis].is_finite());
                prop_assert!(sample.truth.bias[axis].is_finite());
                prop_assert!(sample.counts[axis].unsigned_abs() <= 1 << 53);
            }
        }
    }

    #[test]
    fn what_is_not_a_number_is_refused(mut unit in unit(), which in 0_usize..8) {
        *[
            &mut unit.thermal.case_time_constant_s,
            &mut unit.thermal.cavity_rise_c[1],
            &mut unit.temperature.sigma_c,
            &mut unit.tone[0].amplitude[2],
            &mut unit.lost_rows,
            &mut unit.axes[0].rate_sensitivity,
            &mut unit.axes[1].play[1].gain,
            &mut unit.axes[2].noise.angle_white_noise,
        ][which] = f64::NAN;
        prop_assert!(unit.check().is_err());
        let profile = Profile::named("short").unwrap();
        prop_assert!(Simulation::new(&unit, &profile, 1, 2.0).is_err());
    }
}
