//! How well a finished set does on the logs it was fitted to, beside a plain cubic in T.

use crate::apply::{ApplyError, apply};
use crate::log::Log;
use crate::metrics::Means;
use crate::regress::ChannelData;
use crate::rfactor::RFactor;
use crate::segment::Segment;
use crate::set::{AxisStatistics, CoefficientSet};

/// Degrees of freedom that the spread of means must have to scale uncertainties: it is then known
/// to 22 %.
const LEAST_FREEDOM: usize = 10;

/// Applies the set to the logs by the core and notes the figures of each axis in it.
pub(crate) fn note(
    set: &mut CoefficientSet,
    logs: &[Log],
    channels: &[ChannelData],
    tau_s: f64,
) -> Result<(), ApplyError> {
    let applied = logs
        .iter()
        .map(|log| apply(set, log))
        .collect::<Result<Vec<_>, _>>()?;
    let mut number = 0;
    for (channel, data) in set.channels.iter_mut().zip(channels) {
        let cubics = Cubics::fit(data);
        for (of_channel, axis) in channel.axes.iter_mut().enumerate() {
            let [mut raw, mut cubic, mut compensated] = [(); 3].map(|()| Pool::default());
            for (position, (log, applied)) in logs.iter().zip(&applied).enumerate() {
                let output = &applied.axes[number];
                raw.add(log, tau_s, output.raw.iter().map(|&v| f64::from(v)));
                let values = output.compensated.iter().map(|&v| f64::from(v));
                compensated.add(log, tau_s, values);
                let values = cubics.residuals(data, position, of_channel);
                cubic.add(log, tau_s, values);
            }
            let serial_factor = compensated.serial_factor();
            // Those of a spline account for what is not white already.
            for sigmas in axis.sigmas.iter_mut().filter(|_| axis.noise.is_none()) {
                sigmas.scale(serial_factor.unwrap_or(1.0));
            }
            axis.statistics = Some(AxisStatistics {
                rows: raw.rows,
                rmse_raw: raw.rmse(),
                rmse_cubic: cubic.rmse(),
                rmse_compensated: compensated.rmse(),
                tau_s,
                n: raw.means,
                sigma_raw: raw.sigma(),
                sigma_cubic: cubic.sigma(),
                sigma_compensated: compensated.sigma(),
                serial_factor,
            });
            number += 1;
        }
    }
    Ok(())
}

/// Sums of squares over several logs, each about its own mean.
#[derive(Default)]
struct Pool {
    rows: usize,
    row_squares: f64,
    means: usize,
    mean_squares: f64,
    logs: usize,
}

impl Pool {
    fn add(&mut self, log: &Log, tau_s: f64, values: impl Iterator<Item = f64> + Clone) {
        let means = Means::new(&log.time_s, log.interval_s, values.clone(), tau_s);
        self.rows += log.rows();
        self.row_squares += squares_about(values, means.mean);
        if !means.means.is_empty() {
            let mean = means.means.iter().sum::<f64>() / means.means.len() as f64;
            self.means += means.means.len();
            self.mean_squares += squares_about(means.means.iter().copied(), mean);
            self.logs += 1;
        }
    }

    fn rmse(&self) -> f64 {
        (self.row_squares / self.rows as f64).sqrt()
    }

    /// Each log's mean costs a degree of freedom; 0 where there are too few means to tell.
    fn sigma(&self) -> f64 {
        match self.means.saturating_sub(self.logs) {
            0 => 0.0,
            freedom => (self.mean_squares / freedom as f64).sqrt(),
        }
    }

    /// The spread of the means over what it would be of independent rows.
    fn serial_factor(&self) -> Option<f64> {
        let rows_per_mean = self.rows as f64 / self.means as f64;
        let factor = self.sigma() * rows_per_mean.sqrt() / self.rmse();
        let enough = self.means >= self.logs + LEAST_FREEDOM;
        (enough && factor.is_finite() && factor > 0.0).then_some(factor)
    }
}

fn squares_about(values: impl Iterator<Item = f64>, mean: f64) -> f64 {
    values.map(|value| (value - mean).powi(2)).sum()
}

/// One cubic in T for each axis of a channel, over all usable rows.
struct Cubics {
    range: Segment,
    coefficients: Vec<Vec<f64>>,
}

impl Cubics {
    fn fit(data: &ChannelData) -> Self {
        let (low, high) = data.range(|point| point.effective_c);
        let range = Segment {
            t_min_c: f64::from(low),
            t_max_c: f64::from(high),
        };
        let mut factor = RFactor::new(4, data.axes());
        for (point, raw) in data.rows() {
            let z = (f64::from(point.effective_c) - range.centre_c()) / range.half_width_c();
            factor.push([1.0, z, z * z, z * z * z].into_iter().chain(raw));
        }
        // Data that cannot carry a cubic can carry fewer powers; a constant always.
        let solution = (1..=4).rev().find_map(|terms| factor.solve(terms));
        Self {
            range,
            coefficients: solution.map_or_else(
                || vec![Vec::new(); data.axes()],
                |solution| solution.coefficients,
            ),
        }
    }

    fn residuals<'a>(
        &'a self,
        data: &'a ChannelData,
        log: usize,
        axis: usize,
    ) -> impl Iterator<Item = f64> + Clone + 'a {
        let raw = &data.logs[log].channels[data.channel].axes[axis].raw;
        raw.iter().zip(&data.points[log]).map(move |(raw, point)| {
            let z =
                (f64::from(point.effective_c) - self.range.centre_c()) / self.range.half_width_c();
            let powers = self.coefficients[axis].iter().rev();
            raw - powers.fold(0.0, |sum, coefficient| sum * z + coefficient)
        })
    }
}
