//! A session with a unit: asks, waits, asks again.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use tempco::Schedule;
use tempco_image::{Fit, Unit as AxisUnit};
use tempco_link::{
    Bank, Client, Event, FaultEntry, FaultSet, LinkError, Losses, MAX_FAULTS, Refusal, Request,
    Response, Telemetry, VERSION, Wear,
};

use crate::{Error, Port};

/// Messages of telemetry that are kept for the caller; older ones are dropped.
const MOST_TELEMETRY: usize = 1024;

/// How long to wait for answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Time after which a request is sent again.
    pub answer: Duration,
    /// How often a request is sent in all.
    pub tries: u32,
    /// The longest time that a reset and the boot after it may take.
    pub boot: Duration,
}

impl Default for Patience {
    /// 5 tries of 2 s: a unit may have to erase a sector of flash of 128 KiB before it answers.
    fn default() -> Self {
        Self {
            answer: Duration::from_secs(2),
            tries: 5,
            boot: Duration::from_secs(15),
        }
    }
}

/// What a unit is.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity {
    /// Serial number of the unit.
    pub serial: String,
    /// Firmware and its version.
    pub firmware: String,
    /// Temperature channels.
    pub channels: u8,
    /// Axes of each channel.
    pub axes: u8,
    /// How often it samples.
    pub schedule: Schedule,
    /// The bank in use; none if the unit runs uncompensated.
    pub bank: Option<Bank>,
    /// The bank into which an upload goes.
    pub spare: Bank,
    /// CRC of the table in use; 0 without one.
    pub table_crc: u32,
    /// Number of selections so far.
    pub sequence: u32,
    /// Scale factor of the gyro \[arcsec/pulse\].
    pub scale_factor_arcsec: f32,
    /// What each axis of a table must fit, channel by channel.
    pub fits: Vec<Fit>,
}

/// A unit, with an open session.
pub struct Unit {
    port: Box<dyn Port>,
    client: Client,
    patience: Patience,
    /// What was received and not yet looked at.
    received: VecDeque<u8>,
    telemetry: VecDeque<Telemetry>,
}

impl Unit {
    /// Opens a session with the unit at a port.
    ///
    /// # Errors
    /// No answer, a failing port, another major version.
    pub fn connect(port: Box<dyn Port>, patience: Patience) -> Result<Self, Error> {
        let mut unit = Self {
            port,
            client: Client::new(),
            patience,
            received: VecDeque::new(),
            telemetry: VecDeque::new(),
        };
        unit.hello(patience.answer, patience.tries)?;
        Ok(unit)
    }

    /// Opens a session, whatever was before.
    fn hello(&mut self, answer: Duration, tries: u32) -> Result<(), Error> {
        const REQUEST: &str = "hello";
        framed(REQUEST, self.client.hello(nonce()))?;
        let opened = self.exchange(REQUEST, answer, tries, |response| match response {
            Response::Hello { major, .. } => Some(*major),
            _ => None,
        });
        match opened {
            Ok(major) if major == VERSION.0 => Ok(()),
            Ok(unit) => Err(Error::Version { unit }),
            // Later firmware answers with its version.
            Err(Error::Refused {
                refusal: Refusal::Version,
                ..
            }) => Err(Error::Version { unit: 1 }),
            Err(other) => Err(other),
        }
    }

    /// Waits until a unit that resets itself has booted, and opens a session.
    ///
    /// # Errors
    /// It does not answer within [`Patience::boot`].
    pub fn reconnect(&mut self) -> Result<(), Error> {
        // Short waits, since what is sent during the boot may be lost.
        let answer = Duration::from_millis(200).min(self.patience.answer);
        let tries = self.patience.boot.as_millis() / answer.as_millis().max(1);
        self.hello(answer, (tries as u32).max(1))
    }

    /// Asks, and reads the answer; `read` returns nothing for one that does not fit.
    ///
    /// A question that was lost is sent again, and carried out once in any case. If the unit knows
    /// nothing of the session, a new one is opened; then a request that does not depend on earlier
    /// ones is made again.
    ///
    /// # Errors
    /// No answer, a refusal, an answer that does not fit, a session that was lost under way.
    pub fn ask<T>(
        &mut self,
        request: &Request,
        read: impl FnMut(&Response) -> Option<T>,
    ) -> Result<T, Error> {
        self.ask_patiently(request, Duration::ZERO, read)
    }

    /// As [`ask`](Self::ask), of what takes the unit so much longer.
    pub(crate) fn ask_patiently<T>(
        &mut self,
        request: &Request,
        longer: Duration,
        mut read: impl FnMut(&Response) -> Option<T>,
    ) -> Result<T, Error> {
        let name = name(request);
        let Patience { answer, tries, .. } = self.patience;
        let mut once = |unit: &mut Self| {
            framed(name, unit.client.request(request))?;
            unit.exchange(name, answer + longer, tries, &mut read)
        };
        match once(self) {
            Err(Error::Refused {
                refusal: Refusal::Session,
                ..
            }) => {
                self.hello(answer, tries)?;
                if is_repeatable(request) {
                    once(self)
                } else {
                    Err(Error::SessionLost { request: name })
                }
            }
            other => other,
        }
    }

    /// Sends the client's frame until it is answered.
    fn exchange<T>(
        &mut self,
        request: &'static str,
        answer: Duration,
        tries: u32,
        mut read: impl FnMut(&Response) -> Option<T>,
    ) -> Result<T, Error> {
        let start = Instant::now();
        for _ in 0..tries {
            self.port
                .write_all(self.client.again())
                .and_then(|()| self.port.flush())
                .map_err(Error::Port)?;
            let deadline = Instant::now() + answer;
            while let Some(byte) = self.next_byte(deadline)? {
                match self.client.receive(byte) {
                    Some(Event::Answer(Response::Refused(refusal))) => {
                        return Err(Error::Refused { request, refusal });
                    }
                    Some(Event::Answer(response)) => {
                        return read(&response).ok_or_else(|| Error::Unexpected {
                            request,
                            found: format!("{response:?}"),
                        });
                    }
                    Some(Event::Telemetry(telemetry)) => keep(&mut self.telemetry, telemetry),
                    None => {}
                }
            }
        }
        Err(Error::NoAnswer {
            request,
            tries,
            waited: start.elapsed(),
        })
    }

    /// The next byte from the port; none if there is none in time.
    fn next_byte(&mut self, deadline: Instant) -> Result<Option<u8>, Error> {
        use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
        let mut block = [0; 4096];
        while self.received.is_empty() {
            // Also where bytes keep coming: they may be of a wrong baud rate.
            if Instant::now() >= deadline {
                return Ok(None);
            }
            match self.port.read(&mut block) {
                Ok(0) => return Err(Error::Closed),
                Ok(count) => self.received.extend(&block[..count]),
                Err(error) if matches!(error.kind(), TimedOut | WouldBlock | Interrupted) => {}
                Err(error) => return Err(Error::Port(error)),
            }
        }
        Ok(self.received.pop_front())
    }

    /// What the unit is.
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn identify(&mut self) -> Result<Identity, Error> {
        self.ask(&Request::Identify, |response| match *response {
            Response::Identity {
                serial,
                firmware,
                channels,
                axes,
                sample_rate_hz,
                samples_per_update,
                bank,
                spare,
                table_crc,
                sequence,
                scale_factor_arcsec,
                ref units,
                ref max_bias,
            } => Some(Identity {
                serial: serial.to_owned(),
                firmware: firmware.to_owned(),
                channels,
                axes,
                schedule: Schedule {
                    sample_rate_hz,
                    samples_per_update,
                },
                bank,
                spare,
                table_crc,
                sequence,
                scale_factor_arcsec,
                fits: {
                    let axes = units.iter().zip(max_bias);
                    let fit = |(code, max_bias): (&u8, &f32)| {
                        Some(Fit {
                            unit: AxisUnit::from_code(*code)?,
                            scale_factor_arcsec,
                            max_bias: *max_bias,
                        })
                    };
                    axes.map(fit).collect::<Option<_>>()?
                },
            }),
            _ => None,
        })
    }

    /// The state of the unit now. If the period is not 0, it is sent again every period
    /// \[ms\]: see [`wait_telemetry`](Self::wait_telemetry).
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn telemetry(&mut self, period_ms: u32) -> Result<Telemetry, Error> {
        self.ask(
            &Request::Telemetry { period_ms },
            |response| match response {
                Response::Telemetry(telemetry) => Some(telemetry.clone()),
                _ => None,
            },
        )
    }

    /// The oldest telemetry that came unasked and was not yet looked at; none if none comes
    /// within `timeout`.
    ///
    /// # Errors
    /// The port fails.
    pub fn wait_telemetry(&mut self, timeout: Duration) -> Result<Option<Telemetry>, Error> {
        let deadline = Instant::now() + timeout;
        while self.telemetry.is_empty() {
            let Some(byte) = self.next_byte(deadline)? else {
                return Ok(None);
            };
            if let Some(Event::Telemetry(telemetry)) = self.client.receive(byte) {
                keep(&mut self.telemetry, telemetry);
            }
        }
        Ok(self.telemetry.pop_front())
    }

    /// The faults that the built-in test finds.
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn built_in_test(&mut self) -> Result<FaultSet, Error> {
        self.ask(&Request::Bit, |response| match response {
            Response::Bit { faults } => Some(*faults),
            _ => None,
        })
    }

    /// The whole fault log, by code.
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn faults(&mut self) -> Result<Vec<FaultEntry>, Error> {
        let mut all: Vec<FaultEntry> = Vec::new();
        loop {
            let from_code = all.last().map_or(0, |last| last.code.saturating_add(1));
            let some = self.ask(&Request::Faults { from_code }, |response| match response {
                Response::Faults(faults) => Some(faults.clone()),
                _ => None,
            })?;
            all.extend_from_slice(&some);
            if some.len() < MAX_FAULTS {
                return Ok(all);
            }
        }
    }

    /// What the unit has lost since power-on.
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn losses(&mut self) -> Result<Losses, Error> {
        self.ask(&Request::Losses, |response| match response {
            Response::Losses(losses) => Some(*losses),
            _ => None,
        })
    }

    /// How often the flash of the unit was erased.
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn wear(&mut self) -> Result<Wear, Error> {
        self.ask(&Request::Wear, |response| match response {
            Response::Wear(wear) => Some(*wear),
            _ => None,
        })
    }

    /// Asks what is answered by [`Response::Done`] alone.
    ///
    /// # Errors
    /// As of [`ask`](Self::ask).
    pub fn command(&mut self, request: &Request) -> Result<(), Error> {
        self.ask(request, |response| {
            matches!(response, Response::Done).then_some(())
        })
    }
}

fn keep(telemetry: &mut VecDeque<Telemetry>, message: Telemetry) {
    if telemetry.len() == MOST_TELEMETRY {
        telemetry.pop_front();
    }
    telemetry.push_back(message);
}

fn framed(request: &'static str, frame: Result<&[u8], LinkError>) -> Result<(), Error> {
    let checked = frame.map(drop);
    checked.map_err(|cause| Error::Frame { request, cause })
}

/// Another number each time.
fn nonce() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    // The low bits, which change fastest, mixed with the process for programs started together.
    now.map_or(1, |now| now.as_nanos() as u32) ^ std::process::id().rotate_left(16)
}

/// Whether a request means the same in a new session as in the one before.
const fn is_repeatable(request: &Request) -> bool {
    matches!(
        request,
        Request::Identify
            | Request::Telemetry { .. }
            | Request::Bit
            | Request::Download { .. }
            | Request::Faults { .. }
            | Request::Restart
            | Request::Losses
            | Request::Wear
    )
}

/// The request in words, for messages.
const fn name(request: &Request) -> &'static str {
    match request {
        Request::Hello { .. } => "hello",
        Request::Identify => "the question what it is",
        Request::Telemetry { .. } => "the question how it is",
        Request::Sample(_) => "a sample of a log",
        Request::Bit => "its built-in test",
        Request::ReZero { .. } => "re-zero",
        Request::UploadBegin { .. } => "the beginning of an upload",
        Request::UploadChunk { .. } => "a chunk of an upload",
        Request::UploadCommit { .. } => "the end of an upload",
        Request::Activate(_) => "the use of a table",
        Request::Download { .. } => "a download",
        Request::Faults { .. } => "the question for its fault log",
        Request::Restart => "the start of a replay",
        Request::Block(_) => "a block of a log",
        Request::ClearOffsets => "the clearing of its offsets",
        Request::Losses => "the question what it has lost",
        Request::Wear => "the question how its flash is worn",
        _ => "a request",
    }
}
