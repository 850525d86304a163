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

/// Reads the plain number that `text` starts with, of at most 8 bytes after its sign; returns its value
/// and its length. `None` where there is no digit. If another digit follows, the number is longer, and
/// so for [`short`].
///
/// All bytes are looked at together: a number costs the same whatever its digits.
#[inline(always)]
pub(super) fn shortest(text: &[u8; WINDOW]) -> Option<(f64, usize)> {
    let sign = usize::from(text[0] == b'-');
    let bytes = u64::from_le_bytes(*text[sign..].first_chunk()?);
    // The first byte that is no digit is the point, or the end; 8 if all are digits.
    let others = high_bits(bytes);
    let after_first = others & others.wrapping_sub(1);
    let first = others.trailing_zeros() as usize / 8;
    let second = after_first.trailing_zeros() as usize / 8;
    let has_point = first < 8 && text[sign + first] == b'.';
    let (length, decimals) = match has_point {
        true => (second, second - first - 1),
        false => (first, 0),
    };
    let digits = length - usize::from(has_point);
    if digits == 0 {
        return None;
    }
    // The digits after the point move up to those before it, and all to the last places.
    let whole = (others ^ others.wrapping_sub(1)) >> 8;
    let moved = if has_point { bytes >> 8 } else { bytes };
    let joined = (bytes & whole) | (moved & !whole);
    let mantissa = eight_digits(joined << (64 - 8 * digits));
    Some((quotient(mantissa, sign, decimals), sign + length))
}

/// Bytes that [`shortest`] is given: more than it looks at, so that no place needs a check.
pub(super) const WINDOW: usize = 32;

/// A number of at most so many digits before the point is read by [`short`].
const MOST_SHORT_DIGITS: u32 = 7;

/// Reads the plain number at `at` of `text`, with up to 7 digits before the point and 8 after, of
/// at most 16 bytes with what ends it; returns its value and where it ends. `None` of any other
/// number, which is for [`prefix`], and near the ends of the text.
///
/// All bytes are looked at together: a number costs the same whatever its digits.
#[inline]
pub(super) fn short(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let bytes: &[u8; 16] = text.get(at..at + 16)?.try_into().ok()?;
    let (low, high) = bytes.split_at(8);
    let low = u64::from_le_bytes(low.try_into().ok()?);
    let high = u64::from_le_bytes(high.try_into().ok()?);
    // One bit for each byte that is no digit; the first byte may be a sign.
    let others = u32::from(not_digits(low)) | u32::from(not_digits(high)) << 8;
    let sign = u32::from(bytes[0] == b'-');
    let after_sign = others & !sign;
    let point = after_sign.trailing_zeros();
    let whole_digits = point.wrapping_sub(sign);
    if whole_digits > MOST_SHORT_DIGITS {
        return None;
    }
    let digits = low & !(0xff * u64::from(sign));
    // Digits to the last places of eight, 0 before them.
    let whole = eight_digits(digits.checked_shl(8 * (8 - point)).unwrap_or(0));
    let (mantissa, decimals, end) = if bytes[point as usize] == b'.' {
        let end = (after_sign & (after_sign - 1)).trailing_zeros();
        let decimals = end.wrapping_sub(point + 1);
        let end = at + end as usize;
        if decimals > 8 || whole_digits + decimals == 0 {
            return None;
        }
        let last: &[u8; 8] = text.get(end.checked_sub(8)?..end)?.try_into().ok()?;
        let places = u64::MAX.checked_shl(8 * (8 - decimals)).unwrap_or(0);
        let fraction = eight_digits(u64::from_le_bytes(*last) & places);
        let scale = POWERS_OF_TEN_INTEGER[decimals as usize];
        (whole * scale + fraction, decimals as usize, end)
    } else if whole_digits > 0 {
        (whole, 0, at + point as usize)
    } else {
        return None;
    };
    Some((quotient(mantissa, sign as usize, decimals), end))
}

/// A mantissa below 2^52 with its sign and decimals.
///
/// It is exact, as is the power: the quotient is rounded once. The bits of the doubles from 2^52 on
/// hold it as it is. The power has the sign, so there is no branch, which noise about zero would take
/// at random.
#[inline(always)]
fn quotient(mantissa: u64, sign: usize, decimals: usize) -> f64 {
    let magnitude = f64::from_bits(TWO_52.to_bits() | mantissa) - TWO_52;
    magnitude / SIGNED_POWERS_OF_TEN[sign][decimals]
}

/// The doubles from here on are integers.
const TWO_52: f64 = (1_u64 << 52) as f64;

/// What a mantissa is divided by: for a number without a sign, and with one.
const SIGNED_POWERS_OF_TEN: [[f64; 9]; 2] = [
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8],
    [-1e0, -1e1, -1e2, -1e3, -1e4, -1e5, -1e6, -1e7, -1e8],
];

const POWERS_OF_TEN_INTEGER: [u64; 9] = [
    1,
    10,
    100,
    1_000,
    10_000,
    100_000,
    1_000_000,
    10_000_000,
    100_000_000,
];

/// The high bit of each byte that is no decimal digit.
#[inline]
fn high_bits(bytes: u64) -> u64 {
    const HIGH: u64 = 0x8080_8080_8080_8080;
    let value = bytes ^ 0x3030_3030_3030_3030;
    // A digit's value is below 10: adding 118 to its low seven bits does not reach the high bit.
    (((value & !HIGH) + 0x7676_7676_7676_7676) | value) & HIGH
}

/// A bit for each of eight bytes, the first byte's the lowest: whether it is no decimal digit.
#[inline]
fn not_digits(bytes: u64) -> u8 {
    // The product gathers the high bits in the top byte.
    ((high_bits(bytes) >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
}

/// The number that eight bytes of text make, the first one the highest place; bytes of 0 count as
/// the digit 0.
#[inline]
fn eight_digits(bytes: u64) -> u64 {
    // Pairs, then fours, then all: each product adds the upper neighbour ten, a hundred, ten
    // thousand times.
    let digits = bytes & 0x0f0f_0f0f_0f0f_0f0f;
    let pairs = (digits.wrapping_mul(10 * 256 + 1) >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(100 * 65_536 + 1) >> 16) & 0x0000_ffff_0000_ffff;
    fours.wrapping_mul(10_000 * (1 << 32) + 1) >> 32
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

/// Digits and signs of the longest number with a decimal comma that is read.
const LONGEST: usize = 64;

/// Reads a cell as a finite number, with a decimal comma instead of a point on request. Thousands in
/// groups are no number.
pub(super) fn parse_with(cell: &[u8], decimal_comma: bool) -> Option<f64> {
    if !decimal_comma {
        return parse(cell);
    }
    let mut text = [0; LONGEST];
    let text = text.get_mut(..cell.len())?;
    text.copy_from_slice(cell);
    let mut has_comma = false;
    for byte in &mut *text {
        match byte {
            b'.' => return None,
            b',' if has_comma => return None,
            b',' => {
                has_comma = true;
                *byte = b'.';
            }
            _ => {}
        }
    }
    parse(text)
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
        if let Some((value, length)) = shortest_of(&format!("{text},"))
            && length == text.len()
        {
            assert_eq!(value.to_bits(), expected.to_bits(), "{text}");
        }
        let cells = format!("00000000{text},0000000000000000");
        if let Some((value, end)) = short(cells.as_bytes(), 8)
            && end == 8 + text.len()
        {
            assert_eq!(value.to_bits(), expected.to_bits(), "{text}");
        }
    }

    fn shortest_of(text: &str) -> Option<(f64, usize)> {
        let text = format!("{text}{:032}", 0);
        shortest(text.as_bytes().first_chunk().unwrap())
    }

    #[test]
    fn the_shortest_numbers_take_the_shortest_way() {
        for (text, value, length) in [
            ("0,", 0.0, 1),
            ("-0.0625,", -0.0625, 7),
            ("72000.55\n", 72000.55, 8),
            ("-1234567.,", -1_234_567.0, 9),
            ("12345678,", 12_345_678.0, 8),
            (".1234567,", 0.123_456_7, 8),
            ("-.5\r", -0.5, 3),
            ("5.,", 5.0, 2),
            ("1e5,", 1.0, 1),
            ("1.5.2,", 1.5, 3),
        ] {
            assert_eq!(shortest_of(text), Some((value, length)), "{text}");
        }
        assert!(shortest_of("-0,").unwrap().0.is_sign_negative());
        // The length of a longer number is where it is cut: no end of a cell.
        for text in ["123456789,", "1234567.8,", "-0.1234567,", "12345678.,"] {
            let (_, length) = shortest_of(text).unwrap();
            assert!(length < text.len() - 1, "{text}");
        }
        for text in [",", "-,", ".,", "-.,", "x,", "+1,", "--1,", " 1,", ""] {
            assert_eq!(shortest_of(&format!("{text},")), None, "{text}");
        }
    }

    #[test]
    fn short_numbers_take_a_short_way() {
        let read = |text: &str| {
            let cells = format!("9,9,9,9,{text}0000000000000000");
            let (value, end) = short(cells.as_bytes(), 8)?;
            Some((value, end - 8))
        };
        for (text, value, length) in [
            ("0,", 0.0, 1),
            ("-0.0625,", -0.0625, 7),
            ("72000.5003\n", 72000.5003, 10),
            ("-1234567.12345,", -1_234_567.123_45, 14),
            (".12345678,", 0.123_456_78, 9),
            ("-.5\r", -0.5, 3),
            ("5.,", 5.0, 2),
            ("1e5,", 1.0, 1),
            ("1.5.2,", 1.5, 3),
            ("9999999,", 9_999_999.0, 7),
        ] {
            assert_eq!(read(text), Some((value, length)), "{text}");
        }
        assert!(read("-0,").unwrap().0.is_sign_negative());
        for text in [
            ",",
            "-,",
            ".,",
            "-.,",
            "x,",
            "+1,",
            "--1,",
            " 1,",
            "12345678,",
            "1.123456789,",
            "-123456.12345678,",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    /// Every byte beside a digit.
    #[test]
    fn only_digits_are_digits() {
        for byte in 0..=255_u8 {
            let bytes = u64::from_le_bytes([b'0', byte, b'9', byte, b'5', b'5', b'5', byte]);
            let expected = if byte.is_ascii_digit() {
                0
            } else {
                0b1000_1010
            };
            assert_eq!(not_digits(bytes), expected, "{byte}");
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
