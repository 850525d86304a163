//! The set-up functions, from Rust: what they refuse, and that what they make is the core's.
#![allow(unsafe_code)]

use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use tempco::{Status, Table, Terms, ThermalSettings, Validity};
use tempco_c::{
    Axis, Channel, Error, ImageInfo, axes2, axes3, image_info, raw_status, status_name, strerror,
    validity,
};
use tempco_image::{AlignedBytes, Info, Unit, encode};

/// Two cells of three axes, which do not meet.
static CELLS: [[Terms; 3]; 2] = [
    [Terms::new([0.1, 0.2, 0.3], [0.5, 0.25]); 3],
    [Terms::new([0.4, 0.5, 0.6], [0.1, 0.75]); 3],
];
const GAINS: [[f32; 2]; 3] = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
const SCALE_ARCSEC: f32 = 1.5;

fn thermal() -> ThermalSettings {
    ThermalSettings {
        half_width1_c: 1.0,
        half_width2_c: 2.0,
        ..ThermalSettings::DEFAULT
    }
}

fn channel() -> Channel {
    let axis = |play_gains| Axis {
        scale_factor_arcsec: SCALE_ARCSEC,
        row_noise: 0.0,
        row_noise_interval_s: 0.0,
        rezero_limit: 0.0,
        play_gains,
    };
    let [x, y, z] = GAINS.map(axis);
    let none = axis([0.0; 2]);
    Channel {
        thermal: thermal(),
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -30.0,
        t_max_c: 70.0,
        period_s: 1.0,
        cell_count: 2,
        axis_count: 3,
        axes: [x, y, z, none, none, none],
        cells: CELLS.as_ptr().cast(),
    }
}

/// The same as an image, for ever.
fn image(continuous: bool) -> &'static mut [u8] {
    let axis = |play_gains| tempco_image::Axis {
        scale_factor_arcsec: SCALE_ARCSEC,
        play_gains,
        ..tempco_image::Axis::new(Unit::Dph)
    };
    let of_c = channel();
    let of_image = tempco_image::Channel {
        thermal: thermal(),
        first_edge_c: of_c.first_edge_c,
        last_edge_c: of_c.last_edge_c,
        t_min_c: of_c.t_min_c,
        t_max_c: of_c.t_max_c,
        period_s: of_c.period_s,
        axes: tempco_image::Axis::array(&GAINS.map(axis)),
        cells: CELLS.as_flattened(),
    };
    let info = Info {
        serial: "12345678901234567890123456789012",
        table_crc: 0x1234_5678,
        continuous,
        ..Info::default()
    };
    let place = Box::leak(Box::new(AlignedBytes([0xff; 1024])));
    let length = encode(&info, &[of_image], &mut place.0).unwrap();
    &mut place.0[..length]
}

fn from_image(image: &'static [u8], channel: u32) -> Result<Table<'static, 3>, i32> {
    let mut table = MaybeUninit::uninit();
    let (bytes, length) = (image.as_ptr().cast(), image.len());
    // SAFETY: the image is there for ever.
    match unsafe { axes3::table_from_image(table.as_mut_ptr(), bytes, length, channel) } {
        // SAFETY: it says that it made the table.
        0 => Ok(unsafe { table.assume_init() }),
        code => Err(code),
    }
}

fn from_channel(channel: &Channel) -> Result<Table<'static, 3>, i32> {
    let mut table = MaybeUninit::uninit();
    // SAFETY: the cells are there for ever.
    match unsafe { axes3::table_from_channel(table.as_mut_ptr(), channel) } {
        // SAFETY: it says that it made the table.
        0 => Ok(unsafe { table.assume_init() }),
        code => Err(code),
    }
}

#[test]
fn image_and_structure_give_the_table_of_the_core() {
    let table = from_image(image(false), 0).unwrap();
    assert_eq!(table.cells(), &CELLS);
    assert_eq!(table.thermal().settings(), &thermal());
    assert_eq!((table.t_min_c(), table.t_max_c()), (-30.0, 70.0));
    assert_eq!(table.play_gains(), &[[1.0, 3.0, 5.0], [2.0, 4.0, 6.0]]);
    let from_c = from_channel(&channel()).unwrap();
    assert_eq!(from_c, table);
    assert_eq!(from_c.cells().as_ptr(), CELLS.as_ptr(), "used in place");
}

#[test]
fn a_damaged_image_is_refused_by_its_code() {
    let spoilt = |at: usize, bits: u8| {
        let image = image(false);
        image[at] ^= bits;
        from_image(image, 0).unwrap_err()
    };
    let length = image(false).len();
    for (found, expected) in [
        (spoilt(0, 1), Error::Magic),
        (spoilt(8, 1), Error::Version),
        (spoilt(44, 1), Error::Crc),
        (spoilt(length - 20, 1), Error::Crc),
        (
            from_image(&image(false)[..length - 4], 0).unwrap_err(),
            Error::Short,
        ),
        (
            from_image(&image(false)[..40], 0).unwrap_err(),
            Error::Short,
        ),
        (from_image(&image(false)[..0], 0).unwrap_err(), Error::Short),
        (from_image(image(false), 1).unwrap_err(), Error::Shape),
        (from_image(image(true), 0).unwrap_err(), Error::Jump),
    ] {
        assert_eq!(found, expected as i32, "{expected:?}");
    }
}

#[test]
fn a_bad_structure_is_refused_by_its_code() {
    static BAD: [[Terms; 3]; 2] = [[Terms::new([f32::NAN], [0.0]); 3]; 2];
    type Change = fn(&mut Channel);
    let changes: [(Change, Error); 9] = [
        (|of| of.axis_count = 2, Error::Shape),
        (|of| of.cell_count = 0, Error::Cells),
        (|of| of.cell_count = 1025, Error::Cells),
        (|of| of.cells = null(), Error::Null),
        (
            |of| of.cells = of.cells.cast::<u8>().wrapping_add(1).cast(),
            Error::Alignment,
        ),
        (|of| of.cells = BAD.as_ptr().cast(), Error::Coefficient),
        (|of| of.thermal.tau_s = 0.0, Error::Setting),
        (|of| of.t_max_c = 81.0, Error::Setting),
        (
            |of| of.axes[2].play_gains[1] = f32::INFINITY,
            Error::Setting,
        ),
    ];
    for (change, expected) in changes {
        let mut channel = channel();
        change(&mut channel);
        assert_eq!(from_channel(&channel), Err(expected as i32), "{expected:?}");
    }
}

/// No set-up function follows a pointer to nothing, or one between words.
#[test]
fn bad_pointers_are_refused_everywhere() {
    let image = image(false);
    let (bytes, length) = (image.as_ptr().cast(), image.len());
    let mut table = MaybeUninit::uninit();
    let made = table.as_mut_ptr();
    let mut pulses = MaybeUninit::uninit();
    let null_code = Error::Null as i32;
    // SAFETY: what is not null is there for ever.
    unsafe {
        assert_eq!(
            axes3::table_from_image(null_mut(), bytes, length, 0),
            null_code
        );
        assert_eq!(axes3::table_from_image(made, null(), length, 0), null_code);
        assert_eq!(axes3::table_from_channel(made, null()), null_code);
        assert_eq!(axes3::table_from_channel(null_mut(), &channel()), null_code);
        assert_eq!(axes3::interval_init(null_mut(), made, 1.0), {
            axes3::table_from_image(made, bytes, length, 0);
            null_code
        });
        let mut interval = MaybeUninit::uninit();
        assert_eq!(
            axes3::interval_init(interval.as_mut_ptr(), null(), 1.0),
            null_code
        );
        assert_eq!(axes3::thermal_init(null_mut(), made, 1), null_code);
        assert_eq!(axes3::ramps_init(null_mut()), null_code);
        assert_eq!(axes3::pulse_ramps_init(null_mut()), null_code);
        assert_eq!(axes3::pulses_init(pulses.as_mut_ptr(), null()), null_code);
        assert_eq!(axes3::compensator_init(null_mut(), made), null_code);
        assert_eq!(image_info(null_mut(), bytes, length), null_code);

        let between = bytes.cast::<u8>().add(1).cast();
        let alignment = Error::Alignment as i32;
        assert_eq!(
            axes3::table_from_image(made, between, length - 1, 0),
            alignment
        );
        let between = made.cast::<u8>().add(1).cast();
        assert_eq!(
            axes3::table_from_image(between, bytes, length, 0),
            alignment
        );
        let too_long = axes3::table_from_image(made, bytes, usize::MAX, 0);
        assert_eq!(too_long, Error::Short as i32);
        let mut of_two = MaybeUninit::uninit();
        let other = axes2::table_from_image(of_two.as_mut_ptr(), bytes, length, 0);
        assert_eq!(other, Error::Shape as i32);
    }
}

#[test]
fn an_image_says_whose_it_is_and_in_which_units() {
    let image = image(false);
    let mut info = MaybeUninit::<ImageInfo>::uninit();
    // SAFETY: the image is there, and it says that it filled in the structure.
    let info = unsafe {
        assert_eq!(
            image_info(info.as_mut_ptr(), image.as_ptr().cast(), image.len()),
            0
        );
        info.assume_init()
    };
    assert_eq!(&info.serial, b"12345678901234567890123456789012\0");
    assert_eq!(
        info.units,
        [
            Unit::Dph.code(),
            Unit::Dph.code(),
            Unit::Dph.code(),
            0,
            0,
            0
        ]
    );
    assert_eq!(
        info.scale_factors_arcsec[..4],
        [SCALE_ARCSEC, SCALE_ARCSEC, SCALE_ARCSEC, 0.0]
    );
    assert_eq!(
        (info.table_crc, info.channels, info.axes),
        (0x1234_5678, 1, 3)
    );
}

fn text(pointer: *const std::ffi::c_char) -> &'static str {
    // SAFETY: constant strings.
    unsafe { CStr::from_ptr(pointer) }.to_str().unwrap()
}

#[test]
fn every_code_and_every_flag_has_words() {
    for (error, _) in Error::ALL {
        assert_eq!(
            text(strerror(*error as i32)),
            error.message().to_str().unwrap()
        );
    }
    assert_eq!(text(strerror(0)), "no error");
    for code in [1, -14, i32::MIN, i32::MAX] {
        assert_eq!(text(strerror(code)), "unknown error");
    }
    for (flag, name) in Status::NAMES {
        assert_eq!(text(status_name(flag.bits())), name);
        assert_eq!(text(status_name(flag.bits() | 0x8000)), name);
        let of_core = flag.validity();
        assert_eq!(
            validity(flag.bits()),
            if of_core == Validity::Invalid { 2 } else { 1 }
        );
    }
    assert_eq!((text(status_name(0)), validity(0)), ("ok", 0));
    assert_eq!(text(status_name(0x8000)), "unknown");
}

#[test]
fn samples_that_are_no_numbers_are_seen() {
    let of = |raw: &[f32]| {
        // SAFETY: a slice.
        unsafe { raw_status(raw.as_ptr(), raw.len()) }
    };
    assert_eq!(of(&[1.0, -2.0, 3e38]), 0);
    assert_eq!(of(&[1.0, f32::NAN, 3.0]), Status::RAW_INVALID.bits());
    assert_eq!(
        of(&[1.0, 2.0, f32::NEG_INFINITY]),
        Status::RAW_INVALID.bits()
    );
}
