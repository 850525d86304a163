//! Makes what is shipped of tempco.
//!
//! - [`Platform`]: the processors and systems that archives are for
//! - [`archive()`]: the static library for one of them, one object without a foreign name
//! - [`symbols`]: the names in it, and what is wrong with them
//! - [`c_package()`]: archives, header and modules for build systems as a zip
//! - [`command()`]: the `tempco` command as a zip
//! - [`Tree`]: files on their way into a zip whose bytes depend on nothing else
#![forbid(unsafe_code)]

mod archive;
mod command;
mod package;
mod platform;
pub mod symbols;
mod tree;

pub use archive::archive;
pub use command::command;
pub use package::c_package;
pub use platform::Platform;
pub use tree::Tree;

/// The version of what is shipped.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
