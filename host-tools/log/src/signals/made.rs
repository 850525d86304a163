//! Logs made for the tests of the detectors.

/// A log of one channel.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub(super) time_s: Vec<f64>,
    pub(super) temp_c: Vec<f32>,
    pub(super) axes: Vec<Vec<f64>>,
}

/// Normal noise of sigma 1, about: the sum of twelve uniform numbers.
#[derive(Clone, Debug)]
pub(super) struct Noise(u64);

impl Noise {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed.wrapping_add(0x9e37_79b9_7f4a_7c15))
    }

    pub(super) fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// To a step; 0 is no step.
pub(super) fn rounded(value: f64, step: f64) -> f64 {
    match step == 0.0 {
        true => value,
        false => (value / step).round() * step,
    }
}

/// From the first temperature up to the second at half of the time, and back, with soaks \[degC\].
pub(super) fn up_and_down(share: f64, from_c: f64, to_c: f64) -> f64 {
    let way = 1.0 - (2.0 * share - 1.0).abs();
    from_c + (to_c - from_c) * (1.4 * way - 0.2).clamp(0.0, 1.0)
}

impl Made {
    /// Rows `interval_s` apart; the temperature is a function of the share of the log that is over.
    pub(super) fn new(rows: usize, interval_s: f64, temp_c: impl FnMut(f64) -> f64) -> Self {
        let shares = (0..rows).map(|row| row as f64 / rows as f64);
        Self {
            time_s: (0..rows).map(|row| row as f64 * interval_s).collect(),
            temp_c: shares.map(temp_c).map(|temp_c| temp_c as f32).collect(),
            axes: Vec::new(),
        }
    }

    /// Adds an axis whose values are a function of row and temperature \[degC\].
    pub(super) fn with_axis(mut self, mut value: impl FnMut(usize, f64) -> f64) -> Self {
        let rows = self.temp_c.iter().enumerate();
        let values = rows.map(|(row, &temp_c)| value(row, f64::from(temp_c)));
        self.axes.push(values.collect());
        self
    }

    /// Hands out all rows, in parts of uneven size.
    pub(super) fn parts(&self, mut take: impl FnMut(&[f64], &[f32], &[&[f64]])) {
        let (mut start, mut size) = (0, 1);
        while start < self.time_s.len() {
            let part = start..self.time_s.len().min(start + size);
            let axes: Vec<&[f64]> = self.axes.iter().map(|axis| &axis[part.clone()]).collect();
            take(
                &self.time_s[part.clone()],
                &self.temp_c[part.clone()],
                &axes,
            );
            (start, size) = (part.end, size % 1009 * 3 + 1);
        }
    }
}

/// Three axes with noise of sigma and a bias of the temperature, rows 0.5 s apart. `more` is added,
/// by axis, or to the temperature before it is rounded to its step; by row.
pub(super) fn three_axes(
    seed: u64,
    rows: usize,
    (step_c, sigma): (f64, f64),
    more: impl Fn(Option<usize>, usize) -> f64,
) -> Made {
    let mut noise = Noise::new(seed);
    let mut row = 0;
    let mut log = Made::new(rows, 0.5, |share| {
        row += 1;
        let temp_c = up_and_down(share, -10.0, 50.0) + 0.02 * noise.next();
        rounded(temp_c + more(None, row - 1), step_c)
    });
    for (axis, slope) in [0.012, -0.008, 0.005].into_iter().enumerate() {
        log = log.with_axis(|row, temp_c| {
            slope * (temp_c - 25.0) + sigma * noise.next() + more(Some(axis), row)
        });
    }
    log
}
