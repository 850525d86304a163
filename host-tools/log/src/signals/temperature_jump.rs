//! Temperatures that change faster than a part can, and stay changed.
//!
//! A counter of the sensor folded, a sign or a decimal went missing, or the unit changed on the way.
//! Spikes return at once, and the core leaves them out.

use tempco::ThermalSettings;

use super::Place;

/// Smaller changes are never a jump \[degC\]. The core's own gate is 2 degC.
const LEAST_C: f64 = 3.0;

/// No part heats or cools faster from row to row \[degC/s\].
const FASTEST_C_PER_S: f64 = 2.0;

/// A reading may have been held for so long \[s\] ...
const HELD_S: f64 = 10.0;

/// ... at the rate of a hot-air gun, 40 degC/min \[degC/s\].
const HELD_C_PER_S: f64 = 0.67;

/// A jump is so many times larger than all changes around it.
const RATIO: f64 = 4.0;

/// What remains of the largest change so far, with every further change.
const MEMORY: f64 = 0.97;

/// The temperatures before and after a jump last for so long \[s\], more than a reading is held ...
const LASTS_S: f64 = 12.0;

/// ... and for so many rows.
const LASTS_ROWS: usize = 5;

/// Rows this much further apart than usual have a gap between them, over which nothing is judged ...
const GAP_INTERVALS: f64 = 10.0;

/// ... if it is this long at least \[s\].
const GAP_S: f64 = 5.0;

/// Follows the temperature, and with it a second level that rows jump to.
#[derive(Clone, Debug)]
pub(super) struct TemperatureJump {
    rows: usize,
    /// Time of the last row, and of the first, moved up by all gaps since \[s\].
    last_s: f64,
    first_s: f64,
    level: Level,
    /// The level that the last rows have jumped to.
    away: Option<(Level, Jump)>,
    found: Option<Found>,
    /// What was found before the last jump.
    found_before: Option<Found>,
}

/// A temperature that changes no faster than a part can.
#[derive(Clone, Copy, Debug)]
struct Level {
    temp_c: f64,
    /// Time of the first row \[s\].
    from_s: f64,
    rows: usize,
    /// Time of the last change \[s\].
    changed_s: f64,
    /// The largest change of late \[degC\].
    largest_c: f64,
}

#[derive(Clone, Copy, Debug)]
struct Jump {
    /// Number of the first row after it, from 1.
    row: usize,
    time_s: f64,
    took_s: f64,
    from_c: f64,
    to_c: f64,
}

/// The first jump, and what came after it.
#[derive(Clone, Copy, Debug)]
struct Found {
    first: Jump,
    jumps: usize,
    last_s: f64,
}

impl Level {
    const fn new(temp_c: f64, time_s: f64) -> Self {
        Self {
            temp_c,
            from_s: time_s,
            rows: 1,
            changed_s: time_s,
            largest_c: 0.0,
        }
    }

    /// Whether a part can have come to a temperature since the row before, `interval_s` ago.
    fn reaches(&self, temp_c: f64, time_s: f64, interval_s: f64) -> bool {
        let change_c = (temp_c - self.temp_c).abs();
        if change_c <= LEAST_C {
            return true;
        }
        // A held reading catches up with all that happened since its last change.
        let held_c = HELD_C_PER_S * (time_s - self.changed_s).min(HELD_S);
        let moved_c = LEAST_C + held_c.max(FASTEST_C_PER_S * interval_s);
        change_c <= moved_c.max(RATIO * self.largest_c)
    }

    /// Goes on to the next temperature, without a branch: of coarse steps no processor can guess
    /// whether the next one changes.
    #[inline]
    fn go_on(&mut self, temp_c: f64, time_s: f64) {
        let change_c = (temp_c - self.temp_c).abs();
        let (memory, changed_s) = match change_c > 0.0 {
            true => (MEMORY, time_s),
            false => (1.0, self.changed_s),
        };
        // No number here is NaN; `f64::max` would look for it.
        let faded_c = memory * self.largest_c;
        self.largest_c = if change_c > faded_c {
            change_c
        } else {
            faded_c
        };
        self.changed_s = changed_s;
        self.temp_c = temp_c;
        self.rows += 1;
    }

    /// A sensor that is open or short reads one value, which the core leaves out.
    fn is_rail(&self) -> bool {
        let ThermalSettings {
            sensor_min_c,
            sensor_max_c,
            ..
        } = ThermalSettings::DEFAULT;
        let range_c = f64::from(sensor_min_c)..=f64::from(sensor_max_c);
        self.largest_c == 0.0 && !range_c.contains(&self.temp_c)
    }

    fn lasts(&self, time_s: f64) -> bool {
        self.rows >= LASTS_ROWS && time_s - self.from_s >= LASTS_S
    }
}

impl TemperatureJump {
    pub(super) const fn new(_axes: usize) -> Self {
        Self {
            rows: 0,
            last_s: 0.0,
            first_s: 0.0,
            // No row is near it.
            level: Level::new(f64::NAN, 0.0),
            away: None,
            found: None,
            found_before: None,
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], _axes: &[&[f64]]) {
        // The level is kept in registers; nearly all rows are near it.
        let (mut level, mut last_s, mut is_at_level) =
            (self.level, self.last_s, self.away.is_none());
        let before = self.rows;
        for (row, (&time_s, &temp_c)) in time_s.iter().zip(temp_c).enumerate() {
            let (temp_c, interval_s) = (f64::from(temp_c), time_s - last_s);
            let is_near = (temp_c - level.temp_c).abs() <= LEAST_C && interval_s <= GAP_S;
            if is_near && is_at_level {
                level.go_on(temp_c, time_s);
            } else {
                (self.level, self.last_s, self.rows) = (level, last_s, before + row);
                self.unusual(time_s, temp_c, interval_s);
                (level, is_at_level) = (self.level, self.away.is_none());
            }
            last_s = time_s;
        }
        (self.level, self.last_s, self.rows) = (level, last_s, before + time_s.len());
    }

    /// A row after a pause, or far from the level, or the first.
    #[cold]
    fn unusual(&mut self, time_s: f64, temp_c: f64, interval_s: f64) {
        if self.rows == 0 || (interval_s > GAP_S && self.is_gap(interval_s)) {
            self.first_s += interval_s;
            self.away = None;
            self.level = Level::new(temp_c, time_s);
        } else if self.away.is_none() && self.level.reaches(temp_c, time_s, interval_s) {
            self.level.go_on(temp_c, time_s);
        } else {
            self.far(time_s, temp_c, interval_s);
        }
    }

    fn is_gap(&self, interval_s: f64) -> bool {
        let intervals = self.rows - 1;
        intervals > 0
            && interval_s > GAP_INTERVALS * (self.last_s - self.first_s) / intervals as f64
    }

    /// A row that is far from the level, or follows such a row.
    fn far(&mut self, time_s: f64, temp_c: f64, interval_s: f64) {
        if let Some((away, jump)) = &mut self.away {
            let (back_c, on_c) = (temp_c - self.level.temp_c, temp_c - away.temp_c);
            if back_c.abs() < on_c.abs() {
                // It has returned: a spike.
                self.away = None;
                self.level.go_on(temp_c, time_s);
                return;
            }
            if away.reaches(temp_c, time_s, interval_s) {
                away.go_on(temp_c, time_s);
                if away.lasts(time_s) {
                    // A part that heats fast goes on to do so after the first large change.
                    let size_c = (jump.to_c - jump.from_c).abs();
                    let is_sudden = size_c > RATIO * away.largest_c;
                    if self.level.is_rail() {
                        // A sensor that was open is back.
                        self.found = self.found_before;
                    } else if is_sudden && self.level.lasts(jump.time_s) {
                        self.found_before = self.found;
                        let found = self.found.get_or_insert(Found {
                            first: *jump,
                            jumps: 0,
                            last_s: 0.0,
                        });
                        found.jumps += 1;
                        found.last_s = jump.time_s;
                    }
                    self.level = *away;
                    self.away = None;
                }
                return;
            }
        }
        let jump = Jump {
            row: self.rows + 1,
            time_s,
            took_s: interval_s,
            from_c: self.level.temp_c,
            to_c: temp_c,
        };
        self.away = Some((Level::new(temp_c, time_s), jump));
    }

    pub(super) fn finish(self) -> Vec<Place> {
        let place = |found: Found| {
            let first = found.first;
            let others = match found.jumps {
                1 => String::new(),
                jumps => format!(", the first of {jumps} such changes"),
            };
            let (from_c, to_c) = (first.from_c, first.to_c);
            Place {
                axis: None,
                rows: found.jumps,
                from_s: first.time_s,
                to_s: found.last_s,
                detail: format!(
                    "row {}: from {from_c:.1} to {to_c:.1} degC in {:.3} s{others}",
                    first.row, first.took_s
                ),
            }
        };
        self.found.into_iter().map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::signals::made::{Made, Noise, rounded, up_and_down};

    fn found(log: &Made) -> Vec<Place> {
        let mut detector = TemperatureJump::new(0);
        log.parts(|time_s, temp_c, axes| detector.take(time_s, temp_c, axes));
        detector.finish()
    }

    /// Up and down within an hour and a half.
    fn chamber(interval_s: f64, sigma_c: f64, range_c: (f64, f64), seed: u64) -> Made {
        let mut noise = Noise::new(seed);
        Made::new((5400.0 / interval_s) as usize, interval_s, |share| {
            up_and_down(share, range_c.0, range_c.1) + sigma_c * noise.next()
        })
    }

    fn changed(mut log: Made, mut change: impl FnMut(usize, f64) -> f64) -> Made {
        for (row, temp_c) in log.temp_c.iter_mut().enumerate() {
            *temp_c = change(row, f64::from(*temp_c)) as f32;
        }
        log
    }

    proptest! {
        #[test]
        fn folds_are_found_wherever_they_are(
            seed in 0_u64..1000,
            interval_s in prop::sample::select(vec![0.02, 0.1, 0.5, 2.0]),
            sigma_c in prop::sample::select(vec![0.0, 0.02, 0.3]),
            step_c in prop::sample::select(vec![0.25, 0.5]),
            fold_c in -20.0..40.0_f64,
        ) {
            let log = chamber(interval_s, sigma_c, (-35.0, 60.0), seed);
            let clean = changed(log.clone(), |_, temp_c| rounded(temp_c, step_c));
            prop_assert_eq!(found(&clean), []);
            let folded = changed(log, |_, temp_c| {
                let codes = ((temp_c - fold_c) / step_c).round();
                fold_c + step_c * codes.rem_euclid(256.0)
            });
            let found = found(&folded);
            prop_assert_eq!(found.len(), 1);
            prop_assert!(found[0].rows >= 2, "{:?}", found);
        }

        #[test]
        fn lasting_changes_are_found_wherever_they_are(
            seed in 0_u64..1000,
            interval_s in prop::sample::select(vec![0.02, 0.1, 0.5, 1.0]),
            sigma_c in prop::sample::select(vec![0.005, 0.02, 0.1]),
            step_c in prop::sample::select(vec![0.0, 0.01, 0.0625]),
            place in 0.02..0.98,
            size_c in 10.0..60.0_f64,
            is_up: bool,
        ) {
            let log = chamber(interval_s, sigma_c, (-10.0, 50.0), seed);
            let at = (place * log.temp_c.len() as f64) as usize;
            let size_c = if is_up { size_c } else { -size_c };
            let jump = changed(log, |row, temp_c| {
                rounded(temp_c + if row >= at { size_c } else { 0.0 }, step_c)
            });
            let found = found(&jump);
            prop_assert_eq!(found.len(), 1);
            prop_assert_eq!((found[0].rows, found[0].from_s), (1, jump.time_s[at]));
            let row = format!("row {}: from", at + 1);
            prop_assert!(found[0].detail.starts_with(&row), "{:?}", found);
        }

        #[test]
        fn another_unit_from_some_row_on_is_found(
            seed in 0_u64..1000,
            kind in 0..4,
            place in 0.05..0.95,
        ) {
            let log = chamber(0.2, 0.02, (8.0, 19.0), seed);
            let at = (place * log.temp_c.len() as f64) as usize;
            let other = |temp_c: f64| match kind {
                0 => 1.8 * temp_c + 32.0,
                1 => 10.0 * temp_c,
                2 => -temp_c,
                _ => (temp_c - 36.53) * 340.0 / 333.87,
            };
            let log = changed(log, |row, t| if row < at { t } else { other(t) });
            prop_assert_eq!(found(&log).len(), 1);
        }

        #[test]
        fn what_returns_at_once_is_no_jump(
            seed in 0_u64..1000,
            size_c in -90.0..90.0,
            place in 0.02..0.97,
            rows in 1_usize..=3,
        ) {
            let log = chamber(0.2, 0.02, (-10.0, 50.0), seed);
            let at = (place * log.temp_c.len() as f64) as usize;
            let spikes = changed(log, |row, temp_c| {
                let is_spike = (at..at + rows).contains(&row) || row % 977 == 0;
                temp_c + if is_spike { size_c } else { 0.0 }
            });
            prop_assert_eq!(found(&spikes), []);
        }

        #[test]
        fn what_parts_can_do_is_no_jump(
            seed in 0_u64..1000,
            interval_s in prop::sample::select(vec![0.01, 0.1, 1.0, 10.0]),
            step_c in prop::sample::select(vec![0.0, 0.0625, 0.5, 1.0]),
            sigma_c in prop::sample::select(vec![0.0, 0.02, 0.5]),
            held_s in prop::sample::select(vec![0.0, 1.0, 10.0]),
            time_constant_s in 60.0..300.0_f64,
            rate_c_per_min in 1.0..40.0_f64,
        ) {
            // A hot-air gun after two minutes, then an oven door, with a reading held for a time.
            let mut noise = Noise::new(seed);
            let rows = (600.0 / interval_s) as usize;
            let mut held = (f64::NEG_INFINITY, 0.0);
            let log = Made::new(rows, interval_s, |share| {
                let time_s = 600.0 * share;
                let hot_c = 20.0 + (rate_c_per_min / 60.0 * (time_s - 120.0)).clamp(0.0, 70.0);
                let open_s = (time_s - 400.0).max(0.0);
                let cooled_c = (hot_c - 20.0) * (1.0 - (-open_s / time_constant_s).exp());
                if time_s - held.0 >= held_s {
                    held = (time_s, rounded(hot_c - cooled_c + sigma_c * noise.next(), step_c));
                }
                held.1
            });
            prop_assert_eq!(found(&log), []);
        }
    }

    #[test]
    fn a_bare_probe_in_a_draught_is_no_jump() {
        for time_constant_s in [15.0, 20.0, 30.0] {
            for opened_s in [2000.0, 2003.0, 2009.0] {
                let open_c =
                    |time_s: f64| 70.0 * (-(time_s - opened_s).max(0.0) / time_constant_s).exp();
                let log = Made::new(400, 10.0, |share| open_c(4000.0 * share));
                assert_eq!(found(&log), []);
            }
        }
    }

    #[test]
    fn a_power_cycle_is_no_jump() {
        for gap_s in [6.0, 30.0, 3600.0] {
            let mut log = chamber(0.2, 0.02, (-10.0, 50.0), 1);
            let middle = log.time_s.len() / 2 + 100;
            log.time_s[middle..].iter_mut().for_each(|t| *t += gap_s);
            log.temp_c[middle..].iter_mut().for_each(|t| *t -= 40.0);
            assert_eq!(found(&log), []);
        }
    }

    #[test]
    fn a_sensor_may_be_open_for_a_time() {
        let log = chamber(0.2, 0.02, (-10.0, 50.0), 1);
        let rows = log.temp_c.len();
        let to = |end, read_c| {
            changed(log.clone(), |row, t| match (9000..end).contains(&row) {
                true => read_c,
                false => t,
            })
        };
        assert_eq!(found(&to(9900, 199.0)), []);
        assert_eq!(found(&to(9900, -99.0)), []);
        // The core does not leave out what a sensor can read, and an open sensor is named.
        assert_eq!(found(&to(9900, 85.0))[0].rows, 2);
        assert_eq!(found(&to(rows, 199.0))[0].rows, 1);
    }

    #[test]
    fn the_first_readings_may_be_garbage() {
        for rows in [1, 3, 20] {
            let log = chamber(0.2, 0.02, (-10.0, 50.0), 1);
            let log = changed(log, |row, t| if row < rows { 36.53 } else { t });
            assert_eq!(found(&log), []);
        }
    }
}
