//! Looks for faults of the signals in the rows that may be fitted.

use tempco_log::signals::Signals;
use tempco_set::Stretch;

/// Takes in the next rows of a channel, but not those in excluded stretches: a fault that was cut
/// out is no fault.
pub(super) fn take(
    signals: &mut Signals,
    exclude: &[Stretch],
    time_s: &[f64],
    temp_c: &[f32],
    axes: &[&[f64]],
) {
    if exclude.is_empty() {
        return signals.take(time_s, temp_c, axes);
    }
    let is_out = |time_s: &f64| {
        let mut stretches = exclude.iter();
        stretches.any(|stretch| (stretch.from_s..=stretch.to_s).contains(time_s))
    };
    let mut start = 0;
    for alike in time_s.chunk_by(|a, b| is_out(a) == is_out(b)) {
        let rows = start..start + alike.len();
        start = rows.end;
        if !is_out(&alike[0]) {
            let axes: Vec<&[f64]> = axes.iter().map(|axis| &axis[rows.clone()]).collect();
            signals.take(alike, &temp_c[rows], &axes);
        }
    }
}
