//! Turns the segments of a model into the cells the core evaluates.

use tempco::{Terms, ThermalSettings};
use tempco_image::max_cells;

use crate::model::{AxisModel, horner};
use crate::segment::{Piece, Segmentation};

/// The most cells a table is given, if an image has room for them: 256 cells of three axes take
/// 21 KiB of flash.
const MOST_CELLS: usize = 256;

/// Accepted deviation of the cells from the model, as a share of the range of the axis's bias
/// over the calibrated temperatures, rates and second lags.
pub(crate) const TOLERANCE: f64 = 1e-3;

/// Cells and how well they stand for the model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cells {
    /// Coefficients by cell and axis.
    pub(crate) cells: Vec<Vec<Terms>>,
    /// Largest deviation of an axis from its model, as a share of that axis's bias range.
    pub(crate) deviation: f64,
    /// How far a boundary had to be moved to an edge of a cell \[degC\]; 0 where it lies on one.
    pub(crate) moved_c: f64,
}

/// Finds the fewest cells of equal width that have every boundary between pieces on an edge and
/// stay within the tolerance.
///
/// Quadratics are re-centred exactly; a blend, which is of higher degree, is interpolated at both
/// edges and the middle of each cell, so that it stays continuous. Where no number of cells fits,
/// the most cells are used, boundaries go to the nearest edge, and the result says by how much.
/// `axes_of_unit` is the number of axes of all channels.
pub(crate) fn tabulate(
    segmentation: &Segmentation,
    axes: &[AxisModel],
    limits: &Limits,
    axes_of_unit: usize,
) -> Cells {
    let range = segmentation.range_c();
    let pieces = segmentation.pieces(axes[0].overlap);
    let most = MOST_CELLS.min(max_cells(axes_of_unit));
    for count in 1..=most {
        let grid = Grid { range, count };
        if grid.worst_distance_c(&pieces) > 1e-6 {
            continue;
        }
        let found = grid.cells(&pieces, axes, limits);
        if found.deviation <= TOLERANCE {
            return found;
        }
    }
    in_cells(most, segmentation, axes, limits)
}

/// The model in a given number of cells, well or badly.
pub(crate) fn in_cells(
    count: usize,
    segmentation: &Segmentation,
    axes: &[AxisModel],
    limits: &Limits,
) -> Cells {
    let range = segmentation.range_c();
    let pieces = segmentation.pieces(axes[0].overlap);
    Grid { range, count }.cells(&pieces, axes, limits)
}

/// Lowest and highest calibrated rate \[degC/min\] and second lag \[degC\].
pub(crate) struct Limits {
    rates: (f64, f64),
    lags: (f64, f64),
}

impl Limits {
    pub(crate) fn of(thermal: &ThermalSettings) -> Self {
        let pair = |low: f32, high: f32| (low.into(), high.into());
        Self {
            rates: pair(thermal.rate_min_c_per_min, thermal.rate_max_c_per_min),
            lags: pair(thermal.lag2_min_c, thermal.lag2_max_c),
        }
    }
}

struct Grid {
    range: (f64, f64),
    count: usize,
}

impl Grid {
    fn edge_c(&self, cell: usize) -> f64 {
        let (low, high) = self.range;
        low + (high - low) * cell as f64 / self.count as f64
    }

    /// The largest distance of a boundary between pieces from the nearest edge.
    fn worst_distance_c(&self, pieces: &[Piece]) -> f64 {
        let (low, high) = self.range;
        let width_c = (high - low) / self.count as f64;
        pieces
            .iter()
            .map(|piece| {
                let cells = (piece.to_c - low) / width_c;
                (cells - cells.round()).abs() * width_c
            })
            .fold(0.0, f64::max)
    }

    fn cells(&self, pieces: &[Piece], axes: &[AxisModel], limits: &Limits) -> Cells {
        let mut cells = vec![Vec::with_capacity(axes.len()); self.count];
        let mut deviation = 0.0_f64;
        for axis in axes {
            let mut spread = Spread::new(limits);
            let mut before: Option<(usize, Terms)> = None;
            for (number, cell) in cells.iter_mut().enumerate() {
                let (low, high) = (self.edge_c(number), self.edge_c(number + 1));
                let middle = 0.5 * (low + high);
                let position = pieces
                    .iter()
                    .position(|piece| middle < piece.to_c)
                    .unwrap_or(pieces.len() - 1);
                let at = |temp_c: f64| axis.at(&pieces[position], temp_c);
                // Within a piece, and across pieces that meet, a cell begins where the one before
                // it ends.
                let start = before
                    .filter(|(piece, _)| *piece == position || axis.overlap.meets())
                    .map(|(_, terms)| hot_edge(&terms));
                let terms = terms(at(low), at(middle), at(high), start);
                for step in 0..=8 {
                    let z = f64::from(step) / 8.0;
                    spread.compare(&terms, z, at(low + z * (high - low)));
                }
                before = Some((position, terms));
                cell.push(terms);
            }
            deviation = deviation.max(spread.deviation());
        }
        Cells {
            cells,
            deviation,
            moved_c: self.worst_distance_c(pieces),
        }
    }
}

/// Bias, bias per rate and bias per second lag at the hot edge of a cell, as the core computes them.
fn hot_edge(terms: &Terms) -> [f32; 3] {
    [&terms.a[..], &terms.r, &terms.s].map(|part| horner(part, 1.0))
}

/// The polynomial through three points (static bias, bias per rate, bias per second lag) at the
/// cold edge, the middle and the hot edge of a cell. With `start`, the bias at the cold edge is
/// exactly that: the rounding of the coefficients then leaves no jump, and, because each cell aims
/// at its own hot edge, it does not add up either.
fn terms(cold: [f64; 3], mid: [f64; 3], hot: [f64; 3], start: Option<[f32; 3]>) -> Terms {
    let [a0, r0, s0] = start.unwrap_or(cold.map(|value| value as f32));
    let a2 = (2.0 * (cold[0] + hot[0] - 2.0 * mid[0])) as f32;
    let a1 = (hot[0] - f64::from(a0) - f64::from(a2)) as f32;
    let r1 = (hot[1] - f64::from(r0)) as f32;
    let s1 = (hot[2] - f64::from(s0)) as f32;
    Terms {
        a: [a0, a1, a2],
        r: [r0, r1],
        s: [s0, s1],
    }
}

/// How far cells are from their model, and the range of the model.
struct Spread<'l> {
    limits: &'l Limits,
    worst: f64,
    least: f64,
    most: f64,
}

impl<'l> Spread<'l> {
    const fn new(limits: &'l Limits) -> Self {
        Self {
            limits,
            worst: 0.0,
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
        }
    }

    fn compare(&mut self, terms: &Terms, z: f64, [static_bias, rate_bias, lag_bias]: [f64; 3]) {
        let fixed = horner(&terms.a.map(f64::from), z);
        let by_rate = horner(&terms.r.map(f64::from), z);
        let by_lag = horner(&terms.s.map(f64::from), z);
        let Limits { rates, lags } = self.limits;
        for rate in [rates.0, 0.0, rates.1] {
            for lag in [lags.0, 0.0, lags.1] {
                let bias = static_bias + rate * rate_bias + lag * lag_bias;
                let error = fixed + rate * by_rate + lag * by_lag - bias;
                self.worst = self.worst.max(error.abs());
                self.least = self.least.min(bias);
                self.most = self.most.max(bias);
            }
        }
    }

    /// The largest deviation as a share of the range. A bias that hardly moves is not followed
    /// beyond the precision of f32.
    fn deviation(&self) -> f64 {
        let magnitude = self.most.abs().max(self.least.abs());
        let range = (self.most - self.least).max(1e-4 * magnitude);
        if range > 0.0 { self.worst / range } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Polynomial;
    use crate::segment::{Overlap, Segment};

    fn rates(most: f64) -> Limits {
        Limits {
            rates: (-most, most),
            lags: (0.0, 0.0),
        }
    }

    fn polynomials(segmentation: &Segmentation) -> Vec<Polynomial> {
        // X of the paper's table 2, with a made-up rate part.
        let raw = [
            [0.0173, -0.0014, 1.7535e-5],
            [0.0064, 0.0004, -4.2567e-5],
            [-0.0551, 0.0026, -3.302e-5],
            [0.3390, -0.0118, 9.6146e-5],
        ];
        let fit = segmentation.segments().iter().zip(raw.iter().cycle());
        fit.map(|(segment, raw)| Polynomial {
            r: [0.07, 0.01],
            ..Polynomial::from_raw_static(segment, *raw)
        })
        .collect()
    }

    #[test]
    fn the_papers_segments_fall_on_cells_of_five_degrees() {
        let segmentation: Segmentation = "-15:15,5:35,25:60,50:80".parse().unwrap();
        let polynomials = polynomials(&segmentation);
        for overlap in [
            Overlap::None,
            Overlap::Hard,
            Overlap::Mean,
            Overlap::Linear,
            Overlap::Smooth,
        ] {
            let axis = AxisModel {
                polynomials: &polynomials,
                overlap,
            };
            let table = tabulate(&segmentation, &[axis], &rates(2.0), 3);
            assert_eq!(table.cells.len() % 19, 0, "{overlap:?}");
            assert!(table.deviation <= TOLERANCE, "{overlap:?}");
            assert!(table.moved_c < 1e-9);
            if !matches!(overlap, Overlap::Linear | Overlap::Smooth) {
                assert_eq!(table.cells.len(), 19, "{overlap:?}");
                assert!(table.deviation < 1e-6);
            } else {
                // Blends leave no jump at all, as the core computes it.
                for pair in table.cells.windows(2) {
                    let jump = pair[1][0].bias(0.0, 2.0, 0.0) - pair[0][0].bias(1.0, 2.0, 0.0);
                    assert_eq!(jump, 0.0, "{overlap:?}");
                }
            }
        }
    }

    #[test]
    fn a_constant_needs_one_cell() {
        let segmentation: Segmentation = "10:40".parse().unwrap();
        let constant = Polynomial::new(&segmentation.segments()[0], &[1.0 / 3.0, 1e-17]);
        let axis = AxisModel {
            polynomials: &[constant],
            overlap: Overlap::Linear,
        };
        let table = tabulate(&segmentation, &[axis], &rates(1.0), 3);
        assert_eq!(table.cells.len(), 1);
    }

    #[test]
    fn boundaries_on_no_grid_go_to_the_nearest_edge_and_it_is_said() {
        let segmentation = Segmentation::new(vec![
            Segment {
                t_min_c: 0.0,
                t_max_c: std::f64::consts::PI * 10.0,
            },
            Segment {
                t_min_c: std::f64::consts::E * 10.0,
                t_max_c: 50.0,
            },
        ])
        .unwrap();
        let polynomials = polynomials(&segmentation);
        let axis = AxisModel {
            polynomials: &polynomials,
            overlap: Overlap::Linear,
        };
        let table = tabulate(&segmentation, &[axis], &rates(1.0), 3);
        assert_eq!(table.cells.len(), MOST_CELLS);
        assert!(table.moved_c > 0.0 && table.moved_c <= 0.5 * 50.0 / MOST_CELLS as f64);
    }
}
