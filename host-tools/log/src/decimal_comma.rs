//! Whether numbers have a decimal comma.

use super::decimal;
use super::dialect::{Header, is_clock};
use super::excerpt::excerpt_of_bytes;

/// Whether the numbers of the first rows, in the columns that are read, have a decimal comma.
///
/// # Errors
/// Two signs, or commas that may stand between thousands; with the place of the row.
pub(super) fn has_decimal_comma(
    header: &Header,
    positions: &[usize],
) -> Result<bool, (u64, String)> {
    let (mut point, mut comma, mut is_certain) = (None, None, false);
    for (row, cells) in header.sample.iter().enumerate() {
        for cell in positions.iter().filter_map(|&position| cells.get(position)) {
            if is_clock(cell) {
                continue;
            }
            if decimal::parse(cell).is_some() && cell.contains(&b'.') {
                point.get_or_insert(cell);
            } else if decimal::parse_with(cell, true).is_some() && cell.contains(&b',') {
                comma.get_or_insert((row as u64 + 1, cell));
                is_certain |= !may_be_thousands(cell);
            }
        }
    }
    let Some((row, cell)) = comma else {
        return Ok(false);
    };
    let cell = excerpt_of_bytes(cell);
    match point {
        Some(point) => Err((
            row,
            format!(
                "`{cell}` has a decimal comma and `{}` a decimal point: expected one of them",
                excerpt_of_bytes(point)
            ),
        )),
        None if !is_certain => Err((
            row,
            format!(
                "`{cell}` may have a decimal comma, or a comma between thousands: expected a \
                 decimal point"
            ),
        )),
        None => Ok(true),
    }
}

/// Whether a comma may stand before three digits of a larger number: `1,234`, not `0,123`.
fn may_be_thousands(cell: &[u8]) -> bool {
    let cell = cell.strip_prefix(b"-").unwrap_or(cell);
    let comma = cell.iter().position(|&byte| byte == b',').unwrap_or(0);
    let (whole, decimals) = (&cell[..comma], &cell[comma + 1..]);
    let is_number = |text: &[u8]| text.iter().all(u8::is_ascii_digit);
    (1..=3).contains(&whole.len()) && whole[0] != b'0' && decimals.len() == 3 && is_number(decimals)
}
