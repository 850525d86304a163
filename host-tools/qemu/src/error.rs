//! What can go wrong between the sources and the outcome.

use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::time::Duration;

use crate::Board;

/// Why an image could not be built or run. An image that ran and failed is not an error here: its
/// exit code and log say more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The sources of the firmware are nowhere to be found.
    #[error(
        "no tempco workspace in {start} or above, nor in {built_in}: \
         start this in a checkout of tempco, the firmware is built from its sources"
    )]
    NoWorkspace {
        /// Where the search started.
        start: PathBuf,
        /// Where this program was compiled.
        built_in: PathBuf,
    },
    /// There is no board of this name.
    #[error("there is no board `{0}`; the boards are {list}", list = Board::ALL.map(Board::name).join(", "))]
    UnknownBoard(String),
    /// A program could not be started.
    #[error("starting `{program}`: {cause}")]
    Start {
        /// The program.
        program: String,
        /// Why.
        cause: io::Error,
    },
    /// A program ran and failed.
    #[error("`{command}` failed ({status}):\n{stderr}")]
    Command {
        /// The program with its arguments.
        command: String,
        /// How it ended.
        status: ExitStatus,
        /// What it said.
        stderr: String,
    },
    /// Something must be installed, and may not or cannot be from here.
    #[error("{missing} is not installed; install it with: {command}")]
    Missing {
        /// What is missing.
        missing: String,
        /// How to install it.
        command: String,
    },
    /// The image did not end in time and was killed.
    #[error("the image did not end within {limit:?} and was killed; its log: {log:#?}")]
    TimeLimit {
        /// The limit.
        limit: Duration,
        /// What it had logged.
        log: Vec<String>,
    },
    /// QEMU itself was killed by a signal.
    #[error("QEMU ended with {status}; {stderr}; the image's log: {log:#?}")]
    Killed {
        /// How it ended.
        status: ExitStatus,
        /// What QEMU said.
        stderr: String,
        /// What the image had logged.
        log: Vec<String>,
    },
    /// QEMU refused to run the image.
    #[error("QEMU failed ({status}): {stderr}")]
    Emulator {
        /// How it ended.
        status: ExitStatus,
        /// What QEMU said.
        stderr: String,
    },
    /// QEMU did not carry out a command while it ran an image.
    #[error("QEMU's control socket, {command}: {reason}")]
    Control {
        /// The command.
        command: String,
        /// What QEMU said.
        reason: String,
    },
    /// The file is not an image of this firmware.
    #[error("{path} is not a firmware image: {reason}")]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file could not be read or written.
    #[error("{path}: {cause}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
}

impl Error {
    /// For `map_err`: an I/O error with the file it was about.
    pub(crate) fn file(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |cause| Self::File {
            path: path.to_owned(),
            cause,
        }
    }

    pub(crate) fn image(path: &Path, reason: impl ToString) -> Self {
        Self::Image {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}
