//! The serial link between tempco firmware and a host: samples in, results out, telemetry,
//! updates of the coefficient table, commands. Firmware and host compile this same crate.
//!
//! ```text
//! message -> postcard -> CRC-32P4 -> COBS -> 0 bytes 0 -> wire -> Decoder -> Server | Client
//! ```
//!
//! # Frames
//! A message, with its session and sequence number, is encoded by
//! [postcard](https://postcard.jamesmunns.com/wire-format), followed by its CRC-32P4 (little-endian,
//! finds all errors of up to 5 bits in frames of this size), stuffed by COBS so that it has no
//! zero, and sent between two zero bytes. The leading zero parts it from garbage before it. A
//! [`Decoder`] holds one frame of bounded length and finds its place again at the next zero.
//!
//! # Sessions
//! The host asks, the unit answers. [`Request::Hello`] opens a session, whose number the unit gives
//! and never gives again; the host counts its requests. The [`Server`] carries out a request only
//! if it is of the open session and the next in order; it answers one that comes again with the
//! same bytes as before, without carrying it out again; it refuses or passes over all others. So
//! frames that are lost, cut, reordered, duplicated or replayed, even whole sessions of them, do
//! no harm: at worst the host must say hello again. Telemetry that was asked for once comes under
//! sequence number 0. There is no protection against somebody who forges frames.
//!
//! # Updates
//! Chunks name their offset, and the table is only stored with the length and CRC-32P4 of all its
//! bytes; see the crate `tempco-store`, which decides. [`Request::Activate`] takes it into use.
//!
//! # Versions
//! `Hello` and its answer keep their encoding for ever. A host and a unit of different major
//! [`VERSION`] refuse each other: the unit answers with its version and opens no session. (Firmware of
//! version 1 answers [`Refusal::Version`].) A newer minor version adds variants at the end of
//! [`Request`] and [`Response`]; who does not know one refuses it ([`Refusal::Unknown`]) or drops
//! it.
//!
//! # Example
//!
//! ```
//! use tempco_link::{Client, Event, Handler, Request, Response, Server, VERSION};
//!
//! struct Unit;
//! impl Handler for Unit {
//!     fn handle(&mut self, request: Request<'_>) -> Response<'_> {
//!         match request {
//!             Request::Identify => Response::Done,
//!             _ => Response::Refused(tempco_link::Refusal::Unsupported),
//!         }
//!     }
//! }
//!
//! let (mut client, mut server) = (Client::new(), Server::new(1));
//! let hello = client.hello(17)?.to_vec();
//! let mut answers = Vec::new();
//! for byte in hello {
//!     if let Some(answer) = server.receive(byte, &mut Unit) {
//!         answers.extend_from_slice(answer);
//!     }
//! }
//! let events: Vec<_> = answers
//!     .iter()
//!     .filter_map(|byte| client.receive(*byte).map(|event| format!("{event:?}")))
//!     .collect();
//! assert_eq!(events.len(), 1);
//! assert!(events[0].contains(&format!("major: {}", VERSION.0)));
//! # Ok::<(), tempco_link::LinkError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod block_crc;
mod client;
mod decoder;
mod fault;
mod frame;
mod message;
mod server;

pub use block_crc::BlockCrc;
pub use client::{Client, Event};
pub use decoder::{Counters, Decoder};
pub use fault::{Fault, FaultSet};
pub use frame::{Frame, LinkError, MAX_FRAME, MAX_MESSAGE};
pub use message::{
    Axes, Bank, ChannelTelemetry, Channels, FaultEntry, Losses, MAX_BLOCK, MAX_CHUNK, MAX_FAULTS,
    Outcome, OutcomeBlock, Refusal, Request, Response, Sample, SampleBlock, Telemetry, VERSION,
    Wear,
};
pub use server::{Handler, Server};
