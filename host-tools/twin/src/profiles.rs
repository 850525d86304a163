//! The chamber programmes that have a name.

use crate::chamber::{Profile, Step};
use crate::error::UnknownName;

/// Names that [`Profile::named`] accepts.
pub const PROFILES: &[&str] = &[CALIBRATION.name, VERIFICATION.name, STATIC.name, SHORT.name];

/// A programme as written down here.
struct Programme {
    name: &'static str,
    start_c: f64,
    steps: &'static [Step],
}

const fn soak(air_c: f64, duration_min: f64) -> Step {
    Step::Soak {
        air_c,
        duration_min,
    }
}

const fn ramp(to_c: f64, rate_c_per_min: f64) -> Step {
    Step::Ramp {
        to_c,
        rate_c_per_min,
    }
}

/// Every temperature between -15 and 80 degC is passed upwards at 1 and 2 degC/min and downwards
/// at 0.25 and 0.5: no segment of a model is left with a single rate, for which the rate
/// terms cannot be told from the static ones.
const CALIBRATION: Programme = Programme {
    name: "calibration",
    start_c: 25.0,
    steps: &[
        soak(25.0, 30.0),
        ramp(-15.0, 1.0),
        soak(-15.0, 40.0),
        ramp(0.0, 1.0),
        soak(0.0, 35.0),
        ramp(15.0, 1.0),
        soak(15.0, 35.0),
        ramp(30.0, 1.0),
        soak(30.0, 35.0),
        ramp(45.0, 1.0),
        soak(45.0, 35.0),
        ramp(60.0, 1.0),
        soak(60.0, 35.0),
        ramp(80.0, 1.0),
        soak(80.0, 35.0),
        ramp(-15.0, 0.25),
        soak(-15.0, 40.0),
        ramp(80.0, 2.0),
        soak(80.0, 40.0),
        ramp(65.0, 0.5),
        soak(65.0, 20.0),
        ramp(35.0, 0.5),
        soak(35.0, 20.0),
        ramp(5.0, 0.5),
        soak(5.0, 20.0),
        ramp(-15.0, 0.5),
        soak(-15.0, 40.0),
    ],
};

/// Shares no soak temperature and no rate with [`CALIBRATION`], and stays inside its range, so
/// that it judges a calibration on conditions which that calibration has not seen.
const VERIFICATION: Programme = Programme {
    name: "verification",
    start_c: 20.0,
    steps: &[
        soak(20.0, 30.0),
        ramp(-12.0, 0.7),
        soak(-12.0, 40.0),
        ramp(3.0, 1.5),
        soak(3.0, 30.0),
        ramp(22.0, 1.5),
        soak(22.0, 30.0),
        ramp(38.0, 1.5),
        soak(38.0, 30.0),
        ramp(52.0, 1.5),
        soak(52.0, 30.0),
        ramp(67.0, 1.5),
        soak(67.0, 30.0),
        ramp(77.0, 1.5),
        soak(77.0, 40.0),
        ramp(58.0, 0.7),
        soak(58.0, 25.0),
        ramp(31.0, 0.7),
        soak(31.0, 25.0),
        ramp(8.0, 0.7),
        soak(8.0, 25.0),
        ramp(-12.0, 0.7),
        soak(-12.0, 40.0),
        ramp(77.0, 0.4),
        soak(77.0, 30.0),
        ramp(20.0, 1.5),
        soak(20.0, 20.0),
    ],
};

/// Changes at 0.2 degC/min keep the rate-dependent part of the bias small, and an hour at each
/// temperature outweighs the changes.
const STATIC: Programme = Programme {
    name: "static",
    start_c: -15.0,
    steps: &[
        soak(-15.0, 60.0),
        ramp(-5.0, 0.2),
        soak(-5.0, 60.0),
        ramp(5.0, 0.2),
        soak(5.0, 60.0),
        ramp(15.0, 0.2),
        soak(15.0, 60.0),
        ramp(25.0, 0.2),
        soak(25.0, 60.0),
        ramp(35.0, 0.2),
        soak(35.0, 60.0),
        ramp(45.0, 0.2),
        soak(45.0, 60.0),
        ramp(55.0, 0.2),
        soak(55.0, 60.0),
        ramp(65.0, 0.2),
        soak(65.0, 60.0),
        ramp(75.0, 0.2),
        soak(75.0, 60.0),
        ramp(80.0, 0.2),
        soak(80.0, 60.0),
    ],
};

const SHORT: Programme = Programme {
    name: "short",
    start_c: 25.0,
    steps: &[
        soak(25.0, 10.0),
        ramp(45.0, 1.0),
        soak(45.0, 10.0),
        ramp(5.0, 2.0),
        soak(5.0, 10.0),
        ramp(25.0, 1.0),
    ],
};

impl Profile {
    /// The profile of a name in [`PROFILES`].
    ///
    /// | name | air temperature | rates, degC/min | duration |
    /// | --- | --- | --- | --- |
    /// | `calibration` | -15 to 80 degC, soaks at 11 points, start at 25 degC | 0.25, 0.5, 1, 2 | 20.2 h |
    /// | `verification` | -12 to 77 degC, soaks at 11 other points, start at 20 degC | 0.4, 0.7, 1.5 | 15.3 h |
    /// | `static` | -15 to 80 degC upwards, one hour at each of 11 points | 0.2 | 18.9 h |
    /// | `short` | 5 to 45 degC | 1, 2 | 1.5 h |
    ///
    /// # Errors
    ///
    /// [`UnknownName`] lists the names.
    pub fn named(name: &str) -> Result<Self, UnknownName> {
        let programme = [&CALIBRATION, &VERIFICATION, &STATIC, &SHORT]
            .into_iter()
            .find(|programme| programme.name == name)
            .ok_or_else(|| UnknownName {
                kind: "profile",
                name: name.to_owned(),
                known: PROFILES,
            })?;
        Ok(
            Self::new(programme.name, programme.start_c, programme.steps)
                .expect("the programmes of this file are valid"),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                Step::Ramp { .. } => None,
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
                Step::Soak { .. } => None,
            })
            .collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        rates
    }

    /// Lowest and highest air temperature, looked at every 10 s.
    fn range_c(name: &str) -> (f64, f64) {
        let profile = named(name);
        let samples = (profile.duration_s() / 10.0) as u32;
        (0..=samples)
            .map(|i| profile.air_c(10.0 * f64::from(i)))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), air_c| {
                (low.min(air_c), high.max(air_c))
            })
    }

    #[test]
    fn every_listed_name_exists_and_no_other() {
        for name in PROFILES {
            assert_eq!(named(name).name(), *name);
        }
        let error = Profile::named("calibartion").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown profile `calibartion`, expected one of: calibration, verification, static, short"
        );
    }

    #[test]
    fn durations_are_as_documented() {
        for (name, hours) in [
            ("calibration", 20.2),
            ("verification", 15.3),
            ("static", 18.9),
            ("short", 1.5),
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
        ] {
            let (low, high) = range_c(name);
            assert!((low - low_c).abs() < 1e-9, "{name}: {low} degC");
            assert!((high - high_c).abs() < 1e-9, "{name}: {high} degC");
        }
    }

    #[test]
    fn soaks_and_rates_are_as_documented() {
        assert_eq!(rates("calibration"), [0.25, 0.5, 1.0, 2.0]);
        assert_eq!(rates("verification"), [0.4, 0.7, 1.5]);
        assert_eq!(rates("static"), [0.2]);
        assert_eq!(soaks_c("calibration").len(), 11);
        assert_eq!(soaks_c("verification").len(), 11);
        assert_eq!(soaks_c("static").len(), 11);
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

    #[test]
    fn calibration_passes_every_temperature_at_several_rates_both_ways() {
        let profile = named("calibration");
        for temperature_c in [-10.0, 8.0, 20.0, 33.0, 48.0, 55.0, 72.0] {
            let mut slopes: Vec<f64> = profile
                .legs()
                .iter()
                .filter(|leg| leg.slope_c_per_s != 0.0)
                .filter(|leg| {
                    let (from, to) = (leg.start_c, leg.air_c(leg.end_s));
                    from.min(to) <= temperature_c && temperature_c <= from.max(to)
                })
                .map(|leg| leg.slope_c_per_s)
                .collect();
            slopes.sort_by(f64::total_cmp);
            slopes.dedup();
            assert!(slopes.len() >= 4, "{temperature_c} degC: {slopes:?}");
            assert!(slopes[0] < 0.0 && slopes[slopes.len() - 1] > 0.0);
        }
    }
}
