//! How large the header makes the objects that the caller owns.
//!
//! The compiler lays out the core's types as it likes. So the header has bytes that are enough, and
//! what is here stops the build where they are not. A test compares these numbers with the header.

use tempco::{Compensator, Interval, PulseCorrector, RampBuffer, Table, ThermalHalf};

/// What a kind of object takes: bytes, pointers, and bytes for each axis.
#[derive(Clone, Copy, Debug)]
pub struct Object {
    /// As in `tempcoN_NAME_t`.
    pub name: &'static str,
    fixed: usize,
    pointers: usize,
    per_axis: usize,
}

impl Object {
    /// Bytes that the header provides, a multiple of 8, where a pointer has `pointer` bytes.
    pub const fn bytes(&self, axes: usize, pointer: usize) -> usize {
        (self.fixed + self.pointers * pointer + self.per_axis * axes).next_multiple_of(8)
    }

    /// Stops the build where a type does not fit; else returns its bytes.
    const fn holding<T>(&self, axes: usize) -> usize {
        assert!(size_of::<T>() <= self.bytes(axes, size_of::<usize>()));
        assert!(align_of::<T>() <= 8);
        size_of::<T>()
    }
}

macro_rules! objects {
    ($($name:literal: $fixed:literal, $pointers:literal, $per_axis:literal, $type:ident $(, $number:ty)?;)+) => {
        /// The kinds of objects, each with what its types of 1, 2, 3 and 6 axes take in this build
        /// \[bytes\].
        pub const OBJECTS: &[(Object, [usize; 4])] = &[$({
            const OBJECT: Object = Object {
                name: $name,
                fixed: $fixed,
                pointers: $pointers,
                per_axis: $per_axis,
            };
            (OBJECT, [
                OBJECT.holding::<$type<1 $(, $number)?>>(1),
                OBJECT.holding::<$type<2 $(, $number)?>>(2),
                OBJECT.holding::<$type<3 $(, $number)?>>(3),
                OBJECT.holding::<$type<6 $(, $number)?>>(6),
            ])
        }),+];
    };
}

objects! {
    "table": 184, 3, 8, Table;
    "thermal": 136, 1, 4, ThermalHalf;
    "ramps": 20, 0, 16, RampBuffer;
    "pulse_ramps": 20, 0, 16, RampBuffer, i32;
    "pulses": 0, 1, 4, PulseCorrector;
    "compensator": 104, 1, 0, Compensator;
}

/// Bytes of `tempco_interval_t`.
pub const INTERVAL_BYTES: usize = 40;

const _: () = assert!(size_of::<Interval>() <= INTERVAL_BYTES && align_of::<Interval>() <= 8);

#[cfg(test)]
mod tests {
    use super::*;

    /// The header is not more generous than it must be, so a wrong number in it is seen.
    #[test]
    fn no_object_has_eight_bytes_too_many() {
        for (object, taken) in OBJECTS {
            for (axes, bytes) in [1, 2, 3, 6].into_iter().zip(taken) {
                let provided = object.bytes(axes, size_of::<usize>());
                assert!(
                    provided < bytes + 8,
                    "{} of {axes}: {provided} for {bytes}",
                    object.name
                );
            }
        }
        assert!(INTERVAL_BYTES < size_of::<Interval>() + 8);
    }
}
