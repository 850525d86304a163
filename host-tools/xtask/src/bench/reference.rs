//! The core next to C of the same behaviour, in the same image: all outputs, and the instructions.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Map, Value, json};
use tempco_elf::{CallGraph, Image, Instruction, Price, price};
use tempco_qemu::{Board, Options, Variant, Workspace, ensure_program, run};

use super::{TIME_LIMIT, share};

/// The image with the C in it.
const WITH_C: Variant = Variant {
    name: "c",
    features: &["c-reference"],
    config: &[],
};

/// Hostile updates over which all outputs are compared, for each of two tables.
const UPDATES: u32 = 1_000_000;

/// The compilations, by how the names of their functions begin.
const COMPILED: [&str; 2] = ["c_o2_", "c_o3_"];

/// The functions that are measured.
const KERNELS: [&str; 3] = ["thermal", "subtract", "block8"];

/// The image with the C, where its compiler can be had; else, said aloud, the one without.
pub(super) fn variant(workspace: &Workspace) -> Variant {
    match ensure_program(workspace, "arm-none-eabi-gcc", &["gcc-arm-none-eabi"]) {
        Ok(()) => WITH_C,
        Err(error) => {
            println!(
                "  skipped: C of the same behaviour is neither compared nor measured: {error}"
            );
            Variant::USUAL
        }
    }
}

/// Compares all outputs, and returns the figures of the faster compilation of each function. `log` is
/// what the image logged as it measured.
///
/// # Errors
/// The first output that differs, among others.
pub(super) fn figures(image: &Path, elf: &Image, board: Board, log: &[String]) -> Result<Value> {
    let in_time = Options {
        time_limit: TIME_LIMIT,
        ..Options::default()
    };
    let compared = run(image, board, &["compare", &UPDATES.to_string()], &in_time)?;
    ensure!(
        compared.succeeded(),
        "the C and the core differ: {:?}",
        compared.log
    );
    println!(
        "  C of the same behaviour: every output bit is the core's, {UPDATES} updates, two tables"
    );

    let mut figures = Map::new();
    for compiled in COMPILED {
        let traced = trace(image, elf, board, compiled)?;
        for (name, prices) in KERNELS.iter().zip(traced) {
            let counted = counted(log, compiled, name)?;
            let instructions = || prices.iter().map(|price| price.instructions);
            let found = [instructions().min(), instructions().max()];
            ensure!(
                found == counted.map(Some),
                "{compiled}{name}: {found:?} traced, {counted:?} counted"
            );
            let cycles = prices.iter().map(|price| price.cycles).max();
            let cycles = cycles.context("nothing traced")?;
            let [least, most] = counted;
            let function = format!("{compiled}{name}");
            println!("  {function:24} {least:>8} {most:>8} {cycles:>8}");
            let figure = json!({"instructions": counted, "cycles_m4": cycles});
            let (key, figure) = match *name {
                "block8" => ("block8_per_sample", share(&figure, 8.0)),
                name => (name, figure),
            };
            // The faster one stays.
            let most = |figure: &Value| figure["instructions"][1].as_f64();
            if figures
                .get(key)
                .is_none_or(|former| most(&figure) < most(former))
            {
                figures.insert(key.to_owned(), figure);
            }
        }
    }
    Ok(Value::Object(figures))
}

/// Least and most instructions of a function as the image counted them, with its return.
fn counted(log: &[String], compiled: &str, name: &str) -> Result<[u32; 2]> {
    let wanted = ["c", compiled, name];
    let words = log.iter().map(|line| line.split(' ').collect::<Vec<_>>());
    let mut of_function = words.filter(|words| words.starts_with(&wanted));
    let line = of_function.next().context("the C was not measured")?;
    let [_, _, _, least, most] = line[..] else {
        bail!("not a measurement: {line:?}");
    };
    // The image counts what a function has beyond an empty one, which only returns.
    Ok([least.parse::<u32>()? + 1, most.parse::<u32>()? + 1])
}

/// What each call of each of the [`KERNELS`] costs, in the states that the image measures.
fn trace(image: &Path, elf: &Image, board: Board, compiled: &str) -> Result<[Vec<Price>; 3]> {
    let mut entries = Vec::new();
    let mut ranges = Vec::new();
    let mut instructions = BTreeMap::new();
    for name in KERNELS {
        let entry = elf.named(&format!("{compiled}{name}"))?.address;
        entries.push(entry);
        for function in CallGraph::from(elf, entry, |_| false)?.functions() {
            ranges.push(function.address..function.address + function.size);
            let found = function.instructions.iter();
            instructions.extend(found.map(|instruction| (instruction.address, instruction)));
        }
    }
    let options = Options {
        time_limit: TIME_LIMIT,
        trace: ranges,
        ..Options::default()
    };
    let run = run(image, board, &["trace", compiled], &options)?;
    ensure!(run.succeeded(), "no trace: {:?}", run.log);

    // A call begins at the entry of its function.
    let mut prices = [const { Vec::new() }; 3];
    let executed = run.executed();
    let is_entry = |address: &u64| entries.contains(address);
    for call in executed.chunk_by(|_, next| !is_entry(next)) {
        let kernel = entries.iter().position(|entry| *entry == call[0]);
        let kernel = kernel.context("code that nobody called")?;
        let call: Option<Vec<&Instruction>> = call
            .iter()
            .map(|address| instructions.get(address).copied())
            .collect();
        prices[kernel].push(price(
            call.context("an instruction that is not in the image")?,
        ));
    }
    Ok(prices)
}
