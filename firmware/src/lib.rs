//! The tempco firmware: what is the same on every board and on the host.
//!
//! - [`app`]: replays a log, generic over `embedded-io`; runs and is tested on the host too
//! - [`table`]: the coefficient table built into the image
//! - [`board`]: what differs between boards
//! - [`baselines`]: what is usually done instead
//! - [`golden`]: samples and a hash of what becomes of them, to compare host and targets
//! - [`history`]: the same table with terms of the thermal history
//! - [`kernels`]: the functions whose instructions the `bench` image counts
//! - `measure`: counts instructions in QEMU; only on a target
//! - `target`: semihosting, panics and faults; only on a target
//! - `logger`: where logs go
//! - [`unit`](mod@unit): the application of gyro electronics, with its sampling interrupt, link and store
//! - `idle`, `reset`, `sample_clock`, `stack`: what the application needs of a Cortex-M
//! - `guard`: in place of `target` with the feature `link-guard`, a panic that does not link, and
//!   calls of what must link with it
//!
//! The images are in `src/bin`. On the host they compile to programs that say so.
#![no_std]

// First: its macros are used by what follows.
#[macro_use]
mod log;

pub mod app;
#[cfg(not(feature = "link-guard"))]
pub mod baselines;
pub mod board;
pub mod golden;
#[cfg(all(target_os = "none", feature = "link-guard"))]
pub mod guard;
pub mod history;
#[cfg(all(target_os = "none", feature = "application"))]
pub mod idle;
pub mod kernels;
#[cfg(all(
    target_os = "none",
    any(
        all(feature = "application", feature = "log"),
        not(any(feature = "application", feature = "link-guard"))
    )
))]
mod logger;
#[cfg(target_os = "none")]
pub mod measure;
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
