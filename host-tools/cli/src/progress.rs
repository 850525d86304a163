//! The progress of reading, on a terminal.

use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Reads that take less time than this need no bar.
const PATIENCE: Duration = Duration::from_secs(2);

/// A bar over the bytes of one or more logs; it shows itself when reading takes longer than 2 s,
/// and never if standard error is no terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    can_show: bool,
}

impl Progress {
    /// A bar for the logs at `paths`.
    pub(crate) fn over<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        let lengths = paths.into_iter().filter_map(|path| path.metadata().ok());
        let bar = ProgressBar::with_draw_target(
            Some(lengths.map(|metadata| metadata.len()).sum()),
            ProgressDrawTarget::hidden(),
        );
        let template =
            "reading {bar:30} {bytes} of {total_bytes}, {bytes_per_sec}, {eta} remaining";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self {
            bar,
            can_show: stderr().is_terminal(),
        }
    }

    /// Notes that more bytes were read.
    pub(crate) fn add(&self, bytes: u64) {
        if self.can_show && self.bar.is_hidden() && self.bar.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(bytes);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
