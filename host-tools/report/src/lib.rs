//! The report of a calibration or a verification: one HTML page that needs nothing else, and its
//! figures as SVG.
//!
//! ```text
//! log, read again -> core -> Gatherer (fixed memory) -> figures --+
//! set, evaluation, judgement --------------------------------------+-> page
//! ```
//!
//! The figures are drawn from what a [`Gatherer`] has collected of the rows, so that a log of any
//! length can be shown. The numbers in the tables are the set's and the evaluation's own.
//!
//! A [`Calibration`] is the whole way of a unit, from summaries of its logs to its files.
//!
//! [`batch_page`] makes a page of the summary of a batch, in the same frame and style.
#![forbid(unsafe_code)]

mod band;
mod batch;
mod calibration;
mod figure;
mod gather;
mod page;
mod text;

pub use batch::batch_page;
pub use calibration::{Calibration, CalibrationError, Rows, ShownLog, gather};
pub use gather::{Gatherer, LogTimes};
pub use text::{LAGS, gain, held_out_caption, lags, states, table};

use tempco_evaluate::Evaluation;
use tempco_set::{CoefficientSet, Judgement};
use thiserror::Error;

use figure::Figures;

/// What a report is about.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The set.
    pub set: &'a CoefficientSet,
    /// How it does on the log that is shown; none where the logs are the fitted ones.
    pub evaluation: Option<&'a Evaluation>,
    /// The verdict.
    pub judgement: &'a Judgement,
}

/// A report, ready to be written.
#[derive(Clone, Debug)]
pub struct Report {
    /// The page.
    pub html: String,
    /// The same figures, each with the name of its file.
    pub figures: Vec<(String, String)>,
}

impl Report {
    /// Draws and writes the report. Where no rows were gathered it has no figures of rows, and says
    /// so.
    ///
    /// # Errors
    /// A figure that could not be drawn.
    pub fn new(subject: Subject, gathered: Option<Gatherer>) -> Result<Self, ReportError> {
        let gathered = gathered.map(Gatherer::finish);
        let figures = Figures::draw(subject.set, gathered.as_ref())?;
        Ok(Self {
            html: page::page(&subject, gathered.as_ref(), &figures),
            figures: figures
                .all()
                .map(|figure| (format!("{}.svg", figure.name), figure.file()))
                .collect(),
        })
    }
}

/// A report could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A figure could not be drawn.
    #[error("figure {figure}: {message}")]
    Drawing {
        /// Its name.
        figure: String,
        /// What is wrong.
        message: String,
    },
}
