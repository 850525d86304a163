//! Truth values kept in a sign bit.
//!
//! A comparison of two f32 costs a Cortex-M4 two instructions to reach the processor's flags and
//! two or three more to become a value. A difference of integers has the answer in its sign after
//! one, and signs combine, count and select without a branch. Magnitudes of f32 may be compared
//! so, because their bits are in the order of their values, NaN last.

use core::hint::select_unpredictable;
use core::ops::{BitAnd, BitOr, Not};

/// Whether something holds: if so, the number is negative; its other bits mean nothing.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sign(pub(crate) i32);

impl PartialEq for Sign {
    fn eq(&self, other: &Self) -> bool {
        self.holds() == other.holds()
    }
}

/// The bits of `|value|`.
#[inline(always)]
pub(crate) const fn magnitude(value: f32) -> i32 {
    (value.to_bits() & !SIGN_BIT) as i32
}

/// `value`, but no larger in magnitude than the f32 of the bits `most`.
#[inline(always)]
pub(crate) const fn limit(value: f32, most: i32) -> f32 {
    let size = magnitude(value);
    let size = if size > most { most } else { size };
    // All but the sign: an instruction of its own of a Cortex-M3 and above.
    f32::from_bits(value.to_bits() & SIGN_BIT | size as u32 & !SIGN_BIT)
}

const SIGN_BIT: u32 = 1 << 31;

impl Sign {
    /// It does not hold.
    pub(crate) const NO: Self = Self(0);

    /// Of a comparison of two f32.
    #[inline(always)]
    pub(crate) const fn of(holds: bool) -> Self {
        Self((holds as i32).wrapping_neg())
    }

    /// `a > b`. The difference must fit: both are magnitudes or times, or `b` is negative infinity
    /// and `a` no NaN.
    #[inline(always)]
    pub(crate) const fn above(a: i32, b: i32) -> Self {
        Self(b.wrapping_sub(a))
    }

    /// `yes` where it holds, else `no`.
    #[inline(always)]
    pub(crate) fn select<T>(self, yes: T, no: T) -> T {
        select_unpredictable(self.holds(), yes, no)
    }

    /// As [`select`](Self::select), by bits: a selection outside of a loop became a branch.
    #[inline(always)]
    pub(crate) const fn select_bits(self, yes: f32, no: f32) -> f32 {
        let [yes, no] = [yes.to_bits() as i32, no.to_bits() as i32];
        f32::from_bits((no ^ self.keep(no ^ yes)) as u32)
    }

    /// Whether it holds.
    #[inline(always)]
    pub(crate) const fn holds(self) -> bool {
        self.0 < 0
    }

    /// `value` where it holds, else 0.
    #[inline(always)]
    pub(crate) const fn keep(self, value: i32) -> i32 {
        value & (self.0 >> 31)
    }

    /// 1 where it holds, else 0.
    #[inline(always)]
    pub(crate) const fn count(self) -> u32 {
        self.0 as u32 >> 31
    }
}

impl BitAnd for Sign {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Sign {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Sign {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_equal_where_both_hold_or_neither() {
        assert!(Sign(-1) == Sign(i32::MIN) && Sign(0) == Sign(7));
        assert!(Sign(-1) != Sign::NO);
    }
}
