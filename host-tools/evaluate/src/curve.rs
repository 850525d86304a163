//! Allan deviations of an axis, before and after.

use serde::Serialize;
use tempco_log::AxisUnit;

use crate::allan::{
    AllanPoint, BiasInstability, RandomWalk, Stretch, bias_instability, random_walk,
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
    /// Of a stretch with two series for each axis, without and with compensation.
    pub(super) fn new(stretch: &Stretch, axis: usize, unit: AxisUnit) -> Self {
        let (random_walk_unit, factor) = unit.random_walk();
        let curve = |series: usize| AllanCurves::new(stretch.curves[series].clone(), factor);
        Self {
            rows: stretch.rows,
            interval_s: stretch.interval_s,
            random_walk_unit,
            raw: curve(2 * axis),
            compensated: curve(2 * axis + 1),
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
