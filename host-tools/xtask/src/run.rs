//! Runs programs and shows what is run.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use tempco_qemu::Workspace;

/// A cargo command in the workspace.
pub(crate) fn cargo(workspace: &Workspace, args: &[&str]) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command.current_dir(workspace.root()).args(args);
    command
}

/// Shows a command as one would type it, with paths as seen from the workspace.
fn shown(command: &Command, root: &Path) -> String {
    let mut words = vec![Path::new(command.get_program())];
    words.extend(command.get_args().map(Path::new));
    let words = words.into_iter().enumerate().map(|(position, word)| {
        let word = match position {
            0 => Path::new(word.file_name().unwrap_or_default()),
            _ => word.strip_prefix(root).unwrap_or(word),
        };
        let word = word.display().to_string();
        if word.contains([' ', ':', ',']) {
            format!("\"{word}\"")
        } else {
            word
        }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// Runs a command and lets its output through.
pub(crate) fn run(workspace: &Workspace, command: &mut Command) -> Result<()> {
    let shown = shown(command, workspace.root());
    println!("\n$ {shown}");
    let status = command.status().with_context(|| shown.clone())?;
    ensure!(status.success(), "`{shown}` ended with {status}");
    Ok(())
}

/// Runs a command, lets its output through and returns it as well.
pub(crate) fn run_and_read(workspace: &Workspace, command: &mut Command) -> Result<(String, bool)> {
    let shown = shown(command, workspace.root());
    println!("\n$ {shown}");
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| shown.clone())?;
    let Some(stdout) = child.stdout.take() else {
        bail!("`{shown}` has no output");
    };
    let mut output = String::new();
    for line in BufReader::new(stdout).lines() {
        let line = line?;
        println!("{line}");
        output.push_str(&line);
        output.push('\n');
    }
    Ok((output, child.wait()?.success()))
}

/// Builds with the tasks: their crates, which are there, then have the features that are wanted.
pub(crate) const WITH_TASKS: &[&str] = &["--package", "xtask"];

/// Builds the `tempco` command and returns its path.
pub(crate) fn build_tempco(workspace: &Workspace, options: &[&str]) -> Result<PathBuf> {
    let mut build = cargo(workspace, &["build", "--package", "tempco-cli", "--locked"]);
    build.args(options);
    build.args(["--message-format", "json-render-diagnostics"]);
    let output = build.stderr(Stdio::inherit()).output()?;
    ensure!(
        output.status.success(),
        "the `tempco` command does not build"
    );
    let messages = String::from_utf8(output.stdout)?;
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .find(|message| message["target"]["name"] == "tempco" && message["executable"].is_string())
        .and_then(|message| Some(PathBuf::from(message["executable"].as_str()?)))
        .context("cargo did not say where it put the `tempco` command")
}
