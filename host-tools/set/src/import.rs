//! Reads printed static coefficients, such as table 2 of Weng et al. 2020, as a set.
//!
//! The header is `gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,
//! a2_1e-5_pulses_per_c2`, one row per gyro and segment; a column `a2_pulses_per_c2` without the
//! factor is read as well. The unit is pulses/s.

use std::path::Path;

use serde::Deserialize;
use sha2::{Digest, Sha256};
use tempco::ThermalSettings;
use tempco_log::{AxisUnit, SkippedRows, hex};

use crate::build::{self, Fitted};
use crate::model::{Polynomial, TERMS};
use crate::segment::{Overlap, Segment, Segmentation};
use crate::{AxisSet, CoefficientSet, Input, Model, Provenance, SegmentSet, Settings};

#[derive(Deserialize)]
struct Row {
    gyro: String,
    temp_min_c: f64,
    temp_max_c: f64,
    a0_pulses: f64,
    a1_pulses_per_c: f64,
    #[serde(rename = "a2_1e-5_pulses_per_c2")]
    a2_scaled: Option<f64>,
    a2_pulses_per_c2: Option<f64>,
}

pub(crate) fn static_coefficients(path: &Path, text: &str) -> Result<CoefficientSet, String> {
    // A row is a segment of a gyro; a2 stands in one of two columns, scaled or not.
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let mut gyros: Vec<(String, Vec<Segment>, Vec<Polynomial>)> = Vec::new();
    let mut rows = 0;
    for row in reader.deserialize() {
        let row: Row = row.map_err(|error| {
            format!("{error}; expected static coefficients as in the paper's table 2")
        })?;
        rows += 1;
        let a2 = match (row.a2_scaled, row.a2_pulses_per_c2) {
            (Some(scaled), None) => scaled * 1e-5,
            (None, Some(a2)) => a2,
            _ => return Err("expected one column of a2".to_owned()),
        };
        let segment = Segment {
            t_min_c: row.temp_min_c,
            t_max_c: row.temp_max_c,
        };
        let raw = [row.a0_pulses, row.a1_pulses_per_c, a2];
        let polynomial = Polynomial::from_raw_static(&segment, raw);
        match gyros.iter_mut().find(|(gyro, ..)| *gyro == row.gyro) {
            Some((_, segments, polynomials)) => {
                segments.push(segment);
                polynomials.push(polynomial);
            }
            None => gyros.push((row.gyro, vec![segment], vec![polynomial])),
        }
    }
    // A table has one grid for all axes, so all gyros need the same segments.
    let segments = match gyros.first() {
        Some((_, segments, _)) => segments.clone(),
        None => return Err("no coefficients after the header".to_owned()),
    };
    if let Some((gyro, ..)) = gyros.iter().find(|(_, other, _)| *other != segments) {
        return Err(format!(
            "gyro {gyro} has other segments than the first gyro"
        ));
    }
    let segmentation = Segmentation::new(segments).map_err(|error| error.to_string())?;
    let axes = gyros.into_iter().map(|(name, _, polynomials)| {
        let name = name.to_lowercase();
        (name, AxisUnit::PulsesPerS, polynomials)
    });
    static_set(
        Source { path, text, rows },
        "imported",
        &segmentation,
        Overlap::Linear,
        axes.collect(),
    )
}

/// The file that coefficients were read from.
pub(crate) struct Source<'a> {
    pub(crate) path: &'a Path,
    pub(crate) text: &'a str,
    /// How many rows or parameters of it were used.
    pub(crate) rows: usize,
}

/// A set of static polynomials by axis, of which no fit is known: no rows, no sigmas, and no rate that
/// is calibrated.
pub(crate) fn static_set(
    source: Source,
    serial: &str,
    segmentation: &Segmentation,
    overlap: Overlap,
    axes: Vec<(String, AxisUnit, Vec<Polynomial>)>,
) -> Result<CoefficientSet, String> {
    let (t_min_c, t_max_c) = segmentation.range_c();
    let segments = segmentation.segments().iter().map(|segment| SegmentSet {
        t_min_c: segment.t_min_c,
        t_max_c: segment.t_max_c,
        terms: TERMS[..Model::Static.terms()]
            .iter()
            .map(|&t| t.to_owned())
            .collect(),
        rows: 0,
        condition: 0.0,
        coverage: None,
    });
    let axes_of_unit = axes.len();
    let axes = axes.into_iter().map(|(name, unit, polynomials)| AxisSet {
        name,
        unit,
        reference_c: None,
        polynomials,
        sigmas: Vec::new(),
        gains: Vec::new(),
        noise: None,
        held_out: None,
        statistics: None,
    });
    let channel = build::channel(
        Fitted {
            temperature: "temp_c".to_owned(),
            segments: segments.collect(),
            axes: axes.collect(),
            outliers: None,
            selection: None,
        },
        segmentation,
        overlap,
        ThermalSettings {
            reference_c: 25.0_f64.clamp(t_min_c, t_max_c) as f32,
            rate_min_c_per_min: 0.0,
            rate_max_c_per_min: 0.0,
            ..ThermalSettings::DEFAULT
        },
        (t_min_c as f32, t_max_c as f32),
        axes_of_unit,
    );
    // The file is the only input; its hash says which one it was.
    let file = source.path.file_name().unwrap_or_default();
    let input = Input {
        file: file.to_string_lossy().into(),
        sha256: hex(&Sha256::digest(source.text.as_bytes())),
        rows: source.rows,
        skipped_rows: 0,
        skipped: SkippedRows::default(),
        unusable_rows: 0,
        interval_s: 0.0,
        duration_s: 0.0,
        findings: Vec::new(),
        doubts: Vec::new(),
        mapping: None,
    };
    let set = build::set(
        serial.to_owned(),
        Provenance {
            tool: build::tool(),
            created: build::now(),
            inputs: vec![input],
        },
        Settings {
            model: Model::Static,
            overlap,
            scale_factor_arcsec: None,
            thermal_period_s: 0.0,
        },
        vec![channel],
    );
    set.check()?;
    Ok(set)
}
