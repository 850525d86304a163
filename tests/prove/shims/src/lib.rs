//! Functions of plain arguments around the core: their LLVM IR is what `cargo xtask prove` proves.
//!
//! The constants show where the compiler put the private fields of the core's types.
#![no_std]
#![allow(unsafe_code, reason = "names that can be found again")]

use tempco::{BiasRamp, Corrector, PulseCorrector, PulseRamp, RampBuffer, Status};
use tempco::{Interval, Play, SecondLag, Table, Terms, Thermal, ThermalSettings, ThermalState};

/// One update of the thermal path.
#[allow(clippy::too_many_arguments, reason = "each output has a name")]
#[unsafe(no_mangle)]
pub fn prove_update(
    state: &mut ThermalState,
    thermal: &Thermal,
    interval: &Interval,
    temp_c: f32,
    effective_c: &mut f32,
    rate_c_per_min: &mut f32,
    lag2_c: &mut f32,
    play1_c: &mut f32,
    play2_c: &mut f32,
    status: &mut u16,
) {
    let point = state.update(thermal, interval, temp_c);
    *effective_c = point.effective_c;
    *rate_c_per_min = point.rate_c_per_min;
    *lag2_c = point.lag2_c;
    [*play1_c, *play2_c] = point.plays_c;
    *status = point.status.bits();
}

/// The interval made of a time.
#[unsafe(no_mangle)]
pub fn prove_interval(thermal: &Thermal, dt_s: f32, interval: &mut Interval) {
    *interval = Interval::new(thermal, dt_s);
}

/// The cell of a lag-compensated temperature.
#[unsafe(no_mangle)]
pub fn prove_place(
    table: &Table<'_, 1>,
    effective_c: f32,
    cell: &mut u32,
    z: &mut f32,
    status: &mut u16,
) {
    let place = table.place(effective_c);
    *cell = place.cell as u32;
    *z = place.z;
    *status = place.status.bits();
}

/// The bias in a cell.
#[unsafe(no_mangle)]
pub fn prove_bias(terms: &Terms, z: f32, rate_c_per_min: f32, lag2_c: f32) -> f32 {
    terms.bias(z, rate_c_per_min, lag2_c)
}

/// A play: how far the contact is behind.
#[unsafe(no_mangle)]
pub fn prove_play(play: &mut Play, half_width_c: f32, drag_c: f32) -> f32 {
    play.follow(half_width_c, drag_c)
}

/// A second lag, without limits.
#[unsafe(no_mangle)]
pub fn prove_second_lag(lag: &mut SecondLag, interval: &Interval, temp_c: f32) -> f32 {
    lag.update(interval, temp_c)
}

const THERMAL: Thermal = match Thermal::new(ThermalSettings::DEFAULT) {
    Ok(thermal) => thermal,
    Err(_) => panic!(),
};

/// Cells for the tables of constants.
pub static PROVE_CELLS: [[Terms; 1]; 3] = [[Terms::new([], [])]; 3];

/// A table with the edges 3 and 11 degC, calibrated from 4.25 to 9.75 degC.
#[unsafe(no_mangle)]
pub static PROVE_TABLE: Table<'static, 1> = match Table::new(THERMAL, 3.0, 11.0, &PROVE_CELLS) {
    Ok(table) => match table.calibrated(4.25, 9.75) {
        Ok(table) => table,
        Err(_) => panic!(),
    },
    Err(_) => panic!(),
};

/// The default settings, checked.
#[unsafe(no_mangle)]
pub static PROVE_THERMAL: Thermal = THERMAL;

/// A state as it is made.
#[unsafe(no_mangle)]
pub static PROVE_STATE: ThermalState = ThermalState::new(&THERMAL);

/// An interval of a quarter of a second.
#[unsafe(no_mangle)]
pub static PROVE_INTERVAL: Interval = Interval::new(&THERMAL, 0.25);

/// A play as it is made.
#[unsafe(no_mangle)]
pub static PROVE_PLAY: Play = Play::new(25.0);

/// A second lag as it is made.
#[unsafe(no_mangle)]
pub static PROVE_LAG: SecondLag = SecondLag::new(25.0);

/// Hands a ramp over.
#[unsafe(no_mangle)]
pub fn prove_publish(ramps: &RampBuffer<3>, ramp: &BiasRamp<3>) {
    ramps.publish(ramp);
}

/// The same, and the first gyro sample after it.
#[unsafe(no_mangle)]
pub fn prove_take_over(
    ramps: &RampBuffer<3>,
    ramp: &BiasRamp<3>,
    bias: &mut [f32; 3],
    status: &mut u16,
) {
    ramps.publish(ramp);
    prove_advance(ramps, bias, status);
}

/// The bias of the next gyro sample, with flags.
#[unsafe(no_mangle)]
pub fn prove_advance(ramps: &RampBuffer<3>, bias: &mut [f32; 3], status: &mut u16) {
    let (next, flags) = Corrector::new(ramps).advance::<1>();
    *bias = next;
    *status = flags.bits();
}

/// One gyro sample.
#[unsafe(no_mangle)]
pub fn prove_correct(ramps: &RampBuffer<3>, raw: &[f32; 3], out: &mut [f32; 3]) {
    *out = Corrector::new(ramps).correct(*raw);
}

/// Eight gyro samples at once.
#[unsafe(no_mangle)]
pub fn prove_correct_block(ramps: &RampBuffer<3>, block: &mut [[f32; 3]; 8]) {
    Corrector::new(ramps).correct_block(block);
}

/// The flags as of the last gyro sample.
#[unsafe(no_mangle)]
pub fn prove_status(ramps: &RampBuffer<3>, status: &mut u16) {
    *status = Corrector::new(ramps).status().bits();
}

/// A ramp in pulses.
#[unsafe(no_mangle)]
pub fn prove_pulse_ramp(ramp: &BiasRamp<3>, per_unit: &[f32; 3], fixed: &mut PulseRamp<3>) {
    *fixed = PulseRamp::new(ramp, *per_unit);
}

/// The pulses of one gyro sample.
#[unsafe(no_mangle)]
pub fn prove_pulses(corrector: &mut PulseCorrector<'_, 3>, pulses: &[i32; 3], rest: &mut [i32; 3]) {
    *rest = corrector.correct(*pulses);
}

/// The flags as of the last gyro sample, of pulses.
#[unsafe(no_mangle)]
pub fn prove_pulse_status(corrector: &PulseCorrector<'_, 3>, status: &mut u16) {
    *status = corrector.status().bits();
}

/// The flags of gyro samples.
#[unsafe(no_mangle)]
pub fn prove_of_raw(raw: &[f32; 3]) -> u16 {
    Status::of_raw(raw).bits()
}

/// A ramp of numbers that all differ.
#[unsafe(no_mangle)]
pub static PROVE_RAMP: BiasRamp<3> = BiasRamp {
    end: [1.5, 2.5, 3.5],
    slope: [4.5, 5.5, 6.5],
    samples: 0x1234,
    status: Status::from_bits(0x5678),
};

/// The same in pulses.
#[unsafe(no_mangle)]
pub static PROVE_PULSE_RAMP: PulseRamp<3> = PulseRamp {
    end: [0x1122_3344, 0x2233_4455, 0x3344_5566],
    slope: [0x4455_6677, 0x5566_7788, 0x6677_8899],
    samples: 0x1234,
    status: Status::from_bits(0x5678),
};

/// A buffer as it is made.
#[unsafe(no_mangle)]
pub static PROVE_RAMPS: RampBuffer<3> = RampBuffer::new();

/// A buffer for pulses.
#[unsafe(no_mangle)]
pub static PROVE_PULSE_RAMPS: RampBuffer<3, i32> = RampBuffer::new();

/// A corrector of pulses as it is made.
#[unsafe(no_mangle)]
pub static PROVE_PULSES: PulseCorrector<'static, 3> = PulseCorrector::new(&PROVE_PULSE_RAMPS);
