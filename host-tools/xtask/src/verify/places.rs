//! What of the core its tests reach, from the report of llvm-cov.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use serde_json::Value;
use tempco_qemu::Workspace;

/// Start and end (line, column) of a piece of source.
type Place = (PathBuf, [u64; 4]);

/// How often each piece of the core was reached, over all its instantiations, and how often each
/// outcome of it came about.
pub(super) struct Places(BTreeMap<Place, Vec<u64>>);

impl Places {
    pub(super) fn of(report: &Value, kind: &str, counters: &[usize], file: usize) -> Self {
        let mut places = BTreeMap::new();
        let functions = report["data"][0]["functions"].as_array();
        for function in functions.into_iter().flatten() {
            for entry in function[kind].as_array().into_iter().flatten() {
                let number = |at: usize| entry[at].as_u64().unwrap_or(0);
                // Of regions, only those of code count: a gap or what a macro expands to does not.
                let name = function["filenames"][number(file) as usize].as_str();
                let path = PathBuf::from(name.unwrap_or_default());
                if (kind == "regions" && number(7) != 0) || !is_core(&path, number(0)) {
                    continue;
                }
                let counts = places
                    .entry((path, [0, 1, 2, 3].map(number)))
                    .or_insert_with(|| vec![0; counters.len()]);
                for (count, &at) in counts.iter_mut().zip(counters) {
                    *count += number(at);
                }
            }
        }
        Self(places)
    }

    /// Lines on which a region starts; covered if all of those are.
    pub(super) fn lines(&self) -> Self {
        let mut lines = BTreeMap::new();
        for ((path, [line, ..]), counts) in &self.0 {
            let place = (path.clone(), [*line, 1, *line, 1]);
            let least = lines.entry(place).or_insert_with(|| counts.clone());
            least[0] = least[0].min(counts[0]);
        }
        Self(lines)
    }

    /// Prints the share that was reached and each place that was not.
    pub(super) fn print(&self, what: &str, workspace: &Workspace) -> Result<Option<String>> {
        let counts = self.0.values().flatten();
        let all = counts.clone().count();
        let reached = counts.filter(|&&count| count > 0).count();
        ensure!(all > 0, "the report names no {what} of the core");
        let percent = 100.0 * reached as f64 / all as f64;
        println!("{what:10} {percent:6.2} % ({reached} of {all})");
        for ((path, [line, column, ..]), counts) in &self.0 {
            if counts.contains(&0) {
                let path = path.strip_prefix(workspace.root()).unwrap_or(path);
                println!("  not reached: {}:{line}:{column}", path.display());
            }
        }
        Ok((reached < all).then(|| format!("{what}: {} not reached", all - reached)))
    }
}

/// Whether a line belongs to the core itself rather than to the unit tests below it.
fn is_core(path: &Path, line: u64) -> bool {
    path.to_string_lossy().contains("/crates/tempco/src/")
        && fs::read_to_string(path).is_ok_and(|text| {
            let tests = text.lines().position(|line| line == "mod tests {");
            tests.is_none_or(|tests| line <= tests as u64)
        })
}
