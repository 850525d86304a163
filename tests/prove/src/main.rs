//! `tempco-prove`: what `cargo xtask prove` runs.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use tempco_prove::report::{Effort, Totals, prove};
use tempco_prove::smt::Solver;
use tempco_prove::{exhaustive, gappa};
use tempco_set::{TableData, load_set};

#[allow(dead_code, missing_docs, unreachable_pub, reason = "a generated table")]
mod example {
    include!("../../../firmware/tables/example.rs");
}

/// Prove properties of the core's compiled code, and bound its rounding
#[derive(Parser)]
struct Args {
    /// LLVM IR of the shims
    #[arg(long)]
    ir: PathBuf,
    /// Where queries, scripts and solvers are kept
    #[arg(long)]
    folder: PathBuf,
    /// Coefficient set whose tables are examined; the example table without one
    #[arg(long)]
    set: Option<PathBuf>,
    /// Only this function: place, bias, interval, update, play or second_lag; of the
    /// sample half publish, take_over, advance, correct, correct_block, status, pulses,
    /// pulse_status, pulse_ramp or of_raw
    #[arg(long)]
    only: Option<String>,
    /// Time limit of a query \[s\]
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// Also check every claim against seeded bugs
    #[arg(long)]
    mutants: bool,
    /// Also pass all 2^32 temperatures through the tables
    #[arg(long)]
    exhaustive: bool,
}

fn main() -> Result<()> {
    let args = Args::parse();
    std::fs::create_dir_all(&args.folder)?;
    let tables = match &args.set {
        Some(path) => {
            let set = load_set(path)?;
            set.channels
                .into_iter()
                .map(|channel| channel.table)
                .collect()
        }
        None => vec![example_table()?],
    };
    let mut skipped = Vec::new();
    for table in &tables {
        rounding(table, &args, &mut skipped)?;
    }
    match Solver::both(&args.folder) {
        Err(error) => skipped.push(format!("proofs on LLVM IR: {error:#}")),
        Ok(solvers) => {
            let effort = Effort {
                limit_s: args.limit,
                mutants: args.mutants,
                only: args.only.as_deref(),
            };
            let totals = prove(&args.ir, &solvers, &args.folder, effort)?;
            conclude(&totals, &args);
        }
    }
    for what in &skipped {
        println!("\nSKIPPED: {what}");
    }
    Ok(())
}

fn conclude(totals: &Totals, args: &Args) {
    println!(
        "\n{} claims proved by two solvers, {} by one, {} open",
        totals.by_two, totals.by_one, totals.open
    );
    if args.mutants {
        println!(
            "{} seeded bugs refuted, {} survive all claims, {} undecided",
            totals.killed, totals.survived, totals.undecided
        );
    }
    println!(
        "Of the compiler's LLVM IR; trusts the translator, the stated preconditions and the backend."
    );
}

/// The firmware's default table as data.
fn example_table() -> Result<TableData> {
    let table = &example::TABLES[0];
    let data = TableData {
        thermal: *table.thermal().settings(),
        first_edge_c: table.t_min_c(),
        last_edge_c: table.t_max_c(),
        t_min_c: table.t_min_c(),
        t_max_c: table.t_max_c(),
        cells: table.cells().iter().map(|cell| cell.to_vec()).collect(),
        play_gains: vec![[0.0; tempco::PLAYS]; example::AXES],
    };
    let terms = data.terms::<{ example::AXES }>(0);
    ensure!(
        data.table_over(0, &terms)? == *table,
        "the example's edges are elsewhere"
    );
    Ok(data)
}

fn rounding(table: &TableData, args: &Args, skipped: &mut Vec<String>) -> Result<()> {
    let has_gappa = has_gappa();
    if !has_gappa {
        skipped.push("Gappa's bounds: apt-get install gappa".to_owned());
    }
    println!(
        "rounding of the table ({} cells): bound by running error analysis",
        table.cells.len()
    );
    let axes = table.cells.first().context("a table without cells")?.len();
    for axis in 0..axes {
        let ours = table.rounding_bound(axis);
        println!(
            "  axis {axis}: {:.3e} in all; polynomial {:.3e}, place {:.3e} cells, edges {:.1e} degC",
            ours.total, ours.evaluation, ours.place, ours.edge_c
        );
        if has_gappa {
            let found = gappa::bounds(table, axis, &args.folder)?;
            println!(
                "          Gappa: polynomial {:.3e} ({:.2} of ours), place {:.3e} ({:.2})",
                found.evaluation,
                found.evaluation / ours.evaluation,
                found.place,
                found.place / ours.place
            );
            ensure!(
                found.evaluation <= ours.evaluation && found.place <= ours.place,
                "Gappa does not confirm the bound"
            );
        }
        if args.exhaustive {
            let start = std::time::Instant::now();
            let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
            let worst = exhaustive::check(table, axis, threads)?;
            println!(
                "          all 2^32 temperatures, {} in range, 3 rates: bias within {:.3e}, \
                 place within {:.3e} ({:.0} s)",
                worst.inside,
                worst.bias,
                worst.place,
                start.elapsed().as_secs_f64()
            );
        }
    }
    if has_gappa {
        generic(&args.folder, skipped)?;
    }
    Ok(())
}

fn generic(folder: &Path, skipped: &mut Vec<String>) -> Result<()> {
    let by_coq = gappa::prove_generic(folder)?;
    println!(
        "  any table: {} 2^-24 of the power of two at or above the largest |a| and |r| |T'|, by \
         Gappa{}",
        gappa::GENERIC_UNITS,
        if by_coq {
            "; its proof is accepted by Coq"
        } else {
            ""
        }
    );
    if !by_coq {
        skipped.push("Coq's check of Gappa's proof: apt-get install coq libcoq-gappa".to_owned());
    }
    Ok(())
}

fn has_gappa() -> bool {
    Command::new("gappa").arg("--version").output().is_ok()
}
