//! From intermediate code to SMT-LIB, and from there to two solvers.

mod accesses;
mod floats;
mod instructions;
mod integers;
mod memory;
mod solver;
mod translate;

pub use memory::{Field, FieldType, Object};
pub use solver::{Answer, Solver, Verdict};
pub use translate::{Translation, translate};

use crate::ir::Type;

/// A value of the code as an SMT-LIB term.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// `i1`
    Bool(String),
    /// Other integers: bits and term.
    Bits(u32, String),
    /// `float`
    Float(String),
    /// `ptr`
    Address(Address),
}

impl Value {
    pub(crate) fn sort(&self) -> Option<String> {
        match self {
            Self::Bool(_) => Some("Bool".to_owned()),
            Self::Bits(bits, _) => Some(format!("(_ BitVec {bits})")),
            Self::Float(_) => Some("F32".to_owned()),
            Self::Address(..) => None,
        }
    }

    pub(crate) fn term(&self) -> Option<&str> {
        match self {
            Self::Bool(term) | Self::Bits(_, term) | Self::Float(term) => Some(term),
            Self::Address(..) => None,
        }
    }

    /// The value of the same type with another term.
    pub(crate) fn named(&self, term: String) -> Self {
        match self {
            Self::Bool(_) => Self::Bool(term),
            Self::Bits(bits, _) => Self::Bits(*bits, term),
            Self::Float(_) => Self::Float(term),
            Self::Address(..) => self.clone(),
        }
    }

    pub(crate) const fn is(&self, ty: Type) -> bool {
        match (self, ty) {
            (Self::Bool(_), Type::Int(1))
            | (Self::Float(_), Type::Float)
            | (Self::Address(..), Type::Ptr) => true,
            (Self::Bits(have, _), Type::Int(bits)) => *have == bits,
            _ => false,
        }
    }
}

/// A place in an object.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Address {
    /// Number of the object.
    pub(crate) object: usize,
    /// Offset \[bytes\], but for what depends on data.
    pub(crate) offset: usize,
    /// How many words further it is, where that depends on data: a term of 32 bits, and the most
    /// that it can be.
    pub(crate) words: Option<(String, usize)>,
}

/// A constant of so many bits.
pub(crate) fn bits(bits: u32, value: i128) -> String {
    let mask = (1_u128 << bits) - 1;
    format!("(_ bv{} {bits})", value as u128 & mask)
}

/// A float by its bits.
pub(crate) fn float_bits(value: u32) -> String {
    format!("((_ to_fp 8 24) (_ bv{value} 32))")
}
