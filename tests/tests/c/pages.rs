//! The pages for C are followed to the letter, from the zip, in a folder outside of the workspace.

use std::fs::{self, File};
use std::process::Command;

use tempco::{Corrector, Interval, RampBuffer, ThermalHalf};
use tempco_image::{AlignedBytes, Image};
use tempco_qemu::ensure_program;
use tempco_tests::page::{blocks, file_name, follow, shell};
use tempco_tests::{Bench, root};

use crate::support::{PACKAGE, POSIX_COMPILERS, WARNINGS, WORKSPACE, arm_gcc, package, path, said};

fn text(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

/// A folder with the zip unpacked as `tempco`.
fn scratch() -> Bench {
    let bench = Bench::new();
    let zip = File::open(package()).unwrap();
    zip::ZipArchive::new(zip)
        .unwrap()
        .extract(bench.path(""))
        .unwrap();
    let name = package().file_stem().unwrap();
    fs::rename(bench.path(&name.to_string_lossy()), bench.path("tempco")).unwrap();
    bench
}

/// What `gyro.c` of the page puts out, by the core.
fn expected(table_bin: &[u8]) -> String {
    let mut place = AlignedBytes([0xff; 65_536]);
    place.0[..table_bin.len()].copy_from_slice(table_bin);
    let image = Image::read(&place.0).unwrap();
    let table = image.table::<3>(0).unwrap();
    let ramps = RampBuffer::new();
    let mut half = ThermalHalf::new(&table, 200);
    half.start(21.5);
    let interval = Interval::new(table.thermal(), 0.1);
    let mut corrected = [0.0; 3];
    for _ in 0..10 {
        ramps.publish(&half.update(&interval, 21.5));
        for _ in 0..200 {
            corrected = Corrector::new(&ramps).correct([0.5, 0.25, -0.75]);
        }
    }
    let bits = corrected.map(|value: f32| format!("{:08x} ", value.to_bits()));
    format!("corrected, as bits: {}settling", bits.concat())
}

#[test]
fn the_guide_leads_to_a_unit_that_runs() {
    if arm_gcc().is_none() {
        return;
    }
    let bench = scratch();
    let said = follow(&text("docs/c.md"), &bench.path(""), &[]);
    let expected = expected(&fs::read(bench.path("set/table.bin")).unwrap());
    assert!(said.contains(&expected), "{expected}\n{said}");
}

#[test]
fn the_page_in_the_zip_works() {
    if arm_gcc().is_none() {
        return;
    }
    let bench = scratch();
    let page = fs::read_to_string(bench.path("tempco/README.md")).unwrap();
    let said = follow(&page, &bench.path("tempco"), &[]);
    assert!(said.contains("usage: apply table.bin log.csv"), "{said}");
    assert!(said.contains("x y z "), "{said}");
}

/// Shorter pieces of C: they compile as the body of a function.
#[test]
fn fragments_compile() {
    for (page, fragments) in [("docs/c.md", 1), ("README.md", 1)] {
        let text = text(page);
        let of_page = blocks(&text).into_iter();
        let of_page: Vec<_> = of_page
            .filter(|(language, block)| *language == "c" && file_name(block).is_none())
            .collect();
        assert_eq!(of_page.len(), fragments, "{page}");
        for (_, fragment) in of_page {
            let is_directive = |line: &&str| line.starts_with('#');
            let directives: Vec<&str> = fragment.lines().filter(is_directive).collect();
            let body: Vec<&str> = fragment
                .lines()
                .filter(|line| !is_directive(line))
                .collect();
            let source = format!(
                "{}\n#include \"tempco.h\"\nextern float temp_c, sample[3];\n\
                 int32_t body(void);\nint32_t body(void)\n{{\n\
                 static tempco3_table_t table;\n{}\nreturn code;\n}}\n",
                directives.join("\n"),
                body.join("\n")
            );
            let bench = Bench::new();
            bench.write("body.c", &source);
            let mut compile = Command::new(POSIX_COMPILERS[0].program);
            let examples = path(PACKAGE).join("examples/bare-metal");
            compile
                .args(WARNINGS)
                .args(["-std=c99", "-fsyntax-only", "-I"])
                .arg(path(PACKAGE).join("include"))
                .arg("-I")
                .arg(examples)
                .arg(bench.path("body.c"));
            said(&mut compile);
        }
    }
}

/// The lines for CMake, in a project for this machine and in one for the board.
#[test]
fn cmake_finds_the_archive() {
    if let Err(missing) = ensure_program(&WORKSPACE, "cmake", &["cmake", "make"]) {
        println!("skipped: {missing}");
        return;
    }
    let page = text("docs/c.md");
    let (_, lines) = blocks(&page)
        .into_iter()
        .find(|(language, _)| *language == "cmake")
        .unwrap();
    let bench = scratch();
    let project = |sources: &str| {
        let head = "cmake_minimum_required(VERSION 3.16)\nproject(firmware C)\n";
        format!("{head}add_executable(firmware {sources})\n{lines}")
    };
    bench.write("CMakeLists.txt", &project("tempco/examples/apply/apply.c"));
    let folder = bench.path("");
    shell(
        &folder,
        "cmake -S . -B here >&2 && cmake --build here >&2",
        &[],
    );
    let said = shell(&folder, "here/firmware || true", &[]);
    assert!(said.contains("usage: apply"), "{said}");
    if arm_gcc().is_none() {
        return;
    }
    let board = "tempco/examples/bare-metal";
    let sources = format!("{board}/main.c {board}/startup.c");
    bench.write("CMakeLists.txt", &project(&sources));
    let flags = "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -nostdlib";
    let script = format!(
        "cmake -S . -B board -DCMAKE_SYSTEM_NAME=Generic -DCMAKE_C_COMPILER=arm-none-eabi-gcc \
         -DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY -DCMAKE_C_FLAGS='{flags}' \
         -DCMAKE_EXE_LINKER_FLAGS='-T {}/{board}/mps2-an386.ld' >&2 && cmake --build board -v",
        folder.display()
    );
    let said = shell(&folder, &script, &[]);
    assert!(
        said.contains("lib/thumbv7em-none-eabihf/libtempco.a"),
        "{said}"
    );
}
