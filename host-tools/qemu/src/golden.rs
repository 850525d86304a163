//! Golden vectors: hashes of the outputs of hosts and targets for the same samples.

use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use crate::install::checked;
use crate::{Board, Error, Options, Profile, Variant, Workspace, build, build_host, run};

/// How the program is compiled for the host: the name, the profile, and what is changed in it.
pub const HOST_BUILDS: [(&str, Profile, Variant); 3] = [
    ("host, dev", Profile::Dev, Variant::USUAL),
    (
        "host, firmware's profile",
        Profile::Firmware,
        Variant::USUAL,
    ),
    (
        "host, firmware's profile with checks",
        Profile::Firmware,
        Variant {
            name: "-checked",
            features: &[],
            config: &[
                "profile.firmware.overflow-checks=true",
                "profile.firmware.debug-assertions=true",
            ],
        },
    ),
];

/// The boards to compare: one of each processor with floating point.
pub const BOARDS: [Board; 3] = [Board::Mps2An386, Board::Mps2An500, Board::Mps2An505];

/// Boards whose processors have no floating point: soft float takes much longer.
pub const SOFT_FLOAT_BOARDS: [Board; 2] = [Board::Mps2An385, Board::Microbit];

/// The hashes of so many samples on this machine, a line each, as of `golden SAMPLES`.
///
/// # Errors
/// The program does not build or does not run.
pub fn on_host(
    workspace: &Workspace,
    profile: Profile,
    variant: &Variant,
    samples: u32,
) -> Result<Vec<String>, Error> {
    let program = build_host(workspace, "golden", profile, variant)?;
    let output = checked(Command::new(program).arg(samples.to_string()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().map(str::to_owned).collect())
}

/// The longest that a sample may take in QEMU, in soft float on a busy machine.
const TIME_PER_SAMPLE: Duration = Duration::from_micros(300);

/// The same on a board's machine in QEMU.
///
/// # Errors
/// The image does not build or does not run to its end.
pub fn on_target(workspace: &Workspace, board: Board, samples: u32) -> Result<Vec<String>, Error> {
    let image = build(workspace, board, "golden", None)?;
    let options = Options {
        time_limit: Duration::from_secs(60) + TIME_PER_SAMPLE * samples,
        ..Options::default()
    };
    let run = run(&image, board, &[&samples.to_string()], &options)?;
    if !run.succeeded() {
        let reason = format!("it ended with {} and logged {:?}", run.exit_code, run.log);
        return Err(Error::image(&image, reason));
    }
    let lines = run.log.into_iter();
    Ok(lines.filter(|line| line.starts_with("golden ")).collect())
}

/// Compares hashes with the committed ones, of which there may be more, and returns what differs:
/// a line that was made and the line that was expected in its place.
///
/// # Errors
/// The file of the committed hashes cannot be read.
pub fn check(workspace: &Workspace, lines: &[String]) -> Result<Option<[String; 2]>, Error> {
    let path = expected_path(workspace);
    let expected = fs::read_to_string(&path).map_err(Error::file(&path))?;
    Ok(first_difference(lines, &expected))
}

/// Makes these hashes the ones to be committed.
///
/// # Errors
/// Their file cannot be written.
pub fn bless(workspace: &Workspace, lines: &[String]) -> Result<(), Error> {
    let path = expected_path(workspace);
    fs::write(&path, lines.join("\n") + "\n").map_err(Error::file(&path))
}

fn first_difference(lines: &[String], expected: &str) -> Option<[String; 2]> {
    let mut expected = expected.lines();
    lines.iter().find_map(|line| {
        let expected = expected.next().unwrap_or("nothing");
        (line != expected).then(|| [line.clone(), expected.to_owned()])
    })
}

fn expected_path(workspace: &Workspace) -> PathBuf {
    workspace
        .root()
        .join("firmware/test-images/tests/golden.txt")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_lines_may_be_compared_but_not_more_or_others() {
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let expected = "golden 0 aa\ngolden 1 bb\n";
        assert_eq!(first_difference(&lines("golden 0 aa"), expected), None);
        assert_eq!(first_difference(&lines(expected), expected), None);
        let [made, wanted] =
            first_difference(&lines("golden 0 aa\ngolden 1 bc"), expected).unwrap();
        assert_eq!(
            (made.as_str(), wanted.as_str()),
            ("golden 1 bc", "golden 1 bb")
        );
        assert!(first_difference(&lines("golden 0 aa\ngolden 1 bb\nx"), expected).is_some());
    }
}
