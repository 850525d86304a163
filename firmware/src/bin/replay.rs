//! Image `replay SAMPLES OUTCOMES`: replays a log from one file of the host into another.
//!
//! Exit code 0 if the whole log was replayed, else 1; what happened is in the defmt log.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(target_os = "none")]
mod image {
    use tempco_firmware::target::{Input, Output, arguments, banner, exit};
    use tempco_firmware::{app, table};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        banner("replay");
        exit(run().is_some())
    }

    /// `None` after an error, which is reported where it is found.
    fn run() -> Option<()> {
        let Some([samples, outcomes]) = arguments() else {
            defmt::error!("usage: replay SAMPLES OUTCOMES");
            return None;
        };
        let input = Input::open(&samples)
            .inspect_err(|error| defmt::error!("opening {=str}: {}", samples.as_str(), error))
            .ok()?;
        let output = Output::create(&outcomes)
            .inspect_err(|error| defmt::error!("creating {=str}: {}", outcomes.as_str(), error))
            .ok()?;
        let summary = app::replay(&table::TABLES, table::CRC, input, output)
            .inspect_err(|error| defmt::error!("{}", error))
            .ok()?;
        defmt::info!("{}", summary);
        defmt::info!("worst {}", summary.worst());
        Some(())
    }
}
