//! The kinds of units, the logs they are calibrated with and the missions they are judged on.

use anyhow::Result;
use tempco_twin::{Profile, Unit};

use crate::run::Run;

/// Seeds of noise that one unit may use.
const NOISE_SEEDS: u64 = 100;

/// What a log is for. No two logs of a unit have the same noise.
#[derive(Clone, Copy)]
pub(crate) enum Purpose {
    /// The calibration, from 0 on.
    Training(u64),
    /// What a run of a verification is like.
    Verification,
    /// Ramps at random, with many minor loops.
    Wandering,
    /// Power-on in the middle of a ramp.
    Start,
}

impl Purpose {
    /// The seed of its noise.
    const fn noise_seed(self, unit_seed: u64) -> u64 {
        let number = match self {
            Self::Verification => 0,
            Self::Wandering => 1,
            Self::Start => 2,
            Self::Training(number) => 10 + number,
        };
        NOISE_SEEDS * unit_seed + number
    }
}

/// A unit of a kind.
pub(crate) struct Specimen {
    /// Which of its kind; also what its noise begins from.
    pub(crate) seed: u64,
    /// What it is.
    pub(crate) unit: Unit,
}

impl Specimen {
    /// The unit of a seed.
    ///
    /// # Errors
    /// An unknown kind.
    pub(crate) fn new(kind: &str, seed: u64) -> Result<Self> {
        let unit = Unit::drawn(kind, seed)?;
        Ok(Self { seed, unit })
    }

    /// Runs through the profiles of a calibration, named in `profiles` and joined by `+`: a log each.
    ///
    /// # Errors
    /// An unknown profile.
    pub(crate) fn training(&self, profiles: &str) -> Result<Vec<Run>> {
        let profiles = profiles.split('+').zip(0..);
        let runs = profiles
            .map(|(name, number)| self.run(&Profile::named(name)?, Purpose::Training(number)));
        runs.collect()
    }

    /// A run that is not fitted.
    ///
    /// # Errors
    /// A profile that cannot be.
    pub(crate) fn mission(&self, purpose: Purpose) -> Result<Run> {
        let profile = match purpose {
            Purpose::Training(_) => Profile::named("calibration")?,
            Purpose::Verification => Profile::named("verification")?,
            Purpose::Wandering => Profile::wandering(self.seed),
            Purpose::Start => Profile::named("mid_ramp_start")?,
        };
        self.run(&profile, purpose)
    }

    fn run(&self, profile: &Profile, purpose: Purpose) -> Result<Run> {
        Ok(Run::simulate(
            &self.unit,
            profile,
            purpose.noise_seed(self.seed),
        )?)
    }
}
