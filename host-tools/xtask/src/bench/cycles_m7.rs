//! Cycles of a straight-line function on a Cortex-M7, by LLVM's machine code analyser.
//!
//! Its model of the M7 issues two instructions at a time and knows latencies, but no caches or
//! wait states: the figure is for code and data in tightly coupled memory.

use std::io::Write;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

const TARGET: &str = "thumbv7em-none-eabihf";
const PROCESSOR: &str = "-mcpu=cortex-m7";

/// Cycles of one call of the function with this code; `None`, said aloud, without the tools.
pub(super) fn cycles(code: &[u8]) -> Result<Option<u32>> {
    let hexadecimal: String = code.iter().map(|byte| format!("{byte:#04x} ")).collect();
    let disassembly = ["--disassemble", "--triple", TARGET, PROCESSOR];
    let Some(assembly) = pipe("llvm-mc", &disassembly, &hexadecimal)? else {
        println!("  skipped: cycles on an M7 need llvm-mc and llvm-mca (apt-get install llvm)");
        return Ok(None);
    };
    let body = body(&assembly);
    let analysis = ["-iterations=1", "-mtriple", TARGET, PROCESSOR];
    let Some(report) = pipe("llvm-mca", &analysis, &body)? else {
        return Ok(None);
    };
    let line = report
        .lines()
        .find_map(|line| line.strip_prefix("Total Cycles:"));
    Ok(Some(
        line.context("llvm-mca says nothing of cycles")?
            .trim()
            .parse()?,
    ))
}

/// The instructions up to the return, behind which lie constants. The analyser knows no IT blocks:
/// what is in one is taken to be executed, as the processor takes it through its pipeline.
fn body(assembly: &str) -> String {
    let mut body = String::new();
    let mut conditional = 0;
    for line in assembly.lines().map(str::trim) {
        let (mnemonic, operands) = line.split_once('\t').unwrap_or((line, ""));
        if line.starts_with('.') {
            continue;
        }
        if let Some(pattern) = mnemonic.strip_prefix("it") {
            conditional = pattern.len() + 1;
            continue;
        }
        let (name, suffix) = mnemonic.split_at(mnemonic.find('.').unwrap_or(mnemonic.len()));
        let name = match conditional {
            0 => name,
            _ => &name[..name.len() - 2],
        };
        conditional = conditional.saturating_sub(1);
        body.push_str(&format!("{name}{suffix}\t{operands}\n"));
        if operands.contains("pc}") || line == "bx\tlr" {
            break;
        }
    }
    body
}

/// Runs a program over a text; `None` where there is no such program.
fn pipe(program: &str, args: &[&str], input: &str) -> Result<Option<String>> {
    let child = Command::new(program)
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn();
    let Ok(mut child) = child else {
        return Ok(None);
    };
    let mut stdin = child.stdin.take().context("no input")?;
    stdin.write_all(input.as_bytes())?;
    drop(stdin);
    let output = child.wait_with_output()?;
    ensure!(output.status.success(), "{program} failed");
    Ok(Some(String::from_utf8(output.stdout)?))
}

#[cfg(test)]
mod tests {
    use super::body;

    #[test]
    fn predicates_are_taken_off_and_constants_left_out() {
        let assembly = "\t.text\n\tvcmp.f32\ts0, s1\n\tite\tpl\n\tvmovpl.f32\ts0, s2\n\
            \tmovmi\tr0, r1\n\tmovs\tr2, #1\n\tpop\t{r4, pc}\n\tlsls\tr0, r0, #1\n";
        let expected = "vcmp.f32\ts0, s1\nvmov.f32\ts0, s2\nmov\tr0, r1\n\
            movs\tr2, #1\npop\t{r4, pc}\n";
        assert_eq!(body(assembly), expected);
    }
}
