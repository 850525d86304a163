//! Every example is run.

use std::fs;
use std::process::Command;

use tempco_tests::root;

/// Packages whose examples are a way of use, with the least number of them.
const PACKAGES: [(&str, &str, usize); 3] = [
    ("tempco", "crates/tempco", 3),
    ("tempco-fixed", "crates/tempco-fixed", 1),
    ("tempco-fit", "host-tools/fit", 1),
];

#[test]
fn every_example_runs() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    for (package, folder, least) in PACKAGES {
        let examples = fs::read_dir(root().join(folder).join("examples")).unwrap();
        let names: Vec<String> = examples
            .map(|example| example.unwrap().path())
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        assert!(names.len() >= least, "{package}: {names:?}");
        for name in names {
            let output = Command::new(&cargo)
                .current_dir(root())
                .args([
                    "run",
                    "--quiet",
                    "--locked",
                    "--package",
                    package,
                    "--example",
                    &name,
                ])
                .output()
                .unwrap();
            assert!(
                output.status.success(),
                "{name}: {}",
                String::from_utf8_lossy(&output.stderr)
            );
            assert!(!output.stdout.is_empty(), "{name} says nothing");
        }
    }
}
