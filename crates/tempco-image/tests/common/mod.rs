//! Images for the tests, and ways to spoil them so that the CRCs still hold.
#![allow(dead_code, reason = "each test program uses its share")]

use tempco::{Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Axis, BLOCK_LEN, CRC, Channel, Info, Unit, contents_len, encode};

pub(crate) type Bytes = AlignedBytes<512>;

pub(crate) const HEADER_LEN: usize = 80;
pub(crate) const CHANNEL_LEN: usize = 116;
pub(crate) const AXIS_LEN: usize = 28;
/// Where the cells of the example begin.
pub(crate) const CELLS_AT: usize = HEADER_LEN + CHANNEL_LEN + AXIS_LEN;

/// Two cells of one axis that meet at 20 degC.
pub(crate) const CELLS: [Terms; 2] = [
    Terms::from_array([-0.5, 0.75, 0.0, 0.5, 0.0, 0.125, 0.25]),
    Terms::from_array([0.25, 0.5, 0.125, 0.5, 0.25, 0.375, 0.0]),
];

/// A second lag and two plays.
pub(crate) const THERMAL: ThermalSettings = ThermalSettings {
    kappa: 0.25,
    kappa2: -0.125,
    lag2_min_c: -4.0,
    lag2_max_c: 5.0,
    half_width1_c: 2.0,
    half_width2_c: 8.0,
    play_kappa: 0.375,
    play_kappa2: 0.5,
    least_divisor: 0.75,
    rate_start: 2.5,
    lag2_start_min: -6.0,
    play_start_min: 3.0,
    ..ThermalSettings::DEFAULT
};

pub(crate) const AXIS: Axis = Axis {
    unit: Unit::Dph,
    scale_factor_arcsec: 1.5,
    row_noise: 0.0625,
    row_noise_interval_s: 10.0,
    rezero_limit: 20.0,
    play_gains: [0.5, -0.25],
};

pub(crate) const INFO: Info = Info {
    serial: "SN7",
    table_crc: 0x1234_abcd,
    continuous: true,
    security_counter: 5,
    key_id: 0,
    signature: &[],
};

pub(crate) const SIGNED: Info = Info {
    key_id: 0x102,
    signature: b"eight by",
    ..INFO
};

pub(crate) fn channel<'a>(cells: &'a [Terms], axes: &[Axis]) -> Channel<'a> {
    Channel {
        thermal: THERMAL,
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -35.0,
        t_max_c: 75.0,
        period_s: 0.25,
        axes: Axis::array(axes),
        cells,
    }
}

/// The image of the worked example and its length.
pub(crate) fn example() -> (Bytes, usize) {
    example_of(&INFO)
}

/// Images without and with a signature.
pub(crate) fn examples() -> [(Bytes, usize); 2] {
    [example(), example_of(&SIGNED)]
}

fn example_of(info: &Info) -> (Bytes, usize) {
    let mut bytes = AlignedBytes([0; 512]);
    let len = encode(info, &[channel(&CELLS, &[AXIS])], &mut bytes.0).unwrap();
    (bytes, len)
}

/// Makes all CRCs right again.
pub(crate) fn reseal(image: &mut [u8]) {
    let crc = CRC.checksum(&image[..HEADER_LEN - 4]);
    image[HEADER_LEN - 4..HEADER_LEN].copy_from_slice(&crc.to_le_bytes());
    let (contents, crcs) = image.split_at_mut(contents_len(image.len()).unwrap());
    for (block, crc) in contents.chunks(BLOCK_LEN).zip(crcs.chunks_mut(4)) {
        crc.copy_from_slice(&CRC.checksum(block).to_le_bytes());
    }
}

/// The example with bytes replaced and valid CRCs.
pub(crate) fn spoilt(at: usize, with: &[u8]) -> (Bytes, usize) {
    let (mut bytes, len) = example();
    bytes.0[at..at + with.len()].copy_from_slice(with);
    reseal(&mut bytes.0[..len]);
    (bytes, len)
}

/// SplitMix64: random bits that are the same on every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }
}
