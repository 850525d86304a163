//! The format to the byte, round trips of arbitrary bits, and what is refused.

use proptest::prelude::*;
use tempco_replay::{
    ChannelOutcome, Header, HeaderError, Kind, Outcome, Record, RecordError, Sample, decode_all,
};

#[test]
fn header_is_laid_out_as_documented() {
    assert_eq!(
        Header::samples::<2, 3>().encode(),
        *b"TCSAMPLE\x02\x00\x02\x03\0\0\0\0"
    );
    assert_eq!(
        Header::outcomes::<1, 3>(0x1234_5678).encode(),
        *b"TCOUTCOM\x02\x00\x01\x03\x78\x56\x34\x12"
    );
}

#[test]
fn sample_is_laid_out_as_documented() {
    let mut sample = Sample {
        update_s: Some(1.0),
        temps_c: [2.0, 3.0],
        raw: [[4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
    };
    let mut bytes = [0xaa; 41];
    sample.encode(&mut bytes).unwrap();
    assert_eq!(Sample::<2, 3>::LEN, 40);
    assert_eq!(bytes[..4], [1, 0, 0, 0]);
    for (word, expected) in bytes[4..].chunks_exact(4).zip(1_u8..) {
        assert_eq!(word, f32::from(expected).to_le_bytes());
    }
    assert_eq!(bytes[40], 0xaa, "the byte behind the record is not touched");
    // A row that is no update.
    sample.update_s = None;
    sample.encode(&mut bytes).unwrap();
    assert_eq!(bytes[..8], [0; 8]);
    assert_eq!(bytes[8..12], 2.0_f32.to_le_bytes());
    assert_eq!(Sample::decode(&bytes), Ok(sample));
}

#[test]
fn outcome_is_laid_out_as_documented() {
    let channel = |first: f32| ChannelOutcome {
        effective_c: first,
        rate_c_per_min: first + 1.0,
        status: 0x8000_0001,
        bias: [first + 3.0, first + 5.0],
        compensated: [first + 4.0, first + 6.0],
    };
    let outcome = Outcome {
        channels: [channel(0.0), channel(7.0)],
    };
    let mut bytes = [0; Outcome::<2, 2>::LEN];
    outcome.encode(&mut bytes).unwrap();
    assert_eq!(bytes.len(), 2 * 28);
    for (word, place) in bytes.chunks_exact(4).zip(0_u8..) {
        let expected = match place {
            2 | 9 => [0x01, 0, 0, 0x80],
            _ => f32::from(place).to_le_bytes(),
        };
        assert_eq!(word, expected, "word {place}");
    }
}

#[test]
fn foreign_headers_are_refused_with_the_reason() {
    let good = Header::samples::<1, 3>();
    let bytes = good.encode();
    for given in 0..Header::LEN {
        assert_eq!(
            Header::decode(&bytes[..given]),
            Err(HeaderError::Short { given })
        );
    }
    for place in 0..8 {
        let mut bytes = bytes;
        bytes[place] ^= 0x20;
        assert_eq!(Header::decode(&bytes), Err(HeaderError::Magic));
    }
    let mut newer = bytes;
    newer[8] = 3;
    assert_eq!(
        Header::decode(&newer),
        Err(HeaderError::Version { found: 3 })
    );

    let refused = |expected: Header| good.expect(&expected).unwrap_err();
    assert_eq!(good.expect(&good), Ok(()));
    assert_eq!(
        refused(Header::outcomes::<1, 3>(0)),
        HeaderError::Kind {
            found: Kind::Samples
        }
    );
    let shape = refused(Header::samples::<3, 1>());
    assert_eq!(
        shape.to_string(),
        "the records have 1 channel(s) of 3 axes, expected are 3 of 1"
    );
    assert!(matches!(
        refused(Header::samples::<1, 2>()),
        HeaderError::Shape {
            axes: 3,
            expected_axes: 2,
            ..
        }
    ));
    assert_eq!(
        Header::outcomes::<1, 3>(7)
            .expect(&Header::outcomes::<1, 3>(8))
            .unwrap_err(),
        HeaderError::Table {
            found: 7,
            expected: 8
        }
    );
}

/// Any bytes are records, and come back as they were; any shorter slice is refused.
fn round_trip<R: Record>(bytes: &[u8]) {
    let bytes = &bytes[..R::LEN];
    let record = R::decode(bytes).unwrap();
    let mut again = vec![0; R::LEN];
    record.encode(&mut again).unwrap();
    assert_eq!(again, bytes);
    for given in 0..R::LEN {
        let short = RecordError::Short {
            given,
            needed: R::LEN,
        };
        assert_eq!(R::decode(&bytes[..given]).err(), Some(short));
        let mut untouched = vec![0x55; given];
        assert_eq!(record.encode(&mut untouched), Err(short));
        assert_eq!(untouched, vec![0x55; given]);
    }
}

proptest! {
    #[test]
    fn records_of_arbitrary_bits_survive(bytes in proptest::collection::vec(any::<u8>(), 256)) {
        for head in [[1, 0, 0, 0, bytes[4], bytes[5], bytes[6], bytes[7]], [0; 8]] {
            let bytes = [&head, &bytes[8..]].concat();
            round_trip::<Sample<1, 1>>(&bytes);
            round_trip::<Sample<1, 3>>(&bytes);
            round_trip::<Sample<3, 1>>(&bytes);
            round_trip::<Sample<4, 5>>(&bytes);
        }
        round_trip::<Outcome<1, 1>>(&bytes);
        round_trip::<Outcome<1, 3>>(&bytes);
        round_trip::<Outcome<3, 1>>(&bytes);
        round_trip::<Outcome<4, 5>>(&bytes);
    }

    #[test]
    fn headers_survive_and_noise_does_not_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..40),
        crc in any::<u32>(), channels in any::<u8>(), axes in any::<u8>(),
    ) {
        let header = Header { kind: Kind::Outcomes, channels, axes, table_crc: crc };
        prop_assert_eq!(Header::decode(&header.encode()), Ok(header));
        prop_assert!(Header::decode(&bytes).is_err());
    }

    #[test]
    fn streams_are_read_whole_or_refused(length in 0_usize..200) {
        let bytes = vec![0; length];
        let needed = Sample::<1, 3>::LEN;
        match decode_all::<Sample<1, 3>>(&bytes) {
            Ok(records) => prop_assert_eq!((records.len(), records.count()), (length / needed, length / needed)),
            Err(error) => prop_assert_eq!(
                error,
                RecordError::Truncated { records: length / needed, given: length % needed, needed }
            ),
        }
        prop_assert_eq!(decode_all::<Sample<1, 3>>(&bytes).is_ok(), length % needed == 0);
    }
}
