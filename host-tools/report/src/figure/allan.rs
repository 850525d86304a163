//! Allan deviations before and after.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use tempco_fit::set::AxisSet;

use super::canvas::{DrawError, FINE, Figure};
use super::frame::{Key, Mark, dot, line, text, titled, triangle, with_unit};
use super::palette::{AFTER, BEFORE, GRID, MUTED};
use crate::ReportError;
use crate::gather::{Deviation, GatheredAxis};

const KEYS: [Key; 3] = [
    (Mark::Triangle(BEFORE), "before"),
    (Mark::Dot(AFTER), "after"),
    (Mark::Dashed(MUTED), "averaging time of the traces"),
];

pub(super) fn draw(
    axis: &AxisSet,
    tau_s: f64,
    shown: &GatheredAxis,
) -> Result<Figure, ReportError> {
    let (name, unit) = (&axis.name, axis.unit.symbol());
    let [before, after] = &shown.allan;
    let points = || before.iter().chain(after);
    let x = decades(points().map(|point| point.tau_s));
    let y = decades(points().flat_map(|point| point.interval));
    Figure::draw(
        format!("allan-{name}"),
        format!("Overlapping Allan deviation of {name}, before and after compensation"),
        310,
        |area, hovers| -> Result<(), DrawError> {
            let area = titled(area, &format!("{name}: Allan deviation [{unit}]"), &KEYS)?;
            let mut chart = ChartBuilder::on(&area)
                .margin_right(FINE * 14)
                .margin_top(FINE * 4)
                .x_label_area_size(FINE * 38)
                .y_label_area_size(FINE * 56)
                .build_cartesian_2d(
                    (x.0..x.1).log_scale().with_key_points(powers(x)),
                    (y.0..y.1).log_scale().with_key_points(powers(y)),
                )?;
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .bold_line_style(line(GRID, 10))
                .axis_style(line(MUTED, 10))
                .label_style(text(12, MUTED))
                .axis_desc_style(text(12, MUTED))
                .x_desc("averaging time [s]")
                .x_label_formatter(&power)
                .y_label_formatter(&power)
                .draw()?;
            if (x.0..x.1).contains(&tau_s) {
                let ends = [(tau_s, y.0), (tau_s, y.1)];
                let dashes = DashedPathElement::new(ends, FINE * 5, FINE * 4, line(MUTED, 12));
                chart.draw_series([dashes])?;
            }
            for (curve, colour, what) in [(before, BEFORE, "before"), (after, AFTER, "after")] {
                let place = |point: &Deviation| (point.tau_s, point.deviation);
                let path: Vec<(f64, f64)> = curve.iter().map(place).collect();
                chart.draw_series([PathElement::new(path, line(colour, 15))])?;
                for point in curve {
                    let ends = point.interval.map(|end| (point.tau_s, end.max(y.0)));
                    chart.draw_series([PathElement::new(ends, line(colour, 15))])?;
                    match what {
                        "before" => chart.draw_series([triangle(place(point), colour)])?,
                        _ => chart.draw_series([dot(place(point), colour)])?,
                    };
                    let text = format!(
                        "{what}, {}: {}, 1 sigma {} to {}",
                        with_unit(point.tau_s, "s"),
                        with_unit(point.deviation, unit),
                        crate::text::figure(point.interval[0]),
                        crate::text::figure(point.interval[1])
                    );
                    hovers.dot(chart.backend_coord(&place(point)), text);
                }
            }
            Ok(())
        },
    )
}

/// Whole powers of ten around positive values.
fn decades(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let logs = values.filter(|&value| value > 0.0).map(f64::log10);
    let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), log| {
        (low.min(log), high.max(log))
    });
    if low > high {
        return (0.1, 10.0);
    }
    let low = low.floor();
    (10_f64.powf(low), 10_f64.powf(high.ceil().max(low + 1.0)))
}

fn powers((low, high): (f64, f64)) -> Vec<f64> {
    let [low, high] = [low, high].map(|end| end.log10().round() as i32);
    (low..=high).map(|power| 10_f64.powi(power)).collect()
}

/// A power of ten in as few letters as it takes.
fn power(value: &f64) -> String {
    if (0.01..=1e4).contains(value) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
