//! The one judge of sets.
//!
//! ```text
//! set: fitted logs, table, segments ---+
//! evaluation, or else last sign-off ---+-> Judgement
//! ```
//!
//! What a set holds of its fit is judged wherever it is shown, so that the same set gets the same
//! verdict from every command.

mod bad_rows;
mod merit;
mod of_log;
mod of_outliers;
mod of_reading;
mod of_remains;
mod of_set;
mod of_signals;

use tempco_set::{CoefficientSet, Judgement};

use crate::evaluation::{Evaluation, Role};

pub use of_log::sign_off;

/// Judges `set` by what it holds and by how it does on a log.
///
/// The last sign-off of the set counts as long as the log of `evaluation` is another one. A set is
/// verified if a log that it was not fitted to did not reject it.
pub fn judge(set: &CoefficientSet, evaluation: Option<&Evaluation>) -> Judgement {
    let mut judgement = Judgement::default();
    of_set::judge(set, &mut judgement);
    let again = |sha256: &str| evaluation.is_some_and(|of| of.log.sha256 == sha256);
    let sign_off = set.sign_offs.last().filter(|last| !again(&last.sha256));
    if let Some(sign_off) = sign_off {
        of_log::judge_sign_off(sign_off, &mut judgement);
    }
    let mut is_verified = sign_off.is_some_and(|last| last.accepted);
    if let Some(evaluation) = evaluation {
        let rejections = of_log::rejections(evaluation);
        let is_verification = evaluation.log.role == Role::Verification;
        is_verified =
            rejections.is_empty() && (is_verified || sign_off.is_none() && is_verification);
        // The log may be one that was fitted: what is said of it once is enough.
        let rejections = rejections.into_iter();
        let new = rejections.filter(|of| !judgement.rejections.contains(of));
        let new: Vec<_> = new.collect();
        judgement.rejections.extend(new);
        let warnings = of_log::warnings(evaluation).into_iter();
        let new = warnings.filter(|of| !judgement.warnings.contains(of));
        let new: Vec<_> = new.collect();
        judgement.warnings.extend(new);
    }
    judgement.verified = is_verified;
    judgement
}
