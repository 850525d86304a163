//! Tables from what C has: a flash image, or the structure of `table.h`.

use core::array::from_fn;

use tempco::{MAX_CELLS, Table, Terms, Thermal};
use tempco_image::Image;

use crate::place::{get, slice};
use crate::{Channel, Error};

/// A table of an image that is used in place.
///
/// # Errors
/// A bad pointer; what the image reader or the core refuses.
///
/// # Safety
/// `image` points to `length` bytes that do not change and outlive the table.
pub(crate) unsafe fn from_image<const AXES: usize>(
    image: *const u32,
    length: usize,
    channel: u32,
) -> Result<Table<'static, AXES>, Error> {
    // SAFETY: the caller vouches for it.
    let image = unsafe { read(image, length) }?;
    Ok(image.table(channel as usize)?)
}

/// An image that is used in place.
///
/// # Errors
/// A bad pointer; what the image reader refuses.
///
/// # Safety
/// As of [`from_image`].
pub(crate) unsafe fn read<'a>(image: *const u32, length: usize) -> Result<Image<'a>, Error> {
    // SAFETY: the caller vouches for it. That it is aligned to words is looked at before.
    let bytes = unsafe {
        get(image.cast::<[u32; 0]>())?;
        slice(image.cast::<u8>(), length)
    }?;
    Ok(Image::read(bytes)?)
}

/// A table whose cells stay where `table.h` has them.
///
/// # Errors
/// A bad pointer, another number of axes, what the core refuses.
///
/// # Safety
/// `channel` points to such a structure, and its cells do not change and outlive the table.
pub(crate) unsafe fn from_channel<const AXES: usize>(
    channel: *const Channel,
) -> Result<Table<'static, AXES>, Error> {
    // SAFETY: the caller vouches for it.
    let channel = unsafe { get(channel) }?;
    if channel.axis_count as usize != AXES {
        return Err(Error::Shape);
    }
    let count = channel.cell_count as usize;
    if !(1..=MAX_CELLS).contains(&count) {
        return Err(Error::Cells);
    }
    // SAFETY: the structure says so, and the caller vouches for it. Its number of axes is this one.
    let cells = unsafe { slice(channel.cells.cast::<[Terms; AXES]>(), count) }?;
    let thermal = Thermal::new(channel.thermal)?;
    let table = Table::new(thermal, channel.first_edge_c, channel.last_edge_c, cells)?
        .calibrated(channel.t_min_c, channel.t_max_c)?
        .with_plays(from_fn(|play| {
            from_fn(|axis| channel.axes[axis].play_gains[play])
        }))?;
    Ok(table)
}
