//! The link, both of its sides.

use core::hint::black_box;

use heapless::Vec;
use tempco::MAX_AXES;
use tempco_link::{
    Axes, Bank, BlockCrc, ChannelTelemetry, Client, Event, Fault, FaultEntry, Handler, LinkError,
    MAX_BLOCK, MAX_CHUNK, MAX_FAULTS, MAX_FRAME, Outcome, OutcomeBlock, Refusal, Request, Response,
    Sample, SampleBlock, Server, Telemetry,
};

/// Says hello, asks everything there is to ask and takes the answers.
///
/// # Errors
/// None, unless something is broken.
#[inline(never)]
pub fn links() -> Result<(), LinkError> {
    let mut ends = Ends {
        client: Client::new(),
        server: Server::new(black_box(65_536)),
        unit: Unit {
            bytes: [0x5a; MAX_BLOCK],
        },
    };
    let hello = copy(ends.client.hello(black_box(1))?);
    ends.exchange(&hello)?;
    let bytes = [0x5a; MAX_BLOCK];
    let chunk = bytes.get(..MAX_CHUNK).unwrap_or_default();
    for request in [
        Request::Identify,
        Request::Telemetry { period_ms: 1000 },
        Request::Sample(Sample {
            update_s: Some(0.1),
            temps_c: all(25.0),
            raw: all(0.5),
        }),
        Request::Bit,
        Request::ReZero {
            averaging_s: 60,
            expected: Axes::new(),
        },
        Request::UploadBegin { len: 256 },
        Request::UploadChunk {
            offset: 0,
            bytes: chunk,
        },
        Request::UploadCommit { len: 256, crc: 0 },
        Request::Activate(Bank::B),
        Request::Download {
            bank: Bank::A,
            offset: 0,
            len: 256,
        },
        Request::Faults { from_code: 0 },
        Request::Restart,
        Request::Block(SampleBlock {
            temps_c: all(25.0),
            real_time: true,
            scale: None,
            raw: &bytes,
        }),
    ] {
        let wire = copy(ends.client.request(&black_box(request))?);
        ends.exchange(&wire)?;
    }
    _ = black_box(ends.server.telemetry(telemetry()));
    _ = black_box((ends.client.counters(), ends.server.counters()));
    Ok(())
}

/// A frame; the zeros behind it say nothing.
fn copy(frame: &[u8]) -> [u8; MAX_FRAME] {
    let mut wire = [0; MAX_FRAME];
    for (place, byte) in wire.iter_mut().zip(frame) {
        *place = *byte;
    }
    wire
}

struct Ends {
    client: Client,
    server: Server,
    unit: Unit,
}

impl Ends {
    /// Sends a frame to the server and its answer to the client.
    #[inline(never)]
    fn exchange(&mut self, wire: &[u8; MAX_FRAME]) -> Result<(), LinkError> {
        let mut answered = false;
        for byte in black_box(wire) {
            let answer = self.server.receive(*byte, &mut self.unit);
            for byte in answer.unwrap_or_default() {
                let event = self.client.receive(black_box(*byte));
                answered |= matches!(black_box(event), Some(Event::Answer(_)));
            }
        }
        if answered {
            Ok(())
        } else {
            Err(LinkError::Message)
        }
    }
}

/// Answers each request with another response, as long as it may be.
struct Unit {
    bytes: [u8; MAX_BLOCK],
}

impl Handler for Unit {
    fn handle(&mut self, request: Request<'_>) -> Response<'_> {
        match black_box(request) {
            Request::Identify => Response::Identity {
                serial: "SN7",
                firmware: "guard",
                channels: 1,
                axes: 3,
                sample_rate_hz: 1000.0,
                samples_per_update: 100,
                bank: Some(Bank::A),
                spare: Bank::B,
                table_crc: 7,
                sequence: 1,
                scale_factor_arcsec: 1.0,
                units: all(4),
                max_bias: all(1000.0),
            },
            Request::Telemetry { .. } => Response::Telemetry(telemetry()),
            Request::Sample(sample) => Response::Outcome(outcome(sample)),
            Request::Bit => Response::Bit {
                faults: Fault::ALL.into_iter().collect(),
            },
            Request::Activate(_) => Response::Refused(Refusal::Store),
            Request::UploadBegin { .. } => Response::Expected { offset: 0 },
            Request::UploadChunk { offset, bytes } => Response::Expected {
                offset: offset.wrapping_add(bytes.len() as u32),
            },
            Request::UploadCommit { .. } => Response::Refused(Refusal::Image),
            Request::Download { offset, len, .. } => Response::Chunk {
                offset,
                bytes: self.bytes.get(..len.into()).unwrap_or_default(),
            },
            Request::Faults { .. } => Response::Faults(all::<_, MAX_FAULTS>(FaultEntry::default())),
            Request::Block(block) => {
                for (place, byte) in self.bytes.iter_mut().zip(block.raw) {
                    *place = *byte;
                }
                let mut crc = BlockCrc::default();
                crc.add(black_box(1), black_box(&[0.5; MAX_AXES]));
                Response::Block(OutcomeBlock {
                    channels: all(ChannelTelemetry::default()),
                    bias: all(0.5),
                    compensated: &self.bytes,
                    crc: crc.finish(),
                })
            }
            _ => Response::Done,
        }
    }
}

fn outcome(sample: Sample) -> Outcome {
    Outcome {
        channels: all(ChannelTelemetry::default()),
        bias: sample.raw.clone(),
        compensated: sample.raw,
    }
}

fn telemetry() -> Telemetry {
    Telemetry {
        temps_c: all(25.0),
        raw: all(0.5),
        offset: all::<_, MAX_AXES>(0.5),
        ..Telemetry::default()
    }
}

/// As many as there may be.
fn all<T: Clone, const N: usize>(value: T) -> Vec<T, N> {
    let mut all = Vec::new();
    while all.push(value.clone()).is_ok() {}
    all
}
