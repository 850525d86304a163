//! Every example is run.

use std::fs;
use std::process::Command;

use tempco_tests::{example_path, root};

/// Packages whose examples are a way of use, with the least number of them.
const PACKAGES: [(&str, usize); 2] = [("crates/tempco", 3), ("host-tools/fit", 1)];

#[test]
fn every_example_runs() {
    for (folder, least) in PACKAGES {
        let examples = fs::read_dir(root().join(folder).join("examples")).unwrap();
        let names: Vec<String> = examples
            .map(|example| example.unwrap().path())
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        assert!(names.len() >= least, "{folder}: {names:?}");
        for name in names {
            let output = Command::new(example_path(&name)).output().unwrap();
            assert!(
                output.status.success(),
                "{name}: {}",
                String::from_utf8_lossy(&output.stderr)
            );
            assert!(!output.stdout.is_empty(), "{name} says nothing");
        }
    }
}
