//! Plays and second lags: found where they are, not found where they are not, and carried from the
//! set to the table that flies.

mod worlds;

use tempco::{Compensator, Interval, Table, Terms, Thermal, ThermalSettings};
use tempco_fit::{Fit, FitOptions, Method, SplineSearch, fit};
use tempco_log::{AxisUnit, Log};
use tempco_set::run::apply;
use tempco_set::{
    CoefficientSet, GainSet, HistoryTerm, Model, Warning, WarningCode, load_set, table_rs,
};
use worlds::{ChamberRun, Random, World, simulate};

/// A unit of one axis that is a table of the core.
#[derive(Clone, Copy)]
struct Unit {
    play: Option<(f32, f32)>,
    second_lag: Option<(f32, f32)>,
}

const PLAIN: Unit = Unit {
    play: None,
    second_lag: None,
};

const WHOLE: Unit = Unit {
    play: Some((2.5, 0.004)),
    second_lag: Some((3600.0, -0.0005)),
};

/// Noise of a row of ten seconds.
const WHITE: f64 = 0.01;

/// Steps of the random walk from row to row: little, and as much as the history terms themselves by the
/// end of a log.
const CALM: f64 = 1e-5;
const RESTLESS: f64 = 5e-5;

/// A chamber run of the unit in rows of ten seconds; `seed` makes the noise, which walks as well.
fn run(unit: Unit, chamber_run: ChamberRun, seed: u64, walk_step: f64) -> Log {
    let mut log = simulate(World::Paper, chamber_run, 1, 1).log;
    let channel = &mut log.channels[0];
    channel.temp_c = channel.temp_c.iter().copied().step_by(10).collect();
    channel.axes.truncate(1);
    log.time_s = log.time_s.iter().copied().step_by(10).collect();
    log.interval_s = 10.0;

    let (half_width1_c, play_gain) = unit.play.unwrap_or((1.0, 0.0));
    let (tau2_s, lag_gain) = unit.second_lag.unwrap_or((2000.0, 0.0));
    let thermal = Thermal::new(ThermalSettings {
        tau_s: 120.0,
        kappa: 0.8,
        half_width1_c,
        play_kappa: 0.8,
        tau2_s,
        lag2_min_c: -1000.0,
        lag2_max_c: 1000.0,
        ..ThermalSettings::DEFAULT
    });
    let terms = [0.3, 0.5, -0.2, 0.03, 0.01, lag_gain, 0.0];
    let cells = [[Terms::from_array(terms)]];
    let table = Table::new(thermal.unwrap(), -15.0, 80.0, &cells).unwrap();
    let table = table.with_plays([[play_gain], [0.0]]).unwrap();
    let mut unit = Compensator::new(&table);
    unit.start(channel.temp_c[0]);
    let interval = Interval::new(table.thermal(), 10.0);
    let mut random = Random::new(seed);
    let mut walk = 0.0;
    channel.axes[0].raw = channel
        .temp_c
        .iter()
        .map(|&temp_c| {
            let out = unit.step(&interval, temp_c, [0.0]);
            walk += walk_step * random.normal();
            f64::from(out.bias[0]) + walk + WHITE * random.normal()
        })
        .collect();
    log
}

fn fitted(log: &Log) -> Fit {
    let options = FitOptions::new("SIMULATED", Model::Spline);
    fit(std::slice::from_ref(log), &options).unwrap()
}

/// Of five units one may be given a second play: that is within one standard error one time in six.
#[test]
fn width_time_constant_and_gains_of_a_unit_are_recovered() {
    let recovered = (1..=5).filter(|&seed| {
        let set = fitted(&run(WHOLE, ChamberRun::ManyRates, seed, CALM)).set;
        let channel = &set.channels[0];
        let found: Vec<_> = channel.history(&channel.axes[0]).collect();
        println!("{found:?}");
        let [
            (HistoryTerm::Play { half_width_c }, of_play),
            (HistoryTerm::SecondLag { tau2_s, limit_c }, of_lag),
        ] = found[..]
        else {
            return false;
        };
        assert!((half_width_c / 2.5 - 1.0).abs() < 0.1);
        assert!((tau2_s / 3600.0 - 1.0).abs() < 0.2);
        assert!(limit_c > 20.0 && limit_c < 95.0);
        // What is known of a play best is its height, gain times half width: the stated sigma is
        // the gain's at the width that was found.
        let width_c = f64::from(half_width_c);
        let error = width_c * of_play.gain - 2.5 * 0.004;
        assert!(error.abs() < 3.0 * width_c * of_play.sigma);
        assert!((of_lag.gain + 0.0005).abs() < 3.0 * of_lag.sigma);
        assert!(of_play.sigma < 2e-4 && of_lag.sigma < 5e-5);
        assert_eq!(channel.table.play_gains, [[of_play.gain as f32, 0.0]]);
        let of_lag = of_lag.gain as f32;
        let mut cells = channel.table.cells.iter();
        assert!(cells.all(|cell| (cell[0].s[0] / of_lag - 1.0).abs() < 1e-6));
        true
    });
    assert!(recovered.count() >= 4);
}

#[test]
fn a_unit_without_history_gets_no_history_terms() {
    let seeds = 10;
    let found = (1..=seeds)
        .filter(|&seed| {
            let set = fitted(&run(PLAIN, ChamberRun::ManyRates, seed, RESTLESS)).set;
            set.channels[0].table.has_history()
        })
        .count();
    println!("{found} of {seeds}");
    assert!(found <= 1);
}

#[test]
fn one_rate_gives_no_history_terms_and_says_so() {
    let fit = fitted(&run(WHOLE, ChamberRun::OneRate, 1, CALM));
    assert!(!fit.set.channels[0].table.has_history());
    let rates = &fit.set.channels[0].selection.as_ref().unwrap();
    assert_eq!(rates.ramp_rates_c_per_min.len(), 1);
    let judgement = fit.judge();
    let said = |of: &Warning| of.code == WarningCode::HistoryTermsNotTried;
    assert!(judgement.warnings.iter().any(said), "{judgement:?}");
}

#[test]
fn history_terms_can_be_declined() {
    let log = run(WHOLE, ChamberRun::ManyRates, 1, CALM);
    let method = Method::Spline {
        segmentation: None,
        search: SplineSearch {
            history: false,
            ..SplineSearch::ALL
        },
    };
    let set = fit(&[log], &FitOptions::new("SIMULATED", method))
        .unwrap()
        .set;
    assert!(!set.channels[0].table.has_history());
}

/// The set of two logs, in either order and in another unit.
#[test]
fn order_of_logs_and_units_do_not_matter() {
    let logs = [
        run(WHOLE, ChamberRun::ManyRates, 1, CALM),
        run(WHOLE, ChamberRun::Verification, 2, CALM),
    ];
    let turned = [logs[1].clone(), logs[0].clone()];
    let mut dps = logs.clone();
    for log in &mut dps {
        let axis = &mut log.channels[0].axes[0];
        axis.unit = AxisUnit::Dps;
        axis.raw.iter_mut().for_each(|raw| *raw /= 3600.0);
    }
    let options = FitOptions::new("SIMULATED", Model::Auto);
    let [set, turned, dps] = [&logs, &turned, &dps].map(|logs| fit(logs, &options).unwrap().set);
    for (other, scale) in [(&turned, 1.0), (&dps, 3600.0)] {
        let (a, b) = (&set.channels[0], &other.channels[0]);
        assert!(a.table.has_second_lag() && a.table.half_widths_c()[0] > 0.0);
        let widths = [a, b].map(|of| of.table.thermal.half_width1_c);
        let taus_s = [a, b].map(|of| of.table.thermal.tau2_s);
        for [a, b] in [widths, taus_s] {
            assert!((b / a - 1.0).abs() < 1e-6, "{a} {b}");
        }
        let gains = |of: &tempco_set::ChannelSet| -> Vec<GainSet> {
            of.history(&of.axes[0]).map(|(_, gain)| gain).collect()
        };
        for (a, b) in gains(a).iter().zip(gains(b)) {
            assert!((b.gain * scale / a.gain - 1.0).abs() < 1e-5, "{a:?} {b:?}");
        }
    }
}

/// A set of printed coefficients with history terms put to it.
fn example() -> CoefficientSet {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("printed.csv");
    let text = "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
                X,1,-15,80,0.0173,-0.0014,0.00001\n\
                Y,1,-15,80,0.0064,0.0004,-0.00004\n";
    std::fs::write(&path, text).unwrap();
    let mut set = load_set(&path).unwrap();
    let channel = &mut set.channels[0];
    let table = &mut channel.table;
    table.thermal.half_width1_c = 2.5;
    table.thermal.tau2_s = 4500.0;
    (table.thermal.lag2_min_c, table.thermal.lag2_max_c) = (-40.0, 40.0);
    table.play_gains = vec![[0.004, 0.0], [-0.25, 0.0]];
    for (number, of_lag) in [-0.0005, 1e-6].into_iter().enumerate() {
        for cell in &mut table.cells {
            cell[number].s[0] = of_lag as f32;
        }
        let axis = &mut channel.axes[number];
        axis.polynomials[0].s[0] = of_lag;
        let gains = table.play_gains[number].map(f64::from);
        axis.gains = gains.map(|gain| GainSet { gain, sigma: 0.0 }).to_vec();
    }
    set.seal();
    set
}

#[test]
fn sets_keep_their_history_terms_and_the_crc_covers_them() {
    let set = example();
    let text = serde_json::to_string(&set).unwrap();
    assert_eq!(CoefficientSet::from_json(&text).unwrap(), set);
    for (from, to) in [
        ("\"half_width1_c\":2.5", "\"half_width1_c\":2.6"),
        ("\"lag2_max_c\":40.0", "\"lag2_max_c\":41.0"),
        ("[0.004,0.0],[-0.25,0.0]", "[0.004,0.0],[-0.5,0.0]"),
        ("[0.004,0.0],[-0.25,0.0]", "[0.004,0.0]"),
        ("\"tau2_s\":4500.0", "\"tau2_s\":45.0"),
    ] {
        let damaged = text.replace(from, to);
        assert_ne!(damaged, text);
        assert!(CoefficientSet::from_json(&damaged).is_err(), "{to}");
    }
    let part = set.static_part().unwrap();
    assert!(set.channels[0].table.has_history() && !part.channels[0].table.has_history());
    let text = serde_json::to_string(&part).unwrap();
    assert_eq!(CoefficientSet::from_json(&text).unwrap(), part);
}

#[allow(
    dead_code,
    unreachable_pub,
    reason = "written for firmware, which has it in a module of its library"
)]
mod emitted {
    include!("history/table.rs");
}

/// `history/table.rs` is what is written for the example, compiles, and does what `apply` does.
#[test]
fn the_emitted_table_flies_what_is_applied() {
    let set = example();
    let text = table_rs(&set);
    // The first line names the version.
    let without_first = |text: &str| text.split_once('\n').unwrap().1.to_owned();
    let expected = without_first(include_str!("history/table.rs"));
    assert_eq!(without_first(&text), expected, "as written:\n{text}");

    let mut log = simulate(World::Paper, ChamberRun::MidRamp, 1, 1).log;
    log.channels[0].axes.truncate(2);
    for axis in &mut log.channels[0].axes {
        axis.unit = AxisUnit::PulsesPerS;
    }
    let applied = apply(&set, &log).unwrap();
    let table = &emitted::TABLES[0];
    let mut unit = Compensator::new(table);
    let temps_c = &log.channels[0].temp_c;
    unit.start(temps_c[0]);
    let mut moved = false;
    for (row, (dt_s, &temp_c)) in log.intervals_s().zip(temps_c).enumerate() {
        let interval = Interval::new(table.thermal(), dt_s);
        let out = unit.step(&interval, temp_c, [0.0; 2]);
        assert_eq!(
            out.bias,
            [0, 1].map(|axis: usize| applied.axes[axis].bias[row])
        );
        moved |= out.point.plays_c[0].abs() > 2.4 && out.point.lag2_c.abs() > 10.0;
    }
    assert!(moved);
}
