//! Why the store could not do what was asked.

use core::fmt;

use embedded_storage::nor_flash::{NorFlashError, NorFlashErrorKind};
use tempco_image::ImageError;

/// Why the store could not do what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StoreError {
    /// A region is not made of whole sectors of the flash, overlaps another, or is too short.
    Region,
    /// The flash could not be read, programmed or erased.
    Flash(NorFlashErrorKind),
    /// The image is refused.
    Image(ImageError),
    /// The image or the chunk does not fit into the slot or the buffer.
    Length,
    /// The image is not the one its entry or the caller names.
    Different,
    /// The chunk is not the next one.
    Offset {
        /// Where the next chunk begins \[bytes\].
        expected: u32,
    },
    /// A chunk other than the last one is not made of whole words of the flash.
    Unaligned,
    /// No update has begun, or it is not complete.
    Incomplete,
    /// The table that was selected last has not been booted yet.
    NotBooted,
    /// The slot has no valid image to select.
    Empty,
    /// There is no room for another entry; an update makes room.
    Full,
    /// No such fault code.
    Code,
    /// An offset is not finite.
    NotFinite,
}

impl StoreError {
    pub(crate) fn flash(error: impl NorFlashError) -> Self {
        Self::Flash(error.kind())
    }
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Region => "the region is not made of whole sectors, overlaps, or is too short",
            Self::Flash(kind) => return write!(f, "flash: {kind}"),
            Self::Image(error) => return error.fmt(f),
            Self::Length => "the image does not fit",
            Self::Different => "the image is not the one that is named",
            Self::Offset { expected } => return write!(f, "expected the chunk at {expected}"),
            Self::Unaligned => "the chunk is not made of whole words",
            Self::Incomplete => "no update has begun, or it is not complete",
            Self::NotBooted => "the table selected last has not been booted yet",
            Self::Empty => "the slot is empty",
            Self::Full => "no room for another entry",
            Self::Code => "no such fault code",
            Self::NotFinite => "an offset is not finite",
        })
    }
}

impl core::error::Error for StoreError {}
