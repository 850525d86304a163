//! Frames: what is sent arrives, what is damaged does not, and garbage only costs itself.

mod common;

use common::{Unit, ask, connected, feed, wire};
use proptest::collection::vec;
use proptest::prelude::*;
use tempco::MAX_AXES;
use tempco_image::CRC;
use tempco_link::{
    Axes, Bank, ChannelTelemetry, Decoder, FaultEntry, FaultSet, Frame, LinkError, Losses,
    MAX_BLOCK, MAX_CHUNK, MAX_FAULTS, MAX_FRAME, MAX_MESSAGE, Outcome, OutcomeBlock, Refusal,
    Request, Response, Sample, SampleBlock, Server, Telemetry, Wear,
};

fn filled<T: Clone, const N: usize>(value: &T) -> heapless::Vec<T, N> {
    let mut all = heapless::Vec::new();
    while all.push(value.clone()).is_ok() {}
    all
}

fn largest_outcome() -> Outcome {
    let channel = ChannelTelemetry {
        effective_c: f32::MAX,
        rate_c_per_min: f32::MAX,
        status: u16::MAX,
    };
    Outcome {
        channels: filled(&channel),
        bias: filled(&f32::MAX),
        compensated: filled(&f32::MAX),
    }
}

fn fits(message: impl serde::Serialize) {
    let frame = Frame {
        session: u32::MAX,
        sequence: u16::MAX,
        message,
    };
    frame.encode(&mut [0; MAX_FRAME]).unwrap();
}

#[test]
fn the_longest_messages_fit_and_longer_ones_are_refused() {
    let bytes = [0xff; MAX_CHUNK];
    fits(Request::UploadChunk {
        offset: u32::MAX,
        bytes: &bytes,
    });
    fits(Response::Chunk {
        offset: u32::MAX,
        bytes: &bytes,
    });
    fits(Request::Sample(Sample {
        update_s: Some(f32::MAX),
        temps_c: filled(&f32::MAX),
        raw: filled(&f32::MAX),
    }));
    fits(Response::Outcome(largest_outcome()));
    fits(Response::Telemetry(Telemetry {
        index: u32::MAX,
        uptime_ms: u32::MAX,
        temps_c: filled(&f32::MAX),
        raw: filled(&f32::MAX),
        outcome: largest_outcome(),
        samples: u32::MAX,
        rejected: u32::MAX,
        overruns: u32::MAX,
        dropped_frames: u32::MAX,
        offset: filled(&f32::MAX),
        faults: FaultSet(u32::MAX),
        load_permille: u16::MAX,
        latency_ns: u32::MAX,
    }));
    let block = [0xff; MAX_BLOCK];
    fits(Request::Block(SampleBlock {
        temps_c: filled(&f32::MAX),
        real_time: true,
        scale: Some(f32::MAX),
        raw: &block,
    }));
    let outcome = largest_outcome();
    fits(Response::Block(OutcomeBlock {
        channels: outcome.channels,
        bias: outcome.bias,
        compensated: &block,
        crc: u32::MAX,
    }));
    let fault = FaultEntry {
        code: u16::MAX,
        count: u32::MAX,
        boot: u32::MAX,
        uptime_s: u32::MAX,
        detail: u32::MAX,
    };
    fits(Response::Faults(filled::<_, MAX_FAULTS>(&fault)));
    let name = "x".repeat(100);
    fits(Response::Identity {
        serial: &name,
        firmware: &name,
        channels: 255,
        axes: 255,
        sample_rate_hz: f32::MAX,
        samples_per_update: u16::MAX,
        bank: Some(Bank::B),
        spare: Bank::A,
        table_crc: u32::MAX,
        sequence: u32::MAX,
        scale_factor_arcsec: f32::MAX,
        units: filled(&u8::MAX),
        max_bias: filled(&f32::MAX),
    });
    let long = Frame {
        session: u32::MAX,
        sequence: u16::MAX,
        message: Request::UploadChunk {
            offset: u32::MAX,
            bytes: &[0; MAX_MESSAGE],
        },
    };
    assert_eq!(long.encode(&mut [0; MAX_FRAME]), Err(LinkError::Long));
}

/// The bytes of frames that were once sent must mean the same for ever.
#[test]
fn the_encoding_does_not_change() {
    let hello = Request::Hello {
        major: 1,
        minor: 0,
        nonce: 0x0102,
    };
    assert_eq!(
        wire(0, 1, &hello),
        [0, 1, 2, 1, 2, 1, 7, 130, 2, 236, 92, 68, 144, 0]
    );
    for (number, request) in [
        (1, Request::Identify),
        (2, Request::Telemetry { period_ms: 0 }),
        (3, Request::Sample(Sample::default())),
        (4, Request::Bit),
        (
            5,
            Request::ReZero {
                averaging_s: 0,
                expected: Axes::new(),
            },
        ),
        (6, Request::UploadBegin { len: 0 }),
        (
            7,
            Request::UploadChunk {
                offset: 0,
                bytes: &[],
            },
        ),
        (8, Request::UploadCommit { len: 0, crc: 0 }),
        (9, Request::Activate(Bank::A)),
        (
            10,
            Request::Download {
                bank: Bank::A,
                offset: 0,
                len: 0,
            },
        ),
        (11, Request::Faults { from_code: 0 }),
        (12, Request::Restart),
        (
            13,
            Request::Block(SampleBlock {
                temps_c: Default::default(),
                real_time: false,
                scale: None,
                raw: &[],
            }),
        ),
        (14, Request::ClearOffsets),
        (15, Request::Losses),
        (16, Request::Wear),
    ] {
        assert_eq!(plain(&wire(9, 1, &request)).unwrap()[..3], [9, 1, number]);
    }
    for (number, response) in [
        (
            0,
            Response::Hello {
                major: 0,
                minor: 0,
                nonce: 0,
                session: 0,
            },
        ),
        (1, Response::Refused(Refusal::Version)),
        (2, Response::Done),
        (4, Response::Telemetry(Telemetry::default())),
        (5, Response::Outcome(Outcome::default())),
        (
            6,
            Response::Bit {
                faults: FaultSet::NONE,
            },
        ),
        (7, Response::Expected { offset: 0 }),
        (
            8,
            Response::Chunk {
                offset: 0,
                bytes: &[],
            },
        ),
        (9, Response::Faults(heapless::Vec::new())),
        (
            10,
            Response::Block(OutcomeBlock {
                channels: Default::default(),
                bias: Axes::new(),
                compensated: &[],
                crc: 0,
            }),
        ),
        (11, Response::Losses(Losses::default())),
        (12, Response::Wear(Wear::default())),
    ] {
        let frame = Frame {
            session: 9,
            sequence: 1,
            message: response,
        };
        let mut bytes = [0; MAX_FRAME];
        let len = frame.encode(&mut bytes).unwrap();
        assert_eq!(plain(&bytes[..len]).unwrap()[..3], [9, 1, number]);
    }
    for (number, refusal) in [
        (0, Refusal::Version),
        (7, Refusal::Image),
        (8, Refusal::Store),
        (9, Refusal::Unit { axis: 0 }),
        (10, Refusal::ScaleFactor { axis: 0 }),
        (11, Refusal::Bias { axis: 0 }),
    ] {
        let frame = Frame {
            session: 9,
            sequence: 1,
            message: Response::Refused(refusal),
        };
        let mut bytes = [0; MAX_FRAME];
        let len = frame.encode(&mut bytes).unwrap();
        assert_eq!(plain(&bytes[..len]).unwrap()[..4], [9, 1, 1, number]);
    }
}

fn plain(wire: &[u8]) -> Option<Vec<u8>> {
    let mut decoder = Decoder::new();
    let mut found = None;
    for byte in wire {
        found = found.or(decoder.push(*byte).map(<[u8]>::to_vec));
    }
    found
}

#[test]
fn every_damaged_bit_and_pair_of_bits_is_found() {
    let good = wire(300, 77, &Request::UploadCommit { len: 2420, crc: 1 });
    let expected = plain(&good).unwrap();
    for first in 8..8 * (good.len() - 1) {
        for second in 8..=first {
            let mut damaged = good.clone();
            for bit in [first, second] {
                damaged[bit / 8] ^= 1 << (bit % 8);
            }
            let found = plain(&damaged);
            if first == second {
                assert_eq!(found.as_ref(), Some(&expected));
            } else {
                assert_eq!(found, None, "bits {first} {second}");
            }
            damaged[second / 8] ^= 1 << (second % 8);
            assert!(first == second || plain(&damaged).is_none(), "bit {first}");
        }
    }
    for len in 0..good.len() - 1 {
        assert_eq!(plain(&good[..len]), None, "{len} bytes");
    }
}

/// A frame that is too long is not taken for what it begins with, though its CRC be right.
#[test]
fn long_frames_are_dropped_whole() {
    let message = [7; MAX_MESSAGE];
    let good = [&message[..], &CRC.checksum(&message).to_le_bytes()].concat();
    for (more, taken) in [(0, true), (1, false), (300, false)] {
        let plain = [&good[..], &vec![1; more]].concat();
        let mut stuffed = [0; 2 * MAX_FRAME];
        let len = cobs::try_encode_including_sentinels(&plain, &mut stuffed).unwrap();
        let mut decoder = Decoder::new();
        let mut frames = 0;
        for byte in &stuffed[..len] {
            frames += usize::from(decoder.push(*byte).is_some());
        }
        assert_eq!(frames == 1, taken, "{more} more");
        assert_eq!(decoder.counters().long == 1, !taken, "{more} more");
    }
}

/// SplitMix64.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Ten million bytes: random, with few or many zeros, with pieces of good frames. Nothing is
/// carried out, and right after them the session goes on.
#[test]
fn ten_million_bytes_of_garbage_do_nothing() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let mut client = connected(&mut server, &mut unit, 5);
    let piece = wire(1, 2, &Request::Activate(Bank::B));
    let mut state = 1;
    let mut bytes = 0;
    while bytes < 10_000_000 {
        let kind = random(&mut state) % 4;
        let mut garbage: Vec<u8> = (0..1024)
            .flat_map(|_| random(&mut state).to_le_bytes())
            .map(|byte| match kind {
                0 => byte,
                1 => byte.saturating_sub(64),
                2 => byte % 4,
                _ => byte | 1,
            })
            .collect();
        if kind == 0 {
            // Good but for one byte.
            for place in garbage.chunks_exact_mut(64) {
                let changed = random(&mut state) as usize % (piece.len() - 2) + 1;
                let offset = place[0] as usize % 32;
                let place = &mut place[offset..offset + piece.len()];
                place.copy_from_slice(&piece);
                place[changed] ^= 1 + (state % 255) as u8;
            }
        }
        bytes += garbage.len();
        let answers = feed(&mut server, &mut unit, &garbage);
        assert!(answers.is_empty() && unit.done.is_empty());
    }
    assert_eq!(server.counters().good, 1);
    assert!(server.counters().damaged > 100_000);
    assert!(server.counters().long > 200);
    let answer = ask(&mut client, &mut server, &mut unit, &Request::Bit);
    assert_eq!(answer, "Done");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Every bit pattern of an f32 arrives as it was sent, NaN included.
    #[test]
    fn samples_and_outcomes_arrive_to_the_bit(
        numbers in vec(any::<u32>(), 4 * MAX_AXES),
        channels in 1..=MAX_AXES,
        session in any::<u32>(),
        sequence in any::<u16>(),
    ) {
        let number = |i: usize| f32::from_bits(numbers[i]);
        let all: Axes = (0..MAX_AXES).map(number).collect();
        let outcome = Outcome {
            channels: (0..channels).map(|i| ChannelTelemetry {
                effective_c: number(MAX_AXES + i),
                rate_c_per_min: number(2 * MAX_AXES + i),
                status: numbers[i] as u16,
            }).collect(),
            bias: all.clone(),
            compensated: all.iter().rev().copied().collect(),
        };
        let frame = Frame { session, sequence, message: Response::Outcome(outcome) };
        let mut bytes = [0; MAX_FRAME];
        let len = frame.encode(&mut bytes).unwrap();
        let plain = plain(&bytes[..len]).unwrap();
        let back: Frame<Response> = postcard::from_bytes(&plain).unwrap();
        let text = |frame: &Frame<Response>| {
            let Response::Outcome(outcome) = &frame.message else { panic!() };
            let channels = outcome.channels.iter().flat_map(|c| [c.effective_c, c.rate_c_per_min, f32::from(c.status)]);
            channels.chain(outcome.bias.iter().copied()).chain(outcome.compensated.iter().copied()).map(f32::to_bits).collect::<Vec<_>>()
        };
        prop_assert_eq!(text(&back), text(&frame));
        prop_assert_eq!((back.session, back.sequence), (session, sequence));
    }

    /// A good frame after any garbage is taken, unless the garbage cuts into it.
    #[test]
    fn a_frame_after_garbage_is_taken(garbage in vec(any::<u8>(), 0..1000), chunk in vec(any::<u8>(), 0..=MAX_CHUNK)) {
        let request = Request::UploadChunk { offset: 5, bytes: &chunk };
        let frame = wire(1, 1, &request);
        let found = [&garbage[..], &frame].concat();
        let mut decoder = Decoder::new();
        let last = found.iter().filter_map(|byte| decoder.push(*byte).map(<[u8]>::to_vec)).last();
        let last = last.expect("the frame");
        let back: Frame<Request> = postcard::from_bytes(&last).unwrap();
        prop_assert_eq!(back.message, request);
    }
}
