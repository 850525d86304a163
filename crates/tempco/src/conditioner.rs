//! Decides which temperatures to believe, before anything is differentiated.

use core::hint::select_unpredictable;

use crate::interval::Interval;
use crate::{Status, Thermal};

/// The last believed temperature and the memory of faults.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Conditioner {
    temp_c: f32,
    /// How far from the last believed temperature the present one may lie \[degC\]. It widens at
    /// the maximum slew while nothing is believed, so it is also the age of `temp_c`.
    gate_c: f32,
    /// Time for which the status still says settling \[s\].
    settling_s: f32,
    pub(crate) rejected: u32,
    pub(crate) restarts: u32,
}

/// A temperature to go on with.
pub(crate) struct Conditioned {
    /// The present temperature if believed, else the last one that was \[degC\].
    pub(crate) temp_c: f32,
    /// The temperature is a new beginning: no rate may be derived from the step to it.
    pub(crate) restart: bool,
    /// Nothing was believed for longer than the hold time.
    pub(crate) lost: bool,
    pub(crate) status: Status,
}

impl Conditioner {
    pub(crate) const fn new(reference_c: f32) -> Self {
        Self {
            temp_c: reference_c,
            gate_c: f32::INFINITY,
            settling_s: 0.0,
            rejected: 0,
            restarts: 0,
        }
    }

    /// A temperature is believed if the sensor can report it and the part can have reached it
    /// since the last believed one. NaN fails the first comparison.
    #[inline]
    pub(crate) fn update(
        &mut self,
        thermal: &Thermal,
        interval: &Interval,
        temp_c: f32,
    ) -> Conditioned {
        let settings = &thermal.settings;
        let was_lost = self.gate_c > thermal.lost_gate_c;
        let gate_c = self.gate_c + interval.slew_c;
        let jump = temp_c - self.temp_c;
        let jump = if jump < 0.0 { -jump } else { jump };

        // `&` and `|` on purpose: all of it is computed for every sample.
        let in_range = (temp_c >= settings.sensor_min_c) & (temp_c <= settings.sensor_max_c);
        let believed = in_range & (was_lost | (jump <= gate_c));
        let stepped = jump > settings.spike_gate_c + interval.slew_c;
        let restart = believed & (was_lost | stepped | interval.restart);

        // Plain conditions on `believed` would be gathered into one branch.
        self.temp_c = select_unpredictable(believed, temp_c, self.temp_c);
        self.gate_c = select_unpredictable(believed, settings.spike_gate_c, gate_c);
        let lost = self.gate_c > thermal.lost_gate_c;

        let heal_s = select_unpredictable(believed, 0.0, settings.heal_s);
        let left_s = self.settling_s - interval.dt_s;
        let settling_s = if left_s > heal_s { left_s } else { heal_s };
        self.settling_s = if restart {
            thermal.settle_s
        } else {
            settling_s
        };

        self.rejected = self.rejected.wrapping_add(u32::from(!believed));
        self.restarts = self.restarts.wrapping_add(u32::from(restart));

        Conditioned {
            temp_c: self.temp_c,
            restart,
            lost,
            status: interval.status
                | Status::TEMPERATURE_INVALID.when(!in_range)
                | Status::TEMPERATURE_SPIKE.when(in_range & !believed)
                | Status::TEMPERATURE_LOST.when(lost)
                | Status::SETTLING.when(self.settling_s > 0.0),
        }
    }
}
