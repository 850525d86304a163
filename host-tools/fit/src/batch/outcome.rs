//! What became of a unit in a batch.

use tempco_log::AxisUnit;
use tempco_set::{CoefficientSet, Judgement, Verdict};

/// What became of a unit.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Serial number of the unit.
    pub serial: String,
    /// Number of its logs.
    pub logs: usize,
    /// Its results, or why it has none.
    pub result: Result<UnitResult, String>,
}

/// Results of a unit whose set was written.
#[derive(Clone, Debug)]
pub struct UnitResult {
    /// Rows of all its logs.
    pub rows: usize,
    /// The axes in the order of the set.
    pub axes: Vec<AxisResult>,
    /// The judgement on the set.
    pub judgement: Judgement,
}

/// Results of an axis on the fitted logs.
#[derive(Clone, Debug)]
pub struct AxisResult {
    /// Name of the axis.
    pub axis: String,
    /// Its unit.
    pub unit: AxisUnit,
    /// Number of means.
    pub n: usize,
    /// Standard deviation of the means before compensation, in the unit of the axis; 0 where there
    /// are too few.
    pub sigma_before: f64,
    /// The same after compensation.
    pub sigma_after: f64,
}

impl Outcome {
    /// The verdict on the set; `None` without a set.
    pub fn verdict(&self) -> Option<Verdict> {
        let result = self.result.as_ref().ok();
        result.map(|result| result.judgement.verdict())
    }
}

impl UnitResult {
    /// Collects the results of a fitted set.
    pub fn new(set: &CoefficientSet, judgement: Judgement) -> Self {
        let axes = set.axes().filter_map(|(_, axis)| {
            let statistics = axis.statistics?;
            Some(AxisResult {
                axis: axis.name.clone(),
                unit: axis.unit,
                n: statistics.n,
                sigma_before: statistics.sigma_raw,
                sigma_after: statistics.sigma_compensated,
            })
        });
        Self {
            rows: set.provenance.inputs.iter().map(|input| input.rows).sum(),
            axes: axes.collect(),
            judgement,
        }
    }

    /// Of the rejected axes, or of all if none is rejected, the axis that improves least.
    pub fn worst_axis(&self) -> Option<&AxisResult> {
        let rejections = &self.judgement.rejections;
        let is_rejected = |axis: &AxisResult| {
            let mut names = rejections.iter().filter_map(|of| of.axis.as_ref());
            names.any(|name| *name == axis.axis)
        };
        let order = |axis: &AxisResult| {
            let improvement = axis.improvement().unwrap_or(f64::INFINITY);
            (!is_rejected(axis), improvement)
        };
        self.axes.iter().min_by(|a, b| {
            let (a, b) = (order(a), order(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }
}

impl AxisResult {
    /// By which share the bias stability is better with compensation; `None` without means.
    pub fn improvement(&self) -> Option<f64> {
        let improvement = 1.0 - self.sigma_after / self.sigma_before;
        (self.n > 1 && improvement.is_finite()).then_some(improvement)
    }
}

/// Units for tests.
#[cfg(test)]
pub(super) mod example {
    use super::*;

    /// An accepted unit with axes of a name and a sigma after compensation; before, it is 1.
    pub(in crate::batch) fn unit(serial: &str, sigmas_after: &[(&str, f64)]) -> Outcome {
        let axis = |&(axis, sigma_after): &(&str, f64)| AxisResult {
            axis: axis.to_owned(),
            unit: AxisUnit::Dph,
            n: 50,
            sigma_before: 1.0,
            sigma_after,
        };
        Outcome {
            serial: serial.to_owned(),
            logs: 1,
            result: Ok(UnitResult {
                rows: 100,
                axes: sigmas_after.iter().map(axis).collect(),
                judgement: Judgement::default(),
            }),
        }
    }
}
