//! Installs what building and running need, where it is missing.

use std::path::Path;
use std::process::{Command, Output};

use crate::{Board, Error, Workspace};

/// The firmware's target on the reference board.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Installs the reference board's Rust target with rustup, unless it is there.
///
/// # Errors
/// There is no rustup, or it fails.
pub fn ensure_target(workspace: &Workspace) -> Result<(), Error> {
    ensure_target_of(workspace, Board::Mps2An386)
}

/// Installs a board's Rust target with rustup, unless it is there.
///
/// # Errors
/// There is no rustup, or it fails.
pub fn ensure_target_of(workspace: &Workspace, board: Board) -> Result<(), Error> {
    ensure_rust_target(workspace, board.target())
}

/// Installs a Rust target with rustup, unless it is there.
///
/// # Errors
/// There is no rustup, or it fails.
pub fn ensure_rust_target(workspace: &Workspace, target: &str) -> Result<(), Error> {
    let _lock = workspace.lock()?;
    if has_target(workspace, target) {
        return Ok(());
    }
    eprintln!("installing the Rust target {target}: rustup target add {target}");
    let mut command = Command::new("rustup");
    command.args(["target", "add", target]);
    match checked(command.current_dir(workspace.root())) {
        Err(Error::Start { .. }) => Err(Error::Missing {
            missing: format!("the Rust target {target}"),
            command: format!("rustup target add {target}"),
        }),
        other => other.map(drop),
    }
}

/// Whether the compiler has a core library for the target; so also without rustup.
fn has_target(workspace: &Workspace, target: &str) -> bool {
    let mut command = Command::new("rustc");
    command.args(["--print", "target-libdir", "--target", target]);
    checked(command.current_dir(workspace.root())).is_ok_and(|output| {
        let folder = String::from_utf8_lossy(&output.stdout);
        Path::new(folder.trim()).is_dir()
    })
}

/// Installs `qemu-system-arm` with apt-get, unless it is there.
///
/// # Errors
/// It is missing and this may not install it; the error says how to.
pub fn ensure_qemu(workspace: &Workspace) -> Result<(), Error> {
    ensure_program(workspace, "qemu-system-arm", &["qemu-system-arm"])
}

/// Installs a program by its Debian packages with apt-get, unless it is there.
///
/// # Errors
/// It is missing and this may not install it; the error says how to.
pub fn ensure_program(
    workspace: &Workspace,
    program: &str,
    packages: &[&str],
) -> Result<(), Error> {
    let _lock = workspace.lock()?;
    if checked(Command::new(program).arg("--version")).is_ok() {
        return Ok(());
    }
    let names = packages.join(" ");
    if !is_root() || checked(Command::new("apt-get").arg("--version")).is_err() {
        return Err(Error::Missing {
            missing: program.to_owned(),
            command: format!("sudo apt-get install {names} (or your system's equivalent)"),
        });
    }
    let install = ["install", "-y", "--no-install-recommends"];
    for arguments in [vec!["update"], [&install[..], packages].concat()] {
        eprintln!("installing {program}: apt-get {}", arguments.join(" "));
        let mut command = Command::new("apt-get");
        command.args(["-q", "-o", "DPkg::Lock::Timeout=300"]);
        checked(
            command
                .args(arguments)
                .env("DEBIAN_FRONTEND", "noninteractive"),
        )?;
    }
    Ok(())
}

fn is_root() -> bool {
    checked(Command::new("id").arg("-u")).is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

/// Runs a command to its end; a failure carries what it said.
///
/// # Errors
/// It cannot be started, or does not succeed.
pub fn checked(command: &mut Command) -> Result<Output, Error> {
    let output = command.output().map_err(|cause| Error::Start {
        program: command.get_program().to_string_lossy().into_owned(),
        cause,
    })?;
    if output.status.success() {
        return Ok(output);
    }
    let mut words = vec![command.get_program().to_string_lossy()];
    words.extend(
        command
            .get_args()
            .map(|argument| argument.to_string_lossy()),
    );
    Err(Error::Command {
        command: words.join(" "),
        status: output.status,
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_carry_the_command_and_its_words() {
        let error = checked(Command::new("rustc").arg("--no-such-option")).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("rustc --no-such-option"), "{text}");
        assert!(text.contains("no-such-option'"), "{text}");
        let error = checked(&mut Command::new("/nonexistent/program")).unwrap_err();
        assert!(error.to_string().contains("/nonexistent/program"));
    }
}
