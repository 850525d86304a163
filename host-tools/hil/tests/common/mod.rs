//! A unit of one temperature channel and three axes that lives in a thread, behind a socket.
#![allow(dead_code, reason = "each test program uses its share")]

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex};
use std::thread;

use tempco::{Schedule, Stream, Table, Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Axis, CRC, Channel, Fit, Image, Info, Unit, encode};
use tempco_link::{
    Bank, BlockCrc, ChannelTelemetry, FaultEntry, Handler, Losses, MAX_FAULTS, Outcome,
    OutcomeBlock, Refusal, Request, Response, Sample, SampleBlock, Server, Telemetry, Wear,
};
use tempco_replay::Replay;

pub(crate) const SCHEDULE: Schedule = Schedule {
    sample_rate_hz: 2000.0,
    samples_per_update: 200,
};

type Tables = [Table<'static, 3>; 1];

pub(crate) const FIT: Fit = Fit {
    unit: Unit::Dph,
    scale_factor_arcsec: 1.0,
    max_bias: 1000.0,
};

/// What the unit keeps when it is reset, and what a test may look at.
#[derive(Debug, Default)]
pub(crate) struct Flash {
    pub(crate) serial: String,
    pub(crate) banks: [Vec<u8>; 2],
    /// The bank to boot with.
    pub(crate) chosen: Option<usize>,
    pub(crate) boots: u32,
    /// Requests that were carried out.
    pub(crate) done: usize,
    /// Replayed rows that were thermal updates.
    pub(crate) updates: usize,
    /// Chunks after which the unit is reset without an answer.
    pub(crate) reset_after: Option<usize>,
    /// Is reset before it can answer that it will be.
    pub(crate) is_hasty: bool,
    /// Takes a table and does not use it.
    pub(crate) is_stubborn: bool,
    /// What a table must fit: deg/h of pulses of 1 arcsec where it is not set.
    pub(crate) fit: Option<Fit>,
    /// Why it does not take what was uploaded.
    pub(crate) refuses: Option<Refusal>,
    /// The number of a replayed sample, and which figure of its outcome has a bit turned over.
    pub(crate) spoil: Option<(usize, Figure)>,
}

/// A figure of an outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Figure {
    Effective,
    Rate,
    Status,
    Bias,
    Compensated,
}

/// What is lost with a reset.
struct Running {
    flash: Arc<Mutex<Flash>>,
    in_use: Option<usize>,
    tables: &'static Tables,
    table_crc: u32,
    replay: Replay<'static, 1, 3>,
    stream: Stream<'static, 1, 3>,
    upload: Vec<u8>,
    chunks: usize,
    answer: Vec<u8>,
    /// Samples since the start of the replay, and which outcome is to be spoiled.
    replayed: usize,
    spoil: Option<(usize, Figure)>,
    telemetry: Telemetry,
    period_ms: u32,
    serial: String,
    resets: Option<Reset>,
}

#[derive(Clone, Copy, PartialEq)]
enum Reset {
    AfterAnswer,
    AtOnce,
}

/// Tables live as long as a test.
fn boot(flash: &Arc<Mutex<Flash>>) -> Running {
    let mut kept = flash.lock().unwrap();
    kept.boots += 1;
    let image = kept.chosen.map(|bank| kept.banks[bank].clone());
    let image = image.unwrap_or_else(|| image_of(&kept.serial, 0, 0.0));
    let mut place = Box::new(AlignedBytes([0; 65_536]));
    place.0[..image.len()].copy_from_slice(&image);
    let image = Image::read(&Box::leak(place).0).unwrap();
    let tables: &Tables = Box::leak(Box::new(image.tables().unwrap()));
    Running {
        flash: flash.clone(),
        in_use: kept.chosen,
        tables,
        table_crc: image.info().table_crc,
        replay: Replay::new(tables),
        stream: Stream::new(tables, &SCHEDULE),
        upload: Vec::new(),
        chunks: 0,
        answer: Vec::new(),
        replayed: 0,
        spoil: None,
        telemetry: Telemetry::default(),
        period_ms: 0,
        serial: kept.serial.clone(),
        resets: None,
    }
}

impl Handler for Running {
    fn handle(&mut self, request: Request<'_>) -> Response<'_> {
        let flash = self.flash.clone();
        let mut flash = flash.lock().unwrap();
        flash.done += 1;
        let spare = 1 - self.in_use.unwrap_or(1);
        match request {
            Request::Losses => Response::Losses(Losses {
                missed_samples: 3,
                ..Losses::default()
            }),
            Request::Wear => Response::Wear(Wear {
                faults: 12,
                offsets: 4,
            }),
            Request::Identify => {
                let fit = flash.fit.unwrap_or(FIT);
                Response::Identity {
                    serial: &self.serial,
                    firmware: "simulated 1",
                    channels: 1,
                    axes: 3,
                    sample_rate_hz: SCHEDULE.sample_rate_hz,
                    samples_per_update: SCHEDULE.samples_per_update,
                    bank: self.in_use.map(|bank| [Bank::A, Bank::B][bank]),
                    spare: [Bank::A, Bank::B][spare],
                    table_crc: self.table_crc,
                    sequence: flash.boots,
                    scale_factor_arcsec: fit.scale_factor_arcsec,
                    units: [fit.unit.code(); 3].into_iter().collect(),
                    max_bias: [fit.max_bias; 3].into_iter().collect(),
                }
            }
            Request::Telemetry { period_ms } => {
                self.period_ms = period_ms;
                Response::Telemetry(self.telemetry.clone())
            }
            Request::UploadBegin { .. } => {
                self.upload.clear();
                Response::Expected { offset: 0 }
            }
            Request::UploadChunk { offset, bytes } => {
                let expected = self.upload.len() as u32;
                if offset != expected {
                    return Response::Refused(Refusal::Offset { expected });
                }
                self.upload.extend_from_slice(bytes);
                self.chunks += 1;
                if flash.reset_after == Some(self.chunks) {
                    flash.reset_after = None;
                    self.resets = Some(Reset::AtOnce);
                }
                Response::Expected {
                    offset: self.upload.len() as u32,
                }
            }
            Request::UploadCommit { len, crc } => {
                if len as usize != self.upload.len() || crc != CRC.checksum(&self.upload) {
                    return Response::Refused(Refusal::Image);
                }
                if let Some(refusal) = flash.refuses {
                    return Response::Refused(refusal);
                }
                flash.banks[spare].clone_from(&self.upload);
                Response::Done
            }
            Request::Activate(bank) => {
                let bank = usize::from(bank == Bank::B);
                if flash.banks[bank].is_empty() {
                    return Response::Refused(Refusal::Store);
                }
                if !flash.is_stubborn {
                    flash.chosen = Some(bank);
                }
                self.resets = Some(if flash.is_hasty {
                    Reset::AtOnce
                } else {
                    Reset::AfterAnswer
                });
                Response::Done
            }
            Request::Download { bank, offset, len } => {
                let image = &flash.banks[usize::from(bank == Bank::B)];
                let from = image.len().min(offset as usize);
                let to = image.len().min(from + usize::from(len));
                self.answer = image[from..to].to_vec();
                Response::Chunk {
                    offset,
                    bytes: &self.answer,
                }
            }
            Request::Restart => {
                self.replay = Replay::new(self.tables);
                self.stream = Stream::new(self.tables, &SCHEDULE);
                (self.replayed, self.spoil) = (0, flash.spoil);
                Response::Done
            }
            Request::Sample(sample) => {
                flash.updates += usize::from(sample.update_s.is_some());
                self.sample(&sample)
            }
            Request::Block(block) => self.block(&block),
            Request::Faults { from_code } => Response::Faults(
                (from_code..11)
                    .take(MAX_FAULTS)
                    .map(|code| FaultEntry {
                        code,
                        count: 3,
                        ..FaultEntry::default()
                    })
                    .collect(),
            ),
            _ => Response::Refused(Refusal::Unsupported),
        }
    }
}

impl Running {
    fn sample(&mut self, sample: &Sample) -> Response<'_> {
        let made = self.replay.step(&tempco_replay::Sample {
            update_s: sample.update_s,
            temps_c: sample.temps_c[..].try_into().unwrap(),
            raw: [sample.raw[..].try_into().unwrap()],
        });
        let made = self.spoilt(outcome(&made));
        Response::Outcome(made)
    }

    fn block(&mut self, block: &SampleBlock) -> Response<'_> {
        if let Ok(temps_c) = block.temps_c[..].try_into() {
            self.stream.temperatures(&temps_c);
        }
        self.answer.clear();
        let mut last = Outcome::default();
        let mut crc = BlockCrc::default();
        let values: Vec<f32> = block.values().unwrap().collect();
        for raw in values.as_chunks().0 {
            let made = outcome(&self.stream.sample(&[*raw]).into());
            last = self.spoilt(made);
            crc.add(last.channels[0].status.into(), &last.bias);
            for value in &last.compensated {
                self.answer.extend(value.to_le_bytes());
            }
            self.telemetry.samples += 1;
        }
        Response::Block(OutcomeBlock {
            channels: last.channels,
            bias: last.bias,
            compensated: &self.answer,
            crc: crc.finish(),
        })
    }
}

impl Running {
    fn spoilt(&mut self, mut made: Outcome) -> Outcome {
        let number = self.replayed;
        self.replayed += 1;
        let turn = |value: &mut f32| *value = f32::from_bits(value.to_bits() ^ 1);
        match self.spoil {
            Some((spoilt, figure)) if spoilt == number => match figure {
                Figure::Effective => turn(&mut made.channels[0].effective_c),
                Figure::Rate => turn(&mut made.channels[0].rate_c_per_min),
                Figure::Status => made.channels[0].status ^= 1,
                Figure::Bias => turn(&mut made.bias[1]),
                Figure::Compensated => turn(&mut made.compensated[2]),
            },
            _ => {}
        }
        made
    }
}

fn outcome(made: &tempco_replay::Outcome<1, 3>) -> Outcome {
    let [channel] = &made.channels;
    let telemetry = ChannelTelemetry {
        effective_c: channel.effective_c,
        rate_c_per_min: channel.rate_c_per_min,
        status: channel.status as u16,
    };
    Outcome {
        channels: std::iter::once(telemetry).collect(),
        bias: channel.bias.into_iter().collect(),
        compensated: channel.compensated.into_iter().collect(),
    }
}

/// A wire that loses, damages and doubles bytes.
pub(crate) struct Wire {
    /// Bytes between two mishaps on average; 0 for none.
    pub(crate) every: u32,
    random: u32,
}

impl Wire {
    pub(crate) const GOOD: Self = Self::new(0);

    pub(crate) const fn new(every: u32) -> Self {
        Self {
            every,
            random: 12_345,
        }
    }

    fn carry(&mut self, bytes: &[u8]) -> Vec<u8> {
        let carry = |byte: u8| {
            // Numerical Recipes' generator, which is good enough here.
            self.random = self
                .random
                .wrapping_mul(1_664_525)
                .wrapping_add(1_013_904_223);
            let random = self.random >> 8;
            match random.checked_rem(self.every) {
                Some(0) => {
                    [vec![], vec![byte ^ 8], vec![byte, byte]][random as usize / 7 % 3].clone()
                }
                _ => vec![byte],
            }
        };
        bytes.iter().copied().flat_map(carry).collect()
    }
}

/// Puts a unit at the other end of the socket, until that is closed.
pub(crate) fn serve(mut port: UnixStream, flash: Arc<Mutex<Flash>>, [mut to, mut from]: [Wire; 2]) {
    let mut unit = boot(&flash);
    let mut server = server(&flash);
    let mut block = [0; 1024];
    while let Ok(count @ 1..) = port.read(&mut block) {
        for byte in to.carry(&block[..count]) {
            let Some(answer) = server.receive(byte, &mut unit).map(<[u8]>::to_vec) else {
                continue;
            };
            if unit.resets != Some(Reset::AtOnce) {
                // The host may have gone.
                _ = port.write_all(&from.carry(&answer));
            }
            if unit.resets.is_some() {
                unit = boot(&flash);
                server = self::server(&flash);
            }
            if unit.period_ms > 0 {
                unit.telemetry.index += 1;
                let telemetry = server.telemetry(unit.telemetry.clone());
                _ = port.write_all(&from.carry(telemetry.unwrap_or_default()));
            }
        }
    }
}

fn server(flash: &Mutex<Flash>) -> Server {
    Server::new(flash.lock().unwrap().boots << 16)
}

/// A unit of a serial number in a thread; returns its socket and its flash.
pub(crate) fn spawn(serial: &str, wires: [Wire; 2]) -> (UnixStream, Arc<Mutex<Flash>>) {
    let (host, port) = UnixStream::pair().unwrap();
    let flash = Arc::new(Mutex::new(Flash {
        serial: serial.to_owned(),
        ..Flash::default()
    }));
    let kept = flash.clone();
    thread::spawn(move || serve(port, kept, wires));
    (host, flash)
}

/// An image of a table in deg/h, from pulses of 1 arcsec, whose biases are in proportion to `scale`.
pub(crate) fn image_of(serial: &str, table_crc: u32, scale: f32) -> Vec<u8> {
    image_in(Unit::Dph, 1.0, serial, table_crc, scale)
}

/// As [`image_of`], in another unit or from other pulses.
pub(crate) fn image_in(
    unit: Unit,
    scale_factor_arcsec: f32,
    serial: &str,
    table_crc: u32,
    scale: f32,
) -> Vec<u8> {
    let axis = Axis {
        scale_factor_arcsec,
        ..Axis::new(unit)
    };
    let terms = Terms::new(
        [scale, 0.3 * scale, -0.1 * scale],
        [0.2 * scale, 0.05 * scale],
    );
    let cells = [terms; 3 * 40];
    let channel = Channel {
        thermal: ThermalSettings::DEFAULT,
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -40.0,
        t_max_c: 80.0,
        period_s: 0.0,
        axes: Axis::array(&[axis; 3]),
        cells: &cells,
    };
    let info = Info {
        serial,
        table_crc,
        ..Info::default()
    };
    let mut place = Box::new(AlignedBytes([0; 65_536]));
    let len = encode(&info, &[channel], &mut place.0).unwrap();
    place.0[..len].to_vec()
}
