//! Parameters as a set: cubics become quadratic cells.

use std::path::Path;

use tempco_log::AxisUnit;

use super::cubic::Cubics;
use super::{AXES, Autopilot, Parameters, to_rad_per_s};
use crate::import::{Source, static_set};
use crate::model::Polynomial;
use crate::segment::{Overlap, Segment, Segmentation};
use crate::{CoefficientSet, SetError, escape};

/// Accepted deviation of the cells from the cubic, as a share of the range of the bias.
const TOLERANCE: f64 = 1e-4;

/// The most segments of a set.
const MOST_SEGMENTS: usize = 64;

/// Places in a segment at which the cells are compared with the cubic.
const PLACES: usize = 16;

/// A set of imported parameters.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The set.
    pub set: CoefficientSet,
    /// Number of its cells.
    pub cells: usize,
    /// Largest deviation of an axis from its cubic, as a share of the range of its bias.
    pub deviation: f64,
}

/// Reads the parameters of a gyro as a set of quadratic cells, with the axes x, y and z in `unit`.
///
/// # Errors
/// A file that cannot be read, lacks a parameter, or has a range that cannot be.
pub fn import_parameters(
    path: &Path,
    autopilot: Autopilot,
    instance: u32,
    unit: AxisUnit,
    serial: &str,
) -> Result<Imported, SetError> {
    let text = std::fs::read_to_string(path).map_err(|cause| SetError::Io {
        path: path.to_owned(),
        cause,
    })?;
    let imported = imported(path, &text, autopilot, instance, unit, serial);
    imported.map_err(|message| SetError::Refused {
        path: path.to_owned(),
        message: escape::line(&message),
    })
}

fn imported(
    path: &Path,
    text: &str,
    autopilot: Autopilot,
    instance: u32,
    unit: AxisUnit,
    serial: &str,
) -> Result<Imported, String> {
    let columns = match autopilot {
        Autopilot::Px4 => (2, 3),
        Autopilot::ArduPilot => (0, 1),
    };
    let parameters = Parameters::parse(text, columns)?;
    let mut cubics = autopilot.read(&parameters, instance)?;
    let factor = to_rad_per_s(unit)?;
    for coefficient in cubics.axes.iter_mut().flatten() {
        *coefficient /= factor;
    }
    let cells = (1..MOST_SEGMENTS)
        .find(|count| deviation(&cubics, *count) <= TOLERANCE)
        .unwrap_or(MOST_SEGMENTS);
    let segmentation = Segmentation::new(segments(&cubics, cells));
    let segmentation = segmentation.map_err(|error| error.to_string())?;
    let axes = AXES.iter().enumerate().map(|(axis, name)| {
        let segments = segmentation.segments().iter();
        let polynomials = segments.map(|segment| quadratic(&cubics, axis, segment));
        ((*name).to_owned(), unit, polynomials.collect())
    });
    let source = Source {
        path,
        text,
        rows: parameters.0.len(),
    };
    let set = static_set(
        source,
        serial,
        &segmentation,
        Overlap::Spline,
        axes.collect(),
    )?;
    Ok(Imported {
        cells: set.channels[0].table.cells.len(),
        set,
        deviation: deviation(&cubics, cells),
    })
}

/// Segments of equal width over the range.
fn segments(cubics: &Cubics, count: usize) -> Vec<Segment> {
    let (low, high) = cubics.range_c;
    let edge = |number: usize| low + (high - low) * number as f64 / count as f64;
    let segments = (0..count).map(|number| Segment {
        t_min_c: edge(number),
        t_max_c: edge(number + 1),
    });
    segments.collect()
}

/// The quadratic that has the values of the cubic at both ends and in the middle of a segment.
fn quadratic(cubics: &Cubics, axis: usize, segment: &Segment) -> Polynomial {
    let at = |temp_c: f64| cubics.at(axis, temp_c);
    let (cold, hot) = (at(segment.t_min_c), at(segment.t_max_c));
    let middle = at(segment.centre_c());
    let terms = [middle, 0.5 * (hot - cold), 0.5 * (hot + cold) - middle];
    Polynomial::new(segment, &terms)
}

/// Largest deviation of an axis in so many segments, as a share of the range of its bias.
fn deviation(cubics: &Cubics, count: usize) -> f64 {
    let of_axis = |axis: usize| {
        let (mut worst, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
        for segment in segments(cubics, count) {
            let quadratic = quadratic(cubics, axis, &segment);
            for place in 0..=PLACES {
                let z = 2.0 * place as f64 / PLACES as f64 - 1.0;
                let temp_c = segment.centre_c() + z * segment.half_width_c();
                let (cubic, [a0, a1, a2]) = (cubics.at(axis, temp_c), quadratic.a);
                worst = worst.max((a0 + z * (a1 + z * a2) - cubic).abs());
                (low, high) = (low.min(cubic), high.max(cubic));
            }
        }
        // A constant is exact in every cell.
        if worst == 0.0 {
            0.0
        } else {
            worst / (high - low)
        }
    };
    (0..AXES.len()).map(of_axis).fold(0.0, f64::max)
}
