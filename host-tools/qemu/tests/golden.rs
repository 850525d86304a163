//! Host and targets make the same bits of a million samples, in soft float of 120,000.
//! `cargo xtask golden` takes ten million, in soft float one.

mod support;

use support::WORKSPACE;
use tempco_qemu::golden::{BOARDS, HOST_BUILDS, SOFT_FLOAT_BOARDS, check, on_host, on_target};
use tempco_qemu::{Profile, Variant};

const SAMPLES: u32 = 1_000_000;
const SOFT_FLOAT_SAMPLES: u32 = 120_000;

fn assert_golden(name: &str, lines: &[String]) {
    assert_eq!(lines.len(), 2, "{name}: {lines:?}");
    if let Some([made, expected]) = check(&WORKSPACE, lines).unwrap() {
        panic!("{name} made `{made}`, not `{expected}`; see firmware/test-images/tests/golden.txt");
    }
}

/// Without the last one, which takes long to build: `cargo xtask golden` has it.
#[test]
fn hosts_agree() {
    for (name, profile, variant) in HOST_BUILDS.into_iter().take(2) {
        let lines = on_host(&WORKSPACE, profile, &variant, SAMPLES).unwrap();
        assert_golden(name, &lines);
    }
}

#[test]
fn every_processor_agrees() {
    for board in BOARDS {
        let lines = on_target(&WORKSPACE, board, SAMPLES).unwrap();
        assert_golden(board.name(), &lines);
    }
}

#[test]
fn processors_without_floating_point_agree() {
    let on_host = |samples| {
        on_host(&WORKSPACE, Profile::Firmware, &Variant::USUAL, samples)
            .unwrap_or_else(|error| panic!("{error}"))
    };
    let expected = on_host(SOFT_FLOAT_SAMPLES);
    assert_eq!(expected.len(), 2, "{expected:?}");
    // Hashes that do not see the samples would agree too.
    let hashes = |lines: &[String]| lines[1].split(' ').skip(2).collect::<String>();
    let fewer = on_host(SOFT_FLOAT_SAMPLES - 8);
    assert_ne!(hashes(&fewer), hashes(&expected));
    for board in SOFT_FLOAT_BOARDS {
        let made = on_target(&WORKSPACE, board, SOFT_FLOAT_SAMPLES).unwrap();
        assert_eq!(made, expected, "{board}");
    }
}
