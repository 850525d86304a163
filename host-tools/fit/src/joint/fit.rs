//! The spline model of a channel, fitted on the core's own regressors.

use tempco::{ThermalPoint, ThermalSettings};

use crate::fit::{ChannelFit, FitError};
use crate::joint::basis::RateForm;
use crate::joint::blocks::{Blocks, SamplePoints};
use crate::joint::covariance::{Covariance, of_combinations};
use crate::joint::lag::Lag;
use crate::joint::layout::Layout;
use crate::joint::solve::Rows;
use crate::regress::{ChannelData, with_every_rate};
use crate::segment::{Overlap, Segment, Segmentation};
use crate::set::{CoefficientSigmas, NoiseSet, SegmentSet};
use crate::solve::{LEAST_SPAN, Place, SegmentRows, TERMS};

/// Fits breakpoints of `layout` with the settings' thermal path at `lag`; an axis without its
/// rate terms keeps the rest.
pub(crate) fn fit(
    data: &ChannelData,
    settings: ThermalSettings,
    lag: Lag,
    (layout, rate): (&Layout, RateForm),
    with_rate: &[bool],
) -> Result<ChannelFit, FitError> {
    let thermal = ThermalSettings {
        tau_s: lag.tau_s as f32,
        kappa: lag.kappa as f32,
        ..settings
    };
    let open = with_every_rate(thermal).map_err(FitError::Settings)?;
    let blocks = Blocks::new(data);
    let points = SamplePoints::new(data, &open);
    let samples = || {
        let all = blocks.blocks.iter();
        all.flat_map(|block| points.of_block(block).map(move |found| (block.log, found)))
    };
    let range = |figure: fn(&ThermalPoint) -> f32| {
        let figures = samples().map(|(_, (sample, _))| figure(&sample.point));
        let ends = (f32::INFINITY, f32::NEG_INFINITY);
        figures.fold(ends, |(low, high), value| (low.min(value), high.max(value)))
    };
    let calibrated_c = range(|point| point.effective_c);
    let range_c = (f64::from(calibrated_c.0), f64::from(calibrated_c.1));
    let mut sorted_c = blocks.temp_c.clone();
    sorted_c.sort_by(f64::total_cmp);
    let basis = layout
        .basis(range_c, &sorted_c, rate, data.logs.len())
        .expect("the layout was tried on the same blocks");

    let rows = Rows::new(&points, &blocks, &basis);
    let mut factor = rows.factor(&blocks);
    let unsolved = || FitError::Joint {
        segments: basis.segments(),
    };
    let whole = factor.solve(basis.columns()).ok_or_else(unsolved)?;
    let fixed = factor
        .solve(basis.columns_without_rate())
        .ok_or_else(unsolved)?;
    let maps = basis.polynomial_maps();
    let mut polynomials = Vec::new();
    let mut sigmas = Vec::new();
    let mut noises = Vec::new();
    let covariances = [
        (false, basis.columns_without_rate()),
        (true, basis.columns()),
    ]
    .map(|(with, columns)| {
        let needed = with_rate.contains(&with);
        needed.then(|| Covariance::new(&rows, &blocks, columns))?
    });
    for (axis, &with_rate) in with_rate.iter().enumerate() {
        let solution = if with_rate { &whole } else { &fixed };
        let mut coefficients = solution.coefficients[axis].clone();
        let covariance = covariances[usize::from(with_rate)]
            .as_ref()
            .ok_or_else(unsolved)?;
        let noise = covariance.noise(axis, &coefficients);
        let covariance = covariance.of(noise);
        let of_segment = maps.iter().map(|(_, rows)| {
            CoefficientSigmas::from_covariance(of_combinations(&covariance, rows))
        });
        sigmas.push(of_segment.collect());
        noises.push(Some(NoiseSet {
            white: noise.white.sqrt(),
            walk: (3600.0 * noise.walk).sqrt(),
        }));
        coefficients.resize(basis.columns(), 0.0);
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
    let terms = if rate == RateForm::None {
        3
    } else {
        TERMS.len()
    };
    let timed = samples().map(|(log, (sample, kept))| Timed {
        point: sample.point,
        rows: kept as u64,
        time_s: kept * data.logs[log].interval_s,
    });
    let segments = coverage(timed, &pieces, calibrated_c)?
        .into_iter()
        .map(|segment| SegmentSet {
            terms: TERMS[..terms].iter().map(|&t| t.to_owned()).collect(),
            condition: whole.condition,
            ..segment
        })
        .collect();
    Ok(ChannelFit {
        thermal,
        calibrated_c,
        rates: range(|point| point.rate_c_per_min),
        segmentation: Segmentation::new(pieces)?,
        overlap: Overlap::Spline,
        segments,
        polynomials,
        sigmas,
        noises,
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
