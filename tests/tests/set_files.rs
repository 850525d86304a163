//! The files of a set: all of one set or none, whatever ends the command; and sets from elsewhere,
//! whose texts and numbers anyone may have written.

use std::fs;

use serde_json::{Value, json};
use tempco_tests::Bench;

/// A log between 10 and 40 degC.
fn log(axis: &str, slope: f64) -> String {
    let mut log = format!("time_s,temp_c,{axis}\n");
    for row in 0..600 {
        let temp_c = 25.0 + 15.0 * (f64::from(row) * 0.01).sin();
        log.push_str(&format!("{row},{temp_c:.3},{:.4}\n", slope * temp_c));
    }
    log
}

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("log.csv", &log("x_dph", 0.01));
    bench.write("steep.csv", &log("x_dph", 0.02));
    bench
}

const FIT: &str = "--serial S1 --model composite --segments 10:40";

#[test]
fn a_folder_with_files_of_two_sets_is_refused_and_named() {
    let bench = bench();
    bench.ok(&format!("fit log.csv --out set {FIT}"));
    bench.ok(&format!("fit steep.csv --out other {FIT}"));
    for file in ["table.bin", "table.rs", "table.h", "report.html"] {
        bench.ok("inspect set/coefficients.json");
        let place = bench.path("set").join(file);
        let own = fs::read(&place).unwrap();
        fs::copy(bench.path("other").join(file), &place).unwrap();
        let named = format!("files of several sets are in its folder: {file} is not of this set");
        for command in [
            "apply set/coefficients.json log.csv --out out.csv",
            "apply set/table.bin log.csv --out out.csv",
            "evaluate set/coefficients.json log.csv --tau 10",
            "evaluate other/coefficients.json log.csv --tau 10 --against set/coefficients.json",
            "evaluate other/coefficients.json log.csv --tau 10 --against set/table.bin",
            "replay set/coefficients.json log.csv --target none",
            "flash-set set/coefficients.json --port none",
            "flash-set set/table.bin --port none",
        ] {
            let ran = bench.run(command);
            assert_eq!(ran.code, 2, "{command}: {}", ran.out);
            assert!(ran.err.contains(&named), "{command}: {}", ran.err);
        }
        assert!(!bench.path("out.csv").exists());
        for set in ["coefficients.json", "table.bin"] {
            let ran = bench.run(&format!("inspect set/{set}"));
            assert_eq!(ran.code, 1, "{}", ran.err);
            assert!(ran.err.contains(&named), "{}", ran.err);
        }
        fs::write(&place, own).unwrap();
    }
    // Under another name, a set has nothing to do with the files beside it.
    fs::copy(
        bench.path("other/coefficients.json"),
        bench.path("set/before.json"),
    )
    .unwrap();
    bench.ok("apply set/before.json log.csv --out out.csv");
}

#[test]
fn a_set_replaces_another_one_whole_and_leaves_other_files() {
    let bench = bench();
    bench.ok(&format!("fit log.csv --out set {FIT}"));
    bench.write("set/notes.txt", "mine");
    bench.ok(&format!("fit steep.csv --out set --no-report {FIT}"));
    bench.ok("inspect set/coefficients.json");
    assert!(!bench.path("set/report.html").exists());
    assert_eq!(fs::read(bench.path("set/notes.txt")).unwrap(), b"mine");
}

#[cfg(unix)]
mod signals {
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Child, Command, Stdio};

    use super::*;
    use tempco_tests::tempco_path;

    fn start(bench: &Bench, args: &str) -> Child {
        Command::new(tempco_path())
            .current_dir(bench.path(""))
            .args(args.split_whitespace())
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    }

    /// SIGINT and SIGTERM, but for those that this test ignores, as does what a shell starts in the
    /// background: the command then ignores them too.
    fn signals() -> Vec<i32> {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
        let signals = [2, 15].into_iter();
        signals
            .filter(|signal| mask >> (signal - 1) & 1 == 0)
            .collect()
    }

    /// Sends a signal and returns the one by which the command ended; none if it was done before.
    fn end(mut child: Child, signal: i32) -> Option<i32> {
        let kill = Command::new("kill")
            .args([format!("-{signal}"), child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        child.wait().unwrap().signal()
    }

    fn has_unfinished(folder: &std::path::Path) -> bool {
        fs::read_dir(folder).is_ok_and(|entries| {
            let names = entries.flatten().map(|entry| entry.file_name());
            names
                .map(|name| name.to_string_lossy().into_owned())
                .any(|name| name.starts_with(".tmp") || name.ends_with(".partial"))
        })
    }

    /// A simulation that takes long is ended as soon as it has begun to write.
    #[test]
    fn a_simulation_that_is_ended_leaves_nothing() {
        for signal in signals() {
            let bench = Bench::new();
            let mut child = start(
                &bench,
                "simulate --unit paper --profile calibration --rate 1000 --out new/log.csv --truth new/truth.csv",
            );
            while !has_unfinished(&bench.path("new")) {
                assert!(child.try_wait().unwrap().is_none());
                std::thread::yield_now();
            }
            assert_eq!(end(child, signal), Some(signal));
            assert!(bench.files().is_empty(), "{:?}", bench.files());
        }
    }

    /// The signal comes as soon as a file of the set is begun, or whenever it then can.
    #[test]
    fn a_fit_that_is_ended_leaves_the_set_before_or_the_new_one() {
        let bench = bench();
        bench.ok(&format!("fit steep.csv --out set --no-report {FIT}"));
        let signals = signals();
        for run in 0..8 {
            let signal = signals[run % signals.len()];
            let log = ["log.csv", "steep.csv"][run / 2 % 2];
            let mut child = start(&bench, &format!("fit {log} --out set --no-report {FIT}"));
            while !has_unfinished(&bench.path("set")) && child.try_wait().unwrap().is_none() {
                std::thread::yield_now();
            }
            let ended = end(child, signal);
            assert!(ended.is_none() || ended == Some(signal));
            assert!(!has_unfinished(&bench.path("set")), "run {run}");
            bench.ok("inspect set/coefficients.json");
        }
    }
}

/// The set that a log was fitted to, changed.
fn changed(bench: &Bench, change: impl FnOnce(&mut Value)) {
    let text = fs::read_to_string(bench.path("set/coefficients.json")).unwrap();
    let mut set = serde_json::from_str(&text).unwrap();
    change(&mut set);
    bench.write("changed.json", &set.to_string());
}

#[test]
fn numbers_that_cannot_be_are_refused_with_file_and_key() {
    let bench = bench();
    bench.ok(&format!("fit log.csv --out set {FIT}"));
    for scale_factor in [-1.0, 0.0, 1e308] {
        changed(&bench, |set| {
            set["settings"]["scale_factor_arcsec"] = json!(scale_factor)
        });
        let ran = bench.run("apply changed.json log.csv --out out.csv");
        assert_eq!(ran.code, 2);
        let expected = "changed.json: settings.scale_factor_arcsec is";
        assert!(ran.err.contains(expected), "{}", ran.err);
        let ran = bench.run(&format!(
            "fit log.csv --out new --scale-factor {scale_factor} {FIT}"
        ));
        assert_eq!(ran.code, 2);
        assert!(
            ran.err.contains("expected arcsec per pulse, 1e-6 to 1e6"),
            "{}",
            ran.err
        );
    }
    changed(&bench, |set| {
        let a0 = &mut set["channels"][0]["axes"][0]["polynomials"][0]["a"][0];
        *a0 = json!(a0.as_f64().unwrap() + 0.001);
    });
    let ran = bench.run("inspect changed.json");
    assert_eq!((ran.code, ran.out.as_str()), (2, ""));
    let expected = "changed.json: channels[0].table: axis x, cell 1 of 1: 1.000e-3 deg/h off";
    assert!(ran.err.contains(expected), "{}", ran.err);
}

/// Every text of the set, the names of axis and column included, is one that acts on a terminal, a
/// spreadsheet or a page if it gets there as it is.
#[test]
fn texts_of_a_set_act_on_nothing() {
    let hostile = "-@x</td><script>\u{1b}[2J\u{9b}31m\u{202e}\n\"'";
    let bench = bench();
    bench.write(
        "log.csv",
        &log(
            "\"-@x</td><script>\u{1b}[2J\u{9b}31m\u{202e}\n\"\"'_dph\"",
            0.01,
        ),
    );
    let ran = bench.run(&format!("fit log.csv --out set --figures figures {FIT}"));
    assert_eq!(ran.code, 0, "{}", ran.err);
    changed(&bench, |set| {
        set["serial"] = json!(&hostile[..20]);
        set["provenance"]["tool"] = json!(hostile);
        set["provenance"]["created"] = json!(hostile);
        set["provenance"]["inputs"][0]["file"] = json!(hostile);
        set["provenance"]["inputs"][0]["sha256"] = json!(hostile);
        set["channels"][0]["temperature"] = json!("=1+1|/../../up");
        set["channels"][0]["segments"][0]["terms"][0] = json!(hostile);
        let sign_off = json!({"file": hostile, "sha256": hostile, "judged": hostile, "tau_s": 100.0,
            "accepted": false, "worse_axes": [hostile]});
        set["sign_offs"] = json!([sign_off]);
    });
    let is_quiet = |text: &str| {
        let mut bad = text
            .chars()
            .filter(|c| *c != '\n' && (c.is_control() || *c == '\u{202e}'));
        assert_eq!(bad.next(), None, "{text}");
    };
    for (command, code) in [
        ("inspect changed.json", 1),
        ("inspect changed.json --json", 1),
        ("apply changed.json log.csv --out out.csv", 0),
        ("apply changed.json steep.csv --out out.csv", 2),
        (
            "evaluate changed.json log.csv --tau 10 --report out.html --figures out/svg",
            1,
        ),
        ("evaluate changed.json log.csv --tau 10 --json", 1),
    ] {
        let ran = bench.run(command);
        assert_eq!(ran.code, code, "{command}: {}{}", ran.out, ran.err);
        is_quiet(&ran.out);
        is_quiet(&ran.err);
        if command.ends_with("--json") {
            let read: Value = serde_json::from_str(&ran.out).unwrap();
            assert!(read.to_string().contains("31m\u{202e}"));
        }
    }
    let out = fs::read_to_string(bench.path("out.csv")).unwrap();
    assert!(
        out.starts_with("time_s,'=1+1|/../../up,\"'-@x</td>"),
        "{}",
        &out[..100]
    );
    assert_eq!(out.lines().count(), 601);
    is_quiet(&out);
    let mut pages = vec![bench.path("out.html"), bench.path("set/report.html")];
    for folder in ["figures", "out/svg"] {
        let entries = fs::read_dir(bench.path(folder)).unwrap();
        pages.extend(entries.map(|entry| entry.unwrap().path()));
    }
    assert!(pages.len() > 10);
    for page in pages {
        let text = fs::read_to_string(&page).unwrap();
        assert!(!text.contains("<script"), "{}", page.display());
        is_quiet(&text);
    }
    let names = [
        "changed.json",
        "figures",
        "log.csv",
        "out",
        "out.csv",
        "out.html",
        "set",
        "steep.csv",
    ];
    assert_eq!(bench.files(), names);
}
