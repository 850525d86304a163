//! Simulated units whose bias is known, for judging fits: what makes the bias differs from world
//! to world, and in all but one it is outside every family of models that is fitted.
#![allow(dead_code, reason = "each test takes what it needs")]

use std::sync::LazyLock;

use tempco_log::{Axis, AxisUnit, Channel, Log, SkippedRows};
use tempco_twin::Unit;

/// Time between rows \[s\].
const INTERVAL_S: f64 = 1.0;

/// Noise of a row \[deg/h\]: an angle random walk of 0.001 deg/sqrt(h).
const NOISE_DPH: f64 = 0.06;

/// Noise of a temperature reading \[degC\].
const SENSOR_NOISE_C: f64 = 0.01;

/// Time constant of the case, on which the sensor sits, behind the air \[s\].
const CASE_S: f64 = 240.0;

/// What makes the bias.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum World {
    /// The paper's form: quadratics by segment, blended; rate terms in a 60 s rate.
    Paper,
    /// A cavity that lags the sensor.
    Lagged,
    /// A cavity for each axis, a slow node, hysteresis, random walk, a constant per turn-on.
    Full,
    /// The same with a smooth curve and short lags.
    Smooth,
}

/// A run of the chamber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChamberRun {
    /// Up and down at 0.25, 0.5, 1 and 2 degC/min.
    ManyRates,
    /// Up and down three times at 1 degC/min.
    OneRate,
    /// Other rates, other soaks, parts of the range.
    Verification,
    /// Switched on in the middle of a ramp.
    MidRamp,
}

/// Random numbers (splitmix64; the sum of twelve uniform ones for normal ones).
pub(crate) struct Random(u64);

impl Random {
    /// Every seed gives another series.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xD134_2543_DE82_EF95))
    }

    /// Uniform, 0 to 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// Mean 0, variance 1.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A log and the bias behind it, by axis and row.
pub(crate) struct Run {
    pub(crate) log: Log,
    pub(crate) truth: Vec<Vec<f64>>,
}

/// What an axis of a unit is like.
struct Nature {
    lag_s: f64,
    slow: f64,
    play: f64,
    rate: f64,
    wavelength: f64,
    phase: f64,
}

/// Air temperature: (target, rate in degC/min) or (target, 0, minutes).
fn steps(chamber_run: ChamberRun) -> Vec<(f64, f64, f64)> {
    let (ramp, soak) = (|to, rate| (to, rate, 0.0), |at, min| (at, 0.0, min));
    match chamber_run {
        ChamberRun::ManyRates => [0.5, 1.0, 0.25, 2.0]
            .into_iter()
            .flat_map(|rate| {
                [
                    ramp(80.0, rate),
                    soak(80.0, 45.0),
                    ramp(-15.0, rate),
                    soak(-15.0, 45.0),
                ]
            })
            .collect(),
        ChamberRun::OneRate => (0..4)
            .flat_map(|_| {
                [
                    ramp(80.0, 1.0),
                    soak(80.0, 45.0),
                    ramp(-15.0, 1.0),
                    soak(-15.0, 45.0),
                ]
            })
            .collect(),
        ChamberRun::Verification => vec![
            soak(20.0, 30.0),
            ramp(-12.0, 0.7),
            soak(-12.0, 40.0),
            ramp(30.0, 1.5),
            soak(30.0, 30.0),
            ramp(75.0, 1.5),
            soak(75.0, 40.0),
            ramp(5.0, 0.35),
            soak(5.0, 60.0),
            ramp(60.0, 0.7),
            soak(60.0, 20.0),
            ramp(-12.0, 1.5),
            soak(-12.0, 40.0),
            ramp(45.0, 0.35),
        ],
        ChamberRun::MidRamp => vec![
            ramp(75.0, 1.0),
            soak(75.0, 40.0),
            ramp(-12.0, 1.0),
            soak(-12.0, 30.0),
        ],
    }
}

fn air_c(chamber_run: ChamberRun) -> Vec<f64> {
    let mut at = match chamber_run {
        ChamberRun::Verification => 20.0,
        _ => -15.0,
    };
    let mut air = vec![at; (1800.0 / INTERVAL_S) as usize];
    for (target, rate, minutes) in steps(chamber_run) {
        let per_row = rate / 60.0 * INTERVAL_S;
        while rate > 0.0 && (target - at).abs() > per_row {
            at += per_row * (target - at).signum();
            air.push(at);
        }
        at = target;
        air.extend(std::iter::repeat_n(
            at,
            (60.0 * minutes / INTERVAL_S) as usize,
        ));
    }
    air
}

/// First-order lag, at rest at the beginning.
fn lagged(values: &[f64], tau_s: f64) -> Vec<f64> {
    let gain = 1.0 - (-INTERVAL_S / tau_s).exp();
    let mut state = values[0];
    let step = |&value: &f64| {
        state += gain * (value - state);
        state
    };
    values.iter().map(step).collect()
}

/// Distance from a play of half-width `w`.
fn play(values: &[f64], w: f64) -> Vec<f64> {
    let mut centre = values[0];
    let step = |&value: &f64| {
        centre = centre.clamp(value - w, value + w);
        value - centre
    };
    values.iter().map(step).collect()
}

fn natures(world: World, random: &mut Random) -> Vec<Nature> {
    let lags: [f64; 3] = match world {
        World::Paper => [60.0; 3],
        World::Lagged => [300.0, 420.0, 240.0],
        World::Full => [800.0, 650.0, 500.0],
        World::Smooth => [150.0, 210.0, 100.0],
    };
    let whole = matches!(world, World::Full | World::Smooth);
    let mut around = |value: f64| value * (0.8 + 0.4 * random.uniform());
    lags.into_iter()
        .map(|lag| Nature {
            lag_s: if world == World::Paper {
                lag
            } else {
                around(lag)
            },
            slow: if whole { around(0.00012) } else { 0.0 },
            play: if whole { around(0.0006) } else { 0.0 },
            rate: around(0.01),
            wavelength: around(60.0),
            phase: around(3.0),
        })
        .collect()
}

static PAPER: LazyLock<Unit> = LazyLock::new(|| Unit::named("paper").expect("the unit"));

/// Static bias \[deg/h\] at a temperature \[degC\].
fn curve(world: World, axis: usize, nature: &Nature, temp_c: f64) -> f64 {
    if world == World::Smooth {
        let x = (temp_c - 32.5) / 47.5;
        let scale = [0.05, -0.04, 0.035][axis];
        return scale * (x + 0.5 * x * x - 0.3 * x * x * x);
    }
    let per_pulse = 1.5;
    let paper = |axis: usize, temp_c| PAPER.axes[axis].static_curve.value(temp_c);
    per_pulse
        * match axis {
            0 | 1 => paper(axis, temp_c),
            _ if world == World::Paper => paper(0, 65.0 - temp_c) * 0.8,
            _ => {
                let x = (temp_c - 32.5) / 47.5;
                let wave =
                    (std::f64::consts::TAU * temp_c / nature.wavelength + nature.phase).sin();
                0.035 * x + 0.012 * wave
            }
        }
}

/// Runs the unit of `seed` through a chamber run; `run` gives another noise, walk and turn-on.
pub(crate) fn simulate(world: World, chamber_run: ChamberRun, seed: u64, run: u64) -> Run {
    let natures = natures(world, &mut Random::new(seed));
    let mut random = Random::new(1_000 * (seed + 1) + run);
    let mut air = air_c(chamber_run);
    let mut case = lagged(&air, CASE_S);
    let mut hidden: Vec<Vec<f64>> = Vec::new();
    let slow = lagged(&lagged(&case, 600.0), 5400.0);
    for nature in &natures {
        hidden.push(lagged(&case, nature.lag_s));
    }
    let rows = air.len();
    let from = if chamber_run == ChamberRun::MidRamp {
        1800 + 2400
    } else {
        0
    };
    let mut truth = Vec::new();
    for (axis, nature) in natures.iter().enumerate() {
        let cavity = &hidden[axis];
        let moved = play(cavity, 3.0);
        let walks = matches!(world, World::Full | World::Smooth);
        let mut walk = if walks { 0.0008 * random.normal() } else { 0.0 };
        let step = if walks {
            0.0002 * (INTERVAL_S / 3600.0_f64).sqrt()
        } else {
            0.0
        };
        let bias = (0..rows).map(|i| {
            walk += step * random.normal();
            let rate = 60.0 * (case[i] - cavity[i]) / nature.lag_s;
            let place = if world == World::Paper {
                case[i]
            } else {
                cavity[i]
            };
            let sensitivity = nature.rate * (1.0 + 0.004 * (place - 25.0));
            curve(world, axis, nature, place)
                + sensitivity * rate
                + nature.slow * (slow[i] - cavity[i])
                + nature.play * moved[i]
                + walk
        });
        truth.push(bias.collect::<Vec<f64>>()[from..].to_vec());
    }
    case.drain(..from);
    air.drain(..from);
    let temp_c = case
        .iter()
        .map(|&temp_c| (temp_c + SENSOR_NOISE_C * random.normal()) as f32)
        .collect();
    let axes = truth.iter().zip(["x", "y", "z"]).map(|(bias, name)| Axis {
        name: name.to_owned(),
        unit: AxisUnit::Dph,
        raw: bias
            .iter()
            .map(|b| b + NOISE_DPH * random.normal())
            .collect(),
    });
    let axes = axes.collect();
    Run {
        log: Log {
            file: format!("{world:?} {chamber_run:?} {seed} {run}"),
            sha256: format!("{world:?}{chamber_run:?}{seed}-{run}"),
            time_s: (0..case.len()).map(|i| INTERVAL_S * i as f64).collect(),
            channels: vec![Channel {
                column: "temp_c".to_owned(),
                temp_c,
                axes,
            }],
            reading: tempco_log::Reading::default(),
            ignored_columns: Vec::new(),
            skipped_rows: SkippedRows::default(),
            interval_s: INTERVAL_S,
        },
        truth,
    }
}
