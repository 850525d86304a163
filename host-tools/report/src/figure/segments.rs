//! The polynomial of every segment over its own range, and where neighbours meet.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use tempco_evaluate::boundaries;
use tempco_set::ChannelSet;

use super::canvas::{DrawError, Figure};
use super::frame::{BAND, Key, Mark, Scale, axes, line, range_of, titled, with_unit};
use super::palette::{COOLING, GRID, HEATING, INK, MUTED};
use crate::ReportError;

/// Points along a polynomial.
const STEPS: u32 = 40;

const KEYS: [Key; 3] = [
    (Mark::Line(HEATING), "segments, in turn"),
    (Mark::Dashed(COOLING), ""),
    (Mark::Band(INK, BAND), "overlap or boundary"),
];

pub(super) fn draw(channel: &ChannelSet, number: usize) -> Result<Figure, ReportError> {
    let axis = &channel.axes[number];
    let (name, unit) = (&axis.name, axis.unit.symbol());
    let curves: Vec<Vec<(f64, f64)>> = channel
        .segments
        .iter()
        .zip(&axis.polynomials)
        .map(|(segment, polynomial)| {
            let width_c = segment.t_max_c - segment.t_min_c;
            let temps_c = (0..=STEPS)
                .map(|step| segment.t_min_c + width_c * f64::from(step) / f64::from(STEPS));
            temps_c.map(|t| (t, polynomial.static_bias(t))).collect()
        })
        .collect();
    let x = Scale {
        range: range_of(curves.iter().flatten().map(|point| point.0)),
        name: "lag-compensated temperature [degC]",
    };
    let y = range_of(curves.iter().flatten().map(|point| point.1));
    let shades = boundaries(channel, number);
    Figure::draw(
        format!("segments-{name}"),
        format!("The polynomials of the segments of {name} at T' = 0, and where they overlap"),
        280,
        |area, hovers| -> Result<(), DrawError> {
            let title = format!("{name}: bias at T' = 0 [{unit}]");
            let area = titled(area, &title, &KEYS)?;
            let mut chart = axes(&area, x, y.clone(), 6)?;
            for boundary in &shades {
                let corners = [(boundary.t_min_c, y.start), (boundary.t_max_c, y.end)];
                chart.draw_series([Rectangle::new(corners, MUTED.mix(BAND).filled())])?;
                let edge = [(boundary.t_min_c, y.start), (boundary.t_min_c, y.end)];
                chart.draw_series([PathElement::new(edge, line(GRID, 15))])?;
                let [a, b] = corners.map(|corner| chart.backend_coord(&corner));
                let text = format!(
                    "{:.1} to {:.1} degC: mismatch {}, jump in the table {}",
                    boundary.t_min_c,
                    boundary.t_max_c,
                    with_unit(boundary.overlap_mismatch, unit),
                    with_unit(boundary.jump, unit)
                );
                hovers.rectangle((a.0 - 8, a.1), (b.0 + 8, b.1), text);
            }
            for (segment, curve) in curves.iter().enumerate() {
                if segment % 2 == 0 {
                    chart.draw_series([PathElement::new(curve.clone(), line(HEATING, 22))])?;
                } else {
                    let style = line(COOLING, 22);
                    let dashes = DashedPathElement::new(curve.clone(), 24, 16, style);
                    chart.draw_series([dashes])?;
                }
            }
            Ok(())
        },
    )
}
