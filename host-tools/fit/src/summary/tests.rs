//! What a summary must keep of its rows.

use std::fmt::Write;

use proptest::prelude::*;
use tempco::{Terms, ThermalSettings};
use tempco_log::{Axis, Channel, Log, ReadOptions, SkippedRows, read_log};
use tempco_set::run::with_every_rate;
use tempco_set::{COMPOSITE, Model};
use tempco_twin::{Profile, Simulation, Unit};

use super::grid::{Grid, MOST_BLOCKS};
use super::*;
use crate::least_squares::RFactor;
use crate::summary::ChannelData;
use crate::testing::white;
use crate::{FitOptions, PlanOptions, fit, fit_summaries};

/// Rows of a channel with one axis, at irregular times, some not kept.
fn rows(count: usize, interval_s: f64, seed: u64) -> Rows {
    let mut rows = Rows::with_capacity(1, count);
    let mut time_s = 100.0;
    for (noise, i) in white(seed).zip(0..count) {
        time_s += interval_s * (1.0 + 0.3 * noise.sin());
        rows.time_s.push(time_s);
        rows.temp_c
            .push((20.0 + 0.01 * time_s + 0.1 * noise) as f32);
        rows.effective_c.push((19.0 + 0.01 * time_s) as f32);
        rows.rate.push((0.6 + 0.05 * noise) as f32);
        rows.accepted.push(i % 11 != 3);
        rows.keep.push(i % 11 != 3 && i % 7 != 2);
        rows.axes[0].push(5.0 + 0.001 * time_s + noise);
    }
    rows
}

fn grid_of(rows: &Rows, most_blocks: usize) -> Grid {
    let mut grid = Grid::new(1, rows.time_s[0], 10.0, most_blocks);
    grid.take(rows);
    grid
}

fn whole(blocks: &[Block]) -> Moments {
    let mut whole = Moments::none(1);
    blocks.iter().for_each(|block| whole.merge(&block.moments));
    whole
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-10 * (1.0 + a.abs())
}

fn same(a: &Moments, b: &Moments) -> bool {
    let spread = |m: &Moments| {
        let axis = m.axes[0];
        [
            m.temp_c,
            m.effective_c.mean,
            m.effective_c.squares,
            m.rate,
            m.products,
            axis.mean,
        ]
        .into_iter()
        .chain([axis.squares])
        .collect::<Vec<f64>>()
    };
    a.rows == b.rows
        && a.effective_range_c == b.effective_range_c
        && a.rate_range == b.rate_range
        && spread(a).iter().zip(&spread(b)).all(|(a, b)| close(*a, *b))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// However few blocks there may be, they hold the moments of all rows, in samples that go
    /// with them, and there are no more than that.
    #[test]
    fn a_grid_that_widens_loses_nothing(
        count in 50_usize..2000, interval_s in 0.05_f64..20.0, most in 2_usize..40, seed: u64,
    ) {
        let rows = rows(count, interval_s, seed);
        let (free, _, _) = grid_of(&rows, usize::MAX).finish();
        let (bounded, samples, block_s) = grid_of(&rows, most).finish();
        prop_assert!(bounded.len() <= most && samples.len() <= 10 * most);
        prop_assert!(bounded.len() == free.len() || block_s > 10.0);
        prop_assert!(same(&whole(&free), &whole(&bounded)));
        let direct = rows.moments(0..rows.len());
        prop_assert!(same(&whole(&free), &direct));
        for block in &bounded {
            let kept: u32 = samples[block.samples.clone()].iter().map(|s| s.kept).sum();
            prop_assert_eq!(u64::from(kept), block.moments.rows);
            prop_assert!(block.to_s - block.from_s <= block_s);
        }
        let held: usize = bounded.iter().map(|block| block.samples.len()).sum();
        prop_assert_eq!(held, samples.len());
    }
}

/// A simulated log: the paper's unit, read every 0.1 s, through a soak and two ramps.
fn simulated(seed: u64, rate_hz: f64) -> Log {
    let unit = Unit::named("paper").unwrap();
    let profile = Profile::named("verification").unwrap();
    let mut log = Log {
        file: format!("{seed}"),
        sha256: String::new(),
        time_s: Vec::new(),
        channels: vec![Channel {
            column: "temp_c".to_owned(),
            temp_c: Vec::new(),
            axes: Vec::new(),
        }],
        reading: tempco_log::Reading::default(),
        ignored_columns: Vec::new(),
        skipped_rows: SkippedRows::default(),
        interval_s: 1.0 / rate_hz,
    };
    let mut raw = vec![Vec::new(); 3];
    for sample in Simulation::new(&unit, &profile, seed, rate_hz)
        .unwrap()
        .take(150_000)
    {
        log.time_s.push(sample.time_s);
        log.channels[0].temp_c.push(sample.temp_c as f32);
        for (raw, counts) in raw.iter_mut().zip(sample.counts) {
            raw.push(counts as f64 * rate_hz);
        }
    }
    log.channels[0].axes = raw
        .into_iter()
        .zip(["x", "y", "z"])
        .map(|(raw, name)| Axis {
            name: name.to_owned(),
            unit: AxisUnit::PulsesPerS,
            raw,
        })
        .collect();
    log
}

/// The coefficients of a set, and their standard deviations.
fn coefficients(set: &tempco_set::CoefficientSet) -> Vec<(f64, f64)> {
    let axes = set.channels.iter().flat_map(|channel| &channel.axes);
    axes.flat_map(|axis| axis.polynomials.iter().zip(&axis.sigmas))
        .flat_map(|(p, s)| {
            let values = p.coefficients().into_iter();
            values.zip(s.to_array())
        })
        .collect()
}

/// Logs that were summarised apart, from files and chunk by chunk, give the fit of the logs.
#[test]
fn summaries_of_files_are_fitted_like_the_logs() {
    let options = FitOptions::new("SUMMARY", Model::Composite);
    let plan = Plan::new(options.plan.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut logs = Vec::new();
    let mut summaries = Vec::new();
    for seed in [1, 2] {
        let log = simulated(seed, 2.0);
        let mut text = String::from("time_s,temp_c,x_pulses,y_pulses,z_pulses\n");
        for row in 0..log.rows() {
            let channel = &log.channels[0];
            write!(text, "{},{}", log.time_s[row], channel.temp_c[row]).unwrap();
            for axis in &channel.axes {
                write!(text, ",{}", axis.raw[row] / 2.0).unwrap();
            }
            text.push('\n');
        }
        let path = folder.path().join(format!("{seed}.csv"));
        std::fs::write(&path, text).unwrap();
        let reading = ReadOptions::default();
        summaries.push(summarise_file(&path, &reading, &plan, |_| ()).unwrap());
        logs.push(read_log(&path, &reading).unwrap());
    }
    let expected = fit(&logs, &options).unwrap();
    let found = fit_summaries(&summaries, &options).unwrap();
    summaries.reverse();
    let turned = fit_summaries(&summaries, &options).unwrap();
    assert_eq!(coefficients(&turned.set), coefficients(&found.set));
    let bytes: Vec<Vec<u8>> = summaries.iter().map(LogSummary::to_bytes).collect();
    let read = bytes
        .iter()
        .map(|bytes| LogSummary::from_bytes(bytes).unwrap());
    assert_eq!(read.collect::<Vec<_>>(), summaries);
    assert_eq!(found.judge(), expected.judge());
    let inputs = |set: &tempco_set::CoefficientSet| set.provenance.inputs.clone();
    assert_eq!(inputs(&found.set), inputs(&expected.set));
    let (found, expected) = (coefficients(&found.set), coefficients(&expected.set));
    assert_eq!(found.len(), expected.len());
    for ((found, _), (expected, sigma)) in found.into_iter().zip(expected) {
        assert!(
            (found - expected).abs() <= 1e-9 * sigma,
            "{found} {expected}"
        );
    }
}

/// A summary that was made with another option than the fit.
#[test]
fn a_foreign_plan_is_refused() {
    let log = simulated(1, 2.0);
    let options = FitOptions::new("SUMMARY", Model::Composite);
    type Change = fn(&mut PlanOptions);
    let changes: [(Change, &str); 7] = [
        (|of| of.thermal.max_slew_c_per_min = 3.0, "--max-slew"),
        (|of| of.thermal.kappa = 0.3, "--kappa"),
        (|of| of.search.tau = false, "--rate-tau"),
        (
            |of| {
                of.exclude = vec![tempco_set::Stretch {
                    from_s: 1.0,
                    to_s: 2.0,
                }];
            },
            "--exclude",
        ),
        (|of| of.robust = false, "--keep-outliers"),
        (|of| of.scale_factor_arcsec = Some(0.5), "--scale-factor"),
        (|of| of.tau_s = 10.0, "another --tau:"),
    ];
    for (change, option) in changes {
        let mut plan = PlanOptions::default();
        change(&mut plan);
        let summary = summarise_log(&log, &Plan::new(plan).unwrap());
        let error = fit_summaries(&[summary], &options).unwrap_err().to_string();
        assert!(error.contains(option), "{error}");
    }
}

/// Cut short at every length, and with every byte of its front or one of the rest changed.
#[test]
fn a_summary_that_was_changed_is_refused() {
    let log = simulated(1, 2.0);
    let plan = Plan::new(PlanOptions::default()).unwrap();
    let bytes = summarise_log(&log, &plan).to_bytes();
    let refused = |bytes: &[u8], expected: &str| {
        let error = LogSummary::from_bytes(bytes).unwrap_err();
        assert!(error.contains(expected), "{error}");
    };
    for length in (0..100).chain((100..bytes.len()).step_by(997)) {
        let expected = if length < 24 { "no summary" } else { "cut off" };
        refused(&bytes[..length], expected);
    }
    refused(&[&bytes[..], &[0]].concat(), "cut off");
    for at in (0..100).chain((100..bytes.len()).step_by(997)) {
        let mut changed = bytes.clone();
        changed[at] ^= 1;
        let expected = match at {
            0..8 => "no summary",
            8..12 => "version",
            12..24 => "cut off",
            _ => "checksum",
        };
        refused(&changed, expected);
    }
}

/// With a right checksum, too.
#[test]
fn blocks_that_do_not_fit_together_are_refused() {
    let log = simulated(1, 2.0);
    let plan = Plan::new(PlanOptions::default()).unwrap();
    let good = summarise_log(&log, &plan);
    let changes: [fn(&mut ChannelSummary); 7] = [
        |of| of.blocks[3].samples.end += 1,
        |of| of.blocks.truncate(3),
        |of| of.samples.truncate(3),
        |of| of.axes.truncate(1),
        |of| of.white_sigmas.truncate(1),
        |of| of.spiked.truncate(1),
        |of| of.block_s = f64::NAN,
    ];
    for change in changes {
        let mut summary = good.clone();
        change(&mut summary.channels[0]);
        let error = LogSummary::from_bytes(&summary.to_bytes()).unwrap_err();
        assert!(error.contains("do not fit together"), "{error}");
    }
    let mut summary = good;
    summary.channels.clear();
    assert!(LogSummary::from_bytes(&summary.to_bytes()).is_err());
}

/// The largest share of their standard deviations by which coefficients on samples differ from
/// those on rows. Stated in `docs/mathematics.md`.
const ALLOWED_SHARE: f64 = 0.01;

/// The largest root mean square by which the rates differ \[degC/min\].
const ALLOWED_RATE: f64 = 1e-4;

/// Least squares in the regressors that the core gives at the samples, beside those that it gives
/// row by row, on the same blocks.
#[test]
fn regressors_from_samples_are_as_good_as_those_from_rows() {
    let mut log = simulated(3, 20.0);
    // Both start at the same temperature: the first row is as good as the mean of the first sample.
    let temps_c = &mut log.channels[0].temp_c;
    let first_c = temps_c[0];
    temps_c[..20].fill(first_c);
    for (tau_s, kappa) in [(30.0, 0.5), (60.0, 0.0), (300.0, 1.0)] {
        let thermal = ThermalSettings {
            tau_s,
            kappa,
            ..ThermalSettings::DEFAULT
        };
        let options = PlanOptions {
            thermal,
            ..PlanOptions::default()
        };
        let summary = summarise_log(&log, &Plan::new(options).unwrap());
        let summaries = [&summary];
        let data = ChannelData::new(&summaries, 0);
        let points = data.of(0).points(&with_every_rate(thermal).unwrap());
        let [mut of_rows, mut of_samples] = [(); 2].map(|()| RFactor::new(COMPOSITE, 3));
        let mut rate_squares = 0.0;
        for (_, _, block) in data.blocks() {
            let moments = &block.moments;
            let within = || moments.axes.iter().map(|axis| axis.squares);
            let raw = || moments.axes.iter().map(|axis| axis.mean);
            let rows = moments.rows as f64;
            let z = |u: f64| (u - 30.0) / 45.0;
            let u = z(moments.effective_c.mean);
            let square = u * u + moments.effective_c.squares / rows / 45.0 / 45.0;
            let product = u * moments.rate + moments.products / rows / 45.0;
            let row = [1.0, u, square, moments.rate, product];
            of_rows.push_mean(moments.rows, row.into_iter().chain(raw()), within());
            let mut row = [0.0; COMPOSITE];
            for SamplePoint { point, kept, .. } in &points[block.samples.clone()] {
                let (u, rate) = (z(point.effective_c.into()), f64::from(point.rate_c_per_min));
                for (sum, value) in row.iter_mut().zip([1.0, u, u * u, rate, u * rate]) {
                    *sum += kept / rows * value;
                }
            }
            of_samples.push_mean(moments.rows, row.into_iter().chain(raw()), within());
            rate_squares += (row[Terms::STATIC] - moments.rate).powi(2);
        }
        let [rows, samples] =
            [of_rows, of_samples].map(|mut factor| factor.solve(COMPOSITE).unwrap());
        let mut worst = 0.0_f64;
        for axis in 0..3 {
            for term in 0..COMPOSITE {
                let apart = samples.coefficients[axis][term] - rows.coefficients[axis][term];
                worst = worst.max(apart.abs() / rows.sigmas[axis][term]);
            }
        }
        let rate = (rate_squares / data.blocks().count() as f64).sqrt();
        println!("tau {tau_s} s, kappa {kappa}: {worst:.4} sigma, {rate:.1e} degC/min");
        assert!(worst < ALLOWED_SHARE && rate < ALLOWED_RATE);
    }
}

/// In a log of 133 h blocks are 40 s long, of which three come nearest to 100 s.
#[test]
fn means_of_a_long_log_are_made_of_whole_blocks() {
    let rows = 40_000;
    let phase = |row: usize| row as f64 * 0.01;
    let noise: Vec<f64> = white(5).take(rows).collect();
    let log = Log {
        time_s: (0..rows).map(|row| 12.0 * row as f64).collect(),
        interval_s: 12.0,
        channels: vec![Channel {
            column: "temp_c".to_owned(),
            temp_c: (0..rows)
                .map(|row| (30.0 + 30.0 * phase(row).sin()) as f32)
                .collect(),
            axes: vec![Axis {
                name: "x".to_owned(),
                unit: AxisUnit::Dph,
                raw: (0..rows)
                    .map(|row| phase(row).sin() + 0.3 * noise[row])
                    .collect(),
            }],
        }],
        ..simulated(1, 0.01)
    };
    let set = fit(&[log], &FitOptions::new("LONG", Model::Static)).unwrap();
    let statistics = set.set.channels[0].axes[0].statistics.unwrap();
    assert_eq!((statistics.rows, statistics.tau_s), (rows, 120.0));
    assert_eq!(statistics.n, 4000);
    // Ten rows of white noise in each mean.
    let expected = 0.3 / 10.0_f64.sqrt();
    assert!((statistics.sigma_compensated / expected - 1.0).abs() < 0.06);
    assert!((statistics.rmse_compensated / 0.3 - 1.0).abs() < 0.02);
}

#[test]
fn a_summary_is_bounded() {
    assert_eq!(MOST_BLOCKS, 16_384);
    let rows = rows(40_000, 12.0, 4);
    let (blocks, samples, block_s) = grid_of(&rows, MOST_BLOCKS).finish();
    assert!(blocks.len() <= MOST_BLOCKS && samples.len() <= 40_000);
    assert_eq!(block_s, 40.0);
}
