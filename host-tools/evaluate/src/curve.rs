//! Allan deviations of an axis, before and after.

use serde::Serialize;
use tempco_log::{AxisUnit, Log};
use tempco_set::run::AxisOutput;

use crate::allan::{
    AllanPoint, BiasInstability, RandomWalk, bias_instability, longest_stretch, overlapping,
    random_walk,
};
use crate::measured::Measured;

/// Allan deviations of an axis over the longest stretch of its log without a gap.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AllanOfAxis {
    /// Rows of the stretch.
    pub rows: usize,
    /// Mean interval of its rows \[s\].
    pub interval_s: f64,
    /// Unit of the random walks.
    pub random_walk_unit: &'static str,
    /// Without compensation.
    pub raw: AllanCurves,
    /// With compensation.
    pub compensated: AllanCurves,
}

/// A curve and what is read from it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AllanCurves {
    /// Overlapping Allan deviation at octaves of the interval \[unit of the axis\].
    pub deviations: Vec<AllanPoint>,
    /// Angle random walk of a gyro, velocity random walk of an accelerometer.
    pub angle_random_walk: Measured<RandomWalk>,
    /// Bias instability \[unit of the axis\].
    pub bias_instability: Measured<BiasInstability>,
}

impl AllanOfAxis {
    pub(super) fn new(log: &Log, output: &AxisOutput, unit: AxisUnit) -> Self {
        let stretch = longest_stretch(&log.time_s, log.interval_s);
        let rows = stretch.len();
        let interval_s = match rows {
            0 | 1 => log.interval_s,
            _ => {
                let duration_s = log.time_s[stretch.end - 1] - log.time_s[stretch.start];
                duration_s / (rows - 1) as f64
            }
        };
        let (random_walk_unit, factor) = unit.random_walk();
        let curve = |values: &[f32]| {
            let values = values[stretch.clone()].iter().map(|&v| f64::from(v));
            AllanCurves::new(overlapping(values, interval_s), factor)
        };
        Self {
            rows,
            interval_s,
            random_walk_unit,
            raw: curve(&output.raw),
            compensated: curve(&output.compensated),
        }
    }
}

impl AllanCurves {
    fn new(deviations: Vec<AllanPoint>, random_walk_factor: f64) -> Self {
        let walk = random_walk(&deviations).map(|walk| RandomWalk {
            value: walk.value * random_walk_factor,
            ..walk
        });
        Self {
            angle_random_walk: Measured::or(walk, || "no three octaves of slope -1/2".to_owned()),
            bias_instability: Measured::or(bias_instability(&deviations), || {
                "the stretch without a gap is too short".to_owned()
            }),
            deviations,
        }
    }
}
