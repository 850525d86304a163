//! The functions of each number of axes. `tempco_axes.h` declares them in the same order.

use tempco::{
    BiasRamp, Compensator, Corrector, Interval, PulseCorrector, PulseRamp, RampBuffer, Table,
    ThermalHalf,
};

use crate::error::code;
use crate::place::{get, put};
use crate::{Channel, Output, Point, Ramp, table};

macro_rules! axes {
    ($($module:ident: $axes:literal;)+) => {$(
        #[doc = concat!("The functions of ", $axes, " axes, `tempco", $axes, "_...` for C.")]
        #[allow(clippy::missing_safety_doc, reason = "the header says what holds for all of them")]
        pub mod $module {
            use super::*;

            type Gains = [f32; $axes];
            type PulseRamps = RampBuffer<$axes, i32>;

            /// A table whose cells lie in a flash image.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_table_from_image"))]
            pub unsafe extern "C" fn table_from_image(
                table: *mut Table<'static, $axes>,
                image: *const u32,
                length: usize,
                channel: u32,
            ) -> i32 {
                // SAFETY: pointers are checked, and the caller vouches for what they point to.
                code(unsafe {
                    table::from_image(image, length, channel).and_then(|made| put(table, made))
                })
            }

            /// A table whose cells lie in `table.h`.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_table_from_channel"))]
            pub unsafe extern "C" fn table_from_channel(
                table: *mut Table<'static, $axes>,
                channel: *const Channel,
            ) -> i32 {
                // SAFETY: as above.
                code(unsafe { table::from_channel(channel).and_then(|made| put(table, made)) })
            }

            /// The factors of a time between two thermal updates.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_interval_init"))]
            pub unsafe extern "C" fn interval_init(
                interval: *mut Interval,
                table: *const Table<'static, $axes>,
                dt_s: f32,
            ) -> i32 {
                // SAFETY: as above.
                code(unsafe {
                    get(table).and_then(|table| put(interval, Interval::new(table.thermal(), dt_s)))
                })
            }

            /// A thermal half before its first temperature.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_thermal_init"))]
            pub unsafe extern "C" fn thermal_init(
                half: *mut ThermalHalf<'static, $axes>,
                table: *const Table<'static, $axes>,
                samples_per_update: u16,
            ) -> i32 {
                // SAFETY: as above.
                code(unsafe {
                    get(table)
                        .and_then(|table| put(half, ThermalHalf::new(table, samples_per_update)))
                })
            }

            /// A buffer without a ramp.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_ramps_init"))]
            pub unsafe extern "C" fn ramps_init(ramps: *mut RampBuffer<$axes>) -> i32 {
                // SAFETY: as above.
                code(unsafe { put(ramps, RampBuffer::new()) })
            }

            /// A buffer without a ramp, of pulses.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_pulse_ramps_init"))]
            pub unsafe extern "C" fn pulse_ramps_init(ramps: *mut PulseRamps) -> i32 {
                // SAFETY: as above.
                code(unsafe { put(ramps, RampBuffer::new()) })
            }

            /// The reader of a buffer of pulses.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_pulses_init"))]
            pub unsafe extern "C" fn pulses_init(
                pulses: *mut PulseCorrector<'static, $axes>,
                ramps: *const PulseRamps,
            ) -> i32 {
                // SAFETY: as above.
                code(unsafe {
                    get(ramps).and_then(|ramps| put(pulses, PulseCorrector::new(ramps)))
                })
            }

            /// A compensator before its first temperature.
            #[cold]
            #[unsafe(export_name = concat!("tempco", $axes, "_compensator_init"))]
            pub unsafe extern "C" fn compensator_init(
                compensator: *mut Compensator<'static, $axes>,
                table: *const Table<'static, $axes>,
            ) -> i32 {
                // SAFETY: as above.
                code(unsafe {
                    get(table).and_then(|table| put(compensator, Compensator::new(table)))
                })
            }

            /// The constant bias.
            #[unsafe(export_name = concat!("tempco", $axes, "_thermal_constant"))]
            pub extern "C" fn thermal_constant(
                table: &Table<'static, $axes>,
                ramp: &mut Ramp<$axes>,
            ) {
                *ramp = ThermalHalf::constant(table).into();
            }

            /// The first temperature.
            #[unsafe(export_name = concat!("tempco", $axes, "_thermal_start"))]
            pub extern "C" fn thermal_start(
                half: &mut ThermalHalf<'static, $axes>,
                temp_c: f32,
                ramp: &mut Ramp<$axes>,
            ) {
                *ramp = half.start(temp_c).into();
            }

            /// A temperature.
            #[unsafe(export_name = concat!("tempco", $axes, "_thermal_update"))]
            pub extern "C" fn thermal_update(
                half: &mut ThermalHalf<'static, $axes>,
                interval: &Interval,
                temp_c: f32,
                ramp: &mut Ramp<$axes>,
            ) {
                *ramp = half.update(interval, temp_c).into();
            }

            /// Where the model was evaluated.
            #[unsafe(export_name = concat!("tempco", $axes, "_thermal_point"))]
            pub extern "C" fn thermal_point(
                half: &ThermalHalf<'static, $axes>,
                point: &mut Point,
            ) {
                *point = half.point().into();
            }

            /// Temperatures rejected since the start.
            #[unsafe(export_name = concat!("tempco", $axes, "_thermal_rejected"))]
            pub extern "C" fn thermal_rejected(half: &ThermalHalf<'static, $axes>) -> u32 {
                half.thermal_state().rejected()
            }

            /// Hands a ramp to the sample half.
            #[unsafe(export_name = concat!("tempco", $axes, "_publish"))]
            pub extern "C" fn publish(ramps: &RampBuffer<$axes>, ramp: &Ramp<$axes>) {
                ramps.publish(&ramp.to_core());
            }

            /// Hands a ramp to the sample half of pulses.
            #[unsafe(export_name = concat!("tempco", $axes, "_pulse_publish"))]
            pub extern "C" fn pulse_publish(
                ramps: &PulseRamps,
                ramp: &Ramp<$axes>,
                pulses_per_unit: &Gains,
            ) {
                let ramp: BiasRamp<$axes> = ramp.to_core();
                ramps.publish(&PulseRamp::new(&ramp, *pulses_per_unit));
            }

            /// One gyro sample.
            #[unsafe(export_name = concat!("tempco", $axes, "_correct"))]
            pub extern "C" fn correct(ramps: &RampBuffer<$axes>, sample: &mut [f32; $axes]) {
                *sample = Corrector::new(ramps).correct(*sample);
            }

            /// A FIFO's worth of gyro samples.
            #[unsafe(export_name = concat!("tempco", $axes, "_correct_block"))]
            pub unsafe extern "C" fn correct_block(
                ramps: &RampBuffer<$axes>,
                block: *mut [f32; $axes],
                count: u16,
            ) {
                // SAFETY: the caller vouches for it.
                let block = unsafe { core::slice::from_raw_parts_mut(block, count.into()) };
                Corrector::new(ramps).correct_slice(block);
            }

            /// Flags as of the last gyro sample.
            #[unsafe(export_name = concat!("tempco", $axes, "_status"))]
            pub extern "C" fn status(ramps: &RampBuffer<$axes>) -> u16 {
                Corrector::new(ramps).status().bits()
            }

            /// One gyro sample in whole pulses.
            #[unsafe(export_name = concat!("tempco", $axes, "_pulses_correct"))]
            pub extern "C" fn pulses_correct(
                pulses: &mut PulseCorrector<'static, $axes>,
                sample: &mut [i32; $axes],
            ) {
                *sample = pulses.correct(*sample);
            }

            /// Flags as of the last gyro sample in pulses.
            #[unsafe(export_name = concat!("tempco", $axes, "_pulses_status"))]
            pub extern "C" fn pulses_status(pulses: &PulseCorrector<'static, $axes>) -> u16 {
                pulses.status().bits()
            }

            /// The first temperature of a compensator.
            #[unsafe(export_name = concat!("tempco", $axes, "_start"))]
            pub extern "C" fn start(compensator: &mut Compensator<'static, $axes>, temp_c: f32) {
                compensator.start(temp_c);
            }

            /// A temperature and a gyro sample.
            #[unsafe(export_name = concat!("tempco", $axes, "_step"))]
            pub extern "C" fn step(
                compensator: &mut Compensator<'static, $axes>,
                interval: &Interval,
                temp_c: f32,
                raw: &[f32; $axes],
                output: &mut Output<$axes>,
            ) {
                *output = compensator.step(interval, temp_c, *raw).into();
            }
        }
    )+};
}

axes! {
    axes1: 1;
    axes2: 2;
    axes3: 3;
    axes6: 6;
}
