//! Tells the crate where selections must be kept from becoming branches.

fn main() {
    println!("cargo:rustc-check-cfg=cfg(selects_by_branch)");
    println!("cargo:rerun-if-changed=build.rs");
    // ARMv6-M has no conditional instructions but branches.
    let target = std::env::var("TARGET").expect("cargo sets TARGET");
    if target.starts_with("thumbv6m") {
        println!("cargo:rustc-cfg=selects_by_branch");
    }
}
