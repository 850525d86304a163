//! A figure as SVG: what plotters draws, and values that show when pointed at.

use maud::{Markup, PreEscaped, html};
use plotters::coord::Shift;
use plotters::prelude::*;
use tempco_set::escape;

use super::palette::SURFACE;
use crate::ReportError;

/// Width of a figure in units of its view box, which are about pixels.
pub(super) const WIDTH: i32 = 440;

/// plotters rounds to whole pixels; this many of them make a unit, so that curves stay smooth.
pub(super) const FINE: i32 = 4;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawError = DrawingAreaErrorKind<std::io::Error>;

/// A drawn figure.
pub(crate) struct Figure {
    /// Name of its file, without the extension.
    pub(crate) name: String,
    /// What it shows, for those who do not see it.
    pub(crate) label: String,
    height: i32,
    /// Everything between the outermost tags.
    body: String,
}

/// Places that show a value when pointed at, in fine pixels, and marks that are drawn last.
#[derive(Default)]
pub(super) struct Hovers {
    places: Vec<(Place, String)>,
    marks: Vec<Markup>,
}

enum Place {
    Dot((i32, i32)),
    Rectangle((i32, i32), (i32, i32)),
}

impl Hovers {
    pub(super) fn dot(&mut self, at: (i32, i32), text: String) {
        self.places.push((Place::Dot(at), text));
    }

    /// Between two opposite corners.
    pub(super) fn rectangle(&mut self, a: (i32, i32), b: (i32, i32), text: String) {
        let low = (a.0.min(b.0), a.1.min(b.1));
        let high = (a.0.max(b.0), a.1.max(b.1));
        self.places.push((Place::Rectangle(low, high), text));
    }

    /// A mark of its own, which can have a class, unlike what plotters draws.
    pub(super) fn mark(&mut self, mark: Markup) {
        self.marks.push(mark);
    }

    fn markup(&self) -> Markup {
        html! {
            @for mark in &self.marks { (mark) }
            g fill-opacity="0" {
                @for (place, text) in &self.places {
                    @match place {
                        Place::Dot((x, y)) => circle cx=(x) cy=(y) r=(5 * FINE) { title { (text) } },
                        Place::Rectangle((x0, y0), (x1, y1)) =>
                            rect x=(x0) y=(y0) width=(x1 - x0) height=(y1 - y0) { title { (text) } },
                    }
                }
            }
        }
    }
}

impl Figure {
    pub(super) fn draw(
        name: String,
        label: String,
        height: i32,
        draw: impl FnOnce(&Area, &mut Hovers) -> Result<(), DrawError>,
    ) -> Result<Self, ReportError> {
        let mut svg = String::new();
        let mut hovers = Hovers::default();
        let size = ((FINE * WIDTH) as u32, (FINE * height) as u32);
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let drawn = area
            .fill(&SURFACE)
            .and_then(|()| draw(&area, &mut hovers))
            .and_then(|()| area.present());
        drop(area);
        drawn.map_err(|error| ReportError::Drawing {
            figure: name.clone(),
            message: error.to_string(),
        })?;
        let inner = svg
            .split_once('>')
            .and_then(|(_, rest)| rest.rsplit_once("</svg>"))
            .map_or("", |(inner, _)| inner);
        // Opaque is the default; plotters says so of every element.
        let mut body = inner.replace(" opacity=\"1\"", "");
        body += &hovers.markup().0;
        Ok(Self {
            name: escape::file_name(&name),
            label,
            height,
            body,
        })
    }

    /// For a page.
    pub(crate) fn inline(&self) -> Markup {
        let view_box = format!("0 0 {} {}", FINE * WIDTH, FINE * self.height);
        html! {
            svg id=(self.name) viewBox=(view_box) role="img" aria-label=(self.label) {
                (PreEscaped(&self.body))
            }
        }
    }

    /// As a file of its own.
    pub(crate) fn file(&self) -> String {
        let view_box = format!("0 0 {} {}", FINE * WIDTH, FINE * self.height);
        let svg = html! {
            svg xmlns="http://www.w3.org/2000/svg" width=(2 * WIDTH) height=(2 * self.height)
                viewBox=(view_box) role="img" aria-label=(self.label) {
                (PreEscaped(&self.body))
            }
        };
        escape::lines(&svg.0) + "\n"
    }
}
