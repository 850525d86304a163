//! Bias stability of an axis over all units of a batch, before and after compensation.

use std::collections::HashMap;
use std::ops::Range;

use maud::html;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{Area, DrawError, FINE, Figure, Hovers};
use super::frame::{BAND, BELOW, Key, LEFT, Mark, line, muted, text, titled, with_unit};
use super::log_scale::{around, tick, ticks};
use super::palette::{AFTER, BEFORE, INK, MUTED, hex};
use crate::ReportError;

const KEYS: [Key; 4] = [
    (Mark::Triangle(BEFORE), "before"),
    (Mark::Dot(AFTER), "after"),
    (Mark::Band(MUTED, BAND), "middle half"),
    (Mark::Line(MUTED), "median"),
];

/// Radius of a mark.
const RADIUS: i32 = FINE * 7 / 2;

/// Lines of names above the marks, and the height of one.
const LANES: usize = 2;
const LANE: i32 = FINE * 14;

/// The most letters of a name; others follow in the text below the figure.
const NAME: usize = 16;

/// One unit.
pub(crate) struct Unit<'a> {
    pub(crate) serial: &'a str,
    /// Class of the mark, by which the page hides it.
    pub(crate) class: &'static str,
    /// Its bias stability; above 0.
    pub(crate) value: f64,
    /// Score of an outlier, which is named.
    pub(crate) outlier: Option<f64>,
}

/// Values of units in ascending order, by some places in it.
#[derive(Clone, Copy)]
pub(crate) struct Quantiles {
    pub(crate) low: f64,
    pub(crate) quartiles: [f64; 2],
    pub(crate) median: f64,
    pub(crate) high: f64,
}

impl Quantiles {
    /// Of units in ascending order; `None` of no unit.
    pub(crate) fn of(units: &[Unit]) -> Option<Self> {
        let (low, high) = (units.first()?.value, units.last()?.value);
        // Between neighbours as far as the place lies between them.
        let at = |share: f64| {
            let place = share * (units.len() - 1) as f64;
            let [a, b] = [place.floor(), place.ceil()].map(|place| units[place as usize].value);
            a + (b - a) * place.fract()
        };
        Some(Self {
            low,
            quartiles: [0.25, 0.75].map(at),
            median: at(0.5),
            high,
        })
    }
}

/// Draws the units before and after compensation, each in ascending order.
pub(crate) fn draw(name: &str, unit: &str, groups: &[Vec<Unit>; 2]) -> Result<Figure, ReportError> {
    let values = || groups.iter().flatten().map(|of| of.value);
    let x = around(values());
    Figure::draw(
        format!("distribution-{name}-{unit}"),
        format!("Bias stability of {name} over all units, before and after compensation"),
        300,
        |area, hovers| -> Result<(), DrawError> {
            let title = format!("{name}: bias stability [{unit}]");
            let rest = titled(area, &title, &KEYS)?;
            let mut chart = ChartBuilder::on(&rest)
                .margin_right(FINE * 14)
                .margin_top(FINE * 4)
                .x_label_area_size(FINE * BELOW)
                .y_label_area_size(FINE * LEFT)
                .build_cartesian_2d(x.clone().log_scale().with_key_points(ticks(&x)), 0.0..2.0)?;
            muted(&mut chart.configure_mesh())
                .x_desc("standard deviation of means")
                .x_label_formatter(&tick)
                .y_labels(3)
                .y_label_formatter(&|_| String::new())
                .draw()?;
            let (xs, ys) = chart.plotting_area().get_pixel_range();
            let half = (ys.end - ys.start) / 2;
            let at = |value: f64| chart.backend_coord(&(value, 0.0)).0;
            for (units, (called, top)) in groups
                .iter()
                .zip([("before", ys.start), ("after", ys.start + half)])
            {
                let band = Band::new(called, top, half);
                let style = text(13, MUTED).pos(Pos::new(HPos::Right, VPos::Center));
                area.draw_text(called, &style, (xs.start - FINE * 6, band.middle))?;
                if let Some(quantiles) = Quantiles::of(units) {
                    band.draw_box(area, quantiles.quartiles.map(at), at(quantiles.median))?;
                }
                let columns: Vec<i32> = units.iter().map(|of| at(of.value)).collect();
                band.mark(hovers, units, &columns, unit);
                band.name_outliers(area, units, &columns, xs.clone())?;
            }
            Ok(())
        },
    )
}

/// Half of the figure: names of outliers above, marks below them about a middle line.
struct Band<'a> {
    called: &'a str,
    lanes: i32,
    middle: i32,
    /// Room for marks above and below the middle.
    room: i32,
}

impl<'a> Band<'a> {
    fn new(called: &'a str, top: i32, height: i32) -> Self {
        let lanes = top + FINE * 3;
        let below = lanes + LANES as i32 * LANE;
        let room = (top + height - below) / 2 - FINE * 2;
        Self {
            called,
            lanes,
            middle: below + room,
            room,
        }
    }

    /// The middle half of the units, and their median.
    fn draw_box(&self, area: &Area, [from, to]: [i32; 2], median: i32) -> Result<(), DrawError> {
        let (high, low) = (self.middle - self.room, self.middle + self.room);
        let fill = MUTED.mix(BAND).filled();
        area.draw(&Rectangle::new([(from, high), (to, low)], fill))?;
        area.draw(&PathElement::new(
            [(median, high), (median, low)],
            line(MUTED, 20),
        ))
    }

    /// A mark for every unit: triangles before, dots after.
    fn mark(&self, hovers: &mut Hovers, units: &[Unit], columns: &[i32], symbol: &str) {
        for (of, (x, y)) in units.iter().zip(stacked(columns, self.middle, self.room)) {
            let value = with_unit(of.value, symbol);
            let shown = format!("{}, {}: {value}", of.serial, self.called);
            let (left, right, high, low) = (x - RADIUS, x + RADIUS, y - RADIUS, y + RADIUS);
            hovers.mark(html! {
                @if self.called == "before" {
                    polygon class={ "unit " (of.class) } fill=(hex(BEFORE))
                        points=(format!("{x},{high} {left},{low} {right},{low}")) { title { (shown) } }
                } @else {
                    circle class={ "unit " (of.class) } fill=(hex(AFTER)) cx=(x) cy=(y) r=(RADIUS) {
                        title { (shown) }
                    }
                }
            });
        }
    }

    /// Names of outliers, the farthest first, as long as there is room for them.
    fn name_outliers(
        &self,
        area: &Area,
        units: &[Unit],
        columns: &[i32],
        xs: Range<i32>,
    ) -> Result<(), DrawError> {
        let scored = units.iter().zip(columns);
        let mut outliers: Vec<(f64, &Unit, i32)> = scored
            .filter_map(|(of, &x)| Some((of.outlier?.abs(), of, x)))
            .collect();
        outliers.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut taken: Vec<(usize, Range<i32>)> = Vec::new();
        for (_, of, x) in outliers {
            let name = short(of.serial);
            // No font is at hand to measure with.
            let width = FINE * 8 * name.chars().count() as i32;
            let left = (x - width / 2).min(xs.end - width).max(xs.start);
            let free = |lane: &usize| {
                let mut others = taken.iter().filter(|(of, _)| of == lane);
                others.all(|(_, other)| other.end <= left || left + width <= other.start)
            };
            let Some(lane) = (0..LANES).rev().find(free) else {
                continue;
            };
            taken.push((lane, left..left + width));
            let style = text(12, INK).pos(Pos::new(HPos::Center, VPos::Center));
            let y = self.lanes + lane as i32 * LANE + LANE / 2;
            area.draw_text(&name, &style, (left + width / 2, y))?;
        }
        Ok(())
    }
}

/// Places of marks at columns about a middle line: those that would lie upon each other are stacked
/// up and down in turn, closer where there are many.
fn stacked(columns: &[i32], middle: i32, room: i32) -> Vec<(i32, i32)> {
    let bin = |x: i32| x.div_euclid(2 * RADIUS);
    let mut heights: HashMap<i32, i32> = HashMap::new();
    let steps: Vec<i32> = columns
        .iter()
        .map(|&x| {
            let height = heights.entry(bin(x)).or_default();
            *height += 1;
            // 0, 1, -1, 2, -2, ...
            if *height % 2 == 0 {
                *height / 2
            } else {
                -(*height / 2)
            }
        })
        .collect();
    let most = steps
        .iter()
        .map(|step| step.abs())
        .max()
        .unwrap_or(0)
        .max(1);
    let step_height = (2 * RADIUS).min((room - RADIUS) / most);
    let place = |(&x, step): (&i32, i32)| ((2 * bin(x) + 1) * RADIUS, middle + step * step_height);
    columns.iter().zip(steps).map(place).collect()
}

fn short(serial: &str) -> String {
    match serial.char_indices().nth(NAME) {
        Some(_) => serial.chars().take(NAME - 1).chain(['\u{2026}']).collect(),
        None => serial.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_stacked_within_their_room() {
        let places = stacked(&[100, 101, 102, 400], 500, 200);
        assert_eq!(
            places.iter().map(|p| p.1 - 500).collect::<Vec<_>>(),
            [0, 28, -28, 0]
        );
        let many = stacked(&[100; 1000], 500, 200);
        assert!(many.iter().all(|(_, y)| (300..=700).contains(y)));
    }

    #[test]
    fn long_names_are_cut() {
        assert_eq!(short("SN-7"), "SN-7");
        assert_eq!(short("0123456789abcdefg").chars().count(), NAME);
    }
}
