//! Image `fixed`: the integer core over a stream of good and broken samples.
//!
//! Logs `digest HEX SAMPLES`, which must be what the host computes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(target_os = "none")]
mod image {
    use tempco_firmware::fixed::{converted, digest};
    use tempco_firmware::table::{AXES, TABLES};
    use tempco_firmware::target::{banner, exit};
    use tempco_fixed::FixedTable;

    static TABLE: FixedTable<AXES, { TABLES[0].cells().len() }> = converted(&TABLES[0]);

    const SAMPLES: u32 = 120_000;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        banner("fixed");
        defmt::println!("digest {=u32:08x} {=u32}", digest(&TABLE, SAMPLES), SAMPLES);
        exit(true)
    }
}
