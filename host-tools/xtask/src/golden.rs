//! Golden vectors on every host build and every processor.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use tempco_qemu::golden::{BOARDS, HOST_BUILDS, bless, check, on_host, on_target};
use tempco_qemu::{Workspace, ensure_qemu, ensure_target_of};

/// Set to 1, the committed hashes become those of the host's dev build.
const BLESS: &str = "TEMPCO_BLESS";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Millions of samples
    #[arg(long, default_value_t = 10)]
    millions: u32,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let workspace = Workspace::find()?;
    ensure_qemu(&workspace)?;
    for board in BOARDS {
        ensure_target_of(&workspace, board)?;
    }
    println!(
        "{} million samples each; the hash is of all output bits",
        args.millions
    );
    println!("{:32} {:>18} {:>8}  equal", "on", "hash", "time");
    let mut blesses = std::env::var_os(BLESS).is_some_and(|value| value == "1");
    let mut differ = 0;
    for (name, profile, variant) in HOST_BUILDS {
        let start = Instant::now();
        let lines = on_host(&workspace, profile, &variant, args.millions)?;
        if std::mem::take(&mut blesses) {
            bless(&workspace, &lines)?;
        }
        differ += show(&workspace, name, &lines, start, args.millions)?;
    }
    for board in BOARDS {
        let start = Instant::now();
        let lines = on_target(&workspace, board, args.millions)?;
        let name = format!("{board} ({}), QEMU", board.cpu());
        differ += show(&workspace, &name, &lines, start, args.millions)?;
    }
    ensure!(
        differ == 0,
        "{differ} of {} differ",
        HOST_BUILDS.len() + BOARDS.len()
    );
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
        None => println!("{name:32} {hash:>18} {seconds:>6.1} s  yes"),
        Some([made, expected]) => {
            println!("{name:32} {hash:>18} {seconds:>6.1} s  NO: `{made}`, not `{expected}`");
        }
    }
    Ok(u32::from(difference.is_some()))
}
