//! The coefficient table of a unit as a flash image: `table.bin`.
//!
//! An [`Image`] is read where it lies, in flash or in a buffer: the cells are borrowed, not
//! copied. Reading checks integrity (lengths and CRCs); taking a [`tempco::Table`] out of it
//! checks the contents as well, so that nothing that was not validated can be used. The layout is
//! fixed and little-endian, to the byte, in `docs/flash-image.md`.
//!
//! ```text
//! bytes -> Image::read -> Image::table -> tempco::Table
//!          (integrity)    (contents)      (cells borrowed from the bytes)
//! ```
//!
//! [`Image::expect_fit`] says whether the tables fit the board of a unit.
//!
//! No heap and no panics: whatever the bytes are, the result is a table or an [`ImageError`].
//!
//! # What the CRCs find
//! Each block of 4092 bytes has a CRC-32P4 of its own. Its generator, 0xF4ACFB13, finds every
//! error of up to 5 bits in code words of up to 32768 bits, which is such a block with its CRC;
//! the first 4-bit error that it misses spans 32769 bits. The header has one more at a fixed
//! place, because a CRC whose place depends on a damaged length vouches for nothing. Hence every
//! error of up to 5 bits in an image of any length is found, every burst of up to 32 bits, and
//! all but 2^-32 of others.
//!
//! # Example
//!
//! ```
//! use tempco_image::{AlignedBytes, Axis, Channel, Image, Info, Unit, encode};
//! use tempco::{Terms, ThermalSettings};
//!
//! let cells = [Terms::new([0.1, 0.2, 0.0], [0.5, 0.0])];
//! let channel = Channel {
//!     thermal: ThermalSettings::DEFAULT,
//!     first_edge_c: -40.0,
//!     last_edge_c: 80.0,
//!     t_min_c: -40.0,
//!     t_max_c: 80.0,
//!     period_s: 1.0,
//!     axes: Axis::array(&[Axis::new(Unit::Dph)]),
//!     cells: &cells,
//! };
//! let info = Info { serial: "SN7", continuous: true, ..Info::default() };
//! let mut flash = AlignedBytes([0xff; 512]);
//! encode(&info, &[channel], &mut flash.0)?;
//!
//! let image = Image::read(&flash.0)?;
//! let table = image.table::<1>(0)?;
//! assert_eq!(table.cells()[0], cells);
//! # Ok::<(), tempco_image::ImageError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(target_endian = "big")]
compile_error!("images are used in place, which takes a little-endian processor");

mod axis;
mod channel;
mod check;
mod error;
mod fit;
mod image;
mod layout;
mod unit;
mod write;

#[cfg(test)]
extern crate std;

pub use axis::Axis;
pub use channel::Channel;
pub use check::{BLOCK_LEN, CRC, contents_len, total_len};
pub use error::ImageError;
pub use fit::{Fit, Misfit};
pub use image::{Image, Info};
pub use layout::{
    FORMAT, MAGIC, MAX_CELLS_LEN, MAX_LEN, MAX_SIGNATURE_LEN, MODEL, SERIAL_LEN, max_cells,
};
pub use unit::Unit;
pub use write::{encode, encoded_len};

/// Bytes at an address divisible by 4, as cells that are used in place need them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(4))]
pub struct AlignedBytes<const N: usize>(pub [u8; N]);
