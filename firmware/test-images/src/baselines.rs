//! What is usually done instead, written from the formulas, to compare instructions with.
//!
//! None of it conditions the temperature or says anything about its validity. How well a baseline
//! fits does not matter for what it costs, so the coefficients only touch the table here and
//! there.

use tempco::{Output, Table, ThermalPoint};

/// Segments of the composite baselines.
const SEGMENTS: usize = 4;
/// Points of the look-up table.
const POINTS: usize = 14;

/// All of them.
#[derive(Clone, Debug)]
pub struct Baselines<const A: usize> {
    /// A cubic in the temperature.
    pub cubic: Cubic<A>,
    /// A look-up table.
    pub lookup_14: Lookup14<A>,
    /// The composite model in single precision.
    pub composite_f32: CompositeF32<A>,
    /// The composite model in double precision.
    pub composite_f64: CompositeF64<A>,
}

impl<const A: usize> Baselines<A> {
    /// With coefficients read off a table.
    pub fn new(table: &Table<'_, A>) -> Self {
        Self {
            cubic: Cubic::new(table),
            lookup_14: Lookup14::new(table),
            composite_f32: CompositeF32::new(table),
            composite_f64: CompositeF64::new(table),
        }
    }
}

fn bias_at<const A: usize>(table: &Table<'_, A>, effective_c: f32, rate: f32) -> [f32; A] {
    let point = ThermalPoint {
        effective_c,
        rate_c_per_min: rate,
        ..ThermalPoint::default()
    };
    table.bias(&point).0
}

/// `part / parts` of the way through the calibrated range \[degC\].
fn temp_at<const A: usize>(table: &Table<'_, A>, part: usize, parts: usize) -> f32 {
    table.t_min_c() + (table.t_max_c() - table.t_min_c()) * part as f32 / parts as f32
}

/// The cubic of most autopilots, over the whole range.
///
/// ```text
/// d   = clamp(T, t_min, t_max) - T_ref
/// B   = c0 + d (c1 + d (c2 + d c3))          per axis
/// out = raw - B
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic<const A: usize> {
    /// Cold end of the calibrated range \[degC\].
    pub t_min_c: f32,
    /// Hot end of the calibrated range \[degC\].
    pub t_max_c: f32,
    /// Reference temperature \[degC\].
    pub reference_c: f32,
    /// Coefficients of each axis, lowest power first \[unit of the axis per degC^power\].
    pub coefficients: [[f32; 4]; A],
}

impl<const A: usize> Cubic<A> {
    /// With the bias and the slope of a table at its reference temperature.
    pub fn new(table: &Table<'_, A>) -> Self {
        let reference_c = table.thermal().settings().reference_c;
        let here = bias_at(table, reference_c, 0.0);
        let next = bias_at(table, reference_c + 1.0, 0.0);
        Self {
            t_min_c: table.t_min_c(),
            t_max_c: table.t_max_c(),
            reference_c,
            coefficients: core::array::from_fn(|axis| {
                [here[axis], next[axis] - here[axis], 1e-5, 1e-7]
            }),
        }
    }

    /// Takes the bias out of one sample per axis; only `compensated` and `bias` are written.
    #[inline]
    pub fn compensate(&self, temp_c: f32, raw: [f32; A], out: &mut Output<A>) {
        let temp_c = if temp_c < self.t_min_c {
            self.t_min_c
        } else {
            temp_c
        };
        let temp_c = if temp_c > self.t_max_c {
            self.t_max_c
        } else {
            temp_c
        };
        let d = temp_c - self.reference_c;
        out.bias = self
            .coefficients
            .map(|[c0, c1, c2, c3]| c0 + d * (c1 + d * (c2 + d * c3)));
        out.compensated = core::array::from_fn(|axis| raw[axis] - out.bias[axis]);
    }
}

/// Defines the textbook composite model for a floating point type.
macro_rules! composite {
    ($name:ident, $float:ty) => {
        /// The composite model as in a textbook: segments found by a search, a division for the
        /// place within, a first-order filter for the rate.
        ///
        /// ```text
        /// T'  = (T - L) / tau,  L += alpha (T - L)
        /// z   = (T - edge_k) / (edge_k+1 - edge_k)
        /// B   = a0 + a1 z + a2 z^2 + r0 T' + r1 T' z       per axis
        /// out = raw - B
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name<const A: usize> {
            edges: [$float; SEGMENTS + 1],
            terms: [[[$float; 5]; A]; SEGMENTS],
            alpha: $float,
            tau_min: $float,
            filtered: $float,
        }

        impl<const A: usize> $name<A> {
            /// With the biases of a table at the edges of four segments, for updates each second.
            pub fn new(table: &Table<'_, A>) -> Self {
                let edge = |k| temp_at(table, k, SEGMENTS);
                let tau_s = table.thermal().settings().tau_s;
                Self {
                    edges: core::array::from_fn(|k| edge(k).into()),
                    terms: core::array::from_fn(|k| {
                        let cold = bias_at(table, edge(k), 0.0);
                        let hot = bias_at(table, edge(k + 1), 0.0);
                        let ramp = bias_at(table, edge(k), 1.0);
                        core::array::from_fn(|axis| {
                            let (slope, r0) = (hot[axis] - cold[axis], ramp[axis] - cold[axis]);
                            [cold[axis], slope - 1e-3, 1e-3, r0, 1e-3].map(<$float>::from)
                        })
                    }),
                    alpha: (1.0 / tau_s).into(),
                    tau_min: (tau_s / 60.0).into(),
                    filtered: 25.0,
                }
            }

            /// Takes the bias out of one sample per axis; only `compensated` and `bias` are
            /// written.
            #[inline]
            pub fn compensate(&mut self, temp_c: f32, raw: [f32; A], out: &mut Output<A>) {
                let temp = <$float>::from(temp_c);
                let lag = temp - self.filtered;
                self.filtered += self.alpha * lag;
                let rate = lag / self.tau_min;
                let mut k = 0;
                while k < SEGMENTS - 1 && temp >= self.edges[k + 1] {
                    k += 1;
                }
                let z = (temp - self.edges[k]) / (self.edges[k + 1] - self.edges[k]);
                for axis in 0..A {
                    let [a0, a1, a2, r0, r1] = self.terms[k][axis];
                    let bias = a0 + a1 * z + a2 * z * z + r0 * rate + r1 * rate * z;
                    out.bias[axis] = bias as f32;
                    out.compensated[axis] = (<$float>::from(raw[axis]) - bias) as f32;
                }
            }
        }
    };
}

composite!(CompositeF32, f32);
composite!(CompositeF64, f64);

/// A look-up table of 14 points with linear interpolation between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup14<const A: usize> {
    temps_c: [f32; POINTS],
    biases: [[f32; A]; POINTS],
}

impl<const A: usize> Lookup14<A> {
    /// With the biases of a table.
    pub fn new(table: &Table<'_, A>) -> Self {
        let temps_c = core::array::from_fn(|k| temp_at(table, k, POINTS - 1));
        Self {
            temps_c,
            biases: temps_c.map(|temp_c| bias_at(table, temp_c, 0.0)),
        }
    }

    /// Takes the bias out of one sample per axis; only `compensated` and `bias` are written.
    #[inline]
    pub fn compensate(&self, temp_c: f32, raw: [f32; A], out: &mut Output<A>) {
        let mut k = 0;
        while k < POINTS - 2 && temp_c >= self.temps_c[k + 1] {
            k += 1;
        }
        let part = (temp_c - self.temps_c[k]) / (self.temps_c[k + 1] - self.temps_c[k]);
        let cells = self.biases[k].iter().zip(&self.biases[k + 1]);
        for (axis, (cold, hot)) in cells.enumerate() {
            out.bias[axis] = cold + part * (hot - cold);
            out.compensated[axis] = raw[axis] - out.bias[axis];
        }
    }
}
