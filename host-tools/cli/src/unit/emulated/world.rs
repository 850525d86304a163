//! Chamber and gyros of the emulated unit, played from a simulation.
//!
//! What goes over the line is described in `firmware/src/board/mps2_an386/world.rs`.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::iter::Peekable;

use tempco_twin::{Output, Sample, Simulation};

/// Points per second of the unit's time, as often as it reads its thermometers.
pub(super) const RATE_HZ: f64 = 10.0;

/// Gyro samples of the unit from one point to the next.
const SAMPLES: i64 = 200;

/// Points that are sent before they are taken; the unit has room for eight.
const AHEAD: usize = 6;

const GYROS: usize = 3;
/// What of a point follows its first byte.
type Numbers = [u8; 4 * (1 + GYROS)];

/// A world that a unit asks for, point by point. After the last one it stays as it is.
pub(super) struct World {
    run: Peekable<Simulation>,
    last: Sample,
    /// Counts of the gyro per count of the simulation.
    counts_per_step: f64,
    /// Sent, and not yet taken.
    sent: VecDeque<Numbers>,
    /// Angle that each gyro has not yet turned \[2^-16 counts\].
    owed: [f64; GYROS],
}

impl World {
    /// The world of a simulation of [`RATE_HZ`]. Its pulses become counts; a rate becomes counts of
    /// one arc second, the scale factor of the emulated gyro. None of a simulation without samples.
    pub(super) fn new(mut run: Simulation) -> Option<Self> {
        let unit = run.unit();
        let counts_per_step = match unit.output {
            Output::Pulses { .. } => 1.0,
            Output::Rate { step, .. } => {
                step * unit.output.arcsec_per_angle(unit.rate_unit) / RATE_HZ
            }
        };
        Some(Self {
            last: run.next()?,
            run: run.peekable(),
            counts_per_step,
            sent: VecDeque::new(),
            owed: [0.0; GYROS],
        })
    }

    /// Answers the unit until the line ends.
    ///
    /// # Errors
    /// The line fails.
    pub(super) fn serve(&mut self, mut line: impl Read + Write) -> io::Result<()> {
        let mut block = [0; 64];
        loop {
            let count = line.read(&mut block)?;
            if count == 0 {
                return Ok(());
            }
            for letter in &block[..count] {
                match letter {
                    b'!' => {
                        while self.sent.len() < AHEAD {
                            let next = self.next_point();
                            self.sent.push_back(next);
                        }
                        for (number, point) in self.sent.iter().enumerate() {
                            line.write_all(&message(if number == 0 { 0xa6 } else { 0xa5 }, point))?;
                        }
                    }
                    b'+' => {
                        self.sent.pop_front();
                        let next = self.next_point();
                        self.sent.push_back(next);
                        line.write_all(&message(0xa5, &next))?;
                    }
                    _ => {}
                }
            }
        }
    }

    /// The temperature now, and what the gyros turn until the next point.
    fn next_point(&mut self) -> Numbers {
        let temp_c = self.last.temp_c as f32;
        if let Some(next) = self.run.next() {
            self.last = next;
        }
        let mut numbers = [0; _];
        numbers[..4].copy_from_slice(&temp_c.to_le_bytes());
        for (axis, place) in numbers[4..].chunks_exact_mut(4).enumerate() {
            self.owed[axis] += self.last.counts[axis] as f64 * self.counts_per_step * 65_536.0;
            let rate = (self.owed[axis] / SAMPLES as f64).round() as i32;
            self.owed[axis] -= (i64::from(rate) * SAMPLES) as f64;
            place.copy_from_slice(&rate.to_le_bytes());
        }
        numbers
    }
}

fn message(begin: u8, numbers: &Numbers) -> Vec<u8> {
    let mut message = vec![begin];
    message.extend(numbers);
    message.push(message.iter().fold(0, |sum, byte| sum.wrapping_add(*byte)));
    message
}
