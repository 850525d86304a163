//! The demo's picture: each axis before and after compensation, over the verification log.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use plotters::prelude::*;

/// Averaging time of the traces \[s\].
const TAU_S: f64 = 100.0;
/// Vermillion and blue of the Okabe-Ito palette, which colour-blind people can distinguish.
const BEFORE: RGBColor = RGBColor(213, 94, 0);
const AFTER: RGBColor = RGBColor(0, 114, 178);
const TEMPERATURE: RGBColor = RGBColor(90, 90, 90);

/// Means of one column against time in hours.
type Trace = Vec<(f64, f64)>;

/// Draws the result of `tempco apply` on the `paper` unit into an SVG file.
pub(crate) fn draw(applied: &Path, figure: &Path) -> Result<()> {
    let column = |name: &str| means(applied, name);
    let root = SVGBackend::new(figure, (900, 720)).into_drawing_area();
    let failed = |error: DrawingAreaErrorKind<_>| anyhow!("{}: {error}", figure.display());
    root.fill(&WHITE).map_err(failed)?;
    let panels = root.split_evenly((4, 1));
    panel(
        &panels[0],
        "case temperature [degC]",
        &[(column("temp_c")?, TEMPERATURE, "")],
    )
    .map_err(failed)?;
    for (panel_area, axis) in panels[1..].iter().zip(["x", "y", "z"]) {
        let traces = [
            (
                column(&format!("{axis}_raw_pulses_per_s"))?,
                BEFORE,
                "before",
            ),
            (
                column(&format!("{axis}_compensated_pulses_per_s"))?,
                AFTER,
                "after",
            ),
        ];
        panel(panel_area, &format!("{axis} [pulses/s]"), &traces).map_err(failed)?;
    }
    root.present().map_err(failed)
}

fn panel<DB: DrawingBackend>(
    area: &DrawingArea<DB, plotters::coord::Shift>,
    caption: &str,
    traces: &[(Trace, RGBColor, &str)],
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    let points = || traces.iter().flat_map(|(trace, ..)| trace);
    let hours = points().map(|point| point.0).fold(0.0, f64::max);
    let low = points().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let high = points()
        .map(|point| point.1)
        .fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.05 * (high - low);
    let mut chart = ChartBuilder::on(area)
        .margin(6)
        .caption(caption, ("sans-serif", 15))
        .x_label_area_size(28)
        .y_label_area_size(60)
        .build_cartesian_2d(0.0..hours, low - margin..high + margin)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("time [h]")
        .x_label_formatter(&|hour| format!("{hour:.0}"))
        .draw()?;
    for (trace, colour, label) in traces {
        let series = chart.draw_series(LineSeries::new(trace.iter().copied(), colour))?;
        if !label.is_empty() {
            let colour = *colour;
            series
                .label(*label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour));
        }
    }
    if traces.len() > 1 {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperMiddle)
            .background_style(WHITE.mix(0.8))
            .draw()?;
    }
    Ok(())
}

/// Means of a column of a CSV file over [`TAU_S`].
fn means(path: &Path, name: &str) -> Result<Trace> {
    let mut reader = csv::Reader::from_path(path)?;
    let header = reader.headers()?;
    let find = |name: &str| {
        let position = header.iter().position(|column| column == name);
        position.with_context(|| format!("{}: no column `{name}`", path.display()))
    };
    let (time, value) = (find("time_s")?, find(name)?);
    let mut means = Trace::new();
    let (mut stretch, mut sum, mut rows) = (0.0, 0.0, 0.0);
    for record in reader.records() {
        let record = record?;
        let time_s: f64 = record[time].parse()?;
        let number = (time_s / TAU_S).floor();
        if number != stretch {
            means.push(((stretch + 0.5) * TAU_S / 3600.0, sum / rows));
            (stretch, sum, rows) = (number, 0.0, 0.0);
        }
        sum += record[value].parse::<f64>()?;
        rows += 1.0;
    }
    Ok(means)
}
