//! What surrounds the marks: title, legend, axes and their ticks.

use std::ops::Range;

use plotters::chart::{ChartContext, MeshStyle};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{Area, DrawError, FINE};
use super::palette::{GRID, INK, MUTED};

pub(super) type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Height of the title, and of the legend below it.
const TITLE: i32 = 21;
const LEGEND: i32 = 19;
/// Room for the labels of ticks.
pub(super) const LEFT: i32 = 58;
pub(super) const BELOW: i32 = 40;

/// How a kind of mark looks.
#[derive(Clone, Copy)]
pub(super) enum Mark {
    Line(RGBColor),
    Dashed(RGBColor),
    Band(RGBColor, f64),
    Triangle(RGBColor),
    Dot(RGBColor),
    Cross(RGBColor),
}

/// A kind of mark and what it stands for.
pub(super) type Key<'a> = (Mark, &'a str);

/// Opacity of a band.
pub(super) const BAND: f64 = 0.22;

/// Text of a size in units of the figure.
pub(super) fn text(size: i32, colour: RGBColor) -> TextStyle<'static> {
    // plotters takes the size of a box that is 1.24 times as high.
    ("sans-serif", 1.24 * f64::from(FINE * size))
        .into_font()
        .color(&colour)
}

pub(super) fn line(colour: RGBColor, tenths: u32) -> ShapeStyle {
    colour.stroke_width(FINE as u32 * tenths / 10)
}

/// Draws title and legend; returns the area below.
pub(super) fn titled<'a>(
    area: &Area<'a>,
    title: &str,
    keys: &[Key],
) -> Result<Area<'a>, DrawError> {
    let height = TITLE + if keys.is_empty() { 0 } else { LEGEND };
    let (top, rest) = area.split_vertically(FINE * height);
    let style = text(15, INK).pos(Pos::new(HPos::Left, VPos::Center));
    top.draw_text(title, &style, (FINE * 8, FINE * TITLE / 2))?;
    let (mut x, y) = (FINE * 10, FINE * (TITLE + LEGEND / 2));
    for (mark, name) in keys {
        draw_key(&top, *mark, (x, y))?;
        let style = text(12, MUTED).pos(Pos::new(HPos::Left, VPos::Center));
        top.draw_text(name, &style, (x + FINE * 20, y))?;
        // No font is at hand to measure with: sans-serif letters are about half as wide as high.
        x += FINE * (30 + 13 * name.chars().count() as i32 / 2);
    }
    Ok(rest)
}

fn draw_key(area: &Area, mark: Mark, (x, y): (i32, i32)) -> Result<(), DrawError> {
    let (middle, end) = ((x + FINE * 8, y), (x + FINE * 16, y));
    match mark {
        Mark::Line(colour) => area.draw(&PathElement::new([(x, y), end], line(colour, 20))),
        Mark::Dashed(colour) => {
            let dash = |from, to| [(x + FINE * from, y), (x + FINE * to, y)];
            area.draw(&PathElement::new(dash(0, 6), line(colour, 20)))?;
            area.draw(&PathElement::new(dash(10, 16), line(colour, 20)))
        }
        Mark::Band(colour, opacity) => area.draw(&Rectangle::new(
            [(x, y - FINE * 5), (x + FINE * 16, y + FINE * 5)],
            colour.mix(opacity).filled(),
        )),
        Mark::Triangle(colour) => area.draw(&triangle(middle, colour)),
        Mark::Dot(colour) => area.draw(&dot(middle, colour)),
        Mark::Cross(colour) => area.draw(&cross(middle, colour)),
    }
}

pub(super) fn triangle<C>(at: C, colour: RGBColor) -> TriangleMarker<C, i32> {
    TriangleMarker::new(at, FINE * 5, colour.filled())
}

pub(super) fn dot<C>(at: C, colour: RGBColor) -> Circle<C, i32> {
    Circle::new(at, FINE * 7 / 2, colour.filled())
}

pub(super) fn cross<C>(at: C, colour: RGBColor) -> Cross<C, i32> {
    Cross::new(at, FINE * 3, line(colour, 15))
}

/// What an axis shows: its range, and what it is with its unit; nothing is written for an empty
/// name.
pub(super) struct Scale<'a> {
    pub(super) range: Range<f64>,
    pub(super) name: &'a str,
}

/// Makes grid, axes and their labels step back behind the marks.
pub(super) fn muted<'m, 'a, 'b, 'c, X: Ranged, Y: Ranged>(
    mesh: &'m mut MeshStyle<'a, 'b, X, Y, SVGBackend<'c>>,
) -> &'m mut MeshStyle<'a, 'b, X, Y, SVGBackend<'c>> {
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(line(GRID, 10))
        .axis_style(line(MUTED, 10))
        .label_style(text(13, MUTED))
        .axis_desc_style(text(13, MUTED))
}

/// Axes with ticks and grid over the whole area.
pub(super) fn axes<'a, 'b>(
    area: &'a Area<'b>,
    x: Scale,
    y: Range<f64>,
    y_ticks: usize,
) -> Result<Chart<'a, 'b>, DrawError> {
    let below = if x.name.is_empty() { 6 } else { BELOW };
    let mut chart = ChartBuilder::on(area)
        .margin_right(FINE * 14)
        .margin_top(FINE * 4)
        .x_label_area_size(FINE * below)
        .y_label_area_size(FINE * LEFT)
        .build_cartesian_2d(x.range.clone(), y.clone())?;
    let (x_tick, y_tick) = (ticks(&x.range), ticks(&y));
    let mut mesh = chart.configure_mesh();
    muted(&mut mesh)
        .set_all_tick_mark_size(FINE * 3)
        .y_labels(y_ticks)
        .y_label_formatter(&y_tick);
    if x.name.is_empty() {
        mesh.x_labels(7).x_label_formatter(&|_| String::new());
    } else {
        mesh.x_labels(7).x_label_formatter(&x_tick).x_desc(x.name);
    }
    mesh.draw()?;
    Ok(chart)
}

/// Writes the labels of the ticks over a range: as many decimals as their distance needs.
fn ticks(range: &Range<f64>) -> impl Fn(&f64) -> String + use<> {
    let step = (range.end - range.start) / 6.0;
    let largest = range.start.abs().max(range.end.abs());
    move |&value: &f64| {
        // A tick at zero may be off by rounding.
        let value = if value.abs() < 1e-3 * step {
            0.0
        } else {
            value
        };
        if !(2e-3..1e5).contains(&largest) {
            return if value == 0.0 {
                "0".into()
            } else {
                format!("{value:.1e}")
            };
        }
        let decimals = (-step.log10()).ceil().max(0.0) as usize;
        format!("{value:.decimals$}")
    }
}

/// A range that holds all values with a margin; around a single one, or 0 to 1 for none.
pub(super) fn range_of(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return 0.0..1.0;
    }
    let margin = match 0.06 * (high - low) {
        0.0 => (0.1 * low.abs()).max(1e-6),
        margin => margin,
    };
    low - margin..high + margin
}

/// A value with a unit, in four significant digits.
pub(super) fn with_unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", tempco_evaluate::figure(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_decimals_they_need() {
        for (range, value, text) in [
            (0.0..30.0, 10.0, "10"),
            (-0.05..0.05, 0.02, "0.02"),
            (-0.05..0.05, -1e-18, "0.00"),
            (0.0..3.0, 0.5, "0.5"),
            (0.0..1e-4, 2e-5, "2.0e-5"),
            (0.0..2e6, 1e6, "1.0e6"),
        ] {
            assert_eq!(ticks(&range)(&value), text);
        }
    }

    #[test]
    fn ranges_hold_their_values_and_are_never_empty() {
        let range = range_of([1.0, 3.0, f64::NAN].into_iter());
        assert!(range.start < 1.0 && range.end > 3.0);
        let still = range_of([5.0].into_iter());
        assert!(still.start < 5.0 && still.end > 5.0);
        assert_eq!(range_of(std::iter::empty()), 0.0..1.0);
    }
}
