//! Temperatures on schedule, and what is wrong with the sensors.

use heapless::Vec;
use tempco_link::Fault;
use tempco_sensors::SensorFault;

use super::devices::Thermometers;

/// Readings of which the first temperature is the median: one bad conversion after power-on must
/// not become the start of the rate estimator.
const STARTING: usize = 3;

/// Readings without news after which a sensor counts as failed; until then its last temperature
/// stands for it.
const MAX_AGE: u8 = 3;

/// Readings after which the unit starts without a sensor that has given nothing yet.
const PATIENCE: u8 = 20;

/// The sensors, with what is known of each.
pub struct Thermometry<T, const C: usize> {
    thermometers: T,
    sensors: [Sensor; C],
    starting: Vec<[f32; C], STARTING>,
    tries: u8,
}

#[derive(Clone, Copy)]
struct Sensor {
    last_c: f32,
    /// Readings since the last news.
    age: u8,
    /// Equal readings in a row, after the first.
    equal: u32,
    fault: Option<Fault>,
}

impl<T: Thermometers<C>, const C: usize> Thermometry<T, C> {
    /// Sensors that have not been read yet.
    pub const fn new(thermometers: T) -> Self {
        let sensor = Sensor {
            last_c: f32::NAN,
            // The first conversion may still be under way.
            age: 0,
            equal: 0,
            fault: None,
        };
        Self {
            thermometers,
            sensors: [sensor; C],
            starting: Vec::new(),
            tries: 0,
        }
    }

    /// Reads every sensor; the temperatures for the compensator, NaN where there is none, or
    /// nothing while the sensors start \[degC\].
    pub fn read(&mut self) -> Option<[f32; C]> {
        let readings = self.thermometers.read();
        for (sensor, reading) in self.sensors.iter_mut().zip(readings) {
            sensor.take(reading, T::STUCK_AFTER);
        }
        let temps_c = self.sensors.each_ref().map(Sensor::temp_c);
        if self.starting.is_full() {
            return Some(temps_c);
        }
        self.tries = self.tries.saturating_add(1);
        if self.tries < PATIENCE && temps_c.iter().any(|temp_c| temp_c.is_nan()) {
            return None;
        }
        // Cannot fail: it is not full.
        _ = self.starting.push(temps_c);
        self.starting.is_full().then(|| self.median())
    }

    /// The temperatures of the last reading, for showing them \[degC\].
    pub fn temps_c(&self) -> [f32; C] {
        self.sensors.each_ref().map(Sensor::temp_c)
    }

    /// What is wrong with the sensors, with their channels.
    pub fn faults(&self) -> impl Iterator<Item = (Fault, u32)> {
        let faults = self.sensors.iter().zip(0..);
        faults.filter_map(|(sensor, channel)| Some((sensor.fault?, channel)))
    }

    fn median(&self) -> [f32; C] {
        core::array::from_fn(|channel| {
            let mut of_channel: Vec<f32, STARTING> = self
                .starting
                .iter()
                .map(|temps_c| temps_c[channel])
                .collect();
            of_channel.sort_unstable_by(f32::total_cmp);
            of_channel[STARTING / 2]
        })
    }
}

impl Sensor {
    fn take(&mut self, reading: Result<f32, SensorFault>, stuck_after: Option<u32>) {
        match reading {
            Ok(temp_c) => {
                let is_equal = temp_c.to_bits() == self.last_c.to_bits();
                self.equal = if is_equal {
                    self.equal.saturating_add(1)
                } else {
                    0
                };
                let is_stuck = stuck_after.is_some_and(|limit| self.equal >= limit);
                self.fault = is_stuck.then_some(Fault::SensorStuck);
                self.last_c = temp_c;
                self.age = 0;
            }
            // No conversion has ended: the next one will have.
            Err(SensorFault::NotReady) if self.age < MAX_AGE => self.age += 1,
            Err(error) => {
                self.fault = Some(match error {
                    SensorFault::Open => Fault::SensorOpen,
                    SensorFault::Short => Fault::SensorShort,
                    SensorFault::Rail => Fault::SensorRail,
                    _ => Fault::SensorBus,
                });
                self.age = MAX_AGE;
            }
        }
    }

    /// A sensor that is stuck has no temperature: the compensator then holds the last one, and
    /// says so.
    fn temp_c(&self) -> f32 {
        if self.fault.is_none() {
            self.last_c
        } else {
            f32::NAN
        }
    }
}
