//! Summaries as files: versioned, with a checksum.
//!
//! | bytes | contents |
//! | --- | --- |
//! | 0..8 | `TEMPCOSU` |
//! | 8..12 | version of the format, 1 |
//! | 12..16 | length of the head |
//! | 16..24 | length of the body |
//! | 24.. | head: one JSON object with the plan, the log's name, hash, length and findings |
//! | | body: the channels with their blocks and samples, as postcard |
//! | last 32 | SHA-256 of all before |
//!
//! Numbers are little-endian, every float is kept bit by bit.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tempco_log::signals::Finding;
use tempco_log::{Reading, SkippedRows};
use tempco_set::run::is_rereadable;
use thiserror::Error;

use crate::options::{Plan, PlanOptions};
use crate::summary::{ChannelSummary, LogSummary};

const MAGIC: [u8; 8] = *b"TEMPCOSU";
const VERSION: u32 = 1;
const FRONT: usize = 24;
const CHECKSUM: usize = 32;

/// What a summary says of its log, without the channels.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    plan: PlanOptions,
    file: String,
    sha256: String,
    rows: usize,
    skipped_rows: SkippedRows,
    interval_s: f64,
    duration_s: f64,
    reading: Reading,
    ignored_columns: Vec<String>,
    findings: Vec<Finding>,
}

/// Whether the file begins as a summary does. A file that cannot be read is none: it is read as a
/// log then, which says what is wrong.
pub fn is_summary(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    let mut read = || fs::File::open(path)?.read_exact(&mut start);
    // Nothing may be taken out of a pipe.
    is_rereadable(path) && read().is_ok() && start == MAGIC
}

/// Reads a summary that [`LogSummary::to_bytes`] made.
///
/// # Errors
/// An unreadable file; see [`LogSummary::from_bytes`].
pub fn read_summary(path: &Path) -> Result<LogSummary, SummaryError> {
    let bytes = fs::read(path).map_err(|cause| SummaryError::Io {
        path: path.to_owned(),
        cause,
    })?;
    LogSummary::from_bytes(&bytes).map_err(|message| SummaryError::Refused {
        path: path.to_owned(),
        message,
    })
}

impl LogSummary {
    /// The bytes of a file.
    ///
    /// # Panics
    /// Never: texts and numbers can always be written.
    pub fn to_bytes(&self) -> Vec<u8> {
        let head = Head {
            plan: self.plan.options().clone(),
            file: self.file.clone(),
            sha256: self.sha256.clone(),
            rows: self.rows,
            skipped_rows: self.skipped_rows,
            interval_s: self.interval_s,
            duration_s: self.duration_s,
            reading: self.reading.clone(),
            ignored_columns: self.ignored_columns.clone(),
            findings: self.findings.clone(),
        };
        let head = serde_json::to_vec(&head).expect("keys that are texts");
        let body = self.body();
        let mut bytes = Vec::with_capacity(FRONT + head.len() + body.len() + CHECKSUM);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((head.len() as u32).to_le_bytes());
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(head);
        bytes.extend(body);
        let checksum = Sha256::digest(&bytes);
        bytes.extend(checksum);
        bytes
    }

    fn body(&self) -> Vec<u8> {
        postcard::to_stdvec(&self.channels).expect("lengths are known")
    }

    /// By which the logs of a fit are ordered, whatever they are called and wherever they came from:
    /// SHA-256 of the temperatures, then of all numbers. The axes come second because a change of
    /// unit rounds them.
    pub(crate) fn order(&self) -> [[u8; 32]; 2] {
        let samples = self.channels.iter().map(|channel| &channel.samples);
        let samples: Vec<_> = samples.collect();
        let samples = postcard::to_stdvec(&samples).expect("lengths are known");
        [samples, self.body()].map(|bytes| Sha256::digest(bytes).into())
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// In words: no summary, another version, bytes that are missing or changed, contents that no
    /// log gives.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let front: &[u8; FRONT] = bytes
            .first_chunk()
            .filter(|front| front.starts_with(&MAGIC))
            .ok_or("no summary: expected a file written by `tempco summarise`")?;
        let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| front[at + i]));
        let version = word(8);
        if version != VERSION {
            return Err(format!(
                "a summary of version {version}: expected version {VERSION}: summarise the log again"
            ));
        }
        let head_end = FRONT.checked_add(word(12) as usize);
        let body = u64::from(word(16)) | u64::from(word(20)) << 32;
        let body_end = head_end.and_then(|end| end.checked_add(usize::try_from(body).ok()?));
        let whole = body_end.and_then(|end| end.checked_add(CHECKSUM));
        let (Some(head_end), Some(body_end)) =
            (head_end, body_end.filter(|_| whole == Some(bytes.len())))
        else {
            return Err(format!(
                "{} bytes, but its front says otherwise: was the file cut off?",
                bytes.len()
            ));
        };
        if bytes[body_end..] != Sha256::digest(&bytes[..body_end])[..] {
            return Err(
                "its checksum is wrong: the file was changed: summarise the log again".into(),
            );
        }
        let head: Head = serde_json::from_slice(&bytes[FRONT..head_end])
            .map_err(|error| format!("its head cannot be read: {error}"))?;
        let channels: Vec<ChannelSummary> = postcard::from_bytes(&bytes[head_end..body_end])
            .map_err(|error| format!("its channels cannot be read: {error}"))?;
        channels.iter().try_for_each(ChannelSummary::check)?;
        if channels.is_empty() {
            return Err("it has no channel".into());
        }
        Ok(Self {
            plan: Plan::new(head.plan).map_err(|error| format!("its plan: {error}"))?,
            file: head.file,
            sha256: head.sha256,
            rows: head.rows,
            skipped_rows: head.skipped_rows,
            interval_s: head.interval_s,
            duration_s: head.duration_s,
            reading: head.reading,
            ignored_columns: head.ignored_columns,
            findings: head.findings,
            channels,
        })
    }
}

impl ChannelSummary {
    /// What the rest of the fit relies on.
    fn check(&self) -> Result<(), String> {
        let axes = self.axes.len();
        let mut at = 0;
        let follows = self.blocks.iter().all(|block| {
            let starts = block.samples.start == at && block.samples.end >= at;
            at = block.samples.end;
            starts && block.moments.axes.len() == axes
        });
        let fits = axes > 0
            && follows
            && at == self.samples.len()
            && self.white_sigmas.len() == axes
            && [0, axes].contains(&self.spiked.len())
            && self.block_s > 0.0
            && self.block_s.is_finite();
        match fits {
            true => Ok(()),
            false => Err(format!(
                "the blocks of `{}` do not fit together",
                self.column
            )),
        }
    }
}

/// A summary was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SummaryError {
    /// The file cannot be read.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// The contents are unusable.
    #[error("{}: {message}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        message: String,
    },
}
