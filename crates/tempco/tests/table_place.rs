//! The cell of a temperature, for every temperature and tables of every size.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{MAX_CELLS, Status, Table, Terms, ThermalPoint};

const FLAT: [Terms; 1] = [Terms::new([1.0, 0.0, 0.0], [0.0; 2])];
static MANY: [[Terms; 1]; MAX_CELLS] = [FLAT; MAX_CELLS];

fn effective() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>()
            .prop_map(f32::from_bits)
            .prop_filter("a number", |t| !t.is_nan()),
        -300.0_f32..1100.0,
        Just(f32::INFINITY),
        Just(f32::NEG_INFINITY),
    ]
}

/// What must hold for one temperature in one table of `count` cells.
fn check(table: &Table<'_, 1>, temp: f32) -> Result<(), TestCaseError> {
    let count = table.cells().len();
    let place = table.place(temp);
    prop_assert!(place.cell < count, "{} in {:?}", temp, place);
    prop_assert!((0.0..1.0).contains(&place.z), "{} in {:?}", temp, place);
    let outside = temp < table.t_min_c() || temp > table.t_max_c();
    prop_assert_eq!(place.status == Status::TEMPERATURE_CLAMPED, outside);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(2000), failure_persistence: None, ..Default::default() })]

    #[test]
    fn every_temperature_falls_into_a_cell_of_every_table(
        count in prop_oneof![1_usize..=MAX_CELLS, Just(1), Just(MAX_CELLS)],
        first in -273.0_f32..900.0,
        width in prop_oneof![0.01_f32..90.0, Just(0.002)],
        calibrated in (0.0_f32..0.5, 0.5_f32..1.0),
        temps in prop::collection::vec(effective(), 20),
        inside in prop::collection::vec(0.0_f32..=1.0, 20),
    ) {
        let last = first + width;
        let whole = Table::new(THERMAL, first, last, &MANY[..count]).unwrap();
        let t_min = first + calibrated.0 * width;
        let t_max = (first + calibrated.1 * width).clamp(t_min, last);
        let narrow = whole.calibrated(t_min, t_max).unwrap();
        for table in [whole, narrow] {
            for &temp in &temps {
                check(&table, temp)?;
            }
            for part in &inside {
                let temp = first + part * width;
                check(&table, temp)?;
                // A narrower calibrated range leaves the cells where they are.
                let temp = temp.clamp(t_min, t_max);
                prop_assert_eq!(table.place(temp), whole.place(temp));
            }
            for edge in [table.t_min_c(), table.t_max_c()] {
                for temp in [edge.next_down(), edge, edge.next_up()] {
                    check(&table, temp)?;
                }
            }
        }
    }

    /// Against f64: the place is right to the rounding of the product, and so is the bias.
    #[test]
    fn the_bias_is_that_of_the_polynomial_in_double_precision(
        temp in T_MIN..T_MAX,
        rate in -30.0_f32..30.0,
    ) {
        let (bias, status) = TABLE.bias(&ThermalPoint {
            effective_c: temp,
            rate_c_per_min: rate,
            status: Status::RATE_CLAMPED,
            ..ThermalPoint::default()
        });
        prop_assert_eq!(status, Status::RATE_CLAMPED);
        let position = (f64::from(temp) - f64::from(T_MIN)) / 10.0;
        let (cell, z) = (position as usize, position.fract());
        for (Terms { a, r, .. }, bias) in CELLS[cell].iter().zip(bias) {
            let at_z = |values: &[f32]| {
                let powers = values.iter().rev();
                powers.fold(0.0, |sum, &value| f64::from(value) + z * sum)
            };
            let expected = at_z(a) + f64::from(rate) * at_z(r);
            let error = (f64::from(bias) - expected).abs();
            prop_assert!(error < 2e-5, "{} at {} degC, {}", error, temp, rate);
        }
    }
}

#[test]
fn at_the_edges_of_the_cells_the_bias_is_that_of_both_neighbours() {
    let at = |effective_c: f32, rate_c_per_min| {
        let point = ThermalPoint {
            effective_c,
            rate_c_per_min,
            ..ThermalPoint::default()
        };
        TABLE.bias(&point).0
    };
    for edge in 1..CELLS.len() {
        let temp = T_MIN + 10.0 * edge as f32;
        for rate in [0.0, 10.0] {
            let neighbours = CELLS[edge - 1].iter().zip(&CELLS[edge]);
            for (axis, (left, right)) in neighbours.enumerate() {
                let expected = right.a[0] + rate * right.r[0];
                let sum = left.a.iter().sum::<f32>() + rate * left.r.iter().sum::<f32>();
                assert!((sum - expected).abs() < 1e-5, "the table is continuous");
                for temp in [temp.next_down(), temp, temp.next_up()] {
                    let bias = at(temp, rate)[axis];
                    assert!((bias - expected).abs() < 1e-5, "{bias} at {temp}");
                }
            }
        }
    }
    // Both ends of the range are the outer edges of the outer cells.
    let first = CELLS[0][0];
    let last = CELLS[CELLS.len() - 1][0];
    assert_eq!(at(T_MIN, 0.0)[0], first.a[0]);
    assert!((at(T_MAX, 0.0)[0] - last.a.iter().sum::<f32>()).abs() < 1e-5);
}

/// Where the first edge and the reciprocal width are no round numbers, an edge may fall to either
/// side by a rounding; nowhere may cells be skipped or come back.
#[test]
fn cells_follow_each_other_without_gap_for_awkward_widths() {
    const STEPS: u32 = if cfg!(miri) { 1000 } else { 100_000 };
    for (count, first, last) in [(7, -17.6, 73.97), (19, 0.1, 0.3), (MAX_CELLS, -40.0, 85.0)] {
        let table = Table::new(THERMAL, first, last, &MANY[..count]).unwrap();
        let mut before = 0.0;
        for step in 0..=STEPS {
            let place = table.place(first + (last - first) * (1.0 / STEPS as f32) * step as f32);
            let position = place.cell as f32 + place.z;
            assert!(position >= before, "{position} after {before}");
            let largest = count as f32 * (2.0 / STEPS as f32) + 1e-3;
            assert!(position - before < largest, "{position} after {before}");
            before = position;
        }
        assert_eq!(table.place(last).cell, count - 1);
    }
}
