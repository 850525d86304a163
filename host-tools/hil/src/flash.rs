//! Tables into a unit, and out of it.

use std::fmt;

use tempco_image::{AlignedBytes, CRC, Image, Unit as AxisUnit};
use tempco_link::{Bank, MAX_CHUNK, Request, Response};

use crate::{Error, Identity, Unit};

/// No image is longer \[bytes\].
const MOST_BYTES: usize = 1 << 18;

/// What tables a unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Temperature channels.
    pub channels: usize,
    /// Axes of each channel.
    pub axes: usize,
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} temperature channel(s) of {} axes",
            self.channels, self.axes
        )
    }
}

/// Writes the image of a table into the bank that is not in use, has the unit take it into use,
/// waits for its boot and asks which table it runs on. `progress` gets the bytes written so far.
///
/// A table of angles is only right where the unit turns pulses into angles by the scale factor
/// that the table was fitted with, `scale_factor_arcsec` \[arcsec/pulse\]; for others it is not
/// looked at.
///
/// Whatever fails, the unit keeps a good table: the image counts only once it is whole, checked by
/// the unit and committed.
///
/// # Errors
/// An image that is damaged, of another unit, shape or scale factor, before anything is written; a
/// refusal of the unit; a unit that runs on another table after its reset.
pub fn flash_set(
    unit: &mut Unit,
    image: &[u8],
    scale_factor_arcsec: Option<f64>,
    mut progress: impl FnMut(usize),
) -> Result<Identity, Error> {
    let before = unit.identify()?;
    let table = check(image, &before)?;
    if table.is_of_angles {
        check_scale_factor(unit, scale_factor_arcsec)?;
    }
    let len = image.len() as u32;
    expect(unit, &Request::UploadBegin { len }, 0)?;
    for (number, bytes) in image.chunks(MAX_CHUNK).enumerate() {
        let offset = number * MAX_CHUNK;
        let end = offset + bytes.len();
        let chunk = Request::UploadChunk {
            offset: offset as u32,
            bytes,
        };
        expect(unit, &chunk, end)?;
        progress(end);
    }
    let crc = CRC.checksum(image);
    unit.command(&Request::UploadCommit { len, crc })?;
    match unit.command(&Request::Activate) {
        // The answer was lost, and the unit has reset itself before it was asked again.
        Err(Error::SessionLost { .. }) => {}
        other => other?,
    }
    unit.reconnect()?;
    let after = unit.identify()?;
    if after.table_crc == table.crc && after.bank.is_some() && after.bank != before.bank {
        Ok(after)
    } else {
        Err(Error::NotInUse {
            found: after.bank.map(|_| after.table_crc),
        })
    }
}

/// What is to be known of a table that fits.
struct Fitting {
    crc: u32,
    is_of_angles: bool,
}

/// Scale factors that differ by less are the same, but for their rounding to single precision.
const SAME_SCALE: f64 = 1e-6;

fn check_scale_factor(unit: &mut Unit, table: Option<f64>) -> Result<(), Error> {
    let unit = unit.scale_factor_arcsec()?;
    let is_same =
        |table: f64| (table - f64::from(unit)).abs() <= SAME_SCALE * f64::from(unit).abs();
    match table {
        Some(table) if is_same(table) => Ok(()),
        table => Err(Error::ScaleFactor { table, unit }),
    }
}

/// Checks the image and that it is the unit's.
fn check(image: &[u8], unit: &Identity) -> Result<Fitting, Error> {
    // Cells are used in place, which takes an aligned place.
    let mut place = Box::new(AlignedBytes([0; MOST_BYTES]));
    let room = place.0.get_mut(..image.len());
    room.ok_or(tempco_image::ImageError::Field("total_len"))?
        .copy_from_slice(image);
    let image = Image::read(&place.0[..image.len()])?;
    image.validate()?;
    if image.info().serial != unit.serial {
        return Err(Error::Serial {
            table: image.info().serial.to_owned(),
            unit: unit.serial.clone(),
        });
    }
    let table = Shape {
        channels: image.channels(),
        axes: image.axes(),
    };
    let unit = Shape {
        channels: unit.channels.into(),
        axes: unit.axes.into(),
    };
    if table != unit {
        return Err(Error::Shape { table, unit });
    }
    let mut is_of_angles = false;
    for channel in 0..image.channels() {
        for axis in image.channel(channel)?.axes.iter().flatten() {
            match axis.unit {
                AxisUnit::Dph | AxisUnit::Dps | AxisUnit::Radps => is_of_angles = true,
                AxisUnit::PulsesPerS => {}
                AxisUnit::Mps2 => return Err(Error::NotOfAGyro { unit: "m/s^2" }),
                AxisUnit::G => return Err(Error::NotOfAGyro { unit: "g" }),
            }
        }
    }
    Ok(Fitting {
        crc: image.info().table_crc,
        is_of_angles,
    })
}

/// Asks for what is answered by where the next chunk begins.
fn expect(unit: &mut Unit, request: &Request, next: usize) -> Result<(), Error> {
    unit.ask(request, |response| {
        let is_next = matches!(response, Response::Expected { offset } if *offset as usize == next);
        is_next.then_some(())
    })
}

/// Reads the image in a bank; empty where there is none.
///
/// # Errors
/// A refusal, and what a session can meet.
pub fn download(unit: &mut Unit, bank: Bank) -> Result<Vec<u8>, Error> {
    let mut image = Vec::new();
    loop {
        let from = image.len();
        let request = Request::Download {
            bank,
            offset: from as u32,
            len: MAX_CHUNK as u16,
        };
        let chunk = unit.ask(&request, |response| match response {
            Response::Chunk { offset, bytes } if *offset as usize == from => Some(bytes.to_vec()),
            _ => None,
        })?;
        if chunk.is_empty() {
            return Ok(image);
        }
        image.extend(chunk);
    }
}
