//! The stretches of time that the steps of a chamber profile make.

/// Temperature of the air as a function of time since the beginning of a stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    Line {
        start_c: f64,
        slope_c_per_s: f64,
    },
    Sine {
        mean_c: f64,
        amplitude_c: f64,
        rad_per_s: f64,
    },
}

impl Course {
    pub(crate) const fn constant(air_c: f64) -> Self {
        Self::Line {
            start_c: air_c,
            slope_c_per_s: 0.0,
        }
    }

    fn air_c(&self, time_s: f64) -> f64 {
        match *self {
            Self::Line {
                start_c,
                slope_c_per_s,
            } => start_c + slope_c_per_s * time_s,
            Self::Sine {
                mean_c,
                amplitude_c,
                rad_per_s,
            } => mean_c + amplitude_c * libm::sin(rad_per_s * time_s),
        }
    }
}

/// A stretch of time with one course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) start_s: f64,
    /// Infinite for the last stretch, which holds the final temperature.
    pub(crate) end_s: f64,
    pub(crate) course: Course,
}

impl Leg {
    /// Air temperature, degC, at a time inside the stretch.
    pub(crate) fn air_c(&self, time_s: f64) -> f64 {
        self.course.air_c(time_s - self.start_s)
    }
}

/// Stretches so far, and where they have led to.
pub(crate) struct Legs {
    pub(crate) legs: Vec<Leg>,
    pub(crate) time_s: f64,
    pub(crate) air_c: f64,
}

impl Legs {
    pub(crate) fn starting_at(air_c: f64) -> Self {
        Self {
            legs: Vec::new(),
            time_s: 0.0,
            air_c,
        }
    }

    pub(crate) fn push(&mut self, course: Course, duration_s: f64, end_c: f64) {
        let start_s = self.time_s;
        let end_s = start_s + duration_s;
        // A ramp to where the air already is takes no time and has no slope.
        if end_s > start_s {
            self.legs.push(Leg {
                start_s,
                end_s,
                course,
            });
        }
        self.time_s = end_s;
        self.air_c = end_c;
    }

    pub(crate) fn soak(&mut self, air_c: f64, duration_min: f64) {
        self.push(Course::constant(air_c), 60.0 * duration_min, air_c);
    }

    pub(crate) fn ramp(&mut self, to_c: f64, rate_c_per_min: f64) {
        let rise_c = to_c - self.air_c;
        let course = Course::Line {
            start_c: self.air_c,
            slope_c_per_s: rate_c_per_min.copysign(rise_c) / 60.0,
        };
        self.push(course, 60.0 * rise_c.abs() / rate_c_per_min, to_c);
    }

    pub(crate) fn line(&mut self, to_c: f64, duration_min: f64) {
        let course = Course::Line {
            start_c: self.air_c,
            slope_c_per_s: (to_c - self.air_c) / (60.0 * duration_min),
        };
        self.push(course, 60.0 * duration_min, to_c);
    }
}
