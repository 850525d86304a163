//! Allan deviations before and after.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use tempco_evaluate::allan::AllanPoint;
use tempco_set::AxisSet;

use super::canvas::{DrawError, FINE, Figure};
use super::frame::{BELOW, Key, LEFT, Mark, dot, line, muted, titled, triangle, with_unit};
use super::log_scale::{around, tick, ticks};
use super::palette::{AFTER, BEFORE, MUTED};
use crate::ReportError;
use crate::gather::GatheredAxis;

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
    let x = around(points().map(|point| point.tau_s));
    let y = around(points().flat_map(|point| point.confidence));
    Figure::draw(
        format!("allan-{name}"),
        format!("Overlapping Allan deviation of {name}, before and after compensation"),
        310,
        |area, hovers| -> Result<(), DrawError> {
            let area = titled(area, &format!("{name}: Allan deviation [{unit}]"), &KEYS)?;
            let mut chart = ChartBuilder::on(&area)
                .margin_right(FINE * 14)
                .margin_top(FINE * 4)
                .x_label_area_size(FINE * BELOW)
                .y_label_area_size(FINE * LEFT)
                .build_cartesian_2d(
                    x.clone().log_scale().with_key_points(ticks(&x)),
                    y.clone().log_scale().with_key_points(ticks(&y)),
                )?;
            muted(&mut chart.configure_mesh())
                .x_desc("averaging time [s]")
                .x_label_formatter(&tick)
                .y_label_formatter(&tick)
                .draw()?;
            if x.contains(&tau_s) {
                let ends = [(tau_s, y.start), (tau_s, y.end)];
                let dashes = DashedPathElement::new(ends, FINE * 5, FINE * 4, line(MUTED, 12));
                chart.draw_series([dashes])?;
            }
            for (curve, colour, what) in [(before, BEFORE, "before"), (after, AFTER, "after")] {
                let place = |point: &AllanPoint| (point.tau_s, point.deviation);
                let path: Vec<(f64, f64)> = curve.iter().map(place).collect();
                chart.draw_series([PathElement::new(path, line(colour, 15))])?;
                for point in curve {
                    let ends = point.confidence.map(|end| (point.tau_s, end.max(y.start)));
                    chart.draw_series([PathElement::new(ends, line(colour, 15))])?;
                    match what {
                        "before" => chart.draw_series([triangle(place(point), colour)])?,
                        _ => chart.draw_series([dot(place(point), colour)])?,
                    };
                    let text = format!(
                        "{what}, {}: {}, 1 sigma {} to {}",
                        with_unit(point.tau_s, "s"),
                        with_unit(point.deviation, unit),
                        tempco_evaluate::figure(point.confidence[0]),
                        tempco_evaluate::figure(point.confidence[1])
                    );
                    hovers.dot(chart.backend_coord(&place(point)), text);
                }
            }
            Ok(())
        },
    )
}
