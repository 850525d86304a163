//! Regressors of the spline model: quadratic B-splines for the static part, straight lines or
//! hats for the rate part, a constant per log.

use tempco_set::{COMPOSITE, Polynomial, Segment};

/// The terms that an axis has beside its static part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AxisTerms {
    pub(crate) rate: bool,
    pub(crate) history: bool,
}

/// How the bias per rate depends on the lag-compensated temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RateForm {
    /// No rate term.
    None,
    /// One straight line over the whole range.
    Line,
    /// Straight within each segment, continuous.
    Hats,
}

/// Columns of the least squares of a spline.
///
/// In this order: `segments + 2` quadratic B-splines, which are C1 over the breakpoints and add up
/// to 1; for several logs, one column less than logs, in which the constants of the logs differ
/// from their mean; the rate columns; the history terms, one column each over the whole range.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Basis {
    /// Ends of the range and the breakpoints between, ascending \[degC\].
    breakpoints_c: Vec<f64>,
    rate: RateForm,
    logs: usize,
    history: usize,
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
            history: 0,
        }
    }

    /// The same basis with columns for history terms.
    pub(crate) fn with_history(self, history: usize) -> Self {
        Self { history, ..self }
    }

    pub(crate) fn breakpoints_c(&self) -> &[f64] {
        &self.breakpoints_c
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
            RateForm::Hats => self.segments() + 1,
        }
    }

    /// The columns before the rate terms.
    pub(crate) fn columns_without_rate(&self) -> usize {
        self.static_columns() + self.logs - 1
    }

    /// The columns before the history terms.
    pub(crate) fn columns_without_history(&self) -> usize {
        self.columns_without_rate() + self.rate_columns()
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns_without_history() + self.history
    }

    /// The columns of an axis that has not all terms.
    pub(crate) fn columns_of(&self, terms: AxisTerms) -> Vec<usize> {
        let rate = self.columns_without_rate()..self.columns_without_history();
        let history = self.columns_without_history()..self.columns();
        (0..self.columns())
            .filter(|column| terms.rate || !rate.contains(column))
            .filter(|column| terms.history || !history.contains(column))
            .collect()
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

    /// Appends the values of the history terms to a row.
    pub(crate) fn push_history(&self, values: impl Iterator<Item = f64>, row: &mut SparseRow) {
        row.extend((self.columns_without_history()..).zip(values));
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
            RateForm::Hats => {
                let x = (temp_c - at[segment]) / (at[segment + 1] - at[segment]);
                row.push((first + segment, (1.0 - x) * rate));
                row.push((first + segment + 1, x * rate));
            }
        }
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

    /// For each segment, the coefficients of its [`Polynomial`] as combinations of the columns: a
    /// quadratic is given by three places, a line by two.
    pub(crate) fn polynomial_maps(&self) -> Vec<(Segment, [SparseRow; COMPOSITE])> {
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
                let [cold, mid, hot] = [pair[0], segment.centre_c(), pair[1]].map(value);
                let [rate_cold, rate_hot] = [pair[0], pair[1]].map(slope);
                let a2 = sum(&[(0.5, &cold), (-1.0, &mid), (0.5, &hot)]);
                let a1 = sum(&[(-0.5, &cold), (0.5, &hot)]);
                let r0 = sum(&[(0.5, &rate_cold), (0.5, &rate_hot)]);
                let r1 = sum(&[(-0.5, &rate_cold), (0.5, &rate_hot)]);
                (segment, [mid, a1, a2, r0, r1])
            })
            .collect()
    }

    /// The polynomial of each segment.
    pub(crate) fn polynomials(&self, coefficients: &[f64]) -> Vec<Polynomial> {
        let maps = self.polynomial_maps();
        let of_segment = maps.iter().map(|(segment, rows)| {
            let values = rows.each_ref().map(|row| dot(row, coefficients));
            Polynomial::new(segment, &values)
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

    fn basis(rate: RateForm) -> Basis {
        Basis::new(vec![-15.0, 10.0, 30.0, 55.0, 80.0], rate, 1)
    }

    #[test]
    fn splines_add_up_to_one_and_are_not_negative() {
        let mut row = SparseRow::new();
        for step in 0..=190 {
            basis(RateForm::None).row(0, -15.0 + 0.5 * f64::from(step), 1.0, &mut row);
            assert!(row.iter().all(|&(_, value)| value >= 0.0));
            let total: f64 = row.iter().map(|&(_, value)| value).sum();
            assert!((total - 1.0).abs() < 1e-14);
        }
    }

    /// Any coefficients make a static part with continuous value and slope and a continuous rate
    /// part.
    #[test]
    fn neighbouring_polynomials_meet_in_value_and_slope() {
        for rate in [RateForm::Line, RateForm::Hats] {
            let basis = basis(rate);
            let coefficients: Vec<f64> = (0..basis.columns())
                .map(|i| (i as f64 * 1.7).sin())
                .collect();
            let polynomials = basis.polynomials(&coefficients);
            for (pair, &at) in polynomials.windows(2).zip(&basis.breakpoints_c()[1..]) {
                let [cold, hot] = [pair[0], pair[1]];
                assert!((cold.static_bias(at) - hot.static_bias(at)).abs() < 1e-13);
                let slope = |p: &Polynomial| (p.a[1] + 2.0 * p.a[2] * p.z(at)) / p.half_width_c;
                assert!((slope(&cold) - slope(&hot)).abs() < 1e-13);
                assert!((cold.rate_bias(at) - hot.rate_bias(at)).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn polynomials_are_the_row_times_the_coefficients() {
        for rate in [RateForm::None, RateForm::Line, RateForm::Hats] {
            let basis = basis(rate);
            let coefficients: Vec<f64> = (0..basis.columns())
                .map(|i| (i as f64 * 2.3).cos())
                .collect();
            let polynomials = basis.polynomials(&coefficients);
            let mut row = SparseRow::new();
            for step in 0..95 {
                let temp_c = -14.7 + f64::from(step);
                basis.row(0, temp_c, -1.3, &mut row);
                let polynomial = &polynomials[basis.segment(temp_c)];
                let expected = polynomial.static_bias(temp_c) - 1.3 * polynomial.rate_bias(temp_c);
                assert!((dot(&row, &coefficients) - expected).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn constants_of_logs_add_up_to_zero() {
        let basis = Basis::new(vec![0.0, 10.0], RateForm::None, 3);
        let mut total = [0.0; 5];
        let mut row = SparseRow::new();
        for log in 0..3 {
            basis.row(log, 5.0, 0.0, &mut row);
            for &(column, value) in row.iter().filter(|(column, _)| *column >= 3) {
                total[column] += value;
            }
        }
        assert_eq!(basis.columns(), 5);
        assert_eq!(total[3..], [0.0, 0.0]);
    }
}
