//! The layout to the byte, as structures that reader and writer share; in words in
//! `docs/flash-image.md`.

use core::mem::{offset_of, size_of};

use tempco::{MAX_AXES, PLAYS, Terms, ThermalSettings};
use zerocopy::little_endian::{F32, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// The first bytes of every image.
pub const MAGIC: [u8; 8] = *b"TCTABLE\n";
/// Version of the layout, major and minor. A reader refuses another major; a newer minor only
/// adds fields that it may pass over.
pub const FORMAT: (u16, u16) = (2, 0);
/// Version of the equations, major and minor; refused likewise.
pub const MODEL: (u16, u16) = (2, 0);
/// Bytes of the serial number, which is padded with zeros.
pub const SERIAL_LEN: usize = 32;
/// The most bytes of a signature.
pub const MAX_SIGNATURE_LEN: usize = 128;
/// The most bytes of the cells of an image, all channels together.
pub const MAX_CELLS_LEN: usize = 24 * 1024;
/// Bytes of the longest image that this version writes.
pub const MAX_LEN: usize = crate::total_len(
    HEADER_LEN + MAX_AXES * (CHANNEL_LEN + AXIS_LEN) + MAX_CELLS_LEN + MAX_SIGNATURE_LEN,
);

/// The most cells of each channel of a unit that has so many axes, all channels together.
pub const fn max_cells(axes: usize) -> usize {
    let of_axis = MAX_CELLS_LEN / TERMS_LEN;
    match of_axis.checked_div(axes) {
        Some(cells) => cells,
        None => 0,
    }
}

/// Flag: neighbouring cells meet, and the reader checks it.
pub(crate) const CONTINUOUS: u32 = 1;

/// The head of an image.
#[derive(FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(crate) struct RawHeader {
    pub(crate) magic: [u8; 8],
    pub(crate) format: [U16; 2],
    /// Of the whole image, CRCs included.
    pub(crate) total_len: U32,
    /// Of this header with what a newer minor version adds to it.
    pub(crate) header_len: U16,
    /// Of the head of a channel, likewise.
    pub(crate) channel_len: U16,
    /// Of the record of an axis, likewise.
    pub(crate) axis_len: U16,
    pub(crate) key_id: U16,
    pub(crate) model: [U16; 2],
    pub(crate) channels: u8,
    pub(crate) axes: u8,
    pub(crate) signature_len: U16,
    pub(crate) flags: U32,
    /// The CRC that `coefficients.json` and `table.rs` name, by which a set is recognised.
    pub(crate) table_crc: U32,
    pub(crate) security_counter: U32,
    pub(crate) serial: [u8; SERIAL_LEN],
    /// CRC-32P4 of the bytes before it.
    pub(crate) header_crc: U32,
}

/// The head of a channel.
#[derive(FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(crate) struct RawChannel {
    /// In the order of [`ThermalSettings::NAMES`].
    pub(crate) thermal: [F32; ThermalSettings::NAMES.len()],
    pub(crate) first_edge_c: F32,
    pub(crate) last_edge_c: F32,
    pub(crate) t_min_c: F32,
    pub(crate) t_max_c: F32,
    pub(crate) period_s: F32,
    pub(crate) cells: U32,
}

/// The record of an axis.
#[derive(FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(crate) struct RawAxis {
    pub(crate) unit: u8,
    pub(crate) zeros: [u8; 3],
    pub(crate) scale_factor_arcsec: F32,
    pub(crate) row_noise: F32,
    pub(crate) row_noise_interval_s: F32,
    pub(crate) rezero_limit: F32,
    pub(crate) play_gains: [F32; PLAYS],
}

pub(crate) const HEADER_LEN: usize = size_of::<RawHeader>();
pub(crate) const HEADER_CRC_AT: usize = offset_of!(RawHeader, header_crc);
pub(crate) const CHANNEL_LEN: usize = size_of::<RawChannel>();
pub(crate) const AXIS_LEN: usize = size_of::<RawAxis>();
pub(crate) const TERMS_LEN: usize = size_of::<Terms>();

const _: () = {
    assert!(HEADER_LEN == 80 && HEADER_CRC_AT == 76 && CHANNEL_LEN == 116 && AXIS_LEN == 28);
    assert!(TERMS_LEN == 4 * Terms::COUNT && TERMS_LEN == 28);
    assert!(offset_of!(RawHeader, total_len) == 12 && offset_of!(RawHeader, model) == 24);
    assert!(offset_of!(RawHeader, flags) == 32 && offset_of!(RawHeader, serial) == 44);
    assert!(offset_of!(RawChannel, period_s) == 108 && offset_of!(RawChannel, cells) == 112);
    assert!(offset_of!(RawAxis, rezero_limit) == 16 && offset_of!(RawAxis, play_gains) == 20);
    assert!(max_cells(3) == 292 && max_cells(MAX_AXES) == 146);
};
