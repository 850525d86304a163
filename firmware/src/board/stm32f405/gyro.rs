//! The gyro: pulses in quadrature, counted by timers.
//!
//! The read-out of a ring laser gyro gives two square waves a quarter of a period apart, whose order
//! is the sense of rotation. Timers in encoder mode count all four edges of a period, so a count is
//! a quarter of the scale factor of a pulse. A sample is the difference of two readings, whatever
//! wraps in between.

use stm32f4xx_hal::gpio::{Output, PA0, PA1, PA15, PB3, PB6, PB7, PC8, PushPull};
use stm32f4xx_hal::pac::{TIM2, TIM4, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::Rcc;
use tempco::Status;

use super::{AXES, frame, output};
use crate::unit::devices::{AtRest, Count, Gyro};

/// What the counters are made of.
pub(super) struct Parts {
    pub(super) x: (TIM2, PA15, PB3),
    pub(super) y: (TIM5, PA0, PA1),
    pub(super) z: (TIM4, PB6, PB7),
    pub(super) data_ready: PC8,
    pub(super) output: output::Output,
}

/// Three counters, and what the samples become.
pub struct Counters {
    x: Qei<TIM2>,
    y: Qei<TIM5>,
    z: Qei<TIM4>,
    last: (u32, u32, u16),
    /// High from the moment of the sample until its frame is on its way.
    data_ready: PC8<Output<PushPull>>,
    output: output::Output,
    number: u16,
}

impl Counters {
    pub(super) fn new(parts: Parts, rcc: &mut Rcc) -> Self {
        let Parts { x, y, z, .. } = parts;
        Self {
            x: Qei::new(x.0, (x.1, x.2), rcc),
            y: Qei::new(y.0, (y.1, y.2), rcc),
            z: Qei::new(z.0, (z.1, z.2), rcc),
            last: (0, 0, 0),
            data_ready: parts.data_ready.into_push_pull_output(),
            output: parts.output,
            number: 0,
        }
    }

    fn differences(&mut self) -> [i32; AXES] {
        let now = (self.x.count(), self.y.count(), self.z.count());
        let last = core::mem::replace(&mut self.last, now);
        [
            now.0.wrapping_sub(last.0).cast_signed(),
            now.1.wrapping_sub(last.1).cast_signed(),
            now.2.wrapping_sub(last.2).cast_signed().into(),
        ]
    }
}

impl<const C: usize, const A: usize> Gyro<C, A> for Counters {
    /// Every edge of two waves counts.
    const COUNTS: [[Count; A]; C] = [[Count::Pulses(0.25); A]; C];

    const SCALE_FACTOR_ARCSEC: f32 = 1.0;

    /// An edge more or less in a tenth of a second is 10 counts/s; 25 pulses/s are the Earth's rate
    /// and a bias of 10 deg/h.
    const AT_REST: AtRest = AtRest {
        sigma: 10.0,
        max_bias: 100.0,
    };

    /// 100 pulses/s, or 100 deg/h.
    const MAX_TABLE_BIAS: f32 = 400.0;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        const { assert!(C * A <= AXES, "the board has three axes") };
        let mut axes = self.differences().into_iter();
        self.data_ready.set_high();
        let each = |_| core::array::from_fn(|_| axes.next().unwrap_or(0));
        Some(core::array::from_fn(each))
    }

    fn put(&mut self, compensated: &[[f32; A]; C], status: &[Status; C]) {
        self.output
            .send(frame::encode(self.number, compensated, status));
        self.number = self.number.wrapping_add(1);
        self.data_ready.set_low();
    }
}
