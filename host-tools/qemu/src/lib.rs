//! Builds the tempco firmware, runs it in QEMU and reads what it logs.
//!
//! One module per concern, each usable alone:
//!
//! - [`Workspace`]: where the sources are
//! - [`ensure_target`], [`ensure_target_of`], [`ensure_rust_target`], [`ensure_qemu`],
//!   [`ensure_program`]: install what is missing
//! - [`build`]: an image for a [`Board`], with a coefficient table
//! - [`code()`]: the machine code of one of its functions
//! - [`Layout`]: where an image lies in memory, and how much of it it takes
//! - [`run()`]: an image in QEMU, with a time limit, its exit code and its decoded log
//! - [`Machine`]: an image in QEMU in the background, with a line to its first UART
//! - [`replay()`]: a log through the `replay` image
//! - [`guard`]: images that link only if they cannot panic
//! - [`golden`]: hashes of the outputs of host and targets for the same samples
//!
//! [`replay()`] is bytes in and bytes out, in the format of `tempco-replay`. A log through the
//! whole application, over its serial link, is `tempco-hil` on a [`Machine`].
//!
//! ```no_run
//! use tempco_qemu::{Board, Workspace, build, ensure_qemu, ensure_target, replay};
//!
//! # fn samples() -> Vec<u8> { Vec::new() }
//! let workspace = Workspace::find()?;
//! ensure_target(&workspace)?;
//! ensure_qemu(&workspace)?;
//! let image = build(&workspace, Board::Mps2An386, "replay", None)?;
//! let (outcomes, run) = replay(&image, Board::Mps2An386, &samples())?;
//! assert!(run.succeeded(), "{:?}", run.log);
//! # Ok::<(), tempco_qemu::Error>(())
//! ```
#![forbid(unsafe_code)]

mod board;
mod build;
mod code;
mod error;
#[cfg(unix)]
mod gdb;
pub mod golden;
pub mod guard;
mod install;
mod layout;
mod log;
#[cfg(unix)]
mod machine;
#[cfg(unix)]
mod qmp;
mod replay;
mod run;
mod workspace;

pub use board::Board;
pub use build::{Profile, Variant, build, build_host, build_variant, clean_cargo};
pub use code::code;
pub use error::Error;
pub use install::{
    TARGET, checked, ensure_program, ensure_qemu, ensure_rust_target, ensure_target,
    ensure_target_of,
};
pub use layout::{Layout, Sizes};
#[cfg(unix)]
pub use machine::{Machine, MachineOptions, MachineTime, end_all_machines};
pub use replay::replay;
pub use run::{Options, Run, one_by_one, run};
pub use workspace::Workspace;
