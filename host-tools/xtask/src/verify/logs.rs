//! Logs of autopilots, as others read and write them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use tempco_qemu::Workspace;

use super::tools::Missing;
use super::{Measured, output_folder};
use crate::run::{WITH_TASKS, build_tempco, cargo, run as step, run_and_read};

/// The readers to compare with.
const PACKAGES: [&str; 3] = ["pyulog==1.3.0", "pymavlink==2.4.50", "numpy"];
/// A crate with a real log of PX4, and the place of the log in it.
const SAMPLE: [&str; 3] = ["yule_log", "0.4.0", "data/sample_log_small.ulg"];
const SCRIPT: &str = include_str!("logs.py");

pub(super) fn as_others_read_them(workspace: &Workspace) -> Result<Measured> {
    let folder = output_folder(workspace)?.join("logs");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let python = python(workspace, &folder).map_err(|error| Missing::new(format!("{error:#}")))?;
    let sample = sample(workspace, &folder).map_err(|error| Missing::new(format!("{error:#}")))?;
    let tempco = build_tempco(workspace, WITH_TASKS)?;
    let script = folder.join("logs.py");
    fs::write(&script, SCRIPT)?;
    let mut compare = Command::new(python);
    compare.arg(script).args([&tempco, &sample, &folder]);
    let (output, reached) = run_and_read(workspace, &mut compare)?;
    let equal = output
        .lines()
        .filter(|line| line.ends_with("values are equal"));
    Ok(Measured {
        reached,
        figure: format!(
            "{} of 9 sensors are read as by pyulog and pymavlink",
            equal.count()
        ),
    })
}

/// A Python of its own, with the readers.
fn python(workspace: &Workspace, folder: &Path) -> Result<PathBuf> {
    let environment = folder.join("python");
    let mut make = Command::new("python3");
    step(workspace, make.args(["-m", "venv"]).arg(&environment))?;
    let python = environment.join("bin/python");
    let mut install = Command::new(&python);
    install
        .args(["-m", "pip", "install", "--quiet"])
        .args(PACKAGES);
    step(workspace, &mut install)?;
    Ok(python)
}

/// The real log: cargo says where it unpacked the crate.
fn sample(workspace: &Workspace, folder: &Path) -> Result<PathBuf> {
    let [name, version, file] = SAMPLE;
    let package = folder.join("sample");
    fs::create_dir_all(package.join("src"))?;
    fs::write(package.join("src/lib.rs"), "")?;
    let manifest = package.join("Cargo.toml");
    let text = format!(
        "[package]\nname = \"sample\"\nedition = \"2024\"\n[workspace]\n[dependencies]\n{name} = \
         \"={version}\"\n"
    );
    fs::write(&manifest, text)?;
    let mut metadata = cargo(workspace, &["metadata", "--format-version", "1"]);
    metadata.arg("--manifest-path").arg(manifest);
    let output = metadata.stderr(Stdio::inherit()).output()?;
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().context("no packages")?;
    let of = packages.iter().find(|package| package["name"] == name);
    let manifest = of.and_then(|package| package["manifest_path"].as_str());
    let folder = Path::new(manifest.context("no such package")?).parent();
    Ok(folder.context("no folder")?.join(file))
}
