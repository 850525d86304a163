//! Replays a log through the compensator, in the same way on a host and on a target.
//!
//! A log becomes a stream of fixed-length samples; the replay step turns each into an outcome of
//! fixed length. Host and firmware run the same [`Replay`], so their outcome streams can be
//! compared byte by byte. What a [`tempco::Stream`] puts out becomes an [`Outcome`] too. This crate
//! knows nothing of files or wires: it encodes into and decodes from byte slices, without heap and
//! without panics.
//!
//! Who makes the samples says which of them are thermal updates. In between, the bias of the last
//! update stays.
//!
//! # Format
//!
//! A stream is one [`Header`] followed by records until it ends. All numbers are little-endian;
//! `f32` is IEEE 754 single precision. With `C` temperature channels of `A` axes each:
//!
//! | header, 16 bytes | offset | type | content |
//! |---|---|---|---|
//! | magic | 0 | 8 bytes | `TCSAMPLE` or `TCOUTCOM` |
//! | version | 8 | u16 | [`VERSION`] |
//! | channels | 10 | u8 | `C` |
//! | axes | 11 | u8 | `A` |
//! | table CRC | 12 | u32 | of the table that made the outcomes; 0 for samples |
//!
//! | sample, `4 (2 + C + C A)` bytes | offset | type | content |
//! |---|---|---|---|
//! | is update | 0 | u32 | 0 where the row is no thermal update, else 1 |
//! | `update_s` | 4 | f32 | of an update, time since the one before \[s\]; else 0 |
//! | `temps_c[c]` | `8 + 4 c` | f32 | temperature \[degC\] |
//! | `raw[c][a]` | `8 + 4 C + 4 (c A + a)` | f32 | gyro sample \[unit of the axis\] |
//!
//! | outcome, `C` times `4 (3 + 2 A)` bytes | offset in channel | type | content |
//! |---|---|---|---|
//! | `effective_c` | 0 | f32 | lag-compensated temperature \[degC\] |
//! | `rate_c_per_min` | 4 | f32 | rate of temperature \[degC/min\] |
//! | `status` | 8 | u32 | bits of [`tempco::Status`] |
//! | `bias[a]` | `12 + 8 a` | f32 | bias taken out \[unit of the axis\] |
//! | `compensated[a]` | `16 + 8 a` | f32 | sample without it \[unit of the axis\] |
//!
//! # Example
//!
//! ```
//! use tempco_replay::{Header, Record, Sample, decode_all};
//!
//! let sample = Sample { update_s: Some(1.0), temps_c: [25.0], raw: [[0.1, 0.2, 0.3]] };
//! let mut bytes = [0; Header::LEN + Sample::<1, 3>::LEN];
//! bytes[..Header::LEN].copy_from_slice(&Header::samples::<1, 3>().encode());
//! sample.encode(&mut bytes[Header::LEN..])?;
//!
//! Header::decode(&bytes)?.expect(&Header::samples::<1, 3>())?;
//! let mut samples = decode_all::<Sample<1, 3>>(&bytes[Header::LEN..])?;
//! assert_eq!(samples.next(), Some(sample));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod header;
mod record;
mod replay;

pub use header::{Header, HeaderError, Kind, VERSION};
pub use record::{ChannelOutcome, Outcome, Record, RecordError, Sample, decode_all};
pub use replay::{Replay, Summary};
