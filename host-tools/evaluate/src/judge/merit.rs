//! The figures by which compensation is compared with none.

use tempco_set::{Rejection, RejectionCode};

use crate::text::{figure, percent};

/// A figure of merit before and after compensation; the smaller the better.
#[derive(Clone, Copy)]
pub(super) struct Merit {
    pub(super) name: &'static str,
    pub(super) before: f64,
    pub(super) after: f64,
}

impl Merit {
    pub(super) const fn bias_stability(before: f64, after: f64) -> Self {
        let name = "bias stability";
        Self {
            name,
            before,
            after,
        }
    }

    pub(super) const fn rms_error(before: f64, after: f64) -> Self {
        let name = "RMS error";
        Self {
            name,
            before,
            after,
        }
    }
}

/// The first figure that compensation does not improve on `log` rejects. A figure that could not
/// be formed is no improvement.
pub(super) fn no_better_than_none(
    axis: &str,
    merits: impl IntoIterator<Item = Merit>,
    log: &str,
) -> Option<Rejection> {
    let is_better = |merit: &Merit| merit.after < merit.before;
    let Merit {
        name,
        before,
        after,
    } = merits.into_iter().find(|merit| !is_better(merit))?;
    Some(Rejection::of_axis(
        RejectionCode::NoBetterThanNone,
        axis,
        format_args!(
            "compensation does not help on {log}: {name} {} before, {} after ({})",
            figure(before),
            figure(after),
            percent(1.0 - after / before)
        ),
    ))
}
