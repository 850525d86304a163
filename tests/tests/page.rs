//! The page that runs the command in a browser, as a user has it: opened from the disk, without a
//! network. What it gives is compared with what the command gives.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempco_qemu::Workspace;
use tempco_tests::autopilot::{Row, ulog};
use tempco_tests::browser::{Browser, Screen};
use tempco_tests::{Bench, root};

const SCREEN: Screen = Screen {
    width: 1440,
    dark: false,
};
/// The longest that a fit here may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(300);
/// Files of a set that hold its table.
const TABLES: [&str; 3] = ["table.bin", "table.rs", "table.h"];

/// The page, made as it is shipped.
fn page() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    let folder = root().join(target).join("page");
    fs::create_dir_all(&folder).unwrap();
    let workspace = Workspace::find().unwrap();
    let page = tempco_web::page(&workspace, &folder).unwrap();
    assert!(
        fs::metadata(&page).unwrap().len() <= 3_000_000,
        "at most 3 MB"
    );
    page
}

/// The page in a browser, and the folder of its logs.
struct Visit<'a> {
    browser: &'a mut Browser,
    page: &'a Path,
    bench: &'a Bench,
}

impl<'a> Visit<'a> {
    fn new(browser: &'a mut Browser, page: &'a Path, bench: &'a Bench) -> Self {
        Self {
            browser,
            page,
            bench,
        }
    }

    /// Opens the page once more and chooses logs.
    fn begin(&mut self, logs: &[&str]) {
        self.browser.open(self.page, SCREEN);
        let files: Vec<PathBuf> = logs.iter().map(|log| self.bench.path(log)).collect();
        self.browser
            .choose("document.getElementById('choose')", &files);
    }

    fn set(&mut self, field: &str, value: &str) {
        let field = format!("document.getElementById('{field}')");
        let event = "new Event('change', {bubbles: true})";
        let value = Value::from(value);
        let script = format!("{field}.value = {value}; {field}.dispatchEvent({event}); true");
        self.browser.evaluate(&script);
    }

    /// Presses the button and waits for the end.
    fn fit(&mut self, serial: &str, model: &str) {
        self.set("serial", serial);
        self.set("model", model);
        self.browser
            .evaluate("document.getElementById('fit').click(); true");
        self.browser.wait_for(
            "document.getElementById('fit').disabled === false",
            PATIENCE,
        );
    }

    fn text(&mut self, selector: &str) -> String {
        let script = format!("document.querySelector('{selector}')?.innerText ?? ''");
        self.browser.evaluate(&script).as_str().unwrap().to_owned()
    }

    /// The words of all elements of a kind.
    fn texts(&mut self, selector: &str) -> Vec<String> {
        let script =
            format!("[...document.querySelectorAll('{selector}')].map((e) => e.innerText)");
        let texts = self.browser.evaluate(&script);
        let texts = texts.as_array().unwrap().iter();
        texts
            .map(|text| text.as_str().unwrap().to_owned())
            .collect()
    }

    /// Downloads everything there is; returns the names.
    fn downloads(&mut self, folder: &Path) -> Vec<String> {
        fs::create_dir_all(folder).unwrap();
        self.browser.download_to(folder);
        let names = self.texts(".downloads a");
        for (number, name) in names.iter().enumerate() {
            let click =
                format!("document.querySelectorAll('.downloads a')[{number}].click(); true");
            self.browser.evaluate(&click);
            let begun = Instant::now();
            while !folder.join(name).is_file() {
                assert!(begun.elapsed() < PATIENCE, "{name} does not come");
                std::thread::sleep(Duration::from_millis(20));
            }
        }
        names
    }

    /// Fits the logs here and by the command, and compares tables, verdict and codes.
    fn same_as_command(&mut self, logs: &[&str], model: &str, options: &str) {
        let name = logs.join("-").replace('.', "-");
        self.fit(&name, model);
        let complaint = self.text("#error");
        assert!(complaint.is_empty(), "{logs:?}: {complaint}");
        let ran = self.bench.run(&format!(
            "fit {} --serial {name} --model {model} --out command-{name} --json {options}",
            logs.join(" ")
        ));
        let answer: Value = serde_json::from_str(&ran.out).unwrap();
        let verdict = answer["verdict"].as_str().unwrap().replace('_', " ");
        let shown = self.text(".verdict");
        assert!(
            shown.starts_with(&format!("Verdict: {verdict}")),
            "{logs:?}: {shown}"
        );
        let codes: Vec<String> = ["rejections", "warnings"]
            .iter()
            .flat_map(|kind| answer[kind].as_array().unwrap())
            .map(|reason| reason["code"].as_str().unwrap().to_owned())
            .collect();
        assert_eq!(self.texts("#result li code"), codes, "{logs:?}");

        let folder = self.bench.path(&format!("page-{name}"));
        self.downloads(&folder);
        let command = self.bench.path(&format!("command-{name}"));
        for file in TABLES {
            let [ours, theirs] = [&folder, &command].map(|of| fs::read(of.join(file)).unwrap());
            assert!(ours == theirs, "{logs:?}: {file}");
        }
        self.is_quiet();
    }

    /// Nothing was complained of, and nothing asked for but the page and parts of it.
    fn is_quiet(&self) {
        let mut complaints = self.browser.complaints(self.page);
        complaints.retain(|what| !what.starts_with("asked for \"blob:"));
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
}

/// Rows of a flight controller with one sensor, of a simulated log \[deg/h\].
fn rows(bench: &Bench) -> Vec<Row> {
    let text = fs::read_to_string(bench.path("imu.csv")).unwrap();
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let rad_s = |dps: f64| dps.to_radians() as f32;
        let rates = [cells[2], cells[3], cells[4]].map(rad_s);
        (0, (cells[0] * 1e6) as u64 + 1, rates, cells[1] as f32)
    });
    rows.collect()
}

fn px4_csv(rows: &[Row]) -> String {
    let lines = rows
        .iter()
        .map(|(_, us, [x, y, z], temp_c)| format!("{us},{us},7,{x},{y},{z},{temp_c},0,0\n"));
    let header =
        "timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count,clip_counter[0]\n";
    header.to_owned() + &lines.collect::<String>()
}

#[test]
fn the_page_gives_what_the_command_gives() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile calibration --seed 1 --rate 0.5 --out cal.csv");
    bench.ok("simulate --unit paper --profile calibration --seed 3 --rate 0.5 --out second.csv");
    bench.ok(
        "simulate --unit paper --profile verification --seed 2 --rate 0.5 --out verification.csv",
    );
    bench.ok("simulate --unit mems --profile calibration --seed 4 --rate 1 --out imu.csv");
    let imu = rows(&bench);
    fs::write(bench.path("px4.ulg"), ulog(&imu)).unwrap();
    bench.write("sensor_gyro_0.csv", &px4_csv(&imu));
    // The temperature stands still: such a log is rejected.
    let cal = fs::read_to_string(bench.path("cal.csv")).unwrap();
    let frozen = cal.lines().enumerate().map(|(row, line)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if row > 3000 && row % 3 > 0 {
            cells[1] = "20";
        }
        cells.join(",") + "\n"
    });
    bench.write("spoilt.csv", &frozen.collect::<String>());
    bench.write("refused.csv", "time_s,temp_c,x_dph\n0,20,1\n1,20,what\n");
    bench.write(
        "unnamed.csv",
        &cal.replacen("time_s,temp_c", "when,board", 1),
    );

    let page = page();
    let mut browser = Browser::start();
    let mut visit = Visit::new(&mut browser, &page, &bench);

    for log in ["cal.csv", "sensor_gyro_0.csv", "spoilt.csv"] {
        visit.begin(&[log]);
        visit.same_as_command(&[log], "composite", "");
    }
    visit.begin(&["cal.csv", "second.csv"]);
    visit.same_as_command(&["cal.csv", "second.csv"], "auto", "");

    // A set of each sensor, in a folder of its own.
    visit.begin(&["px4.ulg"]);
    visit.same_as_command(&["px4.ulg"], "composite", "");

    what_cannot_be_read_is_said_in_the_words_of_the_command(&mut visit);
    columns_can_be_named_by_hand(&mut visit);
    a_verification_signs_the_set_off(&mut visit);
    it_reads_well_on_every_screen(&mut visit);
    a_fit_can_be_cancelled(&mut visit);
    a_log_that_was_taken_away_is_said(&mut visit);
}

fn what_cannot_be_read_is_said_in_the_words_of_the_command(visit: &mut Visit) {
    visit.begin(&["refused.csv"]);
    visit.fit("S1", "composite");
    let ran = visit
        .bench
        .run("fit refused.csv --serial S1 --model composite --out none");
    assert_eq!(ran.code, 2);
    let expected = ran.err.trim().trim_start_matches("error: ");
    assert!(expected.contains("refused.csv:3:"), "{expected}");
    assert_eq!(visit.text("#error"), expected);
    visit.is_quiet();
}

fn columns_can_be_named_by_hand(visit: &mut Visit) {
    visit.begin(&["unnamed.csv"]);
    visit
        .browser
        .wait_for("document.querySelector('#logs .alert') !== null", PATIENCE);
    let refused = visit.text("#logs .alert");
    assert!(refused.contains("there are `when`, `board`"), "{refused}");
    visit.set("time", "when:s");
    visit.set("temp", "board:degc");
    visit
        .browser
        .wait_for("document.querySelector('#logs td') !== null", PATIENCE);
    let cells = visit.texts("#logs td");
    assert_eq!(
        cells[..6],
        ["when", "time", "s", "board", "temperature of x, y, z", ""]
    );
    visit.same_as_command(
        &["unnamed.csv"],
        "composite",
        "--time when:s --temp board:degc",
    );
}

/// The sign-off is kept in the set; the report of the verification is there.
fn a_verification_signs_the_set_off(visit: &mut Visit) {
    visit.begin(&["cal.csv", "verification.csv"]);
    visit.fit("V1", "auto");
    let bench = visit.bench;
    bench.run("fit cal.csv --serial V1 --model auto --out signed --json");
    let judged = "evaluate signed/coefficients.json verification.csv --sign-off --json";
    let answer: Value = serde_json::from_str(&bench.run(judged).out).unwrap();
    let verdict = answer["verdict"].as_str().unwrap().replace('_', " ");
    assert_eq!(
        visit.text(".verdict"),
        format!("Verdict: {verdict}, verified")
    );

    let folder = bench.path("page-V1");
    let names = visit.downloads(&folder);
    assert_eq!(
        names,
        [
            "V1.zip",
            "coefficients.json",
            "report.html",
            "table.bin",
            "table.h",
            "table.rs",
            "verification-1.html"
        ]
    );
    let set = |folder: &str| -> Value {
        let text = fs::read_to_string(bench.path(folder).join("coefficients.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let [ours, theirs] = [set("page-V1"), set("signed")];
    assert_eq!(ours["table_crc32"], theirs["table_crc32"]);
    assert_eq!(ours["sign_offs"].as_array().unwrap().len(), 1);
    // The zip holds the same files.
    let zip = fs::File::open(folder.join("V1.zip")).unwrap();
    let mut zip = zip::ZipArchive::new(zip).unwrap();
    assert_eq!(zip.len(), names.len() - 1);
    for name in &names[1..] {
        let mut bytes = Vec::new();
        zip.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        assert!(bytes == fs::read(folder.join(name)).unwrap(), "{name}");
    }
    // Pulses are no angles, which autopilots need; with a scale factor they are.
    let notes = visit.texts("#result .note");
    assert!(
        notes.len() == 2 && notes[0].contains("expected a set in deg/h"),
        "{notes:?}"
    );
    visit.set("scale_factor", "0.92");
    visit.set("device_id", "7");
    visit.fit("V1", "auto");
    let folder = bench.path("page-angles");
    visit.downloads(&folder);
    bench.run("fit cal.csv --serial V1 --scale-factor 0.92 --out angles --no-report");
    for (to, name) in [
        ("px4 --device-id 7", "px4.params"),
        ("ardupilot", "ardupilot.param"),
    ] {
        bench.ok(&format!(
            "export angles/coefficients.json --to {to} --out {name}"
        ));
        let [ours, theirs] = [folder.join(name), bench.path(name)].map(|of| fs::read(of).unwrap());
        assert!(ours == theirs, "{name}");
    }
    visit.is_quiet();
}

fn a_fit_can_be_cancelled(visit: &mut Visit) {
    visit.begin(&["cal.csv"]);
    visit.set("serial", "S1");
    let press =
        "document.getElementById('fit').click(); document.getElementById('cancel').click(); true";
    visit.browser.evaluate(press);
    visit.browser.wait_for(
        "document.getElementById('fit').disabled === false",
        PATIENCE,
    );
    assert_eq!(visit.text("#error"), "cancelled");
    visit.fit("S1", "composite");
    assert!(visit.text(".verdict").contains("accepted"));
}

fn a_log_that_was_taken_away_is_said(visit: &mut Visit) {
    fs::copy(visit.bench.path("cal.csv"), visit.bench.path("gone.csv")).unwrap();
    visit.begin(&["gone.csv"]);
    visit
        .browser
        .wait_for("document.querySelector('#logs td') !== null", PATIENCE);
    fs::remove_file(visit.bench.path("gone.csv")).unwrap();
    visit.fit("S1", "composite");
    let error = visit.text("#error");
    assert!(error.starts_with("gone.csv: "), "{error}");
}

fn it_reads_well_on_every_screen(visit: &mut Visit) {
    let folder = visit.page.parent().unwrap();
    for (width, dark) in [(390, false), (1440, true), (1440, false)] {
        visit.browser.look_on(Screen { width, dark });
        // The frame of the report is drawn by another process.
        std::thread::sleep(Duration::from_secs(1));
        let scheme = if dark { "-dark" } else { "" };
        visit
            .browser
            .screenshot(&folder.join(format!("page-{width}{scheme}.png")));
        let overflow =
            "document.documentElement.scrollWidth - document.documentElement.clientWidth";
        assert_eq!(visit.browser.evaluate(overflow), 0, "{width}");
        // Every field has a name for who cannot see it.
        let nameless = "[...document.querySelectorAll('input, select, textarea, button, iframe, progress')]\
             .filter((e) => !(e.labels?.length || e.ariaLabel || e.title || e.innerText)).length";
        assert_eq!(visit.browser.evaluate(nameless), 0);
    }
}

/// A program that stops at once at a trap: `(func (export "_start") unreachable)`, with a memory.
const TRAP: &[u8] =
    b"\0asm\x01\0\0\0\x01\x04\x01\x60\0\0\x03\x02\x01\0\x05\x03\x01\0\x01\x07\x13\x02\x06memory\
    \x02\0\x06_start\0\0\x0a\x05\x01\x03\0\0\x0b";

#[test]
fn a_fault_of_the_command_is_said_and_the_page_goes_on() {
    let bench = Bench::new();
    bench.write("log.csv", "time_s,temp_c,x_dph\n0,20,1\n");
    let page = bench.path("tempco.html");
    fs::write(&page, tempco_web::assembled(TRAP).unwrap()).unwrap();
    let mut browser = Browser::start();
    let mut visit = Visit::new(&mut browser, &page, &bench);
    visit.begin(&["log.csv"]);
    for _ in 0..2 {
        visit.fit("S1", "auto");
        let error = visit.text("#error");
        assert!(
            error.starts_with("a fault of tempco, please report it: unreachable"),
            "{error}"
        );
    }
    visit.is_quiet();
}

/// Figures of docs/browser.md: `cargo test --release -p tempco-tests --test page -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes, and measures times"]
fn how_long_it_takes() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile calibration --seed 1 --out short.csv");
    // 200 MB: the same cycle, again and again.
    let short = fs::read_to_string(bench.path("short.csv")).unwrap();
    let (header, rows) = short.split_once('\n').unwrap();
    let mut long = format!("{header}\n");
    for again in 0.. {
        if long.len() > 200_000_000 {
            break;
        }
        for row in rows.lines() {
            let (time_s, rest) = row.split_once(',').unwrap();
            let time_s = time_s.parse::<f64>().unwrap() + f64::from(again) * 72_800.0;
            long += &format!("{time_s},{rest}\n");
        }
    }
    fs::write(bench.path("long.csv"), long).unwrap();
    let page = page();
    let mut browser = Browser::start();
    let mut visit = Visit::new(&mut browser, &page, &bench);
    for log in ["short.csv", "long.csv"] {
        visit.begin(&[log]);
        let begun = Instant::now();
        visit.fit("S1", "auto");
        let in_page = begun.elapsed();
        assert!(
            visit.text(".verdict").starts_with("Verdict"),
            "{}",
            visit.text("#error")
        );
        let begun = Instant::now();
        bench.run(&format!("fit {log} --serial S1 --out {log}.set"));
        let by_command = begun.elapsed();
        let ratio = in_page.as_secs_f64() / by_command.as_secs_f64();
        println!("{log}: page {in_page:.1?}, command {by_command:.1?}, ratio {ratio:.1}");
    }
}
