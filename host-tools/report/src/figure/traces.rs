//! Means over time, before and after, below the temperature.

use plotters::prelude::*;
use tempco_set::AxisSet;

use super::canvas::{DrawError, FINE, Figure, Hovers};
use super::frame::{BAND, Chart, Key, Mark, Scale, axes, line, range_of, titled, with_unit};
use super::palette::{AFTER, BEFORE, GRID, MUTED};
use crate::ReportError;
use crate::gather::{Gathered, GatheredAxis, Spread};
use crate::text::seconds;

/// Height of the strip with the temperature.
const STRIP: i32 = 70;

/// The most places that show their values.
const HOVERS: usize = 64;

const KEYS: [Key; 3] = [
    (Mark::Line(BEFORE), "before"),
    (Mark::Line(AFTER), "after"),
    (Mark::Line(MUTED), "temperature [degC]"),
];

pub(super) fn draw(
    axis: &AxisSet,
    temps_c: &[(f64, Spread)],
    gathered: &Gathered,
    shown: &GatheredAxis,
) -> Result<Figure, ReportError> {
    let (name, unit) = (&axis.name, axis.unit.symbol());
    let hours = hours(shown);
    let of = |which: usize| -> Vec<(f64, Spread)> {
        shown
            .means
            .iter()
            .map(|(at, both)| (*at, both[which]))
            .collect()
    };
    let (before, after) = (of(0), of(1));
    let y = range_of(extremes(&before).chain(extremes(&after)));
    Figure::draw(
        format!("traces-{name}"),
        format!("Means of {name} over time, before and after compensation"),
        340,
        |area, hovers| -> Result<(), DrawError> {
            let title = format!("{name}: means over {} [{unit}]", seconds(gathered.tau_s));
            let area = titled(area, &title, &KEYS)?;
            let (strip, area) = area.split_vertically(FINE * STRIP);
            let nothing = Scale {
                range: hours.clone(),
                name: "",
            };
            let mut chart = axes(&strip, nothing, range_of(extremes(temps_c)), 3)?;
            starts(&mut chart, gathered)?;
            for run in runs(temps_c, &gathered.starts_h) {
                let means = run.iter().filter_map(|(at, s)| Some((*at, s.mean()?)));
                let curve: Vec<(f64, f64)> = means.collect();
                chart.draw_series([PathElement::new(curve, line(MUTED, 18))])?;
            }
            let x = Scale {
                range: hours.clone(),
                name: "time [h]",
            };
            let mut chart = axes(&area, x, y, 5)?;
            starts(&mut chart, gathered)?;
            trace(&mut chart, &before, &gathered.starts_h, BEFORE)?;
            trace(&mut chart, &after, &gathered.starts_h, AFTER)?;
            let text = |columns: &[(f64, [Spread; 2])]| {
                let mean = |which: usize| mean_of(columns.iter().map(|(_, both)| both[which]));
                Some(format!(
                    "{:.2} h: before {}, after {}",
                    columns[0].0,
                    with_unit(mean(0)?, unit),
                    with_unit(mean(1)?, unit)
                ))
            };
            point_out(&chart, hovers, &shown.means, text);
            Ok(())
        },
    )
}

fn mean_of(spreads: impl Iterator<Item = Spread>) -> Option<f64> {
    let (n, sum) = spreads.fold((0.0, 0.0), |(n, sum), s| (n + s.n, sum + s.sum));
    (n > 0.0).then(|| sum / n)
}

/// Full columns of the chart, each with the text of some neighbouring values.
pub(super) fn point_out<T>(
    chart: &Chart,
    hovers: &mut Hovers,
    values: &[(f64, T)],
    text: impl Fn(&[(f64, T)]) -> Option<String>,
) {
    let most = values.len().div_ceil(HOVERS).max(1);
    let (_, ys) = chart.plotting_area().get_pixel_range();
    let last = chart.as_coord_spec().get_x_range().end;
    for (number, columns) in values.chunks(most).enumerate() {
        let next = values.get((number + 1) * most).map_or(last, |(at, _)| *at);
        if let Some(text) = text(columns) {
            let y = chart.as_coord_spec().get_y_range().start;
            let [left, right] = [columns[0].0, next].map(|at| chart.backend_coord(&(at, y)).0);
            hovers.rectangle((left, ys.start), (right, ys.end), text);
        }
    }
}

/// The time that an axis covers, all logs after each other \[h\].
pub(super) fn hours(shown: &GatheredAxis) -> std::ops::Range<f64> {
    let ends = [shown.rows.first(), shown.rows.last()];
    let mut ends = ends.into_iter().flatten().map(|(at, _)| *at);
    let (first, last) = (ends.next().unwrap_or(0.0), ends.next().unwrap_or(1.0));
    let margin = 0.01 * (last - first).max(1e-6);
    first - margin..last + margin
}

pub(super) fn extremes(values: &[(f64, Spread)]) -> impl Iterator<Item = f64> {
    values
        .iter()
        .flat_map(|(_, spread)| [spread.min, spread.max])
}

/// Where one log ends and the next begins.
pub(super) fn starts(chart: &mut Chart, gathered: &Gathered) -> Result<(), DrawError> {
    let y = chart.as_coord_spec().get_y_range();
    for &at in gathered.starts_h.iter().skip(1) {
        let edge = PathElement::new([(at, y.start), (at, y.end)], line(GRID, 30));
        chart.draw_series([edge])?;
    }
    Ok(())
}

/// Mean as a line, in a band from lowest to highest.
pub(super) fn trace(
    chart: &mut Chart,
    values: &[(f64, Spread)],
    starts_h: &[f64],
    colour: RGBColor,
) -> Result<(), DrawError> {
    for run in runs(values, starts_h) {
        band(chart, &run, colour)?;
        let means = run.iter().filter_map(|(at, s)| Some((*at, s.mean()?)));
        let curve: Vec<(f64, f64)> = means.collect();
        chart.draw_series([PathElement::new(curve, line(colour, 15))])?;
    }
    Ok(())
}

/// From lowest to highest.
pub(super) fn band(
    chart: &mut Chart,
    run: &[(f64, Spread)],
    colour: RGBColor,
) -> Result<(), DrawError> {
    let upper = run.iter().map(|(at, spread)| (*at, spread.max));
    let lower = run.iter().rev().map(|(at, spread)| (*at, spread.min));
    let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
    chart.draw_series([Polygon::new(outline, colour.mix(BAND))])?;
    Ok(())
}

/// Values without those that are empty, divided where a log begins.
pub(super) fn runs(values: &[(f64, Spread)], starts_h: &[f64]) -> Vec<Vec<(f64, Spread)>> {
    let log_of = |at: f64| starts_h.iter().filter(|&&start| start <= at).count();
    let filled: Vec<(f64, Spread)> = values.iter().copied().filter(|v| v.1.n > 0.0).collect();
    let runs = filled.chunk_by(|a, b| log_of(a.0) == log_of(b.0));
    runs.map(<[_]>::to_vec).collect()
}
