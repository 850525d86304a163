//! The fault log over resets and power cuts.

mod common;

use std::cell::Cell;

use common::flash::{CUTS, Flash, Memory};
use embedded_storage::nor_flash::NorFlash;
use tempco_image::CRC;
use tempco_store::{FaultLog, Region, StoreError};

const CODES: usize = 3;
type Small = Flash<'static, 8, 512>;
type Log = FaultLog<CODES>;

const REGION: Region = Region {
    start: 512,
    len: 1024,
};

fn open<'c>(flash: &mut Flash<'c, 8, 512>) -> Log {
    FaultLog::open(flash, REGION).unwrap()
}

fn counts(log: &Log) -> [u32; CODES] {
    log.faults().map(|fault| fault.count)
}

#[test]
fn faults_and_their_counters_survive_resets() {
    let mut flash = Small::new(4);
    let mut expected = [0; CODES];
    for boot in 1..200 {
        let mut log = open(&mut flash);
        assert_eq!(counts(&log), expected);
        assert_eq!(log.boot(), boot);
        let code = boot as usize % CODES;
        log.record(&mut flash, code, 10 * boot, 7).unwrap();
        log.record(&mut flash, 0, 10 * boot + 1, boot).unwrap();
        log.flush(&mut flash).unwrap();
        expected[code] += 1;
        expected[0] += 1;
        let last = open(&mut flash).faults()[0];
        assert_eq!(
            (last.boot, last.uptime_s, last.detail),
            (boot, 10 * boot + 1, boot)
        );
        assert!((1..CODES).all(|code| open(&mut flash).faults()[code].sequence < last.sequence));
    }
    assert_eq!(flash.overwrites, 0);
}

/// A fault that comes all the time costs a write per doubling, and half at most is lost.
#[test]
fn a_frequent_fault_does_not_wear_out_the_flash() {
    let mut flash = Small::new(4);
    let mut log = open(&mut flash);
    for second in 0..100_000 {
        log.record(&mut flash, 1, second, 0).unwrap();
    }
    assert!(flash.operations <= 4 * 20, "{}", flash.operations);
    assert_eq!(log.faults()[1].count, 100_000);
    assert_eq!(open(&mut flash).faults()[1].count, 65_536);
    log.flush(&mut flash).unwrap();
    assert_eq!(open(&mut flash).faults()[1].count, 100_000);
    let operations = flash.operations;
    log.flush(&mut flash).unwrap();
    assert_eq!(flash.operations, operations, "nothing was left to write");
}

/// Up to the last erasure that the log may have, from the mark of a half that was completed before.
#[test]
fn a_worn_log_is_erased_no_more() {
    let mut flash = Small::new(4);
    let mark = [u32::from_le_bytes(*b"TCF3"), u32::MAX, 19_998, 0, 0, 0, 0];
    let mut bytes = mark.map(u32::to_le_bytes).concat();
    bytes.extend(CRC.checksum(&bytes).to_le_bytes());
    flash.write(REGION.start, &bytes).unwrap();
    let mut counted = 0;
    let mut last = (9_999, false);
    for boot in 0..100 {
        let mut log = open(&mut flash);
        assert!(log.faults()[1].count <= boot);
        log.record(&mut flash, 1, 0, 0).unwrap();
        counted = log.faults()[1].count;
        let now = (log.erasures(), log.is_worn());
        assert!(now == last || now == (10_000, true), "{now:?}");
        last = now;
    }
    // Behind the mark there are 15 places. The turn writes an entry and its mark, which leaves 14. The
    // last occurrence is only counted.
    assert_eq!((last, counted), ((10_000, true), 15 + 1 + 14 + 1));
    let operations = flash.operations;
    let mut log = open(&mut flash);
    for _ in 0..100 {
        log.record(&mut flash, 2, 0, 0).unwrap();
    }
    log.flush(&mut flash).unwrap();
    assert_eq!((flash.operations, log.faults()[2].count), (operations, 100));
}

/// All single cuts and pairs of cuts over two turns of the halves: each fault has the count from
/// before or after what was being recorded, the others what they had.
#[test]
fn a_power_cut_loses_at_most_what_was_being_recorded() {
    let pairs = Cell::new(0);
    let mut start = Small::new(4);
    for round in 0..40 {
        let before = counts(&open(&mut start));
        let code = round % CODES;
        let check = |memory: &Memory<8, 512>, before: [u32; CODES], code: usize| {
            let found = counts(&open(&mut Flash::with(memory)));
            for (number, (found, before)) in found.into_iter().zip(before).enumerate() {
                let more = u32::from(number == code);
                assert!(found == before || found == before + more, "round {round}");
            }
            found
        };
        let mut flash = Flash::watched(&start.memory, |memory, _, _| {
            let between = check(memory, before, code);
            let next = (code + 1) % CODES;
            let mut again = Flash::watched(memory, |memory: &Memory<8, 512>, _, _| {
                pairs.set(pairs.get() + 1);
                check(memory, between, next);
            });
            open(&mut again).record(&mut again, next, 1, 0).unwrap();
            let whole = counts(&open(&mut Flash::with(&again.memory)));
            assert_eq!(whole[next], between[next] + 1);
        });
        open(&mut flash).record(&mut flash, code, 1, 0).unwrap();
        start = Flash::with(&flash.memory);
        assert_eq!(flash.overwrites, 0);
    }
    assert!(pairs.get() > 10_000, "{}", pairs.get());
}

#[test]
fn a_failing_flash_is_said_and_counted_in_memory() {
    let mut flash = Small::new(4);
    let mut log = open(&mut flash);
    log.record(&mut flash, 2, 0, 0).unwrap();
    for cut in CUTS {
        flash.fails_after = Some((flash.operations, cut));
        let mut log = open(&mut flash);
        let before = log.faults()[2].count;
        assert!(log.record(&mut flash, 2, 0, 0).is_err());
        assert_eq!(log.faults()[2].count, before + 1);
    }
}

#[test]
fn regions_and_codes_are_checked() {
    let mut flash = Small::new(4);
    for (start, len) in [(0, 512), (0, 1536), (100, 1024), (1536, 1024), (0, 0)] {
        let error = Log::open(&mut flash, Region { start, len }).err();
        assert_eq!(error, Some(StoreError::Region), "{start} {len}");
    }
    assert!(FaultLog::<7>::open(&mut flash, REGION).is_ok());
    assert!(FaultLog::<8>::open(&mut flash, REGION).is_err());
    let mut log = open(&mut flash);
    let refused = log.record(&mut flash, CODES, 0, 0);
    assert_eq!(refused, Err(StoreError::Code));
}

/// A region that is full of anything is a log without entries.
#[test]
fn garbage_is_no_fault() {
    let mut flash = Small::new(4);
    for bit in 0..8 * 2048 {
        if bit % 3 != 0 {
            flash.flip(bit);
        }
    }
    let mut log = open(&mut flash);
    assert_eq!((counts(&log), log.boot()), ([0; CODES], 1));
    log.record(&mut flash, 1, 0, 0).unwrap();
    assert_eq!(counts(&open(&mut flash)), [0, 1, 0]);
}

/// As the layout says, and not those of another magic number, right as their CRCs may be.
#[test]
fn only_entries_of_its_own_kind_are_faults() {
    for (magic, expected) in [(b"TCF3", [0, 5, 0]), (b"TCF2", [0; CODES])] {
        let mut flash = Small::new(4);
        let magic = u32::from_le_bytes(*magic);
        let (fault, mark) = ([magic, 1, 9, 5, 1, 0, 0], [magic, u32::MAX, 1, 0, 0, 0, 0]);
        for (place, words) in (512..).step_by(32).zip([fault, mark]) {
            let mut bytes = words.map(u32::to_le_bytes).concat();
            bytes.extend(CRC.checksum(&bytes).to_le_bytes());
            flash.write(place, &bytes).unwrap();
        }
        assert_eq!(counts(&open(&mut flash)), expected);
    }
}
