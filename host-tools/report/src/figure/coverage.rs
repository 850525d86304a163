//! Time spent by temperature and its rate, and what is calibrated.

use plotters::prelude::*;
use tempco_set::ChannelSet;

use super::canvas::{DrawError, Figure};
use super::frame::{Key, Mark, Scale, axes, line, range_of, titled};
use super::palette::{COOLING, INK};
use crate::ReportError;
use crate::gather::Map;

/// Opacity of cells, and the least time for it \[min\].
const SHADES: [(f64, f64); 4] = [(0.2, 0.0), (0.4, 1.0), (0.65, 10.0), (1.0, 60.0)];

const KEYS: [Key; 5] = [
    (Mark::Band(COOLING, SHADES[0].0), "less"),
    (Mark::Band(COOLING, SHADES[1].0), "1 min"),
    (Mark::Band(COOLING, SHADES[2].0), "10 min"),
    (Mark::Band(COOLING, SHADES[3].0), "1 h or more"),
    (Mark::Line(INK), "calibrated"),
];

pub(super) fn draw(channel: &ChannelSet, map: &Map) -> Result<Figure, ReportError> {
    let (table, thermal) = (&channel.table, &channel.table.thermal);
    let calibrated = [
        (table.t_min_c, thermal.rate_min_c_per_min),
        (table.t_max_c, thermal.rate_max_c_per_min),
    ]
    .map(|(temp_c, rate)| (f64::from(temp_c), f64::from(rate)));
    let corners = |&(i, j): &(i32, i32)| {
        let low = (f64::from(i) * map.cell_c, f64::from(j) * map.cell_c_per_min);
        [low, (low.0 + map.cell_c, low.1 + map.cell_c_per_min)]
    };
    let ends = || map.time_s.keys().flat_map(corners).chain(calibrated);
    let x = Scale {
        range: range_of(ends().map(|end| end.0)),
        name: "lag-compensated temperature [degC]",
    };
    let y = range_of(ends().map(|end| end.1));
    let name = &channel.temperature;
    Figure::draw(
        format!("coverage-{name}"),
        format!("Time spent by temperature and rate of temperature, {name}"),
        300,
        |area, hovers| -> Result<(), DrawError> {
            let area = titled(area, &format!("{name}: rate T' [degC/min]"), &KEYS)?;
            let mut chart = axes(&area, x, y, 7)?;
            for (cell, time_s) in &map.time_s {
                let minutes = time_s / 60.0;
                let shade = SHADES.iter().rev().find(|(_, least)| minutes >= *least);
                let opacity = shade.map_or(SHADES[0].0, |(opacity, _)| *opacity);
                let corners = corners(cell);
                let fill = COOLING.mix(opacity).filled();
                chart.draw_series([Rectangle::new(corners, fill)])?;
                let [a, b] = corners.map(|corner| chart.backend_coord(&corner));
                let text = format!(
                    "{:.1} degC, {:.2} degC/min: {minutes:.1} min",
                    0.5 * (corners[0].0 + corners[1].0),
                    0.5 * (corners[0].1 + corners[1].1)
                );
                hovers.rectangle(a, b, text);
            }
            // plotters draws the outline of a rectangle in hairlines.
            let [low, high] = calibrated;
            let frame = vec![low, (low.0, high.1), high, (high.0, low.1), low];
            chart.draw_series([PathElement::new(frame, line(INK, 18))])?;
            Ok(())
        },
    )
}
