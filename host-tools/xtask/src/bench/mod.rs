//! The performance figures: exact on the target, indicative on the host.

mod cycles_m7;
mod host;
mod log;
mod peers;
mod reference;
mod watch;

use std::time::Duration;

use anyhow::{Result, ensure};
use clap::ValueEnum;
use serde_json::{Map, Value, json};
use tempco_elf::{Function, Image};
use tempco_qemu::{
    Board, Options, Variant, Workspace, build, build_variant, code, ensure_qemu, ensure_target,
    run as run_image,
};

/// The longest that the image may run, on a busy machine.
const TIME_LIMIT: Duration = Duration::from_secs(600);

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Print one JSON object as the last line
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    host: host::HostArgs,
    /// What to measure; both, if not said
    #[arg(value_enum)]
    only: Option<Side>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Side {
    /// Executed instructions in QEMU
    Target,
    /// Rows per second on this machine, next to pandas, polars and DuckDB with numpy
    Host,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    let mut result = Map::new();
    if args.only != Some(Side::Host) {
        result.insert("target".to_owned(), target(&workspace)?);
    }
    if args.only != Some(Side::Target) {
        result.insert("host".to_owned(), host::figures(&workspace, &args.host)?);
    }
    if args.json {
        println!("{}", Value::Object(result));
    }
    Ok(())
}

/// Instructions per call over a sweep of temperatures and special values, counted by QEMU.
fn target(workspace: &Workspace) -> Result<Value> {
    ensure_target(workspace)?;
    ensure_qemu(workspace)?;
    let board = Board::Mps2An386;
    let variant = reference::variant(workspace);
    let image = build_variant(workspace, board, "bench", None, &variant)?;
    let options = Options {
        icount: true,
        time_limit: TIME_LIMIT,
        ..Options::default()
    };
    let run = run_image(&image, board, &[], &options)?;
    ensure!(run.succeeded(), "the bench image failed: {:?}", run.log);

    // The image prints a line for each function and size.
    let mut figures = Map::new();
    let mut baselines = Map::new();
    let mut sizes = Map::new();
    let elf = Image::read(&image)?;
    let kernel = |name: &str| elf.named(&format!("kernels::{name}"));
    // The image counts what a function has beyond an empty one.
    let empty = kernel("empty")?.price()?.instructions;
    println!("{board}, per call for three axes     instructions (least, most), M4 cycles");
    for line in &run.log {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["bench", name, least, most] => {
                let (least, most): (u32, u32) =
                    (least.parse::<u32>()? + empty, most.parse::<u32>()? + empty);
                let function = name.strip_suffix("_baseline").unwrap_or(name);
                let mut figure = json!({ "instructions": [least, most] });
                let mut cycles = String::new();
                if least == most
                    && let Ok(price) = kernel(function).and_then(Function::price)
                {
                    ensure!(
                        price.instructions == most,
                        "{name}: {price:?}, {most} executed"
                    );
                    cycles = price.cycles.to_string();
                    figure["cycles_m4"] = json!(price.cycles);
                }
                println!("  {name:24} {least:>8} {most:>8} {cycles:>8}");
                if name == "block8" {
                    figures.insert("block8_per_sample".to_owned(), share(&figure, 8.0));
                }
                match name.strip_suffix("_baseline") {
                    Some(name) => baselines.insert(name.to_owned(), figure),
                    None => figures.insert(name.to_owned(), figure),
                };
            }
            ["size", name, bytes] => {
                println!("  {name:24} {bytes:>8} bytes");
                sizes.insert(name.to_owned(), json!(bytes.parse::<u32>()?));
            }
            _ => {}
        }
    }
    ensure!(
        figures.contains_key("step"),
        "the bench image measured nothing"
    );
    // Cycles of an M7 come from a model of that processor, over its own code.
    let code_bytes = kernel("step")?.size;
    println!("  {:24} {code_bytes:>8} bytes", "code of step");
    let m7 = build(workspace, Board::Mps2An500, "bench", None)?;
    for name in ["step", "thermal", "subtract", "block8"] {
        if let Some(cycles) = cycles_m7::cycles(&code(&m7, &["kernels", name])?)? {
            println!("  {name:24} {cycles:>8} cycles on an M7, by llvm-mca");
            figures[name]["cycles_m7"] = json!(cycles);
        }
    }
    if variant != Variant::USUAL {
        let compared = reference::figures(&image, &elf, board, &run.log)?;
        figures.insert("c_same_behaviour".to_owned(), compared);
    }
    figures.insert("code_bytes".to_owned(), json!(code_bytes));
    figures.insert("state_bytes".to_owned(), sizes["compensator"].clone());
    figures.insert("baselines".to_owned(), Value::Object(baselines));
    figures.insert("sizes".to_owned(), Value::Object(sizes));
    Ok(Value::Object(figures))
}

/// A figure of a call for each of its samples.
fn share(figure: &Value, samples: f64) -> Value {
    match figure {
        Value::Number(number) => json!(number.as_f64().unwrap_or(f64::NAN) / samples),
        Value::Array(values) => values.iter().map(|value| share(value, samples)).collect(),
        Value::Object(map) => map
            .iter()
            .map(|(key, value)| (key.clone(), share(value, samples)))
            .collect(),
        other => other.clone(),
    }
}
