//! One channel in all logs of a fit.

use crate::summary::{Block, ChannelSummary, Extremes, LogSummary, Moments};

/// The blocks of one channel in all logs, and which of them are fitted.
pub(crate) struct ChannelData<'a> {
    pub(crate) logs: &'a [&'a LogSummary],
    pub(crate) channel: usize,
    /// For each log and block, whether it may enter a fit.
    pub(crate) keep: Vec<Vec<bool>>,
    /// For each log and axis, how far its constant bias is from the mean of the logs
    /// \[unit of the axis\]; 0 until it is known.
    pub(crate) constants: Vec<Vec<f64>>,
    /// For each log, its steps of the bias in order of time.
    pub(crate) offsets: Vec<Vec<Offset>>,
    /// Log and position of the blocks that were left out because the unit moved.
    pub(crate) moved: Vec<(usize, usize)>,
}

/// How far the constant bias is from the rest of the log, from a block on to the next offset.
pub(crate) struct Offset {
    /// Position of the first block.
    pub(crate) from: usize,
    /// By axis \[unit of the axis\].
    pub(crate) axes: Vec<f64>,
}

impl<'a> ChannelData<'a> {
    /// The blocks with any rows.
    pub(crate) fn new(logs: &'a [&'a LogSummary], channel: usize) -> Self {
        let keep = logs.iter().map(|log| {
            let blocks = log.channels[channel].blocks.iter();
            blocks.map(|block| block.moments.rows > 0).collect()
        });
        let axes = logs[0].channels[channel].axes.len();
        Self {
            logs,
            channel,
            keep: keep.collect(),
            constants: vec![vec![0.0; axes]; logs.len()],
            offsets: logs.iter().map(|_| Vec::new()).collect(),
            moved: Vec::new(),
        }
    }

    /// The channel in a log.
    pub(crate) fn of(&self, log: usize) -> &'a ChannelSummary {
        &self.logs[log].channels[self.channel]
    }

    /// The kept blocks with their log and position.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (usize, usize, &'a Block)> {
        let logs = self.keep.iter().enumerate();
        logs.flat_map(|(log, keep)| {
            let blocks = self.of(log).blocks.iter().zip(keep).enumerate();
            let kept = blocks.filter(|(_, (_, keep))| **keep);
            kept.map(move |(number, (block, _))| (log, number, block))
        })
    }

    /// The means of the axes over a block, less the constant of its log and the steps in it.
    pub(crate) fn levelled(
        &self,
        (log, position): (usize, usize),
        moments: &Moments,
    ) -> impl Iterator<Item = f64> {
        let axes = moments.axes.iter().zip(&self.constants[log]).enumerate();
        axes.map(move |(axis, (spread, constant))| {
            spread.mean - constant - self.offset(log, position, axis)
        })
    }

    /// How far the constant bias of an axis in a block is from the rest of its log.
    pub(crate) fn offset(&self, log: usize, position: usize, axis: usize) -> f64 {
        let offsets = &self.offsets[log];
        let begun = offsets.partition_point(|offset| offset.from <= position);
        begun
            .checked_sub(1)
            .map_or(0.0, |last| offsets[last].axes[axis])
    }

    /// Names of the logs' files.
    pub(crate) fn files(&self) -> String {
        let names: Vec<&str> = self.logs.iter().map(|log| log.file()).collect();
        names.join(", ")
    }

    /// Name of the temperature.
    pub(crate) fn temperature(&self) -> &'a str {
        &self.of(0).column
    }

    pub(crate) fn axes(&self) -> usize {
        self.of(0).axes.len()
    }

    /// Lowest and highest of a figure of the kept rows.
    pub(crate) fn range(&self, figure: impl Fn(&Moments) -> Extremes) -> (f32, f32) {
        let blocks = self.blocks();
        let ranges = blocks.map(|(_, _, block)| figure(&block.moments));
        let range = ranges.fold(Extremes::NONE, Extremes::with);
        (range.low, range.high)
    }
}
