//! The documented error of the bias, asserted over the whole range of random tables.

mod common;

use common::*;
use proptest::prelude::*;
use tempco::{Status, Table, Terms, ThermalPoint, ThermalSettings};
use tempco_fixed::{FixedError, FixedPoint, FixedTable, from_f32, to_f32};

const N: usize = 5;

/// The model in exact arithmetic for a coordinate in cells; both neighbours at an edge.
fn reference(table: &Table<'_, 1>, temp_c: f64, rate: f64) -> [f64; 2] {
    let temp_c = temp_c.clamp(table.t_min_c().into(), table.t_max_c().into());
    let position = (temp_c - f64::from(table.first_edge_c())) * f64::from(table.cells_per_c());
    // What half a last place of either temperature may move across an edge.
    let blur = 2e-6 * f64::from(table.cells_per_c());
    [position - blur, position + blur].map(|side| {
        let cell = (side.max(0.0) as usize).min(N - 1);
        let z = position - cell as f64;
        let Terms { a, r } = table.cells()[cell][0];
        let [a0, a1, a2] = a.map(f64::from);
        let [r0, r1] = r.map(f64::from);
        a0 + z * (a1 + z * a2) + rate * (r0 + r1 * z)
    })
}

/// Coefficients of very different sizes, zero and ties among them.
fn coefficient() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => (-3_i32..1, -1.0_f32..1.0).prop_map(|(e, m)| m * 10.0_f32.powi(e)),
        1 => Just(0.0_f32),
        1 => prop_oneof![Just(1.0_f32), Just(-1.0), Just(0.5)],
    ]
}

#[derive(Clone, Debug)]
struct Case {
    cells: Vec<[f32; 5]>,
    scale: f32,
    range: (f32, f32),
    rates: (f32, f32),
}

fn case() -> impl Strategy<Value = Case> {
    let cell = [(); 5].map(|()| coefficient());
    (
        prop::collection::vec(cell, N),
        -12_i32..13,
        (-273.0_f32..900.0, 0.1_f32..100.0),
        prop_oneof![
            Just((-30.0, 30.0)),
            (-2000.0_f32..0.0, 0.0_f32..2000.0),
            (-1.0_f32..0.0, 0.0_f32..1.0)
        ],
    )
        .prop_map(|(cells, e, (first, width), rates)| Case {
            cells,
            scale: 10.0_f32.powi(e),
            range: (first, first + width),
            rates,
        })
}

fn terms(case: &Case) -> Vec<[Terms; 1]> {
    let term = |cell: &[f32; 5]| {
        let [a0, a1, a2, r0, r1] = cell.map(|c| c * case.scale);
        [Terms {
            a: [a0, a1, a2],
            r: [r0, r1],
        }]
    };
    case.cells.iter().map(term).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_bias_is_within_the_stated_bound_of_double_precision(
        case in case(),
        parts in prop::collection::vec((-0.2_f64..1.2, 0.0_f64..=1.0), 60),
    ) {
        let cells = terms(&case);
        let thermal = thermal(ThermalSettings {
            rate_min_c_per_min: case.rates.0,
            rate_max_c_per_min: case.rates.1,
            ..SETTINGS
        });
        let table = Table::new(thermal, case.range.0, case.range.1, &cells).unwrap();
        let fixed = FixedTable::<1, N>::new(&table).unwrap();
        let unit = f64::from(fixed.exponents()[0]).exp2();
        let bound = fixed.error_bounds()[0];
        let (first, width) = (f64::from(case.range.0), f64::from(case.range.1 - case.range.0));
        let (slowest, fastest) = (f64::from(case.rates.0), f64::from(case.rates.1));
        let edges = (0..=2 * N).map(|half| (half as f64 / (2 * N) as f64, 1.0));
        for (place, share) in parts.into_iter().chain(edges) {
            let rate = slowest + (fastest - slowest) * share;
            let temp_c = (first + width * place).clamp(-1000.0, 1000.0);
            let point = FixedPoint {
                effective: (temp_c * 1_048_576.0).round() as i32,
                rate: (rate * 1_048_576.0).round() as i32,
                status: Status::OK,
            };
            let (bias, status) = fixed.bias(&point);
            let got = f64::from(bias[0]) * unit;
            let error = reference(&table, temp_c, rate)
                .map(|expected| (got - expected).abs())
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            prop_assert!(error <= bound, "{} of {} at {} degC, {}", error, bound, temp_c, rate);
            prop_assert!(bias[0].unsigned_abs() <= 1 << 30);
            let outside = temp_c < first - 1e-6 || temp_c > f64::from(case.range.1) + 1e-6;
            let inside = temp_c > first + 1e-6 && temp_c < f64::from(case.range.1) - 1e-6;
            prop_assert!(!outside || status == Status::TEMPERATURE_CLAMPED);
            prop_assert!(!inside || status == Status::OK);
        }
    }

    /// Every last place of the hot end, where the cell must not be one too far.
    #[test]
    fn the_hot_end_is_in_the_last_cell(case in case(), beyond in -3_i32..4) {
        let cells = terms(&case);
        let table = Table::new(THERMAL, case.range.0, case.range.1, &cells).unwrap();
        let fixed = FixedTable::<1, N>::new(&table).unwrap();
        let end = from_f32(case.range.1);
        let point = FixedPoint { effective: end + beyond, rate: 0, status: Status::OK };
        let (bias, _) = fixed.bias(&point);
        let unit = f64::from(fixed.exponents()[0]).exp2();
        let [_, expected] = reference(&table, f64::from(end + beyond) / 1_048_576.0, 0.0);
        let error = (f64::from(bias[0]) * unit - expected).abs();
        prop_assert!(error <= fixed.error_bounds()[0], "{}", error);
    }

    /// A coarser last place widens the bound by itself; a finer one than fits is refused.
    #[test]
    fn chosen_exponents_hold_their_bound_or_are_refused(case in case(), coarser in 0_i32..20) {
        let cells = terms(&case);
        let table = Table::new(THERMAL, case.range.0, case.range.1, &cells).unwrap();
        let finest = FixedTable::<1, N>::new(&table).unwrap();
        let exponent = finest.exponents()[0];
        let refused = FixedTable::<1, N>::with_exponents(&table, [exponent - 1]);
        prop_assert_eq!(refused.err(), Some(FixedError::Exponent { axis: 0 }));
        let fixed = FixedTable::<1, N>::with_exponents(&table, [exponent + coarser]).unwrap();
        let unit = f64::from(exponent + coarser).exp2();
        prop_assert!(fixed.error_bounds()[0] >= 8.0 * unit);
        for place in [0.1, 0.35, 0.9] {
            let temp_c = case.range.0 + (case.range.1 - case.range.0) * place;
            let effective = from_f32(temp_c);
            let point = FixedPoint { effective, rate: 1 << 20, status: Status::OK };
            let got = f64::from(fixed.bias(&point).0[0]) * unit;
            let [expected, _] = reference(&table, f64::from(effective) / 1_048_576.0, 1.0);
            prop_assert!((got - expected).abs() <= fixed.error_bounds()[0]);
        }
    }
}

/// The resolution is far below any noise: for a bias of 1, 1e-8 and the temperature's last place.
#[test]
fn the_bound_is_small_beside_the_bias() {
    for axis in 0..2 {
        let bound = TABLE.error_bounds()[axis];
        // The largest bias of the table is 3, the noise of a good gyro some 1e-3.
        assert!(bound < 3e-6, "{bound}");
        assert!(
            TABLE.exponents()[axis] <= -24,
            "{}",
            TABLE.exponents()[axis]
        );
    }
}

#[test]
fn both_cores_agree_over_the_whole_range() {
    let mut worst = [0.0_f64; 2];
    for step in 0..=130_000 {
        for rate in [-30.0_f32, -1.25, 0.0, 7.5, 30.0] {
            let temp_c = -45.0 + step as f32 / 1024.0;
            let effective = from_f32(temp_c);
            let f32_point = ThermalPoint {
                effective_c: to_f32(effective),
                rate_c_per_min: rate,
                status: Status::OK,
            };
            let point = FixedPoint {
                effective,
                rate: from_f32(rate),
                status: Status::OK,
            };
            let (expected, f32_status) = F32_TABLE.bias(&f32_point);
            let (bias, status) = TABLE.bias(&point);
            assert_eq!(status, f32_status, "{temp_c}");
            for axis in 0..2 {
                let got = f64::from(bias[axis]) * f64::from(TABLE.exponents()[axis]).exp2();
                worst[axis] = worst[axis].max((got - f64::from(expected[axis])).abs());
            }
        }
    }
    // The f32 core's own rounding, 2e-5 by its tests, is the larger part.
    for (worst, bound) in worst.iter().zip(TABLE.error_bounds()) {
        assert!(*worst < 2e-5 + bound, "{worst}");
    }
    println!("largest difference from the f32 core: {worst:?}");
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let cells = [[Terms {
        a: [1.0; 3],
        r: [0.0; 2],
    }]; 3];
    let table = Table::new(THERMAL, 0.0, 30.0, &cells).unwrap();
    assert_eq!(
        FixedTable::<1, 4>::new(&table).err(),
        Some(FixedError::CellCount)
    );
    let many = [cells[0]; 256];
    let narrow = Table::new(THERMAL, 0.0, 1.1e-3, &many).unwrap();
    assert_eq!(
        FixedTable::<1, 256>::new(&narrow).err(),
        Some(FixedError::CellWidth)
    );
    let fast = thermal(ThermalSettings {
        rate_min_c_per_min: -2000.1,
        ..SETTINGS
    });
    let table = Table::new(fast, 0.0, 30.0, &cells).unwrap();
    assert_eq!(
        FixedTable::<1, 3>::new(&table).err(),
        Some(FixedError::Rate)
    );
    let huge = [[Terms {
        a: [1e20; 3],
        r: [0.0; 2],
    }]; 3];
    let table = Table::new(THERMAL, 0.0, 30.0, &huge).unwrap();
    assert!(FixedTable::<1, 3>::new(&table).is_ok());
    let zero = [[Terms {
        a: [0.0; 3],
        r: [0.0; 2],
    }]; 3];
    let table = Table::new(THERMAL, 0.0, 30.0, &zero).unwrap();
    assert!(FixedTable::<1, 3>::new(&table).is_ok());
}
