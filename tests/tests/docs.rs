//! What the documents show is run: every `$ tempco` line of a `console` block, in order, in one
//! folder per document, where every `toml` block that begins with `# NAME.toml` is a file.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempco_link::Fault;
use tempco_tests::{Bench, root, tempco_path};

/// Splits a line as a shell does, for words and double quotes.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for character in line.chars() {
        match character {
            '"' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            _ => words.last_mut().unwrap().push(character),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn commands(document: &str) -> Vec<Vec<String>> {
    let mut in_console = false;
    let mut commands = Vec::new();
    for line in document.lines() {
        match line.strip_prefix("```") {
            Some(language) => in_console = language == "console",
            None if in_console => commands.extend(line.strip_prefix("$ ").map(words)),
            None => {}
        }
    }
    commands
}

/// Writes the files that the document shows.
fn write_files(document: &str, bench: &Bench) {
    for block in document.split("```toml\n# ").skip(1) {
        let (name, rest) = block.split_once('\n').unwrap();
        let contents = rest.split("```").next().unwrap();
        bench.write(name, contents);
    }
}

fn run_all(path: &Path) -> usize {
    let bench = Bench::new();
    let document = fs::read_to_string(path).unwrap();
    write_files(&document, &bench);
    let commands = commands(&document);
    for command in &commands {
        assert_eq!(command[0], "tempco", "{command:?}");
        let output = Command::new(tempco_path())
            .current_dir(bench.path("."))
            .args(&command[1..])
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{}: {}\n{}{}",
            path.display(),
            command.join(" "),
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
    }
    commands.len()
}

#[test]
fn every_command_in_the_documents_works() {
    let mut count = run_all(&root().join("README.md"));
    assert!(count >= 7, "the commands of the README are not recognised");
    for entry in fs::read_dir(root().join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "md") {
            count += run_all(&path);
        }
    }
    println!("{count} commands run");
}

/// The guide's table of faults is the firmware's list, in its order.
#[test]
fn the_guide_has_every_fault_with_its_class() {
    let guide = fs::read_to_string(root().join("docs/unit.md")).unwrap();
    let table = guide.split("| fault | class |").nth(1).unwrap();
    let rows = table.lines().skip(2).take_while(|line| !line.is_empty());
    let found: Vec<(&str, &str)> = rows
        .map(|row| {
            let mut cells = row.split('|').map(str::trim).skip(1);
            (cells.next().unwrap(), cells.next().unwrap())
        })
        .collect();
    let expected: Vec<(&str, &str)> = Fault::ALL
        .iter()
        .map(|fault| {
            let is_invalid = fault.is_invalidating();
            (
                fault.name(),
                if is_invalid { "invalid" } else { "degraded" },
            )
        })
        .collect();
    assert_eq!(found, expected);
}
