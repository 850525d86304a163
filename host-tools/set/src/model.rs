//! The fitted model of one axis in f64: a polynomial per segment.

use std::ops::{Add, Mul};

use serde::{Deserialize, Serialize};
use tempco::Terms;

use crate::segment::{Overlap, Piece, Segment, Segmentation};

/// The number of terms of the composite model: static terms and rate terms.
pub const COMPOSITE: usize = Terms::STATIC + Terms::RATE;

/// The regressors of the composite model, in the order of [`Terms::NAMES`], in which a fit drops
/// them from the end.
pub const TERMS: [&str; COMPOSITE] = ["1", "T", "T^2", "T'", "T T'"];

/// The same in the basis of a segment.
pub const LOCAL_TERMS: [&str; COMPOSITE] = ["1", "z", "z^2", "T'", "z T'"];

/// The static and the rate coefficients of a list; 0 where it ends.
pub(crate) fn split(list: &[f64]) -> ([f64; Terms::STATIC], [f64; Terms::RATE]) {
    let at = |term: usize| list.get(term).copied().unwrap_or(0.0);
    let rate = std::array::from_fn(|term| at(Terms::STATIC + term));
    (std::array::from_fn(at), rate)
}

/// The inverse of [`split`].
pub(crate) fn join(a: &[f64; Terms::STATIC], r: &[f64; Terms::RATE]) -> [f64; COMPOSITE] {
    std::array::from_fn(|term| match term.checked_sub(Terms::STATIC) {
        None => a[term],
        Some(term) => r[term],
    })
}

/// `c[0] + c[1] z + c[2] z^2 ...` by Horner's rule, as the core does it.
pub(crate) fn horner<T>(coefficients: &[T], z: T) -> T
where
    T: Copy + Default + Add<Output = T> + Mul<Output = T>,
{
    let powers = coefficients.iter().rev().copied();
    powers.reduce(|sum, c| c + z * sum).unwrap_or_default()
}

/// The polynomial of one segment, in the centred and scaled basis `z = (T - centre) / half_width`.
///
/// ```text
/// B(T, T', d2) = a0 + a1 z + a2 z^2 + T' (r0 + r1 z) + d2 (s0 + s1 z)
///                                                  T' in degC/min, d2 in degC
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    /// Middle of the segment \[degC\].
    pub centre_c: f64,
    /// Half the width of the segment \[degC\].
    pub half_width_c: f64,
    /// Static coefficients, lowest power first \[unit of the axis\].
    pub a: [f64; Terms::STATIC],
    /// Rate coefficients, lowest power first \[unit of the axis per degC/min\].
    pub r: [f64; Terms::RATE],
    /// Coefficients of the second lag, lowest power first \[unit of the axis per degC\].
    pub s: [f64; Terms::LAG],
}

impl Polynomial {
    /// The polynomial over `segment` with the leading coefficients of `1, z, z^2, T', z T'`.
    pub fn new(segment: &Segment, coefficients: &[f64]) -> Self {
        let (a, r) = split(coefficients);
        Self {
            centre_c: segment.centre_c(),
            half_width_c: segment.half_width_c(),
            a,
            r,
            s: [0.0; Terms::LAG],
        }
    }

    /// The coefficients in the order of [`TERMS`].
    pub fn coefficients(&self) -> [f64; COMPOSITE] {
        join(&self.a, &self.r)
    }

    /// The polynomial from coefficients of `1, T, T^2` in degC.
    pub fn from_raw_static(segment: &Segment, [a0, a1, a2]: [f64; 3]) -> Self {
        let (c, h) = (segment.centre_c(), segment.half_width_c());
        let a = [a0 + c * (a1 + c * a2), h * (a1 + 2.0 * c * a2), h * h * a2];
        Self::new(segment, &a)
    }

    /// Coefficients of `1, T, T^2, T', T T'` in degC and degC/min, for reports.
    pub fn raw(&self) -> [f64; COMPOSITE] {
        let (c, h) = (self.centre_c, self.half_width_c);
        let [a0, a1, a2] = self.a;
        let [r0, r1] = self.r;
        [
            a0 - a1 * c / h + a2 * c * c / (h * h),
            a1 / h - 2.0 * a2 * c / (h * h),
            a2 / (h * h),
            r0 - r1 * c / h,
            r1 / h,
        ]
    }

    /// The local coordinate of a temperature.
    pub fn z(&self, temp_c: f64) -> f64 {
        (temp_c - self.centre_c) / self.half_width_c
    }

    /// Bias at zero rate \[unit of the axis\].
    pub fn static_bias(&self, temp_c: f64) -> f64 {
        horner(&self.a, self.z(temp_c))
    }

    /// Bias per rate \[unit of the axis per degC/min\].
    pub fn rate_bias(&self, temp_c: f64) -> f64 {
        horner(&self.r, self.z(temp_c))
    }

    /// Bias at zero rate, bias per rate, bias per second lag.
    fn parts(&self, temp_c: f64) -> [f64; 3] {
        let z = self.z(temp_c);
        [&self.a[..], &self.r, &self.s].map(|part| horner(part, z))
    }
}

/// The model of one axis over all segments.
#[derive(Clone, Copy, Debug)]
pub struct AxisModel<'a> {
    /// The polynomial of each segment.
    pub polynomials: &'a [Polynomial],
    /// What is applied where segments overlap.
    pub overlap: Overlap,
}

impl AxisModel<'_> {
    /// Static bias at a temperature \[unit of the axis\].
    pub fn static_bias(&self, segmentation: &Segmentation, temp_c: f64) -> f64 {
        let pieces = segmentation.pieces(self.overlap);
        let last = pieces.len() - 1;
        let mut below = pieces[..last].iter();
        let piece = below.find(|piece| temp_c < piece.to_c);
        self.at(piece.unwrap_or(&pieces[last]), temp_c)[0]
    }

    /// Static bias, bias per rate and bias per second lag at a temperature of `piece`.
    pub fn at(&self, piece: &Piece, temp_c: f64) -> [f64; 3] {
        let cold = self.polynomials[piece.segment].parts(temp_c);
        if !piece.blended {
            return cold;
        }
        let hot = self.polynomials[piece.segment + 1].parts(temp_c);
        let weight = piece.weight(self.overlap, temp_c);
        std::array::from_fn(|part| cold[part] + weight * (hot[part] - cold[part]))
    }
}

/// How far two neighbours disagree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mismatch {
    /// Cold end of the overlap \[degC\].
    pub t_min_c: f64,
    /// Hot end of the overlap \[degC\].
    pub t_max_c: f64,
    /// Largest difference of the static polynomials over the overlap \[unit of the axis\].
    pub overlap_mismatch: f64,
    /// Difference of the static polynomials in the middle of the overlap, where a hard switch
    /// would be, hotter minus colder \[unit of the axis\].
    pub switch_jump: f64,
}

/// The disagreement of each two neighbours of an axis.
pub(crate) fn mismatches(segmentation: &Segmentation, polynomials: &[Polynomial]) -> Vec<Mismatch> {
    const STEPS: u32 = 200;
    let pairs = segmentation.segments().windows(2);
    pairs
        .zip(polynomials.windows(2))
        .map(|(segments, neighbours)| {
            let (t_min_c, t_max_c) = (segments[1].t_min_c, segments[0].t_max_c);
            let difference = |share: f64| {
                let temp_c = t_min_c + share * (t_max_c - t_min_c);
                neighbours[1].static_bias(temp_c) - neighbours[0].static_bias(temp_c)
            };
            Mismatch {
                t_min_c,
                t_max_c,
                overlap_mismatch: (0..=STEPS)
                    .map(|step| difference(f64::from(step) / f64::from(STEPS)).abs())
                    .fold(0.0, f64::max),
                switch_jump: difference(0.5),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEGMENT: Segment = Segment {
        t_min_c: 5.0,
        t_max_c: 35.0,
    };

    #[test]
    fn raw_and_centred_bases_are_the_same_polynomial() {
        let raw = [0.0064, 0.0004, -4.2567e-5];
        let polynomial = Polynomial::from_raw_static(&SEGMENT, raw);
        for temp_c in [5.0, 11.0, 35.0] {
            let expected = raw[0] + raw[1] * temp_c + raw[2] * temp_c * temp_c;
            assert!((polynomial.static_bias(temp_c) - expected).abs() < 1e-15);
        }
        let composite = Polynomial::new(&SEGMENT, &[1.0, 2.0, 3.0, 4.0, 5.0]);
        let back = composite.raw();
        let (t, rate) = (13.0, -0.7);
        let expected = composite.static_bias(t) + rate * composite.rate_bias(t);
        let found = back[0] + back[1] * t + back[2] * t * t + rate * (back[3] + back[4] * t);
        assert!((found - expected).abs() < 1e-12);
    }

    #[test]
    fn dropped_terms_are_zero() {
        let polynomial = Polynomial::new(&SEGMENT, &[1.0, 2.0]);
        assert_eq!((polynomial.a, polynomial.r), ([1.0, 2.0, 0.0], [0.0; 2]));
    }
}
