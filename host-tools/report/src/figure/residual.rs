//! What remains, against time, temperature and rate of temperature.

use plotters::prelude::*;
use tempco_set::AxisSet;

use super::bias::of_direction;
use super::canvas::{DrawError, FINE, Figure, Hovers};
use super::frame::{
    BAND, Chart, Key, Mark, Scale, axes, cross, dot, line, range_of, titled, triangle, with_unit,
};
use super::palette::{AFTER, COOLING, HEATING, INK, MUTED, OTHER};
use super::traces::{band, extremes, hours, point_out, runs, starts, trace};
use crate::ReportError;
use crate::gather::{Direction, Gathered, GatheredAxis, Spread};
use crate::text::seconds;

/// Against time: means, and below them the extremes of single rows on a scale of their own.
pub(super) fn over_time(
    axis: &AxisSet,
    gathered: &Gathered,
    shown: &GatheredAxis,
) -> Result<Figure, ReportError> {
    const KEYS: [Key; 2] = [
        (Mark::Line(AFTER), "means"),
        (Mark::Band(OTHER, BAND), "single rows, lowest to highest"),
    ];
    let (name, unit) = (&axis.name, axis.unit.symbol());
    let means: Vec<(f64, Spread)> = shown
        .means
        .iter()
        .map(|(at, both)| (*at, both[1]))
        .collect();
    let height = 340;
    Figure::draw(
        format!("residual-time-{name}"),
        format!("What remains of {name} over time: means, and extremes of single rows"),
        height,
        |area, hovers| -> Result<(), DrawError> {
            let title = format!(
                "{name}: means over {}; rows [{unit}]",
                seconds(gathered.tau_s)
            );
            let area = titled(area, &title, &KEYS)?;
            let (upper, lower) = area.split_vertically(FINE * (height - 38) * 11 / 20);
            let nothing = Scale {
                range: hours(shown),
                name: "",
            };
            let mut chart = axes(&upper, nothing, range_of(extremes(&means)), 5)?;
            starts(&mut chart, gathered)?;
            zero(&mut chart)?;
            trace(&mut chart, &means, &gathered.starts_h, AFTER)?;
            point_out(&chart, hovers, &means, |columns| between(columns, unit));
            let x = Scale {
                range: hours(shown),
                name: "time [h]",
            };
            let mut chart = axes(&lower, x, range_of(extremes(&shown.rows)), 4)?;
            starts(&mut chart, gathered)?;
            for run in runs(&shown.rows, &gathered.starts_h) {
                band(&mut chart, &run, OTHER)?;
                for extreme in [|s: &Spread| s.min, |s: &Spread| s.max] {
                    let curve: Vec<(f64, f64)> =
                        run.iter().map(|(at, s)| (*at, extreme(s))).collect();
                    chart.draw_series([PathElement::new(curve, line(OTHER, 10))])?;
                }
            }
            zero(&mut chart)?;
            point_out(&chart, hovers, &shown.rows, |columns| {
                between(columns, unit)
            });
            Ok(())
        },
    )
}

fn between(columns: &[(f64, Spread)], unit: &str) -> Option<String> {
    let low = columns
        .iter()
        .map(|c| c.1.min)
        .fold(f64::INFINITY, f64::min);
    let high = columns
        .iter()
        .map(|c| c.1.max)
        .fold(f64::NEG_INFINITY, f64::max);
    (low <= high).then(|| {
        let (at, low) = (columns[0].0, tempco_evaluate::figure(low));
        format!("{at:.2} h: {low} to {}", with_unit(high, unit))
    })
}

/// Against temperature, heating and cooling apart.
pub(super) fn over_temperature(
    axis: &AxisSet,
    shown: &GatheredAxis,
) -> Result<Figure, ReportError> {
    const KEYS: [Key; 4] = [
        (Mark::Triangle(HEATING), "heating"),
        (Mark::Dot(COOLING), "cooling"),
        (Mark::Cross(MUTED), "steady"),
        (Mark::Line(MUTED), "lowest to highest"),
    ];
    let (name, unit) = (&axis.name, axis.unit.symbol());
    // Side by side, so that bars do not hide each other.
    let aside = 0.25 * shown.by_temp.width();
    let places: Vec<(Direction, f64, Spread)> = shown
        .by_temp
        .iter()
        .flat_map(|(temp_c, places)| {
            Direction::ALL.into_iter().map(move |direction| {
                let place = &places[direction as usize];
                let offset = f64::from(direction as i32 - 1);
                (direction, temp_c + aside * offset, place.residual)
            })
        })
        .filter(|(_, _, residual)| residual.n > 0.0)
        .collect();
    let x = Scale {
        range: range_of(places.iter().map(|place| place.1)),
        name: "lag-compensated temperature [degC]",
    };
    let y = range_of(places.iter().flat_map(|place| [place.2.min, place.2.max]));
    Figure::draw(
        format!("residual-temperature-{name}"),
        format!("What remains of {name} against temperature, heating and cooling"),
        280,
        |area, hovers| -> Result<(), DrawError> {
            let area = titled(area, &format!("{name}: what remains [{unit}]"), &KEYS)?;
            let mut chart = axes(&area, x, y, 6)?;
            zero(&mut chart)?;
            for (direction, temp_c, residual) in &places {
                let (colour, called) = of_direction(*direction);
                let at = (*temp_c, residual.mean().unwrap_or(0.0));
                bar(
                    &mut chart,
                    hovers,
                    at,
                    residual,
                    colour,
                    &format!("{called} near {temp_c:.1} degC: {}", with_unit(at.1, unit)),
                )?;
                match direction {
                    Direction::Heating => chart.draw_series([triangle(at, colour)])?,
                    Direction::Cooling => chart.draw_series([dot(at, colour)])?,
                    Direction::Steady => chart.draw_series([cross(at, colour)])?,
                };
            }
            Ok(())
        },
    )
}

/// Against the rate of temperature.
pub(super) fn over_rate(axis: &AxisSet, shown: &GatheredAxis) -> Result<Figure, ReportError> {
    const KEYS: [Key; 2] = [
        (Mark::Dot(INK), "mean"),
        (Mark::Line(MUTED), "lowest to highest"),
    ];
    let (name, unit) = (&axis.name, axis.unit.symbol());
    let places: Vec<(f64, Spread)> = shown
        .by_rate
        .iter()
        .filter(|(_, spread)| spread.n > 0.0)
        .map(|(rate, spread)| (rate, *spread))
        .collect();
    let x = Scale {
        range: range_of(places.iter().map(|place| place.0)),
        name: "rate of temperature T' [degC/min]",
    };
    let y = range_of(extremes(&places));
    Figure::draw(
        format!("residual-rate-{name}"),
        format!("What remains of {name} against the rate of temperature"),
        280,
        |area, hovers| -> Result<(), DrawError> {
            let area = titled(area, &format!("{name}: what remains [{unit}]"), &KEYS)?;
            let mut chart = axes(&area, x, y, 6)?;
            zero(&mut chart)?;
            for (rate, residual) in &places {
                let at = (*rate, residual.mean().unwrap_or(0.0));
                let text = format!(
                    "near {rate:.2} degC/min: {}, {:.0} means",
                    with_unit(at.1, unit),
                    residual.n
                );
                bar(&mut chart, hovers, at, residual, MUTED, &text)?;
                chart.draw_series([dot(at, INK)])?;
            }
            Ok(())
        },
    )
}

fn bar(
    chart: &mut Chart,
    hovers: &mut Hovers,
    at: (f64, f64),
    residual: &Spread,
    colour: RGBColor,
    text: &str,
) -> Result<(), DrawError> {
    let ends = [(at.0, residual.min), (at.0, residual.max)];
    chart.draw_series([PathElement::new(ends, line(colour, 12))])?;
    hovers.dot(chart.backend_coord(&at), text.to_owned());
    Ok(())
}

fn zero(chart: &mut Chart) -> Result<(), DrawError> {
    let x = chart.as_coord_spec().get_x_range();
    let ends = [(x.start, 0.0), (x.end, 0.0)];
    chart.draw_series([PathElement::new(ends, line(MUTED, 8))])?;
    Ok(())
}
