//! The report as a reader sees it: in a browser, on a narrow and a wide screen, light and dark.

use std::fs;
use std::path::{Path, PathBuf};

use tempco_tests::browser::{Browser, Findings, Screen};
use tempco_tests::{Bench, PAPER_SEGMENTS, root, shared};

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
        "fit cal.csv --serial DEMO-1 --segments {PAPER_SEGMENTS} --out set"
    ));
    bench.ok("evaluate set/coefficients.json ver.csv --report ver.html");
    let xyz = ["x", "y", "z"];
    look(&mut browser, &bench.path("set/report.html"), "fit", &xyz);
    look(&mut browser, &bench.path("ver.html"), "verification", &xyz);
    the_look_notices_what_is_wrong(&bench, &mut browser);

    if let Some(log) = shared("data/tofupilot_imu_chamber_cycle.csv") {
        let log = log.display();
        bench.run(&format!(
            "fit {log} --serial REAL --model spline --tau 10.114 --out real"
        ));
        let axes = ["gx", "gy", "gz", "ax", "ay", "az"];
        look(&mut browser, &bench.path("real/report.html"), "real", &axes);
    }
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
