//! `tempco flash-set`, `monitor`, `faults` and `replay` on units: the emulated one with the whole
//! application, and one in this process that does as a test wants.
#![cfg(unix)]

#[path = "../../host-tools/hil/tests/common/mod.rs"]
mod simulated;

use std::fs;
use std::os::unix::net::UnixListener;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::thread;

use serde_json::Value;
use simulated::{FIT, Figure, Flash, Wire, image_of, serve};
use tempco_hil::{Patience, open, replay};
use tempco_image::{AlignedBytes, Fit, Image, Unit};
use tempco_log::{ReadOptions, read_log};
use tempco_qemu::{Board, Machine, MachineOptions};
use tempco_set::load_set;
use tempco_set::run::{Updates, apply, inputs};
use tempco_tests::rig::{SERIAL, image};
use tempco_tests::{Bench, root};

/// A folder with a set of the unit `serial`, in `set`, and three logs: `log.csv`, `fifty.csv` of
/// 50 Hz, and `fast.csv` of the units' sample rate.
fn fitted(serial: &str) -> Bench {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 5 --out long.csv");
    let ran = bench.run(&format!(
        "fit long.csv --serial {serial} --out set --model composite --segments 6:45 --no-report"
    ));
    assert!(ran.code < 2, "{}", ran.err);
    let long = fs::read_to_string(bench.path("long.csv")).unwrap();
    let log: Vec<&str> = long.lines().take(601).collect();
    bench.write("log.csv", &log.join("\n"));
    let mut fast = "time_s,temp_c,x_pulses_per_s,y_pulses_per_s,z_pulses_per_s\n".to_owned();
    for row in 0..1501 {
        let t = f64::from(row);
        let [x, y, z] = [0.01, 0.02, 0.5].map(|pace| (pace * t).sin());
        fast += &format!("{},{},{x},{y},{z}\n", t * 0.0005, 20.0 + t * 1e-4);
    }
    bench.write("fast.csv", &fast);
    bench.write("fifty.csv", &fifty_hz());
    bench
}

/// A unit in this process behind the socket `unit` of a folder, for one program at a time.
fn simulated(bench: &Bench, serial: &str) -> (PathBuf, Arc<Mutex<Flash>>) {
    let path = bench.path("unit");
    let listener = UnixListener::bind(&path).unwrap();
    let flash = Arc::new(Mutex::new(Flash {
        serial: serial.to_owned(),
        fit: Some(Fit {
            unit: Unit::PulsesPerS,
            ..FIT
        }),
        ..Flash::default()
    }));
    let kept = flash.clone();
    thread::spawn(move || {
        for port in listener.incoming() {
            serve(port.unwrap(), kept.clone(), [Wire::GOOD, Wire::GOOD]);
        }
    });
    (path, flash)
}

#[test]
fn a_set_goes_into_the_emulated_unit_and_logs_through_it_bit_for_bit() {
    let bench = fitted(SERIAL);
    // Nothing waits for the time of this machine.
    let options = MachineOptions {
        extra: ["-icount", "shift=5,sleep=off"].map(str::to_owned).to_vec(),
        ..MachineOptions::default()
    };
    let machine = Machine::start(&image(), Board::Mps2An386, &options).unwrap();
    let port = machine.link().display().to_string();
    let ran = bench.run(&format!("replay set/table.bin log.csv --target {port}"));
    assert_eq!(ran.code, 2, "{}", ran.out);
    assert!(ran.err.contains("runs on no table"), "{}", ran.err);

    let set = load_set(&bench.path("set/coefficients.json")).unwrap();
    for (file, bank) in [("table.bin", "A"), ("coefficients.json", "B")] {
        let out = bench.ok(&format!("flash-set set/{file} --port {port}"));
        let expected = format!("runs on table {} in bank {bank}", set.table_crc32);
        assert!(out.contains(&expected), "{out}");
    }
    for (log, real_time, rows) in [
        ("log.csv", "", 600),
        ("fifty.csv", "", 3000),
        ("fast.csv", "", 1501),
        ("fast.csv", "--real-time", 1501),
    ] {
        let out = bench.ok(&format!(
            "replay set/coefficients.json {log} --target {port} {real_time}"
        ));
        let expected = format!("0 of {rows} samples differ between host and unit {SERIAL} at");
        assert!(out.contains(&expected), "{out}");
        // One may be: the line of the emulator is as fast as a busy host lets it be. It is sent again.
        let few = [" 0 frames dropped", " 1 frames dropped"];
        assert!(few.iter().any(|few| out.contains(few)), "{out}");
        assert!(out.contains(" 0 overruns,"), "{out}");
    }
    let ran = bench.run(&format!(
        "replay set/coefficients.json log.csv --target {port} --real-time"
    ));
    assert_eq!(ran.code, 2);
    assert!(
        ran.err
            .contains("expected the sample interval of the unit, 0.0005 s"),
        "{}",
        ran.err
    );

    let out = bench.ok(&format!(
        "monitor --port {port} --period 100 --count 3 --json"
    ));
    let messages: Vec<Value> = out
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(messages.len(), 3, "{out}");
    assert_eq!(messages[0]["raw"].as_array().unwrap().len(), 3, "{out}");
    assert!(messages[0]["load_permille"].as_u64() < Some(1000), "{out}");
    assert!(messages[0]["fault_names"].is_array());
    let faults = bench.ok(&format!("faults --port {port}"));
    assert!(faults.contains("fault"), "{faults}");

    one_bit_of_a_coefficient_is_found(&bench, &machine);
}

/// The unit against a host whose table differs in one bit.
fn one_bit_of_a_coefficient_is_found(bench: &Bench, machine: &Machine) {
    let bytes = fs::read(bench.path("set/table.bin")).unwrap();
    let mut place = Box::new(AlignedBytes([0; 65_536]));
    place.0[..bytes.len()].copy_from_slice(&bytes);
    let image = Image::read(&place.0).unwrap();
    let [good] = image.tables::<1, 3>().unwrap();
    let mut cells = good.cells().to_vec();
    // A cell of the temperatures that are replayed.
    let warm = cells.len() / 2;
    let a0 = &mut cells[warm][1].a[0];
    *a0 = f32::from_bits(a0.to_bits() ^ 1);
    let channel = image.channel(0).unwrap();
    let thermal = tempco::Thermal::new(channel.thermal).unwrap();
    let (first_c, last_c) = (channel.first_edge_c, channel.last_edge_c);
    let other = tempco::Table::new(thermal, first_c, last_c, &cells)
        .and_then(|table| table.calibrated(channel.t_min_c, channel.t_max_c))
        .unwrap();
    let width_c = (last_c - first_c) / cells.len() as f32;
    let within_c = first_c + width_c * (warm as f32 + 0.5);

    let port = open(&machine.link(), 0).unwrap();
    let mut unit = tempco_hil::Unit::connect(port, Patience::default()).unwrap();
    let samples = || {
        (0..50).map(|_| tempco_replay::Sample {
            update_s: Some(1.0),
            temps_c: [within_c],
            raw: [[0.0; 3]],
        })
    };
    let found = replay::by_row(&mut unit, &[other], samples(), |_| {}).unwrap();
    assert_eq!((found.different, found.first), (50, Some(0)));
    let found = replay::by_row(&mut unit, &[good], samples(), |_| {}).unwrap();
    assert_eq!(found.different, 0);
}

#[test]
fn a_unit_that_computes_something_else_is_found_by_exit_code() {
    let bench = fitted("SN1");
    let (port, flash) = simulated(&bench, "SN1");
    let port = port.display();
    bench.ok(&format!("flash-set set/table.bin --port {port}"));
    for log in ["log.csv", "fast.csv"] {
        let command = format!("replay set/table.bin {log} --target {port}");
        let out = bench.ok(&command);
        assert!(out.contains("0 of "), "{out}");
        // The same name for other numbers, as a damaged memory would have it.
        let good = flash.lock().unwrap().banks[0].clone();
        let set = load_set(&bench.path("set/coefficients.json")).unwrap();
        flash.lock().unwrap().banks[0] = image_of("SN1", set.crc32(), 0.5);
        let ran = bench.run(&command);
        flash.lock().unwrap().banks[0] = good;
        assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
        let rows = if log == "log.csv" { 600 } else { 1501 };
        let expected = format!("{rows} of {rows} samples differ between host and unit SN1 at");
        assert!(ran.out.contains(&expected), "{}", ran.out);
        assert!(
            ran.err.contains("the first one that differs is row 1"),
            "{}",
            ran.err
        );
    }
}

/// A bit of one bias, in the middle of a block.
#[test]
fn a_block_that_differs_is_reported_with_its_time() {
    let bench = fitted("SN1");
    let (port, flash) = simulated(&bench, "SN1");
    let port = port.display();
    bench.ok(&format!("flash-set set/table.bin --port {port}"));
    flash.lock().unwrap().spoil = Some((217, Figure::Bias));
    let ran = bench.run(&format!("replay set/table.bin fast.csv --target {port}"));
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    // Temperatures are due at row 201.
    let block =
        "blocks in which a bias or a flag differs: 1, the first one from row 201 at 0.1 s on";
    assert!(ran.err.contains(block), "{}", ran.err);
    assert!(ran.out.contains("0 of 1501 samples differ"), "{}", ran.out);
}

/// A minute at 50 Hz, with a temperature that is told ten times a second: the replay's
/// step gives the same as `apply`, to the bit.
#[test]
fn a_log_of_50_hz_is_replayed_with_the_updates_of_apply() {
    let bench = fitted("SN1");
    let (port, flash) = simulated(&bench, "SN1");
    let port = port.display();
    bench.ok(&format!("flash-set set/table.bin --port {port}"));
    let out = bench.ok(&format!("replay set/table.bin fifty.csv --target {port}"));
    assert!(out.contains("0 of 3000 samples differ"), "{out}");
    // The set was fitted at 2 Hz.
    assert_eq!(flash.lock().unwrap().updates, 120);

    let mut set = load_set(&bench.path("set/coefficients.json")).unwrap();
    let log = read_log(&bench.path("fifty.csv"), &ReadOptions::default()).unwrap();
    for (period_s, expected) in [(1.0, 60), (0.1, 600), (0.02, 600)] {
        set.settings.thermal_period_s = period_s;
        let applied = apply(&set, &log).unwrap();
        let inputs = &inputs(&set, &log).unwrap()[0];
        let period_s = set.thermal_period_s(log.interval_s);
        let mut updates = Updates::new(log.time_s[0], log.interval_s, period_s);
        let bytes = fs::read(bench.path("set/table.bin")).unwrap();
        let mut place = Box::new(AlignedBytes([0; 65_536]));
        place.0[..bytes.len()].copy_from_slice(&bytes);
        let tables = Image::read(&place.0).unwrap().tables::<1, 3>().unwrap();
        let mut host = tempco_replay::Replay::new(&tables);
        let mut count = 0;
        for (row, time_s) in log.time_s.iter().enumerate() {
            let update_s = updates.due(*time_s);
            count += usize::from(update_s.is_some());
            let outcome = host.step(&tempco_replay::Sample {
                update_s,
                temps_c: [inputs.temp_c[row]],
                raw: [inputs.row(row)],
            });
            let [channel] = outcome.channels;
            assert_eq!(channel.flags(), applied.status[row], "row {row}");
            for (axis, output) in applied.axes.iter().enumerate() {
                let found = (channel.bias[axis], channel.compensated[axis]);
                let of_apply = (output.bias[row], output.compensated[row]);
                let bits = |(a, b): (f32, f32)| (a.to_bits(), b.to_bits());
                assert_eq!(bits(found), bits(of_apply), "row {row}");
            }
        }
        assert_eq!(count, expected);
    }
}

/// A log of 3000 rows at 50 Hz.
fn fifty_hz() -> String {
    let mut log = "time_s,temp_c,x_pulses_per_s,y_pulses_per_s,z_pulses_per_s\n".to_owned();
    for row in 0..3000 {
        let t = f64::from(row) * 0.02;
        let [x, y, z] = [0.3, 0.7, 11.0].map(|pace| (pace * t).sin());
        log += &format!("{t},{},{x},{y},{z}\n", 20.0 + 0.05 * t + 0.01 * z);
    }
    log
}

#[test]
fn what_does_not_belong_together_is_refused_before_anything_is_written() {
    let bench = fitted("SN1");
    bench.ok("fit long.csv --serial SN2 --out other --model composite --segments 6:45 --no-report");
    bench.ok("fit long.csv --serial SN1 --axis x=x_pulses:pulses --out narrow --model composite --segments 6:45 --no-report");
    let (port, flash) = simulated(&bench, "SN1");
    let port = port.display();
    for (command, expected) in [
        (
            "flash-set other/table.bin --port PORT",
            "of unit \"SN2\", but this is unit \"SN1\"",
        ),
        (
            "flash-set narrow/coefficients.json --port PORT",
            "1 temperature channel(s) of 1 axes, but the unit is built for 1 temperature channel(s) of 3",
        ),
        (
            "flash-set long.csv --port PORT",
            "expected static coefficients",
        ),
        (
            "replay set/table.bin log.csv --target PORT",
            "tempco flash-set SET --port",
        ),
        (
            "flash-set set/table.bin --port none/ttyUSB9",
            "none/ttyUSB9: No such file",
        ),
        ("monitor --port log.csv --count 1", "log.csv: "),
        (
            "monitor --port PORT --period 0",
            "--period 0: expected milliseconds",
        ),
        (
            "replay set/table.bin log.csv --target none/ttyUSB9",
            "none/ttyUSB9: No such file",
        ),
        (
            "replay set/table.bin log.csv --target qemu --real-time",
            "--real-time: expected with --application",
        ),
        (
            "replay set/table.bin log.csv --target qemu --application --board stm32f405",
            "--board stm32f405: expected mps2-an386",
        ),
    ] {
        let ran = bench.run(&command.replace("PORT", &port.to_string()));
        assert_eq!(ran.code, 2, "{command}: {}{}", ran.out, ran.err);
        assert!(ran.err.contains(expected), "{command}: {}", ran.err);
    }
    let kept = flash.lock().unwrap();
    assert!(kept.banks.iter().all(Vec::is_empty));
}

#[test]
fn a_unit_is_watched_line_by_line() {
    let bench = Bench::new();
    let (port, _flash) = simulated(&bench, "SN1");
    let port = port.display();
    let ran = bench.run(&format!("monitor --port {port} --count 2"));
    assert_eq!(ran.code, 0, "{}", ran.err);
    let lines: Vec<&str> = ran.out.lines().collect();
    assert_eq!(lines.len(), 3, "{}", ran.out);
    assert!(
        lines[0].starts_with("unit SN1, simulated 1, 2000 Hz"),
        "{}",
        lines[0]
    );
    assert!(
        lines[0].ends_with("no table: it runs uncompensated"),
        "{}",
        lines[0]
    );
    assert!(
        lines[1].contains("faults: none, overruns 0"),
        "{}",
        lines[1]
    );
    let faults = bench.ok(&format!("faults --port {port}"));
    assert!(faults.contains("| sensor stuck"), "{faults}");
    assert_eq!(faults.lines().count(), 2 + 11 + 2, "{faults}");
    let lost = "lost since power-on: 3 gyro samples, 0 outcomes for telemetry, 0 of replays\n";
    let erased = "erased so far, each half: fault log 12 times, offsets 4\n";
    assert!(faults.ends_with(&format!("{lost}{erased}")), "{faults}");
}

/// A set in deg/h from pulses of 0.5 arcsec, into a unit whose pulses are of 1 arcsec.
#[test]
fn a_set_that_does_not_fit_the_board_is_refused() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 5 --out long.csv");
    for (set, options) in [
        ("set", "--scale-factor 0.5"),
        ("pulses", ""),
        // As a log in deg/h, which does not say by how many arcsec per pulse it was made.
        (
            "unstated",
            "--axis x=x_pulses:dph --axis y=y_pulses:dph --axis z=z_pulses:dph",
        ),
    ] {
        let ran = bench.run(&format!(
            "fit long.csv --serial SN1 {options} --out {set} --model composite --segments 6:45 --no-report"
        ));
        assert!(ran.code < 2, "{}", ran.err);
    }
    let (port, flash) = simulated(&bench, "SN1");
    let port = port.display();
    let fit = |scale_factor_arcsec, max_bias| Fit {
        scale_factor_arcsec,
        max_bias,
        ..FIT
    };
    let fitted = "fitted with 0.5 arcsec per pulse, but the unit turns pulses into angles by 1 ";
    for (command, fit, expected) in [
        ("set/coefficients.json", fit(1.0, 1e6), fitted),
        ("set/table.bin", fit(1.0, 1e6), fitted),
        (
            "set/table.bin --scale-factor 0.5",
            fit(1.0, 1e6),
            "expected coefficients.json; an image holds its own",
        ),
        (
            "set/coefficients.json --scale-factor 1",
            fit(1.0, 1e6),
            "--scale-factor 1: the set was fitted with 0.5",
        ),
        (
            "pulses/table.bin",
            fit(1.0, 1e6),
            "is in pulses/s, but the firmware of the unit was built for deg/h",
        ),
        (
            "unstated/table.bin",
            fit(1.0, 1e6),
            "give coefficients.json and --scale-factor",
        ),
        ("set/table.bin", fit(0.5, 0.01), "raise MAX_TABLE_BIAS"),
    ] {
        flash.lock().unwrap().fit = Some(fit);
        let ran = bench.run(&format!("flash-set {command} --port {port}"));
        assert_eq!(ran.code, 2, "{command}: {}", ran.err);
        assert!(ran.err.contains(expected), "{command}: {}", ran.err);
        assert!(flash.lock().unwrap().banks.iter().all(Vec::is_empty));
    }
    flash.lock().unwrap().fit = Some(fit(0.5, 1e6));
    for set in [
        "set/coefficients.json",
        "set/table.bin",
        "unstated/coefficients.json --scale-factor 0.5",
    ] {
        bench.ok(&format!("flash-set {set} --port {port}"));
    }
}

#[test]
fn the_default_baud_rate_is_that_of_the_boards() {
    let bench = Bench::new();
    let link = fs::read_to_string(root().join("firmware/src/board/stm32f405/link.rs")).unwrap();
    assert!(link.contains("921_600"), "the board's");
    for command in ["flash-set", "monitor", "faults", "replay"] {
        let help = bench.ok(&format!("{command} --help"));
        assert!(help.contains("[default: 921600]"), "{help}");
    }
}
