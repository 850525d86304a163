//! The paper's fit: each segment by itself, overlaps shared.

use tempco::ThermalSettings;

use crate::fit::FitError;
use crate::fit::channel::ChannelFit;
use crate::model::Polynomial;
use crate::regress::ChannelData;
use crate::segment::{Overlap, Segmentation};
use crate::set::{CoefficientSigmas, SegmentSet};
use crate::solve::{SegmentRows, TERMS};

/// Fits `terms` terms, or as many as the data can carry, to every segment.
pub(crate) fn fit(
    data: &ChannelData,
    thermal: ThermalSettings,
    terms: usize,
    (segmentation, overlap): (&Segmentation, Overlap),
    remarks: &mut Vec<String>,
) -> Result<ChannelFit, FitError> {
    let (t_min_c, t_max_c) = data.range(|point| point.effective_c);
    let temperature = &data.logs[0].channels[data.channel].column;
    let (rows, outside) = rows_of(data, segmentation, overlap);
    if outside > 0 {
        let (low, high) = segmentation.range_c();
        remarks.push(format!(
            "{outside} rows lie outside the segments ({low} to {high} degC); at run time the \
             temperature is clamped there"
        ));
    }

    let mut segments = Vec::new();
    let mut polynomials = vec![Vec::new(); data.axes()];
    let mut sigmas = vec![Vec::new(); data.axes()];
    for (segment, rows) in segmentation.segments().iter().zip(rows) {
        let fit = rows
            .fit(terms, f64::from(thermal.tau_s))
            .map_err(|unfit| FitError::Segment {
                segment: *segment,
                reason: unfit.to_string(),
                t_min_c,
                t_max_c,
            })?;
        if fit.terms < terms {
            remarks.push(format!(
                "segment {segment} degC ({temperature}): the data cannot tell {} apart from the \
                 other terms; dropped",
                TERMS[fit.terms..terms].join(", ")
            ));
        }
        for (axis, coefficients) in polynomials.iter_mut().zip(&fit.solution.coefficients) {
            axis.push(Polynomial::new(segment, coefficients));
        }
        for (axis, found) in sigmas.iter_mut().zip(&fit.solution.sigmas) {
            axis.push(CoefficientSigmas::new(found, &fit.solution.correlations));
        }
        segments.push(SegmentSet {
            t_min_c: segment.t_min_c,
            t_max_c: segment.t_max_c,
            terms: TERMS[..fit.terms]
                .iter()
                .map(|&term| term.to_owned())
                .collect(),
            rows: fit.rows,
            condition: fit.solution.condition,
            coverage: Some(fit.coverage),
        });
    }
    let (low, high) = segmentation.range_c();
    Ok(ChannelFit {
        thermal,
        calibrated_c: (t_min_c.max(low as f32), t_max_c.min(high as f32)),
        rates: data.range(|point| point.rate_c_per_min),
        segmentation: segmentation.clone(),
        overlap,
        segments,
        polynomials,
        sigmas,
        noises: vec![None; data.axes()],
        history: Vec::new(),
        gains: vec![Vec::new(); data.axes()],
    })
}

/// The rows of each segment, and the number of rows outside all of them.
fn rows_of(
    data: &ChannelData,
    segmentation: &Segmentation,
    overlap: Overlap,
) -> (Vec<SegmentRows>, usize) {
    let ranges = segmentation.fit_ranges(overlap);
    let mut rows = vec![SegmentRows::new(data.axes()); ranges.len()];
    let mut outside = 0;
    for (interval_s, point, raw) in data.timed_rows() {
        let temp_c = f64::from(point.effective_c);
        let raw: Vec<f64> = raw.collect();
        let mut taken = false;
        for ((segment, range), rows) in segmentation.segments().iter().zip(&ranges).zip(&mut rows) {
            if temp_c >= range.t_min_c && temp_c <= range.t_max_c {
                let z = (temp_c - segment.centre_c()) / segment.half_width_c();
                let rate = f64::from(point.rate_c_per_min);
                rows.push(interval_s, z, rate, raw.iter().copied());
                taken = true;
            }
        }
        outside += usize::from(!taken);
    }
    (rows, outside)
}
