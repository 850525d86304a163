//! The header says what the library is.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempco::{Status, ThermalSettings};
use tempco_c::{
    ABI_VERSION, Axis, Channel, Error, INTERVAL_BYTES, ImageInfo, OBJECTS, Output, Point, Ramp,
};
use tempco_dist::symbols::{Symbol, names};

use crate::support::{
    Compiler, PACKAGE, POSIX_COMPILERS, WARNINGS, archive_of, arm_gcc, path, said,
};

fn header(name: &str) -> String {
    fs::read_to_string(path(PACKAGE).join("include").join(name)).unwrap()
}

/// Asserts at compile time: an array of a negative length is refused in C99, too.
fn size_is(of: &str, bytes: usize) -> String {
    let name = of.replace([' ', '*'], "_");
    format!("typedef char size_of_{name}[sizeof({of}) == {bytes}u ? 1 : -1];\n")
}

/// What Rust says of the sizes, where a pointer has so many bytes.
fn sizes(pointer: usize) -> String {
    let mut text = String::from("#include \"tempco.h\"\n#include \"tempco.h\"\n");
    for (object, _) in OBJECTS {
        for axes in [1, 2, 3, 6] {
            let name = format!("tempco{axes}_{}_t", object.name);
            text += &size_is(&name, object.bytes(axes, pointer));
        }
    }
    text += &size_is("tempco_interval_t", INTERVAL_BYTES);
    for (name, bytes) in [
        ("tempco1_ramp_t", size_of::<Ramp<1>>()),
        ("tempco3_ramp_t", size_of::<Ramp<3>>()),
        ("tempco6_ramp_t", size_of::<Ramp<6>>()),
        ("tempco1_output_t", size_of::<Output<1>>()),
        ("tempco3_output_t", size_of::<Output<3>>()),
        ("tempco6_output_t", size_of::<Output<6>>()),
        ("tempco_point_t", size_of::<Point>()),
        ("tempco_axis_t", size_of::<Axis>()),
        ("tempco_image_info_t", size_of::<ImageInfo>()),
        (
            "tempco_thermal_t",
            size_of::<[f32; ThermalSettings::NAMES.len()]>(),
        ),
    ] {
        text += &size_is(name, bytes);
    }
    let before_pointer = std::mem::offset_of!(Channel, cells);
    text += &size_is("tempco_channel_t", before_pointer + pointer);
    text
}

/// Whether a compiler takes a text, with the header in a folder.
fn compiles(compiler: &Compiler, language: &[&str], include: &Path, text: &str) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.c");
    fs::write(&source, text).unwrap();
    let output = Command::new(compiler.program)
        .args(compiler.flags)
        .args(WARNINGS)
        .args(language)
        .arg(format!("-I{}", include.display()))
        .args(["-fsyntax-only".as_ref(), source.as_os_str()])
        .output()
        .unwrap();
    if !output.status.success() {
        println!("{}", String::from_utf8_lossy(&output.stderr));
    }
    output.status.success()
}

fn include() -> PathBuf {
    path(PACKAGE).join("include")
}

/// The compilers that are there, each with the bytes of a pointer.
fn compilers() -> Vec<(Compiler, usize)> {
    let here = POSIX_COMPILERS.into_iter().filter(Compiler::is_there);
    let here = here.map(|compiler| (compiler, 8));
    here.chain(arm_gcc().map(|compiler| (compiler, 4)))
        .collect()
}

const LANGUAGES: [&[&str]; 2] = [&["-std=c99"], &["-std=c++17", "-x", "c++"]];

#[test]
fn sizes_are_those_of_rust_in_c_and_in_cpp() {
    for (compiler, pointer) in compilers() {
        for language in LANGUAGES {
            let text = sizes(pointer);
            assert!(
                compiles(&compiler, language, &include(), &text),
                "{} {language:?}",
                compiler.program
            );
        }
    }
}

/// A wrong size in the header, or one that only one side knows, does not compile.
#[test]
fn a_wrong_size_is_seen() {
    for (right, wrong) in [
        ("TEMPCO_WORDS_(184u, 3u, 8u", "TEMPCO_WORDS_(192u, 3u, 8u"),
        ("TEMPCO_WORDS_(136u, 1u", "TEMPCO_WORDS_(136u, 0u"),
        ("TEMPCO_WORDS_(0u, 1u, 4u", "TEMPCO_WORDS_(0u, 1u, 8u"),
        ("uint16_t samples;", "uint32_t samples;"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let axes = header("tempco_axes.h");
        assert!(axes.contains(right), "{right}");
        fs::write(
            folder.path().join("tempco_axes.h"),
            axes.replace(right, wrong),
        )
        .unwrap();
        fs::write(folder.path().join("tempco.h"), header("tempco.h")).unwrap();
        let taken = compiles(&POSIX_COMPILERS[0], LANGUAGES[0], folder.path(), &sizes(8));
        assert!(!taken, "{wrong}");
    }
}

/// `NAME = NUMBER` in the header.
fn constant(name: &str) -> i64 {
    let text = header("tempco.h");
    let (_, rest) = text
        .split_once(&format!(" {name} = "))
        .unwrap_or_else(|| panic!("{name}"));
    let word = rest.split([',', ' ', '\n']).next().unwrap();
    match word.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16).unwrap(),
        None => word.parse().unwrap(),
    }
}

#[test]
fn codes_flags_and_settings_are_those_of_rust() {
    let text = header("tempco.h");
    for (error, name) in Error::ALL {
        let name = format!("TEMPCO_E_{}", name.to_uppercase());
        assert_eq!(constant(&name), *error as i64);
    }
    assert_eq!(text.matches(" TEMPCO_E_").count(), Error::ALL.len());
    for (flag, name) in Status::NAMES {
        let name = format!("TEMPCO_STATUS_{}", name.to_uppercase());
        assert_eq!(constant(&name), i64::from(flag.bits()));
    }
    assert!(text.contains(&format!("#define TEMPCO_ABI_VERSION {ABI_VERSION}u")));
    let (settings, _) = text.split_once("} tempco_thermal_t;").unwrap();
    let settings = settings.rsplit("typedef struct {").next().unwrap();
    let fields: Vec<&str> = settings
        .lines()
        .filter_map(|line| line.trim().strip_prefix("float ")?.strip_suffix(';'))
        .collect();
    assert_eq!(fields, ThermalSettings::NAMES);
}

/// All that is declared is in the archive, and nothing else is.
#[test]
fn the_archive_has_what_the_header_declares() {
    let gcc = POSIX_COMPILERS[0];
    let mut preprocess = Command::new(gcc.program);
    preprocess
        .args(["-E", "-P"])
        .arg(include().join("tempco.h"));
    let text = said(&mut preprocess);
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let declared: BTreeSet<&str> = text
        .split('(')
        .filter_map(|before| before.trim_end().rsplit(|c| !is_word(c)).next())
        .filter(|name| name.starts_with("tempco"))
        .collect();
    let symbols = names("nm", &archive_of(gcc.platform)).unwrap();
    let defined = symbols.iter().filter(|symbol| symbol.is_defined());
    let defined: BTreeSet<&str> = defined.map(|Symbol { name, .. }| name.as_str()).collect();
    assert_eq!(declared, defined);
    assert!(declared.len() > 80, "{}", declared.len());
}
