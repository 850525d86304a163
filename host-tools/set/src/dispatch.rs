//! From numbers that a file gives to numbers that the compiler knows: channels and axes.

use tempco::{Table, TableError};

use crate::TableData;

/// Something to do for so many channels and so many axes of each.
pub trait ShapeUse {
    /// What comes of it.
    type Output;

    /// Does it.
    fn with<const CHANNELS: usize, const AXES: usize>(self) -> Self::Output;
}

/// Does something for `channels` of `axes` axes; none where these are not one to six axes in all.
pub fn use_shape<U: ShapeUse>(channels: usize, axes: usize, task: U) -> Option<U::Output> {
    macro_rules! shapes {
        ($($channels:literal of $axes:literal),+) => {
            match (channels, axes) {
                $(($channels, $axes) => Some(task.with::<$channels, $axes>()),)+
                _ => None,
            }
        };
    }
    shapes!(
        1 of 1, 1 of 2, 1 of 3, 1 of 4, 1 of 5, 1 of 6, 2 of 1, 2 of 2, 2 of 3, 3 of 1, 3 of 2,
        4 of 1, 5 of 1, 6 of 1
    )
}

/// Something to do with the core's tables of some channels.
pub trait TableUse {
    /// What comes of it.
    type Output;

    /// Does it.
    fn with<const CHANNELS: usize, const AXES: usize>(
        self,
        tables: &[Table<AXES>; CHANNELS],
    ) -> Self::Output;
}

/// Makes the core's tables of all axes, and uses them.
///
/// # Errors
/// What the core refuses.
///
/// # Panics
/// If there are more than six axes or none, or a table has not as many axes as the others.
pub fn use_tables<U: TableUse>(data: &[&TableData], task: U) -> Result<U::Output, TableError> {
    let axes = data.first().map_or(0, |first| first.axes());
    use_shape(data.len(), axes, OfAllAxes { data, task })
        .expect("a set has 1 to 6 axes in channels of equally many")
}

/// The same for one axis of a table.
pub fn use_axis<U: TableUse>(
    data: &TableData,
    axis: usize,
    task: U,
) -> Result<U::Output, TableError> {
    use_axes::<1, 1, U>([data], axis, task)
}

struct OfAllAxes<'a, U> {
    data: &'a [&'a TableData],
    task: U,
}

impl<U: TableUse> ShapeUse for OfAllAxes<'_, U> {
    type Output = Result<U::Output, TableError>;

    fn with<const CHANNELS: usize, const AXES: usize>(self) -> Self::Output {
        let data = std::array::from_fn(|channel| self.data[channel]);
        use_axes::<CHANNELS, AXES, U>(data, 0, self.task)
    }
}

/// The same for `AXES` axes from `first_axis` on.
fn use_axes<const CHANNELS: usize, const AXES: usize, U: TableUse>(
    data: [&TableData; CHANNELS],
    first_axis: usize,
    task: U,
) -> Result<U::Output, TableError> {
    let cells = data.map(|data| data.terms::<AXES>(first_axis));
    let tables = data.iter().zip(&cells);
    let tables = tables.map(|(data, cells)| data.table_over(first_axis, cells));
    let tables: Vec<_> = tables.collect::<Result<_, _>>()?;
    let tables = tables[..].try_into().expect("one for each channel");
    Ok(task.with::<CHANNELS, AXES>(tables))
}
