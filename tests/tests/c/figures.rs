//! What functions of C take of a Cortex-M4F: bytes, executed instructions, stack. The figures are
//! committed; `TEMPCO_BLESS=1` writes them again.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use tempco_elf::{CallGraph, Image};
use tempco_image::{Axis, Channel, Info, Unit, encode};
use tempco_qemu::{Board, build, ensure_target, one_by_one};

use crate::support::{Build, Program, WORKSPACE, arm_gcc, path, said};

const COMMITTED: &str = "tests/tests/c/figures.txt";

/// The most that a call from C may take beyond one from Rust.
const BEYOND_RUST: u64 = 5;
/// The most bytes of the minimal program.
const MOST_WITH_IMAGE: u64 = 16 * 1024;
const MOST_WITH_CONST: u64 = 6 * 1024;

/// The example table, as the firmware has it built in.
#[allow(clippy::all, unreachable_pub, missing_docs, dead_code)]
pub(crate) mod example {
    include!("../../../firmware/tables/example.rs");
}

/// `image.h`: the example table as words of a flash image.
fn image_h() -> String {
    let [table] = &example::TABLES;
    let channel = Channel {
        thermal: *table.thermal().settings(),
        first_edge_c: -15.0,
        last_edge_c: 80.0,
        t_min_c: -15.0,
        t_max_c: 80.0,
        period_s: 0.5,
        axes: Axis::array(&[Axis::new(Unit::PulsesPerS); 3]),
        cells: table.cells().as_flattened(),
    };
    let info = Info {
        serial: example::SERIAL,
        table_crc: example::CRC,
        ..Info::default()
    };
    let mut bytes = vec![0; 16 * 1024];
    let len = encode(&info, &[channel], &mut bytes).unwrap();
    let words = bytes[..len].as_chunks().0.iter();
    let words = words.map(|word| format!("{:#010x}u", u32::from_le_bytes(*word)));
    let words: Vec<String> = words.collect();
    format!(
        "#include <stdint.h>\nstatic const uint32_t image[{}] = {{{}}};\n",
        words.len(),
        words.join(", ")
    )
}

/// Functions of `measure.c` and `startup.c`, which call the archive's.
const PROGRAM: &[&str] = &[
    "reset",
    "main",
    "set_up",
    "both_halves",
    "of_word",
    "print",
    "print_word",
    "semihosting",
    "leave",
];

/// A function of the archive.
struct Called {
    address: u64,
    least: usize,
    most: usize,
}

/// The calls of each function of the archive, of which the trace has every instruction.
fn calls(program: &Program, image: &Image) -> BTreeMap<String, Called> {
    let end = image
        .functions()
        .map(|of| of.address + of.size)
        .max()
        .unwrap();
    let mut command = program.command();
    command
        .args(one_by_one())
        .args(["-d", "exec,nochain", "-dfilter"])
        .arg(format!("0x0..{end:#x}"));
    let trace = said(&mut command);
    let lines = trace.lines().filter(|line| line.starts_with("Trace "));
    let addresses = lines.filter_map(|line| {
        let word = line.split('/').nth(1)?;
        u64::from_str_radix(word, 16).ok()
    });
    let own = PROGRAM.iter().filter_map(|name| image.named(name).ok());
    let own: Vec<_> = own.map(|of| of.address..of.address + of.size).collect();
    let is_own = |address: u64| own.iter().any(|range| range.contains(&address));

    let mut called: BTreeMap<String, Called> = BTreeMap::new();
    let mut calls = addresses.collect::<Vec<_>>();
    calls.dedup_by(|next, before| is_own(*next) && is_own(*before));
    for call in calls.split(|address| is_own(*address)) {
        let Some(&address) = call.first() else {
            continue;
        };
        let name = name_of(&image.at(address).unwrap().name);
        let function = called.entry(name).or_insert(Called {
            address,
            least: usize::MAX,
            most: 0,
        });
        function.least = function.least.min(call.len());
        function.most = function.most.max(call.len());
    }
    called
}

/// Functions of the same code have one address, and the name of any of them.
fn name_of(symbol: &str) -> String {
    let (prefix, name) = symbol.split_once('_').unwrap();
    match prefix {
        "tempco" => symbol.to_owned(),
        _ => format!("tempco3_{name}"),
    }
}

fn measured() -> Option<(String, BTreeMap<String, Called>)> {
    let compiler = arm_gcc()?;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("image.h"), image_h()).unwrap();
    let program = Build::new("measure")
        .source("tests/tests/c/measure.c")
        .flag(&format!("-I{}", folder.path().display()))
        // Each function stays what `PROGRAM` calls it.
        .flag("-fno-inline")
        .flag("-fno-ipa-sra")
        .bare_metal()
        .with(&compiler);
    let image = Image::read(&program.path).unwrap();
    let called = calls(&program, &image);
    let mut table = String::from("function bytes instructions_least instructions_most stack\n");
    for (name, of) in &called {
        let bytes = image.at(of.address).unwrap().size;
        let graph = CallGraph::from(&image, of.address, |_| false).unwrap();
        let stack = graph.deepest_stack().unwrap().bytes;
        writeln!(table, "{name} {bytes} {} {} {stack}", of.least, of.most).unwrap();
    }
    Some((table, called))
}

#[test]
fn functions_take_what_is_committed() {
    let Some((table, called)) = measured() else {
        return;
    };
    println!("{table}");
    let path = path(COMMITTED);
    if std::env::var_os("TEMPCO_BLESS").is_some() {
        fs::write(&path, &table).unwrap();
    }
    compare(&table, &fs::read_to_string(&path).unwrap());

    ensure_target(&WORKSPACE).unwrap();
    let bench = build(&WORKSPACE, Board::Mps2An386, "bench", None).unwrap();
    let bench = Image::read(&bench).unwrap();
    let of_rust = |name: &str| {
        let kernel = bench.named(&format!("kernels::{name}")).unwrap();
        u64::from(kernel.price().unwrap().instructions)
    };
    let of_c = |name: &str| {
        let of = &called[&format!("tempco3_{name}")];
        assert_eq!(of.least, of.most, "{name} takes the same for every input");
        of.most as u64
    };
    for (kernel, calls) in [
        ("subtract", &["correct"][..]),
        ("block8", &["correct_block"]),
        ("thermal", &["thermal_update", "publish"]),
        ("pulses", &["pulses_correct"]),
        ("step", &["step"]),
    ] {
        let taken: u64 = calls.iter().map(|call| of_c(call)).sum();
        println!("{kernel}: Rust {}, C {taken}", of_rust(kernel));
        let most = of_rust(kernel) + BEYOND_RUST * calls.len() as u64;
        assert!(taken <= most, "{kernel}: {taken}, at most {most}");
    }
}

/// Words must be the same, and numbers nearly: another version of the compiler changes some.
fn compare(found: &str, committed: &str) {
    let [mut found, mut committed] = [found, committed].map(str::split_whitespace);
    for (a, b) in found.by_ref().zip(committed.by_ref()) {
        match (a.parse::<u32>(), b.parse::<u32>()) {
            (Ok(a), Ok(b)) => assert!(a.abs_diff(b) <= 8.max(b / 20), "{a}, committed {b}"),
            _ => assert_eq!(a, b),
        }
    }
    assert_eq!((found.next(), committed.next()), (None, None));
}

fn minimal(name: &str, with_image: bool) -> Option<u64> {
    let compiler = arm_gcc()?;
    let build = Build::new(name)
        .source("tests/tests/c/minimal.c")
        .flag("-Wl,--defsym=channel=0x100000,--defsym=image=0x100000")
        .bare_metal();
    let build = if with_image {
        build.define("IMAGE", 1)
    } else {
        build
    };
    let program = build.with(&compiler);
    let sizes = said(Command::new("arm-none-eabi-size").arg(&program.path));
    println!("{name}: {sizes}");
    // Code and constants.
    let text = sizes.lines().nth(1)?.split_whitespace().next()?;
    text.parse().ok()
}

#[test]
fn the_minimal_program_is_small() {
    let Some(with_image) = minimal("image", true) else {
        return;
    };
    assert!(with_image <= MOST_WITH_IMAGE, "{with_image}");
    let with_const = minimal("const", false).unwrap();
    assert!(with_const <= MOST_WITH_CONST, "{with_const}");
}

/// The header says what was measured.
#[test]
fn the_header_says_what_is_committed() {
    let header = |name: &str| fs::read_to_string(include(name)).unwrap();
    let text = header("tempco_axes.h") + &header("tempco.h");
    let table = fs::read_to_string(path(COMMITTED)).unwrap();
    for row in table.lines().skip(1) {
        let [name, _, least, most, stack] = row.split(' ').collect::<Vec<_>>()[..] else {
            panic!("{row}");
        };
        let plain = name.replace("tempco3_", "TEMPCO_N(");
        let call = if plain == name {
            format!("{name}(")
        } else {
            format!("{plain})(")
        };
        let (before, _) = text.split_once(&call).unwrap_or_else(|| panic!("{name}"));
        let comment = before.rsplit("/*").next().unwrap();
        let timing = if least == most {
            format!("Timing: {most}")
        } else {
            format!("Timing: {least} to {most}")
        };
        for words in [timing, format!("Stack: {stack}")] {
            let (_, rest) = comment.split_once(&words).unwrap_or_else(|| {
                panic!("{name}: the header lacks `{words}`");
            });
            assert!(
                !rest.starts_with(|next: char| next.is_ascii_digit()),
                "{name}"
            );
        }
    }
}

fn include(name: &str) -> std::path::PathBuf {
    Path::new(&path("crates/tempco-c/package/include")).join(name)
}
