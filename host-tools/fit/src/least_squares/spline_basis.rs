//! Regressors of the spline model: quadratic B-splines for the static part, straight lines or
//! hats for the rate part and the second lag, a constant per log, plays.

use std::ops::Range;

use tempco::Terms;
use tempco_set::{Polynomial, Segment};

/// How the bias per rate depends on the lag-compensated temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RateForm {
    /// No rate term.
    None,
    /// One straight line over the whole range.
    Line,
    /// Straight within each segment or over some of them, continuous.
    Hats,
}

/// Columns of the least squares of a spline.
///
/// In this order: `segments + 2` quadratic B-splines, which are C1 over the breakpoints and add up
/// to 1; for several logs, one column less than logs, in which the constants of the logs differ
/// from their mean; the rate columns; hats for the second lag; the plays, one column each over the
/// whole range.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Basis {
    /// Ends of the range and the breakpoints between, ascending \[degC\].
    breakpoints_c: Vec<f64>,
    rate: RateForm,
    logs: usize,
    /// Segments that a hat is straight over.
    straight: usize,
    lag2: bool,
    plays: usize,
}

/// A row of which few entries are not zero.
pub(crate) type SparseRow = Vec<(usize, f64)>;

impl Basis {
    /// # Panics
    /// With fewer than two breakpoints.
    pub(crate) fn new(breakpoints_c: Vec<f64>, rate: RateForm, logs: usize) -> Self {
        assert!(breakpoints_c.len() >= 2 && breakpoints_c.is_sorted());
        Self {
            breakpoints_c,
            rate,
            logs,
            straight: 1,
            lag2: false,
            plays: 0,
        }
    }

    /// The same basis with hats that are straight over some segments, which must divide their
    /// number: what a gain does over the range is known less finely than the curve.
    pub(crate) fn with_hats_over(self, straight: usize) -> Self {
        assert!(self.segments().is_multiple_of(straight));
        Self { straight, ..self }
    }

    /// The same basis with columns for the second lag and for plays.
    pub(crate) fn with_history(self, lag2: bool, plays: usize) -> Self {
        Self {
            lag2,
            plays,
            ..self
        }
    }

    pub(crate) fn logs(&self) -> usize {
        self.logs
    }

    pub(crate) fn segments(&self) -> usize {
        self.breakpoints_c.len() - 1
    }

    pub(crate) fn static_columns(&self) -> usize {
        self.segments() + 2
    }

    pub(crate) fn rate_columns(&self) -> usize {
        match self.rate {
            RateForm::None => 0,
            RateForm::Line => 2,
            RateForm::Hats => self.hat_columns(),
        }
    }

    /// The columns before the rate terms.
    pub(crate) fn columns_without_rate(&self) -> usize {
        self.static_columns() + self.logs - 1
    }

    /// The columns of the second lag.
    pub(crate) fn lag2_columns(&self) -> Range<usize> {
        let first = self.columns_without_rate() + self.rate_columns();
        let hats = if self.lag2 { self.hat_columns() } else { 0 };
        first..first + hats
    }

    /// The columns of the plays.
    pub(crate) fn play_columns(&self) -> Range<usize> {
        let first = self.lag2_columns().end;
        first..first + self.plays
    }

    pub(crate) fn columns(&self) -> usize {
        self.play_columns().end
    }

    /// Writes the entries of a row; a temperature beyond the range counts as its nearest end.
    pub(crate) fn row(&self, log: usize, temp_c: f64, rate: f64, row: &mut SparseRow) {
        row.clear();
        let last = self.segments();
        let temp_c = temp_c.clamp(self.breakpoints_c[0], self.breakpoints_c[last]);
        let segment = self.segment(temp_c);
        let splines = self.splines(segment, temp_c);
        row.extend((segment..).zip(splines));
        let first_log = self.static_columns();
        if log + 1 < self.logs {
            row.push((first_log + log, 1.0));
        } else {
            row.extend((0..log).map(|other| (first_log + other, -1.0)));
        }
        self.rate_entries(segment, temp_c, rate, row);
    }

    /// Appends the second lag at a temperature, and what the plays are behind, to a row.
    pub(crate) fn push_history(
        &self,
        temp_c: f64,
        lag2_c: f64,
        plays_c: impl IntoIterator<Item = f64>,
        row: &mut SparseRow,
    ) {
        if self.lag2 {
            let (low, high) = (self.breakpoints_c[0], self.breakpoints_c[self.segments()]);
            let temp_c = temp_c.clamp(low, high);
            let (first, segment) = (self.lag2_columns().start, self.segment(temp_c));
            self.hats(first, segment, temp_c, lag2_c, row);
        }
        row.extend(self.play_columns().zip(plays_c));
    }

    fn rate_entries(&self, segment: usize, temp_c: f64, rate: f64, row: &mut SparseRow) {
        let first = self.columns_without_rate();
        let at = &self.breakpoints_c;
        match self.rate {
            RateForm::None => {}
            RateForm::Line => {
                let (low, high) = (at[0], at[at.len() - 1]);
                let z = (2.0 * temp_c - low - high) / (high - low);
                row.extend([(first, rate), (first + 1, z * rate)]);
            }
            RateForm::Hats => self.hats(first, segment, temp_c, rate, row),
        }
    }

    fn hat_columns(&self) -> usize {
        self.segments() / self.straight + 1
    }

    /// The two hats that are not zero in a segment, times a factor.
    fn hats(&self, first: usize, segment: usize, temp_c: f64, factor: f64, row: &mut SparseRow) {
        let at = &self.breakpoints_c;
        let hat = segment / self.straight;
        let (low, high) = (at[hat * self.straight], at[(hat + 1) * self.straight]);
        let x = (temp_c - low) / (high - low);
        row.push((first + hat, (1.0 - x) * factor));
        row.push((first + hat + 1, x * factor));
    }

    fn segment(&self, temp_c: f64) -> usize {
        let inner = &self.breakpoints_c[1..self.segments()];
        inner.partition_point(|&breakpoint| breakpoint <= temp_c)
    }

    /// The three B-splines that are not zero in a segment (de Boor's recurrence; the end
    /// breakpoints count three times).
    fn splines(&self, segment: usize, temp_c: f64) -> [f64; 3] {
        let knot = |offset: isize| {
            let at = (segment as isize + offset).clamp(0, self.segments() as isize);
            self.breakpoints_c[at as usize]
        };
        let [k0, k1, k2, k3] = [knot(-1), knot(0), knot(1), knot(2)];
        let (left, right) = ((k2 - temp_c) / (k2 - k1), (temp_c - k1) / (k2 - k1));
        let (from_left, from_right) = ((temp_c - k0) / (k2 - k0), (temp_c - k1) / (k3 - k1));
        [
            left * (1.0 - from_left),
            left * from_left + right * (1.0 - from_right),
            right * from_right,
        ]
    }

    /// For each segment, the coefficients of its [`Polynomial`] as combinations of the columns, in
    /// the order of [`Terms::NAMES`]: a quadratic is given by three places, a line by two.
    pub(crate) fn polynomial_maps(&self) -> Vec<(Segment, [SparseRow; Terms::COUNT])> {
        let pairs = self.breakpoints_c.windows(2).enumerate();
        pairs
            .map(|(k, pair)| {
                let segment = Segment {
                    t_min_c: pair[0],
                    t_max_c: pair[1],
                };
                let value = |temp_c: f64| (k..).zip(self.splines(k, temp_c)).collect::<SparseRow>();
                let slope = |temp_c: f64| {
                    let mut row = SparseRow::new();
                    self.rate_entries(k, temp_c, 1.0, &mut row);
                    row
                };
                let of_lag = |temp_c: f64| {
                    let mut row = SparseRow::new();
                    if self.lag2 {
                        self.hats(self.lag2_columns().start, k, temp_c, 1.0, &mut row);
                    }
                    row
                };
                let [cold, mid, hot] = [pair[0], segment.centre_c(), pair[1]].map(value);
                let [rate_cold, rate_hot] = [pair[0], pair[1]].map(slope);
                let [lag_cold, lag_hot] = [pair[0], pair[1]].map(of_lag);
                let a2 = sum(&[(0.5, &cold), (-1.0, &mid), (0.5, &hot)]);
                let a1 = sum(&[(-0.5, &cold), (0.5, &hot)]);
                let r0 = sum(&[(0.5, &rate_cold), (0.5, &rate_hot)]);
                let r1 = sum(&[(-0.5, &rate_cold), (0.5, &rate_hot)]);
                let s0 = sum(&[(0.5, &lag_cold), (0.5, &lag_hot)]);
                let s1 = sum(&[(-0.5, &lag_cold), (0.5, &lag_hot)]);
                (segment, [mid, a1, a2, r0, r1, s0, s1])
            })
            .collect()
    }

    /// The polynomial of each segment.
    pub(crate) fn polynomials(&self, coefficients: &[f64]) -> Vec<Polynomial> {
        let maps = self.polynomial_maps();
        let of_segment = maps.iter().map(|(segment, rows)| {
            let values = rows.each_ref().map(|row| dot(row, coefficients));
            Polynomial {
                s: [values[Terms::COUNT - 2], values[Terms::COUNT - 1]],
                ..Polynomial::new(segment, &values)
            }
        });
        of_segment.collect()
    }
}

/// Weighted sum of rows.
fn sum(parts: &[(f64, &SparseRow)]) -> SparseRow {
    let mut total = SparseRow::new();
    for (weight, row) in parts {
        for &(column, value) in *row {
            match total.iter_mut().find(|(known, _)| *known == column) {
                Some((_, sum)) => *sum += weight * value,
                None => total.push((column, weight * value)),
            }
        }
    }
    total
}

/// Product of a row with a vector.
pub(crate) fn dot(row: &[(usize, f64)], vector: &[f64]) -> f64 {
    row.iter()
        .map(|&(column, value)| value * vector[column])
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES_C: [f64; 5] = [-15.0, 10.0, 30.0, 55.0, 80.0];

    /// Every column that there is: three logs, second lag, two plays.
    fn whole(rate: RateForm) -> Basis {
        Basis::new(EDGES_C.to_vec(), rate, 3).with_history(true, 2)
    }

    fn coefficients(basis: &Basis) -> Vec<f64> {
        let columns = 0..basis.columns();
        columns.map(|i| (i as f64 * 1.7).sin()).collect()
    }

    #[test]
    fn splines_add_up_to_one_and_are_not_negative() {
        let basis = Basis::new(EDGES_C.to_vec(), RateForm::None, 1);
        let mut row = SparseRow::new();
        for step in 0..=190 {
            basis.row(0, -15.0 + 0.5 * f64::from(step), 1.0, &mut row);
            assert!(row.iter().all(|&(_, value)| value >= 0.0));
            let total: f64 = row.iter().map(|&(_, value)| value).sum();
            assert!((total - 1.0).abs() < 1e-14);
        }
    }

    /// Splines, constants of logs, rate hats, lag hats, plays: one after the other, nothing twice.
    #[test]
    fn columns_follow_each_other() {
        let basis = whole(RateForm::Hats);
        assert_eq!(basis.static_columns(), 6);
        assert_eq!(basis.columns_without_rate(), 6 + 2);
        assert_eq!(basis.rate_columns(), 5);
        assert_eq!(basis.lag2_columns(), 13..18);
        assert_eq!(basis.play_columns(), 18..20);
        assert_eq!(basis.columns(), 20);
        let without = whole(RateForm::None).with_history(false, 1);
        assert_eq!(without.lag2_columns(), 8..8);
        assert_eq!(without.play_columns(), 8..9);
    }

    /// Any coefficients make a static part with continuous value and slope, and continuous parts of
    /// rate and second lag.
    #[test]
    fn neighbouring_polynomials_meet_in_value_and_slope() {
        for rate in [RateForm::Line, RateForm::Hats] {
            let basis = whole(rate);
            let polynomials = basis.polynomials(&coefficients(&basis));
            for (pair, &at) in polynomials.windows(2).zip(&EDGES_C[1..]) {
                let [cold, hot] = [pair[0], pair[1]];
                assert!((cold.static_bias(at) - hot.static_bias(at)).abs() < 1e-13);
                let slope = |p: &Polynomial| (p.a[1] + 2.0 * p.a[2] * p.z(at)) / p.half_width_c;
                assert!((slope(&cold) - slope(&hot)).abs() < 1e-13);
                assert!((cold.rate_bias(at) - hot.rate_bias(at)).abs() < 1e-13);
                let of_lag = |p: &Polynomial| p.s[0] + p.s[1] * p.z(at);
                assert!((of_lag(&cold) - of_lag(&hot)).abs() < 1e-13);
                assert!((cold.s[1] - hot.s[1]).abs() > 0.01);
            }
        }
    }

    /// The seven coefficients of each segment say what the row says, with any rate, second lag and
    /// plays; beyond the range the row is the one of its end.
    #[test]
    fn polynomials_are_the_row_times_the_coefficients() {
        let (rate, lag2_c, plays_c) = (-1.3, 4.7, [0.9, -6.0]);
        for form in [RateForm::None, RateForm::Line, RateForm::Hats] {
            let basis = whole(form);
            let coefficients = coefficients(&basis);
            let polynomials = basis.polynomials(&coefficients);
            let gains = &coefficients[basis.play_columns()];
            let of_plays = gains[0] * plays_c[0] + gains[1] * plays_c[1];
            // The constants of the three logs add up to zero.
            let [first, second] = [coefficients[6], coefficients[7]];
            let constants = [first, second, -first - second];
            let mut row = SparseRow::new();
            for step in 0..110 {
                let temp_c = -24.7 + f64::from(step);
                let inside_c = temp_c.clamp(-15.0, 80.0);
                let of = &polynomials[basis.segment(inside_c)];
                let of_lag = of.s[0] + of.s[1] * of.z(inside_c);
                let modelled = of.static_bias(inside_c) + rate * of.rate_bias(inside_c);
                for (log, constant) in constants.into_iter().enumerate() {
                    basis.row(log, temp_c, rate, &mut row);
                    basis.push_history(temp_c, lag2_c, plays_c, &mut row);
                    let expected = modelled + lag2_c * of_lag + of_plays + constant;
                    let found = dot(&row, &coefficients);
                    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
                }
            }
        }
    }

    /// Each of the seven maps reads its own columns alone.
    #[test]
    fn maps_read_the_columns_of_their_term() {
        let basis = whole(RateForm::Hats);
        for (number, (segment, rows)) in basis.polynomial_maps().into_iter().enumerate() {
            assert_eq!(segment.t_min_c, EDGES_C[number]);
            for (term, row) in rows.iter().enumerate() {
                let (of, count) = match term {
                    0..3 => (0..basis.static_columns(), 3),
                    3..5 => (8..13, 2),
                    _ => (basis.lag2_columns(), 2),
                };
                assert_eq!(row.len(), count, "term {term}");
                assert!(
                    row.iter().all(|(column, _)| of.contains(column)),
                    "term {term}"
                );
            }
        }
        let without = Basis::new(EDGES_C.to_vec(), RateForm::None, 1);
        for (_, rows) in without.polynomial_maps() {
            assert!(rows[Terms::STATIC..].iter().all(Vec::is_empty));
        }
    }
}
