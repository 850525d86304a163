//! Functions without axes.

use core::ffi::{CStr, c_char};

use tempco::{Status, Validity};
use tempco_image::Axis;

use crate::error::code;
use crate::{ABI_VERSION, Error, ImageInfo, place, table};

/// `tempco_abi_version`: the version that the archive was made with.
#[unsafe(export_name = "tempco_abi_version")]
pub extern "C" fn abi_version() -> u32 {
    ABI_VERSION
}

/// `tempco_strerror`: a code of [`Error`] in words; of 0 and of codes that are none, too.
#[unsafe(export_name = "tempco_strerror")]
pub extern "C" fn strerror(code: i32) -> *const c_char {
    let known = Error::ALL.iter().find(|(error, _)| *error as i32 == code);
    let message = match known {
        Some((error, _)) => error.message(),
        None if code == 0 => c"no error",
        None => c"unknown error",
    };
    message.as_ptr()
}

/// Bytes of the longest name of a flag, with its end.
const NAME_LEN: usize = 20;

/// The names of the flags as C has them.
static NAMES: [[u8; NAME_LEN]; Status::NAMES.len()] = {
    let mut names = [[0; NAME_LEN]; Status::NAMES.len()];
    let mut flag = 0;
    while flag < names.len() {
        let name = Status::NAMES[flag].1.as_bytes();
        assert!(name.len() < NAME_LEN);
        let mut at = 0;
        while at < name.len() {
            names[flag][at] = name[at];
            at += 1;
        }
        flag += 1;
    }
    names
};

/// `tempco_status_name`: the name of the lowest flag that is set.
#[unsafe(export_name = "tempco_status_name")]
pub extern "C" fn status_name(status: u16) -> *const c_char {
    let name: &CStr = if status == 0 { c"ok" } else { c"unknown" };
    match NAMES.get(status.trailing_zeros() as usize) {
        Some(name) => name.as_ptr().cast(),
        None => name.as_ptr(),
    }
}

/// `tempco_validity`: 0 for valid, 1 for degraded, 2 for invalid.
#[unsafe(export_name = "tempco_validity")]
pub extern "C" fn validity(status: u16) -> i32 {
    match Status::from_bits(status).validity() {
        Validity::Valid => 0,
        Validity::Degraded => 1,
        Validity::Invalid => 2,
    }
}

/// `tempco_raw_status`: whether gyro samples are numbers.
///
/// # Safety
/// `raw` points to `count` numbers.
#[unsafe(export_name = "tempco_raw_status")]
pub unsafe extern "C" fn raw_status(raw: *const f32, count: usize) -> u16 {
    // SAFETY: the caller vouches for it.
    let raw = unsafe { core::slice::from_raw_parts(raw, count) };
    Status::of_raw(raw).bits()
}

/// `tempco_image_info`: what an image says of itself.
///
/// # Safety
/// `image` points to `length` bytes, `info` to such a structure, unless they are refused.
#[unsafe(export_name = "tempco_image_info")]
pub unsafe extern "C" fn image_info(info: *mut ImageInfo, image: *const u32, length: usize) -> i32 {
    // SAFETY: the caller vouches for it.
    code(unsafe { info_of(image, length).and_then(|of_image| place::put(info, of_image)) })
}

/// # Safety
/// As of [`image_info`].
unsafe fn info_of(image: *const u32, length: usize) -> Result<ImageInfo, Error> {
    // SAFETY: the caller vouches for it.
    let image = unsafe { table::read(image, length) }?;
    let of_image = image.info();
    let mut info = ImageInfo {
        serial: [0; _],
        units: [0; _],
        reserved: 0,
        scale_factors_arcsec: [0.0; _],
        table_crc: of_image.table_crc,
        channels: image.channels() as u32,
        axes: image.axes() as u32,
    };
    // A byte less than there is room for: the last one ends the text.
    for (to, from) in info.serial.iter_mut().zip(of_image.serial.bytes()) {
        *to = from;
    }
    let mut places = info.units.iter_mut().zip(&mut info.scale_factors_arcsec);
    for channel in 0..image.channels() {
        let axes: [Option<Axis>; _] = image.channel(channel)?.axes;
        for (axis, (unit, scale_factor_arcsec)) in axes.iter().flatten().zip(&mut places) {
            *unit = axis.unit.code();
            *scale_factor_arcsec = axis.scale_factor_arcsec;
        }
    }
    Ok(info)
}
