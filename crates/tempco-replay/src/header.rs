//! The head of a stream, by which a log, an image and a table are found to belong together.

use core::fmt;

/// Version of the format this crate reads and writes.
pub const VERSION: u16 = 2;

/// What the records of a stream are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Kind {
    /// Samples, on their way into the compensator.
    Samples,
    /// Outcomes, on their way back.
    Outcomes,
}

impl Kind {
    const fn magic(self) -> &'static [u8; 8] {
        match self {
            Self::Samples => b"TCSAMPLE",
            Self::Outcomes => b"TCOUTCOM",
        }
    }
}

/// The first 16 bytes of a stream; their layout is in the documentation of the crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// What follows.
    pub kind: Kind,
    /// Temperature channels per record.
    pub channels: u8,
    /// Axes per channel.
    pub axes: u8,
    /// CRC of the coefficient table that made the outcomes; 0 for samples, which have none.
    pub table_crc: u32,
}

impl Header {
    /// Bytes of an encoded header.
    pub const LEN: usize = 16;

    /// The header of a stream of [`Sample<C, A>`](crate::Sample).
    pub const fn samples<const C: usize, const A: usize>() -> Self {
        Self::new::<C, A>(Kind::Samples, 0)
    }

    /// The header of a stream of [`Outcome<C, A>`](crate::Outcome) made with a table.
    pub const fn outcomes<const C: usize, const A: usize>(table_crc: u32) -> Self {
        Self::new::<C, A>(Kind::Outcomes, table_crc)
    }

    const fn new<const C: usize, const A: usize>(kind: Kind, table_crc: u32) -> Self {
        const {
            assert!(C > 0 && C < 256, "1 to 255 channels");
            assert!(A > 0 && A < 256, "1 to 255 axes");
        }
        Self {
            kind,
            channels: C as u8,
            axes: A as u8,
            table_crc,
        }
    }

    /// The header as bytes.
    pub fn encode(&self) -> [u8; Self::LEN] {
        // Without slices: the image `guard` shows that no build of this can panic.
        let [m0, m1, m2, m3, m4, m5, m6, m7] = *self.kind.magic();
        let [v0, v1] = VERSION.to_le_bytes();
        let [c0, c1, c2, c3] = self.table_crc.to_le_bytes();
        let (channels, axes) = (self.channels, self.axes);
        [
            m0, m1, m2, m3, m4, m5, m6, m7, v0, v1, channels, axes, c0, c1, c2, c3,
        ]
    }

    /// Reads a header from the start of `bytes`.
    ///
    /// # Errors
    /// Too few bytes, an unknown magic, or a version that is not [`VERSION`].
    pub fn decode(bytes: &[u8]) -> Result<Self, HeaderError> {
        let Some(bytes) = bytes.first_chunk::<{ Self::LEN }>() else {
            return Err(HeaderError::Short { given: bytes.len() });
        };
        let [magic @ .., v0, v1, channels, axes, c0, c1, c2, c3] = bytes;
        let kind = match magic {
            m if m == Kind::Samples.magic() => Kind::Samples,
            m if m == Kind::Outcomes.magic() => Kind::Outcomes,
            _ => return Err(HeaderError::Magic),
        };
        let version = u16::from_le_bytes([*v0, *v1]);
        if version != VERSION {
            return Err(HeaderError::Version { found: version });
        }
        Ok(Self {
            kind,
            channels: *channels,
            axes: *axes,
            table_crc: u32::from_le_bytes([*c0, *c1, *c2, *c3]),
        })
    }

    /// Checks that a header that was read is the expected one.
    ///
    /// # Errors
    /// Says what differs first: kind, shape, table.
    pub fn expect(&self, expected: &Self) -> Result<(), HeaderError> {
        if self.kind != expected.kind {
            return Err(HeaderError::Kind { found: self.kind });
        }
        if (self.channels, self.axes) != (expected.channels, expected.axes) {
            return Err(HeaderError::Shape {
                channels: self.channels,
                axes: self.axes,
                expected_channels: expected.channels,
                expected_axes: expected.axes,
            });
        }
        if self.table_crc != expected.table_crc {
            return Err(HeaderError::Table {
                found: self.table_crc,
                expected: expected.table_crc,
            });
        }
        Ok(())
    }
}

/// Why a stream was refused at its head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum HeaderError {
    /// The stream ends within its header.
    Short {
        /// Bytes that were there.
        given: usize,
    },
    /// The stream is neither samples nor outcomes.
    Magic,
    /// The stream is of another version of the format.
    Version {
        /// The version it says.
        found: u16,
    },
    /// Outcomes where samples were expected, or the other way round.
    Kind {
        /// What it holds.
        found: Kind,
    },
    /// The records have another number of channels or axes.
    Shape {
        /// Channels in the stream.
        channels: u8,
        /// Axes per channel in the stream.
        axes: u8,
        /// Channels expected.
        expected_channels: u8,
        /// Axes per channel expected.
        expected_axes: u8,
    },
    /// The outcomes were made with another table.
    Table {
        /// CRC of the table that was used.
        found: u32,
        /// CRC of the table that should have been used.
        expected: u32,
    },
}

impl fmt::Display for HeaderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Short { given } => {
                write!(
                    f,
                    "the stream ends after {given} of {} header bytes",
                    Header::LEN
                )
            }
            Self::Magic => f.write_str("the stream is neither samples nor outcomes of tempco"),
            Self::Version { found } => {
                write!(f, "the stream is of format version {found}, not {VERSION}")
            }
            Self::Kind { found } => write!(f, "the stream unexpectedly holds {found:?}"),
            Self::Shape {
                channels,
                axes,
                expected_channels,
                expected_axes,
            } => write!(
                f,
                "the records have {channels} channel(s) of {axes} axes, \
                 expected are {expected_channels} of {expected_axes}"
            ),
            Self::Table { found, expected } => write!(
                f,
                "the outcomes were made with table {found:08x}, expected is {expected:08x}"
            ),
        }
    }
}

impl core::error::Error for HeaderError {}
