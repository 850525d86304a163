//! What is gathered of an axis.

use tempco_evaluate::allan::AllanPoint;

use super::MOST_TIMES;
use super::bins::Bins;
use super::spread::{Merge, Spread};

/// The most bins along temperature and along its rate.
const MOST_PLACES: usize = 56;

/// Whether the temperature rises, falls or stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Cooling,
    Steady,
    Heating,
}

impl Direction {
    pub(crate) const ALL: [Self; 3] = [Self::Cooling, Self::Steady, Self::Heating];
}

/// Means over `tau` in a bin of temperature: of the bias that was taken out and of what remained.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    pub(crate) bias: Spread,
    pub(crate) residual: Spread,
}

impl Merge for Place {
    fn merge(&mut self, other: &Self) {
        self.bias.merge(&other.bias);
        self.residual.merge(&other.residual);
    }
}

/// Sums of an axis over one log.
#[derive(Clone, Debug)]
pub(super) struct AxisSums {
    sums: [f64; 2],
    /// Over the log so far: rows, and their sums raw and compensated.
    whole: (f64, [f64; 2]),
    rows: Bins<Spread>,
    means: Bins<[Spread; 2]>,
    by_temp: Bins<[Place; 3]>,
    by_rate: Bins<Spread>,
}

/// An axis as it is drawn. What is called residual is less its mean over the log it comes from: a
/// constant turn-on bias is not thermal.
#[derive(Clone, Debug)]
pub(crate) struct GatheredAxis {
    /// Extremes of single rows, compensated, by time \[h\].
    pub(crate) rows: Vec<(f64, Spread)>,
    /// Means over `tau`, raw and compensated, by time \[h\].
    pub(crate) means: Vec<(f64, [Spread; 2])>,
    /// Means over `tau` by lag-compensated temperature and [`Direction`].
    pub(crate) by_temp: Bins<[Place; 3]>,
    /// What remained, means over `tau`, by rate of temperature.
    pub(crate) by_rate: Bins<Spread>,
    /// Rows over which the Allan deviations were taken.
    pub(crate) allan_rows: usize,
    /// Allan deviations, raw and compensated.
    pub(crate) allan: [Vec<AllanPoint>; 2],
}

impl AxisSums {
    pub(super) fn new(tau_s: f64) -> Self {
        Self {
            sums: [0.0; 2],
            whole: (0.0, [0.0; 2]),
            rows: Bins::new(1.0, MOST_TIMES),
            means: Bins::new(tau_s, MOST_TIMES),
            by_temp: Bins::new(0.25, MOST_PLACES),
            by_rate: Bins::new(1.0 / 1024.0, MOST_PLACES),
        }
    }

    #[inline]
    pub(super) fn push(&mut self, raw: f64, compensated: f64, since_s: f64) {
        self.sums[0] += raw;
        self.sums[1] += compensated;
        self.rows.at(since_s).add(compensated);
    }

    pub(super) fn close_stretch(
        &mut self,
        middle_s: Option<f64>,
        rows: f64,
        temp_c: f64,
        rate: f64,
        direction: Direction,
    ) {
        let [raw, compensated] = self.sums.map(|sum| sum / rows);
        self.whole.0 += rows;
        for (whole, sum) in self.whole.1.iter_mut().zip(self.sums) {
            *whole += sum;
        }
        self.sums = [0.0; 2];
        let Some(middle_s) = middle_s else {
            return;
        };
        let at = self.means.at(middle_s);
        at[0].add(raw);
        at[1].add(compensated);
        let place = &mut self.by_temp.at(temp_c)[direction as usize];
        place.bias.add(raw - compensated);
        place.residual.add(compensated);
        self.by_rate.at(rate).add(compensated);
    }
}

impl AxisSums {
    /// The axis as it is drawn, in a log that begins at `start_h`.
    pub(super) fn finish(
        self,
        start_h: f64,
        allan_rows: usize,
        allan: [Vec<AllanPoint>; 2],
    ) -> GatheredAxis {
        let (rows, sums) = self.whole;
        let [raw, compensated] = sums.map(|sum| sum / rows);
        let hours = |since_s: f64| start_h + since_s / 3600.0;
        let of_rows = self.rows.iter();
        let means = self.means.iter();
        GatheredAxis {
            rows: of_rows
                .map(|(at, spread)| (hours(at), spread.less(compensated)))
                .collect(),
            means: means
                .map(|(at, [r, c])| (hours(at), [r.less(raw), c.less(compensated)]))
                .collect(),
            by_temp: self.by_temp.map(|places| {
                places.map(|place| Place {
                    bias: place.bias,
                    residual: place.residual.less(compensated),
                })
            }),
            by_rate: self.by_rate.map(|spread| spread.less(compensated)),
            allan_rows,
            allan,
        }
    }
}

impl GatheredAxis {
    /// Adds what a later log has; the Allan deviations are of the longest stretch.
    pub(super) fn append(&mut self, later: Self) {
        self.rows.extend(later.rows);
        self.means.extend(later.means);
        self.by_temp.absorb(later.by_temp);
        self.by_rate.absorb(later.by_rate);
        if later.allan_rows > self.allan_rows {
            (self.allan_rows, self.allan) = (later.allan_rows, later.allan);
        }
    }
}
