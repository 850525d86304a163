//! Tables into a unit, and out of it.

use std::fmt;

use tempco_image::{AlignedBytes, CRC, Image, ImageError, Misfit};
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
/// Whatever fails, the unit keeps a good table: the image is stored only once it is whole and checked
/// by the unit, and used only once it is activated.
///
/// # Errors
/// An image that is damaged, of another unit or shape, or that does not fit the board, before
/// anything is written; a refusal of the unit; a unit that runs on another table after its reset.
pub fn flash_set(
    unit: &mut Unit,
    image: &[u8],
    mut progress: impl FnMut(usize),
) -> Result<Identity, Error> {
    let before = unit.identify()?;
    let table_crc = check(image, &before)?;
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
    let after = activate(unit, before.spare)?;
    if after.table_crc == table_crc {
        Ok(after)
    } else {
        Err(not_in_use(&after))
    }
}

/// Has the unit reset itself and run on the table in a bank, waits for its boot and asks what it is:
/// the roll-back to the table before.
///
/// # Errors
/// There is no good table in the bank; a unit that runs on the other one after its reset.
pub fn activate(unit: &mut Unit, bank: Bank) -> Result<Identity, Error> {
    match unit.command(&Request::Activate(bank)) {
        // The answer was lost, and the unit has reset itself before it was asked again.
        Err(Error::SessionLost { .. }) => {}
        other => other?,
    }
    unit.reconnect()?;
    let after = unit.identify()?;
    if after.bank == Some(bank) {
        Ok(after)
    } else {
        Err(not_in_use(&after))
    }
}

fn not_in_use(after: &Identity) -> Error {
    Error::NotInUse {
        found: after.bank.map(|_| after.table_crc),
    }
}

/// Checks the image and that it is the unit's, as the unit does; returns the CRC of its table.
fn check(image: &[u8], unit: &Identity) -> Result<u32, Error> {
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
    let shape = Shape {
        channels: unit.channels.into(),
        axes: unit.axes.into(),
    };
    if table != shape {
        return Err(Error::Shape { table, unit: shape });
    }
    match image.expect_fit(&unit.fits) {
        Err(ImageError::Unfit { axis, why }) => Err(misfit(&image, unit, axis, why)?),
        other => Ok(other.map(|()| image.info().table_crc)?),
    }
}

/// What does not fit, with the figures of both sides. The axis is counted channel by channel.
fn misfit(image: &Image, unit: &Identity, axis: usize, why: Misfit) -> Result<Error, ImageError> {
    let channel = image.channel(axis / image.axes())?;
    let number = axis % image.axes();
    let record = channel.axes[number].ok_or(ImageError::Shape)?;
    let fit = unit.fits[axis];
    Ok(match why {
        Misfit::Unit => Error::Unit {
            axis,
            table: record.unit,
            unit: fit.unit,
        },
        Misfit::ScaleFactor => Error::ScaleFactor {
            axis,
            table: record.scale_factor_arcsec,
            unit: fit.scale_factor_arcsec,
        },
        Misfit::Bias => Error::Bias {
            axis,
            table: channel.max_bias(number),
            limit: fit.max_bias,
            symbol: record.unit.symbol(),
        },
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
