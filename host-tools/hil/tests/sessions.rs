//! Sessions with a unit in this process, over good wires and bad ones.
#![cfg(unix)]

mod common;

use std::io::{Read, Write};
use std::path::Path;
use std::time::Duration;

use common::{Figure, SCHEDULE, Wire, image_in, image_of, spawn};
use tempco_hil::{Error, Patience, Unit, download, flash_set, open, replay};
use tempco_image::{AlignedBytes, Fit, Image};
use tempco_link::{Bank, Decoder, Frame, MAX_FRAME, Refusal, Request, Response};
use tempco_replay::Sample;

const GOOD: [Wire; 2] = [Wire::GOOD, Wire::GOOD];
/// A mishap in every third frame or so.
fn bad() -> [Wire; 2] {
    [Wire::new(900), Wire::new(1000)]
}

const IMPATIENT: Patience = Patience {
    answer: Duration::from_millis(60),
    tries: 20,
    boot: Duration::from_secs(5),
};

fn connect(port: std::os::unix::net::UnixStream) -> Unit {
    port.set_read_timeout(Some(Duration::from_millis(5)))
        .unwrap();
    Unit::connect(Box::new(port), IMPATIENT).unwrap()
}

#[test]
fn a_table_goes_in_and_comes_out_again_over_good_and_bad_wires() {
    for wires in [GOOD, bad()] {
        let is_good = wires[0].every == 0;
        let (port, flash) = spawn("SN1", wires);
        let mut unit = connect(port);
        assert_eq!(unit.identify().unwrap().bank, None);
        for (round, bank) in [(1, Bank::A), (2, Bank::B), (3, Bank::A)] {
            let image = image_of("SN1", round, round as f32);
            let mut told = Vec::new();
            let after = flash_set(&mut unit, &image, |bytes| told.push(bytes)).unwrap();
            assert_eq!((after.table_crc, after.bank), (round, Some(bank)));
            assert!(told.is_sorted() && told.last() == Some(&image.len()));
            assert_eq!(download(&mut unit, bank).unwrap(), image);
        }
        let kept = flash.lock().unwrap();
        assert_eq!(kept.boots, 4);
        // Hello is not counted. Each request is carried out once, however often it was sent.
        let (chunks, rounds) = (image_of("SN1", 1, 1.0).len().div_ceil(256), 3);
        assert!(is_good || kept.done > 0);
        assert_eq!(
            kept.done,
            // Identity, upload, use, identity, download.
            1 + rounds * (1 + 1 + chunks + 1 + 1 + 1 + chunks + 1)
        );
    }
}

#[test]
fn a_table_of_another_unit_or_shape_is_refused_before_anything_is_written() {
    let (port, flash) = spawn("SN1", GOOD);
    let mut unit = connect(port);
    let good = image_of("SN1", 7, 1.0);
    let mut damaged = good.clone();
    damaged[300] ^= 1;
    for (image, expected) in [
        (
            &image_of("SN2", 7, 1.0),
            "the table is that of unit \"SN2\", but this is unit \"SN1\"",
        ),
        (
            &damaged,
            "the image of the table: the CRC of block 0 is wrong",
        ),
        (&good[..100].to_vec(), "the image of the table: 100 bytes"),
        (&vec![0; 300_000], "the image of the table"),
    ] {
        let error = flash_set(&mut unit, image, |_| panic!("written")).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    assert_eq!(
        flash.lock().unwrap().done,
        4,
        "the unit was only asked what it is"
    );
}

#[test]
fn a_table_that_does_not_fit_the_board_is_refused_in_words_that_help() {
    use tempco_image::Unit::{Dph, Dps, G, Mps2, PulsesPerS};
    let (port, flash) = spawn("SN1", GOOD);
    let mut unit = connect(port);
    let other = "axis 0 of the table was fitted with 0.5 arcsec per pulse, but the unit turns \
                 pulses into angles by 0.7 arcsec; fit again with --scale-factor 0.7";
    let large = "the bias of axis 0 of the table may be 8.9 deg/h, but the unit takes 8.8 deg/h at \
                 most; is the set one of this gyro?";
    for (of_board, of_image, scale_factor, max_bias, refused) in [
        (Dph, Dph, 0.5, 10.0, Some(other)),
        (Dps, Dps, 0.5, 10.0, Some(other)),
        (Dph, Dph, 0.700_002, 10.0, Some("0.700002")),
        (
            Dph,
            Dph,
            0.0,
            10.0,
            Some("give coefficients.json and --scale-factor"),
        ),
        (
            Dph,
            Dps,
            0.7,
            10.0,
            Some("is in deg/s, but the firmware of the unit was built for deg/h"),
        ),
        (
            PulsesPerS,
            Dph,
            0.7,
            10.0,
            Some("built for pulses/s; fit again in that unit, or build"),
        ),
        (
            Dph,
            Mps2,
            0.0,
            10.0,
            Some("is in m/s^2, but the unit counts the pulses of a gyro"),
        ),
        (
            G,
            G,
            0.0,
            10.0,
            Some("is in g, but the unit counts the pulses of a gyro"),
        ),
        (Dph, Dph, 0.7, 8.8, Some(large)),
        (Dph, Dph, 0.7, 10.0, None),
        (PulsesPerS, PulsesPerS, 0.0, 10.0, None),
        (PulsesPerS, PulsesPerS, 0.5, 10.0, None),
    ] {
        flash.lock().unwrap().fit = Some(Fit {
            unit: of_board,
            scale_factor_arcsec: 0.7,
            max_bias,
        });
        let image = image_in(of_image, scale_factor, "SN1", 7, 1.0);
        let chosen = flash.lock().unwrap().chosen;
        let written = flash_set(&mut unit, &image, |_| {});
        match refused {
            None => drop(written.unwrap()),
            Some(words) => {
                let error = written.unwrap_err().to_string();
                assert!(error.contains(words), "{error}");
                assert!(error.ends_with(": nothing was written"), "{error}");
                assert_eq!(flash.lock().unwrap().chosen, chosen);
            }
        }
    }
}

/// What only the unit knows.
#[test]
fn a_refusal_of_the_unit_is_told_in_words() {
    let (port, flash) = spawn("SN1", GOOD);
    let mut unit = connect(port);
    for (refusal, words) in [
        (
            Refusal::Unit { axis: 2 },
            "axis 2 of the table is in another unit than its firmware was built for",
        ),
        (
            Refusal::ScaleFactor { axis: 1 },
            "axis 1 of the table was fitted with another scale factor than that of its board",
        ),
        (
            Refusal::Bias { axis: 0 },
            "the bias of axis 0 of the table may be larger than its board lets it",
        ),
        (Refusal::Image, "the image is not good for it"),
    ] {
        flash.lock().unwrap().refuses = Some(refusal);
        let image = image_of("SN1", 7, 1.0);
        let error = flash_set(&mut unit, &image, |_| {})
            .unwrap_err()
            .to_string();
        let expected = format!("the unit refused the end of an upload: {words}");
        assert!(error.starts_with(&expected), "{error}");
        assert_eq!(flash.lock().unwrap().chosen, None);
    }
}

#[test]
fn a_unit_with_the_example_table_says_how_to_build_it_with_ones_own() {
    let (port, _) = spawn("EXAMPLE", GOOD);
    let error = flash_set(&mut connect(port), &image_of("SN1", 7, 1.0), |_| {});
    let error = error.unwrap_err().to_string();
    assert!(error.contains("this is unit \"EXAMPLE\""), "{error}");
    assert!(error.contains("TEMPCO_TABLE="), "{error}");
}

#[test]
fn a_unit_that_is_reset_in_mid_upload_ends_it_and_a_second_upload_succeeds() {
    let (port, flash) = spawn("SN1", GOOD);
    flash.lock().unwrap().reset_after = Some(3);
    let mut unit = connect(port);
    let image = image_of("SN1", 7, 1.0);
    let error = flash_set(&mut unit, &image, |_| {}).unwrap_err();
    assert!(matches!(error, Error::SessionLost { .. }), "{error}");
    assert!(
        error.to_string().contains("a chunk of an upload"),
        "{error}"
    );
    assert_eq!(flash.lock().unwrap().chosen, None);
    // The session is open again, and what does not depend on the old one needs no second try.
    assert_eq!(unit.identify().unwrap().sequence, 2);
    flash_set(&mut unit, &image, |_| {}).unwrap();
}

#[test]
fn a_lost_answer_of_a_unit_that_resets_itself_is_no_error() {
    let (port, flash) = spawn("SN1", GOOD);
    flash.lock().unwrap().is_hasty = true;
    let after = flash_set(&mut connect(port), &image_of("SN1", 7, 1.0), |_| {}).unwrap();
    assert_eq!(after.table_crc, 7);
}

#[test]
fn a_unit_that_does_not_use_its_new_table_is_told_of() {
    let (port, flash) = spawn("SN1", GOOD);
    flash.lock().unwrap().is_stubborn = true;
    let mut unit = connect(port);
    let error = flash_set(&mut unit, &image_of("SN1", 7, 1.0), |_| {}).unwrap_err();
    assert!(error.to_string().contains("it runs on no table"), "{error}");
}

/// Samples with every kind of bad number.
fn samples(count: usize) -> impl Iterator<Item = Sample<1, 3>> {
    (0..count).map(|row| {
        let mut raw = [0.5, -0.25, row as f32 * 1e-3];
        let mut temp_c = 20.0 + row as f32 * 1e-3;
        match row % 97 {
            13 => raw[0] = -f32::NAN,
            14 => raw[1] = f32::INFINITY,
            15 => temp_c = f32::NAN,
            16 => raw[2] = -0.0,
            _ => {}
        }
        Sample {
            update_s: (row % 5 != 3).then_some(if row % 31 == 0 { 2.0 } else { 1.0 }),
            temps_c: [temp_c],
            raw: [raw],
        }
    })
}

/// Replays over the tables in `image`, by rows and by blocks.
fn replays(unit: &mut Unit, image: &[u8], count: usize) -> [replay::Comparison; 2] {
    let mut place = Box::new(AlignedBytes([0; 65_536]));
    place.0[..image.len()].copy_from_slice(image);
    let tables = Image::read(&place.0).unwrap().tables::<1, 3>().unwrap();
    let mut told = 0;
    let rows = replay::by_row(unit, &tables, samples(count), |done| told = done).unwrap();
    assert_eq!(told, count as u64);
    let samples = samples(count);
    let blocks = replay::by_block(unit, &tables, &SCHEDULE, false, samples, |done| told = done);
    assert_eq!(told, count as u64);
    [rows, blocks.unwrap()]
}

#[test]
fn replays_find_no_difference_where_there_is_none_and_every_one_where_there_is() {
    for wires in [GOOD, [Wire::new(8000), Wire::new(9000)]] {
        let (port, _flash) = spawn("SN1", wires);
        let mut unit = connect(port);
        let image = image_of("SN1", 7, 1.0);
        flash_set(&mut unit, &image, |_| {}).unwrap();
        for comparison in replays(&mut unit, &image, 777) {
            assert_eq!((comparison.samples, comparison.different), (777, 0));
            assert_eq!(comparison.first, None);
        }
        // Nothing is left of the first replay, and samples were counted by the unit.
        let [rows, blocks] = replays(&mut unit, &image, 500);
        assert_eq!((rows.different, blocks.different), (0, 0));
        assert_eq!(blocks.after.samples - blocks.before.samples, 500);
        // Another table, and one whose numbers differ by their lowest bits: some of those are
        // rounded away.
        for (scale, least) in [(1.5, 500), (1.0 + f32::EPSILON, 100)] {
            let other = image_of("SN1", 7, scale);
            for comparison in replays(&mut unit, &other, 500) {
                assert!(comparison.different >= least, "{comparison:?}");
                assert_eq!(comparison.first, Some(0));
            }
        }
    }
}

/// By rows everything is compared. By blocks, which are of 80 samples but for the last, so is the
/// last sample; of the others the compensated samples, and biases and flags by the CRC of the block.
#[test]
fn a_bit_of_any_figure_of_one_sample_is_found() {
    let (port, flash) = spawn("SN1", GOOD);
    let mut unit = connect(port);
    let image = image_of("SN1", 7, 1.0);
    flash_set(&mut unit, &image, |_| {}).unwrap();
    for (figure, number, by_sample, block) in [
        (Figure::Effective, 79, true, None),
        (Figure::Rate, 79, true, None),
        (Figure::Status, 79, true, Some(0)),
        (Figure::Bias, 79, true, Some(0)),
        (Figure::Compensated, 79, true, None),
        (Figure::Compensated, 17, true, None),
        (Figure::Bias, 17, false, Some(0)),
        (Figure::Bias, 80, false, Some(80)),
        (Figure::Status, 98, false, Some(80)),
    ] {
        flash.lock().unwrap().spoil = Some((number, figure));
        let [rows, blocks] = replays(&mut unit, &image, 100);
        let found = Some(number as u64);
        assert_eq!((rows.different, rows.first), (1, found), "{figure:?}");
        assert_eq!((rows.different_blocks, rows.first_block), (0, None));
        let expected = if by_sample { (1, found) } else { (0, None) };
        assert_eq!((blocks.different, blocks.first), expected, "{figure:?}");
        let expected = (u64::from(block.is_some()), block);
        let found = (blocks.different_blocks, blocks.first_block);
        assert_eq!(found, expected, "{figure:?} {number}");
    }
}

/// An older unit refuses without a version of its own, a newer one states it.
#[test]
fn units_of_other_versions_are_told_by_their_version() {
    let answers = |message: Response<'static>| {
        let (port, mut unit) = std::os::unix::net::UnixStream::pair().unwrap();
        std::thread::spawn(move || {
            let mut decoder = Decoder::new();
            let mut byte = [0];
            while unit.read_exact(&mut byte).is_ok() {
                let Some(plain) = decoder.push(byte[0]) else {
                    continue;
                };
                let frame = Frame {
                    session: 0,
                    sequence: u16::from(plain[1]),
                    message: match &message {
                        Response::Hello { major, .. } => Response::Hello {
                            major: *major,
                            minor: 0,
                            // The varint behind session, sequence, request and version.
                            nonce: plain[5..]
                                .iter()
                                .take(5)
                                .zip(0..)
                                .fold(0, |nonce, (byte, at)| {
                                    nonce | u32::from(byte & 0x7f) << (7 * at)
                                }),
                            session: 0,
                        },
                        other => other.clone(),
                    },
                };
                let mut wire = [0; MAX_FRAME];
                let len = frame.encode(&mut wire).unwrap();
                _ = unit.write_all(&wire[..len]);
            }
        });
        port.set_read_timeout(Some(Duration::from_millis(5)))
            .unwrap();
        let error = Unit::connect(Box::new(port), IMPATIENT).err().unwrap();
        error.to_string()
    };
    let told = |version| {
        format!(
            "the unit speaks version {version} of the protocol and this program version 2: use the \
             program that came with the firmware"
        )
    };
    assert_eq!(answers(Response::Refused(Refusal::Version)), told(1));
    let newer = Response::Hello {
        major: 3,
        minor: 0,
        nonce: 0,
        session: 0,
    };
    assert_eq!(answers(newer), told(3));
}

#[test]
fn telemetry_between_answers_is_kept() {
    let (port, _flash) = spawn("SN1", GOOD);
    let mut unit = connect(port);
    assert_eq!(unit.telemetry(50).unwrap().index, 0);
    unit.identify().unwrap();
    let mut indices = Vec::new();
    while let Some(telemetry) = unit.wait_telemetry(Duration::from_millis(20)).unwrap() {
        indices.push(telemetry.index);
    }
    assert_eq!(indices, [1, 2]);
}

#[test]
fn the_whole_fault_log_is_read() {
    let (port, _flash) = spawn("SN1", bad());
    let faults = connect(port).faults().unwrap();
    let codes: Vec<u16> = faults.iter().map(|entry| entry.code).collect();
    assert_eq!(codes, Vec::from_iter(0..11));
}

#[test]
fn refusals_silence_and_missing_ports_are_told_apart() {
    let (port, _flash) = spawn("SN1", GOOD);
    let mut unit = connect(port);
    let error = unit.command(&Request::Activate(Bank::B)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the unit refused the use of a table: its flash failed, or there is no such table in it"
    );

    let (port, _silent) = std::os::unix::net::UnixStream::pair().unwrap();
    port.set_read_timeout(Some(Duration::from_millis(5)))
        .unwrap();
    let patience = Patience {
        answer: Duration::from_millis(10),
        tries: 3,
        ..IMPATIENT
    };
    let error = Unit::connect(Box::new(port), patience).err().unwrap();
    assert!(matches!(error, Error::NoAnswer { tries: 3, .. }), "{error}");
    assert!(
        error
            .to_string()
            .starts_with("no answer to hello after 3 tries in "),
        "{error}"
    );

    let (port, _) = std::os::unix::net::UnixStream::pair().unwrap();
    let error = Unit::connect(Box::new(port), patience).err().unwrap();
    assert!(matches!(error, Error::Closed | Error::Port(_)), "{error}");

    let missing = Path::new("/nonexistent/ttyUSB9");
    let error = open(missing, 921_600).err().unwrap();
    assert!(
        error
            .to_string()
            .starts_with("/nonexistent/ttyUSB9: No such file"),
        "{error}"
    );
}
