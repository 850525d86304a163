//! The offsets over resets and power cuts.

mod common;

use std::cell::Cell;

use common::flash::{CUTS, Flash, Memory};
use embedded_storage::nor_flash::NorFlash;
use tempco_store::{FaultLog, Numbers, Offsets, Region, StoreError};

const AXES: usize = 3;
const TABLE: u32 = 0x1234_5678;
type Small = Flash<'static, 8, 512>;

const REGION: Region = Region {
    start: 512,
    len: 1024,
};

fn open<F: NorFlash>(flash: &mut F, len: u32) -> Offsets<AXES> {
    let region = Region { len, ..REGION };
    Offsets::open(flash, region).unwrap()
}

/// The offsets of a number: different on every axis.
fn number(n: u32) -> [f32; AXES] {
    [n, n + 1000, n + 2000].map(|n| n as f32)
}

#[test]
fn offsets_survive_resets() {
    let mut flash = Small::new(4);
    assert_eq!(open(&mut flash, 1024).table_crc(), None);
    assert_eq!(open(&mut flash, 1024).of(0), [0.0; AXES]);
    for n in 1..100 {
        let mut offsets = open(&mut flash, 1024);
        offsets.set(&mut flash, TABLE, number(n)).unwrap();
        assert_eq!(offsets.of(TABLE), number(n));
        assert_eq!(open(&mut flash, 1024).of(TABLE), number(n));
    }
    // Whatever is finite comes back to the bit.
    for value in [-0.0, f32::MIN, f32::MIN_POSITIVE / 2.0] {
        open(&mut flash, 1024)
            .set(&mut flash, TABLE, [value; AXES])
            .unwrap();
        let found = open(&mut flash, 1024).of(TABLE);
        assert_eq!(found.map(f32::to_bits), [value.to_bits(); AXES]);
    }
    assert_eq!(flash.overwrites, 0);
}

#[test]
fn offsets_of_another_table_are_zero() {
    let mut flash = Small::new(4);
    let mut offsets = open(&mut flash, 1024);
    offsets.set(&mut flash, TABLE, number(1)).unwrap();
    for mut offsets in [offsets, open(&mut flash, 1024)] {
        assert_eq!(offsets.table_crc(), Some(TABLE));
        assert_eq!(offsets.of(TABLE ^ 1), [0.0; AXES]);
        offsets.set(&mut flash, TABLE ^ 1, number(2)).unwrap();
        assert_eq!(offsets.of(TABLE ^ 1), number(2));
        assert_eq!(offsets.of(TABLE), [0.0; AXES]);
        offsets.set(&mut flash, TABLE, number(1)).unwrap();
    }
}

#[test]
fn offsets_that_are_not_finite_are_refused() {
    let mut flash = Small::new(4);
    open(&mut flash, 1024)
        .set(&mut flash, TABLE, number(1))
        .unwrap();
    let operations = flash.operations;
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..AXES {
            let mut offsets = open(&mut flash, 1024);
            let mut values = number(2);
            values[axis] = value;
            let refused = offsets.set(&mut flash, TABLE, values);
            assert_eq!(refused, Err(StoreError::NotFinite));
            assert_eq!(offsets.of(TABLE), number(1));
        }
    }
    assert_eq!(flash.operations, operations);
}

/// Offsets with their table, and the numbers.
type State = (Option<(u32, [f32; AXES])>, Option<Numbers>);

/// A state after the next operation: numbers are set and offsets, in turn.
fn after(before: State, n: u32) -> State {
    if n.is_multiple_of(2) {
        let numbers = Numbers {
            boot: n,
            session: 256 * n,
            resets: n / 2,
        };
        (before.0, Some(numbers))
    } else {
        (Some((n, number(n))), before.1)
    }
}

/// All single cuts and pairs of cuts over two turns of the halves: everything is as before what was
/// being set, or as it was to be.
fn cuts_leave_old_or_new<const W: usize, const E: usize>(len: u32, sets: u32) {
    let pairs = Cell::new(0);
    let mut start = Flash::<W, E>::new((512 + len as usize) / E);
    let read = |memory: &Memory<W, E>| {
        let offsets = open(&mut Flash::with(memory), len);
        let of = |crc| (crc, offsets.of(crc));
        (offsets.table_crc().map(of), offsets.numbers())
    };
    let set = |flash: &mut Flash<W, E>, n: u32| {
        let mut offsets = open(flash, len);
        match after((None, None), n) {
            (_, Some(numbers)) => offsets.set_numbers(flash, numbers).unwrap(),
            _ => offsets.set(flash, n, number(n)).unwrap(),
        }
    };
    let mut before: State = (None, None);
    for n in 1..=sets {
        let old = before;
        let new = after(old, n);
        let mut flash = Flash::watched(&start.memory, |memory, at, cut| {
            let between = read(memory);
            assert!(between == old || between == new, "{n} {at} {cut:?}");
            let last = after(between, n + 100);
            let mut again = Flash::watched(memory, |memory: &Memory<W, E>, _, _| {
                pairs.set(pairs.get() + 1);
                let found = read(memory);
                assert!(found == between || found == last, "{n} {at} {cut:?}");
            });
            set(&mut again, n + 100);
            assert_eq!(again.overwrites, 0);
            assert_eq!(read(&again.memory), last);
        });
        set(&mut flash, n);
        assert_eq!(flash.overwrites, 0);
        start = Flash::with(&flash.memory);
        assert_eq!(read(&start.memory), new);
        before = new;
    }
    println!("words of {W}: {} pairs", pairs.get());
    assert!(pairs.get() > 2_000, "{}", pairs.get());
}

#[test]
fn a_power_cut_leaves_the_old_offsets_or_the_new_ones() {
    cuts_leave_old_or_new::<4, 512>(1024, 26);
    cuts_leave_old_or_new::<8, 512>(1024, 26);
    cuts_leave_old_or_new::<32, 512>(1024, 18);
    // Halves of more than a sector, over whose ends entries lie.
    cuts_leave_old_or_new::<8, 64>(512, 14);
}

#[test]
fn a_failing_flash_is_said_and_the_old_offsets_stay() {
    let mut flash = Small::new(4);
    open(&mut flash, 1024)
        .set(&mut flash, TABLE, number(1))
        .unwrap();
    for cut in CUTS {
        flash.fails_after = Some((flash.operations, cut));
        let mut offsets = open(&mut flash, 1024);
        assert!(offsets.set(&mut flash, TABLE, number(2)).is_err());
        assert_eq!(offsets.of(TABLE), number(1));
    }
}

/// Be they of a program for more axes or for less.
#[test]
fn offsets_of_another_number_of_axes_are_none() {
    let mut flash = Small::new(4);
    open(&mut flash, 1024)
        .set(&mut flash, TABLE, number(1))
        .unwrap();
    assert_eq!(
        Offsets::<2>::open(&mut flash, REGION).unwrap().table_crc(),
        None
    );
    let mut six = Offsets::<6>::open(&mut flash, REGION).unwrap();
    assert_eq!(six.table_crc(), None);
    six.set(&mut flash, TABLE, [6.0; 6]).unwrap();
    assert_eq!(open(&mut flash, 1024).table_crc(), None);
    let six = Offsets::<6>::open(&mut flash, REGION).unwrap();
    assert_eq!(six.of(TABLE), [6.0; 6]);
}

/// Neither garbage nor what another journal has left in the region.
#[test]
fn what_is_not_offsets_is_none() {
    let mut flash = Small::new(4);
    for bit in 0..8 * 2048 {
        if bit % 3 != 0 {
            flash.flip(bit);
        }
    }
    assert_eq!(open(&mut flash, 1024).table_crc(), None);
    let mut log = FaultLog::<3>::open(&mut flash, REGION).unwrap();
    log.record(&mut flash, 0, 0, 0).unwrap();
    let mut offsets = open(&mut flash, 1024);
    assert_eq!(offsets.table_crc(), None);
    offsets.set(&mut flash, TABLE, number(1)).unwrap();
    assert_eq!(open(&mut flash, 1024).of(TABLE), number(1));
    for len in [512, 1536, 100] {
        let region = Region { len, ..REGION };
        let error = Offsets::<AXES>::open(&mut flash, region).err();
        assert_eq!(error, Some(StoreError::Region), "{len}");
    }
}
