//! The firmware in QEMU against the same replay on the host, bit for bit.

mod support;

use std::path::Path;
use std::time::Instant;

use support::{Noise, WORKSPACE, assert_same, encode, example, image, on_host, two_channels};
use tempco::{Status, Validity};
use tempco_qemu::{Board, Error, build, replay};
use tempco_replay::{Header, Record, Sample};

type In = Sample<1, 3>;

fn sample(dt_s: f32, temp_c: f32) -> In {
    Sample {
        update_s: Some(dt_s),
        temps_c: [temp_c],
        raw: [[0.5, -0.25, 0.125]],
    }
}

/// Every kind of fault, each between calm stretches: what a test chamber never shows.
fn mission() -> Vec<In> {
    let mut samples = Vec::new();
    let calm = |samples: &mut Vec<In>, count: usize, from_c: f32, per_s: f32| {
        samples.extend((0..count).map(|i| sample(1.0, from_c + i as f32 * per_s)));
        from_c + count as f32 * per_s
    };
    let mut now_c = calm(&mut samples, 900, -20.0, 0.05);
    let wrong = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        151.0,
        -61.0,
        3e38,
        now_c + 20.0,
        now_c - 20.0,
        -0.0,
        1e-40,
    ];
    for temp_c in wrong {
        samples.push(sample(1.0, temp_c));
        now_c = calm(&mut samples, 60, now_c, -0.01);
    }
    for dt_s in [0.0, -1.0, f32::NAN, 31.0, f32::INFINITY, 1e-30, 29.0] {
        samples.push(sample(dt_s, now_c));
        now_c = calm(&mut samples, 60, now_c, 0.02);
    }
    let raws = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        3e38,
        1e-40,
        -0.0,
    ];
    for raw in raws {
        let mut bad = sample(1.0, now_c);
        bad.raw[0][1] = raw;
        samples.push(bad);
    }
    // A step that stays, a sensor lost for longer than it is held, and a run off the hot end.
    now_c = calm(&mut samples, 300, now_c + 15.0, 0.0);
    samples.extend((0..100).map(|_| sample(1.0, f32::NAN)));
    now_c = calm(&mut samples, 600, now_c, 0.1);
    now_c = calm(&mut samples, 800, now_c, -0.1);
    calm(&mut samples, 400, now_c, 0.0);
    samples
}

#[test]
fn a_mission_with_every_fault_is_the_same_on_all_boards() {
    let samples = mission();
    assert!(samples.len() > 3000);
    let (outcomes, expected, summary) = on_host(&example::TABLES, example::CRC, &samples);

    // The stream does what it is for.
    let of_history = Status::LAG_CLAMPED | Status::HISTORY_UNKNOWN;
    for (flag, name) in Status::NAMES {
        let is_seen = summary.seen.contains(flag);
        assert_eq!(is_seen, !of_history.contains(flag), "{name}");
    }
    let last = outcomes[outcomes.len() - 1].channels[0].flags();
    assert_eq!(last, Status::TEMPERATURE_JUMPED, "all faults heal but one");
    assert_eq!(summary.worst(), Validity::Invalid);

    for board in Board::ALL {
        let image = image(board, "replay", None);
        let (got, run) = replay(&image, board, &encode(&samples)).unwrap();
        assert!(run.succeeded(), "{board}: {:#?}", run.log);
        assert_same(&samples, &expected, &got);
        let banner = &run.log[0];
        for part in [board.name(), "unit EXAMPLE", "3 axes", "38 cells"] {
            assert!(banner.contains(part), "{banner}");
        }
        assert!(
            banner.contains(&format!("{:08x}", example::CRC)),
            "{banner}"
        );
        let counted = format!(
            "INFO Summary {{ samples: {}, not_valid: {}, rejected: {}, restarts: {},",
            summary.samples, summary.not_valid, summary.rejected, summary.restarts
        );
        assert!(
            run.log[1]
                .to_lowercase()
                .starts_with(&counted.to_lowercase()),
            "{:#?}",
            run.log
        );
        assert!(run.log[2].ends_with("worst Invalid"), "{:#?}", run.log);
    }
    for outcome in outcomes {
        assert!(outcome.channels[0].bias.iter().all(|bias| bias.is_finite()));
    }
}

/// One input in eight is any bit pattern or an awkward value.
#[test]
fn a_quarter_million_hostile_samples_are_the_same() {
    let mut noise = Noise(0x7465_6d70_636f);
    let mut temp_c: f32 = 25.0;
    let samples: Vec<In> = (0..250_000)
        .map(|row| {
            temp_c = (temp_c + 0.3 * noise.even()).clamp(-60.0, 150.0);
            let dt_s = 0.5 + 0.4 * noise.even();
            Sample {
                // As of a log that is faster than its thermal updates.
                update_s: (row % 4 != 1).then_some(noise.spoil(dt_s)),
                temps_c: [noise.spoil(temp_c)],
                raw: [[(); 3].map(|()| {
                    let raw = noise.even();
                    noise.spoil(raw)
                })],
            }
        })
        .collect();
    let (outcomes, expected, summary) = on_host(&example::TABLES, example::CRC, &samples);
    for outcome in outcomes {
        assert!(outcome.channels[0].bias.iter().all(|bias| bias.is_finite()));
    }
    // Some of it must get through, or only the rejection is tested.
    assert!(
        summary.rejected > 1000 && summary.rejected < summary.samples / 2,
        "{summary:?}"
    );

    let image = image(Board::Mps2An386, "replay", None);
    let start = Instant::now();
    let (got, run) = replay(&image, Board::Mps2An386, &encode(&samples)).unwrap();
    println!(
        "{} samples in {:?}: 0 differences",
        samples.len(),
        start.elapsed()
    );
    assert!(run.succeeded(), "{:#?}", run.log);
    assert_same(&samples, &expected, &got);
}

#[test]
fn a_table_of_another_shape_is_built_in_and_the_same() {
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables/two_channels.rs");
    let mut noise = Noise(1);
    let samples: Vec<Sample<2, 2>> = (0..3000)
        .map(|i| {
            let temp_c = 30.0 + 40.0 * (i as f32 * 0.002).sin();
            Sample {
                update_s: Some(1.0),
                temps_c: [temp_c, noise.spoil(temp_c - 10.0)],
                raw: [[noise.even(), noise.even()], [noise.even(), noise.even()]],
            }
        })
        .collect();
    let (_, expected, summary) = on_host(&two_channels::TABLES, two_channels::CRC, &samples);
    let image = image(Board::Mps2An386, "replay", Some(&table));
    let (got, run) = replay(&image, Board::Mps2An386, &encode(&samples)).unwrap();
    assert!(run.succeeded(), "{:#?}", run.log);
    assert_same(&samples, &expected, &got);
    assert!(summary.rejected > 0);
    assert!(run.log[0].contains("unit TWO,CHANNELS, 2 channel(s) of 2 axes, 4 cells"));
}

#[test]
fn a_bad_table_stops_the_build_with_its_reason() {
    let example = WORKSPACE.root().join("firmware/tables/example.rs");
    let text = std::fs::read_to_string(example).unwrap();
    let bad = text.replace("hold_s: 60.0", "hold_s: -60.0");
    assert_ne!(bad, text);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.rs");
    std::fs::write(&path, bad).unwrap();
    let error = build(&WORKSPACE, Board::Mps2An386, "replay", Some(&path)).unwrap_err();
    assert!(matches!(error, Error::Command { .. }));
    assert!(error.to_string().contains("hold_s"), "{error}");
}

#[test]
fn streams_that_do_not_belong_are_refused_by_the_image() {
    let board = Board::Mps2An386;
    let image = image(board, "replay", None);
    let refused = |stream: &[u8]| {
        let (outcomes, run) = replay(&image, board, stream).unwrap();
        assert_eq!(run.exit_code, 1, "{:#?}", run.log);
        (outcomes, run.log.last().unwrap().clone())
    };
    let samples = vec![sample(1.0, 25.0); 10];
    let good = encode(&samples);

    let mut other_shape = Header::samples::<3, 1>().encode().to_vec();
    other_shape.extend_from_slice(&good[Header::LEN..]);
    let (outcomes, line) = refused(&other_shape);
    assert!(outcomes.is_empty());
    assert!(
        line.starts_with("error") && line.contains("Shape"),
        "{line}"
    );

    let mut newer = good.clone();
    newer[8] += 1;
    assert!(refused(&newer).1.contains("Version"));
    assert!(
        refused(b"time_s,temp_c,x_dph\n0,25,1\n")
            .1
            .contains("Magic")
    );
    assert!(refused(b"").1.contains("Short"));

    let (outcomes, line) = refused(&good[..good.len() - 5]);
    assert!(line.contains("Truncated"), "{line}");
    let (_, expected, _) = on_host(&example::TABLES, example::CRC, &samples[..9]);
    assert_eq!(outcomes, expected, "what was complete is answered");
    assert_eq!(good.len(), Header::LEN + 10 * In::LEN);
}
