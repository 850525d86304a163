//! The algebra of whitening and evidence against dense matrices, and the rules on what is kept.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use crate::least_squares::{Block, Blocks, SparseRow};
use crate::spline::drift::{self, DriftLimits, FOREVER_S};
use crate::spline::evidence::{Posterior, Ridge, in_use, posterior, tune};
use crate::spline::lags::Lags;
use crate::spline::regressors::Points;
use crate::spline::start::Start;
use crate::spline::whitening::{NoiseShares, WhiteProducts, Whitening};
use crate::testing::white;

/// Columns of the rows that are drawn here.
const COLUMNS: usize = 6;

const NOISE: NoiseShares = NoiseShares {
    walk_per_s: 2e-3,
    drift_s: 400.0,
    angle: 0.7,
};

/// 63 blocks of two logs, of uneven weight, at uneven times, with gaps in both.
fn uneven() -> Blocks {
    let mut blocks = Vec::new();
    for (i, noise) in (0..66).zip(white(1)) {
        // The second log begins at its own first position, and three blocks are left out.
        let (log, position) = if i < 40 { (0, i) } else { (1, i - 40) };
        if [7, 23, 50].contains(&i) {
            continue;
        }
        blocks.push(Block {
            log,
            position,
            time_s: 10.0 * position as f64 + noise,
            weight: if i % 5 == 2 { 3.0 } else { 10.0 },
        });
    }
    let raw = white(2).take(blocks.len()).collect();
    let temp_c = vec![20.0; blocks.len()];
    Blocks::of_values(blocks, temp_c, vec![raw])
}

/// Sparse rows of random numbers, every fifth with a column named twice.
fn rows(count: usize) -> Vec<SparseRow> {
    let mut random = white(3);
    let row = |i: usize| {
        let mut row: SparseRow = (0..COLUMNS)
            .filter(|column| !(i + column).is_multiple_of(3))
            .map(|column| (column, random.next().unwrap()))
            .collect();
        if i.is_multiple_of(5) {
            row.push((1, 0.4));
        }
        row
    };
    (0..count).map(row).collect()
}

fn dense(rows: &[SparseRow]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(rows.len(), COLUMNS);
    for (i, row) in rows.iter().enumerate() {
        for &(column, value) in row {
            matrix[(i, column)] += value;
        }
    }
    matrix
}

/// What is documented of the noise: white, in inverse proportion to the weight; of the angle, two
/// per block, of which neighbours share one; a stationary drift in every log.
fn covariance(blocks: &Blocks, noise: NoiseShares) -> DMatrix<f64> {
    let all = &blocks.blocks;
    let stationary = 0.5 * noise.walk_per_s * noise.drift_s;
    DMatrix::from_fn(all.len(), all.len(), |i, j| {
        let (a, b) = (&all[i.min(j)], &all[i.max(j)]);
        if a.log != b.log {
            return 0.0;
        }
        let drift = stationary * (-(b.time_s - a.time_s) / noise.drift_s).exp();
        let own = match b.position - a.position {
            0 => blocks.usual_weight() / a.weight + 2.0 * noise.angle,
            1 => -noise.angle,
            _ => 0.0,
        };
        drift + own
    })
}

fn log_determinant(matrix: DMatrix<f64>) -> f64 {
    let factor = matrix.cholesky().unwrap();
    let diagonal = factor.l().diagonal();
    2.0 * diagonal.iter().map(|of| of.ln()).sum::<f64>()
}

fn products(blocks: &Blocks, noise: NoiseShares) -> WhiteProducts {
    let whitening = Whitening::new(blocks, noise, |_| true);
    whitening.products(&rows(blocks.blocks.len()), COLUMNS, &blocks.raw[0])
}

fn assert_close(found: f64, expected: f64) {
    let allowed = 1e-8 * expected.abs().max(1.0);
    assert!((found - expected).abs() < allowed, "{found} {expected}");
}

/// The filter makes the products that the inverse of the covariance makes.
#[test]
fn whitened_products_are_those_of_the_dense_covariance() {
    let blocks = uneven();
    let slow = NoiseShares {
        drift_s: FOREVER_S,
        walk_per_s: 1e-6,
        angle: 20.0,
    };
    for noise in [NOISE, slow] {
        let found = products(&blocks, noise);
        let (x, y) = (dense(&rows(blocks.blocks.len())), &blocks.raw[0]);
        let y = DVector::from_column_slice(y);
        let v = covariance(&blocks, noise);
        let inverse = v.clone().cholesky().unwrap().inverse();
        let (normal, target) = (x.transpose() * &inverse * &x, x.transpose() * &inverse * &y);
        for i in 0..COLUMNS {
            assert_close(found.target[i], target[i]);
            for j in 0..COLUMNS {
                assert_close(found.normal[(i, j)], normal[(i, j)]);
            }
        }
        assert_close(found.square, y.dot(&(&inverse * &y)));
        assert_close(found.log_determinant, log_determinant(v));
        assert_eq!(found.rows, 63);
    }
}

/// Blocks that are not used count as little as blocks that are not there.
#[test]
fn blocks_that_are_left_out_are_as_if_they_were_not_there() {
    let blocks = uneven();
    let is_used = |i: usize| !(10..20).contains(&i) && !i.is_multiple_of(7);
    let kept: Vec<usize> = (0..blocks.blocks.len()).filter(|&i| is_used(i)).collect();
    let all = rows(blocks.blocks.len());
    let whitening = Whitening::new(&blocks, NOISE, is_used);
    let found = whitening.products(&all, COLUMNS, &blocks.raw[0]);
    let v = covariance(&blocks, NOISE);
    let v = DMatrix::from_fn(kept.len(), kept.len(), |i, j| v[(kept[i], kept[j])]);
    let rows: Vec<SparseRow> = kept.iter().map(|&i| all[i].clone()).collect();
    let y = DVector::from_fn(kept.len(), |i, _| blocks.raw[0][kept[i]]);
    let solved = v.clone().cholesky().unwrap().solve(&y);
    let target = dense(&rows).transpose() * &solved;
    for i in 0..COLUMNS {
        assert_close(found.target[i], target[i]);
    }
    assert_close(found.square, y.dot(&solved));
    assert_close(found.log_determinant, log_determinant(v));
    assert_eq!(found.rows, kept.len());
}

/// All that is left of white noise is its own; hardly anything of a wave that is much larger.
#[test]
fn the_share_of_noise_is_what_was_added() {
    let count = 4000;
    let block = |position: usize| Block {
        log: 0,
        position,
        time_s: 10.0 * position as f64,
        weight: [5.0, 20.0][position % 2],
    };
    let values = vec![0.0; count];
    let blocks = (0..count).map(block).collect();
    let blocks = Blocks::of_values(blocks, values.clone(), vec![values]);
    let calm = NoiseShares {
        walk_per_s: 1e-12,
        drift_s: FOREVER_S,
        angle: 1e-9,
    };
    let whitening = Whitening::new(&blocks, calm, |_| true);
    let noise: Vec<f64> = white(4).take(count).map(|of| 0.2 * of).collect();
    let share = whitening.share_of_noise(&noise, 0.04);
    assert!((share - 1.0).abs() < 0.06, "{share}");
    // A wave of the variance 0.36 on top: a tenth is noise.
    let wave = |i: usize| (0.72_f64).sqrt() * (0.01 * i as f64).sin();
    let mixed: Vec<f64> = noise
        .iter()
        .enumerate()
        .map(|(i, of)| of + wave(i))
        .collect();
    let share = whitening.share_of_noise(&mixed, 0.04);
    assert!((share - 0.1).abs() < 0.01, "{share}");
    // A drift that follows the wave leaves the noise.
    let lively = NoiseShares {
        walk_per_s: 3e-4,
        ..calm
    };
    let whitening = Whitening::new(&blocks, lively, |_| true);
    let followed = whitening.share_of_noise(&mixed, 0.04);
    assert!(followed > 0.7 && followed < 1.0, "{followed}");
}

/// A ridge on the differences of three columns, one on the size of two; the last column is free,
/// and so is the mean of the first three.
fn ridges() -> [Ridge; 2] {
    let bend = DMatrix::from_row_slice(2, 3, &[1.0, -1.0, 0.0, 0.0, 1.0, -1.0]);
    [
        Ridge {
            first: 0,
            matrix: bend.transpose() * bend,
            rank: 2,
        },
        Ridge {
            first: 3,
            matrix: DMatrix::identity(2, 2),
            rank: 2,
        },
    ]
}
const FREE: usize = 2;

/// -2 ln L with the coefficients under ridges as part of the noise, the free ones integrated out
/// under a flat prior, and the variance the most likely one.
fn dense_deviance(blocks: &Blocks, noise: NoiseShares, precisions: [f64; 2]) -> f64 {
    let (x, y) = (dense(&rows(blocks.blocks.len())), &blocks.raw[0]);
    let y = DVector::from_column_slice(y);
    let mut v = covariance(blocks, noise);
    for (ridge, precision) in ridges().iter().zip(precisions) {
        let own = x.columns(ridge.first, ridge.matrix.nrows());
        let eigen = ridge.matrix.clone().symmetric_eigen();
        for (value, vector) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            if *value > 1e-9 {
                let seen = own * vector;
                v += &seen * seen.transpose() / (precision * value);
            }
        }
    }
    let mean = x.column(0) + x.column(1) + x.column(2);
    let free = DMatrix::from_columns(&[mean, x.column(5).into_owned()]);
    let factor = v.clone().cholesky().unwrap();
    let of_free = free.transpose() * factor.solve(&free);
    let found = of_free.clone().cholesky().unwrap();
    let found = found.solve(&(free.transpose() * factor.solve(&y)));
    let left = &y - &free * found;
    let square = left.dot(&factor.solve(&left));
    let count = (y.len() - FREE) as f64;
    count * square.ln() + log_determinant(v) + log_determinant(of_free)
}

/// Deviances differ as the dense marginal likelihoods do, whether ridges change or noise.
#[test]
fn the_evidence_is_the_marginal_likelihood() {
    let blocks = uneven();
    let calm = NoiseShares {
        walk_per_s: 1e-4,
        angle: 0.1,
        ..NOISE
    };
    let settings = [
        (NOISE, [1.0, 1.0]),
        (NOISE, [300.0, 1.0]),
        (NOISE, [1.0, 0.02]),
        (calm, [5.0, 40.0]),
    ];
    let pairs = settings.map(|(noise, precisions)| {
        let found = posterior(&products(&blocks, noise), &ridges(), &precisions, FREE).unwrap();
        (found.deviance, dense_deviance(&blocks, noise, precisions))
    });
    for (found, expected) in &pairs[1..] {
        let (found, expected) = (found - pairs[0].0, expected - pairs[0].1);
        assert!(expected.abs() > 0.1, "{expected}");
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

/// Whitened rows of independent columns: `y` holds the first three, alike, and the fourth.
fn measured(noise: f64) -> WhiteProducts {
    let count = 400;
    let mut random = white(5);
    let x = DMatrix::from_fn(count, COLUMNS, |_, _| random.next().unwrap());
    let of_column = [1.0, 1.2, 0.9, 0.8, -0.3, 0.5];
    let y = DVector::from_fn(count, |i, _| {
        let seen: f64 = of_column
            .iter()
            .enumerate()
            .map(|(j, b)| b * x[(i, j)])
            .sum();
        seen + noise * random.next().unwrap()
    });
    of_dense(&x, &y)
}

fn of_dense(x: &DMatrix<f64>, y: &DVector<f64>) -> WhiteProducts {
    WhiteProducts {
        normal: x.transpose() * x,
        target: x.transpose() * y,
        square: y.norm_squared(),
        log_determinant: 0.0,
        rows: y.len(),
    }
}

/// Whatever the precisions at the beginning, they end where each one, made larger or smaller, makes
/// the rows less likely.
#[test]
fn tuning_ends_where_the_likelihood_is_highest() {
    let (products, ridges) = (measured(1.0), ridges());
    let mut ends = Vec::new();
    for start in [[1.0, 1.0], [1e-4, 1e4], [1e5, 1e-5]] {
        let mut precisions = start;
        let found = tune(&products, &ridges, &mut precisions, FREE, 200).unwrap();
        for number in 0..precisions.len() {
            for factor in [0.7, 1.4] {
                let mut other = precisions;
                other[number] *= factor;
                let moved = posterior(&products, &ridges, &other, FREE).unwrap();
                assert!(
                    moved.deviance > found.deviance + 1e-3,
                    "{start:?} {number} {factor}"
                );
            }
        }
        assert_eq!(in_use(&ridges, &precisions, &found), [true, true]);
        ends.push(precisions);
    }
    for end in &ends[1..] {
        let pairs = end.iter().zip(ends[0]);
        assert!(
            pairs.map(|(a, b)| (a / b - 1.0).abs()).all(|of| of < 0.05),
            "{ends:?}"
        );
    }
}

/// Columns in which nothing is measured are dropped, the others keep what they have.
#[test]
fn a_group_that_explains_nothing_is_dropped() {
    let count = 300;
    let mut random = white(6);
    let x = DMatrix::from_fn(count, COLUMNS, |_, _| random.next().unwrap());
    let mut y = x.column(0) - x.column(2) + DVector::from_fn(count, |_, _| random.next().unwrap());
    // Nothing of the second group is left in the observations.
    let own = x.columns(3, 2).into_owned();
    let found = (own.transpose() * &own).cholesky().unwrap();
    y -= &own * found.solve(&(own.transpose() * &y));
    let (products, ridges) = (of_dense(&x, &y), ridges());
    let mut precisions = [1.0, 1.0];
    let found = tune(&products, &ridges, &mut precisions, FREE, 60).unwrap();
    assert_eq!(in_use(&ridges, &precisions, &found), [true, false]);
    let Posterior {
        coefficients,
        variance,
        ..
    } = found;
    assert!(coefficients.rows(3, 2).amax() < 1e-6, "{coefficients}");
    assert!((coefficients[0] - 1.0).abs() < 0.2 && (coefficients[2] + 1.0).abs() < 0.2);
    assert!((variance - 1.0).abs() < 0.25, "{variance}");
}

/// Ramps of 30 minutes and soaks of some minutes in turn, and what an axis measures by time since
/// the last change \[s\].
fn soaks(soak_min: usize, mut measured: impl FnMut(f64) -> f64) -> Blocks {
    let (mut blocks, mut temp_c, mut raw) = (Vec::new(), Vec::new(), Vec::new());
    let mut at_c = 20.0;
    for (number, minutes) in [30, soak_min].into_iter().cycle().take(8).enumerate() {
        let rate = [1.0, 0.0, -1.0, 0.0][number % 4];
        for step in 0..6 * minutes {
            let position = blocks.len();
            at_c += rate / 6.0;
            blocks.push(Block {
                log: 0,
                position,
                time_s: 10.0 * position as f64,
                weight: 10.0,
            });
            temp_c.push(at_c);
            raw.push(measured(10.0 * step as f64));
        }
    }
    Blocks::of_values(blocks, temp_c, vec![raw])
}

fn limits(blocks: &Blocks) -> DriftLimits {
    drift::limits(blocks)[0]
}

/// Short soaks have no late part and allow no drift; long ones allow the drift that they show.
#[test]
fn late_soaks_limit_the_drift() {
    let walking = |soak_min: usize, step: f64| {
        let (mut random, mut walked) = (white(7), 0.0);
        limits(&soaks(soak_min, |_| {
            walked += step * random.next().unwrap();
            walked + random.next().unwrap()
        }))
    };
    let (none, quiet, walk) = (walking(8, 0.1), walking(60, 0.0), walking(60, 0.1));
    assert_eq!(none.most_walk_per_s, 1e-6);
    assert!(quiet.most_walk_per_s < 1e-4, "{quiet:?}");
    // Steps of 0.1 every ten seconds, over a white noise of 1.
    let ratio = walk.most_walk_per_s / (0.1_f64.powi(2) / 10.0);
    assert!((1.0..6.0).contains(&ratio), "{walk:?}");
    assert_eq!([none, quiet, walk].map(|of| of.inflation), [1.0; 3]);
}

/// A drift that forgets within two minutes is white over the times of a chamber: nine times the
/// white noise over 240 s on both sides, in blocks of ten.
#[test]
fn a_drift_that_forgets_makes_the_noise_larger() {
    let (mut random, mut state) = (white(8), 0.0);
    let kept = (-10.0_f64 / 120.0).exp();
    let found = limits(&soaks(60, |_| {
        state = kept * state + 3.0 * (1.0 - kept * kept).sqrt() * random.next().unwrap();
        state + random.next().unwrap()
    }));
    assert_eq!(found.most_walk_per_s, 1e-6);
    assert!((110.0..430.0).contains(&found.inflation), "{found:?}");
}

/// What settles in the first ten minutes of a soak is not looked at.
#[test]
fn the_beginning_of_a_soak_is_not_late() {
    let settling = |height: f64| {
        let mut random = white(9);
        limits(&soaks(60, |since_s| {
            let settled = if since_s < 400.0 { height } else { 0.0 };
            settled + random.next().unwrap()
        }))
    };
    assert_eq!(settling(0.0), settling(30.0));
}

/// The factors by which a log is made are found, whatever the time constant. Without plays or ramps
/// they are zero.
#[test]
fn factors_of_the_start_are_found_in_the_logs() {
    let blocks: Vec<Block> = (0..800)
        .map(|i| Block {
            log: i / 500,
            time_s: 10.0 * i as f64,
            weight: 10.0,
            position: i,
        })
        .collect();
    let temp_c: Vec<f64> = (0..800)
        .map(|i| 30.0 * (0.01 * f64::from(i)).sin())
        .collect();
    // Of the last two minutes, in a log that goes on.
    let change = |i: usize| match i % 500 {
        12.. => temp_c[i] - temp_c[i - 12],
        _ => f64::NAN,
    };
    for (tau_s, divisor) in [(20.0, 1.0), (100.0, 0.698_806), (1000.0, 0.4)] {
        let fresh = |i: usize| 0.5 * change(i) * -libm::expm1(-120.0 / tau_s) / divisor;
        let lags = Lags {
            tau_s,
            tau2_s: 3000.0,
            kappa: 0.0,
            kappa2: 0.0,
            play_kappa: 0.0,
            play_kappa2: 0.0,
        };
        let of = |factor: f64| -> Vec<f64> { (0..800).map(|i| factor * fresh(i)).collect() };
        let play_min = 1.3_f64.powi(7);
        let play = |width_c: &f64| -> Vec<f64> {
            let put = of(3.0 * play_min).into_iter();
            put.map(|put_c| put_c.clamp(-width_c, *width_c)).collect()
        };
        let points = |widths_c: &[f64]| Points {
            effective_c: Vec::new(),
            rates: Rc::new(of(3.0)),
            lags2_c: Rc::new(of(-6.0)),
            plays_c: widths_c.iter().map(play).collect(),
        };
        let found = Start::new(&blocks, &temp_c, &points(&[2.0, 12.0]), &lags);
        let expected = Start {
            rate: 3.0,
            lag2_min: -2.0,
            play_min,
        };
        for (found, expected) in [
            (found.rate, expected.rate),
            (found.lag2_min, expected.lag2_min),
            (found.play_min, expected.play_min),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        }
        let without_plays = Start::new(&blocks, &temp_c, &points(&[]), &lags);
        assert_eq!(without_plays.play_min, 0.0);
        let still = vec![25.0; 800];
        let none = Start::new(&blocks, &still, &points(&[2.0]), &lags);
        assert_eq!(none, Start::default());
    }
}
