//! What must not change the fit, and what the stated uncertainties are worth.

mod worlds;

use tempco::{Terms, Thermal, ThermalSettings};
use tempco_fit::{FitOptions, LagSearch, Method, fit};
use tempco_log::{AxisUnit, Log};
use tempco_set::run::{apply, thermal_points};
use tempco_set::{CoefficientSet, Model, Polynomial};
use worlds::{ChamberRun, Random, World, simulate};

fn options(model: Model) -> FitOptions {
    FitOptions::new("SIMULATED", model)
}

/// The largest difference of the coefficients of two sets, as a share of the largest of them.
fn difference(a: &CoefficientSet, b: &CoefficientSet, scale: f64) -> f64 {
    let numbers = |set: &CoefficientSet| -> Vec<f64> {
        let axes = set.channels[0].axes.iter();
        axes.flat_map(|axis| &axis.polynomials)
            .flat_map(Polynomial::coefficients)
            .collect()
    };
    let (a, b) = (numbers(a), numbers(b));
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let pairs = a.iter().zip(&b);
    pairs
        .map(|(a, b)| (a - b * scale).abs())
        .fold(0.0, f64::max)
        / largest
}

/// The search ends where steps gain little, which rounding may move.
fn allowed(model: Model) -> f64 {
    if model == Model::Auto { 1e-4 } else { 1e-9 }
}

/// Root mean square by which the applied biases of two sets differ on a log, the largest of the
/// axes, once their means differ by `offset` \[unit of the axes\].
fn apart(a: &CoefficientSet, b: &CoefficientSet, log: &Log, offset: f64) -> f64 {
    let [a, b] = [a, b].map(|set| apply(set, log).unwrap());
    let of_axis = a.axes.iter().zip(&b.axes).map(|(a, b)| {
        let pairs = a.bias.iter().zip(&b.bias);
        let squares: f64 = pairs
            .map(|(a, b)| (f64::from(b - a) - offset).powi(2))
            .sum();
        (squares / a.bias.len() as f64).sqrt()
    });
    of_axis.fold(0.0, f64::max)
}

/// In deg/h: a third of the errors that the default has in this world.
const APART: f64 = 1e-3;

#[test]
fn the_order_of_logs_does_not_matter() {
    let logs = [
        simulate(World::Full, ChamberRun::Verification, 1, 1).log,
        simulate(World::Full, ChamberRun::OneRate, 1, 2).log,
    ];
    let turned = [logs[1].clone(), logs[0].clone()];
    for (model, allowed) in [(Model::Composite, 1e-6), (Model::Auto, APART)] {
        let options = options(model);
        let [a, b] = [&logs, &turned].map(|logs| fit(logs, &options).unwrap().set);
        let apart = apart(&a, &b, &logs[0], 0.0);
        println!("{}: {apart:.1e} deg/h", model.name());
        assert!(apart < allowed);
    }
}

#[test]
fn units_do_not_matter() {
    let dph = simulate(World::Full, ChamberRun::OneRate, 2, 1).log;
    let mut dps = dph.clone();
    for axis in &mut dps.channels[0].axes {
        axis.unit = AxisUnit::Dps;
        axis.raw.iter_mut().for_each(|raw| *raw /= 3600.0);
    }
    for model in [Model::Composite, Model::Auto] {
        let options = options(model);
        let [a, b] = [&dph, &dps].map(|log| fit(std::slice::from_ref(log), &options).unwrap().set);
        let difference = difference(&a, &b, 3600.0);
        println!("{}: {difference:.1e}", model.name());
        assert!(difference < allowed(model));
    }
}

/// Two turn-on constants 0.2 deg/h apart: the shape is found as with one, and the set's constant
/// lies in the middle.
#[test]
fn the_constant_of_a_log_is_not_taken_for_thermal() {
    let first = simulate(World::Paper, ChamberRun::OneRate, 1, 1).log;
    let second = simulate(World::Paper, ChamberRun::Verification, 1, 2).log;
    let mut moved = second.clone();
    for axis in &mut moved.channels[0].axes {
        axis.raw.iter_mut().for_each(|raw| *raw += 0.2);
    }
    for model in [Model::Composite, Model::Auto] {
        let options = options(model);
        let same = fit(&[first.clone(), second.clone()], &options).unwrap().set;
        let apart = fit(&[first.clone(), moved.clone()], &options).unwrap().set;
        let apart_by = self::apart(&same, &apart, &first, 0.1);
        println!("{}: {apart_by:.1e} deg/h", model.name());
        assert!(apart_by < 2.0 * APART);
        let constants = &apart.channels[0].outliers.as_ref().unwrap().constants;
        let inputs = &apart.provenance.inputs;
        let of = |log: &Log| {
            let mut logs = inputs.iter().zip(constants);
            logs.find(|(input, _)| input.rows == log.rows()).unwrap().1[0]
        };
        let apart = of(&moved) - of(&first);
        assert!((apart - 0.2).abs() < 5e-3, "{constants:?}");
    }
}

/// Share of the 95 % intervals of many fits that hold the true coefficient: of all of an axis and of
/// its plays.
///
/// The lag is given and there is one rate, so no second lag: the intervals do not know of a search.
fn coverage(white: f64, walk: f64) -> (f64, f64) {
    let thermal = ThermalSettings {
        tau_s: 120.0,
        kappa: 0.5,
        rate_min_c_per_min: -50.0,
        rate_max_c_per_min: 50.0,
        ..ThermalSettings::DEFAULT
    };
    let mut log = simulate(World::Paper, ChamberRun::OneRate, 1, 1).log;
    let channel = &mut log.channels[0];
    channel.temp_c = channel.temp_c.iter().copied().step_by(10).collect();
    channel.axes.truncate(1);
    log.time_s = log.time_s.iter().copied().step_by(10).collect();
    log.interval_s = 10.0;
    // Up and down once; many fits of more would take long.
    log.time_s.truncate(2700);
    log.channels[0].temp_c.truncate(2700);
    let points = thermal_points(&log, 0, &Thermal::new(thermal).unwrap());
    let truth = points.iter().map(|point| {
        let u = f64::from(point.effective_c);
        let rate = f64::from(point.rate_c_per_min);
        1.0 + 0.02 * u - 3e-4 * u * u + 0.02 * (0.15 * u).sin() + rate * (0.3 + 0.002 * u)
    });
    let truth: Vec<f64> = truth.collect();
    let mut options = FitOptions::new("SIMULATED", Method::AUTO);
    options.plan.thermal = thermal;
    options.plan.search = LagSearch {
        tau: false,
        kappa: false,
    };
    let mut random = Random::new(9);
    let (mut inside, mut all) = ([0, 0], [0, 0]);
    log.channels[0].axes[0].raw.clone_from(&truth);
    let expected = fit(std::slice::from_ref(&log), &options).unwrap().set;
    let expected = &expected.channels[0].axes[0].polynomials;
    for _ in 0..FITS {
        let mut state = 0.0;
        let noisy = truth.iter().map(|bias| {
            state += walk * random.normal();
            bias + state + white * random.normal()
        });
        log.channels[0].axes[0].raw = noisy.collect();
        let set = fit(std::slice::from_ref(&log), &options).unwrap().set;
        let axis = &set.channels[0].axes[0];
        assert_eq!(axis.polynomials.len(), expected.len());
        let mut count = |of: usize, error: f64, sigma: f64| {
            inside[of] += usize::from(error.abs() < 1.959_964 * sigma);
            all[of] += 1;
        };
        let found = axis.polynomials.iter().zip(&axis.sigmas).zip(expected);
        for ((found, sigmas), expected) in found {
            let [found, expected] = [found, expected].map(Polynomial::coefficients);
            let lag2 = Terms::STATIC + Terms::RATE;
            let pairs = found.iter().zip(expected).zip(sigmas.to_array()).take(lag2);
            for ((found, expected), sigma) in pairs {
                assert!(sigma > 0.0);
                count(0, found - expected, sigma);
            }
        }
        // The truth has no plays.
        for play in axis.gains.iter().filter(|of| of.sigma > 0.0) {
            count(1, play.gain, play.sigma);
        }
    }
    println!("plays in {} of {}", all[1], 2 * FITS);
    let share = |of: usize| f64::from(inside[of] as u32) / f64::from(all[of].max(1) as u32);
    (share(0), share(1))
}

const FITS: usize = 40;

#[test]
fn intervals_of_95_percent_cover_the_truth() {
    let white = coverage(0.02, 0.0);
    println!("white noise: {white:.3?}");
    let walk = coverage(0.02, 0.001);
    println!("random walk: {walk:.3?}");
    assert!(white.0 >= 0.65, "{white:?}");
    assert!(walk.0 >= 0.65, "{walk:?}");
}

/// Logs that drift so slowly that each of them is one soak: there are no parts of which one could
/// be left out.
#[test]
fn logs_of_one_soak_each_are_chosen_for_like_others() {
    let mut noise = Random::new(1);
    let mut drift = |first_c: f64| {
        let mut log = simulate(World::Paper, ChamberRun::MidRamp, 1, 1).log;
        log.interval_s = 10.0;
        log.time_s = (0..1200).map(|row| 10.0 * f64::from(row)).collect();
        let temps_c = log.time_s.iter().map(|time_s| first_c + 0.001 * time_s);
        let temps_c: Vec<f64> = temps_c.collect();
        let channel = &mut log.channels[0];
        for axis in &mut channel.axes {
            let raw = temps_c.iter().map(|t| 1e-3 * t * t + 0.01 * noise.normal());
            axis.raw = raw.collect();
        }
        channel.temp_c = temps_c.iter().map(|&temp_c| temp_c as f32).collect();
        log
    };
    let logs = [10.0, 14.0, 18.0, 22.0, 26.0].map(&mut drift);
    let set = fit(&logs, &options(Model::Auto)).unwrap().set;
    let selection = set.channels[0].selection.as_ref().unwrap();
    assert_eq!((selection.soaks_and_ramps, selection.folds), (5, 16));
}
