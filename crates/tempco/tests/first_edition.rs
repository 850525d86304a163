//! Without the terms that are new, every accepted temperature gives the bias of version 0.1, to the
//! last bit.
//!
//! Its equations are written down here once more, as plainly as they were. Which temperatures are
//! accepted is taken from the core; each must be one that version 0.1 accepted as well.

mod common;

use common::*;
use tempco::{Compensator, Interval, PLAYS, Table, ThermalSettings};

/// A sum of two f32 that follows its input.
struct Sum {
    value: f32,
    remainder: f32,
}

impl Sum {
    fn lag(&mut self, alpha: f32, input: f32) -> f32 {
        let before = self.value;
        let lag = (input - before) - self.remainder;
        let increment = alpha * lag + self.remainder;
        self.value = before + increment;
        self.remainder = increment - (self.value - before);
        lag
    }
}

struct FirstEdition {
    settings: ThermalSettings,
    age_s: f64,
    temp_c: f32,
    filtered: Sum,
    memory: Sum,
    gain: f32,
    effective_c: f32,
    contacts_c: [f32; PLAYS],
}

impl FirstEdition {
    fn start(settings: ThermalSettings, temp_c: f32) -> Self {
        let at = |value| Sum {
            value,
            remainder: 0.0,
        };
        Self {
            settings,
            age_s: 0.0,
            temp_c,
            filtered: at(temp_c),
            memory: at(0.0),
            gain: 1.0 / f32::min(60.0 / settings.tau_s, 1.0),
            effective_c: temp_c,
            contacts_c: [temp_c; PLAYS],
        }
    }

    fn slew_c(&self, dt_s: f32) -> f32 {
        f32::max(self.settings.max_slew_c_per_min * dt_s * (1.0 / 60.0), 2e-5)
    }

    /// Whether a temperature was accepted, `dt_s` after the one before.
    fn accepts(&self, dt_s: f32, temp_c: f32) -> bool {
        let age_s = self.age_s + f64::from(dt_s);
        let far_c = 2.0 + f64::from(self.settings.max_slew_c_per_min) / 60.0 * age_s + 1e-3;
        (-60.0..=150.0).contains(&temp_c) && f64::from((temp_c - self.temp_c).abs()) <= far_c
    }

    /// The bias of both axes after an update that took `accepted`, if that is a number.
    fn update(&mut self, table: &Table<'_, 2>, dt_s: f32, accepted: f32) -> [f32; 2] {
        let s = self.settings;
        let longest_s = 0.5 * s.tau_s;
        let gap = dt_s > longest_s;
        let used_s = dt_s.min(longest_s);
        let slew_c = self.slew_c(used_s);
        let x = used_s * (1.0 / s.tau_s);
        let per_x = 1.0
            - x * (1.0 / 2.0) * (1.0 - x * (1.0 / 3.0) * (1.0 - x * (1.0 / 4.0) * (1.0 - x * 0.2)));
        let alpha = if gap { 1.0 } else { x * per_x };
        let per_min = if gap {
            0.0
        } else {
            60.0 * (1.0 / s.tau_s) * per_x
        };

        // Whatever the part did while nothing was accepted for long, or in a jump, is no rate.
        self.age_s += f64::from(dt_s);
        if !accepted.is_nan() {
            let change_c = accepted - self.temp_c;
            if change_c.abs() > s.spike_gate_c + slew_c || self.age_s > f64::from(longest_s) + 1e-6
            {
                self.filtered.value += change_c;
            }
            self.temp_c = accepted;
            self.age_s = 0.0;
        }
        let temp_c = self.temp_c;
        let lag_c = self.filtered.lag(alpha, temp_c);
        self.memory.lag(alpha, 1.0);
        let memory = self.memory.value.max(f32::min(60.0 / s.tau_s, 1.0));
        self.gain = (self.gain * (2.0 - memory * self.gain)).max(1.0);
        let rate = lag_c * per_min * self.gain;
        let rate = rate.clamp(s.rate_min_c_per_min, s.rate_max_c_per_min);

        let way_c = temp_c - s.kappa * s.tau_s / 60.0 * rate - self.effective_c;
        self.effective_c += way_c.clamp(-slew_c, slew_c);
        let u = self.effective_c;

        let cells = table.cells();
        let position = (u.clamp(T_MIN, T_MAX) - T_MIN) * table.cells_per_c();
        let z = position - (position as usize) as f32;
        core::array::from_fn(|axis| {
            let terms = cells[position as usize][axis];
            let ([a0, a1, a2], [r0, r1]) = (terms.a, terms.r);
            let mut bias = (a0 + z * (a1 + z * a2)) + rate * (r0 + z * r1);
            let widths = [s.half_width1_c, s.half_width2_c];
            for (play, width) in widths.into_iter().enumerate() {
                // The second axis finds the contact where the first has left it.
                let contact_c = &mut self.contacts_c[play];
                *contact_c = contact_c.max(u - width).min(u + width);
                bias += table.play_gains()[play][axis] * (u - *contact_c);
            }
            bias
        })
    }
}

/// Slow and fast ramps, noise, rests, jumps that are taken and that are not, sensors that fail.
fn hostile(noise: &mut Noise, temp_c: &mut f32, rate: &mut f32, dt_s: f32) -> f32 {
    if noise.bits().is_multiple_of(200) {
        *rate = noise.between(-29.0, 29.0) * [0.01, 0.1, 1.0][noise.bits() as usize % 3];
    }
    *temp_c = (*temp_c + *rate / 60.0 * dt_s.min(60.0)).clamp(-59.0, 149.0);
    match noise.bits() % 1024 {
        0..40 => f32::NAN,
        40..50 => noise.between(-80.0, 170.0),
        50..60 => *temp_c + noise.between(-3.0, 3.0),
        60..500 => *temp_c + noise.between(-0.1, 0.1),
        500 => {
            *temp_c = noise.between(-59.0, 149.0);
            *temp_c
        }
        _ => *temp_c,
    }
}

#[test]
fn the_bias_is_that_of_version_0_1_bit_for_bit() {
    let with_plays = ThermalSettings {
        half_width1_c: 3.0,
        half_width2_c: 0.7,
        ..SETTINGS
    };
    let of_kind = |settings: ThermalSettings, tau_s, kappa| ThermalSettings {
        tau_s,
        kappa,
        play_kappa: kappa,
        hold_s: 2e4,
        ..settings
    };
    let gains = [[0.01, -0.02], [0.3, 0.003]];
    let mut compared = 0;
    for (settings, gains) in [(SETTINGS, [[0.0; 2]; PLAYS]), (with_plays, gains)] {
        for &(tau_s, kappa) in first(&[(60.0, 0.0), (30.0, 1.3), (600.0, 0.5), (2400.0, 0.8)], 1) {
            let settings = of_kind(settings, tau_s, kappa);
            let table = table(thermal(settings)).with_plays(gains).unwrap();
            let mut noise = Noise(u64::from(tau_s.to_bits()) + 1);
            let (mut temp_c, mut rate) = (20.0, 1.0);
            let mut unit = Compensator::new(&table);
            let mut old = FirstEdition::start(settings, temp_c);
            unit.start(temp_c);
            for i in 0..fewer(300_000, 300) {
                let dt_s = match (noise.bits() % 512, i / 5000 % 3) {
                    (0, _) => noise.between(1.0, 1500.0),
                    (1..32, _) => noise.between(0.001, 2.0),
                    (_, rate) => [1.0, 0.1, 0.01][rate],
                };
                let read = hostile(&mut noise, &mut temp_c, &mut rate, dt_s);
                let rejected = unit.thermal_state().rejected();
                let out = unit.step(&Interval::new(table.thermal(), dt_s), read, [0.0; 2]);
                let is_accepted = unit.thermal_state().rejected() == rejected;
                assert!(!is_accepted || old.accepts(dt_s, read), "{i}: {read}");
                let bias = old.update(&table, dt_s, if is_accepted { read } else { f32::NAN });
                assert_eq!(
                    out.bias.map(f32::to_bits),
                    bias.map(f32::to_bits),
                    "{i}: {read} {out:?}"
                );
                compared += usize::from(is_accepted);
            }
        }
    }
    assert!(compared > fewer(1_000_000, 100), "{compared}");
}
