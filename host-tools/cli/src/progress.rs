//! The progress of long work, on a terminal.

use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Work that takes less time than this has no bar.
const PATIENCE: Duration = Duration::from_secs(2);

/// A bar. It appears when the work takes longer than 2 s, if standard error is a terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    can_show: bool,
}

impl Progress {
    /// A bar over the bytes of one or more logs at `paths`.
    pub(crate) fn over<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        let lengths = paths.into_iter().filter_map(|path| path.metadata().ok());
        Self::new(
            lengths.map(|metadata| metadata.len()).sum(),
            "reading {bar:30} {bytes} of {total_bytes}, {bytes_per_sec}, {eta} remaining",
        )
    }

    /// A bar over the bytes of an image that is written into a unit.
    pub(crate) fn over_upload(bytes: u64) -> Self {
        Self::new(
            bytes,
            "writing {bar:30} {bytes} of {total_bytes}, {bytes_per_sec}, {eta} remaining",
        )
    }

    /// A bar over the rows of a log that is replayed.
    pub(crate) fn over_rows(rows: u64) -> Self {
        Self::new(
            rows,
            "replaying {bar:30} {human_pos} of {human_len} rows, {per_sec}, {eta} remaining",
        )
    }

    /// A bar over the seconds of a log that is recorded; without an end, it counts.
    pub(crate) fn over_recording(duration_s: Option<f64>) -> Self {
        duration_s.map_or_else(
            || Self::new(u64::MAX, "recording {human_pos} s"),
            |duration_s| {
                Self::new(
                    duration_s.ceil() as u64,
                    "recording {bar:30} {human_pos} of {human_len} s, {eta} remaining",
                )
            },
        )
    }

    fn new(length: u64, template: &str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self {
            bar,
            can_show: stderr().is_terminal(),
        }
    }

    /// Adds to what is done.
    pub(crate) fn add(&self, more: u64) {
        self.show();
        self.bar.inc(more);
    }

    /// Sets how much is done in all.
    pub(crate) fn at(&self, done: u64) {
        self.show();
        self.bar.set_position(done);
    }

    fn show(&self) {
        if self.can_show && self.bar.is_hidden() && self.bar.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
