//! Writes an image.

use tempco::{MAX_AXES, MAX_CELLS};
use zerocopy::IntoBytes;
use zerocopy::little_endian::{F32, U16, U32};

use crate::check::{seal, total_len};
use crate::layout::{
    CHANNEL_LEN, CONTINUOUS, HEADER_CRC_AT, HEADER_LEN, RawChannel, RawHeader, history_len,
};
use crate::{CRC, Channel, FORMAT, ImageError, Info, MAGIC, MODEL, SERIAL_LEN, Unit};

/// What all channels of an image have in common.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Shape {
    axes: usize,
    plays: usize,
    slow_parts: usize,
}

impl Shape {
    fn of(channel: &Channel) -> Self {
        let (plays, slow_parts) = channel.history.counts();
        Self {
            axes: channel.axes(),
            plays,
            slow_parts,
        }
    }
}

/// Bytes of the image of some channels.
pub fn encoded_len(channels: &[Channel]) -> usize {
    let contents_len = channels.iter().fold(HEADER_LEN, |len, channel| {
        let shape = Shape::of(channel);
        let history = history_len(shape.axes, shape.plays, shape.slow_parts);
        let cells = size_of_val(channel.cells);
        [CHANNEL_LEN, history, cells]
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
/// A serial number, shape or number of cells that an image cannot hold, or too little room.
pub fn encode(info: &Info, channels: &[Channel], out: &mut [u8]) -> Result<usize, ImageError> {
    let shape = channels.first().map_or(Shape::default(), Shape::of);
    let axes = shape.axes;
    check(info, channels, shape)?;
    let len = encoded_len(channels);
    let given = out.len();
    let image = out
        .get_mut(..len)
        .ok_or(ImageError::Short { given, needed: len })?;

    let mut rest = put(image, header(info, channels.len(), shape, len).as_bytes())?;
    for channel in channels {
        rest = put(rest, head(channel, axes).as_bytes())?;
        for number in channel.history.numbers(axes) {
            rest = put(rest, &number.to_le_bytes())?;
        }
        rest = put(rest, channel.cells.as_bytes())?;
    }
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

fn check(info: &Info, channels: &[Channel], shape: Shape) -> Result<(), ImageError> {
    let axes = shape.axes;
    let serial = info.serial;
    if !(1..=SERIAL_LEN).contains(&serial.len()) || serial.chars().any(char::is_control) {
        return Err(ImageError::Field("serial"));
    }
    if axes == 0 || channels.len() * axes > MAX_AXES {
        return Err(ImageError::Shape);
    }
    for channel in channels {
        if Shape::of(channel) != shape {
            return Err(ImageError::Shape);
        }
        let cells = channel.cells.chunks_exact(axes);
        if !cells.remainder().is_empty() || !(1..=MAX_CELLS).contains(&cells.len()) {
            return Err(ImageError::Field("cells"));
        }
    }
    Ok(())
}

fn header(info: &Info, channels: usize, shape: Shape, len: usize) -> RawHeader {
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
        model: pair(MODEL),
        channels: channels as u8,
        axes: shape.axes as u8,
        plays: shape.plays as u8,
        slow_parts: shape.slow_parts as u8,
        flags: U32::new(if info.continuous { CONTINUOUS } else { 0 }),
        table_crc: U32::new(info.table_crc),
        serial,
        header_crc: U32::ZERO,
    };
    let (covered, _) = header.as_bytes().split_at(HEADER_CRC_AT);
    header.header_crc = U32::new(CRC.checksum(covered));
    header
}

fn head(channel: &Channel, axes: usize) -> RawChannel {
    let code = |axis: usize| {
        channel
            .units
            .get(axis)
            .copied()
            .flatten()
            .map_or(0, Unit::code)
    };
    RawChannel {
        thermal: channel.thermal.to_array().map(F32::new),
        first_edge_c: F32::new(channel.first_edge_c),
        last_edge_c: F32::new(channel.last_edge_c),
        t_min_c: F32::new(channel.t_min_c),
        t_max_c: F32::new(channel.t_max_c),
        cells: U32::new((channel.cells.len() / axes.max(1)) as u32),
        units: core::array::from_fn(code),
    }
}
