//! Options as Python passes them.

use pyo3::prelude::*;
use tempco_fit::{LagSearch, Method, Plan, PlanOptions, SegmentModel, SegmentOverlap};
use tempco_log::{Mapping, ReadOptions};
use tempco_set::{SCALE_FACTORS_ARCSEC, Segmentation, Stretch};

use crate::errors::{FitError, LogError, of_fit};

/// How to read a log; the texts are as in the command's options.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    time: Option<String>,
    temp: Vec<String>,
    axis: Vec<String>,
    filter: Vec<String>,
    instance: Option<u32>,
    join: Option<String>,
    scale_factor: Option<f64>,
    skip_bad_rows: bool,
}

impl Reading {
    /// # Errors
    /// An angle per pulse that cannot be.
    pub(crate) fn options(self) -> PyResult<ReadOptions> {
        if let Some(arcsec) = self.scale_factor
            && !SCALE_FACTORS_ARCSEC.contains(&arcsec)
        {
            let (least, most) = (SCALE_FACTORS_ARCSEC.start(), SCALE_FACTORS_ARCSEC.end());
            return Err(LogError::new_err(format!(
                "scale_factor {arcsec}: expected arcsec per pulse, {least:e} to {most:e}"
            )));
        }
        Ok(ReadOptions {
            mapping: Mapping {
                time: self.time,
                temp: self.temp,
                axis: self.axis,
                filter: self.filter,
                instance: self.instance,
                join: self.join,
            },
            kept: Vec::new(),
            scale_factor_arcsec: self.scale_factor,
            skip_bad_rows: self.skip_bad_rows,
        })
    }
}

/// What must be known before logs are summarised.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PlanFields {
    rate_tau: Option<f32>,
    kappa: Option<f32>,
    exclude: Vec<(f64, f64)>,
    keep_outliers: bool,
    max_slew: Option<f32>,
    tau: f64,
}

impl PlanFields {
    /// The plan of logs that are read with this angle per pulse \[arcsec\].
    ///
    /// # Errors
    /// Settings that the core refuses, stretches that end before they begin.
    pub(crate) fn plan(self, scale_factor_arcsec: Option<f64>) -> PyResult<Plan> {
        let mut options = PlanOptions {
            search: LagSearch {
                tau: self.rate_tau.is_none(),
                kappa: self.kappa.is_none(),
            },
            robust: !self.keep_outliers,
            scale_factor_arcsec,
            tau_s: self.tau,
            ..PlanOptions::default()
        };
        for (from_s, to_s) in self.exclude {
            if from_s.partial_cmp(&to_s) != Some(std::cmp::Ordering::Less) {
                return Err(FitError::new_err(format!(
                    "exclude ({from_s}, {to_s}): expected (T1, T2) in s, T1 before T2"
                )));
            }
            options.exclude.push(Stretch { from_s, to_s });
        }
        let thermal = &mut options.thermal;
        thermal.tau_s = self.rate_tau.unwrap_or(thermal.tau_s);
        thermal.kappa = self.kappa.unwrap_or(thermal.kappa);
        thermal.max_slew_c_per_min = self.max_slew.unwrap_or(thermal.max_slew_c_per_min);
        Plan::new(options).map_err(of_fit)
    }
}

/// What is fitted.
///
/// # Errors
/// An unknown model or overlap; segments that cannot be.
pub(crate) fn method(model: &str, overlap: &str, segments: Option<&str>) -> PyResult<Method> {
    let refused = |message: String| FitError::new_err(message);
    let overlap = match overlap {
        "none" => SegmentOverlap::None,
        "hard" => SegmentOverlap::Hard,
        "mean" => SegmentOverlap::Mean,
        "linear" => SegmentOverlap::Linear,
        "smooth" => SegmentOverlap::Smooth,
        other => {
            return Err(refused(format!(
                "overlap `{other}`: expected none, hard, mean, linear or smooth"
            )));
        }
    };
    let segmentation = segments
        .map(|text| text.parse::<Segmentation>())
        .transpose()
        .map_err(|error| refused(format!("segments: {error}")))?;
    let model = match model {
        "static" => SegmentModel::Static,
        "composite" => SegmentModel::Composite,
        "auto" => {
            return Ok(Method::Auto {
                overlap,
                segmentation,
            });
        }
        other => {
            return Err(refused(format!(
                "model `{other}`: expected static, composite or auto"
            )));
        }
    };
    Ok(Method::Segments {
        model,
        overlap,
        segmentation,
    })
}
