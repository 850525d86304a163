//! Images, their store, the fault log and the offsets.

use core::hint::black_box;

use embedded_storage::nor_flash::NorFlash;
use tempco::{Terms, ThermalSettings};
use tempco_image::{AlignedBytes, Axis, Channel, Fit, Image, ImageError, Info, Unit, encode};
use tempco_store::{Checked, FaultLog, Numbers, Offsets, Region, Store, StoreError};

use super::flash::{RamFlash, SECTOR};

const CHANNELS: usize = 1;
const AXES: usize = 3;
const CODES: usize = 4;
const SERIAL: &str = "SN7";
const TABLE_CRC: u32 = 7;

/// The slots, the log and the offsets.
const REGIONS: [Region; 4] = [region(0), region(1), region(2), region(3)];

const fn region(number: u32) -> Region {
    Region {
        start: 2 * SECTOR * number,
        len: 2 * SECTOR,
    }
}

type Buffer = AlignedBytes<512>;

/// Updates a table twice, boots, rolls back, records faults and keeps offsets.
///
/// # Errors
/// None, unless something is broken.
#[inline(never)]
pub fn stores() -> Result<(), StoreError> {
    let mut flash = RamFlash::new();
    let flash = black_box(&mut flash);
    let [a, b, faults, offsets] = black_box(REGIONS);
    tables(flash, a, b)?;
    log(flash, faults)?;
    biases(flash, offsets)
}

#[inline(never)]
fn tables(flash: &mut RamFlash, a: Region, b: Region) -> Result<(), StoreError> {
    let mut image: Buffer = AlignedBytes([0xff; 512]);
    let len = write(&mut image).map_err(StoreError::Image)?;
    let image = image.0.get(..len).ok_or(StoreError::Length)?;
    let mut buffer: Buffer = AlignedBytes([0; 512]);
    let mut store = Store::new(flash, a, b)?;
    for _ in 0..2 {
        _ = black_box(store.boot(flash, &mut buffer.0, accept));
        update(&mut store, flash, image, &mut buffer)?;
    }
    let boot = store.boot(flash, &mut buffer.0, accept);
    let active = boot.active.ok_or(StoreError::Empty)?;
    for _ in 0..2 {
        if let Checked::Bad(_, error) = store.check(flash, black_box(100)) {
            return Err(error);
        }
    }
    store.reload(flash, black_box(active), &mut buffer.0, accept)?;
    store.select(flash, !active.slot, &mut buffer.0, accept)
}

#[inline(never)]
fn update<F: NorFlash>(
    store: &mut Store,
    flash: &mut F,
    image: &[u8],
    buffer: &mut Buffer,
) -> Result<(), StoreError> {
    let len = image.len() as u32;
    let slot = store.begin(flash, len)?;
    let mut offset = 0;
    for chunk in image.chunks(64) {
        // Twice, as over a link that loses answers.
        store.write(flash, black_box(offset), chunk)?;
        offset = store.write(flash, black_box(offset), chunk)?;
    }
    _ = black_box(store.expected());
    store.commit(flash, len, Store::crc(image), &mut buffer.0, accept)?;
    _ = black_box(store.spare(flash));
    store.select(flash, slot, &mut buffer.0, accept)
}

/// As a unit accepts an image, and all that can be asked of one besides.
fn accept(image: &Image) -> Result<(), ImageError> {
    image.expect_serial(black_box(SERIAL))?;
    image.validate()?;
    image.check_block(black_box(0))?;
    let tables = image.tables::<CHANNELS, AXES>()?;
    _ = black_box(tables);
    let fit = Fit {
        unit: Unit::PulsesPerS,
        scale_factor_arcsec: 1.0,
        max_bias: 100.0,
    };
    image.expect_fit(black_box(&[fit; CHANNELS * AXES]))
}

#[inline(never)]
fn write(image: &mut Buffer) -> Result<usize, ImageError> {
    let cell = const { Terms::new([0.1], [0.5]) };
    let axis = Axis {
        play_gains: [0.1, 0.2],
        ..Axis::new(Unit::PulsesPerS)
    };
    let channel = Channel {
        thermal: ThermalSettings::DEFAULT,
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -35.0,
        t_max_c: 75.0,
        period_s: 0.1,
        axes: Axis::array(&[axis; AXES]),
        cells: &[cell; 2 * AXES],
    };
    let info = Info {
        serial: SERIAL,
        table_crc: TABLE_CRC,
        continuous: true,
        security_counter: 1,
        key_id: 2,
        signature: &[3; 48],
    };
    encode(&black_box(info), &[black_box(channel)], &mut image.0)
}

#[inline(never)]
fn log(flash: &mut RamFlash, region: Region) -> Result<(), StoreError> {
    let mut log = FaultLog::<CODES>::open(flash, region)?;
    log.at_least_boot(black_box(7));
    for second in 0..100 {
        log.record(flash, black_box(1), second, black_box(0))?;
    }
    log.flush(flash)?;
    _ = black_box((log.faults(), log.boot(), log.erasures(), log.is_worn()));
    Ok(())
}

#[inline(never)]
fn biases(flash: &mut RamFlash, region: Region) -> Result<(), StoreError> {
    let mut offsets = Offsets::<AXES>::open(flash, region)?;
    for _ in 0..20 {
        offsets.set(flash, black_box(TABLE_CRC), black_box([0.5; AXES]))?;
    }
    let numbers = Numbers {
        boot: 1,
        session: 256,
        resets: 0,
    };
    offsets.set_numbers(flash, black_box(numbers))?;
    _ = black_box((offsets.numbers(), offsets.erasures()));
    _ = black_box((offsets.table_crc(), offsets.of(black_box(TABLE_CRC))));
    Ok(())
}
