//! Image and program `golden SAMPLES`: hashes of the core's outputs for so many samples.
//!
//! A line is `golden SAMPLES HASH HASH`, after each million and at the end; 0 is the run on
//! subnormal numbers. The second hash is of the table with terms of the thermal history. This is the
//! one image that does the same on the host, so that both can be compared.
#![cfg_attr(target_os = "none", no_std, no_main)]

use tempco_firmware::table::TABLES;
use tempco_test_images::{golden, history::HISTORY};

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    let samples = std::env::args().nth(1).and_then(|word| word.parse().ok());
    let Some(samples) = samples else {
        eprintln!("usage: golden SAMPLES");
        return std::process::ExitCode::from(2);
    };
    golden::run(&TABLES, &HISTORY, samples, |done, hash, history| {
        println!("golden {done} {hash:016x} {history:016x}");
    });
    std::process::ExitCode::SUCCESS
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use tempco_firmware::target::{arguments, banner, exit};

    banner("golden");
    let arguments = arguments::<1>();
    let Some(samples) = arguments.and_then(|[word]| word.parse().ok()) else {
        defmt::error!("usage: golden SAMPLES");
        exit(false)
    };
    golden::run(&TABLES, &HISTORY, samples, |done, hash, history| {
        defmt::println!("golden {=u32} {=u64:016x} {=u64:016x}", done, hash, history);
    });
    exit(true)
}
