//! The layout to the byte, as structures that reader and writer share; in words in
//! `docs/flash-image.md`.

use core::mem::{offset_of, size_of};

use tempco::ThermalSettings;
use zerocopy::little_endian::{F32, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// The first bytes of every image.
pub const MAGIC: [u8; 8] = *b"TCTABLE\n";
/// Version of the layout, major and minor. A reader refuses another major; a newer minor only
/// adds fields that it may pass over.
pub const FORMAT: (u16, u16) = (1, 0);
/// Version of the equations, major and minor; refused likewise.
pub const MODEL: (u16, u16) = (1, 0);
/// The most play (hysteresis) terms of a channel.
pub const MAX_PLAYS: usize = 2;
/// The most second thermal lags of a channel.
pub const MAX_SLOW_PARTS: usize = 1;
/// Bytes of the serial number, which is padded with zeros.
pub const SERIAL_LEN: usize = 32;

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
    pub(crate) model: [U16; 2],
    pub(crate) channels: u8,
    pub(crate) axes: u8,
    pub(crate) plays: u8,
    pub(crate) slow_parts: u8,
    pub(crate) flags: U32,
    /// The CRC that `coefficients.json` and `table.rs` name, by which a set is recognised.
    pub(crate) table_crc: U32,
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
    pub(crate) cells: U32,
    /// One per axis, then zeros.
    pub(crate) units: [u8; 8],
}

pub(crate) const HEADER_LEN: usize = size_of::<RawHeader>();
pub(crate) const HEADER_CRC_AT: usize = offset_of!(RawHeader, header_crc);
pub(crate) const CHANNEL_LEN: usize = size_of::<RawChannel>();
pub(crate) const TERMS_LEN: usize = size_of::<tempco::Terms>();

const _: () = {
    assert!(HEADER_LEN == 72 && HEADER_CRC_AT == 68 && CHANNEL_LEN == 72);
    assert!(TERMS_LEN == 4 * tempco::Terms::COUNT);
    assert!(offset_of!(RawHeader, total_len) == 12 && offset_of!(RawHeader, channels) == 24);
    assert!(offset_of!(RawHeader, flags) == 28 && offset_of!(RawHeader, serial) == 36);
    assert!(offset_of!(RawChannel, cells) == 60 && offset_of!(RawChannel, units) == 64);
};

/// Bytes of the history terms of a channel: plays of half width and gains, then second lags of time
/// constant, limit and gains.
pub(crate) const fn history_len(axes: usize, plays: usize, slow_parts: usize) -> usize {
    let of_plays = axes.saturating_add(1).saturating_mul(plays);
    let of_parts = axes.saturating_add(2).saturating_mul(slow_parts);
    of_plays.saturating_add(of_parts).saturating_mul(4)
}
