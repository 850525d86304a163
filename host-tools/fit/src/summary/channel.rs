//! One channel of a log on its way into a summary: core, spikes, grid.

use tempco::{Thermal, ThermalPoint, ThermalState};
use tempco_set::run::{IntervalCache, Updates, is_usable, thermal_period_s};

use crate::options::Plan;
use crate::outliers::{SpikeFilter, window_rows};
use crate::summary::ChannelSummary;
use crate::summary::block::Rows;
use crate::summary::grid::{Grid, MOST_BLOCKS};

/// Runs the rows of a channel through the core and the filter of spikes into blocks.
pub(super) struct ChannelSummariser<'a> {
    plan: &'a Plan,
    state: ThermalState,
    intervals: IntervalCache,
    updates: Updates,
    /// Where the last update left the core, and the temperature that it took.
    point: ThermalPoint,
    held_c: f32,
    window: Rows,
    /// A window that is done with, to be filled again.
    spare: Option<Rows>,
    window_rows: usize,
    spikes: Option<SpikeFilter>,
    grid: Grid,
    unusable_rows: usize,
    excluded_rows: usize,
}

impl<'a> ChannelSummariser<'a> {
    /// Starts as firmware does after power-on, at the first temperature.
    pub(super) fn new(
        plan: &'a Plan,
        axes: usize,
        (first_s, interval_s): (f64, f64),
        first_c: f32,
    ) -> Self {
        let thermal = &plan.thermal;
        let window_rows = window_rows(interval_s);
        let mut state = ThermalState::new(thermal);
        let point = state.start(thermal, first_c);
        Self {
            plan,
            state,
            intervals: IntervalCache::new(thermal, interval_s as f32),
            updates: Updates::new(first_s, interval_s, thermal_period_s(interval_s)),
            point,
            held_c: first_c,
            window: Rows::with_capacity(axes, window_rows),
            spare: None,
            window_rows,
            spikes: plan.options.robust.then(|| SpikeFilter::new(axes)),
            grid: Grid::new(axes, first_s - 0.5 * interval_s, plan.block_s, MOST_BLOCKS),
            unusable_rows: 0,
            excluded_rows: 0,
        }
    }

    /// Takes in the next rows.
    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        let mut start = 0;
        while start < time_s.len() {
            let room = self.window_rows - self.window.len();
            let end = time_s.len().min(start + room);
            self.run(&time_s[start..end], &temp_c[start..end]);
            for (to, from) in self.window.axes.iter_mut().zip(axes) {
                to.extend_from_slice(&from[start..end]);
            }
            if self.window.len() == self.window_rows {
                self.close_window();
            }
            start = end;
        }
    }

    /// Runs the core over some rows.
    fn run(&mut self, time_s: &[f64], temp_c: &[f32]) {
        let thermal: &Thermal = &self.plan.thermal;
        let rows = &mut self.window;
        rows.time_s.extend_from_slice(time_s);
        let first = rows.effective_c.len();
        rows.temp_c.resize(first + temp_c.len(), 0.0);
        rows.effective_c.resize(first + temp_c.len(), 0.0);
        rows.rate.resize(first + temp_c.len(), 0.0);
        rows.accepted.resize(first + temp_c.len(), false);
        let points = rows.effective_c[first..].iter_mut();
        let points = points
            .zip(&mut rows.rate[first..])
            .zip(&mut rows.accepted[first..])
            .zip(&mut rows.temp_c[first..]);
        // The state is kept in registers.
        let (mut state, mut intervals) = (self.state, self.intervals);
        let (mut updates, mut point, mut held) = (self.updates, self.point, self.held_c);
        for ((&time_s, &temp_c), (((effective_c, rate), accepted), held_c)) in
            time_s.iter().zip(temp_c).zip(points)
        {
            if let Some(dt_s) = updates.due(time_s) {
                let interval = intervals.of(thermal, dt_s);
                point = state.update(thermal, &interval, temp_c);
                held = temp_c;
            }
            *held_c = held;
            *effective_c = point.effective_c;
            *rate = point.rate_c_per_min;
            *accepted = is_usable(&point);
            self.unusable_rows += usize::from(!*accepted);
        }
        state.drop_tiny();
        (self.state, self.intervals) = (state, intervals);
        (self.updates, self.point, self.held_c) = (updates, point, held);
        rows.keep
            .extend_from_slice(&rows.accepted[rows.keep.len()..]);
        for stretch in &self.plan.options.exclude {
            let first = rows.time_s.len() - time_s.len();
            for (time_s, keep) in rows.time_s[first..].iter().zip(&mut rows.keep[first..]) {
                let excluded = *keep && (stretch.from_s..=stretch.to_s).contains(time_s);
                self.excluded_rows += usize::from(excluded);
                *keep &= !excluded;
            }
        }
    }

    fn close_window(&mut self) {
        let axes = self.window.axes.len();
        let next = self.spare.take();
        let next = next.unwrap_or_else(|| Rows::with_capacity(axes, self.window_rows));
        let window = std::mem::replace(&mut self.window, next);
        let mut judged = |rows: Rows| {
            self.grid.take(&rows);
            self.spare = Some(rows);
        };
        match &mut self.spikes {
            Some(spikes) => spikes.take(window, &mut judged),
            None => judged(window),
        }
        self.window.clear();
    }

    /// The summary, without names.
    pub(super) fn finish(mut self) -> ChannelSummary {
        self.close_window();
        let mut white_sigmas = vec![0.0; self.window.axes.len()];
        let mut spike_rows = 0;
        let mut spiked = Vec::new();
        if let Some(spikes) = &mut self.spikes {
            spikes.finish(&mut |rows| self.grid.take(&rows));
            white_sigmas = spikes.white_sigmas();
            spike_rows = spikes.spikes();
            spiked = spikes.places();
        }
        let (blocks, samples, block_s) = self.grid.finish();
        ChannelSummary {
            column: String::new(),
            axes: Vec::new(),
            blocks,
            samples,
            block_s,
            white_sigmas,
            unusable_rows: self.unusable_rows,
            excluded_rows: self.excluded_rows,
            spike_rows,
            spiked,
        }
    }
}
