//! Images for the tests, and ways to spoil them so that the CRCs still hold.
#![allow(dead_code, reason = "each test program uses its share")]

use tempco::{Play, SlowPart, Terms, ThermalSettings};
use tempco_image::{
    AlignedBytes, BLOCK_LEN, CRC, Channel, ChannelHistory, Info, Unit, contents_len, encode,
};

pub(crate) type Bytes = AlignedBytes<512>;

pub(crate) const HEADER_LEN: usize = 72;
pub(crate) const CHANNEL_LEN: usize = 72;

/// Two cells of one axis that meet at 20 degC.
pub(crate) const CELLS: [Terms; 2] = [
    Terms::new([-0.5, 0.75, 0.0], [0.5, 0.0]),
    Terms::new([0.25, 0.5, 0.125], [0.5, 0.25]),
];

pub(crate) const PLAYS: [Play<1>; 2] = [
    Play {
        half_width_c: 2.0,
        gain: [0.5],
    },
    Play {
        half_width_c: 8.0,
        gain: [-0.25],
    },
];

pub(crate) const SLOW_PART: SlowPart<1> = SlowPart {
    tau_s: 600.0,
    limit_c: 4.0,
    gain: [0.125],
};

pub(crate) const INFO: Info = Info {
    serial: "SN7",
    table_crc: 0x1234_abcd,
    continuous: true,
};

pub(crate) fn channel<'a>(cells: &'a [Terms], units: &[Unit]) -> Channel<'a> {
    Channel {
        thermal: ThermalSettings::DEFAULT,
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -35.0,
        t_max_c: 75.0,
        units: Unit::array(units),
        cells,
        history: ChannelHistory::NONE,
    }
}

/// The image of the worked example and its length.
pub(crate) fn example() -> (Bytes, usize) {
    example_with(&[], &[])
}

/// The example with as many history terms as an image can have.
pub(crate) fn example_with_history() -> (Bytes, usize) {
    example_with(&PLAYS, &[SLOW_PART])
}

/// Images without and with history terms.
pub(crate) fn examples() -> [(Bytes, usize); 2] {
    [example(), example_with_history()]
}

/// The example with some history terms.
pub(crate) fn example_with(plays: &[Play<1>], slow_parts: &[SlowPart<1>]) -> (Bytes, usize) {
    let channel = Channel {
        history: ChannelHistory::new(plays, slow_parts).unwrap(),
        ..channel(&CELLS, &[Unit::Dph])
    };
    let mut bytes = AlignedBytes([0; 512]);
    let len = encode(&INFO, &[channel], &mut bytes.0).unwrap();
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
    spoil(example(), at, with)
}

/// An image with bytes replaced and valid CRCs.
pub(crate) fn spoil((mut bytes, len): (Bytes, usize), at: usize, with: &[u8]) -> (Bytes, usize) {
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
