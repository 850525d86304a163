//! The unit's side: carries out each request once and in order.

use crate::decoder::Counters;
use crate::frame::{MAX_FRAME, Numbers, read, read_numbers};
use crate::{Decoder, Frame, Refusal, Request, Response, Telemetry, VERSION};

/// Carries out requests; [`Request::Hello`] is answered by the [`Server`].
pub trait Handler {
    /// Carries out a request and answers it.
    fn handle(&mut self, request: Request<'_>) -> Response<'_>;
}

/// The session in which the unit is.
#[derive(Clone, Copy)]
struct Session {
    number: u32,
    /// The last request that was carried out.
    last: u16,
    /// Of the hello that opened it.
    nonce: u32,
}

/// Answers the frames of a host.
pub struct Server {
    decoder: Decoder,
    session: Option<Session>,
    next_session: u32,
    /// The answer to the last request, in case it is asked for again.
    answer: [u8; MAX_FRAME],
    answer_len: usize,
    /// Other frames: hellos, refusals and telemetry.
    aside: [u8; MAX_FRAME],
}

/// What is to be done about a frame.
enum Verdict {
    Execute,
    Repeat,
    Refuse(Refusal),
    Ignore,
}

/// The number after another; 0 is for what was not asked for.
pub(crate) const fn next(sequence: u16) -> u16 {
    match sequence.wrapping_add(1) {
        0 => 1,
        next => next,
    }
}

impl Server {
    /// A server without a session. Sessions are numbered from `first_session` on. None of these
    /// numbers may have been one of an earlier boot.
    pub const fn new(first_session: u32) -> Self {
        Self {
            decoder: Decoder::new(),
            session: None,
            next_session: first_session,
            answer: [0; MAX_FRAME],
            answer_len: 0,
            aside: [0; MAX_FRAME],
        }
    }

    /// Takes a byte from the wire; returns the frame to send if it ended one that needs an answer.
    pub fn receive(&mut self, byte: u8, handler: &mut impl Handler) -> Option<&[u8]> {
        let plain = self.decoder.push(byte)?;
        let Numbers { session, sequence } = read_numbers(plain)?;
        let request = read::<Frame<Request>>(plain).map(|frame| frame.message);
        if let Ok(Request::Hello { major, nonce, .. }) = request {
            let response = self.greet(major, nonce, sequence);
            return self.say(session, sequence, response);
        }
        match verdict(self.session, session, sequence) {
            Verdict::Ignore => return None,
            Verdict::Repeat => {}
            Verdict::Refuse(refusal) => {
                return self.say(session, sequence, Response::Refused(refusal));
            }
            Verdict::Execute => {
                if let Some(current) = &mut self.session {
                    current.last = sequence;
                }
                let message = match request {
                    Ok(request) => handler.handle(request),
                    Err(_) => Response::Refused(Refusal::Unknown),
                };
                let frame = |message| Frame {
                    session,
                    sequence,
                    message,
                };
                // A response that is too long is a mistake of the handler; the host is told.
                let encoded = frame(message).encode(&mut self.answer).or_else(|_| {
                    frame(Response::Refused(Refusal::Unsupported)).encode(&mut self.answer)
                });
                self.answer_len = encoded.unwrap_or(0);
            }
        }
        self.answer.get(..self.answer_len)
    }

    /// Opens a session, unless this hello has just opened the present one; none for another major
    /// version, which is told this one.
    fn greet(&mut self, major: u8, nonce: u32, sequence: u16) -> Response<'static> {
        let session = match self.session {
            _ if major != VERSION.0 => 0,
            Some(current) if current.nonce == nonce => current.number,
            _ => {
                let number = self.next_session.max(1);
                self.next_session = number.wrapping_add(1);
                self.session = Some(Session {
                    number,
                    last: sequence,
                    nonce,
                });
                self.answer_len = 0;
                number
            }
        };
        Response::Hello {
            major: VERSION.0,
            minor: VERSION.1,
            nonce,
            session,
        }
    }

    /// Says something that is not kept.
    fn say(&mut self, session: u32, sequence: u16, message: Response) -> Option<&[u8]> {
        let frame = Frame {
            session,
            sequence,
            message,
        };
        let len = frame.encode(&mut self.aside).ok()?;
        self.aside.get(..len)
    }

    /// A frame of telemetry to send unasked; none without a session.
    pub fn telemetry(&mut self, telemetry: Telemetry) -> Option<&[u8]> {
        let session = self.session?.number;
        self.say(session, 0, Response::Telemetry(telemetry))
    }

    /// The number of the session that the next hello opens.
    pub const fn next_session(&self) -> u32 {
        self.next_session
    }

    /// Frames received so far.
    pub const fn counters(&self) -> &Counters {
        self.decoder.counters()
    }
}

fn verdict(current: Option<Session>, session: u32, sequence: u16) -> Verdict {
    let Some(current) = current.filter(|current| current.number == session) else {
        return Verdict::Refuse(Refusal::Session);
    };
    let expected = next(current.last);
    if sequence == expected {
        Verdict::Execute
    } else if sequence == current.last {
        Verdict::Repeat
    } else if sequence == 0 || sequence.wrapping_sub(current.last) > u16::MAX / 2 {
        // Long answered.
        Verdict::Ignore
    } else {
        Verdict::Refuse(Refusal::Order { expected })
    }
}
