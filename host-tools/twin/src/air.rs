//! The air of the chamber as steps make it.

use crate::check::{Invalid, element};
use crate::legs::{Course, Leg, Legs};
use crate::step::Step;

/// Longest profile, s (10 000 h).
pub const MAX_DURATION_S: f64 = 3.6e7;

/// Most stretches a profile may have, cycles written out.
const MAX_LEGS: usize = 100_000;

/// Temperature of the air over a time that begins at 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Air {
    /// One stretch for each stretch that takes time, then one that never ends.
    pub(crate) legs: Vec<Leg>,
    pub(crate) duration_s: f64,
    /// Temperature at the end and after it, degC.
    pub(crate) end_c: f64,
}

impl Air {
    /// Air that begins at `start_c` and goes through `steps`, the value of the key `list`.
    pub(crate) fn new(start_c: f64, steps: &[Step], list: &str) -> Result<Self, Invalid> {
        let mut course = Legs::starting_at(start_c);
        for (index, step) in steps.iter().enumerate() {
            let place = element(list, index);
            step.append(&mut course)
                .map_err(|error| error.inside(&place))?;
            if course.time_s > MAX_DURATION_S || course.legs.len() > MAX_LEGS {
                let found = format!("the end of {:.0} h", course.time_s / 3600.0);
                return Err(Invalid::new(place, found, "10000 h in all at most"));
            }
        }
        course.legs.push(Leg {
            start_s: course.time_s,
            end_s: f64::INFINITY,
            course: Course::constant(course.air_c),
        });
        Ok(Self {
            legs: course.legs,
            duration_s: course.time_s,
            end_c: course.air_c,
        })
    }

    /// Air temperature, degC, at a time of 0 or later.
    pub(crate) fn at(&self, time_s: f64) -> f64 {
        // After the end the last stretch holds one temperature, so that its first moment will do.
        let time_s = time_s.min(self.duration_s);
        let passed = self.legs.partition_point(|leg| leg.end_s <= time_s);
        self.legs[passed].air_c(time_s)
    }
}
