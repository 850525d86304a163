//! The applied bias against the truth, on programmes that were not fitted.

mod worlds;

use tempco::ThermalSettings;
use tempco_fit::apply::apply;
use tempco_fit::fit::{FitOptions, fit};
use tempco_fit::segment::Overlap;
use tempco_fit::set::{CoefficientSet, Model};
use worlds::{Programme, Run, World, simulate};

const PAPER_SEGMENTS: &str = "-15:15,5:35,25:60,50:80";

fn options(model: Model) -> FitOptions {
    let paper = matches!(model, Model::Static | Model::Composite);
    FitOptions {
        serial: "SIMULATED".to_owned(),
        model,
        overlap: Overlap::Smooth,
        segments: paper.then(|| PAPER_SEGMENTS.parse().unwrap()),
        thermal: ThermalSettings::DEFAULT,
        rate_tau_s: None,
        kappa: None,
        scale_factor_arcsec: None,
        tau_s: 100.0,
    }
}

fn fitted(model: Model, run: &Run) -> CoefficientSet {
    fit(std::slice::from_ref(&run.log), &options(model)).unwrap().set
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

#[test]
fn figures() {
    for (world, programme) in [
        (World::Full, Programme::ManyRates),
        (World::Full, Programme::OneRate),
        (World::Smooth, Programme::ManyRates),
        (World::Smooth, Programme::OneRate),
        (World::Paper, Programme::ManyRates),
        (World::Lagged, Programme::ManyRates),
    ] {
        let mut ratios = vec![Vec::new(); 2];
        for seed in 1..=3 {
            let train = simulate(world, programme, seed, 1);
            let judge = simulate(world, Programme::Verification, seed, 2);
            let mid = simulate(world, Programme::MidRamp, seed, 3);
            let [st, co] = [Model::Static, Model::Composite].map(|m| fitted(m, &train));
            let base = whole(&co, &judge);
            println!("{world:?} {programme:?} {seed}: static {:.2?} composite {:.2?}; first 10 min composite {:.2?}", whole(&st, &judge), base, errors(&co, &mid, 0..600));
            for (n, model) in [Model::Spline, Model::Auto].into_iter().enumerate() {
                let clock = std::time::Instant::now();
                let set = fitted(model, &train);
                let time = clock.elapsed();
                let found = whole(&set, &judge);
                let c = &set.channels[0].selection.as_ref().unwrap().chosen;
                println!("   {} {:.2?} first 10 min {:.2?}  {} seg {:?} rate {} tau {:.0} kappa {:.2} jump {} {:?} rows {}", model.name(), found, errors(&set, &mid, 0..600), c.segments, c.place, c.rate_columns, c.tau_s, c.kappa, set.channels[0].table.max_jump(0), time, train.log.rows());
                ratios[n].extend(found.iter().zip(&base).map(|(f, b)| f / b));
            }
        }
        for (n, r) in ratios.iter().enumerate() {
            println!("== {world:?} {programme:?} {n}: geo {:.3} worst {:.3}", geometric_mean(r), r.iter().fold(0.0_f64, |a, &b| a.max(b)));
        }
    }
}
