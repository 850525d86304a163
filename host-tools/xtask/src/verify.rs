//! How thorough the tests of the core are, and what Miri says about them.
//!
//! Slow, and in need of tools that are not to be had everywhere: no part of the continuous checks.

mod places;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use tempco_qemu::Workspace;

use self::places::Places;
use crate::run::run as step;

/// The last compilers that knew MC/DC are of this time.
const MCDC_TOOLCHAIN: &str = "nightly-2025-06-01";
const BIG_ENDIAN: &str = "s390x-unknown-linux-gnu";
/// The tests of the core alone, those of the example in its documentation left out.
const TESTS: [&str; 5] = ["--package", "tempco", "--locked", "--lib", "--tests"];
const LEAST_CAUGHT_PERCENT: f64 = 95.0;

/// Why a part could not run; anything else that fails is an error.
type Skipped = String;
/// What a part found short of its goal.
type Findings = Result<Result<Vec<String>, Skipped>>;

pub(crate) fn run() -> Result<()> {
    let workspace = Workspace::find()?;
    let mut faults = Vec::new();
    let mut take = |name: &str, part: fn(&Workspace) -> Findings| -> Result<()> {
        println!("\n== {name}");
        match part(&workspace).with_context(|| name.to_owned())? {
            Ok(found) => faults.extend(found),
            Err(why) => println!("skipped: {name}: {why}"),
        }
        Ok(())
    };
    take("coverage", coverage)?;
    take("MC/DC", mcdc)?;
    take("mutants", mutants)?;
    take("Miri", miri)?;
    println!();
    for fault in &faults {
        println!("FAULT  {fault}");
    }
    ensure!(faults.is_empty(), "{} faults", faults.len());
    println!("no faults");
    Ok(())
}

fn coverage(workspace: &Workspace) -> Findings {
    if let Err(why) = llvm_cov("nightly") {
        return Ok(Err(why));
    }
    let report = report(workspace, "nightly", &["--branch"])?;
    let regions = Places::of(&report, "regions", &[4], 5);
    let branches = Places::of(&report, "branches", &[4, 5], 6);
    let lines = regions.lines();
    let faults = [
        regions.print("regions", workspace)?,
        lines.print("lines", workspace)?,
        branches.print("branches", workspace)?,
    ];
    Ok(Ok(faults.into_iter().flatten().collect()))
}

fn mcdc(workspace: &Workspace) -> Findings {
    if let Err(why) = toolchain(MCDC_TOOLCHAIN).and_then(|()| llvm_cov(MCDC_TOOLCHAIN)) {
        return Ok(Err(why));
    }
    // It is older than what the manifest asks for, but builds the core.
    let kind = ["--mcdc", "--ignore-rust-version"];
    let report = match report(workspace, MCDC_TOOLCHAIN, &kind) {
        Ok(report) => report,
        Err(why) => return Ok(Err(format!("{MCDC_TOOLCHAIN}: {why:#}"))),
    };
    // Of the whole files, the tests in them included: decisions are not told apart by place.
    let (mut count, mut covered) = (0, 0);
    for file in report["data"][0]["files"].as_array().into_iter().flatten() {
        let mcdc = &file["summary"]["mcdc"];
        count += mcdc["count"].as_u64().unwrap_or(0);
        covered += mcdc["covered"].as_u64().unwrap_or(0);
    }
    println!("conditions shown to decide on their own: {covered} of {count}");
    let missed = (covered < count).then(|| format!("MC/DC: {} conditions", count - covered));
    Ok(Ok(missed.into_iter().collect()))
}

fn mutants(workspace: &Workspace) -> Findings {
    if let Err(why) = program("cargo-mutants") {
        return Ok(Err(why));
    }
    let output = output_folder(workspace)?;
    let mut command = cargo(workspace, "stable", &["mutants", "--package", "tempco"]);
    // Each job builds in the folder of its own copy.
    command.env_remove("CARGO_TARGET_DIR");
    command.args(["-j", "2", "--timeout", "120", "--colors", "never"]);
    command.arg("--output").arg(&output);
    command.args(["--", "--locked", "--lib", "--tests"]);
    // It fails where a mutant survives; what counts is read from its report.
    let _ = step(workspace, &mut command);
    let folder = output.join("mutants.out");
    let outcomes: Value = serde_json::from_slice(&fs::read(folder.join("outcomes.json"))?)?;
    let number = |name: &str| outcomes[name].as_f64().unwrap_or(0.0);
    let [caught, missed, timeout] = ["caught", "missed", "timeout"].map(number);
    let percent = 100.0 * (caught + timeout) / (caught + timeout + missed).max(1.0);
    let unviable = number("unviable");
    println!(
        "{percent:.1} % found: {caught} caught, {timeout} timed out, {missed} missed; {unviable} unviable"
    );
    for (list, what) in [("missed.txt", "survivor"), ("timeout.txt", "timed out")] {
        for mutant in fs::read_to_string(folder.join(list))?.lines() {
            println!("{what}: {mutant}");
        }
    }
    let fault = (percent < LEAST_CAUGHT_PERCENT).then(|| format!("mutants: {percent:.1} % found"));
    Ok(Ok(fault.into_iter().collect()))
}

fn miri(workspace: &Workspace) -> Findings {
    if let Err(why) = component("nightly", "miri").and_then(|()| component("nightly", "rust-src")) {
        return Ok(Err(why));
    }
    let mut faults = Vec::new();
    for target in [&[][..], &["--target", BIG_ENDIAN]] {
        let mut command = cargo(workspace, "nightly", &["miri", "test"]);
        if let Err(error) = step(workspace, command.args(TESTS).args(target)) {
            faults.push(format!("Miri: {error:#}"));
        }
    }
    Ok(Ok(faults))
}

/// Runs the tests instrumented and returns what llvm-cov exports.
fn report(workspace: &Workspace, toolchain: &str, kind: &[&str]) -> Result<Value> {
    let path = output_folder(workspace)?.join("coverage.json");
    let mut command = cargo(workspace, toolchain, &["llvm-cov", "--json"]);
    step(
        workspace,
        command
            .args(kind)
            .args(TESTS)
            .arg("--output-path")
            .arg(&path),
    )?;
    Ok(serde_json::from_slice(&fs::read(&path)?)?)
}

fn output_folder(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.root().join("target/verify");
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// A cargo command of a toolchain, without what the cargo that runs this set for itself.
fn cargo(workspace: &Workspace, toolchain: &str, args: &[&str]) -> Command {
    let mut command = Command::new("rustup");
    command.args(["run", toolchain, "cargo"]).args(args);
    for name in ["CARGO", "RUSTC", "RUSTDOC", "RUSTUP_TOOLCHAIN"] {
        command.env_remove(name);
    }
    command.current_dir(workspace.root());
    command
}

/// Installs what coverage needs, unless it is there.
fn llvm_cov(name: &str) -> Result<(), Skipped> {
    component(name, "llvm-tools").and_then(|()| program("cargo-llvm-cov"))
}

fn toolchain(name: &str) -> Result<(), Skipped> {
    let present = quiet("rustup", &["run", name, "rustc", "--version"]);
    present.or_else(|_| {
        quiet(
            "rustup",
            &["toolchain", "install", name, "--profile", "minimal"],
        )
    })
}

fn component(name: &str, component: &str) -> Result<(), Skipped> {
    toolchain(name)?;
    quiet(
        "rustup",
        &["component", "add", component, "--toolchain", name],
    )
}

/// Installs a program of cargo's unless it is there.
fn program(name: &str) -> Result<(), Skipped> {
    let command = name.trim_start_matches("cargo-");
    quiet(name, &[command, "--version"]).or_else(|_| quiet("cargo", &["install", "--locked", name]))
}

fn quiet(program: &str, args: &[&str]) -> Result<(), Skipped> {
    let mut command = Command::new(program);
    let status = command
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!(
            "`{program} {}` ended with {status}",
            args.join(" ")
        )),
        Err(error) => Err(format!("`{program}`: {error}")),
    }
}
