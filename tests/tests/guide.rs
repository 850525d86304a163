//! The figures of the calibration guide are computed again.

use std::fmt::Write as _;
use std::fs;

use tempco_log::parallel;
use tempco_tests::{Bench, root};

const BEGIN: &str = "<!-- plan -->\n";
const END: &str = "<!-- end of plan -->\n";
const HEAD: &str = "\
| profile | hours | composite x | y | z | auto x | y | z |
| --- | --- | --- | --- | --- | --- | --- | --- |
";
const RUNS: [&str; 5] = ["up_only", "static", "one_rate", "cycles", "calibration"];

/// Writes the profiles that the guide shows.
fn write_profiles(guide: &str, bench: &Bench) {
    for block in guide.split("```toml\n# ").skip(1) {
        let (name, rest) = block.split_once('\n').unwrap();
        bench.write(name, rest.split("```").next().unwrap());
    }
}

/// A row of the table: improvement of the 100 s means of each axis \[%\], by model.
fn row(run: &str, bench: &Bench) -> String {
    let file = format!("{run}.toml");
    let own = bench.path(&file).exists();
    let profile = if own { file } else { run.to_owned() };
    let log = format!("{run}.csv");
    bench.ok(&format!(
        "simulate --unit hysteretic --profile {profile} --seed 1 --out {log}"
    ));
    let text = fs::read_to_string(bench.path(&log)).unwrap();
    let last = text.lines().last().unwrap().split(',').next().unwrap();
    let hours = last.parse::<f64>().unwrap() / 3600.0;
    let mut row = format!("| `{run}` | {hours:.1} |");
    for model in ["composite", "auto"] {
        let set = format!("{run}_{model}");
        bench.ok(&format!(
            "fit {log} --serial PLAN --out {set} --model {model} --no-report"
        ));
        // Exit code 1 where compensation makes an axis worse.
        let judged = bench.run(&format!(
            "evaluate {set}/coefficients.json verification.csv --json"
        ));
        let json: serde_json::Value = serde_json::from_str(&judged.out).unwrap();
        for axis in json["axes"].as_array().unwrap() {
            let improvement = 100.0 * axis["improvement"].as_f64().unwrap();
            write!(row, " {improvement:.0} |").unwrap();
        }
    }
    row + "\n"
}

/// The words of a table and its numbers.
fn split(table: &str) -> (Vec<&str>, Vec<f64>) {
    let words = || table.split_whitespace();
    let is_number = |word: &&str| word.parse::<f64>().is_ok();
    (
        words().filter(|word| !is_number(word)).collect(),
        words().filter_map(|word| word.parse().ok()).collect(),
    )
}

/// Run with `TEMPCO_BLESS=1` to write the table again after a change of simulation or fit.
#[test]
fn the_table_of_profiles_is_what_the_commands_give() {
    let path = root().join("docs/calibration.md");
    let guide = fs::read_to_string(&path).unwrap();
    let bench = Bench::new();
    write_profiles(&guide, &bench);
    bench.ok("simulate --unit hysteretic --profile verification --seed 2 --out verification.csv");
    let rows = parallel::map(&RUNS, |run| row(run, &bench));
    let found = format!("{HEAD}{}", rows.concat());

    let (before, rest) = guide.split_once(BEGIN).unwrap();
    let (committed, after) = rest.split_once(END).unwrap();
    if std::env::var_os("TEMPCO_BLESS").is_some() {
        fs::write(&path, format!("{before}{BEGIN}{found}{END}{after}")).unwrap();
        return;
    }
    let ((words, numbers), (committed_words, committed_numbers)) =
        (split(&found), split(committed));
    assert_eq!(words, committed_words);
    assert_eq!(numbers.len(), 7 * RUNS.len());
    for (found, committed) in numbers.iter().zip(&committed_numbers) {
        // The last digit may depend on the processor.
        assert!(
            (found - committed).abs() <= 1.0,
            "{found} {committed}\n{rows:?}"
        );
    }
}
