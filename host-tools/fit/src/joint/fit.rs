//! The spline model of a channel, fitted on the core's own regressors.

use tempco::ThermalSettings;

use crate::fit::{ChannelFit, FitError};
use crate::joint::basis::RateForm;
use crate::joint::blocks::Blocks;
use crate::joint::covariance::of_combinations;
use crate::joint::select::Spline;
use crate::joint::solve::{AxisSolution, Rows, solve_axes};
use crate::joint::states::row_states;
use crate::regress::{ChannelData, with_every_rate};
use crate::segment::{Overlap, Segment, Segmentation};
use crate::set::{CoefficientSigmas, GainSet, NoiseSet, SegmentSet};
use crate::solve::{LEAST_SPAN, SegmentRows, TERMS};

/// Fits a spline model with the settings' thermal path at its lag; an axis without its rate terms
/// or earned states keeps the rest.
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
    let thermal = ThermalSettings {
        tau_s: lag.tau_s as f32,
        kappa: lag.kappa as f32,
        ..settings
    };
    let open = with_every_rate(thermal).map_err(FitError::Settings)?;
    let data = data.with(&open);
    let blocks = Blocks::new(&data);
    let calibrated_c = data.range(|point| point.effective_c);
    let range_c = (f64::from(calibrated_c.0), f64::from(calibrated_c.1));
    let mut sorted_c = blocks.temp_c.clone();
    sorted_c.sort_by(f64::total_cmp);
    let basis = layout
        .basis(range_c, &sorted_c, rate, data.logs.len())
        .expect("the layout was tried on the same blocks");
    let terms = shape.terms();
    let basis = basis.with_states(terms.len());
    let states = row_states(&data, &open, &terms);

    let rows = Rows::new(&data, &blocks, &basis, &states);
    let unsolved = || FitError::Joint {
        segments: basis.segments(),
    };
    let (solutions, condition) = solve_axes(&rows, &blocks, &basis, axes).ok_or_else(unsolved)?;
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
        sigmas.push(of_segment.collect());
        noises.push(Some(NoiseSet {
            white: noise.white.sqrt(),
            walk: (3600.0 * noise.walk).sqrt(),
        }));
        let first_state = basis.columns_without_states();
        let of_terms = (first_state..basis.columns()).map(|column| GainSet {
            gain: coefficients[column],
            sigma: covariance[(column, column)].max(0.0).sqrt(),
        });
        gains.push(of_terms.collect());
        // The splines add up to 1: the mean constant of the logs goes to all of them.
        let means = blocks.log_means.iter().map(|means| means[axis]);
        let constant = means.sum::<f64>() / blocks.logs() as f64;
        for coefficient in &mut coefficients[..basis.static_columns()] {
            *coefficient += constant;
        }
        polynomials.push(basis.polynomials(&coefficients));
    }

    let pairs = basis.breakpoints_c().windows(2);
    let pieces: Vec<Segment> = pairs
        .map(|pair| Segment {
            t_min_c: pair[0],
            t_max_c: pair[1],
        })
        .collect();
    let names = if rate == RateForm::None {
        &TERMS[..3]
    } else {
        &TERMS[..]
    };
    let segments = coverage(&data, &pieces)?
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
        rates: data.range(|point| point.rate_c_per_min),
        segmentation: Segmentation::new(pieces)?,
        overlap: Overlap::Spline,
        segments,
        polynomials,
        sigmas,
        noises,
        history: terms
            .into_iter()
            .zip(&states)
            .map(|(term, values)| (term, most(&data, values)))
            .collect(),
        gains,
    })
}

/// The largest value of a term in the kept rows.
fn most(data: &ChannelData, values: &[Vec<f32>]) -> f32 {
    let rows = values.iter().flatten().zip(data.keep.iter().flatten());
    let kept = rows.filter(|(_, keep)| **keep);
    kept.fold(0.0, |most, (value, _)| most.max(value.abs()))
}

/// What each segment was fitted from; without terms.
fn coverage(data: &ChannelData, pieces: &[Segment]) -> Result<Vec<SegmentSet>, FitError> {
    let mut rows = vec![SegmentRows::new(0); pieces.len()];
    let ends = &pieces[..pieces.len() - 1];
    for (interval_s, point, _) in data.timed_rows() {
        let temp_c = f64::from(point.effective_c);
        let at = ends.partition_point(|piece| piece.t_max_c <= temp_c);
        let z = (temp_c - pieces[at].centre_c()) / pieces[at].half_width_c();
        let rate = point.rate_c_per_min.into();
        rows[at].push(interval_s, z.clamp(-1.0, 1.0), rate, std::iter::empty());
    }
    let (t_min_c, t_max_c) = data.range(|point| point.effective_c);
    let segments = pieces.iter().zip(rows).map(|(piece, mut rows)| {
        let coverage = rows.coverage();
        if rows.rows() == 0 || coverage.width < LEAST_SPAN {
            return Err(FitError::Segment {
                segment: *piece,
                reason: format!(
                    "holds {} usable rows over {:.0} % of its width",
                    rows.rows(),
                    100.0 * coverage.width
                ),
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
