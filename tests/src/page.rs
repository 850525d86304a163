//! Pages of the guide as a reader follows them: files are written, commands are run, in order.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempco_qemu::checked;

use crate::tempco_path;

/// The blocks of a page, each with its language.
pub fn blocks(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("\n```").skip(1).step_by(2);
    parts.filter_map(|part| part.split_once('\n')).collect()
}

/// The path of the file that a block shows: the comment in its first line, of one word.
pub fn file_name(block: &str) -> Option<&str> {
    let first = block.lines().next()?;
    let comments = ["# ", "// ", "/* "].iter();
    let name = comments.filter_map(|comment| first.strip_prefix(comment));
    let name = name.map(|name| name.trim_end_matches(" */")).next()?;
    (!name.contains(' ')).then_some(name)
}

/// Runs lines of a shell with the `tempco` command at hand; returns what they say.
///
/// # Panics
/// If a line fails.
pub fn shell(folder: &Path, script: &str, environment: &[(&str, &str)]) -> String {
    let path = std::env::var("PATH").expect("a path");
    let command = tempco_path().parent().expect("a folder").display();
    let mut shell = Command::new("sh");
    shell
        .args(["-e", "-c", script])
        .current_dir(folder)
        .envs(environment.iter().copied())
        .env("PATH", format!("{command}:{path}"));
    let output = checked(&mut shell).unwrap_or_else(|error| panic!("{script}\n{error}"));
    String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned()
}

/// Follows a page in a folder: writes the files that it shows and runs its blocks `sh` and
/// `console`; returns what they say.
///
/// # Panics
/// If a command fails.
pub fn follow(page: &str, folder: &Path, environment: &[(&str, &str)]) -> String {
    let mut said = String::new();
    for (language, block) in blocks(page) {
        match language {
            "sh" => said += &shell(folder, block, environment),
            "console" => {
                for line in block.lines().filter_map(|line| line.strip_prefix("$ ")) {
                    said += &shell(folder, line, environment);
                }
            }
            _ => {
                let Some(name) = file_name(block) else {
                    continue;
                };
                let path = folder.join(name);
                fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
                fs::write(path, block).expect("a file");
            }
        }
    }
    said
}
