//! Where tables and logs are in the sectors that are the store's.

use tempco_store::Region;

use crate::unit::devices::Regions;

/// Bytes of a sector.
pub const SECTOR: u32 = 128 * 1024;

/// Sectors of the store: 6 to 11 of the chip.
pub const SECTORS: usize = 6;

/// A slot is one sector. The fault log and the offsets are two each, as one half of each is erased
/// while the other is whole.
pub const REGIONS: Regions = Regions {
    slots: [region(0, 1), region(1, 1)],
    faults: region(2, 2),
    offsets: region(4, 2),
};

const fn region(first: u32, sectors: u32) -> Region {
    Region {
        start: first * SECTOR,
        len: sectors * SECTOR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::format;

    const MEMORY: &str = include_str!("../../../boards/stm32f405.x");

    /// The linker knows where the store begins, and this module how long it is.
    #[test]
    fn the_memory_file_has_as_many_sectors() {
        let len = SECTORS as u32 * SECTOR / 1024;
        let region = format!("STORE : ORIGIN = 0x08040000, LENGTH = {len}K\n");
        assert!(MEMORY.contains(&region), "no `{region}` in {MEMORY}");
        let [a, b] = REGIONS.slots;
        let mut end = 0;
        for region in [a, b, REGIONS.faults, REGIONS.offsets] {
            assert_eq!(region.start, end);
            end += region.len;
        }
        assert_eq!(end, SECTORS as u32 * SECTOR);
    }
}
