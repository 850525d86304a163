//! A set, or two at once, run over a log part by part.

use tempco::TableError;

use super::columns::{ApplyError, ChannelInputs, Columns, LogAxis};
use super::compensators::{Applied, Rows, Step, with_compensators};
use super::updates::Updates;
use crate::CoefficientSet;

/// Consecutive rows of a log, before and after compensation.
pub struct Part<'a> {
    /// Their times \[s\].
    pub time_s: &'a [f64],
    /// The columns that the channels of the set take.
    pub inputs: Vec<ChannelInputs<'a>>,
    /// What came of them.
    pub applied: Applied,
    /// What came of them with the set that is compared, if there is one.
    pub compared: Option<Applied>,
}

/// Consecutive rows of a log, with all its columns.
pub(super) struct LogRows<'a> {
    pub(super) time_s: &'a [f64],
    pub(super) temps_c: Vec<&'a [f32]>,
    pub(super) axes: Vec<&'a [f64]>,
}

/// What is known of a log before its rows.
pub(super) struct LogHead<'a> {
    pub(super) file: &'a str,
    pub(super) axes: &'a [LogAxis<'a>],
    pub(super) interval_s: f64,
}

/// Runs `set`, and `compared` if given, over the rows that `feed` passes on; `sink` gets every part.
pub(super) fn run_parts<E>(
    set: &CoefficientSet,
    compared: Option<&CoefficientSet>,
    log: &LogHead,
    feed: impl FnOnce(&mut dyn FnMut(&LogRows)) -> Result<(), E>,
    mut sink: impl FnMut(Part),
) -> Result<Result<(), E>, ApplyError> {
    let columns = Columns::find(set, log.file, log.axes)?;
    let Some(compared) = compared else {
        return Ok(with_compensators(set, |step| {
            let mut run = Run::new(set, columns, log, step);
            feed(&mut |rows| sink(run.part(rows)))
        })?);
    };
    let other = Columns::find(compared, log.file, log.axes)?;
    let run_both = |step: &mut Step| -> Result<Result<(), E>, TableError> {
        let mut run = Run::new(set, columns, log, step);
        with_compensators(compared, |step| {
            let mut other = Run::new(compared, other, log, step);
            feed(&mut |rows| {
                let compared = Some(other.part(rows).applied);
                sink(Part {
                    compared,
                    ..run.part(rows)
                });
            })
        })
    };
    Ok(with_compensators(set, run_both)??)
}

/// A set in the course of a log.
struct Run<'a, 's> {
    columns: Vec<Columns<'a>>,
    interval_s: f64,
    period_s: f64,
    /// None before the first row.
    updates: Option<Updates>,
    step: &'s mut Step<'s>,
}

impl<'a, 's> Run<'a, 's> {
    fn new(
        set: &CoefficientSet,
        columns: Vec<Columns<'a>>,
        log: &LogHead,
        step: &'s mut Step<'s>,
    ) -> Self {
        Self {
            columns,
            interval_s: log.interval_s,
            period_s: set.thermal_period_s(log.interval_s),
            updates: None,
            step,
        }
    }

    fn part<'b>(&mut self, rows: &LogRows<'b>) -> Part<'b>
    where
        'a: 'b,
    {
        let first_s = rows.time_s.first().copied().unwrap_or(0.0);
        let new = || Updates::new(first_s, self.interval_s, self.period_s);
        let updates_s = self.updates.get_or_insert_with(new).of_rows(rows.time_s);
        let inputs = || {
            self.columns
                .iter()
                .map(|of| of.of(&rows.temps_c, &rows.axes))
        };
        let applied = (self.step)(&Rows {
            updates_s: &updates_s,
            channels: inputs().collect(),
        });
        Part {
            time_s: rows.time_s,
            inputs: inputs().collect(),
            applied,
            compared: None,
        }
    }
}
