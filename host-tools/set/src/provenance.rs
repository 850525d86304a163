//! Where a set comes from, and what it was judged on.

use serde::{Deserialize, Serialize};
use tempco_log::signals::Finding;
use tempco_log::{Doubt, Mapping, SkippedRows};

use crate::{Rejection, RejectionCode, Warning};

/// The verdict of a verification log on a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignOff {
    /// Name of the log's file.
    pub file: String,
    /// SHA-256 of the log, in hexadecimal.
    pub sha256: String,
    /// Time of judging, RFC 3339, UTC.
    pub judged: String,
    /// Averaging time of the bias stabilities that were compared \[s\].
    pub tau_s: f64,
    /// Whether the log does not reject the set.
    pub accepted: bool,
    /// The axes for which it does.
    pub worse_axes: Vec<String>,
    /// Why it does; empty in older sets, where the compensation was not better than none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rejections: Vec<Rejection>,
    /// What the log warned of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
}

impl SignOff {
    /// The axes and codes of the rejections, in a line.
    pub fn reasons(&self) -> String {
        let mut codes: Vec<&str> = Vec::new();
        for code in self.rejections.iter().map(|of| of.code.name()) {
            if !codes.contains(&code) {
                codes.push(code);
            }
        }
        if codes.is_empty() {
            codes.push(RejectionCode::NoBetterThanNone.name());
        }
        let axes = self.worse_axes.iter().map(String::as_str);
        let reasons: Vec<&str> = codes.into_iter().chain(axes).collect();
        reasons.join(", ")
    }
}

/// Where a set comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Program and version.
    pub tool: String,
    /// Time of making, RFC 3339, UTC.
    pub created: String,
    /// The files it was made from.
    pub inputs: Vec<Input>,
}

/// A file that went into a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Name without folders.
    pub file: String,
    /// SHA-256 in hexadecimal.
    pub sha256: String,
    /// Rows read.
    pub rows: usize,
    /// Rows left out for bad cells, on request.
    pub skipped_rows: usize,
    /// The same by reason; absent in older sets.
    #[serde(default, skip_serializing_if = "is_empty")]
    pub skipped: SkippedRows,
    /// Rows that were not fitted because the core did not accept their temperature or interval.
    pub unusable_rows: usize,
    /// Median time between rows \[s\].
    pub interval_s: f64,
    /// Time from the first row to the last \[s\].
    pub duration_s: f64,
    /// What is wrong with its signals.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// What a person must judge of how it was read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<Doubt>,
    /// How its columns were read, where they do not all have plain names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mapping: Option<Mapping>,
}

fn is_empty(skipped: &SkippedRows) -> bool {
    *skipped == SkippedRows::default()
}
