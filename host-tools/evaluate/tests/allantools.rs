//! The Allan deviations equal the results of the Python package allantools 2024.6.
//!
//! `tests/allan/reference.py` wrote `tests/allan/reference.csv` from the series made here.

use tempco_evaluate::allan::overlapping;

/// Largest relative deviation from allantools.
const ALLOWED: f64 = 1e-9;

/// Whole numbers of 64 bits (Steele, Lea and Flood, 2014).
fn splitmix64(seed: u64) -> impl Iterator<Item = u64> {
    let mut state = seed;
    std::iter::repeat_with(move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    })
}

/// White noise, uniform over -0.5 to 0.5.
fn uniform(seed: u64) -> impl Iterator<Item = f64> {
    splitmix64(seed).map(|bits| (bits >> 11) as f64 * 2.0_f64.powi(-53) - 0.5)
}

fn series(name: &str) -> Vec<f64> {
    match name {
        "white" => uniform(1).take(20_000).collect(),
        "random_walk" => {
            let walk = uniform(2).scan(3.0, |value, step| {
                *value += step;
                Some(*value)
            });
            walk.take(30_011).collect()
        }
        "pulses" => {
            let counts = splitmix64(3).scan(0_i64, |angle, bits| {
                let before = *angle >> 32;
                *angle += 1_288_490_189 + (bits >> 32) as i64 - (1 << 31);
                Some(((*angle >> 32) - before) as f64)
            });
            counts.take(65_537).collect()
        }
        "beside_a_constant" => uniform(1).take(12_345).map(|v| 10_000.0 + v).collect(),
        _ => panic!("no series {name}"),
    }
}

#[test]
fn overlapping_allan_deviations_are_those_of_allantools() {
    let mut worst = 0.0_f64;
    let mut compared = 0;
    let lines: Vec<Vec<&str>> = include_str!("allan/reference.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    for name in ["white", "random_walk", "pulses", "beside_a_constant"] {
        let expected: Vec<_> = lines.iter().filter(|cells| cells[0] == name).collect();
        let number = |cell: &str| cell.parse::<f64>().unwrap();
        let interval_s = number(expected[0][1]);
        let found = overlapping(series(name).into_iter(), interval_s);
        // allantools leaves out a deviation of a single difference.
        assert!(found.len() - expected.len() <= 1, "{name}");
        for (found, cells) in found.iter().zip(expected) {
            assert_eq!(found.tau_s, number(cells[2]), "{name}");
            assert_eq!(found.n, cells[3].parse::<usize>().unwrap(), "{name}");
            let deviation = (found.deviation / number(cells[4]) - 1.0).abs();
            assert!(deviation <= ALLOWED, "{name}: {found:?} {cells:?}");
            worst = worst.max(deviation);
            compared += 1;
        }
    }
    assert!(compared >= 50, "{compared}");
    println!("{compared} deviations, {worst:.1e} from allantools at most");
}
