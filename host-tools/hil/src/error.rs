//! What can go wrong between a host and a unit, in words that say what to do.

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use tempco_image::{ImageError, Unit as AxisUnit};
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
    /// What the unit should send unasked does not come.
    #[error("the unit sent nothing for {:.1} s", waited.as_secs_f64())]
    Silent {
        /// For how long.
        waited: Duration,
    },
    /// Unit and host cannot understand each other.
    #[error(
        "the unit speaks version {unit} of the protocol and this program version {}: use the program \
         that came with the firmware",
        VERSION.0
    )]
    Version {
        /// Major version of the unit.
        unit: u8,
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
    /// The table is in another unit than the firmware was built for.
    #[error(
        "axis {axis} of the table is in {}, but {}: nothing was written",
        table.symbol(),
        built_for(*table, *unit)
    )]
    Unit {
        /// Number of the axis, channel by channel.
        axis: usize,
        /// Unit of the table.
        table: AxisUnit,
        /// Unit that the firmware was built for.
        unit: AxisUnit,
    },
    /// The table is of angles that are not the unit's.
    #[error(
        "axis {axis} of the table {}, but {}; {}: nothing was written",
        made_with(*table),
        turned_by(*unit),
        make_with(*table, *unit)
    )]
    ScaleFactor {
        /// Number of the axis, channel by channel.
        axis: usize,
        /// Scale factor of the gyro as of the table; 0 where it is not stated \[arcsec/pulse\].
        table: f32,
        /// Scale factor as of the unit \[arcsec/pulse\].
        unit: f32,
    },
    /// The table may take out more than the unit lets it.
    #[error(
        "the bias of axis {axis} of the table may be {table} {symbol}, but the unit takes {limit} \
         {symbol} at most; is the set one of this gyro? If so, raise MAX_TABLE_BIAS of its board: \
         nothing was written"
    )]
    Bias {
        /// Number of the axis, channel by channel.
        axis: usize,
        /// Bound of the bias \[unit of the axis\].
        table: f32,
        /// The largest bias that the unit takes \[unit of the axis\].
        limit: f32,
        /// Symbol of the axis's unit.
        symbol: &'static str,
    },
    /// The unit was reset.
    #[error("the unit was reset meanwhile: begin again")]
    Reset,
    /// The unit cannot keep what it found.
    #[error("the flash of the unit failed: nothing has changed; see `tempco faults`")]
    Flash,
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

fn built_for(table: AxisUnit, unit: AxisUnit) -> String {
    match table {
        AxisUnit::Mps2 | AxisUnit::G => "the unit counts the pulses of a gyro".to_owned(),
        _ => format!(
            "the firmware of the unit was built for {}; fit again in that unit, or build the \
             firmware with TEMPCO_TABLE=path/to/table.rs of this set",
            unit.symbol()
        ),
    }
}

fn made_with(scale_factor_arcsec: f32) -> String {
    if scale_factor_arcsec == 0.0 {
        "is of angles and does not say by how many arcsec per pulse they were made".to_owned()
    } else {
        format!("was fitted with {scale_factor_arcsec} arcsec per pulse")
    }
}

fn turned_by(scale_factor_arcsec: f32) -> String {
    if scale_factor_arcsec == 0.0 {
        "the gyro of the unit gives rates, not pulses".to_owned()
    } else {
        format!("the unit turns pulses into angles by {scale_factor_arcsec} arcsec")
    }
}

fn make_with(table: f32, unit: f32) -> String {
    if unit == 0.0 {
        "fit a log of rates, without --scale-factor".to_owned()
    } else if table == 0.0 {
        "give coefficients.json and --scale-factor".to_owned()
    } else {
        format!("fit again with --scale-factor {unit}, or correct SCALE_FACTOR_ARCSEC of its board")
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
        Refusal::Unit { axis } => {
            format!("axis {axis} of the table is in another unit than its firmware was built for")
        }
        Refusal::ScaleFactor { axis } => format!(
            "axis {axis} of the table was fitted with another scale factor than that of its board, \
             or does not say with which"
        ),
        Refusal::Bias { axis } => format!(
            "the bias of axis {axis} of the table may be larger than its board lets it; is the set \
             one of this gyro?"
        ),
        Refusal::Store => "its flash failed, or there is no such table in it".to_owned(),
        _ => format!("{refusal:?}"),
    }
}
