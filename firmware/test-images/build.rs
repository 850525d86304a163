//! Says how images are linked, as the build script of `tempco-firmware` does; the board's memory and
//! the coefficient table come from there. Compiles the C of the same behaviour, if it is wanted.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let os = std::env::var("CARGO_CFG_TARGET_OS").expect("cargo sets CARGO_CFG_TARGET_OS");
    if os == "none" {
        for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
        #[cfg(feature = "c-reference")]
        reference();
    }
}

/// Compiles the C for the reference board, once for each level of optimisation.
#[cfg(feature = "c-reference")]
fn reference() {
    println!("cargo:rerun-if-changed=c/reference.c");
    for level in [2, 3] {
        cc::Build::new()
            .compiler("arm-none-eabi-gcc")
            .file("c/reference.c")
            .define("PREFIX", format!("c_o{level}_").as_str())
            .opt_level(level)
            .std("c99")
            .pic(false)
            .force_frame_pointer(false)
            .flags(["-ffp-contract=off", "-mcpu=cortex-m4"])
            .flags(["-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"])
            .extra_warnings(true)
            .warnings_into_errors(true)
            .compile(&format!("reference_o{level}"));
    }
}
