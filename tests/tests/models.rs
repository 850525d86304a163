//! Models that the fit chooses, and verdicts, on the command line.

use std::fs;

use tempco_tests::Bench;

fn set(bench: &Bench, folder: &str) -> serde_json::Value {
    let path = bench.path(&format!("{folder}/coefficients.json"));
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn the_default_meets_itself_and_says_what_it_was_compared_with() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile calibration --seed 1 --out cal.csv");
    bench.ok("simulate --unit paper --profile verification --seed 2 --out ver.csv");
    let fitted = bench.ok("fit cal.csv --serial S1 --out set --verbose");
    println!("{fitted}");
    for said in ["left out of the fit", "Lags: ", "kappa of the plays"] {
        assert!(fitted.contains(said), "{said}: {fitted}");
    }
    assert!(!fitted.contains("Chosen:"), "{fitted}");
    let found = set(&bench, "set");
    let channel = &found["channels"][0];
    let selection = &channel["selection"];
    assert_eq!(selection["chosen"]["model"], "spline");
    assert_eq!(selection["others"].as_array().unwrap().len(), 0);
    let thermal = &channel["table"]["thermal"];
    assert!(thermal["kappa"].as_f64().unwrap() > 0.2, "{thermal}");
    for name in ["kappa", "kappa2", "play_kappa", "play_kappa2"] {
        let of = |set: &serde_json::Value| set[name].as_f64().unwrap_or(0.0);
        let (found, flies) = (of(&selection["chosen"]), of(thermal));
        assert!((found - flies).abs() < 1e-6, "{name}: {found} {flies}");
    }
    let json = bench.ok("evaluate set/coefficients.json ver.csv --json");
    let judged: serde_json::Value = serde_json::from_str(&json).unwrap();
    for jump in judged["max_boundary_jump"].as_array().unwrap() {
        assert_eq!(jump, 0.0);
    }
    // Segments that are fitted together have no condition number of their own.
    let inspected = bench.ok("inspect set/coefficients.json --verbose");
    let (_, coverage) = inspected.split_once("Data of each segment").unwrap();
    let rows = coverage
        .lines()
        .skip(3)
        .take_while(|line| line.starts_with('|'));
    let rows: Vec<&str> = rows.collect();
    assert!(rows.len() > 3, "{inspected}");
    for row in rows {
        assert!(row.ends_with(" - |"), "{row}");
    }
    let page = fs::read_to_string(bench.path("set/report.html")).unwrap();
    assert!(page.contains("kappa of the plays") && !page.contains("Chosen for"));
    // Fixed by the user: fitted as given.
    bench.ok("fit cal.csv --serial S1 --rate-tau 200 --kappa 0.5 --no-report --out fixed");
    let fixed = set(&bench, "fixed");
    let thermal = &fixed["channels"][0]["table"]["thermal"];
    assert_eq!(
        (&thermal["tau_s"], &thermal["kappa"]),
        (&200.0.into(), &0.5.into())
    );
}

/// What a model does by default may be asked for; every other choice changes the table.
#[test]
fn options_of_a_model_do_what_they_say() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 1 --out log.csv");
    let crc = |options: &str| {
        let ran = bench.run(&format!(
            "fit log.csv --serial S1 --segments 6:30,20:45 --no-report --out set {options}"
        ));
        assert!(ran.code < 2, "{options}: {}", ran.err);
        set(&bench, "set")["table_crc32"].clone()
    };
    for (model, defaults, others) in [
        (
            "static",
            "--overlap linear --rate-tau 60 --kappa 0",
            ["--overlap hard", "--rate-tau 90", "--kappa 0.5"],
        ),
        (
            "composite",
            "--overlap linear --rate-tau 60 --kappa 0",
            ["--overlap smooth", "--rate-tau 90", "--kappa 0.5"],
        ),
        (
            "auto",
            "--overlap linear",
            [
                "--overlap linear --rate-tau 90",
                "--rate-tau 90 --kappa 0",
                "--kappa 0.5",
            ],
        ),
    ] {
        let default = crc(&format!("--model {model}"));
        assert_eq!(
            crc(&format!("--model {model} {defaults}")),
            default,
            "{model}"
        );
        for other in others {
            assert_ne!(
                crc(&format!("--model {model} {other}")),
                default,
                "{model} {other}"
            );
        }
        assert_eq!(crc("") == default, model == "auto", "{model}");
    }
}

#[test]
fn excluded_stretches_are_left_out_and_counted() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 1 --out log.csv");
    let printed = bench.ok(
        "fit log.csv --serial S1 --model composite --segments 6:45 --out set --exclude 0:99.9 --exclude 200:299.9",
    );
    assert!(
        printed.contains("400 rows left out: in excluded stretches"),
        "{printed}"
    );
    let set = set(&bench, "set");
    assert_eq!(set["channels"][0]["outliers"]["excluded_rows"], 400);
    let refused = bench.run("fit log.csv --serial S1 --out other --exclude 9:3");
    assert_eq!(refused.code, 2);
    assert!(refused.err.contains("T1 before T2"), "{}", refused.err);
}

/// A verification log that does not follow temperature: the set does harm there.
#[test]
fn a_set_that_does_harm_is_marked_as_rejected_on_request_only() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 1 --out log.csv");
    bench.ok("fit log.csv --serial S1 --model composite --segments 6:45 --out set");
    let text = fs::read_to_string(bench.path("log.csv")).unwrap();
    let flat = text.lines().enumerate().map(|(number, line)| {
        let cells: Vec<&str> = line.split(',').collect();
        match number {
            0 => line.to_owned(),
            // Pulses of a constant rate.
            _ => format!("{},{},{},0,0", cells[0], cells[1], number % 2),
        }
    });
    let flat: Vec<String> = flat.collect();
    fs::write(bench.path("flat.csv"), flat.join("\n") + "\n").unwrap();
    let before = fs::read(bench.path("set/coefficients.json")).unwrap();
    let judged = bench.run("evaluate set/coefficients.json flat.csv");
    assert_eq!(judged.code, 1, "{}", judged.err);
    assert_eq!(
        fs::read(bench.path("set/coefficients.json")).unwrap(),
        before
    );

    let refused = bench.run("evaluate set/coefficients.json log.csv --sign-off");
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .err
            .contains("expected a log that it was not fitted to"),
        "{}",
        refused.err
    );

    let judged = bench.run("evaluate set/coefficients.json flat.csv --sign-off");
    assert_eq!(judged.code, 1);
    assert!(judged.err.contains("marked as rejected"), "{}", judged.err);
    let noted = set(&bench, "set");
    assert_eq!(noted["sign_offs"][0]["accepted"], false);
    assert_eq!(noted["sign_offs"][0]["file"], "flat.csv");
    let inspected = bench.run("inspect set/coefficients.json");
    assert_eq!(inspected.code, 1);
    assert!(
        inspected
            .out
            .contains("rejection no_better_than_none: axes "),
        "{}",
        inspected.out
    );
    let applied = bench.run("apply set/coefficients.json log.csv --out out.csv");
    assert_eq!(applied.code, 0);
    assert!(
        applied.err.contains("rejected, no_better_than_none"),
        "{}",
        applied.err
    );
}
