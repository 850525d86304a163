//! Image `faults KIND`: fails on purpose, to prove that failures are reported and end the run.
//!
//! `panic`, `hardfault` and `interrupt` must exit with 1 and a line in the log; `hang` never exits, and
//! whoever runs it must end it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(target_os = "none")]
mod image {
    use tempco_firmware::target::{arguments, banner, exit};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        banner("faults");
        let kind = arguments::<1>();
        match kind.as_ref().map(|[kind]| kind.as_str()) {
            Some("panic") => panic!("on purpose"),
            Some("hardfault") => cortex_m::asm::udf(),
            Some("interrupt") => {
                cortex_m::peripheral::SCB::set_pendsv();
                cortex_m::asm::isb();
            }
            Some("hang") => loop {
                cortex_m::asm::nop();
            },
            _ => defmt::error!("usage: faults panic|hardfault|interrupt|hang"),
        }
        // Only bad usage comes here.
        exit(false)
    }
}
