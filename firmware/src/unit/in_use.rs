//! The tables in use: in RAM for as long as the unit runs, so that a bit of them may flip.
//!
//! They are checked step by step against the [`Sums`] that they had when they were accepted. Damaged
//! ones are not repaired in their place, which their readers borrow. They are loaded again into
//! [`Room`] that nothing else uses, and the damaged ones are left alone.

use tempco_image::Image;

use super::UnitTables;
use super::sums::Sums;

/// Time between two steps of the check \[ms\].
pub const STEP_MS: u32 = 4000;

/// A unit that has lost its tables resets itself, but not before it has run for so long \[s\].
pub const RESET_AFTER_S: u32 = 600;

/// Places for tables: of boot, and of those that are loaded again until the next one.
pub const PLACES: usize = 4;

/// Tables whose image was checked and accepted, with what was true of them then.
pub struct Accepted<'t, const C: usize, const A: usize> {
    /// Of all channels.
    pub tables: UnitTables<'t, C, A>,
    /// The CRC by which the set is recognised.
    pub crc: u32,
    /// What they said.
    pub sums: Sums,
}

/// The tables in use, and how far they are checked.
pub struct InUse<'t, const C: usize, const A: usize> {
    accepted: &'t Accepted<'t, C, A>,
    /// The step that is next.
    next: usize,
    /// Time of the last step.
    checked_ms: u32,
}

impl<'t, const C: usize, const A: usize> InUse<'t, C, A> {
    /// Tables that are used from now on.
    pub const fn new(accepted: &'t Accepted<'t, C, A>) -> Self {
        Self {
            accepted,
            next: 0,
            checked_ms: 0,
        }
    }

    /// The tables of all channels.
    pub const fn tables(&self) -> &'t UnitTables<'t, C, A> {
        &self.accepted.tables
    }

    /// The CRC by which the set is recognised.
    pub const fn crc(&self) -> u32 {
        self.accepted.crc
    }

    /// The sums that the tables should have.
    pub const fn sums(&self) -> &'t Sums {
        &self.accepted.sums
    }

    /// Whether it is time for a step, given the time; then the next one is due later by
    /// [`STEP_MS`].
    pub const fn is_due(&mut self, now_ms: u32) -> bool {
        let is_due = now_ms.wrapping_sub(self.checked_ms) >= STEP_MS;
        if is_due {
            self.checked_ms = now_ms;
        }
        is_due
    }

    /// Checks on, by one step.
    ///
    /// # Errors
    /// The number of the step, which found damage.
    pub fn check(&mut self) -> Result<(), u32> {
        let step = self.next;
        let next = step.saturating_add(1);
        self.next = if next < self.sums().steps() { next } else { 0 };
        if self.sums().hold(self.tables(), step) {
            Ok(())
        } else {
            Err(step as u32)
        }
    }
}

/// A place for tables.
pub type Place<'t, const C: usize, const A: usize> = Option<Accepted<'t, C, A>>;

/// Memory for tables. What was taken of it is not given back.
pub struct Room<'t, const C: usize, const A: usize> {
    bytes: &'t mut [u8],
    places: &'t mut [Place<'t, C, A>],
}

impl<'t, const C: usize, const A: usize> Room<'t, C, A> {
    /// Room for images, aligned to 4 bytes, and for the tables made of them.
    pub const fn new(bytes: &'t mut [u8], places: &'t mut [Place<'t, C, A>]) -> Self {
        Self { bytes, places }
    }

    /// Where the next image is to be loaded; nothing where there is no place for its tables.
    pub const fn free(&mut self) -> &mut [u8] {
        if self.places.is_empty() {
            &mut []
        } else {
            self.bytes
        }
    }

    /// Takes the image that was loaded, of `len` bytes, and makes tables of it. None where it is not
    /// good or too long.
    #[inline(never)]
    pub fn take(&mut self, len: usize) -> Option<InUse<'t, C, A>> {
        let bytes = core::mem::take(&mut self.bytes);
        let (bytes, rest) = bytes.split_at_mut_checked(len.next_multiple_of(4))?;
        self.bytes = rest;
        let image = Image::read(bytes).ok()?;
        let tables = image.tables().ok()?;
        let accepted = Accepted {
            sums: Sums::of(&tables)?,
            tables,
            crc: image.info().table_crc,
        };
        let (place, rest) = core::mem::take(&mut self.places).split_first_mut()?;
        self.places = rest;
        Some(InUse::new(place.insert(accepted)))
    }
}
