//! The spline model of a channel, fitted on the core's own regressors.

use tempco::{PLAYS, Terms, ThermalPoint, ThermalSettings};
use tempco_set::run::with_every_rate;
use tempco_set::{
    CoefficientSigmas, GainSet, NoiseSet, Overlap, Segment, SegmentSet, Segmentation, TERMS,
};

use crate::channel_fit::ChannelFit;
use crate::error::FitError;
use crate::least_squares::{Blocks, RateForm, SamplePoints};
use crate::segments::solve::{LEAST_SPAN, Place, SegmentRows, Unfit};
use crate::spline::candidate::Spline;
use crate::spline::covariance::of_combinations;
use crate::spline::rows::Rows;
use crate::spline::solve::{AxisSolution, solve_axes};
use crate::summary::ChannelData;

/// Fits a spline model with the settings' thermal path at its lag; an axis without its rate terms
/// or history terms keeps the rest.
pub(crate) fn fit(
    data: &ChannelData,
    settings: ThermalSettings,
    Spline {
        layout,
        rate,
        lag,
        shape,
        axes,
    }: &Spline,
) -> Result<ChannelFit, FitError> {
    let rate = *rate;
    let thermal = shape.settings(ThermalSettings {
        tau_s: lag.tau_s as f32,
        kappa: lag.kappa as f32,
        ..settings
    });
    // The core runs over the samples at the chosen lag, with no limit on the rate. The limits
    // follow from what it finds.
    let open = with_every_rate(thermal).map_err(FitError::Settings)?;
    let blocks = Blocks::new(data);
    let points = SamplePoints::new(data, &open);
    let samples = || {
        let all = blocks.blocks.iter();
        all.flat_map(|block| points.of_block(block).map(move |kept| (block.log, kept)))
    };
    let range = |figure: fn(&ThermalPoint) -> f32| {
        let figures = samples().map(|(_, kept)| figure(&kept.point));
        let ends = (f32::INFINITY, f32::NEG_INFINITY);
        figures.fold(ends, |(low, high), value| (low.min(value), high.max(value)))
    };
    let calibrated_c = range(|point| point.effective_c);
    let range_c = (f64::from(calibrated_c.0), f64::from(calibrated_c.1));
    let mut sorted_c = blocks.temp_c.clone();
    sorted_c.sort_by(f64::total_cmp);
    let unsolved = || FitError::Spline {
        segments: layout.segments(),
    };
    // The layout was tried on the means of blocks, which reach less far than their samples.
    let basis = layout.basis(range_c, &sorted_c, rate, data.logs.len());
    let basis = basis.ok_or_else(unsolved)?;
    // The pieces of the spline become the segments of the set, each with its coverage.
    let pairs = basis.breakpoints_c().windows(2);
    let pieces: Vec<Segment> = pairs
        .map(|pair| Segment {
            t_min_c: pair[0],
            t_max_c: pair[1],
        })
        .collect();
    let timed = samples().map(|(log, kept)| Timed {
        point: kept.point,
        rows: kept.rows as u64,
        time_s: kept.rows * data.logs[log].interval_s,
    });
    let covered = coverage(timed, &pieces, calibrated_c)?;
    // Least squares over all axes: the static part, the rate terms, then the history terms.
    let basis = basis.with_history(shape.terms().len());
    let rows = Rows::new(&points, &blocks, &basis, shape);
    let (solutions, condition) = solve_axes(&rows, &blocks, &basis, axes).ok_or_else(unsolved)?;
    // Spline coefficients become a polynomial per segment, and their covariances sigmas.
    let maps = basis.polynomial_maps();
    let mut polynomials = Vec::new();
    let mut sigmas = Vec::new();
    let mut noises = Vec::new();
    let mut gains = Vec::new();
    for (axis, solution) in solutions.into_iter().enumerate() {
        let AxisSolution {
            mut coefficients,
            covariance,
            noise,
        } = solution;
        let of_segment = maps.iter().map(|(_, rows)| {
            CoefficientSigmas::from_covariance(of_combinations(&covariance, rows))
        });
        let mut of_segments: Vec<CoefficientSigmas> = of_segment.collect();
        noises.push(Some(NoiseSet {
            white: noise.white.sqrt(),
            walk: (3600.0 * noise.walk).sqrt(),
        }));
        let first_state = basis.columns_without_history();
        let of_terms = (first_state..basis.columns()).map(|column| GainSet {
            gain: coefficients[column],
            sigma: covariance[(column, column)].max(0.0).sqrt(),
        });
        let mut of_plays: Vec<GainSet> = of_terms.collect();
        // The gain of the second lag is the same over the whole range.
        let of_lag = shape
            .tau2_s
            .and_then(|_| of_plays.pop())
            .unwrap_or_default();
        if !of_plays.is_empty() {
            of_plays.resize(PLAYS, GainSet::default());
        }
        gains.push(of_plays);
        for sigmas in &mut of_segments {
            sigmas.s[0] = of_lag.sigma;
        }
        sigmas.push(of_segments);
        // The splines add up to 1: the mean constant of the logs goes to all of them.
        let constant = blocks.mean(axis);
        for coefficient in &mut coefficients[..basis.static_columns()] {
            *coefficient += constant;
        }
        let mut of_segments = basis.polynomials(&coefficients);
        for polynomial in &mut of_segments {
            polynomial.s[0] = of_lag.gain;
        }
        polynomials.push(of_segments);
    }

    // Without rate terms the set lists the static terms only.
    let names = if rate == RateForm::None {
        &TERMS[..Terms::STATIC]
    } else {
        &TERMS[..]
    };
    let segments = covered
        .into_iter()
        .map(|segment| SegmentSet {
            terms: names.iter().map(|&t| t.to_owned()).collect(),
            condition,
            ..segment
        })
        .collect();
    Ok(ChannelFit {
        thermal,
        calibrated_c,
        rates: range(|point| point.rate_c_per_min),
        lags: range(|point| point.lag2_c),
        segmentation: Segmentation::new(pieces)?,
        overlap: Overlap::Spline,
        segments,
        polynomials,
        sigmas,
        noises,
        gains,
    })
}

/// A point that stands for some rows.
struct Timed {
    point: ThermalPoint,
    rows: u64,
    time_s: f64,
}

/// What each segment was fitted from; without terms.
fn coverage(
    points: impl Iterator<Item = Timed>,
    pieces: &[Segment],
    (t_min_c, t_max_c): (f32, f32),
) -> Result<Vec<SegmentSet>, FitError> {
    let mut rows = vec![SegmentRows::new(0); pieces.len()];
    let ends = &pieces[..pieces.len() - 1];
    for Timed {
        point,
        rows: count,
        time_s,
    } in points
    {
        let temp_c = f64::from(point.effective_c);
        let at = ends.partition_point(|piece| piece.t_max_c <= temp_c);
        let z = (temp_c - pieces[at].centre_c()) / pieces[at].half_width_c();
        let place = Place::at(z.clamp(-1.0, 1.0), point.rate_c_per_min.into());
        rows[at].push_mean(&place, (count, time_s), std::iter::empty());
    }
    let segments = pieces.iter().zip(rows).map(|(piece, mut rows)| {
        let coverage = rows.coverage();
        let unfit = if rows.rows() == 0 {
            Some(Unfit::Rows(0))
        } else if coverage.width < LEAST_SPAN {
            Some(Unfit::Span(100.0 * coverage.width))
        } else {
            None
        };
        if let Some(unfit) = unfit {
            return Err(FitError::Segment {
                segment: *piece,
                reason: unfit.to_string(),
                t_min_c,
                t_max_c,
            });
        }
        Ok(SegmentSet {
            t_min_c: piece.t_min_c,
            t_max_c: piece.t_max_c,
            terms: Vec::new(),
            rows: rows.rows(),
            condition: 0.0,
            coverage: Some(coverage),
        })
    });
    segments.collect()
}
