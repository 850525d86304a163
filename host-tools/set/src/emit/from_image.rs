//! A flash image as a set, for a log: an image has units and no names.

use tempco_image::{Channel, Image, ImageError, Unit};
use tempco_log::{AxisUnit, Log};

use crate::build;
use crate::segment::Overlap;
use crate::{AxisSet, ChannelSet, CoefficientSet, Model, Provenance, Settings, TableData};

/// The unit of an axis by its code in an image.
pub fn axis_unit(unit: Unit) -> AxisUnit {
    match unit {
        Unit::Dph => AxisUnit::Dph,
        Unit::Dps => AxisUnit::Dps,
        Unit::Radps => AxisUnit::Radps,
        Unit::PulsesPerS => AxisUnit::PulsesPerS,
        Unit::Mps2 => AxisUnit::Mps2,
        Unit::G => AxisUnit::G,
    }
}

/// The tables of an image as a set whose axes are those of `log`, in their order.
///
/// The set runs as the one that the image was made from; what only a fit knows (segments,
/// polynomials, statistics, inputs) is empty in it.
///
/// # Errors
/// Contents that the core refuses, a table CRC that does not belong to the numbers, and a log with
/// other numbers of temperatures or axes, or with other units.
pub fn set_of_image(image: &Image, log: &Log) -> Result<CoefficientSet, String> {
    let explain = |error: ImageError| error.to_string();
    image.validate().map_err(explain)?;
    // The log must have the temperatures and axes of the image, in its units.
    let found: Vec<usize> = log.channels.iter().map(|c| c.axes.len()).collect();
    let expected = vec![image.axes(); image.channels()];
    if found != expected {
        return Err(format!(
            "{}: temperature channels with {found:?} axes: the image has {expected:?}, to be \
             taken in order (--temp and --axis choose columns)",
            log.file
        ));
    }
    let channels = log.channels.iter().enumerate().map(|(number, of_log)| {
        let channel = image.channel(number).map_err(explain)?;
        let axes = of_log.axes.iter().zip(channel.axes.iter().flatten());
        let axes = axes.map(|(axis, of_image)| {
            let unit = axis_unit(of_image.unit);
            if axis.unit == unit {
                Ok(axis_set(&axis.name, unit))
            } else {
                Err(format!(
                    "{}: axis `{}` is in {}, but the image expects {} (--scale-factor turns pulses \
                     into angles)",
                    log.file,
                    axis.name,
                    axis.unit.name(),
                    unit.name()
                ))
            }
        });
        Ok(ChannelSet {
            temperature: of_log.column.clone(),
            segments: Vec::new(),
            axes: axes.collect::<Result<_, String>>()?,
            table: table_data(&channel),
            table_deviation: 0.0,
            boundary_moved_c: 0.0,
            outliers: None,
            selection: None,
        })
    });
    let channels = channels.collect::<Result<_, String>>()?;
    let periods_s =
        (0..image.channels()).filter_map(|number| Some(image.channel(number).ok()?.period_s));
    let thermal_period_s = periods_s.fold(0.0, f32::max).into();
    // What only a fit knows stays empty.
    let set = build::set(
        image.info().serial.to_owned(),
        Provenance {
            tool: build::tool(),
            created: build::now(),
            inputs: Vec::new(),
        },
        Settings {
            model: Model::Composite,
            overlap: Overlap::None,
            scale_factor_arcsec: None,
            thermal_period_s,
        },
        channels,
    );
    // The numbers must be those that the image was written with.
    let table_crc = image.info().table_crc;
    if set.crc32() == table_crc {
        Ok(set)
    } else {
        Err(format!(
            "the image names table {table_crc:08x}, but the CRC of its numbers is {}: it was not \
             written by `tempco fit`",
            set.table_crc32
        ))
    }
}

fn axis_set(name: &str, unit: AxisUnit) -> AxisSet {
    AxisSet {
        name: name.to_owned(),
        unit,
        reference_c: None,
        polynomials: Vec::new(),
        sigmas: Vec::new(),
        gains: Vec::new(),
        noise: None,
        held_out: None,
        statistics: None,
    }
}

fn table_data(channel: &Channel) -> TableData {
    TableData {
        thermal: channel.thermal,
        first_edge_c: channel.first_edge_c,
        last_edge_c: channel.last_edge_c,
        t_min_c: channel.t_min_c,
        t_max_c: channel.t_max_c,
        cells: channel
            .cells
            .chunks_exact(channel.axis_count())
            .map(<[_]>::to_vec)
            .collect(),
        play_gains: channel
            .axes
            .iter()
            .flatten()
            .map(|axis| axis.play_gains)
            .collect(),
    }
}
