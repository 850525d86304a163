//! The set as a flash image, `table.bin`; its layout is in `docs/flash-image.md`.

use tempco::{MAX_AXES, Terms};
use tempco_image::{AlignedBytes, Axis, Channel, Image, ImageError, Info, MAX_LEN, Unit, encode};
use tempco_log::AxisUnit;

use crate::{ChannelSet, CoefficientSet};

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

/// The axes of a channel as an image records them.
pub(super) fn axes(set: &CoefficientSet, channel: &ChannelSet) -> [Option<Axis>; MAX_AXES] {
    let record = |number: usize| {
        let axis = channel.axes.get(number)?;
        // A rate in pulses has no scale factor, nor has an acceleration.
        let is_angle = matches!(axis.unit, AxisUnit::Dph | AxisUnit::Dps | AxisUnit::Radps);
        let scale_factor = set.settings.scale_factor_arcsec.filter(|_| is_angle);
        Some(Axis {
            scale_factor_arcsec: scale_factor.unwrap_or(0.0) as f32,
            play_gains: channel.table.play_gains[number],
            ..Axis::new(code(axis.unit))
        })
    };
    std::array::from_fn(record)
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
    let channels = set.channels.iter().zip(&cells);
    let channels = channels.map(|(channel, cells)| Channel {
        thermal: channel.table.thermal,
        first_edge_c: channel.table.first_edge_c,
        last_edge_c: channel.table.last_edge_c,
        t_min_c: channel.table.t_min_c,
        t_max_c: channel.table.t_max_c,
        period_s: set.settings.thermal_period_s as f32,
        axes: axes(set, channel),
        cells,
    });
    let channels: Vec<Channel> = channels.collect();
    let info = Info {
        serial: &set.serial,
        table_crc: set.crc32(),
        continuous: channels.iter().all(|channel| channel.jump().is_none()),
        ..Info::default()
    };
    let mut image = Box::new(AlignedBytes([0; MAX_LEN]));
    let len = encode(&info, &channels, &mut image.0).map_err(explain)?;
    let image = &image.0[..len];
    let read = Image::read(image).and_then(|read| read.validate());
    read.map_err(explain)?;
    Ok(image.to_vec())
}

/// Whether bytes are an image of the tables of a set, of whatever version.
pub(crate) fn is_of(set: &CoefficientSet, bytes: &[u8]) -> bool {
    let mut place = Box::new(AlignedBytes([0; MAX_LEN]));
    let Some(start) = place.0.get_mut(..bytes.len()) else {
        return false;
    };
    start.copy_from_slice(bytes);
    let Ok(image) = Image::read(start).and_then(|image| image.validate().map(|()| image)) else {
        return false;
    };
    let units = |axes: &[Option<Axis>]| -> Vec<Unit> {
        axes.iter().flatten().map(|axis| axis.unit).collect()
    };
    let has_units = |(number, channel): (usize, &ChannelSet)| {
        let expected = units(&axes(set, channel));
        image
            .channel(number)
            .is_ok_and(|found| units(&found.axes) == expected)
    };
    let info = image.info();
    info.serial == set.serial
        && info.table_crc == set.crc32()
        && image.channels() == set.channels.len()
        && set.channels.iter().enumerate().all(has_units)
}
