//! Bias against temperature, with what the set takes out.

use plotters::prelude::*;
use tempco::ThermalPoint;
use tempco_set::ChannelSet;

use super::canvas::{DrawError, Figure};
use super::frame::{
    BAND, Key, Mark, Scale, axes, cross, dot, line, range_of, titled, triangle, with_unit,
};
use super::palette::{COOLING, HEATING, INK, MUTED};
use crate::ReportError;
use crate::band::sigma_at;
use crate::gather::{Direction, GatheredAxis};

/// Points along a curve.
const STEPS: u32 = 160;

const KEYS: [Key; 5] = [
    (Mark::Triangle(HEATING), "heating"),
    (Mark::Dot(COOLING), "cooling"),
    (Mark::Cross(MUTED), "steady"),
    (Mark::Line(INK), "fit at T' = 0"),
    (Mark::Band(INK, BAND), "1 sigma"),
];

/// Colour of a direction, and what it is called.
pub(super) const fn of_direction(direction: Direction) -> (RGBColor, &'static str) {
    match direction {
        Direction::Heating => (HEATING, "heating"),
        Direction::Cooling => (COOLING, "cooling"),
        Direction::Steady => (MUTED, "steady"),
    }
}

pub(super) fn draw(
    channel: &ChannelSet,
    number: usize,
    shown: &GatheredAxis,
) -> Result<Figure, ReportError> {
    let axis = &channel.axes[number];
    let (name, unit) = (&axis.name, axis.unit.symbol());
    // What the core takes out at zero rate, with the 1-sigma band of its coefficients.
    let curve = static_curve(channel, number);
    let band: Vec<(f64, f64, f64)> = curve
        .iter()
        .filter_map(|&(temp_c, bias)| Some((temp_c, bias, sigma_at(axis, temp_c)?)))
        .collect();
    // Direction, temperature, bias taken out, bias measured.
    let marks: Vec<(Direction, f64, f64, f64)> = shown
        .by_temp
        .iter()
        .flat_map(|(temp_c, places)| {
            Direction::ALL.into_iter().filter_map(move |direction| {
                let place = places[direction as usize];
                let (bias, residual) = (place.bias.mean()?, place.residual.mean()?);
                Some((direction, temp_c, bias, bias + residual))
            })
        })
        .collect();
    // Scales that hold marks, curve and band.
    let y = range_of(
        marks
            .iter()
            .flat_map(|&(_, _, bias, raw)| [bias, raw])
            .chain(curve.iter().map(|&(_, bias)| bias))
            .chain(
                band.iter()
                    .flat_map(|&(_, b, sigma)| [b - sigma, b + sigma]),
            ),
    );
    let temps_c = marks.iter().map(|mark| mark.1);
    let x = Scale {
        range: range_of(temps_c.chain(curve.iter().map(|&(temp_c, _)| temp_c))),
        name: "lag-compensated temperature [degC]",
    };
    Figure::draw(
        format!("bias-{name}"),
        format!("Bias of {name} against temperature, heating and cooling, with the fit"),
        310,
        |area, hovers| -> Result<(), DrawError> {
            let area = titled(area, &format!("{name}: bias [{unit}]"), &KEYS)?;
            let mut chart = axes(&area, x, y, 6)?;
            // The band first, so that everything else lies upon it.
            let upper = band.iter().map(|&(t, b, sigma)| (t, b + sigma));
            let lower = band.iter().rev().map(|&(t, b, sigma)| (t, b - sigma));
            let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
            chart.draw_series([Polygon::new(outline, INK.mix(BAND))])?;
            chart.draw_series([PathElement::new(curve, line(INK, 20))])?;
            // By direction: the line of what was taken out, and the marks of what was measured.
            for direction in Direction::ALL {
                let (colour, called) = of_direction(direction);
                let of_it = || marks.iter().filter(move |mark| mark.0 == direction);
                if direction != Direction::Steady {
                    let applied: Vec<(f64, f64)> = of_it().map(|m| (m.1, m.2)).collect();
                    chart.draw_series([PathElement::new(applied, line(colour, 12))])?;
                }
                let places = || of_it().map(|m| (m.1, m.3));
                match direction {
                    Direction::Heating => {
                        chart.draw_series(places().map(|p| triangle(p, colour)))?
                    }
                    Direction::Cooling => chart.draw_series(places().map(|p| dot(p, colour)))?,
                    Direction::Steady => chart.draw_series(places().map(|p| cross(p, colour)))?,
                };
                for &(_, temp_c, bias, raw) in of_it() {
                    let text = format!(
                        "{called} near {temp_c:.1} degC: {} measured, {} taken out",
                        with_unit(raw, unit),
                        with_unit(bias, unit)
                    );
                    hovers.dot(chart.backend_coord(&(temp_c, raw)), text);
                }
            }
            Ok(())
        },
    )
}

/// What the core takes out at zero rate, over the calibrated range.
fn static_curve(channel: &ChannelSet, number: usize) -> Vec<(f64, f64)> {
    let data = &channel.table;
    let cells = data.terms::<1>(number);
    let Ok(table) = data.table_over(number, &cells) else {
        return Vec::new();
    };
    let (low, high) = (data.t_min_c, data.t_max_c);
    let at = |step: u32| {
        let effective_c = low + (high - low) * step as f32 / STEPS as f32;
        let point = ThermalPoint {
            effective_c,
            ..ThermalPoint::default()
        };
        (f64::from(effective_c), f64::from(table.bias(&point).0[0]))
    };
    (0..=STEPS).map(at).collect()
}
