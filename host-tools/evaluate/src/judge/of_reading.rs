//! What a person must judge of how a log was read, of one that was fitted or of one that is
//! evaluated.

use tempco_log::{Doubt, DoubtKind};
use tempco_set::{Warning, WarningCode};

/// Warnings of the doubts about the log `file`.
pub(super) fn warnings(file: &str, doubts: &[Doubt]) -> impl Iterator<Item = Warning> {
    doubts.iter().map(move |doubt| {
        let code = match doubt.kind {
            DoubtKind::OwnCorrection => WarningCode::OwnCorrection,
            DoubtKind::TimeRestarts => WarningCode::TimeRestarts,
            DoubtKind::LongBursts => WarningCode::LongBursts,
        };
        Warning::new(code, format!("{file}: {}", doubt.detail))
    })
}
