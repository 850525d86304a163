//! The lags, mixes, ridges and noises that make the logs most likely.

use nalgebra::{DMatrix, DVector};
use tempco::TableError;
use tempco_log::parallel;

use crate::least_squares::{Basis, Blocks, SparseRow, dot};
use crate::spline::drift::{DriftLimits, START_NOISE};
use crate::spline::evidence::{Posterior, posterior, tune};
use crate::spline::lags::{Form, Lags, edges_c};
use crate::spline::regressors::{Paths, Points};
use crate::spline::ridges::{Ridges, of_basis};
use crate::spline::sensor_noise::SensorNoise;
use crate::spline::tuning::{AxisPriors, Trial, tuned_axis};
use crate::spline::whitening::Whitening;

/// Time constants from which the search starts \[s\].
const START_TAU_S: [f64; 4] = [40.0, 120.0, 360.0, 1000.0];
const START_TAU2_S: [f64; 4] = [150.0, 700.0, 2200.0, 7000.0];

/// Starts that are followed.
const FOLLOWED: usize = 2;

/// Rounds of moving lags, then ridges and noises.
const ROUNDS: usize = 3;

/// Steps of the lags in a round, and attempts at each.
const STEPS: usize = 8;
const ATTEMPTS: usize = 6;

/// A step that gains less than this in -2 ln L is the last one.
const LEAST_GAIN: f64 = 0.3;

/// Differences by which slopes are found: of the logarithm of a time constant, and of a share.
const DIFFERENCES: [f64; Lags::COUNT] = [0.03, 0.03, 0.02, 0.02, 0.02, 0.02];

/// Rounds of the ridges of a start.
const FIRST_TUNING: usize = 12;

/// What is searched over.
pub(crate) struct Problem<'a> {
    pub(crate) paths: &'a Paths<'a>,
    pub(crate) form: Form,
    pub(crate) sensor: &'a SensorNoise,
    /// For each axis.
    pub(crate) limits: &'a [DriftLimits],
    /// The longest time constant \[s\].
    pub(crate) most_tau2_s: f64,
    /// Lowest and highest of each number; where both are the same it is not searched.
    pub(crate) bounds: [(f64, f64); Lags::COUNT],
}

impl Problem<'_> {
    /// The best model. `None` where no coefficients can be found.
    ///
    /// # Errors
    /// Settings that the core refuses.
    pub(crate) fn search(&self) -> Result<Option<Trial>, TableError> {
        let mut starts = Vec::new();
        for lags in self.starts() {
            starts.extend(self.start(&lags)?);
        }
        starts.sort_by(|a, b| a.deviance.total_cmp(&b.deviance));
        starts.truncate(FOLLOWED);
        let mut best: Option<Trial> = None;
        for start in starts {
            let mut found = start;
            for _ in 0..ROUNDS {
                let before = found.deviance;
                found = self.tuned(found);
                found = self.moved(found)?;
                if before - found.deviance < LEAST_GAIN {
                    break;
                }
            }
            let found = self.tuned(found);
            if best.as_ref().is_none_or(|of| found.deviance < of.deviance) {
                best = Some(found);
            }
        }
        Ok(best)
    }

    fn starts(&self) -> Vec<Lags> {
        let clamp = |of: [f64; Lags::COUNT]| {
            let pairs: [f64; Lags::COUNT] =
                std::array::from_fn(|i| of[i].clamp(self.bounds[i].0, self.bounds[i].1));
            pairs
        };
        let mut found: Vec<[f64; Lags::COUNT]> = Vec::new();
        for tau_s in START_TAU_S {
            for tau2_s in START_TAU2_S {
                let apart = Lags {
                    tau_s,
                    tau2_s,
                    kappa: 0.0,
                    kappa2: 0.0,
                    play_kappa: 0.0,
                    play_kappa2: 0.0,
                };
                let start = clamp(apart.to_array());
                if !found.contains(&start) {
                    found.push(start);
                }
            }
        }
        found.into_iter().map(|of| self.lags(of)).collect()
    }

    /// The lags of some numbers, none longer than the logs allow.
    fn lags(&self, of: [f64; Lags::COUNT]) -> Lags {
        let lags = Lags::from_array(of);
        Lags {
            tau2_s: lags.tau2_s.min(self.most_tau2_s),
            ..lags
        }
    }

    fn basis(&self, points: &Points) -> Basis {
        let range_c = Blocks::range(&points.effective_c);
        let edges_c = edges_c(range_c, self.form.cells);
        self.form.basis(edges_c, self.paths.blocks.logs())
    }

    /// A trial with ridges and noise of its own, roughly.
    fn start(&self, lags: &Lags) -> Result<Option<Trial>, TableError> {
        let blocks = self.paths.blocks;
        let whitening = Whitening::new(blocks, START_NOISE, |_| true);
        self.trial(lags, |axis, (basis, rows), ridges| {
            let products = whitening.products(rows, basis.columns(), &blocks.raw[axis]);
            let mut priors = AxisPriors {
                noise: START_NOISE,
                limits: self.limits[axis],
                is_tuned: false,
                precisions: ridges.groups.iter().map(|of| of.even(&products)).collect(),
            };
            let (groups, precisions) = (&ridges.groups, &mut priors.precisions);
            let posterior = tune(&products, groups, precisions, ridges.free, FIRST_TUNING)?;
            Some((priors, posterior))
        })
    }

    /// The likelihood at other lags, with the noise and ridges of a trial.
    fn evaluate(&self, lags: &Lags, like: &Trial) -> Result<Option<Trial>, TableError> {
        let blocks = self.paths.blocks;
        self.trial(lags, |axis, (basis, rows), ridges| {
            let priors = &like.priors[axis];
            let whitening = Whitening::new(blocks, priors.noise, |_| true);
            let products = whitening.products(rows, basis.columns(), &blocks.raw[axis]);
            let posterior = posterior(&products, &ridges.groups, &priors.precisions, ridges.free)?;
            Some((priors.clone(), posterior))
        })
    }

    /// A trial at some lags; `solve` finds priors and coefficients of an axis.
    fn trial(
        &self,
        lags: &Lags,
        solve: impl Fn(usize, (&Basis, &[SparseRow]), &Ridges) -> Option<(AxisPriors, Posterior)> + Sync,
    ) -> Result<Option<Trial>, TableError> {
        let blocks = self.paths.blocks;
        let points = self.paths.points(&self.form, lags)?;
        let basis = self.basis(&points);
        let ridges = of_basis(&basis);
        let rows = points.rows(blocks, &basis);
        let axes: Vec<usize> = (0..blocks.axes()).collect();
        let found = parallel::map(&axes, |&axis| solve(axis, (&basis, &rows), &ridges));
        let Some(found) = found.into_iter().collect::<Option<Vec<_>>>() else {
            return Ok(None);
        };
        let (priors, posteriors): (Vec<_>, Vec<Posterior>) = found.into_iter().unzip();
        Ok(Some(Trial {
            lags: *lags,
            basis,
            ridges,
            rows,
            priors,
            deviance: posteriors.iter().map(|of| of.deviance).sum(),
            posteriors,
        }))
    }

    /// The same lags with the most likely noise and ridges.
    fn tuned(&self, mut trial: Trial) -> Trial {
        let axes: Vec<usize> = (0..trial.priors.len()).collect();
        let found = parallel::map(&axes, |&axis| {
            tuned_axis(self.paths.blocks, self.sensor, &trial, axis)
        });
        for (axis, found) in found.into_iter().enumerate() {
            if let Some((priors, posterior)) = found {
                trial.priors[axis] = priors;
                trial.posteriors[axis] = posterior;
            }
        }
        trial.deviance = trial.posteriors.iter().map(|of| of.deviance).sum();
        trial
    }

    /// The same ridges and noise with the most likely lags: Gauss-Newton steps on the whitened
    /// rows, the coefficients eliminated (Golub & Pereyra 1973; Kaufman 1975), damped where they
    /// do not help.
    fn moved(&self, start: Trial) -> Result<Trial, TableError> {
        let mut best = start;
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let (curvature, slope) = self.slopes(&best)?;
            let now = best.lags.to_array();
            // A number at a bound that would leave it stays there.
            let free: Vec<usize> = (0..Lags::COUNT)
                .filter(|&i| {
                    let (low, high) = self.bounds[i];
                    let outward =
                        slope[i] < 0.0 && now[i] <= low || slope[i] > 0.0 && now[i] >= high;
                    low < high && !outward && curvature[(i, i)] > 0.0
                })
                .collect();
            let mut gain = 0.0;
            for _ in 0..ATTEMPTS {
                let Some(next) = self.step(now, &free, &curvature, &slope, damping) else {
                    break;
                };
                let tried = self.evaluate(&self.lags(next), &best)?;
                if let Some(tried) = tried.filter(|of| of.deviance < best.deviance) {
                    gain = best.deviance - tried.deviance;
                    best = tried;
                    damping *= 0.2;
                    break;
                }
                damping *= 10.0;
            }
            if gain < LEAST_GAIN {
                break;
            }
        }
        Ok(best)
    }

    /// A damped step within the bounds.
    fn step(
        &self,
        now: [f64; Lags::COUNT],
        free: &[usize],
        curvature: &DMatrix<f64>,
        slope: &DVector<f64>,
        damping: f64,
    ) -> Option<[f64; Lags::COUNT]> {
        let count = free.len();
        let damped = DMatrix::from_fn(count, count, |i, j| {
            let value = curvature[(free[i], free[j])];
            if i == j {
                value * (1.0 + damping)
            } else {
                value
            }
        });
        let target = DVector::from_fn(count, |i, _| slope[free[i]]);
        let step = damped.cholesky()?.solve(&target);
        let mut next = now;
        for (&i, step) in free.iter().zip(step.iter()) {
            next[i] = (next[i] + step).clamp(self.bounds[i].0, self.bounds[i].1);
        }
        (next != now).then_some(next)
    }

    /// Curvature and slope of the log likelihood in the lags.
    fn slopes(&self, trial: &Trial) -> Result<(DMatrix<f64>, DVector<f64>), TableError> {
        let zero = (
            DMatrix::zeros(Lags::COUNT, Lags::COUNT),
            DVector::zeros(Lags::COUNT),
        );
        let parts = self.lag_parts(trial)?.into_iter();
        Ok(parts.fold(zero, |(curvature, slope), part| {
            (curvature + part.curvature, slope + part.slope)
        }))
    }

    /// For each axis, the covariance that its coefficients have because the lags are not known
    /// better.
    pub(crate) fn spread(&self, trial: &Trial) -> Result<Vec<DMatrix<f64>>, TableError> {
        let parts = self.lag_parts(trial)?;
        let mut curvature = DMatrix::zeros(Lags::COUNT, Lags::COUNT);
        for part in &parts {
            curvature += &part.curvature;
        }
        // Anywhere within their bounds, if the rows do not say where.
        for (i, &(low, high)) in self.bounds.iter().enumerate() {
            curvature[(i, i)] += 12.0 / (high - low).powi(2).max(1e-12);
        }
        let n = trial.basis.columns();
        let Some(factor) = curvature.cholesky() else {
            return Ok(vec![DMatrix::zeros(n, n); parts.len()]);
        };
        let of_axis = |part: LagPart| {
            // A column at a time: the same sums on every processor.
            let solved: Vec<DVector<f64>> = part
                .lever
                .row_iter()
                .map(|row| factor.solve(&row.transpose()))
                .collect();
            DMatrix::from_fn(n, n, |i, j| part.lever.row(i).transpose().dot(&solved[j]))
        };
        Ok(parts.into_iter().map(of_axis).collect())
    }

    /// What the lags do to each axis.
    fn lag_parts(&self, trial: &Trial) -> Result<Vec<LagPart>, TableError> {
        let blocks = self.paths.blocks;
        let now = trial.lags.to_array();
        // Rows at lags a little off, on the same basis.
        let mut beside: Vec<Option<(f64, Vec<SparseRow>)>> = Vec::new();
        for (i, &(low, high)) in self.bounds.iter().enumerate() {
            if low >= high {
                beside.push(None);
                continue;
            }
            let difference = if now[i] + DIFFERENCES[i] <= high {
                DIFFERENCES[i]
            } else {
                -DIFFERENCES[i]
            };
            let mut moved = now;
            moved[i] += difference;
            let points = self.paths.points(&self.form, &self.lags(moved))?;
            beside.push(Some((difference, points.rows(blocks, &trial.basis))));
        }
        let n = trial.basis.columns();
        let axes: Vec<usize> = (0..blocks.axes()).collect();
        Ok(parallel::map(&axes, |&axis| {
            // What the prediction does per change of each number, in columns of its own.
            let posterior = &trial.posteriors[axis];
            let coefficients = posterior.coefficients.as_slice();
            let mut rows = trial.rows.clone();
            for (block, row) in rows.iter_mut().enumerate() {
                let here = dot(&trial.rows[block], coefficients);
                for (i, moved) in beside.iter().enumerate() {
                    if let Some((difference, rows)) = moved {
                        let there = dot(&rows[block], coefficients);
                        row.push((n + i, (there - here) / difference));
                    }
                }
            }
            let whitening = Whitening::new(blocks, trial.priors[axis].noise, |_| true);
            let all = whitening.products(&rows, n + Lags::COUNT, &blocks.raw[axis]);
            // The part that coefficients can take up is no slope.
            let cross = all.normal.view((0, n), (n, Lags::COUNT)).into_owned();
            let own = all.normal.view((n, n), (Lags::COUNT, Lags::COUNT));
            // A column at a time: the same sums on every processor.
            let columns = cross.column_iter();
            let lever: Vec<DVector<f64>> =
                columns.map(|column| &posterior.inverse * column).collect();
            let taken = DMatrix::from_fn(Lags::COUNT, Lags::COUNT, |i, j| {
                cross.column(i).dot(&lever[j])
            });
            let target = all.target.rows(n, Lags::COUNT);
            let slope = target - cross.tr_mul(&posterior.coefficients);
            LagPart {
                curvature: (own - taken) / posterior.variance,
                slope: slope / posterior.variance,
                lever: DMatrix::from_columns(&lever),
            }
        }))
    }
}

/// What the lags do to an axis.
struct LagPart {
    /// Of the log likelihood.
    curvature: DMatrix<f64>,
    slope: DVector<f64>,
    /// How far coefficients move, with the other sign, per change of each number.
    lever: DMatrix<f64>,
}
