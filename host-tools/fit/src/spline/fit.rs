//! The spline model of a channel, on its way into the set.

use nalgebra::DMatrix;
use tempco::{PLAYS, Terms, ThermalPoint, ThermalSettings};
use tempco_set::run::with_every_rate;
use tempco_set::{
    CoefficientSigmas, GainSet, NoiseSet, Overlap, Segment, SegmentSet, Segmentation, TERMS,
};

use crate::channel_fit::ChannelFit;
use crate::error::FitError;
use crate::least_squares::{Blocks, SamplePoints, SparseRow};
use crate::segments::solve::{LEAST_SPAN, Place, SegmentRows};
use crate::spline::deployed::{AxisSolution, Deployed, range};
use crate::spline::lags::{Form, edges_c, whole_hats};
use crate::spline::sensor_noise::SensorNoise;
use crate::spline::tuning::Trial;
use crate::summary::ChannelData;

/// Fits the model that a search found, with the core's own points at its lags; `spread` is the
/// covariance of each axis' coefficients that comes from the lags.
pub(crate) fn fit(
    (data, blocks, sensor): (&ChannelData, &Blocks, &SensorNoise),
    thermal: ThermalSettings,
    form: &Form,
    (found, spread): (Trial, &[DMatrix<f64>]),
) -> Result<(ChannelFit, Deployed), FitError> {
    // The core runs over the samples at the chosen lags, with no limit on the rate. The limits
    // follow from what it finds.
    let open = with_every_rate(thermal).map_err(FitError::Settings)?;
    let points = SamplePoints::new(data, &open);
    let calibrated_c = range(&points, blocks, |point| point.effective_c);
    let (edges_c, segments) = cells(data, blocks, &points, calibrated_c, form);
    let basis = form.basis(edges_c, data.logs.len());
    let deployed = Deployed::fit(&points, blocks, sensor, basis, (found, spread));
    let deployed = deployed.ok_or(FitError::Spline {
        segments: segments.len(),
    })?;

    // Spline coefficients become a polynomial per segment, and their covariances sigmas.
    let basis = &deployed.basis;
    let maps = basis.polynomial_maps();
    let (mut polynomials, mut sigmas) = (Vec::new(), Vec::new());
    let (mut noises, mut gains) = (Vec::new(), Vec::new());
    for (axis, solution) in deployed.axes.iter().enumerate() {
        let of_segment = maps.iter().map(|(_, rows)| sigmas_of(solution, rows));
        sigmas.push(of_segment.collect());
        noises.push(Some(NoiseSet {
            white: solution.white.sqrt(),
            walk: (3600.0 * solution.walk).sqrt(),
        }));
        let of_plays = basis.play_columns().map(|column| GainSet {
            gain: solution.coefficients[column],
            sigma: solution.covariance[(column, column)].max(0.0).sqrt(),
        });
        let mut of_plays: Vec<GainSet> = of_plays.collect();
        if form.plays > 0 {
            of_plays.resize(PLAYS, GainSet::default());
        }
        gains.push(of_plays);
        // The splines add up to 1: the constant goes to all of them.
        let mut coefficients = solution.coefficients.clone();
        let constant = deployed.constant(blocks, axis);
        for coefficient in &mut coefficients[..basis.static_columns()] {
            *coefficient += constant;
        }
        polynomials.push(basis.polynomials(&coefficients));
    }
    let pieces = segments.iter().map(|of| Segment {
        t_min_c: of.t_min_c,
        t_max_c: of.t_max_c,
    });
    let fit = ChannelFit {
        thermal,
        calibrated_c,
        rates: range(&points, blocks, |point| point.rate_c_per_min),
        lags: range(&points, blocks, |point| point.lag2_c),
        segmentation: Segmentation::new(pieces.collect())?,
        overlap: Overlap::Spline,
        segments,
        polynomials,
        sigmas,
        noises,
        gains,
    };
    Ok((fit, deployed))
}

/// Standard deviations of the coefficients of a segment, which are combinations of splines.
fn sigmas_of(solution: &AxisSolution, rows: &[SparseRow; Terms::COUNT]) -> CoefficientSigmas {
    let covariance = |i: usize, j: usize| -> f64 {
        let pairs = rows[i]
            .iter()
            .flat_map(|a| rows[j].iter().map(move |b| (a, b)));
        pairs
            .map(|((a, x), (b, y))| x * y * solution.covariance[(*a, *b)])
            .sum()
    };
    let lag = Terms::STATIC + Terms::RATE;
    CoefficientSigmas {
        s: std::array::from_fn(|term| covariance(lag + term, lag + term).max(0.0).sqrt()),
        ..CoefficientSigmas::from_covariance(std::array::from_fn(|i| {
            std::array::from_fn(|j| covariance(i, j))
        }))
    }
}

/// As many cells of equal width as the form has, or fewer where some would hold too little of the
/// logs; with their ends \[degC\].
fn cells(
    data: &ChannelData,
    blocks: &Blocks,
    points: &SamplePoints,
    (low_c, high_c): (f32, f32),
    form: &Form,
) -> (Vec<f64>, Vec<SegmentSet>) {
    let range_c = (f64::from(low_c), f64::from(high_c));
    let counts = (1..=form.cells)
        .rev()
        .filter(|&count| whole_hats(count) == count);
    for count in counts {
        let edges_c = edges_c(range_c, count);
        let found = coverage(data, blocks, points, &edges_c, form);
        if count == 1 || found.iter().all(is_covered) {
            return (edges_c, found);
        }
    }
    unreachable!("a form has a cell at least")
}

fn is_covered(segment: &SegmentSet) -> bool {
    segment.coverage.is_some_and(|of| of.width >= LEAST_SPAN)
}

/// What each cell was fitted from.
fn coverage(
    data: &ChannelData,
    blocks: &Blocks,
    points: &SamplePoints,
    edges_c: &[f64],
    form: &Form,
) -> Vec<SegmentSet> {
    let pieces: Vec<Segment> = edges_c
        .windows(2)
        .map(|pair| Segment {
            t_min_c: pair[0],
            t_max_c: pair[1],
        })
        .collect();
    let mut rows = vec![SegmentRows::new(0); pieces.len()];
    for block in &blocks.blocks {
        let interval_s = data.logs[block.log].interval_s;
        for kept in points.of_block(block) {
            let ThermalPoint {
                effective_c,
                rate_c_per_min,
                ..
            } = kept.point;
            let temp_c = f64::from(effective_c);
            let inner = &edges_c[1..edges_c.len() - 1];
            let at = inner.partition_point(|&edge_c| edge_c <= temp_c);
            let z = (temp_c - pieces[at].centre_c()) / pieces[at].half_width_c();
            let place = Place::at(z.clamp(-1.0, 1.0), rate_c_per_min.into());
            let stands_for = (kept.rows as u64, kept.rows * interval_s);
            rows[at].push_mean(&place, stands_for, std::iter::empty());
        }
    }
    // Without rate terms the set lists the static terms only.
    let terms = if form.rates {
        &TERMS[..]
    } else {
        &TERMS[..Terms::STATIC]
    };
    let segment = |(piece, mut rows): (&Segment, SegmentRows)| SegmentSet {
        t_min_c: piece.t_min_c,
        t_max_c: piece.t_max_c,
        terms: terms.iter().map(|&term| term.to_owned()).collect(),
        rows: rows.rows(),
        condition: 0.0,
        coverage: (rows.rows() > 0).then(|| rows.coverage()),
    };
    pieces.iter().zip(rows).map(segment).collect()
}
