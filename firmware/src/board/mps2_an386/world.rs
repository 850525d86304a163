//! A world for the unit on UART1: a host plays a chamber with one thermometer and three gyros.
//!
//! The world is a sequence of points, one per reading of the thermometers. The unit asks for them, so
//! that the world keeps the unit's time, however fast that passes.
//!
//! | direction | bytes | meaning |
//! |---|---|---|
//! | to the host | `!` | begin with the point after the last one that was taken |
//! | | `+` | a point was taken |
//! | | `-` | there was none: the unit stays at the last one |
//! | to the unit | `0xa6` or `0xa5` | begins a point, the first one after `!` or a later one |
//! | | 4 | temperature of every channel, `f32`; NaN where the sensor is open \[degC\] |
//! | | 3 x 4 | what each gyro counts until the next point, `i32` \[2^-16 counts/sample\] |
//! | | 1 | sum of the bytes before it |
//!
//! Numbers have their low byte first. There is room for eight points that were not yet taken. What was
//! on its way when the unit was reset may repeat or skip some points.

use core::sync::atomic::{AtomicU32, Ordering};

use embedded_io::{Read as _, Write as _};
use heapless::{Deque, Vec};
use tempco::Status;
use tempco_sensors::SensorFault;

use super::played;
use super::uart::Uart;
use crate::unit::devices::{AtRest, Count, Gyro, Thermometers};

/// Points that may wait.
const AHEAD: usize = 8;

const FIRST: u8 = 0xa6;
const NEXT: u8 = 0xa5;

/// Readings after which the host is asked for the first point again.
const PATIENCE: u8 = 10;

const GYROS: usize = 3;
/// Bytes of a point.
const LEN: usize = 2 + 4 * (1 + GYROS);

/// What each gyro counts per sample \[2^-16\], in two's complement.
static RATES: [AtomicU32; GYROS] = [const { AtomicU32::new(0) }; GYROS];

/// From one reading to the next.
#[derive(Clone, Copy)]
struct Point {
    temp_c: f32,
    rates: [u32; GYROS],
}

/// The sensors, and the line to the host.
pub struct WorldThermometers {
    line: Uart,
    /// What has come of a point.
    received: Vec<u8, LEN>,
    points: Deque<Point, AHEAD>,
    /// None before the first point.
    temp_c: Option<f32>,
    /// Readings until the host is asked for the first point; none once it has come.
    asks_in: Option<u8>,
}

impl WorldThermometers {
    pub(super) const fn new(line: Uart) -> Self {
        Self {
            line,
            received: Vec::new(),
            points: Deque::new(),
            temp_c: None,
            asks_in: Some(0),
        }
    }

    fn receive(&mut self, byte: u8) {
        if self.received.is_empty() && !matches!(byte, FIRST | NEXT) {
            return;
        }
        // Cannot fail: it is emptied when full.
        _ = self.received.push(byte);
        let Ok(message) = self.received.clone().into_array::<LEN>() else {
            return;
        };
        self.received.clear();
        let Some(point) = point(&message) else {
            self.asks_in.get_or_insert(0);
            return;
        };
        if message[0] == FIRST {
            self.points.clear();
            self.asks_in = None;
        }
        if self.asks_in.is_none() && self.points.push_back(point).is_err() {
            self.asks_in = Some(0);
        }
    }

    /// Asks for the first point when it is time.
    fn ask(&mut self) {
        self.asks_in = match self.asks_in {
            Some(0) => {
                self.say(b'!');
                Some(PATIENCE)
            }
            Some(more) => Some(more - 1),
            None => None,
        };
    }

    fn say(&mut self, letter: u8) {
        // A UART cannot fail.
        _ = self.line.write_all(&[letter]);
    }

    fn take(&mut self, point: Point) {
        self.temp_c = Some(point.temp_c);
        for (rate, new) in RATES.iter().zip(point.rates) {
            rate.store(new, Ordering::Relaxed);
        }
    }
}

/// What a message says, if its sum is right.
fn point(message: &[u8; LEN]) -> Option<Point> {
    let [begin, numbers @ .., check] = message;
    let sum = |sum: u8, byte: &u8| sum.wrapping_add(*byte);
    if numbers.iter().fold(*begin, sum) != *check {
        return None;
    }
    let (words, _) = numbers.as_chunks();
    let [temp, rates @ ..]: [u32; 1 + GYROS] = <&[[u8; 4]; 1 + GYROS]>::try_from(words)
        .ok()?
        .map(u32::from_le_bytes);
    Some(Point {
        temp_c: f32::from_bits(temp),
        rates,
    })
}

impl<const C: usize> Thermometers<C> for WorldThermometers {
    /// Sensors of any resolution are played.
    const STUCK_AFTER: Option<u32> = None;

    fn read(&mut self) -> [Result<f32, SensorFault>; C] {
        let mut bytes = [0; 64];
        while let Ok(count @ 1..) = self.line.read(&mut bytes) {
            for byte in bytes.iter().take(count) {
                self.receive(*byte);
            }
        }
        self.ask();
        match self.points.pop_front() {
            Some(point) => {
                self.take(point);
                self.say(b'+');
            }
            None => self.say(b'-'),
        }
        let reading = match self.temp_c {
            None => Err(SensorFault::NotReady),
            Some(temp_c) if temp_c.is_nan() => Err(SensorFault::Open),
            Some(temp_c) => Ok(temp_c),
        };
        [reading; C]
    }
}

/// The gyros: whole counts, with the rest carried.
pub struct WorldGyro {
    /// Angle of each \[2^-16 counts\]; it wraps.
    angles: [u32; GYROS],
}

impl WorldGyro {
    pub(super) const fn new() -> Self {
        Self { angles: [0; GYROS] }
    }
}

impl<const C: usize, const A: usize> Gyro<C, A> for WorldGyro {
    const COUNTS: [[Count; A]; C] = [[Count::Pulses(1.0); A]; C];
    const SCALE_FACTOR_ARCSEC: f32 = 1.0;
    const AT_REST: AtRest = played::AT_REST;
    const MAX_TABLE_BIAS: f32 = played::MAX_TABLE_BIAS;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        let mut counts = self.angles.iter_mut().zip(&RATES).map(|(angle, rate)| {
            let before = *angle >> 16;
            *angle = angle.wrapping_add(rate.load(Ordering::Relaxed));
            // The upper halves wrap as counters of 16 bits do.
            i32::from((*angle >> 16).wrapping_sub(before) as i16)
        });
        let each = |_| core::array::from_fn(|_| counts.next().unwrap_or(0));
        Some(core::array::from_fn(each))
    }

    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]) {
        played::put(compensated, status);
    }
}
