//! `tempco fit --batch`: a set for every unit, a summary, and no stop at a bad one.

use std::fs;
use std::process::Command;

use tempco_tests::Bench;

/// A log between 10 and 40 degC; `noise` scales what the temperature does not explain.
fn log(noise: f64) -> String {
    log_over(15.0, noise)
}

/// A log from 10 degC up, by two times `swing_c`.
fn log_over(swing_c: f64, noise: f64) -> String {
    let mut log = String::from("time_s,temp_c,x_dph,y_dph\n");
    for row in 0..6000 {
        let t = f64::from(row);
        let temp_c = 10.0 + swing_c + swing_c * (t * 0.003).sin();
        let noise = noise * (t * 0.0123).sin();
        let (x, y) = (0.01 * temp_c + noise, 2.0 - 0.02 * temp_c + noise);
        log.push_str(&format!("{row},{temp_c:.4},{x:.6},{y:.6}\n"));
    }
    log
}

#[test]
fn a_bad_unit_does_not_stop_the_others() {
    let bench = Bench::new();
    let folder = bench.path("logs");
    for (serial, noise) in [
        ("A1", 0.010),
        ("A2", 0.011),
        ("A3", 0.009),
        ("A4", 0.0105),
        ("A5", 0.0095),
        ("LOUD", 0.05),
    ] {
        fs::create_dir_all(folder.join(serial)).unwrap();
        fs::write(folder.join(serial).join("run.csv"), log(noise)).unwrap();
    }
    // One more, directly in the folder, in two logs; and one that is cut in the middle of a row.
    fs::write(folder.join("F6_1.csv"), log(0.010)).unwrap();
    fs::write(folder.join("F6_2.csv"), log(0.010)).unwrap();
    fs::write(folder.join("BAD.csv"), &log(0.010)[..5000]).unwrap();

    let ran = bench.run("fit --batch logs --out sets --model composite --segments 10:40");
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    assert!(ran.err.contains("unit BAD: logs/BAD.csv:"), "{}", ran.err);
    assert!(ran.out.contains("sets/summary.csv"), "{}", ran.out);

    let mut written: Vec<String> = fs::read_dir(bench.path("sets"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    written.sort();
    let expected = [
        "A1",
        "A2",
        "A3",
        "A4",
        "A5",
        "F6",
        "LOUD",
        "summary.csv",
        "summary.html",
    ];
    assert_eq!(written, expected, "nothing of a unit that failed");
    assert!(bench.path("sets/F6/table.rs").is_file());

    let summary = fs::read_to_string(bench.path("sets/summary.csv")).unwrap();
    let rows: Vec<&str> = summary.lines().collect();
    assert_eq!(rows.len(), 1 + 2 * 7 + 1, "{summary}");
    let row = |serial: &str| rows.iter().find(|row| row.starts_with(serial)).unwrap();
    assert!(
        row("A1,").starts_with("A1,accepted,no,1,6000,x,dph,"),
        "{summary}"
    );
    assert!(
        row("F6,").starts_with("F6,accepted,no,2,12000,x,dph,"),
        "{summary}"
    );
    assert!(row("LOUD,").starts_with("LOUD,accepted,yes,"), "{summary}");
    assert!(
        row("BAD,").contains("cells, but the header has 4"),
        "{summary}"
    );
    let html = fs::read_to_string(bench.path("sets/summary.html")).unwrap();
    assert!(html.contains("7 of 8 units accepted"), "{html}");
    assert_eq!(html.matches("cells, but the header has 4").count(), 1);
    let links = html.split("href=\"").skip(1);
    let links = links.map(|rest| rest.split('"').next().unwrap());
    let reports: Vec<&str> = links.filter(|link| !link.starts_with('#')).collect();
    assert_eq!(reports.len(), 7, "{reports:?}");
    for report in reports {
        assert!(bench.path("sets").join(report).is_file(), "{report}");
    }

    // The set of a unit is the one that it gets alone.
    bench.ok("fit logs/A1/run.csv --serial A1 --out alone --model composite --segments 10:40");
    let set = |folder: &str| fs::read(bench.path(folder).join("table.rs")).unwrap();
    assert_eq!(set("sets/A1"), set("alone"));

    // Without the bad unit, all is well; the folder of sets is no unit.
    fs::remove_file(folder.join("BAD.csv")).unwrap();
    bench.ok("fit --batch logs --out logs/sets --model composite --segments 10:40");
    bench.ok("fit --batch logs --out logs/sets --model composite --segments 10:40");
}

/// What is wrong with one unit is said of it, and the others are fitted.
#[test]
fn what_cannot_be_a_unit_does_not_stop_the_others() {
    let bench = Bench::new();
    for name in [
        "GOOD.csv",
        "summary.csv/run.csv",
        "SUMMARY.html/run.csv",
        "Twin/run.csv",
        "TWIN.csv",
        "_run.csv",
    ] {
        bench.write(&format!("logs/{name}"), &log(0.01));
    }
    bench.write("logs/COLD.csv", &log_over(7.0, 0.01));
    let first_rows: String = log(0.01).split_inclusive('\n').take(150).collect();
    bench.write("logs/SHORT.csv", &first_rows);
    let mut piped = Vec::new();
    if cfg!(unix) {
        let pipe = bench.path("logs/PIPE.csv");
        assert!(Command::new("mkfifo").arg(pipe).status().unwrap().success());
        piped.push(("PIPE", "logs/PIPE.csv: expected a regular file"));
    }
    let ran = bench.run_to_its_end(
        "fit --batch logs --out sets --model composite --segments 10:30,25:40 --exclude 0:200 \
         --no-report",
    );
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    let summary = fs::read_to_string(bench.path("sets/summary.csv")).unwrap();
    for (serial, expected) in [
        (
            "summary.csv",
            "another name, since the batch's summary has this one",
        ),
        (
            "SUMMARY.html",
            "another name, since the batch's summary has this one",
        ),
        ("Twin", "`Twin` and `TWIN` differ by case only"),
        ("TWIN", "`TWIN` and `Twin` differ by case only"),
        ("", "expected a name that a folder can have"),
        ("COLD", "segment 25.0000..40.0000 degC holds 0 usable rows"),
        ("SHORT", "SHORT.csv: no row is left to fit"),
    ]
    .into_iter()
    .chain(piped)
    {
        let row = summary
            .lines()
            .find(|row| row.starts_with(&format!("{serial},failed,")));
        let row = row.unwrap_or_else(|| panic!("{serial}: {summary}"));
        assert!(row.contains(expected), "{row}");
    }
    let mut written: Vec<_> = fs::read_dir(bench.path("sets"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    written.sort();
    assert_eq!(written, ["GOOD", "summary.csv", "summary.html"]);
}

#[test]
fn bad_usage_of_a_batch_is_refused() {
    let bench = Bench::new();
    fs::create_dir(bench.path("logs")).unwrap();
    for (args, expected) in [
        (
            "--batch logs",
            "no units: expected a sub-folder per serial number",
        ),
        ("--batch none", "none: No such file"),
        ("--batch logs --serial S1", "cannot be used with"),
        ("log.csv", "--serial <SERIAL>"),
        ("--serial S1", "<LOG.csv>..."),
        ("--batch logs --tau nan", "expected seconds"),
        ("--batch logs --max-slew nan", "setting max_slew_c_per_min"),
    ] {
        let ran = bench.run(&format!("fit {args} --out sets"));
        assert_eq!(ran.code, 2, "{args}");
        assert!(ran.err.contains(expected), "{args}: {}", ran.err);
        assert_eq!(bench.files(), ["logs"], "{args}");
    }
}
