//! What each column of a log is used for.

use serde::Serialize;

use super::layout::Layout;
use super::temp_columns::TempSource;
use super::unit::ColumnUnit;

/// A column of a log, and what it is used for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ColumnUse {
    /// Its name in the header.
    pub name: String,
    /// `time`, `temperature`, `axis` or `filter`; none of a column that is not used.
    pub role: Option<&'static str>,
    /// The unit of its values, as it is named in a mapping: of times and axes.
    pub unit: Option<String>,
    /// The axes: of an axis its own name, of a temperature those that it belongs to.
    pub axes: Vec<String>,
}

/// The columns of a log, in the order of its header.
pub(crate) fn column_uses(layout: &Layout) -> Vec<ColumnUse> {
    let columns = &layout.columns;
    let header = layout.header.iter().enumerate();
    header
        .map(|(position, name)| {
            let of = |role, unit, axes| ColumnUse {
                name: name.clone(),
                role,
                unit,
                axes,
            };
            if position == columns.time {
                return of(
                    Some("time"),
                    Some(columns.time_unit.to_string()),
                    Vec::new(),
                );
            }
            for channel in &columns.channels {
                if matches!(channel.temp, TempSource::Column(at) if at == position) {
                    let axes = channel.axes.iter().map(|axis| axis.name.clone());
                    return of(Some("temperature"), None, axes.collect());
                }
                if let Some(axis) = channel.axes.iter().find(|axis| axis.position == position) {
                    let unit = match axis.unit {
                        ColumnUnit::Direct(unit) => unit.name(),
                        ColumnUnit::Pulses => "pulses",
                    };
                    let axes = vec![axis.name.clone()];
                    return of(Some("axis"), Some(unit.to_owned()), axes);
                }
            }
            let is_filter = columns.filters.iter().any(|of| of.position == position);
            of(is_filter.then_some("filter"), None, Vec::new())
        })
        .collect()
}
