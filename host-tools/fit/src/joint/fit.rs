//! The spline model of a channel, fitted on the core's own regressors.

use tempco::ThermalSettings;

use crate::fit::{ChannelFit, FitError};
use crate::joint::basis::RateForm;
use crate::joint::blocks::Blocks;
use crate::joint::covariance::{Covariance, of_combinations};
use crate::joint::lag::Lag;
use crate::joint::layout::Layout;
use crate::joint::solve::Rows;
use crate::regress::{ChannelData, with_every_rate};
use crate::segment::{Overlap, Segment, Segmentation};
use crate::set::{CoefficientSigmas, NoiseSet, SegmentSet};
use crate::solve::{LEAST_SPAN, SegmentRows, TERMS};

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
    let data = data.with(&open);
    let blocks = Blocks::new(&data);
    let calibrated_c = data.range(|point| point.effective_c);
    let range_c = (f64::from(calibrated_c.0), f64::from(calibrated_c.1));
    let mut sorted_c = blocks.temp_c.clone();
    sorted_c.sort_by(f64::total_cmp);
    let basis = layout
        .basis(range_c, &sorted_c, rate, data.logs.len())
        .expect("the layout was tried on the same blocks");

    let rows = Rows::new(&data, &blocks, &basis);
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
    let segments = coverage(&data, &pieces)?
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
        rates: data.range(|point| point.rate_c_per_min),
        segmentation: Segmentation::new(pieces)?,
        overlap: Overlap::Spline,
        segments,
        polynomials,
        sigmas,
        noises,
    })
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
