//! The chamber profiles that have a name.

use crate::chamber::Profile;
use crate::error::UnknownName;
use crate::file;
use crate::step::Step;
use crate::wander::Wander;

/// Names that [`Profile::named`] accepts.
pub const PROFILES: &[&str] = &[
    "calibration",
    "verification",
    "static",
    "short",
    "cycles",
    "swing",
    "cold_start",
    "rest",
    "faults",
    "wandering",
    "minor_loops",
    "one_rate",
    "mid_ramp_start",
];

const FILES: [&str; 13] = [
    include_str!("../profiles/calibration.toml"),
    include_str!("../profiles/verification.toml"),
    include_str!("../profiles/static.toml"),
    include_str!("../profiles/short.toml"),
    include_str!("../profiles/cycles.toml"),
    include_str!("../profiles/swing.toml"),
    include_str!("../profiles/cold_start.toml"),
    include_str!("../profiles/rest.toml"),
    include_str!("../profiles/faults.toml"),
    include_str!("../profiles/wandering.toml"),
    include_str!("../profiles/minor_loops.toml"),
    include_str!("../profiles/one_rate.toml"),
    include_str!("../profiles/mid_ramp_start.toml"),
];

impl Profile {
    /// The TOML text of a name in [`PROFILES`].
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn source(name: &str) -> Result<&'static str, UnknownName> {
        let known = PROFILES.iter().position(|known| *known == name);
        known.map(|index| FILES[index]).ok_or_else(|| UnknownName {
            kind: "profile",
            name: name.to_owned(),
            known: PROFILES,
        })
    }

    /// The profile of a name in [`PROFILES`].
    ///
    /// | name | air temperature | rates, degC/min | duration |
    /// | --- | --- | --- | --- |
    /// | `calibration` | -15 to 80 degC, soaks at 11 points, start at 25 degC | 0.25, 0.5, 1, 2 | 20.2 h |
    /// | `verification` | -12 to 77 degC, soaks at 11 other points, start at 20 degC | 0.4, 0.7, 1.5 | 15.3 h |
    /// | `static` | -15 to 80 degC upwards, one hour at each of 11 points | 0.2 | 18.9 h |
    /// | `short` | 5 to 45 degC | 1, 2 | 1.5 h |
    /// | `cycles` | cycles between -10 and 70 degC | 0.5, 1, 3 | 16.2 h |
    /// | `swing` | sine waves about 30 degC | up to 3.1 | 9 h |
    /// | `cold_start` | power on at -20 degC, then to 20 degC | 1 | 3 h |
    /// | `rest` | 25 degC | 0 | 2 h |
    /// | `faults` | 10 to 50 degC, with faults and motion | 0.5, 1 | 4 h |
    /// | `wandering` | -12 to 77 degC, ramps at random with many minor loops | 0.2 to 2.5 | 12 h |
    /// | `minor_loops` | loops of 10 to 30 degC about 5 temperatures, -15 to 80 degC, start at 25 degC | 0.3 to 2 | 15.7 h |
    /// | `one_rate` | as `calibration` | 1 | 14.7 h |
    /// | `mid_ramp_start` | power on at 15 degC in a ramp from -15 to 55 degC, then to 0 and 25 degC | 0.7, 1, 1.5 | 3.1 h |
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn named(name: &str) -> Result<Self, UnknownName> {
        let profile = file::profile(name, Self::source(name)?);
        Ok(profile.expect("the profiles of this crate are valid"))
    }

    /// The profile `wandering` with another seed of its course, named after the seed.
    pub fn wandering(seed: u64) -> Self {
        let named = Self::named("wandering").expect("`wandering` is a named profile");
        let mut parts = named.parts().clone();
        for step in &mut parts.step {
            if let Step::Random(wander) = step {
                *wander = Wander { seed, ..*wander };
            }
        }
        let profile = Self::from_parts(&format!("wandering-{seed}"), parts);
        profile.expect("every seed gives a valid profile")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::legs::{Course, Leg};

    fn named(name: &str) -> Profile {
        Profile::named(name).unwrap()
    }

    fn duration_h(name: &str) -> f64 {
        named(name).duration_s() / 3600.0
    }

    fn soaks_c(name: &str) -> Vec<f64> {
        let mut soaks: Vec<f64> = named(name)
            .steps()
            .iter()
            .filter_map(|step| match step {
                Step::Soak { air_c, .. } => Some(*air_c),
                _ => None,
            })
            .collect();
        soaks.sort_by(f64::total_cmp);
        soaks.dedup();
        soaks
    }

    fn rates(name: &str) -> Vec<f64> {
        let mut rates: Vec<f64> = named(name)
            .steps()
            .iter()
            .filter_map(|step| match step {
                Step::Ramp { rate_c_per_min, .. } => Some(*rate_c_per_min),
                _ => None,
            })
            .collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        rates
    }

    /// Lowest and highest air temperature, looked at every 10 s and where stretches begin.
    fn range_c(name: &str) -> (f64, f64) {
        let profile = named(name);
        let samples = (profile.duration_s() / 10.0) as u32;
        let even_s = (0..=samples).map(|i| 10.0 * f64::from(i));
        let begins_s = profile.air().legs.iter().map(|leg| leg.start_s);
        even_s
            .chain(begins_s)
            .map(|time_s| profile.air_c(time_s))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), air_c| {
                (low.min(air_c), high.max(air_c))
            })
    }

    #[test]
    fn every_listed_name_exists_and_no_other() {
        for name in PROFILES {
            assert_eq!(named(name).name(), *name);
            assert!(!named(name).parts().description.is_empty(), "{name}");
        }
        let error = Profile::named("calibartion").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown profile `calibartion`, expected one of: calibration, verification, static, short, \
             cycles, swing, cold_start, rest, faults, wandering, minor_loops, one_rate, mid_ramp_start"
        );
    }

    #[test]
    fn durations_are_as_documented() {
        for (name, hours) in [
            ("calibration", 20.2),
            ("verification", 15.3),
            ("static", 18.9),
            ("short", 1.5),
            ("cycles", 16.2),
            ("swing", 9.0),
            ("cold_start", 3.0),
            ("rest", 2.0),
            ("faults", 4.0),
            ("wandering", 12.0),
            ("minor_loops", 15.65),
            ("one_rate", 14.7),
            ("mid_ramp_start", 3.1),
        ] {
            let actual = duration_h(name);
            assert!((actual - hours).abs() < 0.05, "{name}: {actual} h");
        }
    }

    #[test]
    fn ranges_are_as_documented() {
        for (name, low_c, high_c) in [
            ("calibration", -15.0, 80.0),
            ("verification", -12.0, 77.0),
            ("static", -15.0, 80.0),
            ("short", 5.0, 45.0),
            ("cycles", -10.0, 70.0),
            ("swing", -5.0, 65.0),
            ("cold_start", -20.0, 20.0),
            ("rest", 25.0, 25.0),
            ("faults", 10.0, 50.0),
            ("minor_loops", -15.0, 80.0),
            ("one_rate", -15.0, 80.0),
            ("mid_ramp_start", 0.0, 55.0),
        ] {
            let (low, high) = range_c(name);
            assert!((low - low_c).abs() < 1e-9, "{name}: {low} degC");
            assert!((high - high_c).abs() < 1e-9, "{name}: {high} degC");
        }
    }

    #[test]
    fn every_seed_wanders_on_a_course_of_its_own() {
        for seed in 0..30 {
            let profile = Profile::wandering(seed);
            assert!(
                (profile.duration_s() / 3600.0 - 12.0).abs() < 0.05,
                "{seed}"
            );
            assert_eq!(profile, Profile::wandering(seed));
            assert_ne!(profile.air(), Profile::wandering(seed + 1).air());
        }
        assert_eq!(Profile::wandering(1).parts(), named("wandering").parts());
    }

    #[test]
    fn soaks_and_rates_are_as_documented() {
        assert_eq!(rates("calibration"), [0.25, 0.5, 1.0, 2.0]);
        assert_eq!(rates("verification"), [0.4, 0.7, 1.5]);
        assert_eq!(rates("static"), [0.2]);
        assert_eq!(soaks_c("calibration").len(), 11);
        assert_eq!(soaks_c("verification").len(), 11);
        assert_eq!(soaks_c("static").len(), 11);
        assert_eq!(rates("one_rate"), [1.0]);
        assert_eq!(soaks_c("one_rate"), soaks_c("calibration"));
    }

    #[test]
    fn verification_shares_no_soak_and_no_rate_with_calibration() {
        for soak_c in soaks_c("verification") {
            assert!(!soaks_c("calibration").contains(&soak_c), "{soak_c} degC");
        }
        for rate in rates("verification") {
            assert!(!rates("calibration").contains(&rate), "{rate} degC/min");
        }
    }

    /// Turning points of the air, degC, and the slopes before and after, degC/min.
    fn turns(name: &str) -> Vec<(f64, f64, f64)> {
        let slope = |leg: &Leg| match leg.course {
            Course::Line { slope_c_per_s, .. } => 60.0 * slope_c_per_s,
            Course::Sine { .. } => 0.0,
        };
        let turn = |pair: &[Leg]| {
            let [before, after] = [&pair[0], &pair[1]];
            (after.air_c(after.start_s), slope(before), slope(after))
        };
        let profile = named(name);
        let turns = profile.air().legs.windows(2).map(turn);
        let turned = |turn: &(f64, f64, f64)| turn.1 * turn.2 < 0.0;
        turns.filter(turned).collect()
    }

    #[test]
    fn minor_loops_turn_without_a_soak_over_the_whole_range() {
        assert!(turns("calibration").is_empty());
        let turns = turns("minor_loops");
        assert!(turns.len() >= 20, "{turns:?}");
        for low_c in [-20.0, 5.0, 30.0, 55.0] {
            let within = |turn: &&(f64, f64, f64)| (low_c..=low_c + 25.0).contains(&turn.0);
            assert!(turns.iter().filter(within).count() >= 4, "{low_c} degC");
        }
        let spans = turns.windows(2).map(|pair| (pair[0].0 - pair[1].0).abs());
        assert!(spans.filter(|span| (9.9..30.1).contains(span)).count() >= 15);
        for downwards in [false, true] {
            let after = turns.iter().map(|turn| turn.2);
            let mut rates: Vec<f64> = after.filter(|rate| (*rate < 0.0) == downwards).collect();
            rates.sort_by(f64::total_cmp);
            rates.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
            assert!(rates.len() >= 3, "{rates:?}");
        }
    }

    #[test]
    fn calibration_passes_every_temperature_at_several_rates_both_ways() {
        let profile = named("calibration");
        for temperature_c in [-10.0, 8.0, 20.0, 33.0, 48.0, 55.0, 72.0] {
            let mut slopes: Vec<f64> = profile
                .air()
                .legs
                .iter()
                .filter_map(|leg| {
                    let Course::Line { slope_c_per_s, .. } = leg.course else {
                        return None;
                    };
                    let (from, to) = (leg.air_c(leg.start_s), leg.air_c(leg.end_s));
                    let passes = from.min(to) <= temperature_c && temperature_c <= from.max(to);
                    (slope_c_per_s != 0.0 && passes).then_some(slope_c_per_s)
                })
                .collect();
            slopes.sort_by(f64::total_cmp);
            slopes.dedup();
            assert!(slopes.len() >= 4, "{temperature_c} degC: {slopes:?}");
            assert!(slopes[0] < 0.0 && slopes[slopes.len() - 1] > 0.0);
        }
    }
}
