//! Checks what is, and what is not, in a tempco image, on the very bytes that are flashed.
//!
//! - [`Image`]: the functions of an ELF file, disassembled
//! - [`Kernel`]: what one function and all it calls consist of: branches, loops, divisions
//! - [`CallGraph`]: who calls whom, recursion, and the deepest stack
//! - [`forbidden_symbols`]: symbols by which panics, formatting and soft double precision show
//! - [`Function::price`], [`price()`]: the instructions of straight or traced code, and an estimate of
//!   their cycles
//! - [`Lines`]: where in the sources an instruction comes from
//! - [`rules`]: what the core may consist of, for every function that runs per sample
//!
//! What cannot be understood is an error, never passed over: an instruction that does not decode,
//! a stack pointer that is set in an unknown way, a call whose target is not in the code.
//!
//! The disassembler is capstone: of those that can be used from Rust and are maintained, it is the
//! one that knows the floating-point instructions of Cortex-M.
#![forbid(unsafe_code)]

mod cycles;
mod decode;
mod error;
mod graph;
mod image;
mod instruction;
mod kernel;
mod lines;
pub mod rules;
mod symbols;
#[cfg(test)]
mod tests;

pub use cycles::{Price, price};
pub use error::Error;
pub use graph::{CallGraph, Depth};
pub use image::{Function, Image};
pub use instruction::{Arithmetic, Flow, Instruction, Stack};
pub use kernel::{Kernel, Site};
pub use lines::Lines;
pub use symbols::{Family, forbidden_symbols, is_failure_path};
