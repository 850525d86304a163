//! A measured chamber cycle, where it is present.
use tempco::ThermalSettings;
use tempco_fit::apply::apply;
use tempco_fit::fit::{FitOptions, fit};
use tempco_fit::log::{Log, ReadOptions, read_log};
use tempco_fit::segment::Overlap;
use tempco_fit::set::Model;

fn part(log: &Log, rows: std::ops::Range<usize>) -> Log {
    let mut part = log.clone();
    part.time_s = log.time_s[rows.clone()].to_vec();
    for channel in &mut part.channels {
        channel.temp_c = channel.temp_c[rows.clone()].to_vec();
        for axis in &mut channel.axes { axis.raw = axis.raw[rows.clone()].to_vec(); }
    }
    part
}

fn means(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let v: Vec<f64> = values.collect();
    v.chunks_exact(20).map(|c| c.iter().sum::<f64>() / 20.0).collect()
}
fn rms(v: &[f64]) -> f64 { let m = v.iter().sum::<f64>() / v.len() as f64; (v.iter().map(|x| (x - m).powi(2)).sum::<f64>() / v.len() as f64).sqrt() }

#[test]
fn split() {
    let path = std::path::Path::new("../../../shared/data/tofupilot_imu_chamber_cycle.csv");
    if !path.exists() { println!("skipped"); return; }
    let log = read_log(path, &ReadOptions::default()).unwrap();
    for (a, b) in [(2800..8399, 0..2700), (0..2700, 2800..8399)] {
        let (train, judge) = (part(&log, a), part(&log, b));
        let x = |l: &Log| { let t = means(l.channels[0].temp_c.iter().map(|&t| f64::from(t))); t.into_iter().map(|t| (t - 28.0) / 46.0).collect::<Vec<_>>() };
        let (xa, xb) = (x(&train), x(&judge));
        let mut factor = tempco_fit::rfactor::RFactor::new(4, 6);
        let ys: Vec<Vec<f64>> = train.channels[0].axes.iter().map(|a| means(a.raw.iter().copied())).collect();
        for (i, z) in xa.iter().enumerate() { factor.push([1.0, *z, z*z, z*z*z].into_iter().chain(ys.iter().map(|y| y[i]))); }
        let cubic = factor.solve(4).unwrap().coefficients;
        let (low, high) = xa.iter().fold((9.0_f64, -9.0_f64), |(l, h), &z| (l.min(z), h.max(z)));
        for model in [Model::Composite, Model::Spline, Model::Auto] {
            let options = FitOptions { serial: "R".into(), model, overlap: Overlap::Smooth, segments: None, thermal: ThermalSettings::DEFAULT, rate_tau_s: None, kappa: None, exclude: Vec::new(), robust: true, scale_factor_arcsec: None, tau_s: 10.0 };
            let f = fit(std::slice::from_ref(&train), &options).unwrap();
            let applied = apply(&f.set, &judge).unwrap();
            if let Some(s) = &f.set.channels[0].selection { println!("{:?}", s.chosen); for o in s.others.iter().take(6) { println!("    {o:?}"); } }
            for (i, o) in applied.axes.iter().enumerate() {
                let raw = means(judge.channels[0].axes[i].raw.iter().copied());
                let c = |z: f64| { let z = z.clamp(low, high); cubic[i][0] + z * (cubic[i][1] + z * (cubic[i][2] + z * cubic[i][3])) };
                let rc: Vec<f64> = raw.iter().zip(&xb).map(|(r, &z)| r - c(z)).collect();
                let ro = means(o.compensated.iter().map(|&v| f64::from(v)));
                println!("{} {}: cubic {:.5} model {:.5} ratio {:.3} none {:.5} rate {}", model.name(), judge.channels[0].axes[i].name, rms(&rc), rms(&ro), rms(&ro) / rms(&rc), rms(&raw), f.set.channels[0].axes[i].polynomials[0].r[0]);
            }
        }
    }
}
