//! How the judgement on a set is said.

use anyhow::Result;
use serde::Serialize;
use tempco_set::Judgement;

use crate::output::{print, print_json, say};

/// Prints `of`, an object, and the judgement as one JSON object.
pub(crate) fn print_as_json(of: impl Serialize, judgement: &Judgement) -> Result<()> {
    #[derive(Serialize)]
    struct Judged<'a, T> {
        #[serde(flatten)]
        of: T,
        #[serde(flatten)]
        judgement: &'a Judgement,
    }
    print_json(&Judged { of, judgement })
}

/// Prints the verdict with its reasons.
pub(crate) fn show(judgement: &Judgement) -> Result<()> {
    let verified = if judgement.verified {
        "verified on a log that the set was not fitted to"
    } else {
        "not verified on a log that the set was not fitted to"
    };
    let verdict = judgement.verdict().name().replace('_', " ");
    print(format_args!("\nverdict: {verdict}, {verified}"))?;
    for warning in &judgement.warnings {
        let (code, message) = (warning.code.name(), &warning.message);
        print(format_args!("warning {code}: {message}"))?;
    }
    Ok(())
}

/// Says on standard error why a set is rejected, so that it is seen wherever the output goes.
pub(crate) fn say_rejections(subject: impl std::fmt::Display, judgement: &Judgement) {
    for rejection in &judgement.rejections {
        let (code, message) = (rejection.code.name(), &rejection.message);
        say!("{subject} rejected, {code}: {message}");
    }
}
