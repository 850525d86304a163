//! Archives: the same bytes again, and no quarrel with other libraries.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempco_dist::{Platform, c_package};
use tempco_qemu::checked;

use crate::support::{
    Build, PLATFORMS, POSIX_COMPILERS, WORKSPACE, archive_of, arm_gcc, package, said,
};

/// Built in two folders. Whatever would be in it of a path, a time or an order is not the same there.
#[test]
fn two_builds_give_the_same_zip() {
    let folder = tempfile::tempdir_in(WORKSPACE.target_dir()).unwrap();
    let second = c_package(&WORKSPACE, &PLATFORMS, folder.path()).unwrap();
    let [first, second] = [package(), &second].map(|path| fs::read(path).unwrap());
    assert!(
        first == second,
        "{} and {} bytes",
        first.len(),
        second.len()
    );
    assert!(first.len() > 50_000);
}

/// No path of this machine is in an archive.
#[test]
fn no_path_is_in_an_archive() {
    for platform in [Platform::LINUX, Platform::M4F] {
        let bytes = fs::read(archive_of(platform)).unwrap();
        let root = WORKSPACE.root().to_str().unwrap().as_bytes();
        for path in [root, b"/rustc/", b".cargo"] {
            assert!(!bytes.windows(path.len()).any(|part| part == path));
        }
    }
}

/// Another Rust library with its own run-time library, which is not hidden.
fn other_library(folder: &Path, target: &str, source: &str) -> std::path::PathBuf {
    let (file, library) = (folder.join("other.rs"), folder.join("libother.a"));
    fs::write(&file, source).unwrap();
    let mut command = Command::new("rustc");
    command
        .args(["--edition", "2024", "--crate-type", "staticlib", "-O"])
        .args(["-C", "panic=abort", "--target", target, "-o"])
        .args([&library, &file])
        .current_dir(WORKSPACE.root());
    checked(&mut command).unwrap_or_else(|error| panic!("{error}"));
    library
}

const CALLS_BOTH: &str = "tests/tests/c/both.c";

#[test]
fn it_links_next_to_a_rust_library_with_std() {
    let folder = tempfile::tempdir().unwrap();
    let source = "#[unsafe(no_mangle)] pub extern \"C\" fn other(x: f32) -> i32 {\
        format!(\"{x:?}\").parse::<f32>().map_or(1, |y| i32::from(x != y)) }";
    let other = other_library(folder.path(), Platform::LINUX.target, source);
    let other = other.to_str().unwrap();
    let build = Build::new("both").source(CALLS_BOTH).define("POSIX", 1);
    // In either order.
    for build in [build.clone().first_library(other), build.library(other)] {
        let build = build.library("-lpthread").library("-ldl").library("-lm");
        assert_eq!(build.with(&POSIX_COMPILERS[0]).run(), "tempco 1 other 0\n");
    }
}

#[test]
fn it_links_next_to_a_rust_library_without_std() {
    if let Some(compiler) = arm_gcc() {
        // Soft float: both have functions for it.
        let mut compiler = compiler;
        compiler.platform = Platform::M3;
        compiler.flags = &["-mcpu=cortex-m3", "-mthumb"];
        let folder = tempfile::tempdir().unwrap();
        let source = "#![no_std]\n\
            #[panic_handler] fn panic(_: &core::panic::PanicInfo) -> ! { loop {} }\n\
            #[unsafe(no_mangle)] pub extern \"C\" fn other(x: f32) -> i32 {\
                [0, 1, 2][(x * 1.5 / 3.0) as usize] }";
        package();
        let other = other_library(folder.path(), compiler.platform.target, source);
        let other = other.to_str().unwrap();
        let build = Build::new("both").source(CALLS_BOTH).bare_metal();
        for build in [build.clone().first_library(other), build.library(other)] {
            assert_eq!(build.with(&compiler).run(), "tempco 1 other 0\n");
        }
    }
}

#[test]
fn sanitizers_and_valgrind_find_nothing() {
    let hostile = Build::new("hostile")
        .source("tests/tests/c/hostile.c")
        .define("AXES", 3)
        .define("SAMPLES", 20_000)
        .define("POSIX", 1);
    let gcc = POSIX_COMPILERS[0];
    let plain = hostile.with(&gcc);
    let expected = plain.run();
    let sanitized = hostile
        .flag("-fsanitize=address,undefined")
        .flag("-fno-sanitize-recover");
    assert_eq!(sanitized.with(&gcc).run(), expected);
    if tempco_qemu::ensure_program(&WORKSPACE, "valgrind", &["valgrind"]).is_err() {
        println!("skipped: there is no valgrind");
        return;
    }
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--error-exitcode=9", "--quiet", "--leak-check=full"]);
    assert_eq!(said(valgrind.arg(&plain.path)), expected);
}
