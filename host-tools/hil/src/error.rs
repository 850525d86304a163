//! What can go wrong between a host and a unit, in words that say what to do.

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use tempco_image::ImageError;
use tempco_link::{LinkError, Refusal, VERSION};

use crate::flash::Shape;

/// Why something could not be done with a unit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The port cannot be opened.
    #[error("{}: {cause}; expected a serial port that can do {baud} baud, or a socket", port.display())]
    Open {
        /// The port.
        port: PathBuf,
        /// The rate that was asked for \[baud\].
        baud: u32,
        /// What the system says.
        cause: io::Error,
    },
    /// The port failed later.
    #[error("the link to the unit: {0}")]
    Port(#[source] io::Error),
    /// The other end of the port was closed.
    #[error("the link to the unit was closed at its other end")]
    Closed,
    /// Nothing came back.
    #[error(
        "no answer to {request} after {tries} tries in {:.1} s: is the unit on, is the port the \
         right one, and does the baud rate match?",
        waited.as_secs_f64()
    )]
    NoAnswer {
        /// What was asked.
        request: &'static str,
        /// How often.
        tries: u32,
        /// For how long.
        waited: Duration,
    },
    /// Unit and host cannot understand each other.
    #[error(
        "the unit speaks version {} of the protocol and this program version {}: use the program \
         that came with the firmware",
        unit.map_or("another".to_owned(), |major| major.to_string()),
        VERSION.0
    )]
    Version {
        /// Major version of the unit, where it says.
        unit: Option<u8>,
    },
    /// The unit has restarted, or another program has opened a session.
    #[error(
        "the unit lost its session at {request}: it was reset, or another program talks to it; \
         what was under way has ended and must be begun again"
    )]
    SessionLost {
        /// What was asked.
        request: &'static str,
    },
    /// The unit would not do it.
    #[error("the unit refused {request}: {}", reason(*refusal))]
    Refused {
        /// What was asked.
        request: &'static str,
        /// Why.
        refusal: Refusal,
    },
    /// The answer is none to the question.
    #[error("the unit gave an answer to {request} that does not fit: {found}")]
    Unexpected {
        /// What was asked.
        request: &'static str,
        /// What came.
        found: String,
    },
    /// The request does not fit into a frame.
    #[error("{request}: {cause}")]
    Frame {
        /// What was asked.
        request: &'static str,
        /// Why.
        cause: LinkError,
    },
    /// The image is damaged, or none.
    #[error("the image of the table: {0}")]
    Image(#[from] ImageError),
    /// The image is another unit's.
    #[error(
        "the table is that of unit {table:?}, but this is unit {unit:?}{}: nothing was written",
        example(unit)
    )]
    Serial {
        /// Serial number in the image.
        table: String,
        /// Serial number of the unit.
        unit: String,
    },
    /// The unit is built for other tables.
    #[error("the table is of {table}, but the unit is built for {unit}: nothing was written")]
    Shape {
        /// Shape of the table.
        table: Shape,
        /// Shape of the unit.
        unit: Shape,
    },
    /// The table is not of rates that a gyro's pulses can be turned into.
    #[error(
        "the table is in {unit}, but the unit counts the pulses of a gyro: nothing was written"
    )]
    NotOfAGyro {
        /// Unit of an axis of the table.
        unit: &'static str,
    },
    /// The table is of angles that are not the unit's.
    #[error(
        "{}, but the unit turns pulses into angles by {unit} arcsec: nothing was written",
        made_with(*table)
    )]
    ScaleFactor {
        /// Scale factor of the gyro as of the table, if it is known \[arcsec/pulse\].
        table: Option<f64>,
        /// Scale factor as of the unit \[arcsec/pulse\].
        unit: f32,
    },
    /// The unit did not take the new table into use.
    #[error(
        "the unit took the table, but after its reset it runs on {}: its log says why",
        in_use(*found)
    )]
    NotInUse {
        /// CRC of the table in use; none where it runs uncompensated.
        found: Option<u32>,
    },
}

/// Serial number of the table that firmware has which was built without one.
const EXAMPLE: &str = "EXAMPLE";

fn example(unit: &str) -> &'static str {
    if unit == EXAMPLE {
        " (its firmware was built with the example table; build it with \
         TEMPCO_TABLE=path/to/table.rs of the set)"
    } else {
        ""
    }
}

fn made_with(scale_factor_arcsec: Option<f64>) -> String {
    match scale_factor_arcsec {
        Some(arcsec) => format!("the table was fitted with {arcsec} arcsec per pulse"),
        None => "the table is of angles and does not say by how many arcsec per pulse they were \
                 made (--scale-factor)"
            .to_owned(),
    }
}

fn in_use(table_crc: Option<u32>) -> String {
    table_crc.map_or("no table".to_owned(), |crc| {
        format!("table {crc:08x} of the same bank as before")
    })
}

fn reason(refusal: Refusal) -> String {
    match refusal {
        Refusal::Version => "its version of the protocol is another".to_owned(),
        Refusal::Session => "it has no such session".to_owned(),
        Refusal::Order { expected } => format!("it expected request number {expected}"),
        Refusal::Unknown => {
            "it does not know this request, or its arguments are out of range; its firmware may be \
             older than this program"
                .to_owned()
        }
        Refusal::Unsupported => "it cannot do this".to_owned(),
        Refusal::Busy => "it is busy with something else; try again later".to_owned(),
        Refusal::Offset { expected } => format!("it expected the chunk from byte {expected} on"),
        Refusal::Image => {
            "the image is not good for it; its log says which check failed".to_owned()
        }
        Refusal::Store => "its flash failed, or there is no such table in it".to_owned(),
        _ => format!("{refusal:?}"),
    }
}
