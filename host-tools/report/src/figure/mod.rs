//! The figures, each an SVG of its own, drawn by plotters.

mod allan;
mod bias;
mod canvas;
mod coverage;
pub(crate) mod distribution;
mod frame;
mod log_scale;
mod palette;
mod residual;
mod segments;
mod traces;

use tempco_set::CoefficientSet;

pub(crate) use canvas::Figure;
pub(crate) use palette::dark_rules;

use crate::ReportError;
use crate::gather::Gathered;

/// All figures of a report.
pub(crate) struct Figures {
    /// Time by temperature and rate, of each channel; none without rows.
    pub(crate) coverage: Vec<Figure>,
    /// Of the rows, for each axis; none without rows.
    pub(crate) axes: Vec<AxisFigures>,
    /// The segments, for each axis.
    pub(crate) segments: Vec<Figure>,
}

/// The figures of the rows of one axis.
pub(crate) struct AxisFigures {
    pub(crate) bias: Figure,
    pub(crate) traces: Figure,
    pub(crate) over_time: Figure,
    pub(crate) over_temperature: Figure,
    pub(crate) over_rate: Figure,
    pub(crate) allan: Figure,
}

impl Figures {
    pub(crate) fn draw(
        set: &CoefficientSet,
        gathered: Option<&Gathered>,
    ) -> Result<Self, ReportError> {
        let of_channels = gathered.map_or(&[][..], |gathered| &gathered.channels);
        let channels = set.channels.iter().zip(of_channels);
        let coverage = channels.map(|(channel, shown)| coverage::draw(channel, &shown.map));
        let (mut axes, mut of_segments) = (Vec::new(), Vec::new());
        for (number, (position, axis)) in set.axes().enumerate() {
            let channel = &set.channels[position];
            let first = set.axes().position(|(p, _)| p == position).unwrap_or(0);
            of_segments.push(segments::draw(channel, number - first)?);
            let Some(gathered) = gathered else { continue };
            let temps_c = &gathered.channels[position].temps_c;
            let shown = &gathered.axes[number];
            axes.push(AxisFigures {
                bias: bias::draw(channel, number - first, shown)?,
                traces: traces::draw(axis, temps_c, gathered, shown)?,
                over_time: residual::over_time(axis, gathered, shown)?,
                over_temperature: residual::over_temperature(axis, shown)?,
                over_rate: residual::over_rate(axis, shown)?,
                allan: allan::draw(axis, gathered.tau_s, shown)?,
            });
        }
        Ok(Self {
            coverage: coverage.collect::<Result<_, _>>()?,
            axes,
            segments: of_segments,
        })
    }

    /// Every figure, in the order of the report.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Figure> {
        let of_axis = |axis: fn(&AxisFigures) -> &Figure| self.axes.iter().map(axis);
        of_axis(|axis| &axis.bias)
            .chain(of_axis(|axis| &axis.traces))
            .chain(of_axis(|axis| &axis.over_time))
            .chain(of_axis(|axis| &axis.over_temperature))
            .chain(of_axis(|axis| &axis.over_rate))
            .chain(of_axis(|axis| &axis.allan))
            .chain(&self.segments)
            .chain(&self.coverage)
    }
}
