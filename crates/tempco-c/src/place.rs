//! Pointers of the caller, checked.

use crate::Error;

fn check<T>(pointer: *const T) -> Result<(), Error> {
    if pointer.is_null() {
        Err(Error::Null)
    } else if !pointer.is_aligned() {
        Err(Error::Alignment)
    } else {
        Ok(())
    }
}

/// Makes an object in memory of the caller.
///
/// # Errors
/// A pointer that is null or not aligned.
///
/// # Safety
/// Else it points to writable memory of that size, which nothing else uses meanwhile.
pub(crate) unsafe fn put<T>(place: *mut T, object: T) -> Result<(), Error> {
    check(place)?;
    // SAFETY: not null, aligned, and the caller vouches for the rest.
    unsafe { place.write(object) };
    Ok(())
}

/// An object of the caller.
///
/// # Errors
/// A pointer that is null or not aligned.
///
/// # Safety
/// Else it points to such an object, which outlives `'a` and does not change meanwhile, but for
/// its atomics.
pub(crate) unsafe fn get<'a, T>(object: *const T) -> Result<&'a T, Error> {
    check(object)?;
    // SAFETY: not null, aligned, and the caller vouches for the rest.
    Ok(unsafe { &*object })
}

/// Values of the caller.
///
/// # Errors
/// A pointer that is null or not aligned.
///
/// # Safety
/// Else it points to so many values, which outlive `'a` and do not change meanwhile.
pub(crate) unsafe fn slice<'a, T>(values: *const T, count: usize) -> Result<&'a [T], Error> {
    check(values)?;
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(Error::Short);
    }
    // SAFETY: not null, aligned, of a possible size, and the caller vouches for the rest.
    Ok(unsafe { core::slice::from_raw_parts(values, count) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pointers_to_nothing_or_between_words_are_refused() {
        let mut words = [0_u32; 4];
        let odd = words
            .as_mut_ptr()
            .cast::<u8>()
            .wrapping_add(2)
            .cast::<u32>();
        for (pointer, expected) in [
            (core::ptr::null_mut(), Error::Null),
            (odd, Error::Alignment),
        ] {
            // SAFETY: they are refused before they are used.
            unsafe {
                assert_eq!(put(pointer, 1), Err(expected));
                assert_eq!(get(pointer), Err(expected));
                assert_eq!(slice(pointer, 2), Err(expected));
            }
        }
        let place = words.as_mut_ptr();
        // SAFETY: four words of this function.
        unsafe {
            assert_eq!(put(place, 7), Ok(()));
            assert_eq!(get(place), Ok(&7));
            assert_eq!(slice(place, 4), Ok(&[7, 0, 0, 0][..]));
            assert_eq!(slice(place, usize::MAX / 4), Err(Error::Short));
        }
    }
}
