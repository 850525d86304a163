//! Every example is run, and listed in the README.

use std::fs;
use std::process::Command;

use tempco_tests::{example_path, root};

/// Names of the examples of all packages.
fn names() -> Vec<String> {
    let packages = ["crates", "host-tools"].map(|folder| root().join(folder).read_dir().unwrap());
    let packages = packages.into_iter().flatten();
    let folders = packages.filter_map(|package| {
        let folder = package.unwrap().path().join("examples");
        folder.read_dir().ok()
    });
    let files = folders.flatten().map(|file| file.unwrap().path());
    files
        .map(|file| file.file_stem().unwrap().to_string_lossy().into_owned())
        .collect()
}

#[test]
fn every_example_runs_and_is_in_the_readme() {
    let names = names();
    assert!(names.len() >= 4, "{names:?}");
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    for name in names {
        assert!(readme.contains(&name), "README: {name}");
        let output = Command::new(example_path(&name)).output().unwrap();
        assert!(
            output.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert!(!output.stdout.is_empty(), "{name} says nothing");
    }
}
