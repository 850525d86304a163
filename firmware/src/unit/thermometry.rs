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
    /// Interrupts of the timer at the last reading, and the number of readings.
    read_at: u32,
    readings: u32,
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
            age: 0,
            equal: 0,
            fault: None,
        };
        Self {
            thermometers,
            sensors: [sensor; C],
            starting: Vec::new(),
            tries: 0,
            read_at: 0,
            readings: 0,
        }
    }

    /// Whether to read now, given the number of interrupts of the timer and the schedule.
    pub fn is_due(&mut self, ticks: u32, samples_per_update: u16) -> bool {
        let period = u32::from(samples_per_update).max(1);
        // After a long stall the readings that were missed are not made up for.
        let periods = ticks.wrapping_sub(self.read_at) / period;
        self.read_at = self.read_at.wrapping_add(periods * period);
        periods > 0
    }

    /// The number of readings since power-on.
    pub const fn readings(&self) -> u32 {
        self.readings
    }

    /// Reads every sensor. The temperatures for the thermal half, NaN where there is none, or nothing
    /// while the sensors start \[degC\].
    pub fn read(&mut self) -> Option<[f32; C]> {
        self.readings = self.readings.wrapping_add(1);
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

#[cfg(test)]
mod tests {
    use super::*;

    struct Script<'s>(&'s [Result<f32, SensorFault>]);

    impl Thermometers<1> for Script<'_> {
        const STUCK_AFTER: Option<u32> = None;

        fn read(&mut self) -> [Result<f32, SensorFault>; 1] {
            let (first, rest) = self.0.split_first().unwrap();
            self.0 = rest;
            [*first]
        }
    }

    #[test]
    fn the_first_temperature_is_the_median_of_three() {
        let not_ready = Err(SensorFault::NotReady);
        let script = [not_ready, Ok(80.0), Ok(25.0), Ok(25.5), Ok(25.6), not_ready];
        let mut thermometry = Thermometry::new(Script(&script));
        let found: [Option<[f32; 1]>; 6] = core::array::from_fn(|_| thermometry.read());
        let expected = [None, None, None, Some([25.5]), Some([25.6]), Some([25.6])];
        assert_eq!(found, expected);
        assert_eq!(thermometry.faults().count(), 0);
    }

    #[test]
    fn a_sensor_that_never_answers_is_not_waited_for() {
        let script = [Err(SensorFault::NotReady); 30];
        let mut thermometry = Thermometry::new(Script(&script));
        let waited = (0..30).take_while(|_| thermometry.read().is_none()).count();
        assert_eq!(waited, usize::from(PATIENCE) + 1);
        assert_eq!(thermometry.faults().next(), Some((Fault::SensorBus, 0)));
    }
}
