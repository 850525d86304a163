//! Golden vectors on every host build and every processor.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use tempco_qemu::golden::{
    BOARDS, HOST_BUILDS, SOFT_FLOAT_BOARDS, bless, check, on_host, on_target,
};
use tempco_qemu::{Workspace, ensure_qemu, ensure_target_of};

/// Set to 1, the hashes of the host's dev build are committed.
const BLESS: &str = "TEMPCO_BLESS";

const MILLION: u32 = 1_000_000;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Millions of samples
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=4000))]
    millions: u32,
    /// Millions of samples in soft float, which takes much longer
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4000))]
    soft_float_millions: u32,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    ensure_qemu(&workspace)?;
    for board in BOARDS.into_iter().chain(SOFT_FLOAT_BOARDS) {
        ensure_target_of(&workspace, board)?;
    }
    println!("the hash is of all output bits");
    println!(
        "{:32} {:>8} {:>18} {:>8}  equal",
        "on", "millions", "hash", "time"
    );
    let mut blesses = std::env::var_os(BLESS).is_some_and(|value| value == "1");
    let (mut compared, mut differ) = (0, 0);
    for (name, profile, variant) in HOST_BUILDS {
        let start = Instant::now();
        let lines = on_host(&workspace, profile, &variant, args.millions * MILLION)?;
        if std::mem::take(&mut blesses) {
            bless(&workspace, &lines)?;
        }
        compared += 1;
        differ += show(&workspace, name, &lines, start, args.millions)?;
    }
    let in_hardware = BOARDS.map(|board| (board, args.millions));
    let in_software = SOFT_FLOAT_BOARDS.map(|board| (board, args.soft_float_millions));
    for (board, millions) in in_hardware.into_iter().chain(in_software) {
        let start = Instant::now();
        let lines = on_target(&workspace, board, millions * MILLION)?;
        let name = format!("{board} ({}), QEMU", board.cpu());
        compared += 1;
        differ += show(&workspace, &name, &lines, start, millions)?;
    }
    ensure!(differ == 0, "{differ} of {compared} differ");
    println!("all equal, bit for bit");
    Ok(())
}

/// Shows the last hash and whether all are as they should be; 1 if not. The time is with building.
fn show(
    workspace: &Workspace,
    name: &str,
    lines: &[String],
    start: Instant,
    millions: u32,
) -> Result<u32> {
    ensure!(
        lines.len() == millions as usize + 1,
        "{name} made {} hashes for {millions} million samples",
        lines.len()
    );
    let last = lines.last().and_then(|line| line.split(' ').nth(2));
    let hash = last.with_context(|| format!("{name} made no hash"))?;
    let difference = check(workspace, lines)?;
    let seconds = start.elapsed().as_secs_f64();
    match &difference {
        None => println!("{name:32} {millions:>8} {hash:>18} {seconds:>6.1} s  yes"),
        Some([made, expected]) => {
            println!(
                "{name:32} {millions:>8} {hash:>18} {seconds:>6.1} s  NO: `{made}`, not `{expected}`"
            );
        }
    }
    Ok(u32::from(difference.is_some()))
}
