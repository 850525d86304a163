//! The programs of the package run, and say what they must.

use std::fs;
use std::process::Command;

use tempco::{Corrector, Interval, RampBuffer, Status, ThermalHalf};
use tempco_tests::Bench;

use crate::figures::example;
use crate::support::{Build, POSIX_COMPILERS, arm_gcc, said};

const BLOCK: u16 = 8;
const BLOCKS_PER_UPDATE: u16 = 25;

/// What the unit of the example puts out after four seconds, by the core.
fn expected() -> String {
    let table = &example::TABLES[0];
    let interval = Interval::new(table.thermal(), 0.1);
    let temp_c = |update: u16| {
        let missing = if update % 10 == 9 { f32::NAN } else { 0.0 };
        24.5 + 0.002 * f32::from(update) + missing
    };
    let ramps = RampBuffer::new();
    let mut half = ThermalHalf::new(table, BLOCK * BLOCKS_PER_UPDATE);
    half.start(temp_c(0));
    let mut corrector = Corrector::new(&ramps);
    let mut block = [[0.0; 3]; BLOCK as usize];
    for update in 0..40 {
        ramps.publish(&half.update(&interval, temp_c(update)));
        for _ in 0..BLOCKS_PER_UPDATE {
            block = [[0.25, 0.5, 0.75]; BLOCK as usize];
            corrector.correct_block(&mut block);
        }
    }
    let bits = block[7].map(|value| format!("{:08x} ", value.to_bits()));
    let status = corrector.status();
    let flags = Status::NAMES
        .iter()
        .filter(|(flag, _)| status.contains(*flag));
    let flags: Vec<&str> = flags.map(|(_, name)| *name).collect();
    format!("x y z {}{}\n", bits.concat(), flags.join("+"))
}

#[test]
fn the_unit_without_an_operating_system_runs_in_c_and_in_cpp() {
    if let Some(compiler) = arm_gcc() {
        let unit = Build::new("unit").bare_metal();
        let unit = unit.source("crates/tempco-c/package/examples/bare-metal/main.c");
        for unit in [unit.clone(), unit.cpp()] {
            let program = unit.with(&compiler);
            let mut command = program.command();
            // Time by instructions: the interrupt comes at the same ones in every run.
            command.args(["-icount", "shift=5,sleep=off"]);
            assert_eq!(said(&mut command), expected());
        }
    }
}

/// The program in C writes the bytes of `tempco apply`, of a log with faults.
#[test]
fn apply_in_c_writes_the_bytes_of_tempco_apply() {
    let bench = Bench::new();
    bench.ok("simulate --unit fog --profile short --seed 5 --out log.csv");
    bench.ok("fit log.csv --serial F1 --model composite --segments 6:30,20:45 --out set");
    // A few readings that cannot be.
    let log = fs::read_to_string(bench.path("log.csv")).unwrap();
    let rows = log
        .lines()
        .enumerate()
        .map(|(number, line)| match number % 500 {
            499 => {
                let mut cells: Vec<&str> = line.split(',').collect();
                cells[1] = if number % 1000 == 999 {
                    "155.0"
                } else {
                    "61.25"
                };
                cells.join(",") + "\n"
            }
            _ => format!("{line}\n"),
        });
    bench.write("faults.csv", &rows.collect::<String>());
    bench.ok("apply set/table.bin faults.csv --out expected.csv");
    let expected = fs::read_to_string(bench.path("expected.csv")).unwrap();
    for flag in ["temperature_invalid", "temperature_spike", ",ok\n"] {
        assert!(expected.contains(flag), "{flag}");
    }
    let apply = Build::new("apply").source("crates/tempco-c/package/examples/apply/apply.c");
    for compiler in POSIX_COMPILERS {
        if !compiler.is_there() {
            println!("skipped: there is no {}", compiler.program);
            continue;
        }
        let program = apply.with(&compiler);
        let mut command = Command::new(&program.path);
        command.args([bench.path("set/table.bin"), bench.path("faults.csv")]);
        assert!(said(&mut command) == expected, "{}", compiler.program);
    }
}
