//! Each request is carried out once and in order, whatever the wire does.

mod common;

use common::{Unit, ask, connected, events, feed, hello, wire};
use proptest::collection::vec;
use proptest::prelude::*;
use tempco_image::CRC;
use tempco_link::{Axes, Bank, Client, MAX_CHUNK, Request, Server, Telemetry};

#[test]
fn a_session_from_hello_to_commit() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let mut client = connected(&mut server, &mut unit, 5);
    let image: Vec<u8> = (0..1000_u32).map(|i| (i % 251) as u8).collect();
    let mut say = |request: &Request| ask(&mut client, &mut server, &mut unit, request);
    assert_eq!(
        say(&Request::UploadBegin { len: 1000 }),
        "Expected { offset: 0 }"
    );
    for (number, bytes) in image.chunks(MAX_CHUNK).enumerate() {
        let offset = (number * MAX_CHUNK) as u32;
        let end = offset as usize + bytes.len();
        let answer = say(&Request::UploadChunk { offset, bytes });
        assert_eq!(answer, format!("Expected {{ offset: {end} }}"));
    }
    let crc = CRC.checksum(&image);
    let commit = |crc| Request::UploadCommit { len: 1000, crc };
    assert_eq!(say(&commit(crc ^ 1)), "Refused(Image)");
    assert_eq!(say(&commit(crc)), "Done");
    let download = say(&Request::Download {
        bank: Bank::A,
        offset: 998,
        len: 256,
    });
    assert_eq!(download, "Chunk { offset: 998, bytes: [245, 246] }");
    assert_eq!(unit.committed, image);
}

#[test]
fn an_answer_that_was_lost_is_repeated_and_nothing_carried_out_twice() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let mut client = connected(&mut server, &mut unit, 5);
    let request = client
        .request(&Request::ReZero {
            averaging_s: 60,
            expected: Axes::new(),
        })
        .unwrap()
        .to_vec();
    let first = feed(&mut server, &mut unit, &request);
    let again = client.again().to_vec();
    assert_eq!(again, request);
    assert_eq!(feed(&mut server, &mut unit, &again), first);
    assert_eq!(unit.done.len(), 1);
    let both = [first.concat(), first.concat()].concat();
    assert_eq!(
        events(&mut client, &both),
        ["Done"],
        "the second is passed over"
    );
}

#[test]
fn other_versions_sessions_and_orders_are_refused() {
    let (mut server, mut unit) = (Server::new(7), Unit::default());
    let mut refused = |bytes: &[u8]| {
        let mut text = Vec::new();
        for answer in feed(&mut server, &mut unit, bytes) {
            let mut decoder = tempco_link::Decoder::new();
            for byte in answer {
                if let Some(plain) = decoder.push(byte) {
                    text.push(plain.to_vec());
                }
            }
        }
        text
    };
    // Session and sequence as varints, 1 for `Refused`, then which.
    let other_major = Request::Hello {
        major: 1,
        minor: 0,
        nonce: 1,
    };
    // Another major version gets this one, and no session.
    let told = [0, 1, 0, 2, 0, 1, 0];
    assert_eq!(refused(&wire(0, 1, &other_major)), [told.to_vec()]);
    assert_eq!(refused(&wire(7, 2, &Request::Bit)), [vec![7, 2, 1, 1]]);
    // A newer minor version is welcome: 0 for `Hello`, version, nonce, session.
    let newer = Request::Hello {
        major: 2,
        minor: 9,
        nonce: 4,
    };
    assert_eq!(refused(&wire(0, 1, &newer)), [vec![0, 1, 0, 2, 0, 4, 7]]);
    assert_eq!(refused(&wire(8, 2, &Request::Bit)), [vec![8, 2, 1, 1]]);
    assert_eq!(refused(&wire(7, 4, &Request::Bit)), [vec![7, 4, 1, 2, 2]]);
    assert_eq!(refused(&wire(7, 0, &Request::Bit)), [[0; 0]; 0]);
    assert_eq!(refused(&wire(7, 2, &Request::Bit)), [vec![7, 2, 2]]);
    assert_eq!(refused(&wire(7, 3, &Request::Bit)), [vec![7, 3, 2]]);
    // Answered long ago: nothing is said, so that no answer comes twice.
    assert_eq!(refused(&wire(7, 2, &Request::Bit)), [[0; 0]; 0]);
    assert_eq!(unit.done, ["Bit", "Bit"]);
}

/// A request of a newer minor version, and one with a byte too many.
#[test]
fn what_is_not_known_is_refused_and_not_carried_out() {
    for message in [&[7, 2, 99, 1, 2][..], &[7, 2, 4, 0]] {
        let (mut server, mut unit) = (Server::new(7), Unit::default());
        let mut client = connected(&mut server, &mut unit, 1);
        client.request(&Request::Bit).unwrap();
        let crc = CRC.checksum(message).to_le_bytes();
        let mut stuffed = [0; 64];
        let plain = [message, &crc].concat();
        let len = cobs::try_encode_including_sentinels(&plain, &mut stuffed).unwrap();
        let answers = feed(&mut server, &mut unit, &stuffed[..len]);
        assert_eq!(events(&mut client, &answers.concat()), ["Refused(Unknown)"]);
        assert!(unit.done.is_empty());
    }
}

/// The whole of an earlier session comes again, hello and all.
#[test]
fn a_replayed_session_carries_nothing_out() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let mut client = Client::new();
    let mut recorded = client.hello(5).unwrap().to_vec();
    let answers = feed(&mut server, &mut unit, &recorded).concat();
    events(&mut client, &answers);
    for request in [
        Request::Activate(Bank::B),
        Request::ReZero {
            averaging_s: 1,
            expected: Axes::new(),
        },
        Request::UploadBegin { len: 64 },
    ] {
        recorded.extend_from_slice(client.request(&request).unwrap());
    }
    feed(&mut server, &mut unit, &recorded);
    assert_eq!(unit.done.len(), 3);
    // At once, and after another session; and by a server that was restarted.
    feed(&mut server, &mut unit, &recorded);
    let mut second = connected(&mut server, &mut unit, 6);
    feed(&mut server, &mut unit, &recorded);
    assert_eq!(unit.done.len(), 3);
    feed(&mut Server::new(65_536), &mut unit, &recorded);
    assert_eq!(unit.done.len(), 3);
    // The host learns of it and begins again.
    let answer = ask(&mut second, &mut server, &mut unit, &Request::Bit);
    assert_eq!(answer, "Refused(Session)");
    let mut third = connected(&mut server, &mut unit, 7);
    assert_eq!(
        ask(&mut third, &mut server, &mut unit, &Request::Bit),
        "Done"
    );
}

#[test]
fn the_answer_to_an_earlier_hello_opens_nothing() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let mut client = Client::new();
    let hello = client.hello(5).unwrap().to_vec();
    let late = feed(&mut server, &mut unit, &hello).concat();
    let hello = client.hello(6).unwrap().to_vec();
    assert!(events(&mut client, &late).is_empty());
    let answer = feed(&mut server, &mut unit, &hello).concat();
    assert_eq!(events(&mut client, &answer).len(), 1);
    assert_eq!(
        ask(&mut client, &mut server, &mut unit, &Request::Bit),
        "Done"
    );
}

#[test]
fn telemetry_comes_between_answers_and_only_within_a_session() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let telemetry = |index| Telemetry {
        index,
        ..Telemetry::default()
    };
    assert_eq!(server.telemetry(telemetry(0)), None);
    let mut client = connected(&mut server, &mut unit, 5);
    let frame = server.telemetry(telemetry(1)).unwrap().to_vec();
    let request = client.request(&Request::Bit).unwrap().to_vec();
    let answer = feed(&mut server, &mut unit, &request).concat();
    let wire = [&frame[..], &answer, &frame].concat();
    assert_eq!(
        events(&mut client, &wire),
        ["telemetry 1", "Done", "telemetry 1"]
    );
    client.hello(6).unwrap();
    assert!(
        events(&mut client, &frame).is_empty(),
        "of the session before"
    );
}

#[test]
fn sequence_numbers_wrap() {
    let (mut server, mut unit) = (Server::new(1), Unit::default());
    let mut client = connected(&mut server, &mut unit, 5);
    for number in 0..70_000_u32 {
        let request = Request::Telemetry { period_ms: number };
        let wire = client.request(&request).unwrap().to_vec();
        let answers = feed(&mut server, &mut unit, &wire).concat();
        assert_eq!(events(&mut client, &answers), ["Done"], "{number}");
    }
    assert_eq!(unit.done.len(), 70_000);
}

/// What a wire may do to a frame.
#[derive(Clone, Debug)]
enum Mishap {
    None,
    Lost,
    Cut(usize),
    Flipped(usize),
    Twice,
    /// An earlier frame comes once more.
    Replayed(usize),
    /// Held back until after the next one.
    Late,
    Garbage(Vec<u8>),
}

fn mishap() -> impl Strategy<Value = Mishap> {
    prop_oneof![
        4 => Just(Mishap::None),
        1 => Just(Mishap::Lost),
        1 => any::<usize>().prop_map(Mishap::Cut),
        1 => any::<usize>().prop_map(Mishap::Flipped),
        1 => Just(Mishap::Twice),
        1 => any::<usize>().prop_map(Mishap::Replayed),
        1 => Just(Mishap::Late),
        1 => vec(any::<u8>(), 0..400).prop_map(Mishap::Garbage),
    ]
}

/// One direction of a wire with mishaps.
struct Wire {
    mishaps: Vec<Mishap>,
    sent: Vec<Vec<u8>>,
    held: Vec<u8>,
}

impl Wire {
    fn new(mishaps: Vec<Mishap>) -> Self {
        Self {
            mishaps,
            sent: Vec::new(),
            held: Vec::new(),
        }
    }

    /// What arrives when a frame is sent.
    fn send(&mut self, frame: &[u8]) -> Vec<u8> {
        let mut bytes = std::mem::take(&mut self.held);
        self.sent.push(frame.to_vec());
        match self.mishaps.pop().unwrap_or(Mishap::None) {
            Mishap::None => bytes = [frame, &bytes].concat(),
            Mishap::Lost => {}
            Mishap::Cut(at) => bytes.extend_from_slice(&frame[..at % frame.len()]),
            Mishap::Flipped(bit) => {
                let mut flipped = frame.to_vec();
                let bit = bit % (8 * frame.len());
                flipped[bit / 8] ^= 1 << (bit % 8);
                bytes.extend(flipped);
            }
            Mishap::Twice => bytes.extend([frame, frame].concat()),
            Mishap::Replayed(which) => {
                let earlier = &self.sent[which % self.sent.len()];
                bytes.extend([earlier.as_slice(), frame].concat());
            }
            Mishap::Late => self.held = frame.to_vec(),
            Mishap::Garbage(garbage) => bytes.extend([&garbage[..], frame].concat()),
        }
        bytes
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// An upload with commands in between, over a wire with mishaps both ways, by a host that asks
    /// again until it is answered: everything is carried out exactly once and in order.
    #[test]
    fn everything_is_carried_out_once_and_in_order(
        there in vec(mishap(), 0..60),
        back in vec(mishap(), 0..60),
        image in vec(any::<u8>(), 1..1500),
    ) {
        let (mut server, mut unit) = (Server::new(1), Unit::default());
        let (mut there, mut back) = (Wire::new(there), Wire::new(back));
        let mut client = Client::new();
        let mut requests = vec![Request::UploadBegin { len: image.len() as u32 }];
        for (number, bytes) in image.chunks(MAX_CHUNK).enumerate() {
            let offset = (number * MAX_CHUNK) as u32;
            requests.push(Request::UploadChunk { offset, bytes });
            requests.push(Request::ReZero { averaging_s: number as u16, expected: Axes::new() });
        }
        let crc = CRC.checksum(&image);
        requests.push(Request::UploadCommit { len: image.len() as u32, crc });

        let mut expected = Vec::new();
        let hello = hello(9);
        for request in std::iter::once(&hello).chain(&requests) {
            if let Request::Hello { nonce, .. } = request {
                client.hello(*nonce).unwrap();
            } else {
                client.request(request).unwrap();
                expected.push(format!("{request:?}"));
            }
            let mut tries = 0;
            loop {
                let arrived = there.send(client.again());
                let mut answers = Vec::new();
                for answer in feed(&mut server, &mut unit, &arrived) {
                    answers.extend(back.send(&answer));
                }
                let seen = events(&mut client, &answers);
                if let Some(answer) = seen.first() {
                    prop_assert!(!answer.starts_with("Refused"), "{answer} to {request:?}");
                    break;
                }
                tries += 1;
                prop_assert!(tries < 200, "no answer to {:?}", request);
            }
        }
        prop_assert_eq!(&unit.done, &expected);
        prop_assert_eq!(&unit.committed, &image);
    }
}
