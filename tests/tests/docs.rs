//! What the documents show is run: every `$ tempco` line of a `console` block, in order, in one
//! folder per document, where every `toml` block that begins with `# NAME.toml` is a file. A line
//! with `# rejected` behind it must end with exit code 1, every other line with 0. A line with `&`
//! behind it runs on until `$ kill %1`, as in a shell; the next line waits for what it prints first.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tempco_link::Fault;
use tempco_log::parallel;
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

/// A command that runs on.
struct Job(Child);

impl Job {
    fn start(command: &mut Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut first = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut first).unwrap();
        assert!(!first.is_empty(), "{command:?} ended");
        Self(child)
    }
}

/// As `kill` does, so that it can clean up; also where a test fails.
impl Drop for Job {
    fn drop(&mut self) {
        let id = self.0.id().to_string();
        Command::new("kill").arg(id).status().unwrap();
        self.0.wait().unwrap();
    }
}

fn run_all(path: &Path) -> usize {
    let bench = Bench::new();
    let document = fs::read_to_string(path).unwrap();
    write_files(&document, &bench);
    let commands = commands(&document);
    let mut job = None;
    for words in &commands {
        if *words == ["kill", "%1"] {
            assert!(job.take().is_some(), "{}: no job", path.display());
            continue;
        }
        assert_eq!(words[0], "tempco", "{words:?}");
        let end = words.iter().position(|word| word == "#" || word == "&");
        let (args, rest) = words[1..].split_at(end.unwrap_or(words.len()) - 1);
        let mut command = Command::new(tempco_path());
        command.current_dir(bench.path(".")).args(args);
        if rest.iter().any(|word| word == "&") {
            job = Some(Job::start(&mut command));
            continue;
        }
        let expected = i32::from(rest.iter().any(|word| word == "rejected"));
        let output = command.output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(expected),
            "{}: {}\n{}{}",
            path.display(),
            words.join(" "),
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
        let last = output
            .stdout
            .trim_ascii_end()
            .rsplit(|byte| *byte == b'\n')
            .next();
        if args[0] == "replay" {
            assert!(last.unwrap().starts_with(b"0 of "), "{}", words.join(" "));
        }
    }
    commands.len()
}

#[test]
fn every_command_in_the_documents_works() {
    // Those that take longest first.
    let mut pages = vec![root().join("docs/first-table.md"), root().join("README.md")];
    for entry in fs::read_dir(root().join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "md") && !pages.contains(&path) {
            pages.push(path);
        }
    }
    let counts = parallel::map(&pages, |page| run_all(page));
    assert!(
        counts[1] >= 6,
        "the commands of the README are not recognised"
    );
    let count: usize = counts.iter().sum();
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

/// The numbers in the row of a table of figures that begins with some words.
fn committed(name: &str, row: &str) -> Vec<f64> {
    let table = fs::read_to_string(root().join("firmware/tests").join(name)).unwrap();
    let numbers = table.lines().find_map(|line| line.strip_prefix(row));
    let numbers = numbers.unwrap().split_whitespace();
    numbers.map(|number| number.parse().unwrap()).collect()
}

/// What the pages say of the unit's load, latency and memory is what was measured, rounded.
#[test]
fn the_figures_of_the_unit_are_those_measured() {
    let [load, latency, stack] = committed("load.txt", "unit ")[..] else {
        panic!("columns of load.txt")
    };
    let [text, rodata, data, bss] = committed("sizes.txt", "unit mps2-an386 ")[..] else {
        panic!("columns of sizes.txt")
    };
    let other: f64 = committed("sizes.txt", "unit stm32f405 ")[..3].iter().sum();
    let [slow, fast] = ["2000 ", "8000 "].map(|row| committed("fifo.txt", row)[0]);
    let kilo = |bytes: f64| format!("{:.0}", bytes / 1000.0);
    let (variables, program) = (kilo(data + bss), kilo(text + rodata + data));
    let (ram, stack_kb) = (kilo(data + bss + stack), format!("{:.1}", stack / 1000.0));
    // At 168 MHz, 2 kHz and 1.5 cycles per instruction.
    let percent = 100.0 * load * 1.5 * 2000.0 / 168e6;
    let latency_us = latency * 1.5 / 168.0;
    for (page, sentences) in [
        (
            "docs/port-in-an-hour.md",
            vec![
                format!("About {ram} kB of RAM (variables {variables} kB, stack {stack_kb} kB)"),
                format!("{program} to {} kB of flash for the program", kilo(other)),
                format!("{load} instructions per sample and {latency} from interrupt to output"),
                format!("a load of {percent:.1} % and {latency_us:.1} us"),
                format!("{stack_kb} kB at most on mps2-an386, variables {variables} kB"),
            ],
        ),
        (
            "docs/unit.md",
            vec![
                format!("| interrupt to output, worst, one channel of three axes | {latency} |"),
                format!("while nobody talks to it | {load} |"),
                format!(
                    "{load} instructions per sample are {:.1} million",
                    load * 2e-3
                ),
                format!("The stack takes {stack_kb} kB at most"),
                format!("code and constants {program} kB, variables {variables} kB"),
                format!("come over a bus: {slow} instructions at 2 kHz"),
            ],
        ),
        (
            "docs/performance.md",
            vec![
                format!("it takes {latency} instructions at worst"),
                format!("For all its work it takes {load} per sample"),
            ],
        ),
        (
            "docs/gyro-inputs.md",
            vec![
                format!("| 2 kHz, one by one | {slow} |"),
                format!("| 8 kHz, blocks of four | {fast} |"),
                format!("A counter takes {load}."),
            ],
        ),
        (
            "docs/claims.md",
            vec![
                format!("{load} and {latency} instructions, {stack_kb} kB"),
                format!("no sample lost; {slow} and {fast} instructions"),
            ],
        ),
    ] {
        let text = fs::read_to_string(root().join(page)).unwrap();
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for sentence in sentences {
            assert!(text.contains(&sentence), "{page}: {sentence}");
        }
    }
}
