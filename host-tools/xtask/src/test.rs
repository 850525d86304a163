//! Every check, as continuous integration runs it.

use std::thread;

use anyhow::{Result, ensure};
use tempco_qemu::{Board, Workspace, ensure_program, ensure_qemu, ensure_target, ensure_target_of};

use crate::run::{cargo, run as step, run_and_read};
use crate::{python, windows};

const FIRMWARE: &str = "tempco-firmware";
const TEST_IMAGES: &str = "tempco-test-images";
const IMAGES: [&str; 2] = [FIRMWARE, TEST_IMAGES];

/// `--no-fail-fast`: the count at the end is of all tests.
const TEST: &[&str] = &["test", "--workspace", "--no-fail-fast", "--locked"];

pub(crate) fn run() -> Result<()> {
    let workspace = Workspace::find()?;
    ensure_target(&workspace)?;
    ensure_qemu(&workspace)?;
    lint(&workspace)?;
    let mut skipped: Vec<String> = windows::lint(&workspace)?.into_iter().collect();
    skipped.extend(without_c_tools(&workspace));

    // Packages come over the network while documents and tests are built.
    let python = thread::scope(|scope| -> Result<_> {
        let python = scope.spawn(|| python::for_tests(&workspace));
        let mut doc = cargo(&workspace, &["doc", "--workspace", "--no-deps", "--locked"]);
        step(&workspace, doc.env("RUSTDOCFLAGS", "-D warnings"))?;
        step(&workspace, cargo(&workspace, TEST).arg("--no-run"))?;
        Ok(python.join().expect("it does not panic"))
    })?;
    // The tests of the Python module take one core, and the others seldom both.
    let (rust, python) = thread::scope(|scope| {
        let python = scope.spawn(|| python.map(|python| python::test(&workspace, &python)));
        let rust = run_and_read(&workspace, &mut cargo(&workspace, TEST));
        (rust, python.join().expect("it does not panic"))
    });
    let (output, succeeded) = rust?;
    let [mut passed, failed] = ["passed", "failed"].map(|what| count(&output, what));
    match python {
        Ok(of_python) => {
            let (said, of_python) = of_python?;
            println!("\n{said}");
            passed += of_python;
        }
        Err(reason) => skipped.push(reason),
    }
    for skipped in skipped {
        println!("\nSKIPPED: {skipped}");
    }
    println!("\n{passed} passed, {failed} failed");
    ensure!(succeeded && failed == 0, "tests failed");
    ensure!(passed > 0, "no test ran");
    Ok(())
}

/// Format, and lints on the host and on boards.
fn lint(workspace: &Workspace) -> Result<()> {
    for job in [
        vec!["fmt", "--check"],
        vec![
            "clippy",
            "--workspace",
            "--all-targets",
            "--locked",
            "--",
            "-D",
            "warnings",
        ],
    ] {
        step(workspace, &mut cargo(workspace, &job))?;
    }
    lint_images(workspace, Board::Mps2An386, &IMAGES, &["--bins"], "")?;
    let guards = ["--bin", "guard", "--bin", "guard_unit"];
    let test_images = [TEST_IMAGES];
    lint_images(
        workspace,
        Board::Mps2An386,
        &test_images,
        &guards,
        ",link-guard",
    )?;
    // The application, on the boards and with the gyros that it is for.
    for (board, gyro) in [
        (Board::Mps2An386, ""),
        (Board::Mps2An386, ",world"),
        (Board::Mps2An386, ",gyro-simulated,rate-8khz"),
        (Board::Stm32F405, ""),
        (Board::Stm32F405, ",gyro-icm42688"),
        (Board::Mps2An500, ""),
    ] {
        let unit = ["--lib", "--bin", "unit"];
        let features = format!(",application{gyro}");
        lint_images(workspace, board, &[FIRMWARE], &unit, &features)?;
    }
    // The real board, and one of each other kind of processor.
    for board in [
        Board::Stm32F405,
        Board::Mps2An505,
        Board::Mps2An385,
        Board::Microbit,
    ] {
        ensure_target_of(workspace, board)?;
        lint_images(workspace, board, &IMAGES, &["--bins"], "")?;
    }
    // Of it, on a processor, is more than on the host.
    let mut lint = cargo(workspace, &["clippy", "--locked", "--package", "tempco-c"]);
    lint.args([
        "--target",
        Board::Mps2An386.target(),
        "--",
        "-D",
        "warnings",
    ]);
    step(workspace, &mut lint)
}

/// Installs what the tests of the C side use, and returns what is skipped of them for want of it.
fn without_c_tools(workspace: &Workspace) -> Vec<String> {
    let tools = [
        ("arm-none-eabi-gcc", "gcc-arm-none-eabi", "C on a Cortex-M"),
        ("clang", "clang", "C by clang"),
        ("valgrind", "valgrind", "C under valgrind"),
        ("cmake", "cmake", "the package for CMake"),
    ];
    let missing = tools.map(|(program, package, what)| {
        let missing = ensure_program(workspace, program, &[package]).err()?;
        Some(format!("{what}: {missing}"))
    });
    missing.into_iter().flatten().collect()
}

/// Clippy on targets of packages as they are built for a board, with further features.
fn lint_images(
    workspace: &Workspace,
    board: Board,
    packages: &[&str],
    targets: &[&str],
    features: &str,
) -> Result<()> {
    for package in packages {
        let mut lint = cargo(workspace, &["clippy", "--locked", "--package", package]);
        lint.args(targets)
            .args(["--target", board.target(), "--no-default-features"])
            .args(["--features", &(board.feature() + features)])
            .args(["--", "-D", "warnings"]);
        step(workspace, &mut lint)?;
    }
    Ok(())
}

/// Sums a count of tests (`passed`, `failed`, `ignored`) over the closing lines of all programs.
pub(crate) fn count(output: &str, what: &str) -> u32 {
    let what = format!(" {what};");
    let number = |line: &str| -> u32 {
        let (before, _) = line.split_once(&what).unwrap_or_default();
        let word = before.split_whitespace().next_back().unwrap_or_default();
        word.parse().unwrap_or_default()
    };
    output
        .lines()
        .filter(|line| line.starts_with("test result: "))
        .map(number)
        .sum()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use tempco_qemu::{Workspace, checked};

    use super::count;
    use crate::run::cargo;

    /// Lines of crate and features.
    fn crates(of: &[&str]) -> HashSet<String> {
        let workspace = Workspace::find().unwrap();
        let mut tree = cargo(&workspace, &["tree", "--locked", "--prefix", "none"]);
        tree.args(["--format", "{p}|{f}"]).args(of);
        let output = checked(&mut tree).unwrap().stdout;
        let lines = String::from_utf8(output).unwrap();
        let lines = lines.lines().map(|line| line.trim_end_matches(" (*)"));
        lines.map(str::to_owned).collect()
    }

    /// What is built for the tasks serves the tests. If not, the manifest of the tasks lacks a feature.
    #[test]
    fn crates_of_the_tasks_have_the_features_that_they_have_in_tests() {
        let of_tasks = crates(&["--package", "xtask", "--edges", "normal,build"]);
        let of_tests = crates(&["--workspace", "--edges", "all"]);
        let others: Vec<_> = of_tasks.difference(&of_tests).collect();
        assert!(others.is_empty(), "{others:?}");
        assert!(of_tasks.len() > 100);
    }

    #[test]
    fn closing_lines_are_summed() {
        let output = "running 3 tests\n\
            test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured\n\
            test result: FAILED. 10 passed; 2 failed; 1 ignored; 0 measured\n";
        let counts = ["passed", "failed", "ignored"].map(|what| count(output, what));
        assert_eq!(counts, [13, 2, 1]);
    }
}
