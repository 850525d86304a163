//! Images that exist to be measured: what they have in common, and what hosts compute like them.
//!
//! - [`baselines`]: what is usually done instead of the core
//! - [`golden`]: samples and a hash of what becomes of them, to compare host and targets
//! - [`history`]: the built-in table with terms of the thermal history
//! - [`kernels`]: the functions whose instructions the `bench` image counts
//! - `measure`: counts instructions in QEMU; only on a target
//! - `reference`: with the feature `c-reference`, C of the same behaviour next to the core; only on a
//!   target
//! - `guard`: with the feature `link-guard`, a panic that does not link, and calls of what must link
//!   with it; only on a target
//!
//! The images are in `src/bin`; boards, the coefficient table and semihosting are those of
//! `tempco-firmware`. On the host they compile to programs that say so, but for `golden`.
#![no_std]

#[cfg(not(feature = "link-guard"))]
pub mod baselines;
pub mod golden;
#[cfg(all(target_os = "none", feature = "link-guard"))]
pub mod guard;
pub mod history;
pub mod kernels;
#[cfg(target_os = "none")]
pub mod measure;
#[cfg(all(target_os = "none", feature = "c-reference"))]
pub mod reference;

#[cfg(all(test, not(target_os = "none")))]
extern crate std;
