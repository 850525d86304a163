//! Turns the segments of a model into the cells the core evaluates.

use tempco::{MAX_CELLS, Terms};

use crate::model::AxisModel;
use crate::segment::{Piece, Segmentation};

/// The most cells a table is given: 256 cells of three axes take 15 KiB of flash.
const MOST_CELLS: usize = 256;
const _: () = assert!(MOST_CELLS <= MAX_CELLS);

/// Accepted deviation of the cells from the model, as a share of the range of the axis's bias
/// over the calibrated temperatures and rates.
const TOLERANCE: f64 = 1e-3;

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
pub(crate) fn tabulate(
    segmentation: &Segmentation,
    axes: &[AxisModel],
    rates_c_per_min: (f64, f64),
) -> Cells {
    let range = segmentation.range_c();
    let pieces = segmentation.pieces(axes[0].overlap);
    for count in 1..=MOST_CELLS {
        let grid = Grid { range, count };
        if grid.worst_distance_c(&pieces) > 1e-6 {
            continue;
        }
        let found = grid.cells(&pieces, axes, rates_c_per_min);
        if found.deviation <= TOLERANCE {
            return found;
        }
    }
    let count = MOST_CELLS;
    Grid { range, count }.cells(&pieces, axes, rates_c_per_min)
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

    fn cells(&self, pieces: &[Piece], axes: &[AxisModel], rates: (f64, f64)) -> Cells {
        let mut cells = vec![Vec::with_capacity(axes.len()); self.count];
        let mut deviation = 0.0_f64;
        for axis in axes {
            let mut worst = 0.0_f64;
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for (number, cell) in cells.iter_mut().enumerate() {
                let (low, high) = (self.edge_c(number), self.edge_c(number + 1));
                let middle = 0.5 * (low + high);
                let piece = pieces
                    .iter()
                    .find(|piece| middle < piece.to_c)
                    .unwrap_or(&pieces[pieces.len() - 1]);
                let [cold, mid, hot] = [low, middle, high].map(|temp_c| axis.at(piece, temp_c));
                let a = [
                    cold.0,
                    4.0 * mid.0 - 3.0 * cold.0 - hot.0,
                    2.0 * (cold.0 + hot.0 - 2.0 * mid.0),
                ];
                let r = [cold.1, hot.1 - cold.1];
                for step in 0..=8 {
                    let z = f64::from(step) / 8.0;
                    let (static_bias, rate_bias) = axis.at(piece, low + z * (high - low));
                    for rate in [rates.0, 0.0, rates.1] {
                        least = least.min(static_bias + rate * rate_bias);
                        most = most.max(static_bias + rate * rate_bias);
                    }
                    let static_error = (a[0] + z * (a[1] + z * a[2]) - static_bias).abs();
                    let rate_error = (r[0] + z * r[1] - rate_bias).abs();
                    let fastest = rates.1.max(-rates.0);
                    worst = worst.max(static_error + fastest * rate_error);
                }
                cell.push(Terms {
                    a: a.map(|value| value as f32),
                    r: r.map(|value| value as f32),
                });
            }
            // A bias that hardly moves is not followed beyond the precision of f32.
            let range = (most - least).max(1e-6 * most.abs().max(least.abs()));
            if range > 0.0 {
                deviation = deviation.max(worst / range);
            }
        }
        Cells {
            cells,
            deviation,
            moved_c: self.worst_distance_c(pieces),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Polynomial;
    use crate::segment::{Overlap, Segment};

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
            let table = tabulate(&segmentation, &[axis], (-2.0, 2.0));
            assert_eq!(table.cells.len() % 19, 0, "{overlap:?}");
            assert!(table.deviation <= TOLERANCE, "{overlap:?}");
            assert!(table.moved_c < 1e-9);
            if !matches!(overlap, Overlap::Linear | Overlap::Smooth) {
                assert_eq!(table.cells.len(), 19, "{overlap:?}");
                assert!(table.deviation < 1e-12);
            } else {
                // Blends leave no jump between cells beyond the rounding of the coefficients.
                for pair in table.cells.windows(2) {
                    let jump = pair[1][0].bias(0.0, 2.0) - pair[0][0].bias(1.0, 2.0);
                    assert!(jump.abs() < 1e-7, "{overlap:?} {jump}");
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
        let table = tabulate(&segmentation, &[axis], (-1.0, 1.0));
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
        let table = tabulate(&segmentation, &[axis], (-1.0, 1.0));
        assert_eq!(table.cells.len(), MOST_CELLS);
        assert!(table.moved_c > 0.0 && table.moved_c <= 0.5 * 50.0 / MOST_CELLS as f64);
    }
}
