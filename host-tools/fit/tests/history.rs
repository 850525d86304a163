//! The default model: lags, plays and second lag found where they are, next to nothing where they
//! are not, and carried from the set to the table that flies.

mod worlds;

use tempco::{Compensator, Interval, Table, Terms, Thermal, ThermalSettings};
use tempco_fit::summary::summarise_log;
use tempco_fit::{Fit, FitOptions, LagSearch, Method, Plan, fit, fit_summaries};
use tempco_log::{AxisUnit, Log};
use tempco_set::run::apply;
use tempco_set::{ChannelSet, CoefficientSet, GainSet, Warning, WarningCode, load_set, table_rs};
use worlds::{ChamberRun, Random, World, simulate};

/// Lag, time constants and plays of the units \[s, degC\].
const TAU_S: f32 = 120.0;
const KAPPA: f32 = 0.8;
const TAU2_S: f32 = 2400.0;
const HALF_WIDTHS_C: [f32; 2] = [2.0, 12.0];

/// A unit of one axis that is a table of the core.
#[derive(Clone, Copy)]
struct Unit {
    play_gains: [f32; 2],
    lag2_gain: f32,
}

const PLAIN: Unit = Unit {
    play_gains: [0.0; 2],
    lag2_gain: 0.0,
};

const WHOLE: Unit = Unit {
    play_gains: [0.005, 0.001],
    lag2_gain: -0.0005,
};

/// A wave of the curve: in a parabola a shift of the temperature is the same as a rate term.
const WAVE: (f64, f64) = (0.1, 0.12);

/// Noise of a row of ten seconds.
const WHITE: f64 = 0.01;

/// Steps of the random walk from row to row: little, and by the end of a log as much as the history
/// terms themselves.
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

    let thermal = Thermal::new(ThermalSettings {
        tau_s: TAU_S,
        kappa: KAPPA,
        half_width1_c: HALF_WIDTHS_C[0],
        half_width2_c: HALF_WIDTHS_C[1],
        play_kappa: KAPPA,
        tau2_s: TAU2_S,
        lag2_min_c: -1000.0,
        lag2_max_c: 1000.0,
        ..ThermalSettings::DEFAULT
    });
    let terms = [0.3, 0.5, -0.2, 0.03, 0.01, unit.lag2_gain, 0.0];
    let cells = [[Terms::from_array(terms)]];
    let table = Table::new(thermal.unwrap(), -15.0, 80.0, &cells).unwrap();
    let [narrow, wide] = unit.play_gains;
    let table = table.with_plays([[narrow], [wide]]).unwrap();
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
            let wave = WAVE.0 * (WAVE.1 * f64::from(out.point.effective_c)).sin();
            f64::from(out.bias[0]) + wave + walk + WHITE * random.normal()
        })
        .collect();
    log
}

fn fitted(log: &Log) -> Fit {
    let options = FitOptions::new("SIMULATED", Method::AUTO);
    fit(std::slice::from_ref(log), &options).unwrap()
}

/// What the second lag of the first axis adds per degC, in the middle of each cell.
fn lag2_gains(channel: &ChannelSet) -> Vec<f64> {
    let cells = channel.axes[0].polynomials.iter();
    cells.map(|of| of.s[0]).collect()
}

#[test]
fn lags_and_gains_of_a_unit_are_recovered() {
    for seed in 1..=3 {
        let set = fitted(&run(WHOLE, ChamberRun::ManyRates, seed, CALM)).set;
        let channel = &set.channels[0];
        let thermal = &channel.table.thermal;
        println!("{thermal:?}");
        println!("{:?} {:?}", channel.axes[0].gains, lag2_gains(channel));
        assert!((thermal.tau_s / TAU_S - 1.0).abs() < 0.15);
        assert!((thermal.kappa - KAPPA).abs() < 0.1);
        assert!((thermal.tau2_s / TAU2_S - 1.0).abs() < 0.25);
        assert!(thermal.kappa2.abs() < 0.02);
        assert_eq!(channel.table.half_widths_c(), HALF_WIDTHS_C);
        for (number, (gain, truth)) in channel.axes[0]
            .gains
            .iter()
            .zip(WHOLE.play_gains)
            .enumerate()
        {
            let error = gain.gain - f64::from(truth);
            assert!(error.abs() < 0.2 * f64::from(truth), "{number}: {gain:?}");
            assert!(gain.sigma > 0.0 && gain.sigma < 0.1 * f64::from(truth));
            assert_eq!(channel.table.play_gains[0][number], gain.gain as f32);
        }
        let truth = f64::from(WHOLE.lag2_gain);
        for gain in lag2_gains(channel) {
            assert!((gain / truth - 1.0).abs() < 0.4, "{gain}");
        }
    }
}

/// What plays and second lag may add where there are none: a fifth of what a unit with them has,
/// which is less than the random walk.
#[test]
fn a_unit_without_history_gets_hardly_any() {
    for seed in 1..=4 {
        let set = fitted(&run(PLAIN, ChamberRun::ManyRates, seed, RESTLESS)).set;
        let channel = &set.channels[0];
        let plays = channel.axes[0].gains.iter().zip(HALF_WIDTHS_C);
        let of_plays: f64 = plays
            .map(|(of, width_c)| of.gain.abs() * f64::from(width_c))
            .sum();
        let thermal = &channel.table.thermal;
        let limit_c = thermal.lag2_max_c.max(-thermal.lag2_min_c);
        let of_lag = lag2_gains(channel)
            .iter()
            .fold(0.0_f64, |most, of| most.max(of.abs()));
        println!(
            "{of_plays:.5} {:.5} {thermal:?}",
            of_lag * f64::from(limit_c)
        );
        assert!(of_plays < 0.2 * (2.0 * 0.005 + 12.0 * 0.001), "{of_plays}");
        assert!(
            of_lag * f64::from(limit_c) < 0.2 * 0.0005 * 40.0,
            "{of_lag}"
        );
    }
}

#[test]
fn one_rate_gives_no_second_lag_and_says_so() {
    let fit = fitted(&run(WHOLE, ChamberRun::OneRate, 1, CALM));
    let channel = &fit.set.channels[0];
    assert!(!channel.table.has_second_lag());
    assert!(lag2_gains(channel).iter().all(|&gain| gain == 0.0));
    let selection = channel.selection.as_ref().unwrap();
    assert_eq!(
        (selection.chosen.tau2_s, selection.chosen.kappa2),
        (None, 0.0)
    );
    assert_eq!(selection.ramp_rates_c_per_min.len(), 1);
    let judgement = fit.judge();
    let said = |of: &Warning| of.code == WarningCode::HistoryTermsNotTried;
    assert!(judgement.warnings.iter().any(said), "{judgement:?}");
}

/// One ramp: no temperature was passed at two rates.
#[test]
fn few_soaks_and_ramps_give_neither_rate_terms_nor_history() {
    let mut log = run(WHOLE, ChamberRun::ManyRates, 1, CALM);
    // A part of the first ramp.
    let rows = 250..440;
    log.time_s = log.time_s[rows.clone()].to_vec();
    let channel = &mut log.channels[0];
    channel.temp_c = channel.temp_c[rows.clone()].to_vec();
    channel.axes[0].raw = channel.axes[0].raw[rows].to_vec();
    let fit = fitted(&log);
    let channel = &fit.set.channels[0];
    let selection = channel.selection.as_ref().unwrap();
    assert!(
        selection.soaks_and_ramps < 3,
        "{}",
        selection.soaks_and_ramps
    );
    assert_eq!(selection.chosen.rate_columns, 0);
    assert!(!channel.table.has_history());
    assert!(
        channel.axes[0]
            .polynomials
            .iter()
            .all(|of| of.r == [0.0; 2])
    );
    assert_eq!(channel.table.thermal.kappa, ThermalSettings::DEFAULT.kappa);
    let said = |of: &Warning| of.code == WarningCode::NoRateTerms;
    assert!(fit.judge().warnings.iter().any(said));
}

/// What is not searched stays as the settings have it.
#[test]
fn lags_that_are_given_stay() {
    let log = run(WHOLE, ChamberRun::Verification, 1, CALM);
    let (tau_s, kappa) = (90.0, 0.3);
    for (tau, searches_kappa) in [(false, false), (true, false), (false, true)] {
        let mut options = FitOptions::new("SIMULATED", Method::AUTO);
        options.plan.thermal.tau_s = tau_s;
        options.plan.thermal.kappa = kappa;
        options.plan.search = LagSearch {
            tau,
            kappa: searches_kappa,
        };
        let set = fit(std::slice::from_ref(&log), &options).unwrap().set;
        let thermal = &set.channels[0].table.thermal;
        let stays = |now: f32, before: f32| (now / before - 1.0).abs() < 1e-6;
        assert_eq!(stays(thermal.tau_s, tau_s), !tau, "{}", thermal.tau_s);
        assert_eq!(
            stays(thermal.kappa, kappa),
            !searches_kappa,
            "{}",
            thermal.kappa
        );
    }
}

/// All that a set holds, but for the time at which it was made.
fn timeless(mut set: CoefficientSet) -> CoefficientSet {
    set.provenance.created.clear();
    set
}

#[test]
fn the_same_logs_give_the_same_set() {
    let log = run(WHOLE, ChamberRun::Verification, 1, CALM);
    let [first, second] = [(); 2].map(|()| timeless(fitted(&log).set));
    assert_eq!(first, second);
    // So do summaries that were made apart.
    let options = FitOptions::new("SIMULATED", Method::AUTO);
    let plan = Plan::new(options.plan.clone()).unwrap();
    let summaries = [summarise_log(&log, &plan)];
    assert_eq!(
        timeless(fit_summaries(&summaries, &options).unwrap().set),
        first
    );
}

/// The set of two logs, in either order and in another unit. In another unit rounding differs, which
/// moves where the search ends: where steps gain little.
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
    let options = FitOptions::new("SIMULATED", Method::AUTO);
    let [set, turned, dps] = [&logs, &turned, &dps].map(|logs| fit(logs, &options).unwrap().set);
    assert_eq!(timeless(turned), timeless(set.clone()));
    let scale = 3600.0;
    let (a, b) = (&set.channels[0], &dps.channels[0]);
    assert!(a.table.has_second_lag());
    let lags = |of: &ChannelSet| {
        let of = &of.table.thermal;
        [of.tau_s, of.tau2_s, of.kappa, of.play_kappa]
    };
    for (a, b) in lags(a).into_iter().zip(lags(b)) {
        println!("{a} {b}");
        assert!((b / a - 1.0).abs() < 0.03, "{a} {b}");
    }
    let gains = |of: &ChannelSet| -> Vec<f64> {
        let plays = of.axes[0].gains.iter().map(|of| of.gain);
        plays.chain(lag2_gains(of)).collect()
    };
    for (a, b) in gains(a).iter().zip(gains(b)) {
        println!("{a} {}", b * scale);
        assert!((b * scale / a - 1.0).abs() < 0.1, "{a:?} {b:?}");
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
