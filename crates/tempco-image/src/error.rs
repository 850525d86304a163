//! Why an image was refused.

use core::fmt;

use tempco::TableError;

use crate::{FORMAT, MAX_CELLS_LEN, Misfit};

/// Why an image was refused, or could not be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ImageError {
    /// The bytes end within the image.
    Short {
        /// Bytes that were there.
        given: usize,
        /// Bytes that the image needs.
        needed: usize,
    },
    /// The bytes are no image.
    Magic,
    /// The layout has another major version.
    Format {
        /// The version it says.
        major: u16,
    },
    /// The equations have another major version.
    Model {
        /// The version it says.
        major: u16,
    },
    /// The CRC of the header does not belong to it.
    Header,
    /// The CRC of a block does not belong to it.
    Crc {
        /// Number of the block of 4092 bytes.
        block: usize,
    },
    /// The named field is out of range or does not agree with the others.
    Field(&'static str),
    /// The image is of another unit.
    Serial,
    /// The channel does not exist or has another number of axes than was asked for.
    Shape,
    /// The cells of all channels are more than an image may have.
    TooLarge {
        /// Bytes of the cells.
        cells_len: usize,
    },
    /// The core refuses settings, grid or cells of a channel.
    Table {
        /// Number of the channel.
        channel: usize,
        /// Why.
        error: TableError,
    },
    /// A number of an axis is not finite or below zero.
    Axis {
        /// Number of the channel.
        channel: usize,
        /// Number of the axis.
        axis: usize,
        /// The number.
        name: &'static str,
    },
    /// An axis does not fit the board.
    Unfit {
        /// Number of the axis, channel by channel.
        axis: usize,
        /// What does not fit.
        why: Misfit,
    },
    /// The bias jumps at the hot edge of a cell of an image marked as continuous.
    Jump {
        /// Number of the channel.
        channel: usize,
        /// Number of the cell.
        cell: usize,
        /// Number of the axis.
        axis: usize,
    },
    /// The bytes do not lie at an address divisible by 4.
    Alignment,
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Short { given, needed } => {
                write!(f, "{given} bytes, but the image needs {needed}")
            }
            Self::Magic => f.write_str("not a table image"),
            Self::Format { major } => {
                write!(f, "layout version {major}, expected {}", FORMAT.0)?;
                if major < FORMAT.0 {
                    f.write_str("; write it again from coefficients.json")?;
                }
                Ok(())
            }
            Self::Model { major } => {
                write!(f, "model version {major}, expected {}", crate::MODEL.0)
            }
            Self::Header => f.write_str("the CRC of the header is wrong: it was damaged"),
            Self::Crc { block } => {
                write!(f, "the CRC of block {block} is wrong: it was damaged")
            }
            Self::Field(name) => write!(f, "field {name} is out of range or does not agree"),
            Self::Serial => f.write_str("the image is of another unit"),
            Self::Shape => f.write_str("not the expected channels and axes"),
            Self::TooLarge { cells_len } => write!(
                f,
                "the cells take {cells_len} bytes, but an image has room for {MAX_CELLS_LEN}; \
                 fewer cells are needed"
            ),
            Self::Table { channel, error } => write!(f, "channel {channel}: {error}"),
            Self::Axis {
                channel,
                axis,
                name,
            } => write!(
                f,
                "channel {channel}, axis {axis}: {name} is not finite or below zero"
            ),
            Self::Unfit { axis, why } => {
                write!(f, "axis {axis}: the {why} does not fit the board")
            }
            Self::Jump {
                channel,
                cell,
                axis,
            } => write!(
                f,
                "the bias jumps behind cell {cell} (channel {channel}, axis {axis}), but the image \
                 is marked as continuous"
            ),
            Self::Alignment => f.write_str("the image does not lie at an address divisible by 4"),
        }
    }
}

impl core::error::Error for ImageError {}
