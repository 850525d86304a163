//! Faults of signals are found wherever and on whichever axis they are, and sound logs have none.

use std::ops::Range;

use tempco_log::signals::{Fault, Finding, Signals};

/// Random numbers that are the same everywhere.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// About normal, with standard deviation 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A sound log: a soak, a ramp up, a soak, a ramp down, a soak.
#[derive(Clone, Copy, Debug)]
struct World {
    rows: usize,
    interval_s: f64,
    temp_noise_c: f64,
    temp_step_c: f64,
    /// Noise of a row of an axis, of which the bias moves by about 1.
    noise: f64,
    step: f64,
    /// Rows for which the temperature, and the axes, are held.
    held: (usize, usize),
    /// Share of the log that is soaks.
    soaks: f64,
    /// Time constant with which the axes follow the temperature [share of the log].
    lag: f64,
    /// Whether an axis counts steps, so that what is rounded off comes with the next row.
    counts: bool,
    /// How far a bias wanders from one end of the log to the other, by about.
    drift: f64,
}

const FINE: World = World {
    rows: 20_000,
    interval_s: 0.2,
    temp_noise_c: 0.02,
    temp_step_c: 0.01,
    noise: 0.05,
    step: 1e-4,
    held: (1, 1),
    soaks: 0.4,
    lag: 0.0,
    counts: false,
    drift: 0.0,
};

struct Columns {
    time_s: Vec<f64>,
    temp_c: Vec<f32>,
    axes: Vec<Vec<f64>>,
}

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

impl World {
    fn log(&self, seed: u64) -> Columns {
        let mut random = Random(seed);
        let mut log = Columns {
            time_s: Vec::new(),
            temp_c: Vec::new(),
            axes: vec![Vec::new(); 3],
        };
        let ramp = 0.5 * (1.0 - self.soaks);
        let (mut of_unit_c, mut left, mut drift) = (-10.0, [0.0; 3], [0.0; 3]);
        for row in 0..self.rows {
            // A soak, a ramp up, a soak twice as long, a ramp down, a soak.
            let place = row as f64 / self.rows as f64;
            let up = (place - self.soaks / 4.0) / ramp;
            let down = (1.0 - place - self.soaks / 4.0) / ramp;
            let true_c = -10.0 + 60.0 * up.min(down).clamp(0.0, 1.0);
            let follows = 1.0 / (1.0 + self.lag * self.rows as f64);
            of_unit_c += follows * (true_c - of_unit_c);
            log.time_s.push(row as f64 * self.interval_s);
            let is_held = |rows: usize| row % rows != 0;
            let read_c = true_c + self.temp_noise_c * random.normal();
            log.temp_c.push(match is_held(self.held.0) {
                true => log.temp_c[row - 1],
                false => rounded(read_c, self.temp_step_c) as f32,
            });
            for (axis, slope) in [0.012, -0.016, 0.006].into_iter().enumerate() {
                let d = of_unit_c - 25.0;
                drift[axis] += self.drift / (self.rows as f64).sqrt() * random.normal();
                let bias = 0.3 + slope * d + 1e-4 * d * d + drift[axis];
                let value = bias + self.noise * random.normal() + left[axis];
                let read = rounded(value, self.step);
                left[axis] = f64::from(u8::from(self.counts)) * (value - read);
                let column = &mut log.axes[axis];
                column.push(match is_held(self.held.1) {
                    true => column[row - 1],
                    false => read,
                });
            }
        }
        log
    }
}

/// Findings of a log that comes in parts.
fn find(log: &Columns, part: usize) -> Vec<Finding> {
    let mut signals = Signals::new(log.axes.len());
    for start in (0..log.time_s.len()).step_by(part) {
        let rows = start..log.time_s.len().min(start + part);
        let axes: Vec<&[f64]> = log.axes.iter().map(|axis| &axis[rows.clone()]).collect();
        signals.take(&log.time_s[rows.clone()], &log.temp_c[rows], &axes);
    }
    signals.finish("temp_c", &["x", "y", "z"])
}

/// Logs with all kinds of noise, steps and rates that loggers write.
fn sound() -> Vec<World> {
    let mut worlds = Vec::new();
    for (rows, interval_s) in [(1_500, 10.0), (20_000, 0.2), (60_000, 0.02), (60_000, 1.0)] {
        let world = World {
            rows,
            interval_s,
            ..FINE
        };
        for temp_noise_c in [0.0, 0.005, 0.02, 0.1, 0.5] {
            for temp_step_c in [0.001, 0.0625, 0.5, 1.0] {
                for (noise, step) in [(0.05, 1e-4), (0.5, 1e-3)] {
                    worlds.push(World {
                        temp_noise_c,
                        temp_step_c,
                        noise,
                        step,
                        ..world
                    });
                }
            }
        }
        for noise in [0.0, 0.01, 0.03, 0.1, 0.3] {
            // The noise in steps, from hardly any to four of them.
            for in_steps in [0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 4.0] {
                let step = f64::max(noise, 0.01) / in_steps;
                // An axis that stays within a step or two does stand still.
                if step > 0.25 {
                    continue;
                }
                worlds.push(World {
                    noise,
                    step,
                    ..world
                });
            }
        }
        for held in [(10, 1), (100, 1), (1, 5), (50, 50)] {
            // A temperature that is read every 1000 s does stand still.
            if held.0 as f64 * interval_s <= 500.0 {
                worlds.push(World { held, ..world });
            }
        }
        for (soaks, lag, drift) in [
            (0.8, 0.0, 0.0),
            (0.8, 0.02, 0.0),
            (0.8, 0.05, 0.1),
            (0.4, 0.03, 0.1),
            (0.6, 0.0, 0.2),
        ] {
            for (temp_noise_c, temp_step_c) in [(0.0, 1.0), (0.01, 1.0), (0.01, 0.0625), (0.1, 0.5)]
            {
                for (noise, step, counts) in [
                    (0.05, 1e-4, false),
                    (0.002, 0.02, false),
                    (0.01, 0.2, true),
                    (0.1, 0.2, true),
                ] {
                    worlds.push(World {
                        temp_noise_c,
                        temp_step_c,
                        noise,
                        step,
                        soaks,
                        lag,
                        counts,
                        drift,
                        ..world
                    });
                }
            }
        }
    }
    worlds
}

#[test]
fn sound_logs_have_no_findings() {
    let mut alarms = 0;
    for (number, world) in sound().into_iter().enumerate() {
        let mut found = find(&world.log(11 + number as u64), 4096);
        // Where a bias wanders as far as the temperature moves it, a warning is due.
        found.retain(|of| world.drift < 0.2 || of.fault != Fault::StandingTemperature);
        if !found.is_empty() {
            println!("{world:?}: {found:?}");
            alarms += 1;
        }
    }
    assert_eq!(alarms, 0);
}

/// Worlds in which a fault can be seen.
const WORLDS: [World; 4] = [
    FINE,
    World {
        rows: 60_000,
        interval_s: 0.02,
        ..FINE
    },
    World {
        rows: 6_000,
        interval_s: 2.0,
        // One step of noise.
        step: 0.05,
        temp_noise_c: 0.0625,
        temp_step_c: 0.0625,
        ..FINE
    },
    World {
        held: (10, 5),
        rows: 40_000,
        ..FINE
    },
];

/// Sweeps share, place and axis of a fault; `spoil` puts it into the rows.
fn sweep(fault: Fault, shares: &[f64], spoil: impl Fn(&mut Columns, usize, Range<usize>)) {
    let mut missed = 0;
    for (number, world) in WORLDS.into_iter().enumerate() {
        for (share, place, axis) in shares.iter().flat_map(|&share| {
            let places = [0.0, 0.13, 0.5, 0.77, 1.0].into_iter();
            places.flat_map(move |place| (0..3).map(move |axis| (share, place, axis)))
        }) {
            let mut log = world.log(11 + number as u64 + (share * 1e6) as u64);
            let count = (share * world.rows as f64) as usize;
            let start = (place * (world.rows - count) as f64) as usize;
            let rows = start..start + count;
            spoil(&mut log, axis, rows.clone());
            let found = find(&log, 1000);
            let column = match fault {
                Fault::FrozenTemperature => "temp_c",
                _ => ["x", "y", "z"][axis],
            };
            let slack_s = 30.0 * world.interval_s;
            let is_near = |a: f64, row: usize| (a - log.time_s[row]).abs() <= slack_s;
            let is_it = |of: &Finding| {
                of.fault == fault
                    && of.column == column
                    && (of.share - share).abs() < 0.1 * share
                    && is_near(of.from_s, rows.start)
                    && is_near(of.to_s, rows.end - 1)
            };
            if !found.iter().any(is_it) {
                println!("{world:?} {share} {place} {axis}: {found:?}");
                missed += 1;
            }
        }
    }
    assert_eq!(missed, 0);
}

#[test]
fn full_scale_is_found() {
    for rail in [250.1376, -250.1376] {
        let shares = [0.03, 0.08, 0.27, 0.6];
        sweep(Fault::FullScale, &shares, |log, axis, rows| {
            log.axes[axis][rows].fill(rail);
        });
    }
}

/// An offset takes the axis to its stop: the values beyond are cut off.
#[test]
fn noise_that_is_cut_off_is_found() {
    for cut in [0.02, 0.1, 0.3] {
        for axis in 0..3 {
            let mut log = FINE.log(11);
            let mut sorted = log.axes[axis].clone();
            sorted.sort_by(f64::total_cmp);
            let stop = sorted[((1.0 - cut) * sorted.len() as f64) as usize];
            for value in &mut log.axes[axis] {
                *value = value.min(stop);
            }
            let found = find(&log, 1000);
            let faults: Vec<Fault> = found.iter().map(|of| of.fault).collect();
            assert!(faults.contains(&Fault::FullScale), "{cut}: {found:?}");
        }
    }
}

#[test]
fn identical_values_are_found() {
    let shares = [0.03, 0.1, 0.34, 0.6];
    sweep(Fault::IdenticalValues, &shares, |log, axis, rows| {
        let value = log.axes[axis][rows.start];
        log.axes[axis][rows].fill(value);
    });
    let shares = [0.05, 0.5, 1.0];
    sweep(Fault::IdenticalValues, &shares, |log, axis, rows| {
        log.axes[axis][rows].fill(0.0);
    });
}

/// A link that drops out now and then repeats its last value.
#[test]
fn many_short_runs_are_found_together() {
    for world in WORLDS {
        let mut log = world.log(11);
        let rows = log.axes[1].len();
        for start in (rows / 16..rows).step_by(rows / 8) {
            let value = log.axes[1][start];
            log.axes[1][start..start + rows / 40].fill(value);
        }
        let found = find(&log, 1000);
        let is_it = |of: &Finding| {
            of.fault == Fault::IdenticalValues && (of.share - 0.2).abs() < 0.03 && of.column == "y"
        };
        assert!(found.iter().any(is_it), "{world:?} {found:?}");
    }
}

#[test]
fn a_frozen_temperature_is_found() {
    let shares = [0.05, 0.2, 0.73];
    sweep(Fault::FrozenTemperature, &shares, |log, _, rows| {
        let value = log.temp_c[rows.start];
        log.temp_c[rows].fill(value);
    });
}

/// Without noise of its own, a coarse temperature is judged by the axes.
#[test]
fn a_coarse_temperature_that_freezes_in_a_ramp_is_found() {
    for (temp_step_c, step, counts) in [(1.0, 1e-4, false), (0.5, 0.2, true), (0.0625, 0.05, false)]
    {
        for (from, to) in [(0.12, 0.5), (0.15, 0.9), (0.6, 1.0)] {
            let world = World {
                temp_noise_c: 0.0,
                temp_step_c,
                step,
                counts,
                ..FINE
            };
            let mut log = world.log(11);
            let [from, to] = [from, to].map(|share| (share * world.rows as f64) as usize);
            let value = log.temp_c[from];
            log.temp_c[from..to].fill(value);
            let found = find(&log, 1000);
            let faults: Vec<Fault> = found.iter().map(|of| of.fault).collect();
            let is_there = faults.contains(&Fault::FrozenTemperature);
            assert!(is_there, "{world:?} {from} {to} {found:?}");
        }
    }
}

/// A coarse output stands still in soaks, but not in ramps.
#[test]
fn an_axis_of_whole_pulses_that_freezes_in_a_ramp_is_found() {
    let world = World {
        noise: 0.02,
        step: 0.2,
        counts: true,
        ..FINE
    };
    for axis in 0..3 {
        for (from, to) in [(0.1, 0.4), (0.2, 0.5), (0.4, 0.9)] {
            let mut log = world.log(11);
            let [from, to] = [from, to].map(|share| (share * world.rows as f64) as usize);
            let value = log.axes[axis][from];
            log.axes[axis][from..to].fill(value);
            let found = find(&log, 1000);
            let faults: Vec<Fault> = found.iter().map(|of| of.fault).collect();
            assert!(
                faults.contains(&Fault::IdenticalValues),
                "{axis} {from} {to}"
            );
        }
    }
}

/// Noise of half a step says by itself that an axis is frozen, even in a soak.
#[test]
fn a_coarse_axis_with_noise_that_freezes_in_a_soak_is_found() {
    for in_steps in [0.45, 0.6, 1.0] {
        let world = World {
            noise: 0.2 * in_steps,
            step: 0.2,
            ..FINE
        };
        for axis in 0..3 {
            let mut log = world.log(11);
            let [from, to] = [0.42, 0.58].map(|share| (share * world.rows as f64) as usize);
            let value = log.axes[axis][from];
            log.axes[axis][from..to].fill(value);
            let found = find(&log, 1000);
            let column = ["x", "y", "z"][axis];
            let is_it = |of: &Finding| of.fault == Fault::IdenticalValues && of.column == column;
            assert!(found.iter().any(is_it), "{in_steps} {axis} {found:?}");
        }
    }
}
