//! One axis of a channel: its unit, and what else is known of it.

use tempco::{MAX_AXES, PLAYS};

use crate::layout::RawAxis;
use crate::{ImageError, Unit};

/// What an image says of an axis beside its cells; not validated. A number that is not known or
/// not used is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Axis {
    /// Unit of the axis and so of its bias.
    pub unit: Unit,
    /// Scale factor \[arcsec/pulse\].
    pub scale_factor_arcsec: f32,
    /// Standard deviation of the noise of the rows that were fitted \[unit of the axis\].
    pub row_noise: f32,
    /// Interval of these rows \[s\].
    pub row_noise_interval_s: f32,
    /// How far re-zero may move the constant bias \[unit of the axis\].
    pub rezero_limit: f32,
    /// Gain of each play \[unit of the axis per degC\].
    pub play_gains: [f32; PLAYS],
}

impl Axis {
    /// An axis of which the unit alone is known.
    pub const fn new(unit: Unit) -> Self {
        Self {
            unit,
            scale_factor_arcsec: 0.0,
            row_noise: 0.0,
            row_noise_interval_s: 0.0,
            rezero_limit: 0.0,
            play_gains: [0.0; PLAYS],
        }
    }

    /// Up to [`MAX_AXES`] axes as a [`Channel`](crate::Channel) holds them; further ones are left
    /// out.
    pub fn array(axes: &[Self]) -> [Option<Self>; MAX_AXES] {
        core::array::from_fn(|axis| axes.get(axis).copied())
    }

    /// The name of the first number that is not finite or below zero. The core checks the gains.
    pub(crate) fn bad_number(&self) -> Option<&'static str> {
        let numbers = [
            (self.scale_factor_arcsec, "scale_factor_arcsec"),
            (self.row_noise, "row_noise"),
            (self.row_noise_interval_s, "row_noise_interval_s"),
            (self.rezero_limit, "rezero_limit"),
        ];
        let bad = numbers.into_iter().find(|(number, _)| !is_usable(*number));
        bad.map(|(_, name)| name)
    }

    pub(crate) fn from_raw(raw: &RawAxis) -> Result<Self, ImageError> {
        if raw.zeros != [0; 3] {
            return Err(ImageError::Field("unit"));
        }
        Ok(Self {
            unit: Unit::from_code(raw.unit).ok_or(ImageError::Field("unit"))?,
            scale_factor_arcsec: raw.scale_factor_arcsec.get(),
            row_noise: raw.row_noise.get(),
            row_noise_interval_s: raw.row_noise_interval_s.get(),
            rezero_limit: raw.rezero_limit.get(),
            play_gains: raw.play_gains.map(|gain| gain.get()),
        })
    }

    pub(crate) fn to_raw(self) -> RawAxis {
        RawAxis {
            unit: self.unit.code(),
            zeros: [0; 3],
            scale_factor_arcsec: self.scale_factor_arcsec.into(),
            row_noise: self.row_noise.into(),
            row_noise_interval_s: self.row_noise_interval_s.into(),
            rezero_limit: self.rezero_limit.into(),
            play_gains: self.play_gains.map(Into::into),
        }
    }
}

/// Whether a number is finite and not below zero.
pub(crate) fn is_usable(number: f32) -> bool {
    (0.0..=f32::MAX).contains(&number)
}
