//! Images with history terms and programs compiled for more or fewer of them.

mod common;

use common::{CELLS, PLAYS, SLOW_PART, example, example_with, example_with_history};
use tempco::{Compensator, Interval, Play, SlowPart, Status, Table, Thermal, ThermalSettings};
use tempco_image::{Image, ImageError};

fn expected() -> Table<'static, 1> {
    let thermal = Thermal::new(ThermalSettings::DEFAULT).unwrap();
    let cells = CELLS.as_chunks::<1>().0;
    let table = Table::new(thermal, -40.0, 80.0, cells).unwrap();
    table.calibrated(-35.0, 75.0).unwrap()
}

#[test]
fn the_terms_of_the_image_are_those_of_the_table() {
    let (bytes, _) = example_with_history();
    let image = Image::read(&bytes.0).unwrap();
    let with_history = expected().with_history(PLAYS, [SLOW_PART]).unwrap();
    assert_eq!(image.table::<1, 2, 1>(0), Ok(with_history));
    assert_eq!(image.tables::<1, 1, 2, 1>(), Ok([with_history]));
    assert_eq!(image.validate(), Ok(()));
}

/// Whether a program that has so many terms takes the image: it must not leave any out.
fn takes<const PLAYS: usize, const SLOW: usize>(image: &Image) {
    let (plays, slow_parts) = image.history();
    let expected = if plays <= PLAYS && slow_parts <= SLOW {
        Ok(())
    } else {
        Err(ImageError::History { plays, slow_parts })
    };
    assert_eq!(image.table::<1, PLAYS, SLOW>(0).map(drop), expected);
    assert_eq!(image.tables::<1, 1, PLAYS, SLOW>().map(drop), expected);
}

#[test]
fn terms_that_the_program_does_not_have_are_refused() {
    for plays in 0..=2 {
        for slow_parts in 0..=1 {
            let (bytes, _) = example_with(&PLAYS[..plays], &[SLOW_PART][..slow_parts]);
            let image = Image::read(&bytes.0).unwrap();
            assert_eq!(image.history(), (plays, slow_parts));
            takes::<0, 0>(&image);
            takes::<1, 0>(&image);
            takes::<2, 0>(&image);
            takes::<0, 1>(&image);
            takes::<1, 1>(&image);
            takes::<2, 1>(&image);
        }
    }
}

/// Biases over a cycle of temperature.
fn biases<const PLAYS: usize, const SLOW: usize>(table: &Table<1, PLAYS, SLOW>) -> Vec<u32> {
    let second = Interval::new(table.thermal(), 1.0);
    let mut unit = Compensator::new(table);
    unit.start(25.0);
    let temps_c = (0..2400).map(|s: i32| 10.0 + 0.05 * (s - 1200).abs() as f32);
    let bias = temps_c.map(|temp_c| {
        let out = unit.step(&second, temp_c, [0.0]);
        assert!(!out.status.contains(Status::TEMPERATURE_INVALID));
        out.bias[0].to_bits()
    });
    bias.collect()
}

#[test]
fn terms_that_the_image_does_not_have_make_no_difference() {
    let (bytes, _) = example();
    let image = Image::read(&bytes.0).unwrap();
    let table = image.table::<1, 2, 1>(0).unwrap();
    let no_play = Play {
        half_width_c: 0.0,
        gain: [0.0],
    };
    let no_slow_part = SlowPart {
        tau_s: ThermalSettings::DEFAULT.tau_s,
        limit_c: 0.0,
        gain: [0.0],
    };
    assert_eq!(table.history().plays(), &[no_play; 2]);
    assert_eq!(table.history().slow_parts(), &[no_slow_part]);
    assert_eq!(biases(&table), biases(&expected()));

    let (bytes, _) = example_with(&PLAYS[..1], &[]);
    let image = Image::read(&bytes.0).unwrap();
    let fewer = biases(&image.table::<1, 1, 0>(0).unwrap());
    assert_eq!(biases(&image.table::<1, 2, 1>(0).unwrap()), fewer);
    assert_ne!(biases(&expected()), fewer);
}
