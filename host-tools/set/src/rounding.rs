//! How far the core's f32 arithmetic can be from exact arithmetic, for a given table.
//!
//! A running error analysis: each operation rounds to nearest, so that its result is off by a
//! share of [`UNIT`] of its magnitude at most, or by [`UNDERFLOW`] where it is subnormal. Errors of
//! the operands are passed on. All of it is computed in f64 and enlarged by [`SLACK`], which
//! outweighs the rounding of the analysis itself many times over.

use crate::TableData;

/// Largest relative error of an f32 operation.
const UNIT: f64 = 1.0 / (1 << 24) as f64;
/// Largest error of a subnormal result: half of 2^-149.
const UNDERFLOW: f64 = f32::from_bits(1) as f64 / 2.0;
/// Allowance for the rounding of this analysis in f64.
const SLACK: f64 = 1.0 + 1e-9;

/// Bound on the rounding of one axis over the calibrated temperatures and rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoundingBound {
    /// Error of the polynomial for the place it is given \[unit of the axis\].
    pub evaluation: f64,
    /// Error of the place within the cell \[cells\].
    pub place: f64,
    /// Error of the bias for the lag-compensated temperature and the values of rate, second lag and
    /// plays: the polynomial's, the place's times the steepest slope, and a product and a sum for
    /// each play \[unit of the axis\].
    pub total: f64,
    /// How far from an edge between cells the neighbour may be evaluated instead \[degC\].
    pub edge_c: f64,
}

impl TableData {
    /// The largest difference between the bias of an axis as the core computes it and the exact
    /// value of the same coefficients at the same lag-compensated temperature, rate and second lag,
    /// for every f32 temperature and every calibrated rate and lag, in the cell that the core chose.
    ///
    /// # Panics
    /// If the table has no such axis.
    pub fn rounding_bound(&self, axis: usize) -> RoundingBound {
        let thermal = &self.thermal;
        let rate = f64::from(thermal.rate_max_c_per_min.max(-thermal.rate_min_c_per_min));
        let lag = f64::from(thermal.lag2_max_c.max(-thermal.lag2_min_c));
        let place = self.place_error();
        let mut bound = RoundingBound {
            place,
            edge_c: place * self.cell_width_c(),
            ..RoundingBound::default()
        };
        for cell in &self.cells {
            let terms = cell[axis];
            let a = terms.a.map(f64::from);
            let by = [
                (terms.r.map(f64::from), rate),
                (terms.s.map(f64::from), lag),
            ];
            let evaluation = evaluation_error(&a, &by);
            let slope = slope(&a, &by, place);
            bound.evaluation = bound.evaluation.max(evaluation);
            let polynomial = Rounded {
                most: by
                    .iter()
                    .fold(most(&a), |sum, (part, factor)| sum + factor * most(part)),
                error: (evaluation + slope * place) * SLACK,
            };
            let with_plays = self
                .plays_most(axis)
                .fold(polynomial, Rounded::plus_product);
            bound.total = bound.total.max(with_plays.error * SLACK);
        }
        bound
    }

    /// For each play that is used, the largest product of gain and value, which is within its slot.
    fn plays_most(&self, axis: usize) -> impl Iterator<Item = f64> {
        let plays = self.half_widths_c().into_iter().zip(self.play_gains[axis]);
        let used = plays.filter(|(half_width_c, _)| *half_width_c > 0.0);
        // The contact is rounded to its place at the edge of the slot.
        used.map(|(half_width_c, gain)| {
            f64::from(half_width_c) * f64::from(gain).abs() * (1.0 + 1e-3)
        })
    }

    /// Width of a cell \[degC\].
    pub fn cell_width_c(&self) -> f64 {
        (f64::from(self.last_edge_c) - f64::from(self.first_edge_c)) / self.cells.len() as f64
    }

    /// The factor by which the core computes places \[1/degC\]: the nearest f32 to the number of
    /// cells per degree that leaves the hottest temperature below the number of cells.
    pub fn cells_per_c(&self) -> f32 {
        let (count, span_c) = (
            self.cells.len() as f32,
            self.last_edge_c - self.first_edge_c,
        );
        let mut cells_per_c = count / span_c;
        while span_c * cells_per_c >= count {
            cells_per_c = cells_per_c.next_down();
        }
        cells_per_c
    }

    /// Largest error of `(T - first_edge) cells_per_c`; taking the whole cells off is exact.
    fn place_error(&self) -> f64 {
        let exact = 1.0 / self.cell_width_c();
        let factor = (f64::from(self.cells_per_c()) / exact - 1.0).abs() + 1e-15;
        let relative = (1.0 + factor) * (1.0 + UNIT) * (1.0 + UNIT) - 1.0;
        let hottest = (f64::from(self.t_max_c) - f64::from(self.first_edge_c)) * exact;
        (hottest * relative + UNDERFLOW) * SLACK
    }
}

/// A number that is known to a bound: its largest magnitude, exactly computed, and its error.
#[derive(Clone, Copy)]
struct Rounded {
    most: f64,
    error: f64,
}

impl Rounded {
    const fn exact(most: f64) -> Self {
        Self { most, error: 0.0 }
    }

    /// A result of magnitude `most` whose operands bring in `error`.
    fn new(most: f64, error: f64) -> Self {
        Self {
            most,
            error: error + UNIT * (most + error) + UNDERFLOW,
        }
    }

    /// The product with an exact number of at most this magnitude.
    fn times(self, most: f64) -> Self {
        Self::new(self.most * most, self.error * most)
    }

    /// The sum with a rounded product of exact numbers that is at most so large.
    fn plus_product(self, most: f64) -> Self {
        let product = Self::new(most, 0.0);
        Self::new(self.most + most, self.error + product.error)
    }

    /// The sum with an exact number, of a known magnitude.
    fn plus_exact(self, most: f64) -> Self {
        Self::new(most, self.error)
    }
}

/// Error of the polynomial `a` plus other polynomials, each times a number up to a limit, all by
/// Horner's rule in f32, for z from 0 to 1.
fn evaluation_error(a: &[f64], by: &[([f64; 2], f64)]) -> f64 {
    let sum = by.iter().fold(horner_error(a), |sum, (part, factor)| {
        let product = horner_error(part).times(*factor);
        // The sum with 0 is exact.
        if product.most == 0.0 {
            return sum;
        }
        Rounded::new(sum.most + product.most, sum.error + product.error)
    });
    sum.error * SLACK
}

/// A polynomial by Horner's rule for z from 0 to 1.
fn horner_error(coefficients: &[f64]) -> Rounded {
    let last = coefficients.len() - 1;
    let highest = Rounded::exact(coefficients[last].abs());
    (0..last).rev().fold(highest, |sum, power| {
        sum.times(1.0).plus_exact(most(&coefficients[power..]))
    })
}

/// Largest magnitude of a polynomial for z from 0 to 1; a bound on it beyond quadratics.
fn most(coefficients: &[f64]) -> f64 {
    match *coefficients {
        [] => 0.0,
        [c0, c1] => c0.abs().max((c0 + c1).abs()),
        [c0, c1, c2] => {
            let ends = c0.abs().max((c0 + c1 + c2).abs());
            let z = -0.5 * c1 / c2;
            if (0.0..=1.0).contains(&z) {
                ends.max((c0 + 0.5 * c1 * z).abs())
            } else {
                ends
            }
        }
        [c0, ref higher @ ..] => c0.abs() + most(higher),
    }
}

/// The same for z up to `beyond` outside of 0 to 1.
fn most_around(coefficients: &[f64], beyond: f64) -> f64 {
    match coefficients {
        [] => 0.0,
        _ => most(coefficients) + beyond * most_around(&derivative(coefficients), beyond),
    }
}

fn derivative(coefficients: &[f64]) -> Vec<f64> {
    let powers = coefficients.iter().enumerate().skip(1);
    powers.map(|(power, c)| power as f64 * c).collect()
}

/// Steepest slope per cell, also a little beyond its edges.
fn slope(a: &[f64], by: &[([f64; 2], f64)], beyond: f64) -> f64 {
    let of = |part: &[f64]| most_around(&derivative(part), beyond);
    by.iter()
        .fold(of(a), |sum, (part, factor)| sum + factor * of(part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::horner;
    use crate::{TableUse, use_axis};
    use proptest::prelude::*;
    use tempco::{Compensator, Interval, PLAYS, Table, Terms, ThermalPoint, ThermalSettings};

    fn table(terms: Terms, edges: (f32, f32), count: usize, (rate, lag): (f32, f32)) -> TableData {
        let settings = ThermalSettings {
            rate_min_c_per_min: -rate,
            rate_max_c_per_min: rate,
            lag2_min_c: -lag,
            lag2_max_c: lag,
            ..ThermalSettings::DEFAULT
        };
        TableData {
            thermal: settings,
            first_edge_c: edges.0,
            last_edge_c: edges.1,
            t_min_c: edges.0,
            t_max_c: edges.1,
            cells: vec![vec![terms]; count],
            play_gains: vec![[0.0; PLAYS]],
        }
    }

    /// The bias in exact arithmetic.
    fn bias(terms: &Terms, z: f64, rate: f64, lag: f64) -> f64 {
        let fixed = horner(&terms.a.map(f64::from), z);
        let by_rate = rate * horner(&terms.r.map(f64::from), z);
        fixed + by_rate + lag * horner(&terms.s.map(f64::from), z)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn measured_errors_stay_within_the_bound(
            terms in prop::array::uniform::<_, { Terms::COUNT }>(-1.0_f32..1.0),
            exponents in prop::array::uniform::<_, { Terms::COUNT }>(-20_i32..10),
            first in -80.0_f32..20.0,
            span in 1.0_f32..200.0,
            count in 1_usize..=1024,
            at in 0.0_f32..=1.0,
            rate in 0.0_f32..30.0,
            lag in prop_oneof![Just(0.0_f32), 0.0_f32..30.0],
            share in -1.0_f32..=1.0,
        ) {
            let terms = std::array::from_fn(|i| terms[i] * 2.0_f32.powi(exponents[i]));
            let table = table(Terms::from_array(terms), (first, first + span), count, (rate, lag));
            let bound = table.rounding_bound(0);
            let cells = table.terms::<1>(0);
            let core = table.table_over(0, &cells).unwrap();
            let effective_c = (first + span * at).min(table.t_max_c);
            let (rate, lag) = (rate * share, lag * share);
            let place = core.place(effective_c);
            let z = f64::from(place.z);
            let polynomial = |z: f64| bias(&table.cells[0][0], z, rate.into(), lag.into());
            let bias = f64::from(core.cells()[place.cell][0].bias(place.z, rate, lag));
            prop_assert!((bias - polynomial(z)).abs() <= bound.evaluation);
            let exact = (f64::from(effective_c) - f64::from(first)) / table.cell_width_c()
                - place.cell as f64;
            prop_assert!((z - exact).abs() <= bound.place);
            prop_assert!((bias - polynomial(exact)).abs() <= bound.total);
            let point = ThermalPoint {
                effective_c,
                rate_c_per_min: rate,
                lag2_c: lag,
                ..ThermalPoint::default()
            };
            prop_assert_eq!(f64::from(core.bias(&point).0[0]), bias);
        }
    }

    /// The bias of a compensator is within the bound of what its point makes in exact arithmetic.
    #[test]
    fn history_terms_add_a_product_and_a_sum_each() {
        let terms = [3.0, 0.1, -0.02, 0.5, 0.01, -0.3, 0.0];
        let mut data = table(Terms::from_array(terms), (-20.0, 80.0), 20, (5.0, 0.0));
        let without = data.rounding_bound(0).total;
        (data.thermal.lag2_min_c, data.thermal.lag2_max_c) = (-20.0, 20.0);
        (data.thermal.half_width1_c, data.play_gains[0][0]) = (3.0, 0.7);
        let bound = data.rounding_bound(0).total;
        assert!(bound > without + (3.0 * 0.7 + 20.0 * 0.3) * UNIT);
        let worst = use_axis(&data, 0, Measure(&data)).unwrap();
        assert!(worst <= bound && worst > 0.02 * bound, "{worst} {bound}");
    }

    struct Measure<'a>(&'a TableData);

    impl TableUse for Measure<'_> {
        type Output = f64;

        fn with<const CHANNELS: usize, const AXES: usize>(
            self,
            tables: &[Table<AXES>; CHANNELS],
        ) -> f64 {
            let core = &tables[0];
            let mut unit = Compensator::new(core);
            unit.start(20.0);
            let interval = Interval::new(core.thermal(), 1.0);
            let steps = (0..20_000).map(|i| {
                let temp_c = 30.0 + 40.0 * (0.003 * i as f32).sin();
                let out = unit.step(&interval, temp_c, [0.0; AXES]);
                let u = f64::from(out.point.effective_c);
                let exact = (u - f64::from(self.0.first_edge_c)) / self.0.cell_width_c();
                let z = exact - core.place(out.point.effective_c).cell as f64;
                let (rate, lag) = (out.point.rate_c_per_min.into(), out.point.lag2_c.into());
                let mut bias = bias(&self.0.cells[0][0], z, rate, lag);
                for (gain, play_c) in self.0.play_gains[0].into_iter().zip(out.point.plays_c) {
                    bias += f64::from(gain) * f64::from(play_c);
                }
                (bias - f64::from(out.bias[0])).abs()
            });
            steps.fold(0.0, f64::max)
        }
    }

    /// The bound for any table: 18 half-units of the last place of the largest coefficient.
    #[test]
    fn the_generic_bound_is_eighteen_units() {
        let bound = evaluation_error(&[1.0; 3], &[([1.0; 2], 1.0)]);
        let mixed = evaluation_error(&[1.0, 0.5, -1.0], &[([1.0, -1.0], 1.0)]);
        assert!(bound <= 18.01 * UNIT, "{bound}");
        assert!(mixed <= 18.01 * UNIT, "{mixed}");
    }

    #[test]
    fn a_flat_table_rounds_by_its_own_last_place_only() {
        let bound = table(Terms::new([3.0], []), (0.0, 1.0), 1, (0.0, 0.0)).rounding_bound(0);
        assert!(bound.total < 3.0 * 3.0 * UNIT, "{}", bound.total);
    }
}
