//! The units of a batch, compared.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use tempco_log::AxisUnit;
use tempco_set::Verdict;

use super::outcome::{AxisResult, Outcome};
use super::outlier::{OUTLIER_Z, robust_z};

/// Number of a unit, and of an axis in it.
type Place = (usize, usize);

/// All units of a batch, compared.
#[derive(Debug)]
pub struct Summary {
    units: Vec<Outcome>,
    /// For unit and axis, the robust z-scores of ln sigma before and after compensation.
    scores: BTreeMap<Place, [Option<f64>; 2]>,
}

/// An axis of the same name and unit, over all units that have it.
#[derive(Clone, Debug)]
pub struct BatchAxis<'a> {
    /// Name of the axis.
    pub name: &'a str,
    /// Its unit.
    pub unit: AxisUnit,
    /// Its results, in the order of the units.
    pub results: Vec<AxisOfUnit<'a>>,
}

/// An axis of one unit among the others.
#[derive(Clone, Copy, Debug)]
pub struct AxisOfUnit<'a> {
    place: Place,
    /// Its results.
    pub result: &'a AxisResult,
    /// Robust z-scores of ln sigma before and after compensation; none among too few units.
    pub scores: [Option<f64>; 2],
}

impl AxisOfUnit<'_> {
    /// Number of the unit in the batch.
    pub fn unit(&self) -> usize {
        self.place.0
    }

    /// Whether the axis is far from the others, before and after compensation.
    pub fn is_outlier(&self) -> [bool; 2] {
        self.scores.map(is_far)
    }
}

fn is_far(score: Option<f64>) -> bool {
    score.is_some_and(|z| z.abs() > OUTLIER_Z)
}

impl Summary {
    /// Compares the units, axis by axis of the same name and unit.
    ///
    /// The scores are of ln sigma, since sigmas differ by factors: a unit that is ten times worse is
    /// as far off as one that is ten times better.
    pub fn new(units: Vec<Outcome>) -> Self {
        let mut scores: BTreeMap<Place, [Option<f64>; 2]> = BTreeMap::new();
        let sigmas: [fn(&AxisResult) -> f64; 2] =
            [|axis| axis.sigma_before, |axis| axis.sigma_after];
        for axis in by_axis(&units) {
            for (which, sigma) in sigmas.into_iter().enumerate() {
                let (places, values): (Vec<Place>, Vec<f64>) = axis
                    .results
                    .iter()
                    .map(|of| (of.place, sigma(of.result).ln()))
                    .filter(|(_, value)| value.is_finite())
                    .unzip();
                for (place, z) in places.iter().zip(robust_z(&values).unwrap_or_default()) {
                    scores.entry(*place).or_default()[which] = Some(z);
                }
            }
        }
        Self { units, scores }
    }

    /// The units, in the order given.
    pub fn units(&self) -> &[Outcome] {
        &self.units
    }

    /// The axes, in the order in which the units have them.
    pub fn axes(&self) -> Vec<BatchAxis<'_>> {
        let mut axes = by_axis(&self.units);
        for of in axes.iter_mut().flat_map(|axis| &mut axis.results) {
            of.scores = self.scores(of.place);
        }
        axes
    }

    /// Numbers of the units, the worst first: without a set, rejected, accepted with warnings,
    /// accepted; then by the improvement of their worst axis.
    pub fn worst_first(&self) -> Vec<usize> {
        let severity = |verdict: Option<Verdict>| match verdict {
            None => 3,
            Some(Verdict::Rejected) => 2,
            Some(Verdict::AcceptedWithWarnings) => 1,
            Some(Verdict::Accepted) => 0,
        };
        let improvement = |unit: &Outcome| {
            let worst = unit.result.as_ref().ok()?.worst_axis()?;
            worst.improvement()
        };
        let mut numbers: Vec<usize> = (0..self.units.len()).collect();
        numbers.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|number| &self.units[number]);
            let least = |unit| improvement(unit).unwrap_or(f64::INFINITY);
            Reverse(severity(a.verdict()))
                .cmp(&Reverse(severity(b.verdict())))
                .then(least(a).total_cmp(&least(b)))
        });
        numbers
    }

    /// Whether every unit has an acceptable set.
    pub fn is_acceptable(&self) -> bool {
        let accepted = |of: &Outcome| of.verdict().is_some_and(|it| it != Verdict::Rejected);
        self.units.iter().all(accepted)
    }

    /// The verdict on the set of a unit; `failed` without a set.
    pub fn verdict(&self, unit: usize) -> &'static str {
        self.units[unit].verdict().map_or("failed", Verdict::name)
    }

    /// Whether some robust z-score of the unit is beyond [`OUTLIER_Z`].
    pub fn is_outlier(&self, unit: usize) -> bool {
        let mut scores = self.scores.range((unit, 0)..(unit + 1, 0));
        scores.any(|(_, scores)| scores.iter().any(|&score| is_far(score)))
    }

    /// The robust z-scores of an axis of a unit.
    pub(super) fn scores(&self, place: Place) -> [Option<f64>; 2] {
        self.scores.get(&place).copied().unwrap_or_default()
    }
}

/// The results by axis, without scores.
fn by_axis(units: &[Outcome]) -> Vec<BatchAxis<'_>> {
    let mut axes: Vec<BatchAxis> = Vec::new();
    for (number, unit) in units.iter().enumerate() {
        let results = unit.result.iter().flat_map(|result| &result.axes);
        for (position, result) in results.enumerate() {
            let of = AxisOfUnit {
                place: (number, position),
                result,
                scores: [None; 2],
            };
            let same =
                |axis: &&mut BatchAxis| (axis.name, axis.unit) == (&result.axis, result.unit);
            match axes.iter_mut().find(same) {
                Some(axis) => axis.results.push(of),
                None => axes.push(BatchAxis {
                    name: &result.axis,
                    unit: result.unit,
                    results: vec![of],
                }),
            }
        }
    }
    axes
}

#[cfg(test)]
mod tests {
    use tempco_set::{Rejection, RejectionCode};

    use super::super::outcome::example::unit;
    use super::*;

    #[test]
    fn the_far_unit_and_the_bad_one_stand_out() {
        let sigmas = [0.1, 0.11, 0.09, 0.105, 0.095, 0.9];
        let mut units: Vec<Outcome> = sigmas.map(|s| unit("S", &[("x", s)])).into();
        units.push(Outcome {
            result: Err("no".to_owned()),
            ..unit("BAD", &[])
        });
        let summary = Summary::new(units);
        let outliers: Vec<usize> = (0..7).filter(|&unit| summary.is_outlier(unit)).collect();
        assert_eq!(outliers, [5]);
        assert!(!summary.is_acceptable());
        let axes = summary.axes();
        assert_eq!((axes.len(), axes[0].results.len()), (1, 6));
        let last = axes[0].results[5];
        assert_eq!((last.unit(), last.is_outlier()), (5, [false, true]));
    }

    #[test]
    fn units_are_in_the_order_of_their_worst_axes() {
        let mut units = vec![
            unit("good", &[("x", 0.1), ("y", 0.2)]),
            unit("worse", &[("x", 0.5), ("y", 0.01)]),
            unit("rejected", &[("x", 0.4), ("y", 0.1)]),
            unit("failed", &[]),
        ];
        units[3].result = Err("no".to_owned());
        let code = RejectionCode::SegmentsDisagree;
        let rejected = units[2].result.as_mut().unwrap();
        let rejections = &mut rejected.judgement.rejections;
        rejections.push(Rejection::of_axis(code, "y", "segments disagree"));
        assert_eq!(rejected.worst_axis().unwrap().axis, "y");
        let rejections = &mut rejected.judgement.rejections;
        rejections.push(Rejection::of_axis(code, "x", "segments disagree"));
        assert_eq!(rejected.worst_axis().unwrap().axis, "x");
        rejected.judgement.rejections.pop();
        assert_eq!(Summary::new(units).worst_first(), [3, 2, 1, 0]);
    }
}
