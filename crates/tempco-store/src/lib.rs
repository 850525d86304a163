//! Keeps a unit's coefficient table in NOR flash, in two copies, a log of its faults, the constant
//! biases that re-zero found, and the numbers of boots and sessions.
//!
//! Each of two slots holds a flash image (see `tempco-image`) and behind it a few *entries*, each
//! of which says that the image was whole and validated, and whether it was selected. The entry with
//! the highest sequence number names the table in use. An update touches the other slot only, and
//! stores an image there with its last write, the entry. A selection is one more entry:
//!
//! ```text
//! begin: erase the sector with the entries of the slot not in use
//! write: erase a sector when it is first written to, program, chunk by chunk
//! commit: read back -> CRCs -> validation -> program one entry, number 0
//! select: load -> CRCs -> validation -> program one entry, the next number
//! ```
//!
//! So a power cut at any operation leaves the old table in use or the new one. An image that was
//! stored and not selected is never used. The other slot is selected likewise, which is the roll-back.
//! An entry that a cut has torn is not used, be it wrong or unreadable, and its place is not used
//! again.
//!
//! # Layout of a slot
//!
//! | offset | content |
//! |---|---|
//! | 0 | image, padded with 0xff to a whole word of the flash |
//! | `len - 8 s` | eight entries of `s` bytes: 32, or the word of the flash if that is longer |
//!
//! An entry is eight little-endian u32: magic, sequence number (0 stored, from 1 on
//! selected), length of the image, its CRC-32P4, three times 0xffffffff, and the CRC-32P4 of the 28 bytes before.
//!
//! A fixed layout instead of a general flash store, because the image is to lie in one piece at an
//! address that is known and aligned, so that a table can be used in place, and may be larger than
//! a sector.
//!
//! # Faults and offsets
//! [`FaultLog`] and [`Offsets`] have a region each of two halves, of which one is in use at a time:
//!
//! ```text
//! append: program one entry behind the others
//! turn, when the half is full: erase the other half -> the latest entry of each key -> a mark
//! ```
//!
//! An entry is a few little-endian u32, padded with 0xff to whole words of the flash: magic, key,
//! contents, and the CRC-32P4 of what is before. The mark has 0xffffffff for the key and then
//! the number of the turn. The half with the later mark counts, and in it the latest entry of a key.
//! Offsets have key 0 of their region, the numbers of boots and sessions key 1. The number of the turn is
//! also the count of erasures, two turns for each half: a fault log that has had 10,000 is written no
//! more.
//!
//! # Boot
//! [`Store::boot`] tries the slots, the latest first: load, CRCs, the caller's validation. It makes
//! two attempts and returns in any case; with no good slot, it says why for each, and the unit
//! runs uncompensated. Flash that cannot be read is a slot that is not good, so drivers must
//! return an error where the hardware finds more wrong bits than it corrects, and not fault.
//!
//! Nothing is cached but what [`Store`] says, and no method loops over more than the flash it
//! was given.
#![no_std]
#![forbid(unsafe_code)]

mod check;
mod entry;
mod error;
mod faults;
mod journal;
mod offsets;
mod region;
mod slot;
mod store;
mod update;

pub use check::Checked;
pub use entry::MAX_WRITE_SIZE;
pub use error::StoreError;
pub use faults::{Fault, FaultLog};
pub use offsets::{Numbers, Offsets};
pub use region::Region;
pub use slot::Slot;
pub use store::{Active, Boot, SlotState, Store};
