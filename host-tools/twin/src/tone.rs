//! Tones in the angle that the gyros report: dither that was not taken out, or vibration.

use serde::Deserialize;

use crate::check::{Invalid, Range};
use crate::normal::{NormalSource, Stream};

/// A tone that all axes see, each with its own amplitude.
///
/// It is a tone of the angle at the sampling instants, so that one above half the sample rate
/// appears at its alias, as it does on a real unit.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tone {
    /// Frequency, Hz, 1e-6 to 1e5.
    pub frequency_hz: f64,
    /// Amplitude of the angle seen by the X, Y and Z gyro, rate unit times s.
    pub amplitude: [f64; 3],
    /// Sigma of a slow wandering of the frequency, Hz.
    #[serde(default)]
    pub wander_hz: f64,
    /// Correlation time of the wandering, s, 1 to 1e6.
    #[serde(default = "default_wander_time_s")]
    pub wander_time_s: f64,
}

const fn default_wander_time_s() -> f64 {
    100.0
}

impl Tone {
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Range::FREQUENCY.check("frequency_hz", self.frequency_hz)?;
        for amplitude in self.amplitude {
            Range::SIGNED.check("amplitude", amplitude)?;
        }
        Range::new(0.0, 0.5 * self.frequency_hz).check("wander_hz", self.wander_hz)?;
        Range::new(1.0, 1e6).check("wander_time_s", self.wander_time_s)
    }
}

/// Phase of a tone as a function of time alone: its frequency is drawn once per second of simulated
/// time and changes on straight lines.
#[derive(Debug, Clone)]
pub(crate) struct ToneState {
    tone: Tone,
    noise: NormalSource,
    decay: f64,
    /// Whole second at which `turns` and `offset_hz` hold.
    second: f64,
    /// Phase, 0 to 1.
    turns: f64,
    offset_hz: f64,
    next_offset_hz: f64,
}

impl ToneState {
    pub(crate) fn new(tone: &Tone, seed: u64, index: usize) -> Self {
        let mut noise = NormalSource::new(seed, Stream::Tone(index));
        let turns = 0.5 * (noise.symmetric() + 1.0);
        let mut state = Self {
            tone: *tone,
            decay: libm::exp(-1.0 / tone.wander_time_s),
            second: 0.0,
            turns,
            offset_hz: tone.wander_hz * noise.next(),
            next_offset_hz: 0.0,
            noise,
        };
        state.next_offset_hz = state.draw();
        state
    }

    fn draw(&mut self) -> f64 {
        let sigma_hz = self.tone.wander_hz * (1.0 - self.decay * self.decay).sqrt();
        self.decay * self.offset_hz + sigma_hz * self.noise.next()
    }

    /// Turns since the whole second.
    fn turns_since(&self, time_s: f64) -> f64 {
        let bend_hz = 0.5 * (self.next_offset_hz - self.offset_hz) * time_s;
        (self.tone.frequency_hz + self.offset_hz + bend_hz) * time_s
    }

    /// Angle that each axis sees at a time not before the last call's.
    pub(crate) fn angle_at(&mut self, time_s: f64) -> [f64; 3] {
        while self.second + 1.0 <= time_s {
            let turns = self.turns + self.turns_since(1.0);
            self.turns = turns - turns.floor();
            self.second += 1.0;
            self.offset_hz = self.next_offset_hz;
            self.next_offset_hz = self.draw();
        }
        let turns = self.turns + self.turns_since(time_s - self.second);
        let wave = libm::sin(core::f64::consts::TAU * (turns - turns.floor()));
        self.tone.amplitude.map(|amplitude| amplitude * wave)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_tone_is_a_sine_at_any_rate() {
        let tone = Tone {
            frequency_hz: 2.3,
            amplitude: [1.0, -0.5, 0.0],
            wander_hz: 0.0,
            wander_time_s: 100.0,
        };
        let mut state = ToneState::new(&tone, 1, 0);
        let phase = state.turns;
        for i in 0..10_000 {
            let time_s = f64::from(i) / 64.0;
            let expected = (core::f64::consts::TAU * (phase + 2.3 * time_s)).sin();
            let [x, y, z] = state.angle_at(time_s);
            assert!((x - expected).abs() < 1e-9, "{time_s} s: {x} {expected}");
            assert_eq!((y, z), (-0.5 * x, 0.0));
        }
    }

    #[test]
    fn the_frequency_wanders_by_the_stated_sigma() {
        let tone = Tone {
            frequency_hz: 5.0,
            amplitude: [1.0; 3],
            wander_hz: 0.1,
            wander_time_s: 20.0,
        };
        let mut state = ToneState::new(&tone, 1, 0);
        let mut square = 0.0;
        for second in 0..100_000 {
            state.angle_at(f64::from(second));
            square += state.offset_hz * state.offset_hz;
        }
        let sigma_hz = (square / 1e5).sqrt();
        assert!((sigma_hz / 0.1 - 1.0).abs() < 0.05, "{sigma_hz}");
    }
}
