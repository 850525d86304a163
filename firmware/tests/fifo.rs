//! The application on the host with a gyro that has a clock, a FIFO and a data-ready line of its own:
//! a simulated ICM-42688-P behind its driver and reader. What happens to it, and what the unit says.

mod common;

use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::rc::Rc;

use common::{Bench, Outside, Running, SCHEDULE};
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use tempco::{Status, Validity};
use tempco_firmware::fifo_gyro::{self, Channel, INVALID_COUNT, Reader, Samples};
use tempco_firmware::unit::devices::{AtRest, Clock, Count, Gyro, Lost, ResetCause};
use tempco_firmware::unit::{AXES, CHANNELS};
use tempco_link::{Fault, FaultSet};
use tempco_sensors::icm42688::simulated::Simulated;
use tempco_sensors::icm42688::{AntiAlias, OutputRate, Range, Settings};

const SETTINGS: Settings = Settings {
    range: Range::Dps250,
    rate: OutputRate::Hz2000,
    filter: AntiAlias::Hz536,
    block: 1,
};

/// Counts of the chip's time per millisecond. The unit's time is slower, as of all tests here: a
/// period of its timer is half a millisecond of the chip.
const PER_MS: u32 = 10_000;

/// Samples after which the first axis of one is marked as not valid.
const INVALID_EVERY: u32 = 1000;

type Chip = Simulated<Box<dyn FnMut() -> u32>>;

#[derive(Clone)]
struct Wire(Rc<RefCell<Chip>>);

impl ErrorType for Wire {
    type Error = Infallible;
}

impl SpiDevice for Wire {
    fn transaction(&mut self, steps: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        self.0.borrow_mut().transaction(steps)
    }
}

fn at_rest(_: u32) -> [i16; 3] {
    [100, -200, 300]
}

fn sometimes_invalid(number: u32) -> [i16; 3] {
    let is_invalid = number.is_multiple_of(INVALID_EVERY);
    [if is_invalid { i16::MIN } else { 100 }, -200, 300]
}

/// The chip, its lines, and what came out of the unit.
struct World<'q> {
    chip: Wire,
    now: Rc<Cell<u32>>,
    reader: RefCell<Reader<'q, Wire>>,
    /// The data-ready line is cut.
    is_cut: Cell<bool>,
    wants_look: Rc<Cell<bool>>,
    output: Rc<RefCell<Vec<(f32, Status)>>>,
}

struct Imu<'q> {
    samples: Samples<'q>,
    wants_look: Rc<Cell<bool>>,
    output: Rc<RefCell<Vec<(f32, Status)>>>,
}

impl Gyro<CHANNELS, AXES> for Imu<'_> {
    const CLOCK: Clock = fifo_gyro::clock(&SETTINGS);
    const COUNTS: [[Count; AXES]; CHANNELS] =
        [[Count::Rate(SETTINGS.range.deg_per_s()); AXES]; CHANNELS];
    const INVALID: Option<i32> = Some(INVALID_COUNT);
    const AT_REST: AtRest = AtRest {
        sigma: 1.0,
        max_bias: 1000.0,
    };
    const MAX_TABLE_BIAS: f32 = 1000.0;

    fn sample(&mut self) -> Option<[[i32; AXES]; CHANNELS]> {
        self.samples.take()
    }

    fn lost(&mut self) -> Lost {
        self.samples.lost()
    }

    fn look(&mut self) {
        self.wants_look.set(true);
    }

    fn put(&mut self, compensated: &[[f32; AXES]; CHANNELS], status: &[Status; CHANNELS]) {
        self.output
            .borrow_mut()
            .push((compensated[0][0], status[0]));
    }
}

impl Outside for World<'_> {
    fn pass(&self, periods: u32) -> bool {
        self.now
            .set(self.now.get().wrapping_add(periods * PER_MS / 2));
        let is_ready = self.chip.0.borrow_mut().is_data_ready() && !self.is_cut.get();
        if is_ready {
            self.reader.borrow_mut().ready();
        }
        is_ready
    }

    fn after(&self) -> bool {
        let wants_look = self.wants_look.take();
        if wants_look {
            self.reader.borrow_mut().look();
        }
        wants_look
    }
}

impl World<'_> {
    fn chip(&self) -> std::cell::RefMut<'_, Chip> {
        self.chip.0.borrow_mut()
    }

    /// What came out since the last call.
    fn taken(&self) -> Vec<(f32, Status)> {
        std::mem::take(&mut self.output.borrow_mut())
    }
}

/// A unit with tables that has settled, on a chip whose clock is off.
fn run(
    error_ppm: i32,
    sample: fn(u32) -> [i16; 3],
    test: impl FnOnce(&mut Bench, &mut dyn Running, &World),
) {
    let now = Rc::new(Cell::new(0));
    let time = now.clone();
    let time = Box::new(move || time.get()) as Box<dyn FnMut() -> u32>;
    let chip = Simulated::new(time, PER_MS, error_ppm, sample);
    let chip = Wire(Rc::new(RefCell::new(chip)));
    let mut channel = Channel::new();
    let (mut reader, samples) = channel.split(chip.clone(), SETTINGS);
    let output = Rc::new(RefCell::new(Vec::new()));
    let wants_look = Rc::new(Cell::new(false));
    reader.start(&mut Delay(now.clone()));
    let world = World {
        chip,
        now,
        reader: RefCell::new(reader),
        is_cut: Cell::new(false),
        wants_look: wants_look.clone(),
        output: output.clone(),
    };
    let imu = Imu {
        samples,
        wants_look,
        output,
    };
    let mut bench = Bench::with_tables();
    bench.boot_with(imu, &world, ResetCause::PowerOn, None, |bench, unit| {
        bench.connect(unit);
        bench.wait(unit, 200.0);
        test(bench, unit, &world);
    });
}

/// Waits by the chip's time.
struct Delay(Rc<Cell<u32>>);

impl embedded_hal::delay::DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        let counts = ns / 1000 * (PER_MS / 1000);
        self.0.set(self.0.get().wrapping_add(counts));
    }
}

/// All is well, and was since power-on.
fn is_well(bench: &mut Bench, unit: &mut dyn Running, error_ppm: i32) {
    let telemetry = bench.telemetry(unit);
    let status = telemetry.outcome.channels[0].status;
    assert_eq!((telemetry.faults, status), (FaultSet::NONE, 0));
    assert_eq!(telemetry.overruns, 0);
    let log = bench.log(unit);
    assert!(log.is_empty(), "{error_ppm}: {log:?}");
}

/// Twice as far off as the data sheet allows, over minutes: no flag, no fault, no sample lost.
#[test]
fn a_clock_that_is_fast_or_slow_changes_nothing_but_the_number_of_samples() {
    for error_ppm in [0, 20_000, -20_000] {
        run(error_ppm, at_rest, |bench, unit, world| {
            is_well(bench, unit, error_ppm);
            world.taken();
            let before = bench.telemetry(unit);
            let measured = world.chip().samples();
            bench.wait(unit, 100.0);
            let after = bench.telemetry(unit);
            is_well(bench, unit, error_ppm);
            let samples = after.samples - before.samples;
            let measured = world.chip().samples() - measured;
            assert!(samples.abs_diff(measured) <= 8, "{samples} of {measured}");
            let periods = 100.0 * SCHEDULE.sample_rate_hz;
            let expected = periods * (1.0 + error_ppm as f32 / 1e6);
            assert!((samples as f32 / expected - 1.0).abs() < 2e-3, "{samples}");
            assert_eq!(after.raw, [100.0, -200.0, 300.0], "counts as they are");
            let mut output = world.taken().into_iter();
            assert!(output.all(|(value, status)| value.is_finite() && status == Status::OK));
        });
    }
}

/// Within 10 ms the output says so; it heals by itself.
#[test]
fn a_gyro_that_stops_is_a_fault_in_10_ms_and_heals() {
    run(0, at_rest, |bench, unit, world| {
        // Longer than the reader waits before it starts the chip again, and shorter.
        for periods in [40, 3000] {
            world.taken();
            world.chip().is_stuck = true;
            bench.wait(unit, periods as f32 / SCHEDULE.sample_rate_hz);
            let output = world.taken();
            let good = output.iter().filter(|(value, _)| value.is_finite()).count();
            // The period of the last sample counts too.
            assert_eq!((good, output.len()), (0, periods - 18));
            let mut flags = output.into_iter().map(|(_, status)| status);
            assert!(flags.all(|status| status.validity() == Validity::Invalid));
            // The means of the first one are of good samples too.
            bench.telemetry(unit);
            bench.wait(unit, 0.2);
            let telemetry = bench.telemetry(unit);
            assert!(telemetry.faults.contains(Fault::GyroSilent));
            assert!(telemetry.faults.is_invalidating());
            assert!(telemetry.raw.iter().all(|raw| raw.is_nan()));

            world.chip().is_stuck = false;
            bench.wait(unit, 5.0);
            world.taken();
            let telemetry = bench.telemetry(unit);
            assert_eq!(telemetry.faults, FaultSet::NONE);
            assert_eq!(telemetry.outcome.channels[0].status, 0);
            let mut output = world.taken().into_iter();
            assert!(output.all(|(value, status)| value.is_finite() && status == Status::OK));
        }
    });
}

/// The timer takes over: no sample is lost, and the unit says that the line is silent.
#[test]
fn a_missed_data_ready_is_a_fault_and_loses_nothing() {
    run(10_000, at_rest, |bench, unit, world| {
        world.is_cut.set(true);
        let before = bench.telemetry(unit);
        let measured = world.chip().samples();
        bench.wait(unit, 60.0);
        let after = bench.telemetry(unit);
        assert_eq!(after.faults, FaultSet::from(Fault::DataReady));
        assert!(!after.faults.is_invalidating());
        assert_eq!(after.overruns, 0);
        let samples = after.samples - before.samples;
        let measured = world.chip().samples() - measured;
        assert!(samples.abs_diff(measured) <= 8, "{samples} of {measured}");
        world.is_cut.set(false);
        bench.wait(unit, 5.0);
        assert_eq!(bench.faults(unit), FaultSet::NONE);
    });
}

/// Interrupts that are held back, as while flash is erased: what the FIFO could not keep is counted.
#[test]
fn an_overrun_of_the_fifo_is_a_fault_with_the_number_of_samples() {
    run(0, at_rest, |bench, unit, world| {
        bench.wait(unit, 1.0);
        let before = bench.telemetry(unit);
        let measured = world.chip().samples();
        bench.held.set(170);
        bench.wait(unit, 1.0);
        let after = bench.telemetry(unit);
        let measured = world.chip().samples() - measured;
        let lost = measured - (after.samples - before.samples);
        assert!(lost.abs_diff(43) <= 1, "of 171, 128 stay: {lost}");
        assert!(after.overruns.abs_diff(lost) <= 1, "{}", after.overruns);
        assert!(after.faults.contains(Fault::Overrun));
        let elapsed_ms = after.uptime_ms - before.uptime_ms;
        assert!(elapsed_ms >= 2700, "time goes on: {elapsed_ms}");
        bench.wait(unit, 5.0);
        assert_eq!(bench.faults(unit), FaultSet::NONE);
    });
}

/// Wrong packets are lost, never given out; the samples behind them are good again.
#[test]
fn a_torn_read_is_lost_and_counted() {
    run(0, at_rest, |bench, unit, world| {
        world.taken();
        for tears in 1..=20_u32 {
            world.chip().is_torn = true;
            bench.wait(unit, 0.5);
            let telemetry = bench.telemetry(unit);
            assert!(telemetry.faults.contains(Fault::Overrun));
            assert_eq!(telemetry.overruns, tears);
        }
        let mut output = world.taken().into_iter();
        assert!(output.all(|(value, status)| value.is_finite() && status == Status::OK));
    });
}

/// A supply that fails for a moment: silence, a start, 50 ms of settling; then good samples.
#[test]
fn a_chip_that_reset_itself_is_started_again() {
    run(0, at_rest, |bench, unit, world| {
        for is_away in [false, true] {
            world.chip().restart();
            world.chip().is_away = is_away;
            bench.wait(unit, 1.5);
            assert!(bench.faults(unit).contains(Fault::GyroSilent));
            world.chip().is_away = false;
            bench.wait(unit, 5.0);
            let telemetry = bench.telemetry(unit);
            assert_eq!(telemetry.faults, FaultSet::NONE);
            assert!(telemetry.overruns >= 1);
            assert_eq!(telemetry.raw, [100.0, -200.0, 300.0]);
        }
    });
}

/// A range that changes by itself would be a scale that is wrong: it is found within 900 reads.
#[test]
fn a_setting_that_is_lost_is_found() {
    const GYRO_CONFIG0: u8 = 0x4f;
    run(0, at_rest, |bench, unit, world| {
        world.chip().upset(GYRO_CONFIG0, OutputRate::Hz2000 as u8);
        bench.wait(unit, 9.0);
        let log = bench.log(unit);
        let named = log.iter().any(|(fault, _)| *fault == Fault::GyroSilent);
        assert!(named, "it was started again: {log:?}");
        bench.wait(unit, 5.0);
        let telemetry = bench.telemetry(unit);
        assert_eq!(telemetry.faults, FaultSet::NONE);
        assert!(telemetry.overruns >= 1);
    });
}

/// A sample that the part marks is flagged, and all others are good.
#[test]
fn a_sample_that_is_not_valid_is_never_given_out_as_good() {
    run(0, sometimes_invalid, |bench, unit, world| {
        world.taken();
        bench.wait(unit, 100.0);
        let output = world.taken();
        let (bad, good): (Vec<_>, Vec<_>) = output
            .into_iter()
            .partition(|(_, status)| status.contains(Status::RAW_INVALID));
        assert!(bad.len().abs_diff(10) <= 1, "{}", bad.len());
        assert!(bad.iter().all(|(value, _)| value.is_nan()));
        assert!(good.iter().all(|(value, _)| value.is_finite()));
        let telemetry = bench.telemetry(unit);
        assert!(telemetry.raw.iter().all(|raw| raw.is_finite()));
        let log = bench.log(unit);
        let named = log.iter().any(|(fault, _)| *fault == Fault::RawInvalid);
        assert!(named, "{log:?}");
    });
}
