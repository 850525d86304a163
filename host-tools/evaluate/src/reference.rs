//! What a compensation is compared with, beside none.

use tempco_log::Log;
use tempco_set::CoefficientSet;
use tempco_set::run::{ApplyError, apply};

use crate::means::Means;

/// Bias stability of the reference: by axis and averaging time.
pub(super) struct Reference {
    /// What it is.
    pub(super) name: String,
    taus_s: Vec<f64>,
    axes: Vec<(String, Vec<f64>)>,
}

impl Reference {
    /// Applies `against`, or else the static part of `set`.
    pub(super) fn new(
        set: &CoefficientSet,
        log: &Log,
        against: Option<&CoefficientSet>,
        taus_s: &[f64],
    ) -> Result<Self, ApplyError> {
        let mut reference = Self {
            name: match against {
                Some(other) => format!(
                    "the set of unit {} with table CRC {}",
                    other.serial, other.table_crc32
                ),
                None => "the static part of the set".to_owned(),
            },
            taus_s: taus_s.to_vec(),
            axes: Vec::new(),
        };
        let part;
        let other = match against {
            Some(other) => other,
            None => match set.static_part() {
                Some(static_part) => {
                    part = static_part;
                    &part
                }
                None => {
                    reference.name = "none: the set makes no use of the rate".to_owned();
                    return Ok(reference);
                }
            },
        };
        let applied = apply(other, log)?;
        for ((_, axis), output) in other.axes().zip(&applied.axes) {
            let sigmas = taus_s
                .iter()
                .map(|&tau_s| Means::of_f32(log, &output.compensated, tau_s).sigma())
                .collect();
            reference.axes.push((axis.name.clone(), sigmas));
        }
        Ok(reference)
    }

    /// Bias stability of an axis with the reference, if there is one for it.
    pub(super) fn sigma(&self, axis: &str, tau_s: f64) -> Option<f64> {
        let (_, sigmas) = self.axes.iter().find(|(name, _)| name == axis)?;
        let place = self.taus_s.iter().position(|&other| other == tau_s)?;
        Some(sigmas[place])
    }
}
