//! Random numbers for tests.

/// White noise of mean 0 and variance 1: sums of twelve uniform numbers (splitmix64).
pub(crate) fn white(seed: u64) -> impl Iterator<Item = f64> {
    let mut state = seed.wrapping_mul(0xD134_2543_DE82_EF95);
    let mut uniform = move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53)
    };
    std::iter::repeat_with(move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
}
