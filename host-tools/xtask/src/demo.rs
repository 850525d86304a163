//! The main job, end to end: what a stranger runs first.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use tempco_qemu::{Workspace, ensure_qemu, ensure_target};

use crate::figure;
use crate::run::{WITH_TASKS, build_tempco, run as step, run_and_read};

/// The paper's segments \[degC\].
const SEGMENTS: &str = "-15:15,5:35,25:60,50:80";
/// The models that are compared, the default one last.
const MODELS: [&str; 3] = ["static", "composite", DEFAULT];
const DEFAULT: &str = "auto";
/// Samples that host and target must agree on.
const LEAST_SAMPLES: u64 = 100_000;

fn run_in(workspace: &Workspace, folder: &Path) -> Result<()> {
    let start = Instant::now();
    ensure_target(workspace)?;
    ensure_qemu(workspace)?;
    let program = build_tempco(workspace, WITH_TASKS)?;
    let tempco = |args: &[&str]| {
        let mut command = Command::new(&program);
        command.current_dir(workspace.root()).args(args);
        command
    };
    let path = |name: &str| folder.join(name).display().to_string();
    let (calibration, verification) = (path("calibration.csv"), path("verification.csv"));

    println!("1. A simulated unit goes through a chamber twice: to be fitted, and to be judged.");
    for (profile, seed, log) in [
        ("calibration", "1", &calibration),
        ("verification", "2", &verification),
    ] {
        step(
            workspace,
            &mut tempco(&[
                "simulate",
                "--unit",
                "paper",
                "--profile",
                profile,
                "--seed",
                seed,
                "--out",
                log,
            ]),
        )?;
    }

    println!("\n2. The paper's two models, with its segments, and the default model are fitted to");
    println!("   the calibration log.");
    for model in MODELS {
        let out = path(model);
        let mut fit = tempco(&["fit", &calibration, "--serial", "DEMO-1", "--out", &out]);
        if model != DEFAULT {
            fit.args(["--model", model, "--segments", SEGMENTS]);
        }
        step(workspace, &mut fit)?;
    }

    println!("\n3. They are judged on the verification log.");
    let set = |model: &str| path(&format!("{model}/coefficients.json"));
    let evaluations = MODELS.map(|model| -> Result<Value> {
        let output = tempco(&["evaluate", &set(model), &verification, "--json"]).output()?;
        serde_json::from_slice(&output.stdout).context("the evaluation is not JSON")
    });
    let [of_static, of_composite, of_default] = evaluations;
    compare_models(&of_static?, &of_composite?, &of_default?)?;
    let (set, applied) = (set(DEFAULT), path("compensated.csv"));
    step(
        workspace,
        &mut tempco(&["apply", &set, &verification, "--out", &applied]),
    )?;
    let report = path("verification.html");
    let evaluate = [
        "evaluate",
        &set,
        &verification,
        "--report",
        &report,
        "--json",
    ];
    ensure!(
        tempco(&evaluate).output()?.status.success(),
        "no report was written"
    );
    println!("wrote {report}; the report of the fit lies in the folder of the set");
    let picture = folder.join("verification.svg");
    figure::draw(Path::new(&applied), &picture)?;
    println!("drew {}", picture.display());

    println!(
        "\n4. The default model's table is compiled into firmware, and the verification log is"
    );
    println!("   replayed through it on two emulated boards.");
    for board in ["mps2-an386", "stm32f405"] {
        let mut replay = tempco(&[
            "replay",
            &set,
            &verification,
            "--target",
            "qemu",
            "--board",
            board,
        ]);
        let (output, succeeded) = run_and_read(workspace, &mut replay)?;
        ensure!(succeeded, "host and {board} differ");
        ensure!(
            samples_compared(&output) >= Some(LEAST_SAMPLES),
            "fewer than {LEAST_SAMPLES} samples were compared on {board}"
        );
    }
    println!("\ndone in {:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

fn demo_folder(workspace: &Workspace) -> Result<std::path::PathBuf> {
    let folder = workspace.root().join("target/demo");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

pub(crate) fn run() -> Result<()> {
    let workspace = Workspace::find()?;
    run_in(&workspace, &demo_folder(&workspace)?)
}

/// Prints the table the paper closes with, and the default model: sigma of the smoothed output
/// without compensation and with each model. `over paper` is against the composite one.
fn compare_models(of_static: &Value, of_composite: &Value, of_default: &Value) -> Result<()> {
    let axes = |evaluation: &Value| evaluation["axes"].as_array().cloned().unwrap_or_default();
    println!(
        "\nsigma of {} s means of the verification log [pulses/s]",
        of_default["tau_s"]
    );
    println!("| axis | n   | before | static | composite | auto   | improvement | over paper |");
    println!("|------|-----|--------|--------|-----------|--------|-------------|------------|");
    let of_paper = axes(of_static).into_iter().zip(axes(of_composite));
    for ((with_static, with_composite), with_default) in of_paper.zip(axes(of_default)) {
        let figure = |axis: &Value, name: &str| axis[name].as_f64().context("a figure is missing");
        let raw = figure(&with_default, "sigma_raw")?;
        let [fixed, composite, sigma] = [&with_static, &with_composite, &with_default]
            .map(|axis| figure(axis, "sigma_compensated"));
        let (fixed, composite, sigma) = (fixed?, composite?, sigma?);
        println!(
            "| {:4} | {:3} | {raw:.4} | {fixed:.4} | {composite:9.4} | {sigma:.4} | {:9.1} % | {:8.1} % |",
            with_default["axis"].as_str().unwrap_or_default(),
            with_default["n"],
            100.0 * (1.0 - sigma / raw),
            100.0 * (1.0 - sigma / composite),
        );
        ensure!(sigma < raw, "the default model is no better than nothing");
    }
    Ok(())
}

/// N of the line `0 of N samples differ ...`.
fn samples_compared(output: &str) -> Option<u64> {
    let line = output.lines().find_map(|line| line.strip_prefix("0 of "))?;
    line.split_once(" samples differ")?.0.parse().ok()
}
