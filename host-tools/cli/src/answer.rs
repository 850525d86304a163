//! What `fit`, `evaluate` and `inspect` print for a person: the verdict with its reasons, one
//! table, what else matters, and the files written. At most 30 lines of 80 columns.

use std::io::{IsTerminal, stdout};
use std::path::Path;

use anyhow::Result;
use comfy_table::Table;
use serde::Serialize;
use tempco_evaluate::{Evaluation, Role};
use tempco_log::AxisUnit;
use tempco_set::{AxisSet, AxisStatistics, ChannelSet, CoefficientSet, Judgement};

use crate::judgement::{
    print_as_json, print_reasons, print_verdict, reasons_within, say_rejections,
};
use crate::output::{WIDTH, figure, percent, print_lines, table, within, without_dust, wrap};
use crate::shared_args::PrintArgs;

/// Lines that a terminal shows at once.
const MOST_LINES: usize = 30;

/// Characters of the name of an axis in the table, where it may take several lines.
const LONGEST_NAME: usize = 36;

/// An answer: how a set does, on the fitted logs or on another one.
pub(crate) struct Answer<'a> {
    pub(crate) set: &'a CoefficientSet,
    pub(crate) judgement: &'a Judgement,
    /// The log that the table is of; without, it is of the fitted logs.
    pub(crate) evaluation: Option<&'a Evaluation>,
    /// Whether the set is compared with another set.
    pub(crate) is_against: bool,
    /// What else matters, below the table.
    pub(crate) notes: Vec<String>,
    /// What was written where.
    pub(crate) written: Vec<String>,
}

impl Answer<'_> {
    /// Prints the answer as `args` ask for: as it is, with all `tables`, or as the object `json`
    /// with the judgement. `subject` is the set on the command line.
    pub(crate) fn print<T: Serialize>(
        &self,
        args: &PrintArgs,
        subject: &Path,
        json: impl FnOnce() -> T,
        tables: impl FnOnce() -> Result<()>,
    ) -> Result<()> {
        if args.json {
            print_as_json(json(), self.judgement)?;
        } else {
            let (table, written) = (self.summary(), wrap_all(&self.written));
            let room = MOST_LINES.saturating_sub(1 + table.len() + written.len());
            print_verdict(self.judgement, self.set, self.evaluation)?;
            if args.verbose {
                print_reasons(self.judgement)?;
            } else {
                print_each(&reasons_within(self.judgement, room))?;
            }
            print_each(&table)?;
            if args.verbose {
                tables()?;
            }
            print_each(&written)?;
        }
        if args.json || !stdout().is_terminal() {
            say_rejections(subject.display(), self.judgement);
        }
        Ok(())
    }

    /// The table with its title and notes, after an empty line.
    fn summary(&self) -> Vec<String> {
        let last = self.last_column();
        let mut lines = vec![String::new()];
        lines.extend(wrap(&self.title()));
        lines.extend(within(&mut self.table(&last), WIDTH).lines());
        lines.extend(wrap_all(last.note.iter().chain(&self.notes)));
        lines
    }

    fn title(&self) -> String {
        let set = self.set;
        if let Some(evaluation) = self.evaluation {
            let role = match evaluation.log.role {
                Role::Training => ", a training log",
                Role::Verification => ", a verification log",
                Role::Unknown => "",
            };
            return format!(
                "unit {} on {}{role}: bias stability at {} s",
                set.serial, evaluation.log.file, evaluation.tau_s
            );
        }
        let mut statistics = set.axes().filter_map(|(_, axis)| axis.statistics);
        let what = match statistics.next() {
            None => "what it does to a log is not known".to_owned(),
            Some(of) if has_means(&of) => {
                format!("bias stability at {} s on the fitted logs", of.tau_s)
            }
            Some(_) => "RMS error of the rows of the fitted logs".to_owned(),
        };
        format!("unit {}, {} model: {what}", set.serial, models(set))
    }

    fn table(&self, last: &LastColumn) -> Table {
        let mut header = vec!["axis", "unit", "before", "after", "improvement"];
        header.extend(last.name);
        let rows = self.set.axes().enumerate().map(|(number, (_, axis))| {
            let of_log = self.evaluation.map(|of| &of.axes[number]);
            let before_and_after = match of_log {
                Some(of) => Some((of.sigma_raw, of.sigma_compensated)),
                None => axis.statistics.map(|of| of_fit(&of)),
            };
            let mut row = result(&axis.name, axis.unit, before_and_after);
            if last.name.is_some() {
                row.push(last.cells[number].clone().unwrap_or_else(|| "-".to_owned()));
            }
            row
        });
        table(&header, rows)
    }

    /// The column after the improvement: the comparison asked for, or else the errors on soaks and
    /// ramps left out of the fit.
    fn last_column(&self) -> LastColumn {
        let against = self.evaluation.filter(|_| self.is_against);
        let (name, note, cells): (_, _, Vec<Option<String>>) = match against {
            Some(evaluation) => (
                "over reference",
                format!("over reference: improvement over {}", evaluation.reference),
                over_reference(evaluation).collect(),
            ),
            None => (
                "held out",
                "held out: RMS of 100 s means less white noise, in what was left out of the fit"
                    .to_owned(),
                self.set.axes().map(|(_, axis)| held_out(axis)).collect(),
            ),
        };
        let is_known = cells.iter().any(Option::is_some);
        LastColumn {
            name: is_known.then_some(name),
            note: is_known.then_some(note),
            cells,
        }
    }
}

/// The fitted model; with `auto` the chosen one, which channels may not have in common.
fn models(set: &CoefficientSet) -> String {
    let selections = set.channels.iter().filter_map(|of| of.selection.as_ref());
    let mut chosen: Vec<&str> = selections.map(|of| of.chosen.model.name()).collect();
    chosen.dedup();
    if chosen.is_empty() {
        chosen.push(set.settings.model.name());
    }
    chosen.join(" and ")
}

/// A name, without its middle where it is long.
fn short_name(name: &str) -> String {
    let length = name.chars().count();
    if length <= LONGEST_NAME {
        return name.to_owned();
    }
    let half = LONGEST_NAME / 2 - 2;
    let [start, end] = [0, length - half].map(|from| name.chars().skip(from).take(half));
    start.chain("...".chars()).chain(end).collect()
}

fn wrap_all<'a>(texts: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    texts.into_iter().flat_map(|text| wrap(text)).collect()
}

fn print_each(lines: &[String]) -> Result<()> {
    lines.iter().try_for_each(print_lines)
}

/// A column that is there if any axis has something in it.
struct LastColumn {
    name: Option<&'static str>,
    note: Option<String>,
    cells: Vec<Option<String>>,
}

fn result(name: &str, unit: AxisUnit, before_and_after: Option<(f64, f64)>) -> Vec<String> {
    let mut row = vec![short_name(name), unit.to_string()];
    row.extend(match before_and_after {
        Some((before, after)) => [
            figure(before),
            figure(without_dust(after, before)),
            percent(1.0 - after / before),
        ],
        None => ["-"; 3].map(str::to_owned),
    });
    row
}

/// Whether there are enough means over the averaging time for their spread.
const fn has_means(of: &AxisStatistics) -> bool {
    of.n > 1
}

const fn of_fit(of: &AxisStatistics) -> (f64, f64) {
    if has_means(of) {
        (of.sigma_raw, of.sigma_compensated)
    } else {
        (of.rmse_raw, of.rmse_compensated)
    }
}

fn held_out(axis: &AxisSet) -> Option<String> {
    let errors = axis.held_out?;
    let chosen = without_dust(errors.chosen?, errors.none);
    Some(format!("{} -> {}", figure(errors.none), figure(chosen)))
}

fn over_reference(evaluation: &Evaluation) -> impl Iterator<Item = Option<String>> {
    evaluation.axes.iter().map(|axis| {
        let mut taus = axis.bias_stability.iter();
        let at_tau = taus.find(|at| at.tau_s == evaluation.tau_s)?;
        at_tau
            .sigma
            .figure()?
            .improvement_over_reference
            .map(percent)
    })
}

/// What matters of a channel beside its axes, a line each.
pub(crate) fn channel_notes(channel: &ChannelSet) -> impl Iterator<Item = String> {
    std::iter::once(range_note(channel)).chain(channel.about_reference())
}

/// Range and boundaries of a channel, in a line.
fn range_note(channel: &ChannelSet) -> String {
    let data = &channel.table;
    let segments = match channel.segments.len() {
        1 => "1 segment".to_owned(),
        count => format!("{count} segments"),
    };
    let range = format!(
        "{}: {segments}, {} to {} degC, {} to {} degC/min",
        channel.temperature,
        figure(data.t_min_c.into()),
        figure(data.t_max_c.into()),
        figure(data.thermal.rate_min_c_per_min.into()),
        figure(data.thermal.rate_max_c_per_min.into()),
    );
    if channel.segments.len() == 1 {
        return range;
    }
    let mut mismatch: f64 = 0.0;
    let mut jump: f64 = 0.0;
    for axis in 0..channel.axes.len() {
        let bias_range = data.static_range(axis);
        let mismatches = channel.mismatches(axis);
        let largest = mismatches.iter().map(|of| of.overlap_mismatch);
        let largest = without_dust(largest.fold(0.0, f64::max), bias_range);
        mismatch = mismatch.max(largest / bias_range);
        let of_table = without_rounding(data.max_jump(axis).into(), channel, axis);
        jump = jump.max(of_table / bias_range);
    }
    format!(
        "{range}; segments disagree by up to {} % of the bias range, the table jumps by up to {} %",
        figure(100.0 * mismatch),
        figure(100.0 * jump)
    )
}

/// A jump of the table of an axis, or 0 where it is within the rounding of the core.
pub(crate) fn without_rounding(jump: f64, channel: &ChannelSet, axis: usize) -> f64 {
    if jump <= channel.table.rounding_bound(axis).total {
        0.0
    } else {
        jump
    }
}
