//! What is written is read back, for any shape and any numbers.

mod common;

use proptest::collection::vec;
use proptest::prelude::*;
use tempco::{Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Axis, Channel, Image, Info, Unit, encode};

fn terms() -> impl Strategy<Value = Terms> {
    any::<[u32; Terms::COUNT]>().prop_map(|bits| Terms::from_array(bits.map(f32::from_bits)))
}

fn bits(cells: &[Terms]) -> Vec<u32> {
    let numbers = cells.iter().flat_map(Terms::to_array);
    numbers.map(f32::to_bits).collect()
}

/// An axis of random numbers.
fn axis() -> impl Strategy<Value = Axis> {
    (1_u8..=6, any::<[u32; 6]>()).prop_map(|(code, numbers)| {
        let [
            scale_factor_arcsec,
            row_noise,
            row_noise_interval_s,
            rezero_limit,
            gains @ ..,
        ] = numbers.map(f32::from_bits);
        Axis {
            unit: Unit::from_code(code).unwrap(),
            scale_factor_arcsec,
            row_noise,
            row_noise_interval_s,
            rezero_limit,
            play_gains: gains,
        }
    })
}

fn axis_bits(axis: Axis) -> (u8, Vec<u32>) {
    let numbers = [
        axis.scale_factor_arcsec,
        axis.row_noise,
        axis.row_noise_interval_s,
        axis.rezero_limit,
    ];
    let numbers = numbers.into_iter().chain(axis.play_gains);
    (axis.unit.code(), numbers.map(f32::to_bits).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn channels_come_back(
        shape in (1_usize..=6, 1_usize..=6).prop_filter("six axes", |(c, a)| c * a <= 6),
        cells in vec(terms(), 6 * 20),
        count in 1_usize..=20,
        thermal in any::<[u32; ThermalSettings::NAMES.len()]>(),
        temps in any::<[u32; 5]>(),
        axes_of in vec(axis(), 6),
        (table_crc, security_counter, key_id) in (any::<u32>(), any::<u32>(), 1_u16..),
        continuous in any::<bool>(),
        serial in "[ -~]{1,32}",
        signature in vec(any::<[u8; 4]>(), 0..=32),
    ) {
        let (channels, axes) = shape;
        let thermal = thermal.map(f32::from_bits);
        let [first_edge_c, last_edge_c, t_min_c, t_max_c, period_s] = temps.map(f32::from_bits);
        let written: Vec<Channel> = (0..channels).map(|number| Channel {
            thermal: ThermalSettings { kappa: number as f32, ..ThermalSettings::from_array(thermal) },
            first_edge_c,
            last_edge_c,
            t_min_c,
            t_max_c,
            period_s,
            axes: Axis::array(&axes_of[number..][..axes]),
            cells: &cells[number..][..axes * count],
        }).collect();
        let signature = signature.as_flattened();
        let key_id = if signature.is_empty() { 0 } else { key_id };
        let info = Info { serial: &serial, table_crc, continuous, security_counter, key_id, signature };
        let mut bytes = Box::new(AlignedBytes([0xee; 20_000]));
        let len = encode(&info, &written, &mut bytes.0).unwrap();
        let image = Image::read(&bytes.0).unwrap();
        prop_assert_eq!(image.bytes().len(), len);
        prop_assert_eq!(image.info(), &info);
        prop_assert_eq!((image.channels(), image.axes()), shape);
        for (number, channel) in written.iter().enumerate() {
            let read = image.channel(number).unwrap();
            let numbers = |c: &Channel| {
                let temps = [c.first_edge_c, c.last_edge_c, c.t_min_c, c.t_max_c, c.period_s];
                c.thermal.to_array().into_iter().chain(temps).map(f32::to_bits).collect::<Vec<_>>()
            };
            prop_assert_eq!(numbers(&read), numbers(channel));
            let axes = |c: &Channel| c.axes.map(|axis| axis.map(axis_bits));
            prop_assert_eq!(axes(&read), axes(channel));
            prop_assert_eq!(bits(read.cells), bits(channel.cells));
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
