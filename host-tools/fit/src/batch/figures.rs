//! The figures of a unit in a batch.

use tempco_set::{CoefficientSet, Judgement};

/// What became of a unit.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Serial number of the unit.
    pub serial: String,
    /// Number of its logs.
    pub logs: usize,
    /// Its figures, or why it has none.
    pub result: Result<UnitFigures, String>,
}

/// Figures of a unit whose set was written.
#[derive(Clone, Debug)]
pub struct UnitFigures {
    /// Rows of all its logs.
    pub rows: usize,
    /// The axes in the order of the set.
    pub axes: Vec<AxisFigures>,
    /// The judgement on the set.
    pub judgement: Judgement,
}

/// Figures of an axis on the fitted logs.
#[derive(Clone, Debug)]
pub struct AxisFigures {
    /// Name of the axis.
    pub axis: String,
    /// Its unit, as in the names of columns.
    pub unit: &'static str,
    /// Number of means.
    pub n: usize,
    /// Standard deviation of the means before compensation, in the unit of the axis; 0 where there
    /// are too few.
    pub sigma_before: f64,
    /// The same after compensation.
    pub sigma_after: f64,
}

impl UnitFigures {
    /// Collects the figures of a fitted set.
    pub fn new(set: &CoefficientSet, judgement: Judgement) -> Self {
        let axes = set.axes().filter_map(|(_, axis)| {
            let statistics = axis.statistics?;
            Some(AxisFigures {
                axis: axis.name.clone(),
                unit: axis.unit.name(),
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
}
