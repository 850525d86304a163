//! The coefficients of the bias model, and the polynomial that they are of.

use crate::error::{MAX_COEFFICIENT, is_within};

/// The coefficients of one axis in one cell, lowest power first.
///
/// `z` runs from 0 at the cold edge of the cell to 1 at its hot edge, so `a[0]` is the bias at
/// the cold edge and `a[0] + a[1] + a[2]` the bias at the hot edge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "zerocopy",
    derive(zerocopy::FromBytes, zerocopy::IntoBytes, zerocopy::Immutable)
)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "[f32; Terms::COUNT]", from = "[f32; Terms::COUNT]")
)]
#[repr(C)]
pub struct Terms {
    /// Bias at zero rate: `a[0] + a[1] z + a[2] z^2` \[unit of the axis\].
    pub a: [f32; Terms::STATIC],
    /// Bias per rate: `r[0] + r[1] z` \[unit of the axis per degC/min\].
    pub r: [f32; Terms::RATE],
    /// Bias per second lag: `s[0] + s[1] z` \[unit of the axis per degC\].
    pub s: [f32; Terms::LAG],
}

impl Terms {
    /// The coefficients `a` and `r`, lowest power first; those that are not given are 0, and so
    /// are the terms of the second lag.
    pub const fn new<const A: usize, const R: usize>(a: [f32; A], r: [f32; R]) -> Self {
        const { assert!(A <= Self::STATIC && R <= Self::RATE) }
        let mut terms = Self {
            a: [0.0; Self::STATIC],
            r: [0.0; Self::RATE],
            s: [0.0; Self::LAG],
        };
        let mut power = 0;
        while power < A {
            terms.a[power] = a[power];
            power += 1;
        }
        let mut power = 0;
        while power < R {
            terms.r[power] = r[power];
            power += 1;
        }
        terms
    }

    /// The bias at place `z` in the cell, rate `rate_c_per_min` and second lag `lag2_c`
    /// (without the latter the composite model of Weng et al. 2020, in the basis of the cell).
    #[inline(always)]
    pub fn bias(&self, z: f32, rate_c_per_min: f32, lag2_c: f32) -> f32 {
        let [a0, a1, a2] = self.a;
        let [r0, r1] = self.r;
        let [s0, s1] = self.s;
        let bias = (a0 + z * (a1 + z * a2)) + rate_c_per_min * (r0 + z * r1);
        bias + lag2_c * (s0 + z * s1)
    }
}

/// The first of some terms with a coefficient that is not.
pub(crate) const fn first_unusable(terms: &[Terms]) -> Option<usize> {
    let mut i = 0;
    while i < terms.len() {
        if !are_usable(&terms[i].to_array()) {
            return Some(i);
        }
        i += 1;
    }
    None
}

/// Whether each of some coefficients is finite and no larger than a table may have.
pub(crate) const fn are_usable(values: &[f32]) -> bool {
    let mut i = 0;
    while i < values.len() {
        if !is_within(values[i], -MAX_COEFFICIENT, MAX_COEFFICIENT) {
            return false;
        }
        i += 1;
    }
    true
}

/// The list of terms, and conversions to and from arrays in its order.
macro_rules! in_order {
    ([$($a:ident),+], [$($r:ident),+], [$($s:ident),+]) => {
        impl Terms {
            /// Number of static coefficients, `a`.
            pub const STATIC: usize = [$(stringify!($a)),+].len();

            /// Number of rate coefficients, `r`.
            pub const RATE: usize = [$(stringify!($r)),+].len();

            /// Number of coefficients of the second lag, `s`.
            pub const LAG: usize = [$(stringify!($s)),+].len();

            /// Number of all coefficients.
            pub const COUNT: usize = Self::STATIC + Self::RATE + Self::LAG;

            /// Names of the coefficients: those of `a`, `r`, `s`, lowest power first.
            pub const NAMES: [&'static str; Self::COUNT] =
                [$(stringify!($a),)+ $(stringify!($r),)+ $(stringify!($s)),+];

            /// The coefficients in the order of [`NAMES`](Self::NAMES).
            pub const fn to_array(&self) -> [f32; Self::COUNT] {
                let ([$($a),+], [$($r),+], [$($s),+]) = (self.a, self.r, self.s);
                [$($a,)+ $($r,)+ $($s),+]
            }

            /// The inverse of [`to_array`](Self::to_array).
            pub const fn from_array([$($a,)+ $($r,)+ $($s),+]: [f32; Self::COUNT]) -> Self {
                Self { a: [$($a),+], r: [$($r),+], s: [$($s),+] }
            }
        }
    };
}

in_order!([a0, a1, a2], [r0, r1], [s0, s1]);

impl From<Terms> for [f32; Terms::COUNT] {
    fn from(terms: Terms) -> Self {
        terms.to_array()
    }
}

impl From<[f32; Terms::COUNT]> for Terms {
    fn from(values: [f32; Terms::COUNT]) -> Self {
        Self::from_array(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_go_through_an_array_and_those_not_given_are_zero() {
        let terms = Terms::new([1.0, 2.0], [8.0]);
        let numbers: [f32; Terms::COUNT] = terms.into();
        assert_eq!(numbers, [1.0, 2.0, 0.0, 8.0, 0.0, 0.0, 0.0]);
        assert_eq!(Terms::from(numbers), terms);
    }

    #[test]
    fn bias_is_the_polynomial_of_all_terms() {
        let terms = Terms::from_array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0]);
        assert_eq!(terms.bias(0.0, 0.0, 0.0), 1.0);
        assert_eq!(terms.bias(0.5, 0.0, 0.0), 1.0 + 1.0 + 1.0);
        assert_eq!(terms.bias(0.5, 2.0, 0.0), 3.0 + 2.0 * (8.0 + 8.0));
        assert_eq!(terms.bias(0.5, 0.0, -1.0), 3.0 - (32.0 + 32.0));
    }
}
