//! Rows that were left out on reading, of fitted logs and of an evaluated one.

use tempco_log::SkippedRows;
use tempco_set::{Rejection, RejectionCode};

/// Share of bad rows beyond which a log is not what it should be.
const MANY_BAD: f64 = 0.05;

/// Rejects a log of which too many rows were left out; `kept` are the others.
pub(super) fn rejection(file: &str, kept: usize, skipped: SkippedRows) -> Option<Rejection> {
    let share = skipped.share(kept);
    let found = || {
        format!(
            "{:.1} % of the rows of {file} were left out as bad: {skipped}",
            100.0 * share
        )
    };
    (share > MANY_BAD).then(|| Rejection::new(RejectionCode::TooManyBadRows, found()))
}
