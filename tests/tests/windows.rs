//! A command built for another system writes the same files as the one of this system.

use std::fs;
use std::process::Command;

use serde_json::Value;
use tempco_tests::{Bench, tempco, tempco_path};

const COMMANDS: [&str; 7] = [
    "simulate --unit paper --profile calibration --seed 1 --out cal.csv --truth truth.csv",
    "simulate --unit paper --profile verification --seed 2 --out ver.csv",
    "fit cal.csv --serial S1 --model composite --segments -15:15,5:35,25:60,50:80 --out composite",
    "fit cal.csv --serial S1 --model auto --out auto",
    "apply auto/coefficients.json ver.csv --out out.csv",
    "evaluate auto/coefficients.json ver.csv --json",
    "inspect auto/coefficients.json --json",
];

/// Texts and numbers in double precision that depend on a library of the system are not among
/// them: dates, sigmas.
const FILES: [&str; 6] = [
    "cal.csv",
    "truth.csv",
    "ver.csv",
    "composite/table.bin",
    "auto/table.bin",
    "out.csv",
];

fn run(mut command: Command, bench: &Bench, args: &str) -> String {
    let output = command
        .current_dir(bench.path(""))
        .args(args.split_whitespace())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let erred = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "tempco {args}\n{said}{erred}");
    said
}

#[test]
#[ignore = "run by `cargo xtask verify windows`"]
fn files_are_those_of_this_system() {
    let (here, there) = (Bench::new(), Bench::new());
    for args in COMMANDS {
        let own = run(Command::new(tempco_path()), &here, args);
        let other = run(tempco(), &there, args);
        if let Ok(own) = serde_json::from_str::<Value>(&own) {
            let other: Value = serde_json::from_str(&other).unwrap();
            println!("{args}: JSON equal: {}", own == other);
        }
    }
    for file in FILES {
        let [own, other] = [&here, &there].map(|bench| fs::read(bench.path(file)).unwrap());
        println!("{file}: {} bytes", own.len());
        assert!(own == other, "{file} differs");
    }
}
