//! Python: environments of packages, and the tests of the Python module.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use tempco_qemu::{Workspace, ensure_program};

use crate::run::{build_tempco, run as step};
use crate::windows;

/// The crate of the module, below the root of the workspace.
const MODULE: &str = "host-tools/python";
/// Its tests.
pub(crate) const TESTS: &str = "host-tools/python/tests";

/// A Python with the packages of a list, in a folder below `target`. It is made where it is not there
/// yet, or was made of another list.
///
/// # Errors
/// No Python, no module `venv`, or packages that cannot be had.
pub(crate) fn environment(workspace: &Workspace, name: &str, list: &str) -> Result<PathBuf> {
    let folder = workspace.root().join("target").join(name);
    let bin = if cfg!(windows) { "Scripts" } else { "bin" };
    let python = folder.join(bin).join("python");
    let wanted = workspace.root().join(list);
    let installed = folder.join("requirements.txt");
    let is_there = fs::read(&installed)
        .is_ok_and(|former| fs::read(&wanted).is_ok_and(|wanted| wanted == former));
    if !is_there {
        ensure_program(workspace, "python3", &["python3"])?;
        let make = || {
            let mut venv = Command::new("python3");
            venv.args(["-m", "venv"]).arg(&folder).output()
        };
        if !make()?.status.success() {
            // Debian has it in a package of its own. No program of that name: it is installed.
            ensure_program(workspace, "python3-venv", &["python3-venv"])?;
            let made = make()?;
            let said = String::from_utf8_lossy(&made.stderr).into_owned();
            ensure!(made.status.success(), "python3 -m venv: {said}");
        }
        let mut pip = Command::new(&python);
        pip.args(["-m", "pip", "install", "--quiet"]);
        pip.args(["--disable-pip-version-check", "-r"]).arg(&wanted);
        step(workspace, &mut pip)?;
        fs::copy(&wanted, &installed)?;
    }
    Ok(python)
}

/// Makes the wheels in `folder` and returns their paths: for every Linux of the last ten years by zig as
/// the linker, which is installed and used in an environment that has nothing else; and for Windows,
/// which is not tried.
pub(crate) fn wheels(workspace: &Workspace, folder: &Path) -> Result<[PathBuf; 2]> {
    let linux = wheel(workspace, folder, &["--zig"])?;
    use_it(workspace, &linux)?;
    windows::ensure_compilers(workspace)?;
    let windows = wheel(workspace, folder, &["--target", windows::TARGET])?;
    Ok([linux, windows])
}

fn wheel(workspace: &Workspace, folder: &Path, options: &[&str]) -> Result<PathBuf> {
    let python = environment(workspace, "maturin", &format!("{MODULE}/requirements.txt"))?;
    let tools = python.parent().context("a folder")?;
    let wheels = folder.join("wheel");
    if wheels.exists() {
        fs::remove_dir_all(&wheels)?;
    }
    let others = std::env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(tools.to_owned()).chain(std::env::split_paths(&others));
    let mut maturin = Command::new(tools.join("maturin"));
    maturin
        .current_dir(workspace.root().join(MODULE))
        .args(["build", "--release", "--locked", "--out"])
        .arg(&wheels)
        .args(options)
        .env("PATH", std::env::join_paths(path)?);
    step(workspace, &mut maturin)?;
    let mut made = fs::read_dir(&wheels)?;
    let made = made.next().context("maturin made no wheel")??;
    let wheel = folder.join(made.file_name());
    fs::rename(made.path(), &wheel)?;
    fs::remove_dir(&wheels)?;
    Ok(wheel)
}

/// Installs a wheel into an environment of its own, and fits a set by it.
fn use_it(workspace: &Workspace, wheel: &Path) -> Result<()> {
    let folder = workspace.root().join("target/clean-python");
    let mut venv = Command::new("python3");
    step(workspace, venv.args(["-m", "venv", "--clear"]).arg(&folder))?;
    let python = folder.join("bin/python");
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet"]);
    pip.arg("--disable-pip-version-check").arg(wheel);
    step(workspace, &mut pip)?;
    let mut fit = Command::new(&python);
    let lines = "import tempco; print(tempco.fit(tempco.simulate(), 'S1', model='composite'))";
    // Not in the sources, which have a folder of that name.
    step(workspace, fit.current_dir(&folder).args(["-c", lines]))
}

/// The Python of the tests, or why they are skipped.
pub(crate) fn for_tests(workspace: &Workspace) -> Result<PathBuf, String> {
    let list = format!("{TESTS}/requirements.txt");
    environment(workspace, "python", &list)
        .map_err(|missing| format!("the tests of the Python module: {missing:#}"))
}

/// Runs the tests of the Python module. Returns their output and how many passed.
///
/// # Errors
/// The module does not build, or tests failed, with what they said.
pub(crate) fn test(workspace: &Workspace, python: &Path) -> Result<(String, u32)> {
    let Module { command, package } = module(workspace)?;
    let mut pytest = Command::new(python);
    pytest
        .current_dir(workspace.root())
        .args(["-m", "pytest", "--quiet", "--color=no"])
        // Nothing is written into the sources.
        .args(["-p", "no:cacheprovider", "--doctest-modules"])
        .arg(package.join("tempco"))
        .arg(workspace.root().join(TESTS))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYTHONPATH", &package)
        .env("TEMPCO_COMMAND", command);
    let run = pytest.output()?;
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    let errors = String::from_utf8_lossy(&run.stderr);
    ensure!(
        run.status.success(),
        "tests of the Python module failed:\n{said}{errors}"
    );
    let count = said.lines().rev().find_map(|line| {
        let (count, _) = line.split_once(" passed")?;
        count.rsplit(' ').next()?.parse().ok()
    });
    let count = count.context("pytest did not say how many passed")?;
    Ok((said, count))
}

/// What is built to be used from Python.
pub(crate) struct Module {
    /// The command `tempco`, to compare with.
    pub(crate) command: PathBuf,
    /// The folder to import the package from.
    pub(crate) package: PathBuf,
}

/// Builds the command and the module, with the features that the tests of the workspace give to their
/// crates: what these have built is used.
pub(crate) fn module(workspace: &Workspace) -> Result<Module> {
    let as_tests = ["--workspace", "--lib", "--bin", "tempco", "--examples"];
    let command = build_tempco(workspace, &as_tests)?;
    let package = package(workspace, command.parent().context("a folder")?)?;
    Ok(Module { command, package })
}

/// Puts the package together, with the module that was built into `built`; returns the folder to import
/// it from.
fn package(workspace: &Workspace, built: &Path) -> Result<PathBuf> {
    let folder = workspace.root().join("target/python-package");
    let package = folder.join("tempco");
    fs::create_dir_all(&package)?;
    let sources = workspace.root().join(MODULE).join("python/tempco");
    for source in fs::read_dir(sources)? {
        let source = source?;
        if source.file_type()?.is_file() {
            fs::copy(source.path(), package.join(source.file_name()))?;
        }
    }
    fs::copy(
        built.join("libtempco_python.so"),
        package.join("_core.abi3.so"),
    )?;
    Ok(folder)
}
