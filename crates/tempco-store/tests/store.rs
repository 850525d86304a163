//! What the store takes, refuses and says.

mod common;

use common::flash::Flash;
use common::{
    BLANK, Buffer, accept, active_version, boot, image, image_of, store_image, update,
    with_two_versions,
};
use tempco_image::{CRC, ImageError};
use tempco_store::{Active, Checked, Region, Slot, SlotState, Store, StoreError};

type Small = Flash<'static, 8, 512>;

/// Version 1 in A, version 2 in B and in use.
fn two_versions() -> Small {
    with_two_versions::<8, 512>(4, 10)
}

const IMAGE_LEN: u32 = 228 + 10 * 28;

#[test]
fn the_latest_table_is_in_use_and_the_other_on_standby() {
    let mut flash = two_versions();
    let mut buffer = BLANK;
    let (_, found) = boot(&mut flash, &mut buffer);
    assert_eq!(active_version(&found, &buffer), Some(2));
    let active = found.active.unwrap();
    assert_eq!((active.slot, active.sequence), (Slot::B, 2));
    assert_eq!(active.len, IMAGE_LEN as usize);
    assert_eq!(found.slots, [SlotState::Standby, SlotState::Active]);
}

#[test]
fn a_damaged_table_gives_way_to_the_other_and_says_why() {
    for bit in (0..8 * IMAGE_LEN as usize).step_by(7) {
        let mut flash = two_versions();
        flash.flip(8 * 1024 + bit);
        let mut buffer = BLANK;
        let (_, found) = boot(&mut flash, &mut buffer);
        assert_eq!(active_version(&found, &buffer), Some(1), "bit {bit}");
        assert_eq!(
            found.slots,
            [SlotState::Active, SlotState::Bad(StoreError::Different)]
        );
    }
    let mut flash = two_versions();
    flash.tear(1024 + 100);
    let mut buffer = BLANK;
    let (_, found) = boot(&mut flash, &mut buffer);
    assert_eq!(active_version(&found, &buffer), Some(1));
    assert!(matches!(
        found.slots,
        [SlotState::Active, SlotState::Bad(StoreError::Flash(_))]
    ));
}

/// Every flip in an entry makes it no entry: of the selection, which leaves the image stored, and
/// of the image itself, which leaves nothing.
#[test]
fn a_damaged_entry_is_not_believed() {
    for bit in 0..8 * 32 {
        let mut flash = two_versions();
        flash.flip(8 * (2048 - 256 + 32) + bit);
        let mut buffer = BLANK;
        let (_, found) = boot(&mut flash, &mut buffer);
        assert_eq!(active_version(&found, &buffer), Some(1), "bit {bit}");
        assert_eq!(found.slots, [SlotState::Active, SlotState::Stored]);
        flash.flip(8 * (2048 - 256) + bit);
        let (_, found) = boot(&mut flash, &mut buffer);
        assert_eq!(active_version(&found, &buffer), Some(1), "bit {bit}");
        assert_eq!(found.slots, [SlotState::Active, SlotState::Empty]);
    }
}

#[test]
fn a_store_that_is_wholly_unreadable_boots_uncompensated_and_can_be_written_anew() {
    let mut flash = two_versions();
    (0..2048).step_by(8).for_each(|byte| flash.tear(byte));
    let mut buffer = BLANK;
    let (mut store, found) = boot(&mut flash, &mut buffer);
    assert_eq!(found.active, None);
    assert_eq!(found.slots, [SlotState::Empty; 2]);
    for _ in 0..4 {
        assert!(matches!(store.check(&mut flash, 100), Checked::Passed(_)));
    }
    update(&mut store, &mut flash, &image(10, 5), &mut buffer).unwrap();
    let (_, found) = boot(&mut flash, &mut buffer);
    assert_eq!(active_version(&found, &buffer), Some(5));

    // Both images damaged, both entries good.
    let mut flash = two_versions();
    flash.flip(8 * 80);
    flash.tear(1024);
    let (_, found) = boot(&mut flash, &mut buffer);
    assert_eq!(found.active, None);
    assert!(
        found
            .slots
            .iter()
            .all(|state| matches!(state, SlotState::Bad(_)))
    );
}

#[test]
fn the_table_in_use_is_loaded_again_or_not_at_all() {
    let mut flash = two_versions();
    let (mut buffer, mut other) = (BLANK, BLANK);
    let (store, found) = boot(&mut flash, &mut buffer);
    let active = found.active.unwrap();
    let mut reload = |flash: &mut Small, active, len: usize| {
        store.reload(flash, active, &mut other.0[..len], accept)
    };
    assert_eq!(reload(&mut flash, active, active.len), Ok(()));
    let short = reload(&mut flash, active, active.len - 4);
    assert_eq!(short, Err(StoreError::Length));
    let older = Active {
        sequence: 1,
        ..active
    };
    let refused = reload(&mut flash, older, 4096);
    assert_eq!(refused, Err(StoreError::Different));
    assert_eq!(buffer.0[..active.len], other.0[..active.len]);
    flash.flip(8 * (1024 + 200));
    let mut other = BLANK;
    let damaged = store.reload(&mut flash, active, &mut other.0, accept);
    assert_eq!(damaged, Err(StoreError::Different));
}

/// The slot that was chosen last is not always the one in use: its table may be bad. An update goes
/// there, and the table in use stays, whatever becomes of the update.
#[test]
fn an_update_never_goes_to_the_slot_in_use() {
    let mut flash = two_versions();
    flash.flip(8 * (1024 + 200));
    let mut buffer = BLANK;
    let (mut store, found) = boot(&mut flash, &mut buffer);
    assert_eq!(found.active.map(|active| active.slot), Some(Slot::A));
    assert_eq!(store.begin(&mut flash, IMAGE_LEN), Ok(Slot::B));
    let (mut store, found) = boot(&mut flash, &mut buffer);
    assert_eq!(active_version(&found, &buffer), Some(1));

    update(&mut store, &mut flash, &image(10, 3), &mut buffer).unwrap();
    let (_, found) = boot(&mut flash, &mut buffer);
    assert_eq!(active_version(&found, &buffer), Some(3));
    assert_eq!(found.slots, [SlotState::Standby, SlotState::Active]);
}

/// Stored, booted with or without the one in use, and selected at last.
#[test]
fn a_stored_table_is_not_used_before_it_is_selected() {
    for is_damaged in [false, true] {
        let mut flash = two_versions();
        let mut buffer = BLANK;
        let (mut store, _) = boot(&mut flash, &mut buffer);
        assert_eq!(store.spare(&mut flash), Slot::A);
        let stored = store_image(&mut store, &mut flash, &image(10, 3), &mut buffer);
        assert_eq!(stored, Ok(Slot::A));
        // It is checked as all images are, and may be replaced.
        assert_eq!(store.check(&mut flash, 100), Checked::Good(Slot::A));
        store_image(&mut store, &mut flash, &image(10, 4), &mut buffer).unwrap();
        if is_damaged {
            flash.flip(8 * 1024 + 8 * 200);
        }
        for _ in 0..2 {
            let (_, found) = boot(&mut flash, &mut buffer);
            let expected = (!is_damaged).then_some(2);
            assert_eq!(active_version(&found, &buffer), expected);
            assert_eq!(found.slots[0], SlotState::Stored);
        }
        let (mut store, _) = boot(&mut flash, &mut buffer);
        store
            .select(&mut flash, Slot::A, &mut buffer.0, accept)
            .unwrap();
        let (_, found) = boot(&mut flash, &mut buffer);
        assert_eq!(active_version(&found, &buffer), Some(4));
        assert_eq!(found.slots, [SlotState::Active, SlotState::Standby]);
    }
}

#[test]
fn roll_back_and_forth_until_there_is_no_room() {
    let mut flash = two_versions();
    let mut buffer = BLANK;
    for round in 0..13 {
        let (mut store, found) = boot(&mut flash, &mut buffer);
        let expected = if round % 2 == 0 { 2 } else { 1 };
        assert_eq!(active_version(&found, &buffer), Some(expected), "{round}");
        let slot = found.active.unwrap().slot;
        // The slot in use need not be selected, which costs nothing.
        let before = flash.operations;
        store
            .select(&mut flash, slot, &mut buffer.0, accept)
            .unwrap();
        assert_eq!(flash.operations, before);
        let selected = store.select(&mut flash, !slot, &mut buffer.0, accept);
        let expected = if round < 12 {
            Ok(())
        } else {
            Err(StoreError::Full)
        };
        assert_eq!(selected, expected, "{round}");
    }
    // An update makes room in the slot that it goes to.
    for (version, selected) in [(3, Err(StoreError::Full)), (4, Ok(()))] {
        let (mut store, _) = boot(&mut flash, &mut buffer);
        update(&mut store, &mut flash, &image(10, version), &mut buffer).unwrap();
        let (mut store, found) = boot(&mut flash, &mut buffer);
        assert_eq!(active_version(&found, &buffer), Some(version));
        let other = !found.active.unwrap().slot;
        let result = store.select(&mut flash, other, &mut buffer.0, accept);
        assert_eq!(result, selected, "{version}");
    }
}

#[test]
fn nothing_is_selected_that_is_not_good() {
    let mut flash = two_versions();
    flash.flip(8 * 200);
    let mut buffer = BLANK;
    let (mut store, _) = boot(&mut flash, &mut buffer);
    let select = |store: &mut Store, flash: &mut Small, buffer: &mut Buffer| {
        store.select(flash, Slot::A, &mut buffer.0, accept)
    };
    let refused = select(&mut store, &mut flash, &mut buffer);
    assert_eq!(refused, Err(StoreError::Different));
    let operations = flash.operations;
    store.begin(&mut flash, 64).unwrap();
    let refused = select(&mut store, &mut flash, &mut buffer);
    assert_eq!(refused, Err(StoreError::Empty));
    assert_eq!(flash.operations, operations + 1);
    let (_, found) = boot(&mut flash, &mut buffer);
    assert_eq!(active_version(&found, &buffer), Some(2));
}

/// Another unit's table, one of another shape, one with a wrong CRC: whole, but not accepted.
#[test]
fn nothing_is_committed_that_is_not_accepted() {
    let mut spoilt = image(10, 3);
    spoilt[150] ^= 1;
    for (bytes, error) in [
        (image_of("SN8", 10, 3), ImageError::Serial),
        (spoilt, ImageError::Crc { block: 0 }),
        (vec![0; 348], ImageError::Magic),
        (vec![0xff; 348], ImageError::Magic),
    ] {
        let mut flash = two_versions();
        let mut buffer = BLANK;
        let (mut store, _) = boot(&mut flash, &mut buffer);
        let refused = update(&mut store, &mut flash, &bytes, &mut buffer).unwrap_err();
        assert_eq!(refused, StoreError::Image(error));
        let (_, found) = boot(&mut flash, &mut buffer);
        assert_eq!(active_version(&found, &buffer), Some(2));
        assert_eq!(found.slots, [SlotState::Empty, SlotState::Active]);
    }
}

#[test]
fn a_table_of_another_unit_is_not_booted() {
    let mut flash = two_versions();
    let mut buffer = BLANK;
    let (mut store, _) = boot(&mut flash, &mut buffer);
    let found = store.boot(&mut flash, &mut buffer.0, |image| {
        image.expect_serial("SN8")
    });
    assert_eq!(found.active, None);
    let serial = SlotState::Bad(StoreError::Image(ImageError::Serial));
    assert_eq!(found.slots, [serial; 2]);
}

#[test]
fn chunks_may_come_twice_but_not_early_or_changed() {
    let mut flash = two_versions();
    let mut buffer = BLANK;
    let (mut store, _) = boot(&mut flash, &mut buffer);
    let bytes = image(10, 3);
    let (len, crc) = (bytes.len() as u32, CRC.checksum(&bytes));
    let write = |store: &mut Store, flash: &mut Small, offset: u32, end: u32| {
        store.write(flash, offset, &bytes[offset as usize..end as usize])
    };
    assert_eq!(
        write(&mut store, &mut flash, 0, 64),
        Err(StoreError::Incomplete)
    );
    assert_eq!(store.begin(&mut flash, len), Ok(Slot::A));
    for (offset, end, expected) in [
        (0, 64, Ok(64)),
        (0, 64, Ok(64)),
        (0, 32, Ok(64)),
        (8, 48, Ok(64)),
        (128, 192, Err(StoreError::Offset { expected: 64 })),
        (32, 96, Err(StoreError::Offset { expected: 64 })),
        (64, 70, Err(StoreError::Unaligned)),
        (64, 128, Ok(128)),
    ] {
        let written = write(&mut store, &mut flash, offset, end);
        assert_eq!(written, expected, "{offset}..{end}");
        assert_eq!(store.expected(), Some(written.unwrap_or(64)));
    }
    let operations = flash.operations;
    let differs = store.write(&mut flash, 0, &[0x55; 64]);
    assert_eq!(differs, Err(StoreError::Different));
    let beyond = store.write(&mut flash, 128, &[0; 1000]);
    assert_eq!(beyond, Err(StoreError::Length));
    let far = store.write(&mut flash, u32::MAX, &[0; 8]);
    assert_eq!(far, Err(StoreError::Length));
    let early = store.commit(&mut flash, len, crc, &mut buffer.0, accept);
    assert_eq!(early, Err(StoreError::Incomplete));
    assert_eq!(flash.operations, operations, "nothing was touched");

    assert_eq!(write(&mut store, &mut flash, 128, len), Ok(len));
    let other = store.commit(&mut flash, len - 4, crc, &mut buffer.0, accept);
    assert_eq!(other, Err(StoreError::Incomplete));
    let other = store.commit(&mut flash, len, crc ^ 1, &mut buffer.0, accept);
    assert_eq!(other, Err(StoreError::Different));
    let ended = store.commit(&mut flash, len, crc, &mut buffer.0, accept);
    assert_eq!(ended, Err(StoreError::Incomplete));
    assert_eq!(update(&mut store, &mut flash, &bytes, &mut buffer), Ok(()));

    // Until it has been booted, neither slot may be touched: one is in use, one is chosen.
    assert_eq!(store.begin(&mut flash, len), Err(StoreError::NotBooted));
    let select = store.select(&mut flash, Slot::B, &mut buffer.0, accept);
    assert_eq!(select, Err(StoreError::NotBooted));
    store.boot(&mut flash, &mut buffer.0, accept);
    assert_eq!(store.begin(&mut flash, len), Ok(Slot::B));
}

#[test]
fn lengths_and_regions_are_checked() {
    let mut flash = two_versions();
    let mut buffer = BLANK;
    let (mut store, _) = boot(&mut flash, &mut buffer);
    let room = store.room::<Small>(Slot::A);
    assert_eq!(room, 1024 - 256);
    for len in [0, 2, room + 4, u32::MAX] {
        assert_eq!(store.begin(&mut flash, len), Err(StoreError::Length));
    }
    assert_eq!(store.begin(&mut flash, room), Ok(Slot::A));
    // A buffer that is too small is no reason to fault.
    let found = store.boot(&mut flash, &mut buffer.0[..100], accept);
    assert_eq!(found.active, None);

    let region = |start: u32, len: u32| Region { start, len };
    for (a, b) in [
        (region(0, 1024), region(512, 1024)),
        (region(0, 1024), region(1000, 1024)),
        (region(0, 1000), region(1024, 1024)),
        (region(0, 1024), region(1024, 1536)),
        (region(0, 0), region(1024, 1024)),
        (region(0, 1024), region(u32::MAX - 511, 1024)),
        (region(0, 1024), region(1024, u32::MAX - 511)),
    ] {
        let error = Store::new(&flash, a, b).err();
        assert_eq!(error, Some(StoreError::Region), "{a:?} {b:?}");
    }
}

/// Goes on until both slots are through.
fn check_all(store: &mut Store, flash: &mut Small) -> [Checked; 2] {
    [(); 2].map(|()| {
        for _ in 0..20 {
            match store.check(flash, 1) {
                Checked::Underway(_) => {}
                done => return done,
            }
        }
        panic!("an image of 348 bytes has 6 slices");
    })
}

#[test]
fn the_periodic_check_finds_what_happens_after_boot() {
    let mut flash = two_versions();
    let mut buffer = BLANK;
    let (mut store, _) = boot(&mut flash, &mut buffer);
    let good = [Checked::Good(Slot::A), Checked::Good(Slot::B)];
    assert_eq!(check_all(&mut store, &mut flash), good);
    for bit in (0..8 * IMAGE_LEN as usize).step_by(5) {
        flash.flip(8 * 1024 + bit);
        let crc = StoreError::Image(ImageError::Crc { block: 0 });
        let expected = [Checked::Good(Slot::A), Checked::Bad(Slot::B, crc)];
        assert_eq!(check_all(&mut store, &mut flash), expected, "bit {bit}");
        flash.flip(8 * 1024 + bit);
    }
    assert_eq!(check_all(&mut store, &mut flash), good);
    // A slot that is being written is passed over, and a check that was under way begins again.
    assert_eq!(store.check(&mut flash, 1), Checked::Underway(Slot::A));
    store.begin(&mut flash, IMAGE_LEN).unwrap();
    let during = [Checked::Passed(Slot::A), Checked::Good(Slot::B)];
    assert_eq!(check_all(&mut store, &mut flash), during);
    flash.tear(1024 + 96);
    assert!(matches!(
        check_all(&mut store, &mut flash),
        [
            Checked::Passed(_),
            Checked::Bad(Slot::B, StoreError::Flash(_))
        ]
    ));
}

/// An image of more than one block with its CRCs.
#[test]
fn the_periodic_check_follows_the_blocks_of_a_long_image() {
    let mut flash = Flash::<8, 4096>::new(8);
    let mut buffer = Box::new(tempco_image::AlignedBytes([0; 16_384]));
    let mut store = common::store(&flash);
    store.boot(&mut flash, &mut buffer.0, accept);
    let bytes = image(250, 1);
    let len = bytes.len() as u32;
    assert_eq!(len, 80 + 116 + 28 + 7000 + 8);
    store.begin(&mut flash, len).unwrap();
    let mut offset = 0;
    for chunk in bytes.chunks(1000) {
        offset = store.write(&mut flash, offset, chunk).unwrap();
    }
    let crc = CRC.checksum(&bytes);
    store
        .commit(&mut flash, len, crc, &mut buffer.0, accept)
        .unwrap();
    assert_eq!(store.check(&mut flash, 1000), Checked::Good(Slot::A));
    assert_eq!(store.check(&mut flash, 1000), Checked::Passed(Slot::B));
    for byte in [0, 4091, 4092, 7223, 7224, 7231] {
        flash.flip(8 * byte);
        let block = usize::from(byte > 4091 && !(7224..7228).contains(&byte));
        let bad = StoreError::Image(ImageError::Crc { block });
        assert_eq!(store.check(&mut flash, 1000), Checked::Bad(Slot::A, bad));
        store.check(&mut flash, 1000);
        flash.flip(8 * byte);
    }
}
