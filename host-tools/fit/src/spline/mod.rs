//! The default model: a smooth curve and gains of rate, second lag and plays, all fitted together.
//!
//! ```text
//! paths (core) -> points -> rows -> whitening -> evidence -+
//!       ^                                                  | search: lags, mixes, ridges, noise
//!       +--------------------------------------------------+
//! found lags -> core over all samples -> deployed -> fit: polynomials, sigmas
//! ```
//!
//! | modules | what they do |
//! | --- | --- |
//! | `lags`, `regressors` | two thermal lags and their mixes; what the model sees of each block |
//! | `whitening`, `drift` | white noise, noise of the angle and drift, taken apart |
//! | `sensor_noise` | how far the temperature of a block is from the truth |
//! | `evidence`, `ridges` | coefficients under ridges of the highest marginal likelihood |
//! | `lowest`, `tuning` | the most likely ridges and noise at some lags |
//! | `search` | the most likely lags and mixes |
//! | `deployed`, `fit`, `start` | the model on the core's own points, as it flies |
//! | `folds`, `held_out` | errors on soaks and ramps that were left out |
//! | `auto` | which terms the logs allow; the comparison with simpler models |

pub(crate) mod auto;
mod deployed;
mod drift;
mod evidence;
mod fit;
mod folds;
mod held_out;
mod lags;
mod lowest;
mod regressors;
mod ridges;
mod search;
mod sensor_noise;
mod start;
#[cfg(test)]
mod tests;
mod tuning;
mod whitening;
