//! What matters of an instruction.

use crate::cycles::Cost;

/// An instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Where it is.
    pub address: u64,
    /// As an assembler would have it.
    pub text: String,
    /// Whether it is carried out only under a condition: in an IT block, or a conditional branch.
    pub conditional: bool,
    /// Where the program goes on.
    pub flow: Flow,
    /// What becomes of the stack pointer.
    pub stack: Stack,
    /// What it computes, if that is of interest.
    pub arithmetic: Arithmetic,
    pub(crate) cost: Cost,
}

/// Where the program goes on after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// With the next instruction.
    Next,
    /// At an address.
    Jump(u64),
    /// At an address, to come back.
    Call(u64),
    /// At one of several addresses in a table behind the instruction.
    Table,
    /// Where a register says, to come back or not.
    Indirect,
    /// At the caller.
    Return,
}

/// What becomes of the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stack {
    /// Nothing, or it rises.
    Kept,
    /// It sinks by so many bytes.
    Sinks(u32),
    /// It is set to something.
    Unknown,
}

/// Instructions that the step should not contain, or that are worth knowing of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Anything else.
    Other,
    /// A division or square root, of integers or floats: slow, and with data-dependent time for
    /// integers.
    Division,
    /// A fused multiplication and addition: one rounding, other bits than the host's.
    Fused,
    /// A multiplication and addition with two roundings: the host's bits.
    Chained,
    /// Double precision.
    Double,
}
