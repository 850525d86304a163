//! Every f32 as lag-compensated temperature, against exact arithmetic.

use anyhow::{Context, Result, bail, ensure};
use tempco::{Table, ThermalPoint};
use tempco_set::TableData;

/// Worst errors over all temperatures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// Of the place \[cells\].
    pub place: f64,
    /// Of the bias \[unit of the axis\].
    pub bias: f64,
    /// Temperatures within the calibrated range.
    pub inside: u64,
}

/// Passes every f32 but NaN to the core, at the lowest, zero and highest rate.
///
/// # Errors
/// A place out of range, a temperature outside whose place is not the nearest end, a bias
/// that is not finite, or an error beyond the rounding bound.
pub fn check(data: &TableData, axis: usize, threads: u64) -> Result<Worst> {
    let cells = data.terms::<1>(axis);
    let table = data.table_over(0, &cells)?;
    let parts: Vec<Result<Worst>> = std::thread::scope(|scope| {
        let table = &table;
        let workers: Vec<_> = (0..threads)
            .map(|thread| {
                let range = |part: u64| ((1_u64 << 32) * part / threads) as u32;
                let last = range(thread + 1).wrapping_sub(1);
                scope.spawn(move || over(data, table, range(thread)..=last))
            })
            .collect();
        workers
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|_| bail!("a thread failed")))
            .collect()
    });
    let mut worst = Worst::default();
    for part in parts {
        let part = part?;
        worst.place = worst.place.max(part.place);
        worst.bias = worst.bias.max(part.bias);
        worst.inside += part.inside;
    }
    let bound = data.rounding_bound(axis);
    ensure!(
        worst.bias <= bound.total && worst.place <= bound.place,
        "measured {worst:?} beyond {bound:?}"
    );
    Ok(worst)
}

fn over(data: &TableData, table: &Table<1>, bits: std::ops::RangeInclusive<u32>) -> Result<Worst> {
    let mut worst = Worst::default();
    let (cold, hot) = (table.place(data.t_min_c), table.place(data.t_max_c));
    let (count, first) = (data.cells.len(), f64::from(data.first_edge_c));
    let per_c = 1.0 / data.cell_width_c();
    let thermal = &data.thermal;
    let rates = [thermal.rate_min_c_per_min, 0.0, thermal.rate_max_c_per_min];
    for effective_c in bits.map(f32::from_bits).filter(|value| !value.is_nan()) {
        let place = table.place(effective_c);
        if effective_c < data.t_min_c || effective_c > data.t_max_c {
            let end = if effective_c < data.t_min_c {
                cold
            } else {
                hot
            };
            ensure!(
                (place.cell, place.z) == (end.cell, end.z),
                "{effective_c} is not held at the end of the range"
            );
            continue;
        }
        let in_range = place.cell < count && place.z >= 0.0 && place.z < 1.0;
        ensure!(in_range, "{effective_c} has place {place:?}");
        worst.inside += 1;
        let exact = (f64::from(effective_c) - first) * per_c - place.cell as f64;
        worst.place = worst.place.max((f64::from(place.z) - exact).abs());
        let terms = table.cells().get(place.cell).context("a cell")?[0];
        let at_exact = |values: &[f32]| {
            let powers = values.iter().rev();
            powers.fold(0.0, |sum, &value| f64::from(value) + exact * sum)
        };
        let (fixed, slope) = (at_exact(&terms.a), at_exact(&terms.r));
        for rate_c_per_min in rates {
            let point = ThermalPoint {
                effective_c,
                rate_c_per_min,
                ..Default::default()
            };
            let bias = table.bias(&point).0[0];
            ensure!(bias.is_finite(), "{effective_c} has bias {bias}");
            let reference = fixed + f64::from(rate_c_per_min) * slope;
            worst.bias = worst.bias.max((f64::from(bias) - reference).abs());
        }
    }
    Ok(worst)
}
