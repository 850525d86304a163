//! Images and stores for the tests.
#![allow(dead_code, reason = "each test program uses its share")]

pub(crate) mod flash;

use embedded_storage::nor_flash::NorFlash;
use flash::Flash;
use tempco::{Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Axis, CRC, Channel, Image, ImageError, Info, Unit, encode};
use tempco_store::{Boot, Region, Slot, Store, StoreError};

pub(crate) const SERIAL: &str = "SN7";

/// An image of a number of cells, marked by `version`, and its length.
pub(crate) fn image_of(serial: &str, cells: usize, version: u32) -> Vec<u8> {
    let cells = vec![Terms::new([version as f32, 0.0, 0.0], [0.5, 0.0]); cells];
    let channel = Channel {
        thermal: ThermalSettings::DEFAULT,
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -35.0,
        t_max_c: 75.0,
        period_s: 0.0,
        axes: Axis::array(&[Axis::new(Unit::Dph)]),
        cells: &cells,
    };
    let info = Info {
        serial,
        table_crc: version,
        continuous: true,
        ..Info::default()
    };
    let mut bytes = vec![0; 8192];
    let len = encode(&info, &[channel], &mut bytes).unwrap();
    bytes.truncate(len);
    bytes
}

pub(crate) fn image(cells: usize, version: u32) -> Vec<u8> {
    image_of(SERIAL, cells, version)
}

pub(crate) fn accept(image: &Image) -> Result<(), ImageError> {
    image.expect_serial(SERIAL)?;
    image.tables::<1, 1>().map(drop)
}

pub(crate) type Buffer = AlignedBytes<4096>;

pub(crate) const BLANK: Buffer = AlignedBytes([0; 4096]);

/// A store over a whole flash, A in its first half, B in its second.
pub(crate) fn store<F: NorFlash>(flash: &F) -> Store {
    let len = flash.capacity() as u32 / 2;
    let a = Region { start: 0, len };
    let b = Region { start: len, len };
    Store::new(flash, a, b).unwrap()
}

/// A power-on: a new store, booted.
pub(crate) fn boot<F: NorFlash>(flash: &mut F, buffer: &mut Buffer) -> (Store, Boot) {
    let mut store = store(flash);
    let boot = store.boot(flash, &mut buffer.0, accept);
    (store, boot)
}

/// The version of the table in use, which must be whole.
pub(crate) fn active_version(boot: &Boot, buffer: &Buffer) -> Option<u32> {
    let len = boot.active?.len;
    let image = Image::read(&buffer.0[..len]).expect("only what is whole is active");
    accept(&image).expect("only what was validated is active");
    Some(image.info().table_crc)
}

/// A whole update in chunks of 64 bytes, up to the selection.
pub(crate) fn update<F: NorFlash>(
    store: &mut Store,
    flash: &mut F,
    image: &[u8],
    buffer: &mut Buffer,
) -> Result<(), StoreError> {
    let slot = store_image(store, flash, image, buffer)?;
    store.select(flash, slot, &mut buffer.0, accept)
}

/// An image stored in chunks of 64 bytes, and where.
pub(crate) fn store_image<F: NorFlash>(
    store: &mut Store,
    flash: &mut F,
    image: &[u8],
    buffer: &mut Buffer,
) -> Result<Slot, StoreError> {
    let slot = store.begin(flash, image.len() as u32)?;
    let mut offset = 0;
    for chunk in image.chunks(64) {
        offset = store.write(flash, offset, chunk)?;
    }
    let len = image.len() as u32;
    store.commit(flash, len, CRC.checksum(image), &mut buffer.0, accept)?;
    Ok(slot)
}

/// A flash in which version 1 was booted from A and version 2 from B.
pub(crate) fn with_two_versions<const W: usize, const E: usize>(
    sectors: usize,
    cells: usize,
) -> Flash<'static, W, E> {
    let mut flash = Flash::new(sectors);
    let mut buffer = BLANK;
    for version in [1, 2] {
        let (mut store, _) = boot(&mut flash, &mut buffer);
        update(&mut store, &mut flash, &image(cells, version), &mut buffer).unwrap();
    }
    flash
}
