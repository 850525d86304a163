//! What a fit says of its unit.

use crate::Fit;

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
    /// Why the set is not acceptable; empty if it is.
    pub objections: Vec<String>,
    /// Remarks of the fit.
    pub remarks: Vec<String>,
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
    /// Collects the figures of a fit and judges it.
    pub fn new(fit: &Fit) -> Self {
        let mut axes = Vec::new();
        let mut objections = Vec::new();
        for channel in &fit.set.channels {
            for (number, axis) in channel.axes.iter().enumerate() {
                if channel.mismatch_alarm(number) {
                    objections.push(format!("axis {}: segments disagree", axis.name));
                }
                let Some(statistics) = axis.statistics else {
                    continue;
                };
                if statistics.rmse_compensated >= statistics.rmse_raw {
                    objections.push(format!(
                        "axis {}: compensation is no better than none",
                        axis.name
                    ));
                }
                axes.push(AxisFigures {
                    axis: axis.name.clone(),
                    unit: axis.unit.name(),
                    n: statistics.n,
                    sigma_before: statistics.sigma_raw,
                    sigma_after: statistics.sigma_compensated,
                });
            }
        }
        let inputs = &fit.set.provenance.inputs;
        Self {
            rows: inputs.iter().map(|input| input.rows).sum(),
            axes,
            objections,
            remarks: fit.remarks.clone(),
        }
    }
}
