//! Axes at full scale: their largest or smallest value, bit by bit, again and again.

use super::Place;
use crate::decimate::Decimated;

/// Less is left to the filters of the fit: a knock, a turn of the unit \[share of the rows\].
const LEAST_SHARE: f64 = 0.01;

/// Fewer rows may be chance.
const LEAST_ROWS: usize = 16;

/// Noise makes the second value more frequent than the extreme one. A stop turns that round.
const OVER_SECOND: usize = 4;

/// An extreme value is far from the rest of the axis if this many times their spread is between.
const FAR: f64 = 8.0;

/// Rows that are compared at once.
const BLOCK: usize = 64;

/// Rows that the spread of an axis is taken from.
const SAMPLE: usize = 1 << 12;

/// Looks at the two extreme values of every axis.
#[derive(Clone, Debug)]
pub(super) struct FullScale {
    rows: usize,
    axes: Vec<OfAxis>,
}

#[derive(Clone, Debug)]
struct OfAxis {
    /// Largest value, and smallest with its sign changed.
    ends: [End; 2],
    sample: Decimated,
    /// For rows in the sample: 1 if two changes end neither where they began nor go on, 0 if they
    /// do, NaN of fewer changes.
    wide: Decimated,
}

/// The extreme value on one side, and the next to it.
#[derive(Clone, Copy, Debug)]
struct End {
    sign: f64,
    value: f64,
    rows: usize,
    second_rows: usize,
    second: f64,
    from_s: f64,
    to_s: f64,
}

impl FullScale {
    pub(super) fn new(axes: usize) -> Self {
        let end = |sign| End {
            sign,
            value: f64::NEG_INFINITY,
            rows: 0,
            second_rows: 0,
            second: f64::NEG_INFINITY,
            from_s: 0.0,
            to_s: 0.0,
        };
        let axis = OfAxis {
            ends: [end(1.0), end(-1.0)],
            sample: Decimated::new(SAMPLE),
            wide: Decimated::new(SAMPLE),
        };
        Self {
            rows: 0,
            axes: vec![axis; axes],
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], _temp_c: &[f32], axes: &[&[f64]]) {
        self.rows += time_s.len();
        for (of_axis, values) in self.axes.iter_mut().zip(axes) {
            for (times_s, values) in time_s.chunks(BLOCK).zip(values.chunks(BLOCK)) {
                for end in &mut of_axis.ends {
                    end.take(values, times_s);
                }
            }
            of_axis.sample.extend(values.len(), |row| values[row]);
            let triples = values.len().saturating_sub(2);
            of_axis.wide.extend(triples, |row| {
                let [a, b, c] = [values[row], values[row + 1], values[row + 2]];
                match a == b || b == c {
                    true => f64::NAN,
                    false => f64::from((c > b) != (b > a) && c != a),
                }
            });
        }
    }

    pub(super) fn finish(self) -> Vec<Place> {
        let rows = self.rows;
        let axes = self.axes.iter().enumerate();
        let places = axes.flat_map(|(number, axis)| {
            let ends = axis.ends.iter();
            let at_stop = ends.filter(move |end| axis.is_at_stop(end, rows));
            at_stop.map(move |end| Place {
                axis: Some(number),
                rows: end.rows,
                from_s: end.from_s,
                to_s: end.to_s,
                detail: format!(
                    "the {} value, {}, comes again and again",
                    if end.sign > 0.0 {
                        "largest"
                    } else {
                        "smallest"
                    },
                    end.sign * end.value
                ),
            })
        });
        places.collect()
    }
}

impl OfAxis {
    /// Whether the axis cannot go beyond an end: its values pile up there.
    fn is_at_stop(&self, end: &End, rows: usize) -> bool {
        let is_often = end.rows as f64 >= LEAST_SHARE * rows as f64 && end.rows >= LEAST_ROWS;
        // All rows at one value are a matter of identical values.
        let is_often = is_often && end.second_rows > 0;
        is_often && (self.is_piled_up(end) || self.is_far(end))
    }

    /// With noise wider than its steps, an axis is at its extreme value less often than at the next.
    fn is_piled_up(&self, end: &End) -> bool {
        let changes = self.wide.values().iter().filter(|wide| !wide.is_nan());
        let (count, wide) = changes.fold((0, 0.0), |(count, sum), wide| (count + 1, sum + wide));
        wide >= 0.05 * f64::from(count) && count > 0 && end.rows >= OVER_SECOND * end.second_rows
    }

    /// Whether the extreme value stands alone, far from the rest.
    fn is_far(&self, end: &End) -> bool {
        let mut values: Vec<f64> = self.sample.values().iter().map(|v| end.sign * v).collect();
        values.sort_by(f64::total_cmp);
        let middle = 0.5 * (values[values.len() / 2] + end.value);
        let rest = &values[..values.partition_point(|&value| value < middle)];
        let at_end = values.iter().filter(|&&value| value == end.value).count();
        if rest.is_empty() || 10 * at_end < 9 * (values.len() - rest.len()) {
            return false;
        }
        let (low, high) = (
            rest[rest.len() / 100],
            rest[rest.len() - 1 - rest.len() / 100],
        );
        let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
        let step = steps
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min);
        end.value - high >= FAR * (high - low).max(2.0 * step)
    }
}

impl End {
    /// Takes in some values. Few blocks have one beyond the second value; of others with an extreme
    /// value, such rows are counted without a branch.
    fn take(&mut self, values: &[f64], times_s: &[f64]) {
        let sign = self.sign;
        let signed = values.iter().map(|&value| sign * value);
        if count(&signed, |value| value >= self.second) == 0 {
            return;
        }
        let is_new = |value: f64| (value > self.second) & (value != self.value);
        if count(&signed, is_new) > 0 {
            let rows = signed.zip(times_s);
            rows.for_each(|(value, &time_s)| self.row(value, time_s));
            return;
        }
        self.second_rows += count(&signed, |value| value == self.second);
        let extreme = count(&signed, |value| value == self.value);
        self.rows += extreme;
        if extreme > 0 {
            let last = signed.clone().rposition(|value| value == self.value);
            self.to_s = last.map_or(self.to_s, |row| times_s[row]);
        }
    }

    fn row(&mut self, value: f64, time_s: f64) {
        if value == self.value {
            self.rows += 1;
            self.to_s = time_s;
        } else if value > self.value {
            (self.second, self.second_rows) = (self.value, self.rows);
            (self.value, self.rows) = (value, 1);
            (self.from_s, self.to_s) = (time_s, time_s);
        } else if value == self.second {
            self.second_rows += 1;
        } else if value > self.second {
            (self.second, self.second_rows) = (value, 1);
        }
    }
}

/// So many of the values; a loop without a branch.
fn count(values: &(impl Iterator<Item = f64> + Clone), is: impl Fn(f64) -> bool) -> usize {
    values.clone().map(|value| usize::from(is(value))).sum()
}
