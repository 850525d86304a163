//! The lowest place of a smooth function.

/// Looks for it by parabolas: both ends and the middle first, then `steps` times the lowest place
/// of the parabola through the best place and its neighbours.
pub(crate) fn lowest(
    (low, high): (f64, f64),
    steps: usize,
    mut cost: impl FnMut(f64) -> f64,
) -> f64 {
    let middle = 0.5 * (low + high);
    let mut tried: Vec<(f64, f64)> = [low, middle, high].map(|x| (x, cost(x))).into();
    for _ in 0..steps {
        let best = position_of_lowest(&tried).clamp(1, tried.len() - 2);
        let [(x0, y0), (x1, y1), (x2, y2)] = [tried[best - 1], tried[best], tried[best + 1]];
        let (before, after) = ((x1 - x0) * (y1 - y2), (x1 - x2) * (y1 - y0));
        let vertex = x1 - 0.5 * ((x1 - x0) * before - (x1 - x2) * after) / (before - after);
        // Where the vertex adds nothing new, the middle of the wider side does.
        let apart = 0.01 * (x2 - x0);
        let near = |x: f64| [x0, x1, x2].iter().any(|known| (x - known).abs() < apart);
        let wider = if x1 - x0 > x2 - x1 {
            0.5 * (x0 + x1)
        } else {
            0.5 * (x1 + x2)
        };
        let inside = vertex > x0 && vertex < x2;
        let x = if inside && !near(vertex) {
            vertex
        } else {
            wider
        };
        let at = tried.partition_point(|&(known, _)| known < x);
        tried.insert(at, (x, cost(x)));
    }
    tried[position_of_lowest(&tried)].0
}

/// As [`lowest`], of a positive number, by its logarithm.
pub(crate) fn lowest_exp(
    logarithms: (f64, f64),
    steps: usize,
    mut cost: impl FnMut(f64) -> f64,
) -> f64 {
    libm::exp(lowest(logarithms, steps, |x| cost(libm::exp(x))))
}

fn position_of_lowest(tried: &[(f64, f64)]) -> usize {
    let values = tried.iter().enumerate();
    values
        .min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1))
        .map_or(0, |(position, _)| position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_find_a_minimum_inside_and_at_the_ends() {
        for (minimum, expected) in [(0.7, 0.7), (-1.0, 0.0), (3.0, 1.3)] {
            let found = lowest((0.0, 1.3), 6, |x: f64| {
                (x - minimum).powi(2) + 0.3 * (x - minimum).powi(4)
            });
            assert!((found - expected).abs() < 0.02, "{found} for {minimum}");
        }
    }
}
