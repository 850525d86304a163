//! Hostile samples, with losses and lasting jumps of the temperature that take more than one of them.

use tempco_firmware::table::AXES;

use crate::golden::samples::{Sample, Samples};

/// How long one kind of course lasts [updates].
const PHASE: u32 = 1024;

pub(super) struct Course {
    samples: Samples,
    count: u32,
}

impl Course {
    pub(super) const fn new() -> Self {
        Self {
            samples: Samples::new(),
            count: 0,
        }
    }

    /// One in eight phases begins with a loss, another one is a jump that stays until its end.
    pub(super) fn next(&mut self) -> Sample<AXES> {
        let mut sample = self.samples.hostile();
        let (phase, part) = (self.count / PHASE % 8, self.count % PHASE);
        if phase == 5 && part < PHASE * 3 / 4 {
            sample.temp_c = f32::NAN;
        }
        if phase == 6 {
            sample.temp_c += 15.0;
        }
        self.count = self.count.wrapping_add(1);
        sample
    }
}
