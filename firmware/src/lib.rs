//! The tempco firmware: what is the same on every board and on the host.
//!
//! - [`app`]: replays a log, generic over `embedded-io`; runs and is tested on the host too
//! - [`table`]: the coefficient table built into the image
//! - [`board`]: what differs between boards
//! - `target`: semihosting, panics and faults; only on a target
//! - `logger`: where logs go
//! - [`unit`](mod@unit): the application of gyro electronics, with its sampling interrupt, link and store
//! - [`fifo_gyro`]: a gyro with a FIFO, between its interrupt and the sampling
//! - `idle`, `reset`, `sample_clock`, `stack`: what the application needs of a Cortex-M
//!
//! The images are in `src/bin`, those that exist to be measured in the package
//! `tempco-test-images`. On the host they compile to programs that say so.
#![no_std]

// First: its macros are used by what follows.
#[macro_use]
mod log;

pub mod app;
pub mod board;
pub mod fifo_gyro;
#[cfg(all(target_os = "none", feature = "application"))]
pub mod idle;
#[cfg(all(
    target_os = "none",
    any(
        all(feature = "application", feature = "log"),
        not(any(feature = "application", feature = "link-guard"))
    )
))]
mod logger;
pub mod queue;
#[cfg(all(target_os = "none", feature = "application"))]
pub mod reset;
#[cfg(all(target_os = "none", feature = "application"))]
pub mod sample_clock;
#[cfg(all(
    target_os = "none",
    any(feature = "application", feature = "link-guard")
))]
pub mod stack;
pub mod table;
#[cfg(all(
    target_os = "none",
    not(any(feature = "application", feature = "link-guard"))
))]
pub mod target;
pub mod unit;

#[cfg(not(target_os = "none"))]
extern crate std;

/// What an image does where there is no target to run on.
#[cfg(not(target_os = "none"))]
pub fn host_main() -> std::process::ExitCode {
    std::eprintln!(
        "This is a firmware image compiled for the host, where it does nothing. \
         Build it with --target thumbv7em-none-eabihf."
    );
    std::process::ExitCode::from(2)
}
