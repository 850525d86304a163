//! How far the temperature of a block is from the truth: noise and steps of the sensor.

use tempco_log::median::median;

use crate::least_squares::Blocks;

/// Time on each side of the mean that a temperature is compared with \[s\]: over it a coarse sensor
/// makes steps in most ramps.
const BESIDE_S: f64 = 300.0;

/// Median of the square of a standard normal number.
pub(crate) const MEDIAN_OF_SQUARE: f64 = 0.454_936;

/// Temperatures about the mean of their log \[degC\], and the variance of their noise.
pub(crate) struct SensorNoise {
    pub(crate) temp_c: Vec<f64>,
    pub(crate) variance: f64,
}

/// From the distances of temperatures from the means around them, in which a ramp has no part. In
/// a soak a coarse sensor is silent, so only blocks that move count.
pub(crate) fn sensor_noise(blocks: &Blocks) -> SensorNoise {
    let all = &blocks.temp_c;
    let beside = blocks.steps_in(BESIDE_S);
    let mut squares = Vec::new();
    for at in beside..all.len().saturating_sub(beside) {
        let (first, last) = (at - beside, at + beside);
        let moves = (all[last] - all[first]).abs() > 1.0;
        if moves && blocks.blocks[first].log == blocks.blocks[last].log {
            let mean = all[first..=last].iter().sum::<f64>() / (last - first + 1) as f64;
            squares.push((all[at] - mean).powi(2));
        }
    }
    let logs = blocks.blocks.chunk_by(|a, b| a.log == b.log);
    let mut rest = &all[..];
    let mut temp_c = Vec::with_capacity(all.len());
    for log in logs {
        let (of_log, later) = rest.split_at(log.len());
        rest = later;
        let mean = of_log.iter().sum::<f64>() / log.len() as f64;
        temp_c.extend(of_log.iter().map(|of| of - mean));
    }
    SensorNoise {
        temp_c,
        variance: match squares.is_empty() {
            true => 0.0,
            false => median(&mut squares) / MEDIAN_OF_SQUARE,
        },
    }
}
