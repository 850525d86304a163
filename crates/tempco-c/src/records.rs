//! Structures that C reads and writes, field by field as in `tempco.h`.

use tempco::{BiasRamp, MAX_AXES, PLAYS, Status, Terms, ThermalPoint, ThermalSettings};
use tempco_image::SERIAL_LEN;

/// `tempcoN_ramp_t`: a [`BiasRamp`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ramp<const AXES: usize> {
    /// The bias at the end \[unit of each axis\].
    pub end: [f32; AXES],
    /// Change per gyro sample \[unit of each axis\].
    pub slope: [f32; AXES],
    /// Gyro samples of the ramp.
    pub samples: u16,
    /// Flags.
    pub status: u16,
}

impl<const AXES: usize> Ramp<AXES> {
    /// The ramp of the core.
    #[inline(always)]
    pub(crate) const fn to_core(self) -> BiasRamp<AXES> {
        BiasRamp {
            end: self.end,
            slope: self.slope,
            samples: self.samples,
            status: Status::from_bits(self.status),
        }
    }
}

impl<const AXES: usize> From<BiasRamp<AXES>> for Ramp<AXES> {
    #[inline(always)]
    fn from(ramp: BiasRamp<AXES>) -> Self {
        Self {
            end: ramp.end,
            slope: ramp.slope,
            samples: ramp.samples,
            status: ramp.status.bits(),
        }
    }
}

/// `tempco_point_t`: a [`ThermalPoint`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Point {
    /// Lag-compensated temperature \[degC\].
    pub effective_c: f32,
    /// Rate of temperature \[degC/min\].
    pub rate_c_per_min: f32,
    /// Second lag \[degC\].
    pub lag2_c: f32,
    /// What each play is behind \[degC\].
    pub plays_c: [f32; PLAYS],
    /// Flags of the temperature.
    pub status: u16,
    /// Zero.
    pub reserved: u16,
}

impl From<ThermalPoint> for Point {
    #[inline(always)]
    fn from(point: ThermalPoint) -> Self {
        Self {
            effective_c: point.effective_c,
            rate_c_per_min: point.rate_c_per_min,
            lag2_c: point.lag2_c,
            plays_c: point.plays_c,
            status: point.status.bits(),
            reserved: 0,
        }
    }
}

/// `tempcoN_output_t`: an [`Output`](tempco::Output).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Output<const AXES: usize> {
    /// `raw - bias` \[unit of each axis\].
    pub compensated: [f32; AXES],
    /// The bias \[unit of each axis\].
    pub bias: [f32; AXES],
    /// Where the model was evaluated.
    pub point: Point,
    /// Flags.
    pub status: u16,
    /// Zero.
    pub reserved: u16,
}

impl<const AXES: usize> From<tempco::Output<AXES>> for Output<AXES> {
    #[inline(always)]
    fn from(output: tempco::Output<AXES>) -> Self {
        Self {
            compensated: output.compensated,
            bias: output.bias,
            point: output.point.into(),
            status: output.status.bits(),
            reserved: 0,
        }
    }
}

/// `tempco_axis_t`: an axis of `table.h`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Axis {
    /// Scale factor \[arcsec/pulse\].
    pub scale_factor_arcsec: f32,
    /// Standard deviation of fitted rows \[unit of the axis\].
    pub row_noise: f32,
    /// Interval of these rows \[s\].
    pub row_noise_interval_s: f32,
    /// How far re-zero may move the constant bias \[unit of the axis\].
    pub rezero_limit: f32,
    /// Gain of each play \[unit of the axis per degC\].
    pub play_gains: [f32; PLAYS],
}

/// `tempco_channel_t`: a temperature channel of `table.h`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Channel {
    /// Settings of the thermal path, in the order of [`ThermalSettings::NAMES`].
    pub thermal: ThermalSettings,
    /// Cold edge of the first cell \[degC\].
    pub first_edge_c: f32,
    /// Hot edge of the last cell \[degC\].
    pub last_edge_c: f32,
    /// Cold end of the calibrated range \[degC\].
    pub t_min_c: f32,
    /// Hot end of the calibrated range \[degC\].
    pub t_max_c: f32,
    /// Time between two temperatures of the fit \[s\].
    pub period_s: f32,
    /// Number of cells.
    pub cell_count: u32,
    /// Number of axes.
    pub axis_count: u32,
    /// The axes, then zeros.
    pub axes: [Axis; MAX_AXES],
    /// All axes of the coldest cell, then all of the next.
    pub cells: *const Terms,
}

/// `tempco_image_info_t`: what an image says of itself.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ImageInfo {
    /// Serial number of the unit, ended by zeros.
    pub serial: [u8; SERIAL_LEN + 1],
    /// Code of the unit of each axis, channel by channel; then 0.
    pub units: [u8; MAX_AXES],
    /// Zero.
    pub reserved: u8,
    /// Scale factor of each axis, likewise; 0 where it is not known \[arcsec/pulse\].
    pub scale_factors_arcsec: [f32; MAX_AXES],
    /// The CRC that names the set.
    pub table_crc: u32,
    /// Number of temperature channels.
    pub channels: u32,
    /// Number of axes of each channel.
    pub axes: u32,
}
