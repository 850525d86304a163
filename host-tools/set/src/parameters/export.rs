//! A set as parameters, and what they lose of it.

use tempco::{PLAYS, Terms, ThermalPoint};
use tempco_log::AxisUnit;

use super::cubic::{Cubics, nearest};
use super::{AXES, Autopilot, to_rad_per_s};
use crate::{ChannelSet, CoefficientSet};

/// Temperatures over which a cubic is fitted and compared.
const POINTS: usize = 2001;

/// A text of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The contents of the file.
    pub text: String,
    /// What it loses, axis by axis.
    pub losses: Vec<Loss>,
}

/// What the parameters of an axis lose of its table \[unit of the axis\].
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// Name of the axis in the set.
    pub axis: String,
    /// Its unit.
    pub unit: AxisUnit,
    /// Range of the bias at rest over the calibrated temperatures.
    pub static_range: f64,
    /// Largest difference between the bias at rest and the cubic.
    pub largest: f64,
    /// Root mean square of this difference, every temperature counting the same.
    pub rms: f64,
    /// The most that rate, second lag and plays add to the bias within their calibrated ranges, which
    /// is lost as a whole.
    pub rate_and_history: f64,
}

/// Writes a set as parameters of a gyro. `device_id` is the one of the sensor, for PX4.
///
/// # Errors
/// A set that is not of three gyro axes at one temperature, in a unit of angle; an instance that the
/// autopilot does not have; a range that it refuses.
pub fn export_parameters(
    set: &CoefficientSet,
    autopilot: Autopilot,
    instance: u32,
    device_id: i32,
) -> Result<Exported, String> {
    let instances = autopilot.instances();
    if !instances.contains(&instance) {
        let (first, last) = (instances.start(), instances.end());
        return Err(format!("instance {instance}: expected {first} to {last}"));
    }
    let (channel, axes) = gyro(set)?;
    let table = &channel.table;
    let range_c = (f64::from(table.t_min_c), f64::from(table.t_max_c));
    if autopilot == Autopilot::ArduPilot && range_c.1 - range_c.0 < 10.0 {
        return Err(
            "the calibrated range is shorter than the 10 degC that ArduPilot asks for".to_owned(),
        );
    }
    let mut cubics = Cubics {
        centre_c: 0.5 * (range_c.0 + range_c.1),
        range_c,
        axes: [[0.0; 4]; AXES.len()],
    };
    let mut curves = Vec::new();
    for (&axis, cubic) in axes.iter().zip(&mut cubics.axes) {
        let factor = to_rad_per_s(channel.axes[axis].unit)?;
        let curve = at_rest(channel, axis, range_c)?;
        let in_rad_per_s: Vec<f64> = curve.iter().map(|bias| factor * bias).collect();
        *cubic = nearest(&in_rad_per_s, range_c);
        curves.push((axis, factor, curve));
    }
    let losses = curves
        .iter()
        .enumerate()
        .map(|(number, (axis, factor, curve))| {
            let pairs = curve.iter().zip(temps_c(range_c));
            let differences = pairs.map(|(bias, temp_c)| bias - cubics.at(number, temp_c) / factor);
            let differences: Vec<f64> = differences.collect();
            let squares: f64 = differences.iter().map(|of| of * of).sum();
            Loss {
                axis: channel.axes[*axis].name.clone(),
                unit: channel.axes[*axis].unit,
                static_range: table.static_range(*axis),
                largest: differences.iter().map(|of| of.abs()).fold(0.0, f64::max),
                rms: (squares / POINTS as f64).sqrt(),
                rate_and_history: rate_and_history(channel, *axis),
            }
        });
    Ok(Exported {
        losses: losses.collect(),
        text: autopilot.write(&cubics, instance, device_id),
    })
}

/// The channel of a gyro, and where its axes x, y and z stand in it.
fn gyro(set: &CoefficientSet) -> Result<(&ChannelSet, [usize; AXES.len()]), String> {
    let [channel] = &set.channels[..] else {
        return Err(
            "the axes have temperatures of their own: expected one for all axes".to_owned(),
        );
    };
    let mut places = [0; AXES.len()];
    for (name, place) in AXES.iter().zip(&mut places) {
        let is_axis = |axis: &crate::AxisSet| {
            !axis.unit.is_acceleration() && axis.name.to_lowercase().ends_with(name)
        };
        let mut found = channel
            .axes
            .iter()
            .enumerate()
            .filter(|(_, axis)| is_axis(axis));
        *place = match (found.next(), found.next()) {
            (Some((place, _)), None) => place,
            _ => {
                return Err(format!(
                    "expected one gyro axis with a name that ends with {name}"
                ));
            }
        };
    }
    Ok((channel, places))
}

/// Temperatures that are evenly spread over a range.
fn temps_c((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    let share = |point: usize| point as f64 / (POINTS - 1) as f64;
    (0..POINTS).map(move |point| low + share(point) * (high - low))
}

/// The bias at rest of an axis over the calibrated range, as the core computes it: without rate, lag
/// and pull of the plays.
fn at_rest(channel: &ChannelSet, axis: usize, range_c: (f64, f64)) -> Result<Vec<f64>, String> {
    let biases = channel.table.with_axis(axis, |table| {
        let bias = |temp_c: f64| {
            let point = ThermalPoint {
                effective_c: temp_c as f32,
                ..ThermalPoint::default()
            };
            f64::from(table.bias(&point).0[0])
        };
        temps_c(range_c).map(bias).collect()
    });
    biases.map_err(|error| error.to_string())
}

/// The most that the terms of rate, second lag and plays add.
fn rate_and_history(channel: &ChannelSet, axis: usize) -> f64 {
    let table = &channel.table;
    let thermal = &table.thermal;
    let largest = |low: f32, high: f32| f64::from(low.abs().max(high.abs()));
    let rate = largest(thermal.rate_min_c_per_min, thermal.rate_max_c_per_min);
    let lag2_c = largest(thermal.lag2_min_c, thermal.lag2_max_c);
    let of_cell = |terms: &Terms| {
        [0.0, 1.0].map(|z: f64| {
            let at = |c: &[f32; 2]| (f64::from(c[0]) + z * f64::from(c[1])).abs();
            rate * at(&terms.r) + lag2_c * at(&terms.s)
        })
    };
    let cells = table.cells.iter().flat_map(|cell| of_cell(&cell[axis]));
    let plays = (0..PLAYS).map(|play| {
        let gain = f64::from(table.play_gains[axis][play].abs());
        gain * f64::from(table.half_widths_c()[play])
    });
    cells.fold(0.0, f64::max) + plays.sum::<f64>()
}
