//! Power cuts at every operation, and at every operation of what is tried after the first cut:
//! the unit comes up with the old table or the new one, whole and validated, and never with none.

mod common;

use std::cell::{Cell, RefCell};

use common::flash::{Flash, Memory};
use common::{BLANK, accept, active_version, boot, image, store_image, update, with_two_versions};
use tempco_store::{Slot, StoreError};

/// What is done when power fails.
#[derive(Clone, Copy, Debug)]
enum Action {
    /// An update to the table of this version.
    Update(u32),
    /// The table of this version is stored, and not selected.
    Store(u32),
    /// The table not in use is taken.
    RollBack,
}

/// Boots, does it, and returns the versions before and after.
fn act<const W: usize, const E: usize>(
    flash: &mut Flash<W, E>,
    action: Action,
    cells: usize,
) -> (u32, Result<u32, StoreError>) {
    let mut buffer = BLANK;
    let (mut store, before) = boot(flash, &mut buffer);
    let old = active_version(&before, &buffer).expect("a table before");
    let slot = before.active.expect("a table before").slot;
    let done = match action {
        Action::Update(version) => {
            let image = image(cells, version);
            update(&mut store, flash, &image, &mut buffer).map(|()| version)
        }
        Action::Store(version) => {
            let image = image(cells, version);
            store_image(&mut store, flash, &image, &mut buffer).map(|_| old)
        }
        Action::RollBack => store.select(flash, !slot, &mut buffer.0, accept).map(|()| {
            tempco_image::Image::read(&buffer.0)
                .unwrap()
                .info()
                .table_crc
        }),
    };
    (old, done)
}

fn version_of<const W: usize, const E: usize>(memory: &Memory<W, E>) -> u32 {
    let mut flash: Flash<W, E> = Flash::with(memory);
    let mut buffer = BLANK;
    let (_, boot) = boot(&mut flash, &mut buffer);
    active_version(&boot, &buffer).expect("a table is active after every cut")
}

/// All cuts of the first action, and after each all cuts of the second; returns how many.
fn enumerate<const W: usize, const E: usize>(
    sectors: usize,
    cells: usize,
    first: Action,
    second: Action,
) -> (u64, u64) {
    let (singles, pairs) = (Cell::new(0), Cell::new(0));
    let start = with_two_versions::<W, E>(sectors, cells);
    let seen = RefCell::new([false; 4]);
    let mut flash = Flash::<W, E>::watched(&start.memory, |memory, at, cut| {
        singles.set(singles.get() + 1);
        let came_up = version_of(memory);
        let allowed = match first {
            Action::Update(new) => [2, new],
            Action::Store(_) => [2, 2],
            Action::RollBack => [2, 1],
        };
        assert!(
            allowed.contains(&came_up),
            "{first:?} {at} {cut:?}: {came_up}"
        );
        seen.borrow_mut()[came_up as usize] = true;

        // What the second action would lead to, if power does not fail again.
        let mut whole = Flash::<W, E>::with(memory);
        let (old, done) = act(&mut whole, second, cells);
        assert_eq!(old, came_up);
        let new = match (second, done) {
            (_, Ok(version)) => version,
            // The slot was being written when power failed: there is nothing to go back to.
            (Action::RollBack, Err(_)) => old,
            (_, Err(error)) => panic!("{first:?} {at} {cut:?}: {error}"),
        };
        assert_eq!(version_of(&whole.memory), new);

        let mut again = Flash::<W, E>::watched(memory, |memory, at_again, cut_again| {
            pairs.set(pairs.get() + 1);
            let version = version_of(memory);
            assert!(
                version == old || version == new,
                "{first:?} {at} {cut:?}, {second:?} {at_again} {cut_again:?}: {version}"
            );
        });
        let _ = act(&mut again, second, cells);
        assert_eq!(again.overwrites, 0, "a word was programmed twice");
    });
    act(&mut flash, first, cells).1.unwrap();
    assert_eq!(flash.overwrites, 0);
    let last = version_of(&flash.memory);
    drop(flash);
    assert_eq!(last == 2, matches!(first, Action::Store(_)));
    assert!(seen.into_inner()[2], "the old table was never seen");
    (singles.into_inner(), pairs.into_inner())
}

fn enumerate_all<const W: usize, const E: usize>(sectors: usize, cells: usize) -> u64 {
    let mut total = 0;
    for (first, second) in [
        (Action::Update(3), Action::Update(3)),
        (Action::Update(3), Action::RollBack),
        (Action::RollBack, Action::Update(3)),
        (Action::RollBack, Action::RollBack),
        (Action::Store(3), Action::RollBack),
        (Action::RollBack, Action::Store(3)),
    ] {
        let (singles, pairs) = enumerate::<W, E>(sectors, cells, first, second);
        println!("words of {W}: {first:?} {second:?}: {singles} cuts, {pairs} pairs");
        total += singles + pairs;
    }
    total
}

/// The numbers of points are asserted so that they cannot shrink unseen.
#[test]
fn every_cut_and_pair_of_cuts_with_words_of_4_bytes() {
    assert!(enumerate_all::<4, 512>(4, 13) > 350_000);
}

#[test]
fn every_cut_and_pair_of_cuts_with_words_of_8_bytes() {
    assert!(enumerate_all::<8, 512>(4, 18) > 140_000);
}

#[test]
fn every_cut_and_pair_of_cuts_with_words_of_16_and_32_bytes() {
    assert!(enumerate_all::<16, 512>(4, 18) > 35_000);
    assert!(enumerate_all::<32, 512>(4, 18) > 10_000);
    // Slots of a single sector, as in large flashes.
    assert!(enumerate_all::<32, 1024>(2, 18) > 10_000);
}

/// Millions of points: `cargo test --release -p tempco-store -- --ignored`.
#[test]
#[ignore = "five million points; minutes in release"]
fn every_cut_and_pair_of_cuts_of_larger_images() {
    let mut points = enumerate_all::<4, 1024>(4, 54);
    points += enumerate_all::<8, 1024>(4, 54);
    points += enumerate_all::<8, 512>(8, 54);
    points += enumerate_all::<32, 1024>(8, 126);
    println!("{points} points");
    assert!(points > 5_000_000);
}

/// Many cuts in a row, each at a random operation: never none, and an update still works.
#[test]
fn any_number_of_cuts_in_a_row_leaves_a_table() {
    let mut random = 1_u64;
    let mut next = |bound: u64| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 33) % bound
    };
    for _ in 0..40 {
        let mut flash = with_two_versions::<8, 512>(4, 10);
        for version in 3..23 {
            let cut = common::flash::CUTS[next(4) as usize];
            flash.fails_after = Some((flash.operations + next(60) as u32, cut));
            let action = if next(3) == 0 {
                Action::RollBack
            } else {
                Action::Update(version)
            };
            let (old, _) = act(&mut flash, action, 10);
            assert!(old < version);
            flash = Flash::with(&flash.memory);
        }
        let (_, done) = act(&mut flash, Action::Update(99), 10);
        assert_eq!(done, Ok(99));
        assert_eq!(version_of(&flash.memory), 99);
    }
}

/// The very first update of a unit: before it ends there is no table, and boot says so.
#[test]
fn before_the_first_update_ends_the_unit_is_uncompensated() {
    let cuts = Cell::new(0);
    let blank = Flash::<8, 512>::new(4);
    let mut flash = Flash::watched(&blank.memory, |memory: &Memory<8, 512>, _, _| {
        cuts.set(cuts.get() + 1);
        let mut torn = Flash::with(memory);
        let mut buffer = BLANK;
        let (mut store, first) = boot(&mut torn, &mut buffer);
        assert!(active_version(&first, &buffer).is_none_or(|version| version == 1));
        update(&mut store, &mut torn, &image(12, 1), &mut buffer).unwrap();
        let (_, second) = boot(&mut torn, &mut buffer);
        assert_eq!(active_version(&second, &buffer), Some(1));
    });
    let mut buffer = BLANK;
    let (mut store, first) = boot(&mut flash, &mut buffer);
    assert_eq!((first.active, store.expected()), (None, None));
    let slot = store.begin(&mut flash, 556).unwrap();
    assert_eq!(slot, Slot::A);
    update(&mut store, &mut flash, &image(12, 1), &mut buffer).unwrap();
    drop(flash);
    assert!(cuts.get() > 250);
}
