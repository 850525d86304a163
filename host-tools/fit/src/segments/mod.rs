//! The paper's fit: each segment by itself, overlaps shared.

pub(crate) mod solve;

use tempco::ThermalSettings;
use tempco_set::{
    CoefficientSigmas, Overlap, Polynomial, Segment, SegmentSet, Segmentation, TERMS, Warning,
    WarningCode,
};

use crate::channel_fit::ChannelFit;
use crate::error::FitError;
use crate::segments::solve::{Place, SegmentRows};
use crate::summary::{ChannelData, Moments};

/// Fits `terms` terms, or as many as the data can carry, to every segment.
pub(crate) fn fit(
    data: &ChannelData,
    thermal: ThermalSettings,
    terms: usize,
    (segmentation, overlap): (&Segmentation, Overlap),
    warnings: &mut Vec<Warning>,
) -> Result<ChannelFit, FitError> {
    let (t_min_c, t_max_c) = data.range(|block| block.effective_range_c);
    let temperature = data.temperature();
    // Rows outside are not fitted, and the user should know.
    let (rows, outside) = rows_of(data, segmentation, overlap);
    if outside > 0 {
        let (low, high) = segmentation.range_c();
        warnings.push(Warning::new(
            WarningCode::RowsOutsideSegments,
            format!(
                "{temperature}: {outside} rows lie outside the segments ({low} to {high} degC); at \
                 run time the temperature is clamped there"
            ),
        ));
    }

    // Each segment is solved by itself; the results are sorted by axis, as a set has them.
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
    // The calibrated range ends where rows or segments end, whichever is nearer.
    let (low, high) = segmentation.range_c();
    Ok(ChannelFit {
        thermal,
        calibrated_c: (t_min_c.max(low as f32), t_max_c.min(high as f32)),
        rates: data.range(|block| block.rate_range),
        segmentation: segmentation.clone(),
        overlap,
        segments,
        polynomials,
        sigmas,
        noises: vec![None; data.axes()],
        lags: (0.0, 0.0),
        gains: vec![Vec::new(); data.axes()],
    })
}

/// The rows of each segment, and the number of rows outside all of them. A block belongs where its
/// mean lies: its rows are a fraction of a degree apart, by which a segment may reach beyond its
/// ends.
fn rows_of(
    data: &ChannelData,
    segmentation: &Segmentation,
    overlap: Overlap,
) -> (Vec<SegmentRows>, u64) {
    let ranges = segmentation.fit_ranges(overlap);
    let mut rows = vec![SegmentRows::new(data.axes()); ranges.len()];
    let mut outside = 0;
    for (log, position, block) in data.blocks() {
        let moments = &block.moments;
        let temp_c = moments.effective_c.mean;
        let time_s = moments.rows as f64 * data.logs[log].interval_s;
        let mut taken = false;
        for ((segment, range), rows) in segmentation.segments().iter().zip(&ranges).zip(&mut rows) {
            if temp_c >= range.t_min_c && temp_c <= range.t_max_c {
                let place = place(segment, range, moments);
                let squares = moments.axes.iter().map(|axis| axis.squares);
                let raw = data.levelled((log, position), moments).zip(squares);
                rows.push_mean(&place, (moments.rows, time_s), raw);
                taken = true;
            }
        }
        outside += if taken { 0 } else { moments.rows };
    }
    (rows, outside)
}

/// Where a block lies in a segment that is fitted over `range`.
fn place(segment: &Segment, range: &Segment, moments: &Moments) -> Place {
    let (centre_c, half_width_c) = (segment.centre_c(), segment.half_width_c());
    let z_of = |temp_c: f64| (temp_c - centre_c) / half_width_c;
    let end = |temp_c: f32| z_of(f64::from(temp_c).clamp(range.t_min_c, range.t_max_c));
    let (z, rate, rows) = (
        z_of(moments.effective_c.mean),
        moments.rate,
        moments.rows as f64,
    );
    let square = z * z + moments.effective_c.squares / rows / (half_width_c * half_width_c);
    let product = z * rate + moments.products / rows / half_width_c;
    let extremes = moments.effective_range_c;
    Place {
        regressors: [1.0, z, square, rate, product],
        z_range: (end(extremes.low), end(extremes.high)),
        rate_range: (
            moments.rate_range.low.into(),
            moments.rate_range.high.into(),
        ),
    }
}
