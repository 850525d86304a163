//! The verdict on a set, and why.

use tempco_evaluate::{AxisEvaluation, Evaluation, Role};
use tempco_set::{AxisSet, CoefficientSet, SegmentSet};

use crate::text::{figure, percent};

/// Correlation of what remains with temperature or rate beyond which a quarter of it follows them.
const LARGE_CORRELATION: f64 = 0.5;

/// A segment of which the rows span less than this share of its width reaches beyond its data.
const LEAST_WIDTH: f64 = 0.8;

/// Condition number beyond which coefficients are hardly told apart.
const LARGE_CONDITION: f64 = 100.0;

/// A simpler model that does better by this share on what was left out is worth a remark.
const CLEARLY_BETTER: f64 = 0.05;

/// Rows with remarks in their status, as a share, that are worth one here.
const MANY_ROWS: f64 = 0.01;

/// What to do with a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing speaks against it.
    Accept,
    /// Read the remarks, then decide.
    AcceptWithRemarks,
    /// Do not use it.
    Reject,
}

impl Verdict {
    /// As a person says it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accept => "accept",
            Self::AcceptWithRemarks => "accept with remarks",
            Self::Reject => "reject",
        }
    }
}

/// A verdict with its reasons.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Judgement {
    /// Why the set is to be rejected; empty if it is not.
    pub objections: Vec<String>,
    /// What should be known before it is accepted.
    pub remarks: Vec<String>,
}

impl Judgement {
    /// Judges a set by its own figures and, if there is one, by an evaluation; `remarks` are those
    /// of the fit.
    pub fn new(set: &CoefficientSet, evaluation: Option<&Evaluation>, remarks: &[String]) -> Self {
        let mut judgement = Self {
            remarks: remarks.to_vec(),
            ..Self::default()
        };
        judgement.of_alarms(set);
        match evaluation {
            Some(evaluation) => judgement.of_evaluation(evaluation),
            None => judgement.of_fit(set),
        }
        for segments in set.channels.iter().map(|channel| &channel.segments) {
            judgement.of_segments(segments);
        }
        judgement
    }

    /// What follows from objections and remarks.
    pub const fn verdict(&self) -> Verdict {
        match (self.objections.is_empty(), self.remarks.is_empty()) {
            (false, _) => Verdict::Reject,
            (true, false) => Verdict::AcceptWithRemarks,
            (true, true) => Verdict::Accept,
        }
    }

    fn of_alarms(&mut self, set: &CoefficientSet) {
        if let Some(last) = set.sign_offs.last().filter(|last| !last.accepted) {
            self.objections.push(format!(
                "signed off as rejected on {}: no better than no compensation on {}",
                last.file,
                last.worse_axes.join(", ")
            ));
        }
        for channel in &set.channels {
            for (number, axis) in channel.axes.iter().enumerate() {
                if channel.mismatch_alarm(number) {
                    self.objections.push(format!(
                        "axis {}: neighbouring segments disagree by more than half of the bias range",
                        axis.name
                    ));
                }
            }
        }
        // The fit says the same; once is enough.
        self.remarks
            .retain(|remark| !self.objections.contains(remark));
    }

    fn of_fit(&mut self, set: &CoefficientSet) {
        for (_, axis) in set.axes() {
            let worse = axis
                .statistics
                .is_some_and(|s| s.rmse_compensated >= s.rmse_raw);
            if worse {
                self.objections.push(format!(
                    "axis {}: compensation is no better than none on the logs it was fitted to",
                    axis.name
                ));
            }
            self.of_held_out(axis);
        }
        self.remarks.push(
            "not yet judged on a verification log: the figures below are of the logs it was fitted to"
                .to_owned(),
        );
    }

    fn of_held_out(&mut self, axis: &AxisSet) {
        let Some((errors, chosen)) = axis.held_out.and_then(|e| Some((e, e.chosen?))) else {
            return;
        };
        if chosen >= errors.none {
            self.remarks.push(format!(
                "axis {}: on soaks and ramps left out of the fit, the model is no better than none",
                axis.name
            ));
            return;
        }
        let others = [
            ("one cubic in T", errors.cubic),
            ("the static model", errors.static_model),
            ("the composite model", errors.composite),
        ];
        let better = others
            .into_iter()
            .filter_map(|(name, error)| Some((name, error?)))
            .filter(|(_, error)| *error < (1.0 - CLEARLY_BETTER) * chosen)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((name, error)) = better {
            self.remarks.push(format!(
                "axis {}: on soaks and ramps left out of the fit, {name} does better ({} against {} {})",
                axis.name,
                figure(error),
                figure(chosen),
                axis.unit
            ));
        }
    }

    fn of_evaluation(&mut self, evaluation: &Evaluation) {
        for axis in &evaluation.axes {
            if !axis.is_acceptable() {
                self.objections.push(format!(
                    "axis {}: compensation is no better than none on {} ({})",
                    axis.axis,
                    evaluation.log.file,
                    percent(axis.improvement)
                ));
            }
            self.of_residuals(axis, evaluation);
        }
        if evaluation.log.role == Role::Training {
            self.remarks
                .push("judged on a log it was fitted to: this is no verification".to_owned());
        }
        for (flag, rows) in &evaluation.status_rows {
            let share = *rows as f64 / evaluation.log.rows as f64;
            if share > MANY_ROWS && *flag != "settling" {
                self.remarks.push(format!(
                    "{:.1} % of the rows have the status {flag}",
                    100.0 * share
                ));
            }
        }
    }

    fn of_residuals(&mut self, axis: &AxisEvaluation, evaluation: &Evaluation) {
        if let Some(r) = axis.correlation_compensated.figure() {
            for (what, r) in [("the temperature", r.temperature), ("its rate", r.rate)] {
                if r.abs() > LARGE_CORRELATION {
                    self.remarks.push(format!(
                        "axis {}: what remains follows {what} (r = {r:+.2})",
                        axis.axis
                    ));
                }
            }
        }
        let at_tau = axis
            .bias_stability
            .iter()
            .find(|at| at.tau_s == evaluation.tau_s);
        let over = at_tau
            .and_then(|at| at.sigma.figure()?.improvement_over_reference)
            .filter(|over| *over < 0.0);
        if let Some(over) = over {
            self.remarks.push(format!(
                "axis {}: {} does better ({})",
                axis.axis,
                evaluation.reference,
                percent(over)
            ));
        }
    }

    fn of_segments(&mut self, segments: &[SegmentSet]) {
        for segment in segments {
            let name = format!(
                "segment {:.1} to {:.1} degC",
                segment.t_min_c, segment.t_max_c
            );
            if let Some(coverage) = segment.coverage.filter(|c| c.width < LEAST_WIDTH) {
                self.remarks.push(format!(
                    "{name}: the fitted rows span {:.0} % of it",
                    100.0 * coverage.width
                ));
            }
            if segment.condition > LARGE_CONDITION {
                self.remarks.push(format!(
                    "{name}: condition number {}, the coefficients are hardly told apart",
                    figure(segment.condition)
                ));
            }
        }
    }
}
