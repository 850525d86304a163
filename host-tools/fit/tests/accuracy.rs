//! The applied bias against the truth, on chamber runs that were not fitted.

mod worlds;

use tempco_fit::{FitOptions, Method, SegmentModel, SegmentOverlap, fit};
use tempco_set::run::apply;
use tempco_set::{CoefficientSet, Model};

use worlds::{ChamberRun, Random, Run, World, simulate};

const PAPER_SEGMENTS: &str = "-15:15,5:35,25:60,50:80";

fn options(model: Model) -> FitOptions {
    let overlap = SegmentOverlap::Smooth;
    let segmentation = Some(PAPER_SEGMENTS.parse().unwrap());
    let method = match model {
        Model::Static | Model::Composite => Method::Segments {
            model: match model {
                Model::Static => SegmentModel::Static,
                _ => SegmentModel::Composite,
            },
            overlap,
            segmentation,
        },
        Model::Spline | Model::Auto => Method::Auto {
            overlap,
            segmentation,
        },
    };
    FitOptions::new("SIMULATED", method)
}

fn fitted(model: Model, run: &Run) -> CoefficientSet {
    fit(std::slice::from_ref(&run.log), &options(model))
        .unwrap()
        .set
}

/// Root mean square of applied bias less truth \[mdeg/h\], by axis, over `rows`.
fn errors(set: &CoefficientSet, run: &Run, rows: std::ops::Range<usize>) -> Vec<f64> {
    let applied = apply(set, &run.log).unwrap();
    let of_axis = applied.axes.iter().zip(&run.truth);
    of_axis
        .map(|(output, truth)| {
            let pairs = output.bias[rows.clone()].iter().zip(&truth[rows.clone()]);
            let squares: f64 = pairs.map(|(b, t)| (f64::from(*b) - t).powi(2)).sum();
            1e3 * (squares / rows.len() as f64).sqrt()
        })
        .collect()
}

fn whole(set: &CoefficientSet, run: &Run) -> Vec<f64> {
    errors(set, run, 0..run.log.rows())
}

fn geometric_mean(values: &[f64]) -> f64 {
    (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp()
}

/// What was chosen.
fn description(set: &CoefficientSet) -> String {
    let channel = &set.channels[0];
    channel.selection.as_ref().map_or_else(String::new, |selection| {
        let of = &selection.chosen;
        format!(
            "{} segments, {} columns, tau {:.0} s, kappa {:.2}, plays {:.2?} degC, second lag {:.0?} s",
            of.segments, of.columns, of.tau_s, of.kappa, of.half_widths_c, of.tau2_s
        )
    })
}

/// No axis may be worse than the paper's composite by more than this and not say so.
const MOST_WORSE: f64 = 1.15;

/// Ratios of the errors of the default to the paper's composite, over three units of three axes.
struct Ratios {
    mean: f64,
    worst: f64,
    first_minutes: f64,
}

fn ratios(world: World, chamber_run: ChamberRun) -> Ratios {
    let (mut found, mut first) = (Vec::new(), Vec::new());
    for unit in 1..=3 {
        let train = simulate(world, chamber_run, unit, 1);
        let judge = simulate(world, ChamberRun::Verification, unit, 2);
        let mid_ramp = simulate(world, ChamberRun::MidRamp, unit, 3);
        let [paper, set] = [Model::Composite, Model::Auto].map(|model| fitted(model, &train));
        let (before, after) = (whole(&paper, &judge), whole(&set, &judge));
        println!(
            "{}: composite {before:.2?}, default {after:.2?} mdeg/h",
            train.log.file
        );
        println!("  {}", description(&set));
        for channel in &set.channels {
            let outliers = channel.outliers.as_ref().unwrap();
            assert_eq!((outliers.spike_rows, outliers.disturbed_rows), (0, 0));
            assert!(outliers.steps.is_empty(), "{:?}", outliers.steps);
            assert!((0..3).all(|axis| channel.table.max_jump(axis) == 0.0));
            // An axis that is worse than the paper's model says so.
            let axes = channel.axes.iter().zip(after.iter().zip(&before));
            for (axis, (after, before)) in axes {
                let is_said = axis.held_out.unwrap().surpassed.is_some();
                assert!(is_said || *after < MOST_WORSE * before, "{after} {before}");
            }
        }
        found.extend(
            after
                .iter()
                .zip(&before)
                .map(|(after, before)| after / before),
        );
        let ten_minutes = |set| errors(set, &mid_ramp, 0..600);
        first.extend(
            ten_minutes(&set)
                .iter()
                .zip(ten_minutes(&paper))
                .map(|(a, b)| a / b),
        );
    }
    let ratios = Ratios {
        mean: geometric_mean(&found),
        worst: found.iter().copied().fold(0.0, f64::max),
        first_minutes: geometric_mean(&first),
    };
    println!(
        "{world:?} {chamber_run:?}: ratio to the composite {:.3}, worst axis {:.3}; first ten \
         minutes in mid-ramp {:.3}",
        ratios.mean, ratios.worst, ratios.first_minutes
    );
    ratios
}

#[test]
fn outside_the_family_the_error_is_little_more_than_a_third_of_the_composites() {
    let full = ratios(World::Full, ChamberRun::ManyRates);
    assert!(full.mean <= 0.42 && full.worst <= 0.75);
    // Both lags begin at nothing, also where the unit is switched on in a ramp.
    assert!(full.first_minutes <= 1.7);
    let lagged = ratios(World::Lagged, ChamberRun::ManyRates);
    assert!(lagged.mean <= 0.45 && lagged.worst <= 0.80);
    assert!(lagged.first_minutes <= 1.7);
}

/// Play and second thermal lag are all that is left of such a unit beside its random walk. Just after
/// power-on in the middle of a ramp they are not known, and a model without them, whose rate terms
/// stand in for them, does better.
#[test]
fn a_smooth_unit_with_short_lags_gains_by_its_history() {
    assert!(ratios(World::Smooth, ChamberRun::ManyRates).mean <= 0.8);
    assert!(ratios(World::Smooth, ChamberRun::OneRate).mean <= 1.05);
}

#[test]
fn one_rate_does_not_mislead() {
    let ratios = ratios(World::Full, ChamberRun::OneRate);
    assert!(ratios.mean <= 0.85 && ratios.worst <= 1.0 && ratios.first_minutes <= 1.75);
}

#[test]
fn on_the_papers_own_form_nothing_is_lost() {
    let ratios = ratios(World::Paper, ChamberRun::ManyRates);
    assert!(ratios.worst <= 1.05 && ratios.first_minutes <= 1.0);
}

/// A run with one row in a hundred 20 sigma too high, and one with ten minutes 0.5 deg/h too high.
fn disturbed(unit: u64) -> [(&'static str, Run, usize); 2] {
    let mut random = Random::new(77);
    let [mut spiky, mut glitch] =
        [(); 2].map(|()| simulate(World::Full, ChamberRun::ManyRates, unit, 1));
    for axis in &mut spiky.log.channels[0].axes {
        for raw in &mut axis.raw {
            *raw += if random.uniform() < 0.01 {
                20.0 * 0.06
            } else {
                0.0
            };
        }
    }
    for axis in &mut glitch.log.channels[0].axes {
        axis.raw[40_000..40_600]
            .iter_mut()
            .for_each(|raw| *raw += 0.5);
    }
    [("spikes", spiky, 3000), ("glitch", glitch, 600)]
}

/// Over two units.
#[test]
fn outliers_and_a_glitch_hardly_show() {
    let runs = [1, 2].map(|unit| {
        let clean = simulate(World::Full, ChamberRun::ManyRates, unit, 1);
        let judge = simulate(World::Full, ChamberRun::Verification, unit, 2);
        (clean, judge, disturbed(unit))
    });
    for model in [Model::Static, Model::Composite, Model::Auto] {
        let mut growth = [Vec::new(), Vec::new()];
        for (clean, judge, disturbed) in &runs {
            let before = whole(&fitted(model, clean), judge);
            for ((name, run, least), growth) in disturbed.iter().zip(&mut growth) {
                let set = fitted(model, run);
                let outliers = set.channels[0].outliers.as_ref().unwrap();
                assert!(
                    outliers.spike_rows + outliers.disturbed_rows >= *least,
                    "{outliers:?}"
                );
                let after = whole(&set, judge);
                println!(
                    "{} {name}: {before:.3?} to {after:.3?} mdeg/h; {}",
                    model.name(),
                    description(&set)
                );
                growth.extend(after.iter().zip(&before).map(|(a, b)| a / b));
            }
        }
        for growth in growth {
            // The default may end at another pair of lags, which do as well.
            let most = if model == Model::Auto { 1.25 } else { 1.05 };
            assert!(geometric_mean(&growth) < most, "{growth:?}");
        }
    }
}

#[test]
fn a_step_of_the_bias_is_reported_with_time_and_size() {
    let mut run = simulate(World::Full, ChamberRun::ManyRates, 2, 1);
    run.log.channels[0].axes[1].raw[50_000..]
        .iter_mut()
        .for_each(|raw| *raw += 0.05);
    let set = fitted(Model::Spline, &run);
    let steps = &set.channels[0].outliers.as_ref().unwrap().steps;
    println!("{steps:?}");
    assert_eq!(steps.len(), 1);
    assert_eq!(steps[0].axis, "y");
    assert!((steps[0].time_s - 50_000.0).abs() < 120.0);
    assert!((steps[0].size / 0.05 - 1.0).abs() < 0.35);
}
