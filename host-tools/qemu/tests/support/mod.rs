//! What the tests of the images share: set-up, sample streams, and the host's side of a replay.
#![allow(dead_code, unreachable_pub)]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use tempco::Table;
use tempco_image::{Axis, Channel, Info, Unit, encode as encode_image};
use tempco_qemu::{Board, Workspace, build, ensure_qemu, ensure_target_of};
use tempco_replay::{Header, Outcome, Record, Replay, Sample, Summary};

/// The checkout, on a machine that has all that is needed.
pub static WORKSPACE: LazyLock<Workspace> = LazyLock::new(|| {
    let workspace = Workspace::find().unwrap();
    for board in Board::ALL {
        ensure_target_of(&workspace, board).unwrap();
    }
    ensure_qemu(&workspace).unwrap();
    workspace
});

pub fn image(board: Board, bin: &str, table: Option<&Path>) -> PathBuf {
    ensure_target_of(&WORKSPACE, board).unwrap();
    build(&WORKSPACE, board, bin, table).unwrap_or_else(|error| panic!("{error}"))
}

/// The example table, as the firmware has it built in.
#[allow(clippy::all, unreachable_pub)]
pub mod example {
    include!("../../../../firmware/tables/example.rs");
}

/// The same as a flash image.
pub fn example_image() -> Vec<u8> {
    example_image_in(Unit::PulsesPerS)
}

/// As [`example_image`], with its axes in any unit.
pub fn example_image_in(unit: Unit) -> Vec<u8> {
    let [table] = &example::TABLES;
    let channel = Channel {
        thermal: *table.thermal().settings(),
        first_edge_c: -15.0,
        last_edge_c: 80.0,
        t_min_c: -15.0,
        t_max_c: 80.0,
        period_s: 0.0,
        axes: Axis::array(&[Axis::new(unit); 3]),
        cells: table.cells().as_flattened(),
    };
    let info = Info {
        serial: example::SERIAL,
        table_crc: example::CRC,
        ..Info::default()
    };
    let mut image = vec![0; 16 * 1024];
    let len = encode_image(&info, &[channel], &mut image).unwrap();
    image.truncate(len);
    image
}

/// Another table, of another shape.
#[allow(clippy::all, unreachable_pub)]
pub mod two_channels {
    include!("../tables/two_channels.rs");
}

/// Numbers without a pattern, the same on every run (xorshift64*).
pub struct Noise(pub u64);

impl Noise {
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    /// Evenly from -1 to 1.
    pub fn even(&mut self) -> f32 {
        self.bits() as f32 / u32::MAX as f32 * 2.0 - 1.0
    }

    /// `good` mostly; one in eight is any bit pattern or a value of the awkward kinds.
    pub fn spoil(&mut self, good: f32) -> f32 {
        const AWKWARD: [u32; 8] = [
            0x7f80_0000,
            0xff80_0000,
            0x7fc0_0000,
            0xff80_0001,
            0x8000_0000,
            0x0000_0001,
            0x7f61_b1e6,
            0x3380_0000,
        ];
        match self.bits() % 16 {
            0 => f32::from_bits(self.bits()),
            1 => f32::from_bits(AWKWARD[self.bits() as usize % AWKWARD.len()]),
            _ => good,
        }
    }
}

pub fn encode<const C: usize, const A: usize>(samples: &[Sample<C, A>]) -> Vec<u8> {
    let mut bytes = Header::samples::<C, A>().encode().to_vec();
    for sample in samples {
        append(&mut bytes, sample);
    }
    bytes
}

/// The outcome stream and summary that the firmware must arrive at too.
pub fn on_host<const C: usize, const A: usize>(
    tables: &[Table<'_, A>; C],
    crc: u32,
    samples: &[Sample<C, A>],
) -> (Vec<Outcome<C, A>>, Vec<u8>, Summary) {
    let mut replay = Replay::new(tables);
    let outcomes: Vec<_> = samples.iter().map(|sample| replay.step(sample)).collect();
    let mut bytes = Header::outcomes::<C, A>(crc).encode().to_vec();
    for outcome in &outcomes {
        append(&mut bytes, outcome);
    }
    (outcomes, bytes, replay.summary())
}

fn append(bytes: &mut Vec<u8>, record: &impl Record) {
    fn len<R: Record>(_: &R) -> usize {
        R::LEN
    }
    let start = bytes.len();
    bytes.resize(start + len(record), 0);
    record.encode(&mut bytes[start..]).unwrap();
}

/// Fails with the first record that differs and how many do.
pub fn assert_same<const C: usize, const A: usize>(
    samples: &[Sample<C, A>],
    host: &[u8],
    target: &[u8],
) {
    assert_eq!(host.len(), target.len(), "lengths of the outcome streams");
    assert_eq!(host[..Header::LEN], target[..Header::LEN], "headers");
    let len = Outcome::<C, A>::LEN;
    let records = |bytes| <[u8]>::chunks_exact(bytes, len);
    let differing: Vec<usize> = records(&host[Header::LEN..])
        .zip(records(&target[Header::LEN..]))
        .enumerate()
        .filter_map(|(number, (host, target))| (host != target).then_some(number))
        .collect();
    if let Some(first) = differing.first() {
        let at = Header::LEN + first * len;
        panic!(
            "{} of {} outcomes differ, first number {first}:\n{:?}\nhost   {:?}\ntarget {:?}",
            differing.len(),
            samples.len(),
            samples[*first],
            Outcome::<C, A>::decode(&host[at..]),
            Outcome::<C, A>::decode(&target[at..]),
        );
    }
}
