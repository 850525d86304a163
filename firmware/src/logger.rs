//! The way out for logs: semihosting, which QEMU and debuggers have, or RTT with the feature `rtt`,
//! which is faster and what `probe-rs` shows.

#[cfg(feature = "rtt")]
use defmt_rtt as _;
#[cfg(not(feature = "rtt"))]
use defmt_semihosting as _;
