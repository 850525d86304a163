//! Decisions without branches.
//!
//! A Cortex-M0 has no conditional instructions but branches, so a selection that costs the same
//! either way has to be arithmetic. The compiler knows what a mask stands for and would make
//! a selection, hence a branch, of it; on such processors a mask is hidden from it. That this
//! holds is checked by the `fixed_bench` image in QEMU.

use tempco::Status;

/// All ones for yes, zero for no.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Mask(i32);

impl Mask {
    pub(crate) const NO: Self = Self(0);
    #[cfg(test)]
    pub(crate) const YES: Self = Self(-1);

    /// Whether `value` is below zero.
    #[inline(always)]
    pub(crate) const fn negative(value: i32) -> Self {
        Self(hidden(value >> 31))
    }

    /// Whether `value` is below zero.
    #[inline(always)]
    pub(crate) const fn negative_wide(value: i64) -> Self {
        Self::negative((value >> 32) as i32)
    }

    /// Whether `a < b`, for all values: the sign of the difference, corrected where it overflows.
    #[inline(always)]
    pub(crate) const fn less(a: i32, b: i32) -> Self {
        let difference = a.wrapping_sub(b);
        Self::negative(difference ^ ((a ^ b) & (difference ^ a)))
    }

    /// Whether `value` is [`INVALID`](crate::INVALID): it alone has no bit set but the sign's, and
    /// this keeps the lowest bit that is set.
    #[inline(always)]
    pub(crate) const fn invalid(value: i32) -> Self {
        let value = hidden(value);
        Self::negative(value & value.wrapping_neg())
    }

    #[inline(always)]
    pub(crate) const fn not(self) -> Self {
        Self(!self.0)
    }

    #[inline(always)]
    pub(crate) const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    #[inline(always)]
    pub(crate) const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// `yes` or `no`.
    #[inline(always)]
    pub(crate) const fn pick(self, yes: i32, no: i32) -> i32 {
        no ^ ((yes ^ no) & self.0)
    }

    /// `value` or 0.
    #[inline(always)]
    pub(crate) const fn keep(self, value: i32) -> i32 {
        value & self.0
    }

    /// 1 or 0.
    #[inline(always)]
    pub(crate) const fn count(self) -> u32 {
        self.0 as u32 & 1
    }

    /// The flags or none.
    #[inline(always)]
    pub(crate) const fn flags(self, flags: Status) -> Status {
        Status::from_bits(flags.bits() & self.0 as u16)
    }
}

/// The value, of which the compiler then knows nothing.
#[cfg(selects_by_branch)]
#[inline(always)]
const fn hidden(value: i32) -> i32 {
    core::hint::black_box(value)
}

/// Elsewhere selections are conditional instructions, which cost the same either way.
#[cfg(not(selects_by_branch))]
#[inline(always)]
const fn hidden(value: i32) -> i32 {
    value
}

/// `|value|`; the least value stays as it is.
#[inline(always)]
pub(crate) const fn abs(value: i32) -> i32 {
    let sign = value >> 31;
    (value ^ sign).wrapping_sub(sign)
}

/// The smaller of two values whose difference does not overflow.
#[inline(always)]
pub(crate) const fn min(a: i32, b: i32) -> i32 {
    Mask::negative(a.wrapping_sub(b)).pick(a, b)
}

/// The larger of two values whose difference does not overflow.
#[inline(always)]
pub(crate) const fn max(a: i32, b: i32) -> i32 {
    Mask::negative(a.wrapping_sub(b)).pick(b, a)
}

/// `value` limited to `-limit..=limit`, `limit` not being negative.
#[inline(always)]
pub(crate) const fn limit(value: i32, limit: i32) -> i32 {
    let value = Mask::less(limit, value).pick(limit, value);
    Mask::less(value, -limit).pick(-limit, value)
}

/// `value`, far from overflow, limited to `-limit..=limit`, `limit` not being negative.
#[inline(always)]
pub(crate) const fn limit_wide(value: i64, limit: i32) -> i32 {
    let high = Mask::negative_wide(limit as i64 - value);
    let low = Mask::negative_wide(value + limit as i64);
    low.pick(-limit, high.pick(limit, value as i32))
}

/// The sum of two values that are not negative, or the largest value.
#[inline(always)]
pub(crate) const fn saturating_sum(a: i32, b: i32) -> i32 {
    let sum = a.wrapping_add(b);
    (sum | (sum >> 31)) & i32::MAX
}

/// `a - b` or the end of the range it is beyond, and whether it is.
#[inline(always)]
pub(crate) const fn saturating_difference(a: i32, b: i32) -> (i32, Mask) {
    let difference = a.wrapping_sub(b);
    let beyond = Mask::negative((a ^ b) & (a ^ difference));
    (beyond.pick(hidden(a >> 31) ^ i32::MAX, difference), beyond)
}

/// The upper word of a product: `a b / 2^32`, rounded down.
#[inline(always)]
pub(crate) const fn upper(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [i32; 11] = [
        i32::MIN,
        i32::MIN + 1,
        -(1 << 30),
        -2,
        -1,
        0,
        1,
        2,
        1 << 30,
        i32::MAX - 1,
        i32::MAX,
    ];

    fn mask(condition: bool) -> Mask {
        if condition { Mask::YES } else { Mask::NO }
    }

    #[test]
    fn decisions_are_those_of_the_operators_at_all_borders() {
        for a in VALUES {
            assert_eq!(Mask::negative(a), mask(a < 0));
            assert_eq!(Mask::negative_wide(i64::from(a) << 3), mask(a < 0));
            assert_eq!(Mask::invalid(a), mask(a == i32::MIN));
            assert_eq!(abs(a), a.wrapping_abs());
            for b in VALUES {
                assert_eq!(Mask::less(a, b), mask(a < b), "{a} < {b}");
                assert_eq!(Mask::YES.pick(a, b), a);
                assert_eq!(Mask::NO.pick(a, b), b);
                let (difference, beyond) = saturating_difference(a, b);
                assert_eq!(difference, a.saturating_sub(b));
                assert_eq!(beyond, mask(a.checked_sub(b).is_none()));
                if a >= 0 && b >= 0 {
                    assert_eq!(saturating_sum(a, b), a.saturating_add(b));
                    assert_eq!((min(a, b), max(a, b)), (a.min(b), a.max(b)));
                }
                if b >= 0 {
                    assert_eq!(limit(a, b), a.clamp(-b, b));
                    let wide = i64::from(a) << 3;
                    let clamped = wide.clamp(-i64::from(b), b.into());
                    assert_eq!(i64::from(limit_wide(wide, b)), clamped);
                }
            }
        }
    }

    #[test]
    fn masks_combine_like_truths() {
        for (a, b) in [(false, false), (false, true), (true, false), (true, true)] {
            assert_eq!(mask(a).and(mask(b)), mask(a && b));
            assert_eq!(mask(a).or(mask(b)), mask(a || b));
            assert_eq!(mask(a).not(), mask(!a));
            assert_eq!(mask(a).count(), u32::from(a));
            assert_eq!(mask(a).keep(5), if a { 5 } else { 0 });
            let flags = if a { Status::SETTLING } else { Status::OK };
            assert_eq!(mask(a).flags(Status::SETTLING), flags);
        }
    }
}
