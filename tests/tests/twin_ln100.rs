//! The simulated unit `ln100` has the noise of the unit it is named after.

use tempco_tests::ln100::{OCTAVES, factor, record, tau_s, twin};

/// The unit was made after the record `up`. Between the records the tones move by up to 0.2 Hz, so
/// that `down` differs where a tone's period divides the averaging time in one of them; how far the
/// records are from each other is printed beside it.
#[test]
fn the_allan_deviation_is_that_of_the_record() {
    let (Some(up), Some(down)) = (record("up"), record("down")) else {
        return;
    };
    let mut worst = [1.0_f64; 3];
    for seed in [1, 2] {
        let twin = twin(seed);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for i in 0..OCTAVES {
                let (t, u, d) = (twin[axis][i], up[axis][i], down[axis][i]);
                println!(
                    "seed {seed} {name} {:9.4} s: up {u:9.4} twin {t:9.4} deg/h, factor {:.2}; \
                     down {d:9.4}, factor {:.2}; up to down {:.2}",
                    tau_s(i),
                    factor(t, u),
                    factor(t, d),
                    factor(u, d),
                );
                assert!(factor(t, u) <= 1.1, "{name} at {} s", tau_s(i));
                assert!(factor(t, d) <= 2.0, "{name} at {} s", tau_s(i));
                for (worst, pair) in worst.iter_mut().zip([(t, u), (t, d), (u, d)]) {
                    *worst = worst.max(factor(pair.0, pair.1));
                }
            }
        }
    }
    println!("largest factors: twin to up, twin to down, up to down: {worst:.2?}");
}
