//! The records: a sample on its way in, an outcome on its way back.

use core::fmt;

use tempco::{Output, Status};

/// A record of fixed length; the layouts are in the documentation of the crate.
pub trait Record: Sized {
    /// Bytes of an encoded record.
    const LEN: usize;

    /// Writes the record to the start of `bytes` and leaves the rest alone.
    ///
    /// # Errors
    /// Fewer than [`LEN`](Self::LEN) bytes; nothing is written then.
    fn encode(&self, bytes: &mut [u8]) -> Result<(), RecordError>;

    /// Reads a record from the start of `bytes`.
    ///
    /// # Errors
    /// Fewer than [`LEN`](Self::LEN) bytes. All bit patterns are records: a NaN is data, and whatever is
    /// not 0 says yes.
    fn decode(bytes: &[u8]) -> Result<Self, RecordError>;
}

/// One moment of a log: `C` temperatures, each with the raw samples of its `A` axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const C: usize, const A: usize> {
    /// Time since the last thermal update, where this is one \[s\].
    pub update_s: Option<f32>,
    /// Temperature of each channel \[degC\]; NaN where there is none. Taken by an update alone.
    pub temps_c: [f32; C],
    /// Gyro samples of each channel's axes \[unit of the axis\].
    pub raw: [[f32; A]; C],
}

/// What the compensator made of a [`Sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome<const C: usize, const A: usize> {
    /// One per temperature channel.
    pub channels: [ChannelOutcome<A>; C],
}

/// The outcome of one temperature channel for its part of a [`Sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelOutcome<const A: usize> {
    /// Lag-compensated temperature \[degC\].
    pub effective_c: f32,
    /// Rate of temperature \[degC/min\].
    pub rate_c_per_min: f32,
    /// The bits of the status, widened.
    pub status: u32,
    /// The bias that was taken out \[unit of the axis\].
    pub bias: [f32; A],
    /// The sample without it; every NaN is 0x7fc00000 \[unit of the axis\].
    pub compensated: [f32; A],
}

impl<const A: usize> ChannelOutcome<A> {
    /// The status as flags.
    pub const fn flags(&self) -> Status {
        Status::from_bits(self.status as u16)
    }
}

impl<const A: usize> From<Output<A>> for ChannelOutcome<A> {
    #[inline]
    fn from(output: Output<A>) -> Self {
        Self {
            effective_c: output.point.effective_c,
            rate_c_per_min: output.point.rate_c_per_min,
            status: u32::from(output.status.bits()),
            bias: output.bias,
            compensated: output.compensated.map(canonical),
        }
    }
}

impl<const C: usize, const A: usize> From<[Output<A>; C]> for Outcome<C, A> {
    #[inline]
    fn from(channels: [Output<A>; C]) -> Self {
        Self {
            channels: channels.map(ChannelOutcome::from),
        }
    }
}

/// A NaN of an arithmetic operation differs in sign and payload between processors; here it is
/// always the positive quiet one.
fn canonical(value: f32) -> f32 {
    if value.is_nan() {
        f32::from_bits(0x7fc0_0000)
    } else {
        value
    }
}

impl<const C: usize, const A: usize> Record for Sample<C, A> {
    const LEN: usize = {
        assert!(C > 0 && A > 0, "a record has channels and axes");
        4 * (2 + C + C * A)
    };

    fn encode(&self, bytes: &mut [u8]) -> Result<(), RecordError> {
        let mut words = WordWriter::new(bytes, Self::LEN)?;
        words.put(u32::from(self.update_s.is_some()));
        words.put_f32(self.update_s.unwrap_or(0.0));
        words.put_all(&self.temps_c);
        for axes in &self.raw {
            words.put_all(axes);
        }
        Ok(())
    }

    fn decode(bytes: &[u8]) -> Result<Self, RecordError> {
        let mut words = WordReader::new(bytes, Self::LEN)?;
        let is_update = words.take() != 0;
        let update_s = words.take_f32();
        Ok(Self {
            update_s: is_update.then_some(update_s),
            temps_c: core::array::from_fn(|_| words.take_f32()),
            raw: core::array::from_fn(|_| core::array::from_fn(|_| words.take_f32())),
        })
    }
}

impl<const C: usize, const A: usize> Record for Outcome<C, A> {
    const LEN: usize = {
        assert!(C > 0 && A > 0, "a record has channels and axes");
        4 * C * (3 + 2 * A)
    };

    fn encode(&self, bytes: &mut [u8]) -> Result<(), RecordError> {
        let mut words = WordWriter::new(bytes, Self::LEN)?;
        for channel in &self.channels {
            words.put_f32(channel.effective_c);
            words.put_f32(channel.rate_c_per_min);
            words.put(channel.status);
            for (bias, compensated) in channel.bias.iter().zip(&channel.compensated) {
                words.put_f32(*bias);
                words.put_f32(*compensated);
            }
        }
        Ok(())
    }

    fn decode(bytes: &[u8]) -> Result<Self, RecordError> {
        let mut words = WordReader::new(bytes, Self::LEN)?;
        let mut channel = |_| {
            let mut channel = ChannelOutcome {
                effective_c: words.take_f32(),
                rate_c_per_min: words.take_f32(),
                status: words.take(),
                bias: [0.0; A],
                compensated: [0.0; A],
            };
            for (bias, compensated) in channel.bias.iter_mut().zip(&mut channel.compensated) {
                *bias = words.take_f32();
                *compensated = words.take_f32();
            }
            channel
        };
        Ok(Self {
            channels: core::array::from_fn(&mut channel),
        })
    }
}

/// The records of a stream's remainder behind its header.
///
/// # Errors
/// The bytes end within a record.
pub fn decode_all<R: Record>(
    bytes: &[u8],
) -> Result<impl ExactSizeIterator<Item = R>, RecordError> {
    let chunks = bytes.chunks_exact(R::LEN);
    match chunks.remainder().len() {
        0 => Ok(Complete {
            chunks,
            record: core::marker::PhantomData,
        }),
        given => Err(RecordError::Truncated {
            records: bytes.len() / R::LEN,
            given,
            needed: R::LEN,
        }),
    }
}

/// Records decoded from chunks that each hold a complete one.
struct Complete<'a, R> {
    chunks: core::slice::ChunksExact<'a, u8>,
    record: core::marker::PhantomData<R>,
}

impl<R: Record> Iterator for Complete<'_, R> {
    type Item = R;

    fn next(&mut self) -> Option<R> {
        self.chunks.next().and_then(|chunk| R::decode(chunk).ok())
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.chunks.size_hint()
    }
}

impl<R: Record> ExactSizeIterator for Complete<'_, R> {}

/// Writes little-endian words into a slice whose length was checked before.
struct WordWriter<'a>(core::slice::IterMut<'a, [u8; 4]>);

impl<'a> WordWriter<'a> {
    fn new(bytes: &'a mut [u8], needed: usize) -> Result<Self, RecordError> {
        let given = bytes.len();
        match bytes.get_mut(..needed) {
            Some(bytes) => Ok(Self(bytes.as_chunks_mut().0.iter_mut())),
            None => Err(RecordError::Short { given, needed }),
        }
    }

    fn put(&mut self, word: u32) {
        if let Some(slot) = self.0.next() {
            *slot = word.to_le_bytes();
        }
    }

    fn put_f32(&mut self, value: f32) {
        self.put(value.to_bits());
    }

    fn put_all(&mut self, values: &[f32]) {
        for value in values {
            self.put_f32(*value);
        }
    }
}

/// Reads little-endian words from a slice whose length was checked before.
struct WordReader<'a>(core::slice::Iter<'a, [u8; 4]>);

impl<'a> WordReader<'a> {
    fn new(bytes: &'a [u8], needed: usize) -> Result<Self, RecordError> {
        let given = bytes.len();
        match bytes.get(..needed) {
            Some(bytes) => Ok(Self(bytes.as_chunks().0.iter())),
            None => Err(RecordError::Short { given, needed }),
        }
    }

    fn take(&mut self) -> u32 {
        self.0.next().map_or(0, |word| u32::from_le_bytes(*word))
    }

    fn take_f32(&mut self) -> f32 {
        f32::from_bits(self.take())
    }
}

/// Why bytes could not be made into records, or a record into bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RecordError {
    /// The slice is shorter than the record.
    Short {
        /// Bytes that were there.
        given: usize,
        /// Bytes of the record.
        needed: usize,
    },
    /// A stream ends within a record.
    Truncated {
        /// Complete records before the end.
        records: usize,
        /// Bytes of the incomplete record.
        given: usize,
        /// Bytes of a complete record.
        needed: usize,
    },
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Short { given, needed } => {
                write!(f, "a record takes {needed} bytes, there are {given}")
            }
            Self::Truncated {
                records,
                given,
                needed,
            } => write!(
                f,
                "the stream ends {given} bytes into a record of {needed}, after {records} records"
            ),
        }
    }
}

impl core::error::Error for RecordError {}
