//! The host's side: numbers requests and knows their answers.

use crate::decoder::Counters;
use crate::frame::{MAX_FRAME, read};
use crate::server::next;
use crate::{Decoder, Frame, LinkError, Request, Response, Telemetry, VERSION};

/// What a unit sent.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event<'a> {
    /// The answer to the request that is open, which it no longer is.
    Answer(Response<'a>),
    /// Telemetry that was not asked for.
    Telemetry(Telemetry),
}

/// Asks a unit, one request at a time.
///
/// The caller sends what [`hello`](Self::hello) and [`request`](Self::request) return, feeds in
/// what comes back, and if no answer comes in time, sends [`again`](Self::again). After
/// [`Refusal::Session`](crate::Refusal::Session) it says hello again, with another nonce.
pub struct Client {
    decoder: Decoder,
    session: u32,
    sequence: u16,
    nonce: u32,
    is_open: bool,
    wire: [u8; MAX_FRAME],
    len: usize,
}

impl Default for Client {
    fn default() -> Self {
        Self::new()
    }
}

impl Client {
    /// A client without a session.
    pub const fn new() -> Self {
        Self {
            decoder: Decoder::new(),
            session: 0,
            sequence: 0,
            nonce: 0,
            is_open: false,
            wire: [0; MAX_FRAME],
            len: 0,
        }
    }

    /// The frame that opens a session. The nonce should be another one than last time, for
    /// instance from a clock.
    ///
    /// # Errors
    /// None in practice: a hello is short.
    pub fn hello(&mut self, nonce: u32) -> Result<&[u8], LinkError> {
        self.session = 0;
        self.sequence = 0;
        self.nonce = nonce;
        let (major, minor) = VERSION;
        self.request(&Request::Hello {
            major,
            minor,
            nonce,
        })
    }

    /// The frame of a request; one that is still open is given up.
    ///
    /// # Errors
    /// [`LinkError::Long`]: a chunk of more than [`MAX_CHUNK`](crate::MAX_CHUNK) bytes.
    pub fn request(&mut self, request: &Request) -> Result<&[u8], LinkError> {
        let sequence = next(self.sequence);
        let frame = Frame {
            session: self.session,
            sequence,
            message: request,
        };
        self.len = frame.encode(&mut self.wire)?;
        self.sequence = sequence;
        self.is_open = true;
        Ok(self.again())
    }

    /// The frame of the last request once more.
    pub fn again(&self) -> &[u8] {
        self.wire.get(..self.len).unwrap_or_default()
    }

    /// Takes a byte from the wire. What is not the answer to the open request, or telemetry of
    /// this session, is passed over.
    pub fn receive(&mut self, byte: u8) -> Option<Event<'_>> {
        let plain = self.decoder.push(byte)?;
        let frame = read::<Frame<Response>>(plain).ok()?;
        if frame.session != self.session {
            return None;
        }
        match frame.message {
            Response::Telemetry(telemetry) if frame.sequence == 0 => {
                Some(Event::Telemetry(telemetry))
            }
            // Of an earlier hello.
            Response::Hello { nonce, .. } if nonce != self.nonce => None,
            message if self.is_open && frame.sequence == self.sequence => {
                self.is_open = false;
                if let Response::Hello { session, .. } = message {
                    self.session = session;
                }
                Some(Event::Answer(message))
            }
            _ => None,
        }
    }

    /// Frames received so far.
    pub const fn counters(&self) -> &Counters {
        self.decoder.counters()
    }
}
