//! Whether an image fits the board of a unit.

use core::fmt;

use crate::{Image, ImageError, Unit};

/// Scale factors that differ by no more than this share are the same: they were rounded to f32
/// in one way or another.
const SCALE_TOLERANCE: f32 = 4.0 * f32::EPSILON;

/// What a board that counts the pulses of a gyro expects of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fit {
    /// Unit of the axis. One of accelerations fits no such board.
    pub unit: Unit,
    /// By what the board turns pulses into angles; looked at where the unit is one of angles
    /// \[arcsec/pulse\].
    pub scale_factor_arcsec: f32,
    /// The largest bias \[unit of the axis\].
    pub max_bias: f32,
}

/// What does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Misfit {
    /// The unit is another, or no rate of a gyro.
    Unit,
    /// The scale factor is another, or the image does not say which.
    ScaleFactor,
    /// The bias may be too large.
    Bias,
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unit => "unit",
            Self::ScaleFactor => "scale factor",
            Self::Bias => "largest bias",
        })
    }
}

impl Image<'_> {
    /// Checks that every axis fits a board: unit, scale factor, largest bias
    /// ([`Channel::max_bias`](crate::Channel::max_bias)). One of `fits` for each axis, channel by
    /// channel. The contents must have been validated.
    ///
    /// # Errors
    /// [`ImageError::Unfit`], [`ImageError::Shape`] where the axes are not as many.
    pub fn expect_fit(&self, fits: &[Fit]) -> Result<(), ImageError> {
        if fits.len() != self.channels().saturating_mul(self.axes()) {
            return Err(ImageError::Shape);
        }
        // The number of the axis, channel by channel.
        let mut axis: usize = 0;
        for channel in 0..self.channels() {
            let channel = self.channel(channel)?;
            for number in 0..self.axes() {
                let record = channel.axes.get(number).copied().flatten();
                let (Some(record), Some(fit)) = (record, fits.get(axis)) else {
                    return Err(ImageError::Shape);
                };
                let misfit = |why| ImageError::Unfit { axis, why };
                let is_scaled = match record.unit {
                    unit if unit != fit.unit => return Err(misfit(Misfit::Unit)),
                    Unit::Mps2 | Unit::G => return Err(misfit(Misfit::Unit)),
                    Unit::PulsesPerS => true,
                    Unit::Dph | Unit::Dps | Unit::Radps => {
                        let expected = fit.scale_factor_arcsec;
                        let distance = (record.scale_factor_arcsec - expected).abs();
                        distance <= SCALE_TOLERANCE * expected
                    }
                };
                if !is_scaled {
                    return Err(misfit(Misfit::ScaleFactor));
                }
                // A limit that is no number lets nothing pass.
                if !(0.0..=fit.max_bias).contains(&channel.max_bias(number)) {
                    return Err(misfit(Misfit::Bias));
                }
                axis = axis.saturating_add(1);
            }
        }
        Ok(())
    }
}
