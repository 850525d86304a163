//! Re-zero: starts it, and waits for what becomes of it.

use std::thread;
use std::time::Duration;

use tempco_link::{Axes, Fault, Request};

use crate::{Error, Unit};

/// Time between two questions.
const PAUSE: Duration = Duration::from_millis(100);

/// The unit's time from the end of the averaging to its outcome, at most \[s\].
const OUTCOME_S: f64 = 2.0;

/// What became of a re-zero.
#[derive(Clone, Debug, PartialEq)]
pub enum ReZeroed {
    /// The unit takes out other constant biases now.
    Done {
        /// Constant biases before \[unit of the axis\].
        before: Axes,
        /// Constant biases now \[unit of the axis\].
        after: Axes,
    },
    /// The unit was not valid and at rest all the time: its constant biases are what they were.
    GivenUp {
        /// Why, as in the fault log.
        detail: u32,
    },
}

/// Lets a unit at rest find its constant biases, and waits for the outcome. `progress` gets the time
/// since the beginning by the unit's clock \[s\].
///
/// # Errors
/// The unit refuses, it was reset meanwhile, its flash failed, and what a session can meet.
pub fn re_zero(
    unit: &mut Unit,
    averaging_s: u16,
    expected: Axes,
    mut progress: impl FnMut(f64),
) -> Result<ReZeroed, Error> {
    let start = unit.telemetry(0)?;
    unit.command(&Request::ReZero {
        averaging_s,
        expected,
    })?;
    loop {
        thread::sleep(PAUSE);
        let now = unit.telemetry(0)?;
        if now.uptime_ms < start.uptime_ms {
            return Err(Error::Reset);
        }
        if now.faults.contains(Fault::ReZero) {
            let faults = unit.faults()?;
            let entry = faults
                .iter()
                .find(|entry| entry.code == Fault::ReZero.code());
            return Ok(ReZeroed::GivenUp {
                detail: entry.map_or(0, |entry| entry.detail),
            });
        }
        let passed_s = f64::from(now.uptime_ms - start.uptime_ms) / 1000.0;
        progress(passed_s);
        if passed_s < f64::from(averaging_s) {
            continue;
        }
        if now.offset != start.offset || passed_s > f64::from(averaging_s) + OUTCOME_S {
            if now.faults.contains(Fault::Flash) {
                return Err(Error::Flash);
            }
            return Ok(ReZeroed::Done {
                before: start.offset,
                after: now.offset,
            });
        }
    }
}
