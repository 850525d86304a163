//! Proofs on the compiled core, with tools that are installed where that is allowed.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use tempco_qemu::{TARGET, Workspace, ensure_program, ensure_target};

use crate::run::{cargo, run as step};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Also check every claim against seeded bugs (several minutes)
    #[arg(long)]
    mutants: bool,
    /// Also pass all 2^32 temperatures through the table, against f64
    #[arg(long)]
    exhaustive: bool,
    /// Only this function: place, bias, interval, update, play or second_lag; of the
    /// sample half publish, take_over, advance, correct, correct_block, status, pulses,
    /// pulse_status, pulse_ramp or of_raw
    #[arg(long)]
    only: Option<String>,
    /// Time limit of a query \[s\]
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// Coefficient set to examine; the firmware's example table without one
    #[arg(long)]
    set: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    ensure_target(&workspace)?;
    for (program, packages) in [
        ("gappa", &["gappa"][..]),
        ("coqc", &["coq", "libcoq-gappa"]),
    ] {
        if let Err(error) = ensure_program(&workspace, program, packages) {
            eprintln!("SKIPPED: what needs {program}: {error}");
        }
    }
    let ir = intermediate_code(&workspace)?;
    let mut prove = cargo(&workspace, &["run", "--quiet", "--release", "--locked"]);
    prove
        .args(["--package", "tempco-prove", "--", "--ir"])
        .arg(ir);
    prove
        .arg("--folder")
        .arg(workspace.root().join("target/prove"));
    prove.args(["--limit", &args.limit.to_string()]);
    if let Some(set) = &args.set {
        prove.arg("--set").arg(std::path::absolute(set)?);
    }
    if let Some(only) = &args.only {
        prove.args(["--only", only]);
    }
    for (wanted, name) in [
        (args.mutants, "--mutants"),
        (args.exhaustive, "--exhaustive"),
    ] {
        if wanted {
            prove.arg(name);
        }
    }
    step(&workspace, &mut prove)
}

/// The shims' LLVM IR for the firmware's target, as the compiler hands it to the backend.
fn intermediate_code(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.root().join("target/prove");
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("shims.ll");
    let mut build = cargo(
        workspace,
        &["rustc", "--quiet", "--profile", "firmware", "--locked"],
    );
    build.args(["--package", "tempco-prove-shims", "--target", TARGET]);
    // Of its own, so that the file cannot be gone while cargo takes it for fresh.
    build.arg("--target-dir").arg(folder.join("build"));
    // Fat LTO would leave the inlining to the linker, after the IR was written.
    build.args(["--config", "profile.firmware.lto=false", "--"]);
    build.arg(format!("--emit=llvm-ir={}", file.display()));
    build.args([
        "-C",
        "panic=abort",
        "-C",
        "codegen-units=1",
        "-C",
        "debuginfo=0",
    ]);
    step(workspace, &mut build)?;
    ensure!(file.is_file(), "the compiler wrote no LLVM IR");
    Ok(file)
}
