//! Image and program `golden MILLIONS`: hashes of what the core makes of so many million samples.
//!
//! A line is `golden MILLION HASH HASH`, 0 being the run on subnormal numbers, the second hash that
//! of the table with terms of the thermal history. This is the one image
//! that does the same on the host, so that both can be compared.
#![cfg_attr(target_os = "none", no_std, no_main)]

use tempco_firmware::{golden, history::HISTORY, table::TABLES};

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    let millions = std::env::args().nth(1).and_then(|word| word.parse().ok());
    let Some(millions) = millions else {
        eprintln!("usage: golden MILLIONS");
        return std::process::ExitCode::from(2);
    };
    golden::run(&TABLES, &HISTORY, millions, |million, hash, history| {
        println!("golden {million} {hash:016x} {history:016x}");
    });
    std::process::ExitCode::SUCCESS
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use tempco_firmware::target::{arguments, banner, exit};

    banner("golden");
    let arguments = arguments::<1>();
    let Some(millions) = arguments.and_then(|[word]| word.parse().ok()) else {
        defmt::error!("usage: golden MILLIONS");
        exit(false)
    };
    golden::run(&TABLES, &HISTORY, millions, |million, hash, history| {
        defmt::println!(
            "golden {=u32} {=u64:016x} {=u64:016x}",
            million,
            hash,
            history
        );
    });
    exit(true)
}
