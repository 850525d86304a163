//! Tables of what a set says of its own fit, for `inspect` and `evaluate`.

use anyhow::Result;
use comfy_table::Table;
use tempco_fit::set::SegmentSet;

use crate::output::{figure, print, table};

/// What each segment was fitted from.
pub(crate) fn show_coverage(segments: &[SegmentSet]) -> Result<()> {
    print("\nWhat each segment was fitted from [degC, degC/min]")?;
    print(coverage(segments))
}

fn coverage(segments: &[SegmentSet]) -> Table {
    let rows = segments.iter().map(|segment| {
        let mut row = vec![
            format!("{:.2}..{:.2}", segment.t_min_c, segment.t_max_c),
            segment.terms.join(" "),
            segment.rows.to_string(),
        ];
        match &segment.coverage {
            Some(coverage) => row.extend([
                format!("{:.2} h", coverage.time_s / 3600.0),
                format!("{:.0} %", 100.0 * coverage.width),
                format!(
                    "{:+.2}..{:+.2}",
                    coverage.rate_min_c_per_min, coverage.rate_max_c_per_min
                ),
                figure(coverage.rate_independent_c_per_min),
            ]),
            None => row.extend(["-"; 4].map(str::to_owned)),
        }
        row.push(if segment.rows > 0 {
            figure(segment.condition)
        } else {
            "-".to_owned()
        });
        row
    });
    let header = [
        "segment",
        "terms",
        "rows",
        "time",
        "width",
        "rate",
        "spread",
        "condition",
    ];
    table(&header, rows)
}
