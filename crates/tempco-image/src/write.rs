//! Writes an image.

use tempco::{MAX_AXES, MAX_CELLS};
use zerocopy::IntoBytes;
use zerocopy::little_endian::{F32, U16, U32};

use crate::check::{seal, total_len};
use crate::layout::{
    AXIS_LEN, CHANNEL_LEN, CONTINUOUS, HEADER_CRC_AT, HEADER_LEN, RawChannel, RawHeader,
};
use crate::{CRC, Channel, FORMAT, ImageError, Info, MAGIC, MAX_CELLS_LEN, MODEL, SERIAL_LEN};

/// Bytes of the image of some channels, with its signature.
pub fn encoded_len(info: &Info, channels: &[Channel]) -> usize {
    let begin = HEADER_LEN.saturating_add(info.signature.len());
    let contents_len = channels.iter().fold(begin, |len, channel| {
        let axes = channel.axis_count().saturating_mul(AXIS_LEN);
        let cells = size_of_val(channel.cells);
        [CHANNEL_LEN, axes, cells]
            .into_iter()
            .fold(len, usize::saturating_add)
    });
    total_len(contents_len)
}

/// Writes an image to the start of `out` and returns its length.
///
/// The tables are not validated here: the reader of an image validates it.
///
/// # Errors
/// A serial number, signature, shape or number of cells that an image cannot hold, or too little
/// room.
pub fn encode(info: &Info, channels: &[Channel], out: &mut [u8]) -> Result<usize, ImageError> {
    let axes = channels.first().map_or(0, Channel::axis_count);
    check(info, channels, axes)?;
    let len = encoded_len(info, channels);
    let given = out.len();
    let image = out
        .get_mut(..len)
        .ok_or(ImageError::Short { given, needed: len })?;

    let mut rest = put(image, header(info, channels.len(), axes, len).as_bytes())?;
    for channel in channels {
        rest = put(rest, head(channel, axes).as_bytes())?;
        for axis in channel.axes.iter().flatten() {
            rest = put(rest, axis.to_raw().as_bytes())?;
        }
        rest = put(rest, channel.cells.as_bytes())?;
    }
    put(rest, info.signature)?;
    seal(image);
    Ok(len)
}

/// Writes `bytes` to the start of `out` and returns what is behind them.
fn put<'o>(out: &'o mut [u8], bytes: &[u8]) -> Result<&'o mut [u8], ImageError> {
    let short = ImageError::Short {
        given: out.len(),
        needed: bytes.len(),
    };
    let (place, rest) = out.split_at_mut_checked(bytes.len()).ok_or(short)?;
    place.copy_from_slice(bytes);
    Ok(rest)
}

fn check(info: &Info, channels: &[Channel], axes: usize) -> Result<(), ImageError> {
    let serial = info.serial;
    if !(1..=SERIAL_LEN).contains(&serial.len()) || serial.chars().any(char::is_control) {
        return Err(ImageError::Field("serial"));
    }
    if !info.is_signature_usable() {
        return Err(ImageError::Field("signature"));
    }
    if axes == 0 || channels.len() * axes > MAX_AXES {
        return Err(ImageError::Shape);
    }
    for channel in channels {
        // No axis behind a gap either.
        let rest = channel.axes.get(axes..).unwrap_or_default();
        if channel.axis_count() != axes || rest.iter().any(Option::is_some) {
            return Err(ImageError::Shape);
        }
        let cells = channel.cells.chunks_exact(axes);
        if !cells.remainder().is_empty() || !(1..=MAX_CELLS).contains(&cells.len()) {
            return Err(ImageError::Field("cells"));
        }
    }
    let cells_len = channels.iter().map(|channel| size_of_val(channel.cells));
    let cells_len = cells_len.fold(0, usize::saturating_add);
    if cells_len > MAX_CELLS_LEN {
        return Err(ImageError::TooLarge { cells_len });
    }
    Ok(())
}

fn header(info: &Info, channels: usize, axes: usize, len: usize) -> RawHeader {
    let pair = |(major, minor)| [U16::new(major), U16::new(minor)];
    let mut serial = [0; SERIAL_LEN];
    for (place, byte) in serial.iter_mut().zip(info.serial.bytes()) {
        *place = byte;
    }
    let mut header = RawHeader {
        magic: MAGIC,
        format: pair(FORMAT),
        total_len: U32::new(len as u32),
        header_len: U16::new(HEADER_LEN as u16),
        channel_len: U16::new(CHANNEL_LEN as u16),
        axis_len: U16::new(AXIS_LEN as u16),
        key_id: U16::new(info.key_id),
        model: pair(MODEL),
        channels: channels as u8,
        axes: axes as u8,
        signature_len: U16::new(info.signature.len() as u16),
        flags: U32::new(if info.continuous { CONTINUOUS } else { 0 }),
        table_crc: U32::new(info.table_crc),
        security_counter: U32::new(info.security_counter),
        serial,
        header_crc: U32::ZERO,
    };
    let (covered, _) = header.as_bytes().split_at(HEADER_CRC_AT);
    header.header_crc = U32::new(CRC.checksum(covered));
    header
}

fn head(channel: &Channel, axes: usize) -> RawChannel {
    RawChannel {
        thermal: channel.thermal.to_array().map(F32::new),
        first_edge_c: F32::new(channel.first_edge_c),
        last_edge_c: F32::new(channel.last_edge_c),
        t_min_c: F32::new(channel.t_min_c),
        t_max_c: F32::new(channel.t_max_c),
        period_s: F32::new(channel.period_s),
        cells: U32::new((channel.cells.len() / axes.max(1)) as u32),
    }
}
