//! What is written is read back, for any shape and any numbers.

mod common;

use proptest::collection::vec;
use proptest::prelude::*;
use tempco::{Play, SlowPart, Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Channel, ChannelHistory, Image, Info, Unit, encode};

fn terms() -> impl Strategy<Value = Terms> {
    any::<[u32; Terms::COUNT]>().prop_map(|bits| Terms::from_array(bits.map(f32::from_bits)))
}

fn bits(cells: &[Terms]) -> Vec<u32> {
    let numbers = cells.iter().flat_map(Terms::to_array);
    numbers.map(f32::to_bits).collect()
}

/// Terms of so many axes, of the same random numbers in every channel.
fn history(axes: usize, plays: usize, slow_parts: usize, numbers: &[u32; 8]) -> ChannelHistory {
    let [width, tau, gain @ ..] = numbers.map(f32::from_bits);
    let gain = std::array::from_fn(|axis| if axis < axes { gain[axis] } else { 0.0 });
    let play = Play {
        half_width_c: width,
        gain,
    };
    let part = SlowPart {
        tau_s: tau,
        limit_c: width,
        gain,
    };
    ChannelHistory::new::<6>(&[play; 2][..plays], &[part][..slow_parts]).unwrap()
}

fn history_bits(history: &ChannelHistory) -> Vec<u32> {
    let plays = history.plays().flat_map(|play| {
        let width = std::iter::once(play.half_width_c);
        width.chain(play.gain)
    });
    let slow_parts = history.slow_parts().flat_map(|part| {
        let settings = [part.tau_s, part.limit_c];
        settings.into_iter().chain(part.gain)
    });
    plays.chain(slow_parts).map(f32::to_bits).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn channels_come_back(
        shape in (1_usize..=6, 1_usize..=6).prop_filter("six axes", |(c, a)| c * a <= 6),
        cells in vec(terms(), 6 * 20),
        count in 1_usize..=20,
        code in 1_u8..=6,
        edges in any::<[u32; 4]>(),
        terms in (0_usize..=2, 0_usize..=1, any::<[u32; 8]>()),
        table_crc in any::<u32>(),
        continuous in any::<bool>(),
        serial in "[ -~]{1,32}",
    ) {
        let (channels, axes) = shape;
        let [first_edge_c, last_edge_c, t_min_c, t_max_c] = edges.map(f32::from_bits);
        let unit = Unit::from_code(code).unwrap();
        let written: Vec<Channel> = (0..channels).map(|number| Channel {
            thermal: ThermalSettings { kappa: number as f32, ..ThermalSettings::DEFAULT },
            first_edge_c,
            last_edge_c,
            t_min_c,
            t_max_c,
            units: Unit::array(&[unit; 6][..axes]),
            cells: &cells[number..][..axes * count],
            history: history(axes, terms.0, terms.1, &terms.2),
        }).collect();
        let info = Info { serial: &serial, table_crc, continuous };
        let mut bytes = Box::new(AlignedBytes([0xee; 20_000]));
        let len = encode(&info, &written, &mut bytes.0).unwrap();
        let image = Image::read(&bytes.0).unwrap();
        prop_assert_eq!(image.bytes().len(), len);
        prop_assert_eq!(image.info(), &info);
        prop_assert_eq!((image.channels(), image.axes()), shape);
        for (number, channel) in written.iter().enumerate() {
            let read = image.channel(number).unwrap();
            prop_assert_eq!(read.thermal, channel.thermal);
            prop_assert_eq!(read.units, channel.units);
            let temps = |c: &Channel| [c.first_edge_c, c.last_edge_c, c.t_min_c, c.t_max_c].map(f32::to_bits);
            prop_assert_eq!(temps(&read), temps(channel));
            prop_assert_eq!(bits(read.cells), bits(channel.cells));
            prop_assert_eq!(read.history.counts(), (terms.0, terms.1));
            prop_assert_eq!(history_bits(&read.history), history_bits(&channel.history));
        }
        // Whatever the numbers are, validation ends without a panic.
        let _ = image.validate();
    }

    /// Garbage behind a valid start is refused or read, but never panics.
    #[test]
    fn any_bytes_are_survived(
        bytes in vec(any::<u8>(), 0..400),
        sealed in any::<bool>(),
        of in 0_usize..2,
    ) {
        let (mut image, len) = common::examples()[of];
        let end = (24 + bytes.len()).min(len);
        image.0[24..end].copy_from_slice(&bytes[..end - 24]);
        if sealed {
            common::reseal(&mut image.0[..len]);
        }
        if let Ok(image) = Image::read(&image.0) {
            let _ = image.validate();
        }
    }
}
