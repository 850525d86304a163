//! The paper's calibration flow on the simulated unit, next to the printed tables.

mod flow;
mod printed;
mod show;

use anyhow::{Result, ensure};

/// Run the paper's flow and print its tables next to the printed ones
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Number of seeds; with more than one, mean and sample standard deviation are printed
    #[arg(long, default_value_t = 1)]
    seeds: u64,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    ensure!(args.seeds >= 1, "--seeds 0: expected 1 or more");
    let outcomes = (1..=args.seeds)
        .map(flow::run)
        .collect::<Result<Vec<_>>>()?;
    show::tables(&outcomes);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::flow;

    /// What the paper finds, as far as a simulated unit can show it.
    #[test]
    fn the_pattern_of_the_paper_is_found() {
        let outcome = flow::run(1).unwrap();
        for axis in 0..3 {
            let [without, with] = outcome.unseen[axis];
            assert!(with < 1.05 * without, "{axis}: {without} {with}");
            let [without, with] = outcome.jumps[axis];
            assert!(with < 0.7 * without, "{axis}: {without} {with}");
            // In the variable-temperature run the static model is about useless.
            let [raw, of_static, composite, auto] = outcome.table_3[axis];
            assert!((of_static / raw - 1.0).abs() < 0.2, "{axis}");
            assert!(composite < 0.75 * raw, "{axis}");
            assert!(auto < 1.02 * composite, "{axis}: {composite} {auto}");
        }
        let [raw, _, composite, _] = outcome.table_3[0];
        let improvement = 1.0 - composite / raw;
        assert!((0.55..0.75).contains(&improvement), "{improvement}");
    }
}
