//! How well a finished set does on the logs it was fitted to, beside a plain cubic in T.
//!
//! All figures are of the rows that entered the blocks. Within a block the bias of any model is
//! taken as constant: the spread of rows about the mean of their block is the same with and
//! without compensation.

use tempco::{Table, TableError};
use tempco_set::{AxisStatistics, CoefficientSet, Segment, TableData, TableUse, use_axis};

use crate::least_squares::{Block, Blocks, RFactor, SamplePoints};
use crate::summary::{ChannelData, Moments};

/// Degrees of freedom that the spread of means must have to scale uncertainties: it is then known
/// to 22 %.
const LEAST_FREEDOM: usize = 10;

/// A mean over `tau` counts where at least this share of its rows is there.
const LEAST_COVERAGE: f64 = 0.25;

/// Runs the set's table over the logs by the core and notes the figures of each axis in it, of
/// means over `tau_s`, as far as whole blocks make it.
pub(crate) fn note(
    set: &mut CoefficientSet,
    channels: &mut [ChannelData],
    tau_s: f64,
) -> Result<(), TableError> {
    for (channel, data) in set.channels.iter_mut().zip(channels) {
        // Disturbed blocks are not fitted, but they are judged. Steps of the bias stay out, and so
        // do movements: next to one, chance would say whether compensation helps.
        let moved = std::mem::take(&mut data.moved);
        *data = ChannelData {
            offsets: std::mem::take(&mut data.offsets),
            ..ChannelData::new(data.logs, data.channel)
        };
        for (log, position) in moved {
            data.keep[log][position] = false;
        }
        let blocks = Blocks::new(data);
        let cubics = Cubics::fit(data);
        let tau_s = whole_blocks_s(data, tau_s);
        for (number, axis) in channel.axes.iter_mut().enumerate() {
            let biases = biases(&channel.table, number, data, &blocks)?;
            let pool = |model: &[f64]| Pool::new(data, &blocks, number, model, tau_s);
            let raw = pool(&vec![0.0; biases.len()]);
            let compensated = pool(&biases);
            let cubic = pool(&cubics.values(data, number));
            let serial_factor = compensated.serial_factor();
            // Those of a spline account for what is not white already.
            for sigmas in axis.sigmas.iter_mut().filter(|_| axis.noise.is_none()) {
                sigmas.scale(serial_factor.unwrap_or(1.0));
            }
            axis.statistics = Some(AxisStatistics {
                rows: raw.rows as usize,
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
        }
    }
    Ok(())
}

/// The averaging time: of logs so long that their blocks are longer than planned, the nearest one
/// of whole blocks \[s\].
fn whole_blocks_s(data: &ChannelData, tau_s: f64) -> f64 {
    let planned_s = data.logs[0].plan.block_s;
    let of_logs = (0..data.logs.len()).map(|log| data.of(log).block_s);
    let block_s = of_logs.fold(planned_s, f64::max);
    if block_s > planned_s {
        block_s * (tau_s / block_s).round().max(1.0)
    } else {
        tau_s
    }
}

/// The mean bias of an axis over each block, by the core and the table that fly.
fn biases(
    table: &TableData,
    axis: usize,
    data: &ChannelData,
    blocks: &Blocks,
) -> Result<Vec<f64>, TableError> {
    use_axis(table, axis, BlockBiases { data, blocks })
}

/// Running the samples of all logs through the table of an axis.
struct BlockBiases<'a> {
    data: &'a ChannelData<'a>,
    blocks: &'a Blocks,
}

impl TableUse for BlockBiases<'_> {
    type Output = Vec<f64>;

    fn with<const CHANNELS: usize, const AXES: usize>(
        self,
        tables: &[Table<AXES>; CHANNELS],
    ) -> Vec<f64> {
        let table = &tables[0];
        let points = SamplePoints::new(self.data, table.thermal());
        let of_log = |log: usize| {
            let samples = points.of_log(log).iter();
            let bias = samples.map(|sample| f64::from(table.bias(&sample.point).0[0]));
            bias.collect()
        };
        let biases: Vec<Vec<f64>> = (0..points.logs()).map(of_log).collect();
        let mean = |block: &Block| {
            let (mut sum, mut rows) = (0.0, 0.0);
            for kept in points.of_block(block) {
                sum += kept.rows * biases[block.log][kept.sample];
                rows += kept.rows;
            }
            sum / rows
        };
        self.blocks.blocks.iter().map(mean).collect()
    }
}

/// Sums of squares over several logs, each about its own mean.
#[derive(Default)]
struct Pool {
    rows: f64,
    row_squares: f64,
    means: usize,
    mean_squares: f64,
    logs: usize,
}

/// A sum of rows.
#[derive(Clone, Copy, Default)]
struct Sum {
    rows: f64,
    total: f64,
}

impl Pool {
    /// An axis less a model, which is given by block.
    fn new(data: &ChannelData, blocks: &Blocks, axis: usize, model: &[f64], tau_s: f64) -> Self {
        let mut pool = Self::default();
        let mut of_logs = vec![Vec::new(); data.logs.len()];
        for (block, bias) in blocks.blocks.iter().zip(model) {
            of_logs[block.log].push((block, bias));
        }
        for (log, of_log) in of_logs.into_iter().enumerate() {
            let all = &data.of(log).blocks;
            let residuals = of_log.iter().map(|(block, bias)| {
                let spread = &all[block.position].moments.axes[axis];
                let offset = data.offset(log, block.position, axis);
                (*block, spread.mean - offset - *bias, spread.squares)
            });
            pool.add(
                (data.logs[log].interval_s, all[0].from_s),
                &residuals.collect::<Vec<_>>(),
                tau_s,
            );
        }
        pool
    }

    /// Takes in the blocks of a log: mean and sum of squares about it.
    fn add(
        &mut self,
        (interval_s, first_s): (f64, f64),
        blocks: &[(&Block, f64, f64)],
        tau_s: f64,
    ) {
        let least_rows = (LEAST_COVERAGE * tau_s / interval_s).max(1.0);
        let mut all = Sum::default();
        let mut stretches: Vec<(f64, Sum)> = Vec::new();
        for (block, mean, _) in blocks {
            let number = ((block.time_s - first_s + 0.5 * interval_s) / tau_s).floor();
            if stretches.last().is_none_or(|(last, _)| *last != number) {
                stretches.push((number, Sum::default()));
            }
            let stretch = stretches.last_mut().map(|(_, sum)| sum);
            for sum in stretch.into_iter().chain([&mut all]) {
                sum.rows += block.weight;
                sum.total += block.weight * mean;
            }
        }
        let mean_of_all = all.total / all.rows.max(1.0);
        self.rows += all.rows;
        let of_block = blocks.iter().map(|(block, mean, squares)| {
            squares + block.weight * (mean - mean_of_all) * (mean - mean_of_all)
        });
        self.row_squares += of_block.sum::<f64>();
        let full = stretches.iter().map(|(_, sum)| sum);
        let full = full.filter(|sum| sum.rows >= least_rows);
        let means: Vec<f64> = full.map(|sum| sum.total / sum.rows).collect();
        if !means.is_empty() {
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            self.means += means.len();
            self.mean_squares += means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>();
            self.logs += 1;
        }
    }

    fn rmse(&self) -> f64 {
        (self.row_squares / self.rows).sqrt()
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
        let rows_per_mean = self.rows / self.means as f64;
        let factor = self.sigma() * rows_per_mean.sqrt() / self.rmse();
        let enough = self.means >= self.logs + LEAST_FREEDOM;
        (enough && factor.is_finite() && factor > 0.0).then_some(factor)
    }
}

/// One cubic in T for each axis of a channel, over all blocks.
struct Cubics {
    range: Segment,
    coefficients: Vec<Vec<f64>>,
}

impl Cubics {
    fn fit(data: &ChannelData) -> Self {
        let (low, high) = data.range(|block| block.effective_range_c);
        let mut cubics = Self {
            range: Segment {
                t_min_c: f64::from(low),
                t_max_c: f64::from(high),
            },
            coefficients: vec![Vec::new(); data.axes()],
        };
        let mut factor = RFactor::new(4, data.axes());
        for (log, position, block) in data.blocks() {
            let z = cubics.z(&block.moments);
            let squares = block.moments.axes.iter().map(|axis| axis.squares);
            let row = [1.0, z, z * z, z * z * z];
            let row = row
                .into_iter()
                .chain(data.levelled((log, position), &block.moments));
            factor.push_mean(block.moments.rows, row, squares);
        }
        // Data that cannot carry a cubic can carry fewer powers; a constant always.
        if let Some(solution) = (1..=4).rev().find_map(|terms| factor.solve(terms)) {
            cubics.coefficients = solution.coefficients;
        }
        cubics
    }

    fn z(&self, moments: &Moments) -> f64 {
        (moments.effective_c.mean - self.range.centre_c()) / self.range.half_width_c()
    }

    /// The cubic of an axis in each block.
    fn values(&self, data: &ChannelData, axis: usize) -> Vec<f64> {
        let value = |moments| {
            let powers = self.coefficients[axis].iter().rev();
            powers.fold(0.0, |sum, coefficient| sum * self.z(moments) + coefficient)
        };
        let blocks = data.blocks();
        blocks.map(|(_, _, block)| value(&block.moments)).collect()
    }
}
