//! `table.bin` and `table.h` as `tempco fit` writes them.

use std::fs;
use std::process::Command;

use serde_json::Value;
use tempco_image::{AlignedBytes, Image, Info, contents_len, encode};
use tempco_set::{CoefficientSet, load_set, table_bin, table_h};
use tempco_tests::history::add_history;
use tempco_tests::{Bench, root};

fn fitted(model: &str) -> Bench {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 5 --out log.csv");
    // Whether neighbouring segments agree (exit code 0 or 1) is not the matter here.
    let ran = bench.run(&format!(
        "fit log.csv --serial SN?7 --out set --segments 6:30,20:45 {model}"
    ));
    assert!(ran.code < 2, "{}", ran.err);
    bench
}

/// The set with history terms, written as `with/coefficients.json`, `with/table.bin` and
/// `with/table.h`.
fn with_history(bench: &Bench) -> CoefficientSet {
    let mut set = load_set(&bench.path("set/coefficients.json")).unwrap();
    add_history(&mut set);
    fs::create_dir(bench.path("with")).unwrap();
    let json = serde_json::to_string(&set).unwrap();
    bench.write("with/coefficients.json", &json);
    bench.write("with/table.h", &table_h(&set));
    fs::write(bench.path("with/table.bin"), table_bin(&set).unwrap()).unwrap();
    set
}

fn aligned(bytes: &[u8]) -> Box<AlignedBytes<65_536>> {
    let mut place = Box::new(AlignedBytes([0xff; 65_536]));
    place.0[..bytes.len()].copy_from_slice(bytes);
    place
}

/// The core's tables from the image and from the JSON are equal to the bit.
#[test]
fn the_image_holds_the_tables_of_the_set() {
    for (model, continuous) in [
        ("--model composite --overlap hard", false),
        ("--model auto", true),
    ] {
        let bench = fitted(model);
        let place = aligned(&fs::read(bench.path("set/table.bin")).unwrap());
        let set = load_set(&bench.path("set/coefficients.json")).unwrap();
        let image = Image::read(&place.0).unwrap();
        assert_eq!(image.info().continuous, continuous, "{model}");
        assert_eq!(image.info().serial, "SN?7");
        assert_eq!(image.info().table_crc, set.crc32());
        assert_eq!(image.channels(), set.channels.len());
        let data = &set.channels[0].table;
        let cells = data.terms::<3>(0);
        assert_eq!(
            image.table::<3>(0).unwrap(),
            data.table_over(0, &cells).unwrap()
        );

        let data = &with_history(&bench).channels[0].table;
        let place = aligned(&fs::read(bench.path("with/table.bin")).unwrap());
        let image = Image::read(&place.0).unwrap();
        let cells = data.terms::<3>(0);
        let table = data.table_over(0, &cells).unwrap();
        assert_eq!(table.play_gains()[0], [0.25, -0.5, 0.125]);
        assert_eq!(image.table::<3>(0).unwrap(), table);
    }
}

#[test]
fn inspect_shows_an_image_and_compares_it() {
    let bench = fitted("--model composite");
    let shown = bench.ok("inspect set/table.bin --against set/coefficients.json");
    for part in ["unit SN?7", "layout 2.0", "axes in", "the image is that of"] {
        assert!(shown.contains(part), "{shown}");
    }
    bench.ok("fit log.csv --serial SN8 --out other --model composite --segments 6:45");
    let ran = bench.run("inspect set/table.bin --against other/coefficients.json");
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert!(ran.err.contains("is not the image of"), "{}", ran.err);

    with_history(&bench);
    let shown = bench.ok("inspect with/table.bin --against with/coefficients.json");
    let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "play: half width 2.5 degC, gain per degC 0.25 pulses/s, -0.5 pulses/s, 0.125 pulses/s",
        "play: half width 8 degC",
        "second lag: tau 900 s, -3.5 to 4.25 degC",
        "the image is that of with",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    let ran = bench.run("inspect with/table.bin --against set/coefficients.json");
    assert_eq!(ran.code, 1, "{}", ran.err);

    let good = fs::read(bench.path("set/table.bin")).unwrap();
    let mut flipped = good.clone();
    flipped[200] ^= 4;
    let longer = [&good[..], &[0; 4]].concat();
    for (bytes, expected) in [
        (&flipped, "bad.bin: the CRC of block 0 is wrong"),
        (&longer, "bad.bin: 4 bytes behind the image"),
        (
            &good[..70].to_vec(),
            "bad.bin: 70 bytes, but the image needs 80",
        ),
        (&Vec::new(), "bad.bin: 0 bytes"),
    ] {
        fs::write(bench.path("bad.bin"), bytes).unwrap();
        let ran = bench.run("inspect bad.bin");
        assert_eq!((ran.code, ran.out.as_str()), (2, ""));
        assert!(ran.err.contains(expected), "{}", ran.err);
    }
}

/// With history terms too, which only some sets have.
#[test]
fn an_image_is_applied_and_evaluated_as_the_set_it_is_made_from() {
    let bench = fitted("--model composite");
    with_history(&bench);
    for folder in ["set", "with"] {
        let result = |file: &str| {
            let set = format!("{folder}/{file}");
            bench.ok(&format!("apply {set} log.csv --out {file}.csv"));
            let out = fs::read_to_string(bench.path(&format!("{file}.csv"))).unwrap();
            // Whether the log is good enough (exit code 0 or 1) is not the matter here.
            let ran = bench.run(&format!("evaluate {set} log.csv --tau 10 --json"));
            let mut evaluation: Value = serde_json::from_str(&ran.out).unwrap();
            let role = evaluation["log"]["role"].take();
            // What only the fit knows.
            for key in ["segments", "verdict", "verified", "warnings"] {
                evaluation[key].take();
            }
            for axis in evaluation["axes"].as_array_mut().unwrap() {
                axis["boundaries"].take();
                axis["coefficient_sigmas"].take();
            }
            // A trend rejects unless the log is known to be a training log.
            let rejections = evaluation["rejections"].as_array_mut().unwrap();
            rejections.retain(|of| {
                let is_trend = of["code"].as_str().unwrap().starts_with("trend_");
                !is_trend && of["message"].as_str().unwrap().contains("on log.csv")
            });
            (out, evaluation, role)
        };
        let of_set = result("coefficients.json");
        let of_image = result("table.bin");
        assert_eq!((&of_image.0, &of_image.1), (&of_set.0, &of_set.1));
        assert_eq!(
            (of_set.2, of_image.2),
            ("training".into(), "unknown".into())
        );
    }
    let out = bench.run("evaluate with/coefficients.json log.csv --against set/table.bin --tau 10");
    assert!(
        out.out.contains("the set of unit SN?7"),
        "{}{}",
        out.out,
        out.err
    );
}

#[test]
fn an_image_is_refused_for_a_log_of_other_axes_or_units() {
    let bench = fitted("--model composite");
    for (command, expected) in [
        (
            "apply set/table.bin log.csv --out out.csv --axis x=x_pulses:pulses",
            "set/table.bin: log.csv: temperature channels with [1] axes: the image has [3]",
        ),
        (
            "apply set/table.bin log.csv --out out.csv --scale-factor 2",
            "axis `x` is in dph, but the image expects pulses_per_s",
        ),
        (
            "evaluate set/table.bin log.csv --report report.html",
            "set/table.bin: expected coefficients.json",
        ),
        (
            "evaluate set/table.bin log.csv --sign-off --tau 10",
            "set/table.bin: expected coefficients.json",
        ),
    ] {
        let ran = bench.run(command);
        assert_eq!(ran.code, 2, "{command}: {}", ran.out);
        assert!(ran.err.contains(expected), "{command}: {}", ran.err);
    }
    assert_eq!(bench.files(), ["log.csv", "set"]);

    // An image whose name for its table is not that of its numbers.
    let place = aligned(&fs::read(bench.path("set/table.bin")).unwrap());
    let image = Image::read(&place.0).unwrap();
    let info = Info {
        table_crc: 1,
        ..*image.info()
    };
    let mut renamed = vec![0; image.bytes().len()];
    encode(&info, &[image.channel(0).unwrap()], &mut renamed).unwrap();
    fs::write(bench.path("renamed.bin"), renamed).unwrap();
    let ran = bench.run("apply renamed.bin log.csv --out out.csv");
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains("the image names table 00000001"),
        "{}",
        ran.err
    );
}

#[test]
fn a_serial_number_that_no_image_can_hold_is_refused() {
    let bench = Bench::new();
    bench.ok("simulate --unit paper --profile short --seed 5 --out log.csv");
    let serial = "S".repeat(33);
    let ran = bench.run(&format!("fit log.csv --serial {serial} --out set"));
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("expected 1 to 32 bytes"), "{}", ran.err);
    assert_eq!(bench.files(), ["log.csv"]);
}

/// Compiled with every warning as an error, included twice, and run: its bytes equal the
/// image. Skipped, with a printed reason, where there is no C compiler.
#[test]
fn the_c_header_compiles_and_holds_the_same_numbers() {
    let bench = fitted("--model composite");
    with_history(&bench);
    for folder in ["set", "with"] {
        let Some(printed) = printed_by_c(&bench, folder) else {
            println!("skipped: there is no gcc");
            return;
        };
        let image = fs::read(bench.path(&format!("{folder}/table.bin"))).unwrap();
        // The channel as in the image, but for the codes of the units.
        let (head, rest) = image[80..contents_len(image.len()).unwrap()].split_at(116);
        let (axes, cells) = rest.split_at(3 * 28);
        let axes: Vec<u8> = axes
            .chunks(28)
            .flat_map(|axis| &axis[4..])
            .copied()
            .collect();
        let axis_count = 3_u32.to_le_bytes();
        let expected = [head, &axis_count, &axes, cells, b"SN?7"].concat();
        assert_eq!(printed, expected, "{folder}");
    }
}

/// What a program prints that was compiled with `folder/table.h`: the numbers in the order of the
/// image.
fn printed_by_c(bench: &Bench, folder: &str) -> Option<Vec<u8>> {
    let program = r#"#include <stdio.h>
#include "table.h"
#include "table.h"
int main(void) {
    const tempco_channel_t *channel = &tempco_channels[0];
    fwrite(&channel->thermal, sizeof(tempco_thermal_t), 1, stdout);
    fwrite(&channel->first_edge_c, sizeof(float), 5, stdout);
    fwrite(&channel->cell_count, sizeof(uint32_t), 2, stdout);
    fwrite(channel->axes, sizeof(tempco_axis_t), TEMPCO_AXES, stdout);
    fwrite(channel->cells, sizeof(tempco_terms_t), channel->cell_count * TEMPCO_AXES, stdout);
    fputs(TEMPCO_SERIAL, stdout);
    return TEMPCO_CHANNELS - 1;
}
"#;
    bench.write(&format!("{folder}/print.c"), program);
    let compiled = Command::new("gcc")
        .current_dir(bench.path(folder))
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .arg("-I")
        .arg(root().join("crates/tempco-c/package/include"))
        .args(["print.c", "-o", "print"])
        .output()
        .ok()?;
    let errors = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{errors}");
    let ran = Command::new(bench.path(folder).join("print"))
        .output()
        .unwrap();
    assert!(ran.status.success());
    Some(ran.stdout)
}
