//! The one judge of sets.
//!
//! ```text
//! set: fitted logs, table, segments ---+
//! evaluation, or else last sign-off ---+-> Judgement
//! ```
//!
//! What a set holds of its fit is judged wherever it is shown, so that the same set gets the same
//! verdict from every command.

mod merit;
mod of_log;
mod of_set;

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
        judgement.rejections.extend(rejections);
        judgement.warnings.extend(of_log::warnings(evaluation));
    }
    judgement.verified = is_verified;
    judgement
}
