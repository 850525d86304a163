//! The places of the core in a report of llvm-cov, and which of them were reached.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use serde_json::Value;
use tempco_qemu::Workspace;

use super::Measured;

/// Start and end (line, column) of a piece of source.
type Place = (PathBuf, [u64; 4]);

/// How often each outcome of each piece of the core came about, over all its instantiations.
pub(super) struct Places(BTreeMap<Place, Vec<u64>>);

impl Places {
    pub(super) fn regions(report: &Value) -> Self {
        // Only those of code count: a gap or what a macro expands to does not.
        Self::of(report, "regions", 5, |region| {
            (region[7] == 0).then(|| vec![number(&region[4])])
        })
    }

    pub(super) fn branches(report: &Value) -> Self {
        Self::of(report, "branches", 6, |branch| {
            Some(vec![number(&branch[4]), number(&branch[5])])
        })
    }

    /// Of each condition, in how many instantiations it was shown to decide on its own.
    pub(super) fn conditions(report: &Value) -> Self {
        Self::of(report, "mcdc_records", 4, |decision| {
            let shown = decision[6].as_array()?.iter();
            Some(shown.map(|shown| u64::from(shown == true)).collect())
        })
    }

    /// The entries of a kind in all functions, by their first four numbers and the file whose
    /// number is at `file`.
    fn of(
        report: &Value,
        kind: &str,
        file: usize,
        outcomes: impl Fn(&Value) -> Option<Vec<u64>>,
    ) -> Self {
        let mut places = BTreeMap::new();
        for function in array(&report["data"][0]["functions"]) {
            for entry in array(&function[kind]) {
                let name = &function["filenames"][number(&entry[file]) as usize];
                let path = PathBuf::from(name.as_str().unwrap_or_default());
                if !is_core(&path, number(&entry[0])) {
                    continue;
                }
                let Some(outcomes) = outcomes(entry) else {
                    continue;
                };
                let place = (path, [0, 1, 2, 3].map(|at: usize| number(&entry[at])));
                let counts = places
                    .entry(place)
                    .or_insert_with(|| vec![0; outcomes.len()]);
                for (count, outcome) in counts.iter_mut().zip(outcomes) {
                    *count += outcome;
                }
            }
        }
        Self(places)
    }

    /// Names each place that was not reached.
    pub(super) fn judge(&self, what: &str, workspace: &Workspace) -> Result<Measured> {
        let counts = self.0.values().flatten();
        let all = counts.clone().count();
        let reached = counts.filter(|&&count| count > 0).count();
        ensure!(all > 0, "the report names no {what} of the core");
        for ((path, [line, column, ..]), counts) in &self.0 {
            if counts.contains(&0) {
                let path = path.strip_prefix(workspace.root()).unwrap_or(path);
                println!("{what} not reached: {}:{line}:{column}", path.display());
            }
        }
        Ok(Measured {
            reached: reached == all,
            figure: format!("{reached} of {all} {what}"),
        })
    }
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or(0)
}

/// Whether a line belongs to the core itself rather than to the unit tests below it.
fn is_core(path: &Path, line: u64) -> bool {
    path.to_string_lossy().contains("/crates/tempco/src/")
        && fs::read_to_string(path).is_ok_and(|text| {
            let tests = text.lines().position(|line| line == "mod tests {");
            tests.is_none_or(|tests| line <= tests as u64)
        })
}
