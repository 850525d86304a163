//! The table the firmware is built with by default, and the one of the examples in C, are one that
//! `tempco fit` writes.

use std::fs;
use std::path::Path;

use tempco_tests::{Bench, root};

/// The text between numbers, and the numbers.
fn split(text: &str) -> (Vec<String>, Vec<f64>) {
    let mut between = vec![String::new()];
    let mut numbers = Vec::new();
    for line in text
        .lines()
        .filter(|line| !line.contains("CRC") && !line.contains("TEMPCO_TABLE_"))
    {
        for word in line.split_inclusive([' ', '[', ']', ',', '{', '}', '(', ')', ';']) {
            let bare = word.trim_end_matches([' ', '[', ']', ',', '{', '}', '(', ')', ';']);
            // A float of C.
            let bare = bare.trim_end_matches('f');
            match bare.parse::<f64>() {
                Ok(number) => {
                    numbers.push(number);
                    between.push(word[bare.len()..].to_owned());
                }
                Err(_) => between.last_mut().unwrap().push_str(word),
            }
        }
        between.last_mut().unwrap().push('\n');
    }
    (between, numbers)
}

/// Run with `TEMPCO_BLESS=1` to write the table again after a change of simulation, fit or format.
#[test]
fn the_example_table_is_what_fit_writes() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile calibration --seed 1 --out cal.csv");
    bench.ok(
        "fit cal.csv --serial EXAMPLE --model composite --segments -15:15,5:35,25:60,50:80 --out set",
    );
    for (emitted, committed) in [
        ("set/table.rs", "firmware/tables/example.rs"),
        (
            "set/table.h",
            "crates/tempco-c/package/examples/bare-metal/table.h",
        ),
    ] {
        compare(&bench.path(emitted), &root().join(committed));
    }
}

fn compare(emitted: &Path, path: &Path) {
    let emitted = fs::read_to_string(emitted).unwrap();
    if std::env::var_os("TEMPCO_BLESS").is_some() {
        fs::write(path, &emitted).unwrap();
    }
    let committed = fs::read_to_string(path).unwrap();

    // The last digits may depend on the processor the fit runs on.
    let (text, numbers) = split(&emitted);
    let (committed_text, committed_numbers) = split(&committed);
    assert_eq!(text, committed_text);
    assert!(numbers.len() > 500, "{}", numbers.len());
    for (found, committed) in numbers.iter().zip(&committed_numbers) {
        let allowed = 1e-7 + 1e-4 * committed.abs();
        assert!((found - committed).abs() <= allowed, "{found} {committed}");
    }
}
