//! The set as a flash image, `table.bin`; its layout is in `docs/flash-image.md`.

use tempco::{MAX_AXES, Play, SlowPart, Terms};
use tempco_image::{
    AlignedBytes, Channel, ChannelHistory, Image, ImageError, Info, Unit, encode, encoded_len,
};
use tempco_log::AxisUnit;

use crate::{ChannelSet, CoefficientSet, TableData};

/// Most bytes of an image: six axes of the most cells, each its own channel, with room for heads.
const MOST_BYTES: usize = 6 * (100 + size_of::<Terms>() * tempco::MAX_CELLS) + 256;

const fn code(unit: AxisUnit) -> Unit {
    match unit {
        AxisUnit::Dph => Unit::Dph,
        AxisUnit::Dps => Unit::Dps,
        AxisUnit::Radps => Unit::Radps,
        AxisUnit::PulsesPerS => Unit::PulsesPerS,
        AxisUnit::Mps2 => Unit::Mps2,
        AxisUnit::G => Unit::G,
    }
}

fn history(table: &TableData) -> Result<ChannelHistory, ImageError> {
    let plays: Vec<Play<MAX_AXES>> = table
        .plays
        .iter()
        .map(|play| Play {
            half_width_c: play.half_width_c,
            gain: gains(&play.gain),
        })
        .collect();
    let slow_parts: Vec<SlowPart<MAX_AXES>> = table
        .slow_parts
        .iter()
        .map(|part| SlowPart {
            tau_s: part.tau_s,
            limit_c: part.limit_c,
            gain: gains(&part.gain),
        })
        .collect();
    ChannelHistory::new(&plays, &slow_parts)
}

/// Gains of as many axes as there can be: those there are, then 0.
pub(super) fn gains(of_axes: &[f32]) -> [f32; MAX_AXES] {
    std::array::from_fn(|axis| of_axes.get(axis).copied().unwrap_or(0.0))
}

/// The tables of a set as an image that its reader accepts; marked as continuous where no table
/// has a jump.
///
/// # Errors
/// A serial number that an image cannot hold.
pub fn table_bin(set: &CoefficientSet) -> Result<Vec<u8>, String> {
    let cells: Vec<Vec<Terms>> = set
        .channels
        .iter()
        .map(|channel| channel.table.cells.concat())
        .collect();
    let explain = |error: ImageError| match error {
        ImageError::Field("serial") => format!(
            "serial number {:?}: expected 1 to {} bytes without control characters",
            set.serial,
            tempco_image::SERIAL_LEN
        ),
        other => format!("table.bin: {other}"),
    };
    let channels: Vec<Channel> = set
        .channels
        .iter()
        .zip(&cells)
        .map(|(channel, cells)| {
            let units: Vec<Unit> = channel.axes.iter().map(|axis| code(axis.unit)).collect();
            Ok(Channel {
                thermal: channel.table.thermal,
                first_edge_c: channel.table.first_edge_c,
                last_edge_c: channel.table.last_edge_c,
                t_min_c: channel.table.t_min_c,
                t_max_c: channel.table.t_max_c,
                units: Unit::array(&units),
                cells,
                history: history(&channel.table)?,
            })
        })
        .collect::<Result<_, _>>()
        .map_err(explain)?;
    let info = Info {
        serial: &set.serial,
        table_crc: set.crc32(),
        continuous: channels.iter().all(|channel| channel.jump().is_none()),
    };
    let mut image = Box::new(AlignedBytes([0; MOST_BYTES]));
    debug_assert!(encoded_len(&channels) <= MOST_BYTES);
    let len = encode(&info, &channels, &mut image.0).map_err(explain)?;
    let image = &image.0[..len];
    let read = Image::read(image).and_then(|read| read.validate());
    read.map_err(explain)?;
    Ok(image.to_vec())
}

/// Whether bytes are an image of the tables of a set, of whatever version.
pub(crate) fn is_of(set: &CoefficientSet, bytes: &[u8]) -> bool {
    let mut place = Box::new(AlignedBytes([0; MOST_BYTES]));
    let Some(start) = place.0.get_mut(..bytes.len()) else {
        return false;
    };
    start.copy_from_slice(bytes);
    let Ok(image) = Image::read(start).and_then(|image| image.validate().map(|()| image)) else {
        return false;
    };
    let units = |(number, channel): (usize, &ChannelSet)| {
        let units: Vec<Unit> = channel.axes.iter().map(|axis| code(axis.unit)).collect();
        image
            .channel(number)
            .is_ok_and(|found| found.units == Unit::array(&units))
    };
    let info = image.info();
    info.serial == set.serial
        && info.table_crc == set.crc32()
        && image.channels() == set.channels.len()
        && set.channels.iter().enumerate().all(units)
}
