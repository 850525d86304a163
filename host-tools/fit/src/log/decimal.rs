//! Decimal numbers in text, correctly rounded.

/// Powers of ten that a double holds exactly.
const POWERS_OF_TEN: [f64; 20] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19,
];

/// Up to this many digits fit into 64 bits.
const MOST_DIGITS: usize = 19;

/// Integers up to this are doubles.
const LARGEST_EXACT: u64 = 1 << 53;

/// Reads the plain number, such as `-12.0625`, that `text` starts with; returns it with its length.
///
/// `None` where the digits are too many for one exact division, or missing: such text is for
/// [`parse`]. Both round correctly, so both give the double that `str::parse` gives.
#[inline]
pub(super) fn prefix(text: &[u8]) -> Option<(f64, usize)> {
    let is_negative = *text.first()? == b'-';
    let start = usize::from(is_negative);
    let (mut mantissa, mut at) = (0_u64, start);
    at += digits(&text[at..], &mut mantissa);
    let mut count = at - start;
    let mut decimals = 0;
    if text.get(at) == Some(&b'.') {
        decimals = digits(&text[at + 1..], &mut mantissa);
        at += 1 + decimals;
        count += decimals;
    }
    // Beyond these limits the mantissa has wrapped or is not exact.
    if count == 0 || count > MOST_DIGITS || mantissa > LARGEST_EXACT {
        return None;
    }
    // Both operands are exact, so the quotient is rounded once.
    let magnitude = mantissa as f64 / POWERS_OF_TEN[decimals];
    Some((if is_negative { -magnitude } else { magnitude }, at))
}

/// Adds the digits that `text` starts with to `mantissa`; returns their number.
#[inline]
fn digits(text: &[u8], mantissa: &mut u64) -> usize {
    let mut count = 0;
    for byte in text {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(digit.into());
        count += 1;
    }
    count
}

/// Reads a cell as a finite number.
pub(super) fn parse(cell: &[u8]) -> Option<f64> {
    let value: f64 = fast_float2::parse(cell).ok()?;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn both(text: &str) {
        let expected: f64 = text.parse().unwrap();
        let parsed = parse(text.as_bytes()).unwrap();
        assert_eq!(parsed.to_bits(), expected.to_bits(), "{text}");
        if let Some((value, length)) = prefix(text.as_bytes())
            && length == text.len()
        {
            assert_eq!(value.to_bits(), expected.to_bits(), "{text}");
        }
    }

    #[test]
    fn plain_numbers_take_the_short_way() {
        for (text, value, length) in [
            ("0", 0.0, 1),
            ("-0.0625,", -0.0625, 7),
            ("72000.5\n", 72000.5, 7),
            (".5", 0.5, 2),
            ("5.", 5.0, 2),
            ("1e5", 1.0, 1),
        ] {
            assert_eq!(prefix(text.as_bytes()), Some((value, length)), "{text}");
        }
        assert!(prefix(b"-0").unwrap().0.is_sign_negative());
        for text in [
            "",
            "-",
            ".",
            "x",
            "12345678901234567890",
            "9007199254740993",
        ] {
            assert_eq!(prefix(text.as_bytes()), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn numbers_are_those_of_the_standard_library(
            text in "-?([0-9]{1,12}(\\.[0-9]{0,12})?|\\.[0-9]{1,18})(e-?[0-9]{1,2})?",
            value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL,
        ) {
            both(&text);
            both(&format!("{value}"));
            both(&format!("{value:e}"));
            both(&format!("{:.6}", value % 1e6));
        }
    }
}
