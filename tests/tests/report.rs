//! The report as a reader sees it: in a browser, on a narrow and a wide screen, light and dark.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempco_set::load_set;
use tempco_tests::browser::{Browser, Findings, Screen};
use tempco_tests::history::add_history;
use tempco_tests::{Bench, PAPER_SEGMENTS, root, shared, tempco_path};

const NARROW: u32 = 390;
const WIDE: u32 = 1440;

/// Names of the figures of a report.
fn figures(axes: &[&str]) -> Vec<String> {
    let kinds = [
        "bias",
        "traces",
        "residual-time",
        "residual-temperature",
        "residual-rate",
        "allan",
        "segments",
    ];
    let of_axes = kinds
        .iter()
        .flat_map(|kind| axes.iter().map(move |axis| format!("{kind}-{axis}")));
    of_axes.chain(["coverage-temp_c".to_owned()]).collect()
}

/// Where pictures are kept, to be looked at.
fn kept(name: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    let folder = root().join(target).join("report");
    fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// Looks at a page on every kind of screen and keeps pictures.
fn look(browser: &mut Browser, page: &Path, name: &str, axes: &[&str]) {
    for (width, dark) in [(NARROW, false), (WIDE, true), (WIDE, false)] {
        let screen = Screen { width, dark };
        let found = browser.findings(page, screen, &figures(axes));
        let scheme = if dark { "-dark" } else { "" };
        browser.screenshot(&kept(&format!("{name}-{width}{scheme}.png")));
        assert!(found.is_empty(), "{name}, {screen:?}: {found:#?}");
        let ground = browser.evaluate("getComputedStyle(document.body).backgroundColor");
        assert_eq!(ground == "rgb(22, 25, 29)", dark, "{ground}");
    }
    browser.print(&kept(&format!("{name}.pdf")));
}

#[test]
fn reports_read_well_on_every_screen() {
    let bench = Bench::new();
    let mut browser = Browser::start();
    bench.ok("simulate --unit paper --profile calibration --seed 1 --out cal.csv");
    bench.ok("simulate --unit paper --profile verification --seed 2 --out ver.csv");
    bench.ok(&format!(
        "fit cal.csv --serial DEMO-1 --model composite --segments {PAPER_SEGMENTS} --out set"
    ));
    bench.ok("evaluate set/coefficients.json ver.csv --report ver.html");
    let xyz = ["x", "y", "z"];
    look(&mut browser, &bench.path("set/report.html"), "fit", &xyz);
    look(&mut browser, &bench.path("ver.html"), "verification", &xyz);
    the_look_notices_what_is_wrong(&bench, &mut browser);

    if let Some(log) = shared("data/tofupilot_imu_chamber_cycle.csv") {
        let log = log.display();
        bench.run(&format!("fit {log} --serial REAL --tau 10.114 --out real"));
        let axes = ["gx", "gy", "gz", "ax", "ay", "az"];
        look(&mut browser, &bench.path("real/report.html"), "real", &axes);
    }
}

/// Seven units and one whose log is cut off.
#[test]
fn the_page_of_a_batch_reads_well_and_is_filtered() {
    let bench = Bench::new();
    fs::create_dir(bench.path("logs")).unwrap();
    for seed in 1..=7 {
        let log = format!("logs/RLG-{seed:03}.csv");
        bench.ok(&format!(
            "simulate --unit paper --profile short --seed {seed} --out {log}"
        ));
    }
    let log = fs::read_to_string(bench.path("logs/RLG-001.csv")).unwrap();
    bench.write("logs/CUT.csv", &log[..5000]);
    let ran = bench.run("fit --batch logs --out sets --model composite --segments 6:45");
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);

    let mut browser = Browser::start();
    let page = bench.path("sets/summary.html");
    let figures = ["x", "y", "z"].map(|axis| format!("distribution-{axis}-pulses_s"));
    for (width, dark) in [(NARROW, false), (WIDE, true), (WIDE, false)] {
        let screen = Screen { width, dark };
        let found = browser.findings(&page, screen, &figures);
        let scheme = if dark { "-dark" } else { "" };
        browser.screenshot(&kept(&format!("batch-{width}{scheme}.png")));
        assert!(found.is_empty(), "{screen:?}: {found:#?}");
    }
    browser.print(&kept("batch.pdf"));
    let shown = "[...document.querySelectorAll('tr.unit')].filter(row => row.offsetHeight).length";
    assert_eq!(browser.evaluate(shown), 8);
    browser.evaluate("document.getElementById('show-failed').click()");
    assert_eq!(browser.evaluate(shown), 1);
    let faint = "getComputedStyle(document.querySelector('svg .unit')).opacity";
    assert_eq!(browser.evaluate(faint), "0.12");
    browser.evaluate("document.getElementById('show-all').click()");
    assert_eq!(browser.evaluate(shown), 8);
}

/// Spoils a good page in every way that is looked for.
fn the_look_notices_what_is_wrong(bench: &Bench, browser: &mut Browser) {
    let good = fs::read_to_string(bench.path("set/report.html")).unwrap();
    let screen = Screen {
        width: NARROW,
        dark: false,
    };
    let mut found = |page: &str| -> Findings {
        bench.write("bad.html", page);
        browser.findings(&bench.path("bad.html"), screen, &figures(&["x", "y", "z"]))
    };
    let after = |what: &str, more: &str| good.replacen(what, &format!("{what}{more}"), 1);
    let text =
        |x: i32, text: &str| format!("<text x=\"{x}\" y=\"100\" font-size=\"50\">{text}</text>");
    let figure = "<svg id=\"allan-y\"";
    let (before, rest) = good.split_once(figure).unwrap();
    let (tag, body) = rest.split_once('>').unwrap();
    let body = body.split_once("</svg>").unwrap();
    let with_body = |body_of: &str| format!("{before}{figure}{tag}>{body_of}</svg>{}", body.1);
    let marks_gone = body.0.replace("<circle", "<g").replace("<poly", "<g");
    for (page, expected) in [
        (
            good.replace("id=\"bias-x\"", ""),
            "figure bias-x is missing",
        ),
        (with_body(&marks_gone), "figure allan-y is empty"),
        (
            with_body(&(text(500, "first") + &text(510, "second") + body.0)),
            "\"second\" lies upon \"first\"",
        ),
        (with_body(&(text(1900, "far right") + body.0)), "is cut off"),
        (
            after("<main>", "<p style=\"width:600px\">wide</p>"),
            "616 px wide",
        ),
        (
            after("<main>", "<script>console.error('trouble')</script>"),
            "trouble",
        ),
        (after("<main>", "<script>nothing.at.all</script>"), "thrown"),
        (
            after("<main>", "<img src=\"http://127.0.0.1:9/x.png\">"),
            "asked for \"http://127.0.0.1:9/x.png\"",
        ),
    ] {
        assert_ne!(page, good, "{expected}");
        let found = found(&page);
        assert!(
            found.iter().any(|finding| finding.contains(expected)),
            "{expected}: {found:#?}"
        );
    }
    assert_eq!(found(&good), Findings::new());
}

#[test]
fn the_page_rejects_what_does_harm_and_trusts_no_name() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    // What the set takes out is then what it should put in.
    let log = fs::read_to_string(bench.path("log.csv")).unwrap();
    let lines = log.lines().map(|line| match line.rsplit_once(',') {
        Some((rest, z)) if !line.starts_with("time") => {
            format!("{rest},{}", -z.parse::<f64>().unwrap())
        }
        _ => line.to_owned(),
    });
    bench.write("turned.csv", &lines.collect::<Vec<_>>().join("\n"));
    bench.ok("fit log.csv --serial <b>&\"S1 --out set --model composite --segments 6:45");
    let page = |name: &str| fs::read_to_string(bench.path(name)).unwrap();
    let fitted = page("set/report.html");
    assert!(fitted.contains("Calibration of unit &lt;b&gt;&amp;&quot;S1</h1>"));
    assert!(fitted.contains("Not verified on a log"));
    let (verdict, _) = fitted.split_once("</section>").unwrap();
    for covered in ["Calibrated for", "temp_c: T ", " degC, T' ", " degC/min"] {
        assert!(verdict.contains(covered), "{verdict}");
    }
    let ran = bench.run("evaluate set/coefficients.json turned.csv --report turned.html");
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    let rejected = page("turned.html");
    assert!(rejected.contains("verdict reject"));
    assert!(rejected.contains("axis z: compensation does not help on turned.csv"));
    bench.ok("evaluate set/coefficients.json log.csv --report log.html");
    assert!(page("log.html").contains("Not verified on a log"));
}

#[test]
fn history_terms_have_a_table_where_there_are_any() {
    const CAPTION: &str = "the terms of the thermal history are left out of it";
    const HEAD: &str = "lag up to [degC]";
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    bench.ok("fit log.csv --serial S1 --out set --model composite --segments 6:45");
    let without = fs::read_to_string(bench.path("set/report.html")).unwrap();
    assert!(!without.contains(CAPTION) && !without.contains(HEAD));

    let mut set = load_set(&bench.path("set/coefficients.json")).unwrap();
    add_history(&mut set);
    bench.write("with.json", &serde_json::to_string(&set).unwrap());
    // The terms are made up: whether they do any good is not the matter here.
    let ran = bench.run("evaluate with.json log.csv --report with.html");
    assert!(ran.code < 2, "{}", ran.err);
    let page = fs::read_to_string(bench.path("with.html")).unwrap();
    assert!(page.contains(CAPTION) && page.contains(HEAD));
    let (_, table) = page.split_once(HEAD).unwrap();
    let rows: Vec<&str> = table.split("<tr>").skip(1).take(9).collect();
    let text_of = |row: &str| -> String {
        let cells = row.replace("</td>", "|");
        let parts = cells.split('<');
        parts
            .map(|part| part.split_once('>').map_or(part, |(_, text)| text))
            .collect()
    };
    for (row, expected) in [
        (0, "x [pulses/s]|play|2.500|-|-|0.2500\u{b1} 1.6e-2|"),
        (4, "y [pulses/s]|play|8.000|-|-|-|"),
        (
            8,
            "z [pulses/s]|second lag|-|900.0|4.250|3.000\u{b1} 1.9e-1|",
        ),
    ] {
        let found = text_of(rows[row]);
        assert!(found.starts_with(expected), "row {row}: {found}");
    }
    let screen = Screen {
        width: NARROW,
        dark: false,
    };
    let names = figures(&["x", "y", "z"]);
    let found = Browser::start().findings(&bench.path("with.html"), screen, &names);
    assert_eq!(found, Findings::new());
}

#[test]
fn what_is_judged_is_printed_as_json_too() {
    let bench = Bench::new();
    let json = |args: &str| -> Value { serde_json::from_str(&bench.ok(args)).unwrap() };
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    let fitted = json(
        "fit log.csv --serial S1 --out set --model composite --segments 6:45 --figures svg --json",
    );
    assert_ne!(fitted["verdict"], "rejected");
    assert_eq!(fitted["verified"], false);
    assert_eq!(fitted["rejections"], Value::Array(Vec::new()));
    let files = [
        "coefficients.json",
        "table.bin",
        "table.rs",
        "table.h",
        "report.html",
    ];
    for (file, name) in fitted["files"].as_array().unwrap().iter().zip(files) {
        assert!(bench.path(file.as_str().unwrap()).ends_with(name), "{file}");
        assert!(bench.path(file.as_str().unwrap()).is_file(), "{file}");
    }
    let inspected = json("inspect set/coefficients.json --json");
    assert_eq!(inspected["set"], fitted["set"]);
    for key in ["verdict", "verified", "rejections", "warnings"] {
        assert_eq!(inspected[key], fitted[key]);
    }
    assert_eq!(inspected["rejected"], false);
    assert_eq!(inspected["channels"][0]["axes"][2]["axis"], "z");

    let mut written: Vec<String> = fs::read_dir(bench.path("svg"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let mut expected = figures(&["x", "y", "z"]);
    expected.iter_mut().for_each(|name| name.push_str(".svg"));
    written.sort();
    expected.sort();
    assert_eq!(written, expected);
}

#[test]
fn without_a_report_logs_are_read_once_and_may_be_pipes() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 3 --out log.csv");
    let log = fs::read(bench.path("log.csv")).unwrap();
    let pipe = |args: &'static str| {
        let (log, folder) = (log.clone(), bench.path("."));
        let mut child = Command::new(tempco_path())
            .args(args.split_whitespace())
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        // Refused at once, it may not read what is written.
        let writer = std::thread::spawn(move || stdin.write_all(&log).is_ok());
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let (code, said) =
        pipe("fit /dev/stdin --serial S1 --out set --model composite --segments 6:45");
    assert_eq!(code, Some(2));
    assert!(said.contains("reads a log twice"), "{said}");
    assert_eq!(bench.files(), ["log.csv"], "nothing may be written");
    let (code, said) =
        pipe("fit /dev/stdin --serial S1 --out set --model composite --segments 6:45 --no-report");
    assert_eq!(code, Some(0), "{said}");
    assert!(!bench.path("set/report.html").exists());
}
