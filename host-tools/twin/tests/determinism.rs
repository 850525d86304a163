//! The same bytes on every machine, in debug and in release.

use sha2::{Digest, Sha256};
use tempco_twin::{Profile, Simulation, UNITS, Unit, write_log, write_log_and_truth};

/// SHA-256 of log and truth of each named unit on the profile `faults`, seed 1, 16 Hz. A change here
/// is a change of every simulated log.
const HASHES: &[(&str, &str)] = &[
    (
        "paper",
        "7b5a416cd071487d73dabe62df04d830654d927a899f5ce9ccdf7df3027fc043",
    ),
    (
        "smooth",
        "9657133c811652d5bea65bded88bdc01d08fc54e9bd351b43a0b56e0673344d2",
    ),
    (
        "wavy",
        "b03c7a130f5edc96a25ac858ca348ef478e96cc5c779ab19b662d78425e3f76e",
    ),
    (
        "hysteretic",
        "e4f0bc6671bb9f70e7f3f9edd3063576f0f2135853780046b68427dbea0e25b3",
    ),
    (
        "ln100",
        "61f7be6d38497ed13ae80e5f682361f59766cd9db037ca46b31bdc68f1043684",
    ),
    (
        "mems",
        "437e625a219573c6c3d475e1944ae8b547c371d87eac0fd62bbfc4a643146bc1",
    ),
    (
        "fog",
        "0bf73edbea62a5e78be7472de825a2186b03e512c27ee52107554c367ca2c44b",
    ),
    (
        "gradient",
        "c75a3f50f41b6b14054b141bd22362c29a9086804eb417efd0d74ec6fc735d15",
    ),
    (
        "mode_hops",
        "39da2bf30802f29cf7253d2d83f28b0377eb2581d9fca5a65ec1c7b42fead4a1",
    ),
    (
        "fibre",
        "6f9c1cfa0ec9af8d6a914e7c9df3e50062cfe06ed5a8cc89d3dd6fb89a429d80",
    ),
    (
        "loop",
        "55ba4446b15a8bd084f60df6c5023aa52096ae3f0d95f90608bdd9001041f039",
    ),
];

fn hash(unit: &str) -> String {
    let unit = Unit::named(unit).unwrap();
    let profile = Profile::named("faults").unwrap();
    let (mut log, mut truth) = (Vec::new(), Vec::new());
    let run = Simulation::new(&unit, &profile, 1, 16.0).unwrap();
    write_log_and_truth(&mut log, &mut truth, run).unwrap();
    let mut hasher = Sha256::new();
    hasher.update(&log);
    hasher.update(&truth);
    hex(&hasher.finalize())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The log that the committed example table and the figures of the README come from.
#[test]
fn the_calibration_log_of_the_paper_unit_has_its_committed_bytes() {
    let unit = Unit::named("paper").unwrap();
    let profile = Profile::named("calibration").unwrap();
    let mut log = Vec::new();
    write_log(&mut log, Simulation::new(&unit, &profile, 1, 2.0).unwrap()).unwrap();
    assert_eq!(
        hex(&Sha256::digest(&log)),
        "db82fd1fb939df59f52058814cc175a5eb34881911a24848487dbd6cce513b7c"
    );
}

#[test]
fn every_named_unit_has_its_committed_bytes() {
    let found: Vec<(&str, String)> = UNITS.iter().map(|unit| (*unit, hash(unit))).collect();
    let committed: Vec<(&str, String)> = HASHES
        .iter()
        .map(|(unit, hash)| (*unit, (*hash).to_owned()))
        .collect();
    assert_eq!(found, committed, "found on the left");
}
