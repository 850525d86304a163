//! Tables, fault log and offsets in the flash.

use heapless::Vec;
use tempco::MAX_AXES;
use tempco_image::{Fit, Image, ImageError, Misfit};
use tempco_link::{Bank, Fault, FaultEntry, MAX_FAULTS, Refusal, Wear};
use tempco_store::{
    Active, Checked, FaultLog, Numbers, Offsets, Slot, SlotState, Store, StoreError,
};

use super::SERIAL;
use super::devices::{Flash, Regions};
use super::in_use::{InUse, Room};

/// Codes in the log: those that a set of faults can have, and the number of boots behind them,
/// where it stays when there are more faults.
const CODES: usize = BOOTS + 1;
const BOOTS: usize = u32::BITS as usize;

/// Slices of 64 bytes that one pass of the main loop checks.
const SLICES: u32 = 4;

/// Everything that is kept over resets.
pub struct Storage<'t, F> {
    flash: F,
    regions: Regions,
    store: Store,
    faults: FaultLog<CODES>,
    offsets: Offsets<MAX_AXES>,
    /// Where an image is loaded to be looked at; the one in use stays where it is.
    scratch: &'t mut [u8],
    active: Option<Active>,
    /// What a table must fit, channel by channel.
    fits: Vec<Fit, MAX_AXES>,
    /// Why the images of slots A and B are not good, as boot or the last check found them.
    bad: [Option<u32>; 2],
}

/// The image of a slot cannot be read, or its CRCs are wrong.
const DAMAGED: u32 = 0;

/// Why the image of a slot is not good: as in the fault log, where the number of the slot comes to
/// it. The reason is in the upper half, an axis in the second byte.
const fn reason(error: StoreError) -> u32 {
    match error {
        StoreError::Image(ImageError::Unfit { axis, why }) => {
            let reason = match why {
                Misfit::Unit => 1,
                Misfit::ScaleFactor => 2,
                Misfit::Bias => 3,
            };
            reason << 16 | (axis as u32) << 8
        }
        // It is whole: another unit's, or of another version.
        StoreError::Image(_) => 4 << 16,
        _ => DAMAGED,
    }
}

/// The check by which an image is taken: integrity was checked before.
fn accept<const C: usize, const A: usize>(
    fits: &[Fit],
) -> impl Fn(&Image) -> Result<(), ImageError> {
    move |image| {
        image.expect_serial(SERIAL)?;
        image.tables::<C, A>()?;
        image.expect_fit(fits)
    }
}

impl<'t, F: Flash> Storage<'t, F> {
    /// Opens the flash, loads the image to use into `room` and validates it; it must fit the
    /// board as `fits` says. Where there is none, the unit runs uncompensated. `scratch` must be
    /// aligned to 4 bytes.
    ///
    /// # Errors
    /// Regions that do not fit the flash; a defect of the board's module, and of nothing else.
    pub fn boot<const C: usize, const A: usize>(
        mut flash: F,
        regions: Regions,
        fits: &[[Fit; A]; C],
        room: &mut Room<'t, C, A>,
        scratch: &'t mut [u8],
    ) -> Result<(Self, Option<InUse<'t, C, A>>), StoreError> {
        let mut faults = FaultLog::open(&mut flash, regions.faults)?;
        let offsets = Offsets::open(&mut flash, regions.offsets)?;
        // The number of the boot is in both, so that neither need be readable.
        if let Some(numbers) = offsets.numbers() {
            faults.at_least_boot(numbers.boot.saturating_add(1));
        }
        _ = faults.record(&mut flash, BOOTS, 0, 0);
        let [a, b] = regions.slots;
        let mut store = Store::new(&flash, a, b)?;
        let fits: Vec<Fit, MAX_AXES> = Vec::from_slice(fits.as_flattened()).unwrap_or_default();
        let boot = store.boot(&mut flash, room.free(), accept::<C, A>(&fits));
        let in_use = boot.active.and_then(|active| room.take(active.len));
        let storage = Self {
            flash,
            regions,
            store,
            faults,
            offsets,
            scratch,
            active: boot.active,
            fits,
            bad: boot.slots.map(|slot| match slot {
                SlotState::Bad(error) => Some(reason(error)),
                _ => None,
            }),
        };
        Ok((storage, in_use))
    }

    /// Loads the image in use again, into what is left of the room. Where that fails, there is none
    /// in use any more.
    pub fn reload<const C: usize, const A: usize>(
        &mut self,
        room: &mut Room<'t, C, A>,
    ) -> Option<InUse<'t, C, A>> {
        let Self {
            store,
            flash,
            fits,
            active,
            ..
        } = self;
        let image = active.take()?;
        let loaded = store.reload(flash, image, room.free(), accept::<C, A>(fits));
        let in_use = loaded.ok().and_then(|()| room.take(image.len))?;
        *active = Some(image);
        Some(in_use)
    }

    /// The first number of a session that nobody has been promised. Without a record the numbers
    /// begin where no boot before can have come to, by the number of this one.
    pub fn promised_sessions(&self) -> u32 {
        let first = self.faults.boot().saturating_mul(1 << 16);
        self.offsets
            .numbers()
            .map_or(first, |numbers| numbers.session)
    }

    /// Resets in a row that nobody wanted.
    pub fn resets(&self) -> u32 {
        self.offsets.numbers().map_or(0, |numbers| numbers.resets)
    }

    /// Keeps the number of this boot, the first session that is not promised, and the number of resets
    /// in a row.
    ///
    /// # Errors
    /// A failing flash; sessions may then have the same numbers again after a reset.
    pub fn keep_numbers(&mut self, session: u32, resets: u32) -> Result<(), StoreError> {
        let boot = self.faults.boot();
        let numbers = Numbers {
            boot,
            session,
            resets,
        };
        self.offsets.set_numbers(&mut self.flash, numbers)
    }

    /// The image in use.
    pub const fn active(&self) -> Option<Active> {
        self.active
    }

    /// The bank into which an upload goes.
    pub fn spare(&mut self) -> Bank {
        bank_of(self.store.spare(&mut self.flash))
    }

    /// What a table must fit, channel by channel.
    pub fn fits(&self) -> &[Fit] {
        &self.fits
    }

    /// Puts an occurrence of a fault into the log.
    ///
    /// # Errors
    /// A failing flash.
    pub fn record(&mut self, fault: Fault, uptime_s: u32, detail: u32) -> Result<(), StoreError> {
        let code = fault.code().into();
        self.faults.record(&mut self.flash, code, uptime_s, detail)
    }

    /// How often the flash was erased.
    pub const fn wear(&self) -> Wear {
        Wear {
            faults: self.faults.erasures(),
            offsets: self.offsets.erasures(),
        }
    }

    /// Whether the fault log has been erased too often to be written.
    pub const fn is_worn(&self) -> bool {
        self.faults.is_worn()
    }

    /// Writes what was counted but not yet written, before a reset that is planned.
    ///
    /// # Errors
    /// A failing flash.
    pub fn flush(&mut self) -> Result<(), StoreError> {
        self.faults.flush(&mut self.flash)
    }

    /// Faults that occurred, from a code on.
    pub fn faults(&self, from_code: u16) -> Vec<FaultEntry, MAX_FAULTS> {
        let all = self.faults.faults().iter().take(BOOTS).zip(0..);
        let occurred = all.filter(|(fault, code)| fault.count > 0 && *code >= from_code);
        let entry = |(fault, code): (&tempco_store::Fault, u16)| FaultEntry {
            code,
            count: fault.count,
            boot: fault.boot,
            uptime_s: fault.uptime_s,
            detail: fault.detail,
        };
        // `collect` would panic, were there more.
        let mut entries = Vec::new();
        for entry in occurred.map(entry) {
            if entries.push(entry).is_err() {
                break;
            }
        }
        entries
    }

    /// The constant biases that re-zero has found with a table, as they are kept.
    pub fn offsets<const C: usize, const A: usize>(&self, table_crc: u32) -> [[f32; A]; C] {
        let all = self.offsets.of(table_crc);
        let mut all = all.into_iter();
        core::array::from_fn(|_| core::array::from_fn(|_| all.next().unwrap_or(0.0)))
    }

    /// Keeps the constant biases that re-zero has found with a table.
    ///
    /// # Errors
    /// A failing flash, or one that is not finite; the ones before are then kept.
    pub fn set_offsets<const C: usize, const A: usize>(
        &mut self,
        table_crc: u32,
        offsets: &[[f32; A]; C],
    ) -> Result<(), StoreError> {
        let mut all = [0.0; MAX_AXES];
        for (place, offset) in all.iter_mut().zip(offsets.as_flattened()) {
            *place = *offset;
        }
        self.offsets.set(&mut self.flash, table_crc, all)
    }

    /// Checks the next stretch of the slots, which take turns.
    pub fn check(&mut self) {
        let checked = self.store.check(&mut self.flash, SLICES);
        self.remember(checked);
    }

    /// Why the image of a slot is not good, with the number of the slot, as far as is known.
    pub fn bad(&self) -> Option<u32> {
        let mut slots = self.bad.iter().zip(0..);
        slots.find_map(|(reason, slot)| reason.map(|reason| reason | slot))
    }

    fn remember(&mut self, checked: Checked) {
        match checked {
            Checked::Underway(_) => {}
            Checked::Passed(slot) => *self.bad_mut(slot) = None,
            // An image that is whole may yet be one that does not fit.
            Checked::Good(slot) => {
                let bad = self.bad_mut(slot);
                *bad = bad.filter(|reason| *reason != DAMAGED);
            }
            Checked::Bad(slot, _) => _ = self.bad_mut(slot).get_or_insert(DAMAGED),
        }
    }

    fn bad_mut(&mut self, slot: Slot) -> &mut Option<u32> {
        let [a, b] = &mut self.bad;
        if slot == Slot::A { a } else { b }
    }

    /// Checks the whole of both slots now, from wherever the periodic check is.
    pub fn check_all(&mut self) {
        for _ in 0..3 {
            let checked = self.store.check(&mut self.flash, u32::MAX);
            self.remember(checked);
        }
    }

    /// Begins an update.
    ///
    /// # Errors
    /// Why not.
    pub fn upload_begin(&mut self, len: u32) -> Result<(), Refusal> {
        if len as usize > self.scratch.len() {
            return Err(Refusal::Store);
        }
        let slot = self.store.begin(&mut self.flash, len).map_err(refusal)?;
        // What was there is no more.
        *self.bad_mut(slot) = None;
        Ok(())
    }

    /// Takes a chunk; where the next one begins.
    ///
    /// # Errors
    /// Why not.
    pub fn upload_chunk(&mut self, offset: u32, bytes: &[u8]) -> Result<u32, Refusal> {
        let written = self.store.write(&mut self.flash, offset, bytes);
        written.map_err(refusal)
    }

    /// Ends the update and keeps the image, if it is good.
    ///
    /// # Errors
    /// Why not.
    pub fn upload_commit<const C: usize, const A: usize>(
        &mut self,
        len: u32,
        crc: u32,
    ) -> Result<(), Refusal> {
        let Self {
            store,
            flash,
            scratch,
            fits,
            ..
        } = self;
        let committed = store.commit(flash, len, crc, scratch, accept::<C, A>(fits));
        committed.map_err(refusal)
    }

    /// Makes the image of a bank the one to boot with, if it is good.
    ///
    /// # Errors
    /// Why not.
    pub fn select<const C: usize, const A: usize>(&mut self, bank: Bank) -> Result<(), Refusal> {
        let Self {
            store,
            flash,
            scratch,
            fits,
            ..
        } = self;
        let selected = store.select(flash, slot_of(bank), scratch, accept::<C, A>(fits));
        selected.map_err(refusal)
    }

    /// A stretch of the image in a bank, as far as it goes.
    ///
    /// # Errors
    /// Why not.
    pub fn download(&mut self, bank: Bank, offset: u32, len: u16) -> Result<&[u8], Refusal> {
        let Self {
            store,
            flash,
            scratch,
            regions,
            ..
        } = self;
        let slot = slot_of(bank);
        let [a, b] = regions.slots;
        let region = if slot == Slot::A { a } else { b };
        let room = scratch.len().min(store.room::<F>(slot) as usize);
        let scratch = scratch.get_mut(..room).ok_or(Refusal::Store)?;
        let read = flash.read(region.start, scratch);
        read.map_err(|_| Refusal::Store)?;
        let image = Image::read(scratch).map_err(|_| Refusal::Image)?.bytes();
        let from = image.len().min(offset as usize);
        let to = image.len().min(from + usize::from(len));
        image.get(from..to).ok_or(Refusal::Store)
    }
}

/// The link's name of a slot.
pub const fn bank_of(slot: Slot) -> Bank {
    match slot {
        Slot::A => Bank::A,
        Slot::B => Bank::B,
    }
}

const fn slot_of(bank: Bank) -> Slot {
    match bank {
        Bank::A => Slot::A,
        Bank::B => Slot::B,
    }
}

fn refusal(error: StoreError) -> Refusal {
    crate::warn!("store: {}", error);
    match error {
        StoreError::Offset { expected } => Refusal::Offset { expected },
        StoreError::Image(ImageError::Unfit { axis, why }) => {
            let axis = axis as u8;
            match why {
                Misfit::Unit => Refusal::Unit { axis },
                Misfit::ScaleFactor => Refusal::ScaleFactor { axis },
                Misfit::Bias => Refusal::Bias { axis },
            }
        }
        StoreError::Image(_) | StoreError::Different | StoreError::Incomplete => Refusal::Image,
        _ => Refusal::Store,
    }
}
