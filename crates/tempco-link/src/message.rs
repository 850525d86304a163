//! What is said: requests of the host, responses of the unit.

use heapless::Vec;
use serde::{Deserialize, Serialize};
use tempco::MAX_AXES;

use crate::FaultSet;

/// Version of the protocol, major and minor.
pub const VERSION: (u8, u8) = (2, 0);

/// The most bytes of a chunk of an image; of whole words of any flash.
pub const MAX_CHUNK: usize = 256;
/// The most bytes of the gyro samples of a block: 80 samples of three axes.
pub const MAX_BLOCK: usize = 960;
/// The most faults in a response.
pub const MAX_FAULTS: usize = 8;

/// A figure per axis, channel by channel.
pub type Axes = Vec<f32, MAX_AXES>;
/// One thing per temperature channel, of which there are as many as axes at most.
pub type Channels<T> = Vec<T, MAX_AXES>;

/// One of the two copies of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Bank {
    /// The first one.
    A,
    /// The second one.
    B,
}

/// What a host asks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Request<'a> {
    /// Begins a session; answered by [`Response::Hello`] also by other versions, from 2.0 on.
    Hello {
        /// Major version of the host.
        major: u8,
        /// Minor version of the host.
        minor: u8,
        /// Any number that the host did not use last; comes back in the answer.
        nonce: u32,
    },
    /// Asks for [`Response::Identity`].
    Identify,
    /// Asks for [`Response::Telemetry`] now and, if the period is not 0, again every period.
    Telemetry {
        /// Period \[ms\].
        period_ms: u32,
    },
    /// Compensates this sample instead of one of the gyro; answered by [`Response::Outcome`].
    Sample(Sample),
    /// Runs the built-in test; answered by [`Response::Bit`].
    Bit,
    /// Takes the mean over this time, at rest, as the constant bias from now on. Given up with
    /// [`Fault::ReZero`](crate::Fault::ReZero) where the unit is not valid and at rest all the time.
    ReZero {
        /// Averaging time \[s\].
        averaging_s: u16,
        /// What the gyro should show meanwhile, such as the Earth's rate; empty for nothing
        /// \[unit of the axis\].
        expected: Axes,
    },
    /// Begins to write an image into the bank that is not in use.
    UploadBegin {
        /// Length of the image \[bytes\].
        len: u32,
    },
    /// The next chunk of the image, or one that was sent before; answered by
    /// [`Response::Expected`].
    UploadChunk {
        /// Where it begins \[bytes\].
        offset: u32,
        /// Up to [`MAX_CHUNK`] bytes.
        bytes: &'a [u8],
    },
    /// Ends the upload: the image is checked and stored if it is good. It is not used before it is
    /// activated.
    UploadCommit {
        /// Length of the image \[bytes\].
        len: u32,
        /// CRC-32P4 of all its bytes.
        crc: u32,
    },
    /// Makes the table in a bank the one to boot with, and resets the unit: a table that was stored,
    /// or the one before, which is the roll-back.
    Activate(Bank),
    /// Asks for a stretch of a bank's image; answered by [`Response::Chunk`], which is empty behind
    /// its end.
    Download {
        /// The bank.
        bank: Bank,
        /// Where the stretch begins \[bytes\].
        offset: u32,
        /// Its length, up to [`MAX_CHUNK`] \[bytes\].
        len: u16,
    },
    /// Asks for the fault log from a code on; answered by [`Response::Faults`].
    Faults {
        /// The lowest code.
        from_code: u16,
    },
    /// Forgets what was replayed: the next sample or block is the first one after power-on.
    Restart,
    /// Passes these through the sampling interrupt instead of samples of the gyro, at the pace of
    /// its timer or as fast as it goes; answered by [`Response::Block`].
    Block(SampleBlock<'a>),
    /// Sets the constant biases of re-zero to zero, in the store too.
    ClearOffsets,
    /// Asks for [`Response::Losses`].
    Losses,
    /// Asks for [`Response::Wear`].
    Wear,
}

/// What a unit says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Response<'a> {
    /// Answer to [`Request::Hello`].
    Hello {
        /// Major version of the unit.
        major: u8,
        /// Minor version of the unit.
        minor: u8,
        /// As in the request.
        nonce: u32,
        /// Number of the session, which all further requests bear; 0, which is none, to a host of
        /// another major version.
        session: u32,
    },
    /// It was not carried out.
    Refused(Refusal),
    /// It was carried out, and there is nothing more to say.
    Done,
    /// What the unit is.
    Identity {
        /// Serial number of the unit.
        serial: &'a str,
        /// Firmware and its version.
        firmware: &'a str,
        /// Temperature channels.
        channels: u8,
        /// Axes of each channel.
        axes: u8,
        /// Gyro samples per second \[Hz\].
        sample_rate_hz: f32,
        /// Gyro samples between two temperatures.
        samples_per_update: u16,
        /// The bank in use; none if the unit runs uncompensated.
        bank: Option<Bank>,
        /// The bank into which an upload goes, which is not in use.
        spare: Bank,
        /// CRC of the table in use, as in `coefficients.json`; 0 without one.
        table_crc: u32,
        /// Number of selections so far.
        sequence: u32,
        /// Scale factor of the gyro, by which a unit turns pulses into angles \[arcsec/pulse\].
        scale_factor_arcsec: f32,
        /// Units that the axes of a table must have, channel by channel, by their codes in an image.
        units: Vec<u8, MAX_AXES>,
        /// The largest bias that a table may have, of each axis \[unit of the axis\].
        max_bias: Axes,
    },
    /// The state of the unit.
    Telemetry(Telemetry),
    /// What became of a [`Request::Sample`].
    Outcome(Outcome),
    /// Result of the built-in test.
    Bit {
        /// Faults that were found, by the bits of their codes; none if it passed.
        faults: FaultSet,
    },
    /// Where the next chunk of an upload begins \[bytes\].
    Expected {
        /// Offset in the image.
        offset: u32,
    },
    /// A stretch of an image.
    Chunk {
        /// Where it begins \[bytes\].
        offset: u32,
        /// Its bytes.
        bytes: &'a [u8],
    },
    /// Faults by code; fewer than [`MAX_FAULTS`] if there are no more.
    Faults(Vec<FaultEntry, MAX_FAULTS>),
    /// What became of a [`Request::Block`].
    Block(OutcomeBlock<'a>),
    /// What was lost since power-on.
    Losses(Losses),
    /// How much of the flash is used up.
    Wear(Wear),
}

/// Why a request was not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Refusal {
    /// The host's major version is another, as firmware of version 1 says it.
    Version,
    /// The request is of no open session: say hello.
    Session,
    /// The request is not the next in order.
    Order {
        /// Sequence number that is.
        expected: u16,
    },
    /// The request is not one that this version knows, or has arguments out of range.
    Unknown,
    /// The unit cannot do this.
    Unsupported,
    /// Not now: something else is under way.
    Busy,
    /// The chunk is not the next one.
    Offset {
        /// Where the next one begins \[bytes\].
        expected: u32,
    },
    /// The image is not good: which check failed is in the log of the unit.
    Image,
    /// The store cannot do this.
    Store,
    /// The table does not fit the board: an axis is in another unit.
    Unit {
        /// Number of the axis, channel by channel.
        axis: u8,
    },
    /// The table does not fit the board: an axis was fitted with another scale factor, or with one
    /// that is not stated.
    ScaleFactor {
        /// Number of the axis, channel by channel.
        axis: u8,
    },
    /// The table does not fit the board: the bias of an axis may be too large.
    Bias {
        /// Number of the axis, channel by channel.
        axis: u8,
    },
}

/// One moment of a log, in place of a measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// Time since the last thermal update, where this is one \[s\].
    pub update_s: Option<f32>,
    /// Temperatures; NaN where there is none. Taken by an update alone \[degC\].
    pub temps_c: Channels<f32>,
    /// Gyro samples \[unit of the axis\].
    pub raw: Axes,
}

/// What the compensator made of a [`Sample`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Outcome {
    /// Of each channel.
    pub channels: Channels<ChannelTelemetry>,
    /// Biases that were taken out \[unit of the axis\].
    pub bias: Axes,
    /// Samples without them \[unit of the axis\].
    pub compensated: Axes,
}

/// Gyro samples in place of the gyro's own, without gaps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SampleBlock<'a> {
    /// Temperatures to take before the first sample, NaN where there is none; none at all where
    /// the thermal update is not yet due \[degC\].
    pub temps_c: Channels<f32>,
    /// At the pace of the unit's timer; otherwise as fast as it goes.
    pub real_time: bool,
    /// Without it, a value of [`raw`](Self::raw) is an `f32`, low byte first \[unit of the axis\];
    /// with it, a count of the gyro in one signed byte, to be multiplied by this in `f32`
    /// \[unit of the axis per count\].
    pub scale: Option<f32>,
    /// Values, sample by sample and in each channel by channel; as many as make up to
    /// [`MAX_BLOCK`] bytes of `f32`.
    pub raw: &'a [u8],
}

impl SampleBlock<'_> {
    /// The values, as `f32` \[unit of the axis\]; none where bytes are left over or there are more
    /// than a block can have.
    pub fn values(&self) -> Option<impl ExactSizeIterator<Item = f32>> {
        let len = if self.scale.is_some() { 1 } else { 4 };
        let count = self.raw.len() / len;
        if !self.raw.len().is_multiple_of(len) || count > MAX_BLOCK / 4 {
            return None;
        }
        let scale = self.scale.unwrap_or(f32::NAN);
        let values = self.raw.chunks_exact(len).map(move |bytes| match *bytes {
            [count] => f32::from(count.cast_signed()) * scale,
            [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
            _ => f32::NAN,
        });
        Some(values)
    }
}

/// What the unit made of a [`SampleBlock`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutcomeBlock<'a> {
    /// Of each channel, at the last sample.
    pub channels: Channels<ChannelTelemetry>,
    /// Biases that were taken out of the last sample \[unit of the axis\].
    pub bias: Axes,
    /// Samples without their biases, laid out as the samples were \[unit of the axis\].
    pub compensated: &'a [u8],
    /// Of the biases and flags of all samples: [`BlockCrc`](crate::BlockCrc).
    pub crc: u32,
}

/// The thermal path of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ChannelTelemetry {
    /// Lag-compensated temperature \[degC\].
    pub effective_c: f32,
    /// Rate of temperature \[degC/min\].
    pub rate_c_per_min: f32,
    /// Bits of `tempco::Status`.
    pub status: u16,
}

/// What a unit has lost since power-on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Losses {
    /// Gyro samples that were not taken: their sampling interrupt did not come, or too late.
    pub missed_samples: u32,
    /// Outcomes of gyro samples that telemetry and re-zero did not see; the output had them.
    pub moments: u32,
    /// Outcomes of replayed samples.
    pub replies: u32,
}

/// How often the flash of a unit was erased: of each region, the half that was erased more often.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Wear {
    /// The fault log.
    pub faults: u32,
    /// The offsets of re-zero, and the numbers of boots and sessions.
    pub offsets: u32,
}

/// The state of a unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Telemetry {
    /// Number of the message since power-on, by which lost ones are seen.
    pub index: u32,
    /// Time since power-on, later than in the message before \[ms\].
    pub uptime_ms: u32,
    /// Measured temperatures; NaN where there is none \[degC\].
    pub temps_c: Channels<f32>,
    /// Means of the gyro samples since the message before, of at least one \[unit of the axis\].
    pub raw: Axes,
    /// What the compensator made of them: means as well.
    pub outcome: Outcome,
    /// Constant biases found by re-zero, which are taken out besides \[unit of the axis\].
    pub offset: Axes,
    /// Gyro samples since power-on.
    pub samples: u32,
    /// Temperatures that were rejected, of all channels.
    pub rejected: u32,
    /// Sum of the [`Losses`].
    pub overruns: u32,
    /// Frames that were dropped.
    pub dropped_frames: u32,
    /// Faults that are present.
    pub faults: FaultSet,
    /// Share of the processor's time that was not spent asleep, over the last second \[1/1000\].
    pub load_permille: u16,
    /// Longest time since power-on from the sampling interrupt to the output \[ns\].
    pub latency_ns: u32,
}

/// A fault in the log of a unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FaultEntry {
    /// Code.
    pub code: u16,
    /// How often it occurred.
    pub count: u32,
    /// Boot in which it last occurred.
    pub boot: u32,
    /// When, after that boot \[s\].
    pub uptime_s: u32,
    /// What the unit adds.
    pub detail: u32,
}
