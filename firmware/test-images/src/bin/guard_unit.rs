//! Image `guard_unit`: calls what a unit calls besides the core, which is its image, store, link
//! and sensors, and links only if none of it can panic. Needs the feature `link-guard`.
//!
//! An image of its own, because more is demanded of the core's: no double precision, no recursion
//! and a stack that is known.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(all(target_os = "none", not(feature = "link-guard")))]
#[cortex_m_rt::entry]
fn main() -> ! {
    // Without the feature this would prove nothing: panics link.
    tempco_firmware::target::exit(false)
}

#[cfg(all(target_os = "none", feature = "link-guard"))]
#[cortex_m_rt::entry]
fn main() -> ! {
    use tempco_test_images::guard::{links, report_and_exit, sensors, stores};

    let stored = stores().is_ok();
    let linked = links().is_ok();
    sensors();
    #[cfg(feature = "seeded-panic")]
    {
        use core::hint::black_box;
        black_box(tempco_firmware::table::TABLES[black_box(0)]);
    }
    report_and_exit(stored && linked)
}
