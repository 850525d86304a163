//! `table.bin` and `table.h` as `tempco fit` writes them.

use std::fs;
use std::process::Command;

use tempco_fit::load_set;
use tempco_image::{AlignedBytes, Image};
use tempco_tests::Bench;

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

fn aligned(bytes: &[u8]) -> Box<AlignedBytes<65_536>> {
    let mut place = Box::new(AlignedBytes([0xff; 65_536]));
    place.0[..bytes.len()].copy_from_slice(bytes);
    place
}

/// The core's tables from the image and from the JSON are equal to the bit.
#[test]
fn the_image_holds_the_tables_of_the_set() {
    for (model, continuous) in [("--overlap hard", false), ("--model spline", true)] {
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
            data.five_term_table(&cells).unwrap()
        );
    }
}

#[test]
fn inspect_shows_an_image_and_compares_it() {
    let bench = fitted("");
    let shown = bench.ok("inspect set/table.bin --against set/coefficients.json");
    for part in ["unit SN?7", "layout 1.0", "axes in", "the image is that of"] {
        assert!(shown.contains(part), "{shown}");
    }
    bench.ok("fit log.csv --serial SN8 --out other --segments 6:45");
    let ran = bench.run("inspect set/table.bin --against other/coefficients.json");
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert!(ran.err.contains("is not the image of"), "{}", ran.err);

    let good = fs::read(bench.path("set/table.bin")).unwrap();
    let mut flipped = good.clone();
    flipped[200] ^= 4;
    let longer = [&good[..], &[0; 4]].concat();
    for (bytes, expected) in [
        (&flipped, "bad.bin: the CRC of block 0 is wrong"),
        (&longer, "bad.bin: 4 bytes behind the image"),
        (
            &good[..70].to_vec(),
            "bad.bin: 70 bytes, but the image needs 72",
        ),
        (&Vec::new(), "bad.bin: 0 bytes"),
    ] {
        fs::write(bench.path("bad.bin"), bytes).unwrap();
        let ran = bench.run("inspect bad.bin");
        assert_eq!((ran.code, ran.out.as_str()), (2, ""));
        assert!(ran.err.contains(expected), "{}", ran.err);
    }
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

/// Compiled with every warning as an error, included twice, and run: its bytes are those of the
/// image. Skipped, with a printed reason, where there is no C compiler.
#[test]
fn the_c_header_compiles_and_holds_the_same_numbers() {
    let bench = fitted("");
    bench.write(
        "print.c",
        r#"#include <stdio.h>
#include "set/table.h"
#include "set/table.h"
int main(void) {
    fwrite(&tempco_channels[0].thermal, sizeof(tempco_thermal_t), 1, stdout);
    fwrite(&tempco_channels[0].first_edge_c, sizeof(float), 4, stdout);
    fwrite(&tempco_channels[0].cell_count, sizeof(uint32_t), 1, stdout);
    fwrite(tempco_channels[0].cells, sizeof(tempco_terms_t),
           tempco_channels[0].cell_count * TEMPCO_AXES, stdout);
    fputs(TEMPCO_SERIAL, stdout);
    return TEMPCO_CHANNELS - 1;
}
"#,
    );
    let compiled = Command::new("gcc")
        .current_dir(bench.path("."))
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .args(["print.c", "-o", "print"])
        .output();
    let Ok(compiled) = compiled else {
        println!("skipped: there is no gcc");
        return;
    };
    let errors = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{errors}");
    let ran = Command::new(bench.path("print")).output().unwrap();
    assert!(ran.status.success());
    let image = fs::read(bench.path("set/table.bin")).unwrap();
    // The channel as in the image, but for the codes of the units.
    let (head, cells) = (&image[72..136], &image[144..image.len() - 4]);
    assert_eq!(ran.stdout, [head, cells, b"SN?7"].concat());
}
