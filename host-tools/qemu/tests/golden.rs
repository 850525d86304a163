//! Host and targets make the same bits of a million samples. `cargo xtask golden` takes ten.

mod support;

use support::WORKSPACE;
use tempco_qemu::golden::{BOARDS, HOST_BUILDS, check, on_host, on_target};

const MILLIONS: u32 = 1;

fn assert_golden(name: &str, lines: &[String]) {
    assert_eq!(lines.len(), MILLIONS as usize + 1, "{name}: {lines:?}");
    if let Some([made, expected]) = check(&WORKSPACE, lines).unwrap() {
        panic!("{name} made `{made}`, not `{expected}`; see firmware/tests/golden.txt");
    }
}

#[test]
fn hosts_agree() {
    for (name, profile, variant) in HOST_BUILDS {
        let lines = on_host(&WORKSPACE, profile, &variant, MILLIONS).unwrap();
        assert_golden(name, &lines);
    }
}

#[test]
fn every_processor_agrees() {
    for board in BOARDS {
        let lines = on_target(&WORKSPACE, board, MILLIONS).unwrap();
        assert_golden(board.name(), &lines);
    }
}
