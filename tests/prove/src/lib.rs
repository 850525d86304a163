//! Proofs on the core's compiled code, and bounds on its rounding.
//!
//! ```text
//! shims -> rustc --emit=llvm-ir -> ir -> smt (translate) -> queries -> bitwuzla and cvc5
//!                                         ^ spec/*.smt2
//! TableData -> gappa (scripts) -> gappa, coqc
//! TableData -> exhaustive (all 2^32 temperatures against f64)
//! ```
//!
//! What is proved holds of the compiler's LLVM IR for the Cortex-M4F; it trusts the translator, the
//! stated preconditions and the backend. See `docs/verification.md`.

pub mod exhaustive;
pub mod gappa;
pub mod ir;
mod layout;
pub mod mutant;
pub mod proof;
pub mod report;
pub mod smt;
pub mod spec;
