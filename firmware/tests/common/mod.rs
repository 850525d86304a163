//! A unit on the host: its flash, line, sensors, gyro and timer are made of memory.
#![allow(dead_code, reason = "each test program uses its share")]

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;
use std::sync::atomic::AtomicU32;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use tempco::{Schedule, Status, Terms};
use tempco_firmware::board::mps2_an386::nor::{Nor, REGIONS, WORDS};
use tempco_firmware::table;
use tempco_firmware::unit::devices::{
    AtRest, Count, Devices, Gyro, ResetCause, SampleClock, Thermometers, Watchdog,
};
use tempco_firmware::unit::exchange::{Counts, Exchange};
use tempco_firmware::unit::fit::{UNITS, fits, scale};
use tempco_firmware::unit::in_use::{Accepted, InUse, PLACES, Room};
use tempco_firmware::unit::known_answer;
use tempco_firmware::unit::offsets::Offsets;
use tempco_firmware::unit::rezero::Limits;
use tempco_firmware::unit::storage::Storage;
use tempco_firmware::unit::{AXES, CHANNELS, IMAGE_LEN, Next, Parts, SERIAL, Sampling, Unit};
use tempco_image::{AlignedBytes, Axis, Channel, Image, Info, Unit as AxisUnit, encode};
use tempco_link::{
    Client, Event, Fault, FaultEntry, FaultSet, MAX_CHUNK, Refusal, Request, Response, Telemetry,
};
use tempco_sensors::SensorFault;
use tempco_store::Store;

/// A twentieth of the unit's gyro rate and its rate of temperatures: tests of minutes are short.
pub(crate) const SCHEDULE: Schedule = Schedule {
    sample_rate_hz: 100.0,
    samples_per_update: 10,
};

/// What lies outside the unit, and what outlives its resets.
pub(crate) struct Bench {
    pub(crate) flash: Rc<[AtomicU32]>,
    pub(crate) readings: Rc<RefCell<Vec<Result<f32, SensorFault>>>>,
    pub(crate) counts: Rc<Cell<i32>>,
    pub(crate) fed: Rc<Cell<u32>>,
    /// Interrupts that come during the next pass, beyond the one that each sleep ends with.
    pub(crate) late: Rc<Cell<u32>>,
    /// Periods for which the next interrupt is held back, as while a flash is erased.
    pub(crate) held: Rc<Cell<u32>>,
    /// In place of the units of the table that the firmware was built with.
    pub(crate) units: [[AxisUnit; AXES]; CHANNELS],
    /// In place of the test by the known answer.
    pub(crate) knows_the_answer: fn() -> bool,
    /// What is in RAM from the start, in place of the image that the next boot has accepted: an upset.
    pub(crate) upset: Option<Vec<u8>>,
    /// Places for tables.
    pub(crate) places: usize,
    line: Line,
    client: Client,
}

#[derive(Clone, Default)]
struct Line {
    to_unit: Rc<RefCell<VecDeque<u8>>>,
    from_unit: Rc<RefCell<VecDeque<u8>>>,
}

impl ErrorType for Line {
    type Error = Infallible;
}

impl ReadReady for Line {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.to_unit.borrow().is_empty())
    }
}

impl Read for Line {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let mut from = self.to_unit.borrow_mut();
        let count = bytes.len().min(from.len());
        for (place, byte) in bytes.iter_mut().zip(from.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.from_unit.borrow_mut().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

struct Sensors(Rc<RefCell<Vec<Result<f32, SensorFault>>>>);

impl<const C: usize> Thermometers<C> for Sensors {
    const STUCK_AFTER: Option<u32> = Some(50);

    fn read(&mut self) -> [Result<f32, SensorFault>; C] {
        let mut readings = self.0.borrow_mut();
        for reading in readings.iter_mut().flatten() {
            // The noise of a good sensor; `stuck` readings lie where it is lost.
            *reading = f32::from_bits(reading.to_bits() ^ u32::from(reading.abs() < 200.0));
        }
        std::array::from_fn(|channel| match readings[channel] {
            // A stuck sensor is told by a reading far beyond any temperature.
            Ok(temp_c) if temp_c > 1000.0 => Ok(temp_c - 1000.0),
            reading => reading,
        })
    }
}

struct Counter(Rc<Cell<i32>>);

impl<const C: usize, const A: usize> Gyro<C, A> for Counter {
    const COUNTS: [[Count; A]; C] = [[Count::Pulses(1.0); A]; C];
    const SCALE_FACTOR_ARCSEC: f32 = 0.5;
    /// At 100 Hz, up to two counts per sample of constant bias.
    const AT_REST: AtRest = AtRest {
        sigma: 10.0,
        max_bias: 200.0,
    };
    /// A table in pulses/s may have as much.
    const MAX_TABLE_BIAS: f32 = 50.0;

    fn sample(&mut self) -> Option<[[i32; A]; C]> {
        Some([[self.0.get(); A]; C])
    }

    fn put(&mut self, _: &[[f32; A]; C], _: &[Status; C]) {}
}

struct Dog(Rc<Cell<u32>>);

impl Watchdog for Dog {
    fn start(&mut self, _: u32) {
        self.0.set(0);
    }

    fn feed(&mut self) {
        self.0.set(self.0.get() + 1);
    }
}

/// What happens besides the timer's interrupts.
pub(crate) trait Outside {
    /// So many periods pass; whether the gyro asks for an interrupt before the timer's.
    fn pass(&self, periods: u32) -> bool;

    /// The timer's interrupt has ended; whether the gyro asks for another one.
    fn after(&self) -> bool;
}

/// Nothing.
struct Quiet;

impl Outside for Quiet {
    fn pass(&self, _: u32) -> bool {
        false
    }

    fn after(&self) -> bool {
        false
    }
}

/// Every sleep ends with an interrupt that is due.
struct Timer<'t, G> {
    sampling: Rc<RefCell<Sampling<'t, G, CHANNELS, AXES>>>,
    inside: Inside,
    late: Rc<Cell<u32>>,
    held: Rc<Cell<u32>>,
    outside: &'t dyn Outside,
}

/// The clock as the interrupt sees it, with the periods that have begun.
#[derive(Clone, Default)]
struct Inside(Rc<Cell<u32>>);

impl SampleClock for Inside {
    const COUNT_NS: u32 = 40;
    const FREE_PER_PERIOD: u32 = 5;
    const FREE_MAX: u32 = 0xffff;

    fn since_interrupt(&self) -> u32 {
        17
    }

    fn period(&self) -> u32 {
        12_500
    }

    fn sleep(&self) -> u32 {
        0
    }

    fn free_running(&self) -> u32 {
        (self.0.get() * Self::FREE_PER_PERIOD) & Self::FREE_MAX
    }

    fn interrupt_now(&self) {}
}

impl<G: Gyro<CHANNELS, AXES>> SampleClock for Timer<'_, G> {
    const COUNT_NS: u32 = Inside::COUNT_NS;
    const FREE_PER_PERIOD: u32 = Inside::FREE_PER_PERIOD;
    const FREE_MAX: u32 = Inside::FREE_MAX;

    fn since_interrupt(&self) -> u32 {
        self.inside.since_interrupt()
    }

    fn period(&self) -> u32 {
        self.inside.period()
    }

    fn sleep(&self) -> u32 {
        for _ in 0..=self.late.take() {
            let periods = 1 + self.held.take();
            self.inside.0.set(self.inside.0.get() + periods);
            if self.outside.pass(periods) {
                self.sampling.borrow_mut().interrupt(false, &self.inside);
            }
            self.sampling.borrow_mut().interrupt(true, &self.inside);
            if self.outside.after() {
                self.sampling.borrow_mut().interrupt(false, &self.inside);
            }
        }
        10_000
    }

    fn free_running(&self) -> u32 {
        self.inside.free_running()
    }

    fn interrupt_now(&self) {
        self.sampling.borrow_mut().interrupt(false, &self.inside);
    }
}

/// A boot under way, as a test steers it.
pub(crate) trait Running {
    /// One pass of the main loop.
    fn pass(&mut self) -> Next;
}

impl<L, F, T, W, K, const C: usize, const A: usize> Running for Unit<'_, L, F, T, W, K, C, A>
where
    L: Read + ReadReady + Write,
    F: embedded_storage::nor_flash::NorFlash,
    T: Thermometers<C>,
    W: Watchdog,
    K: SampleClock,
{
    fn pass(&mut self) -> Next {
        Unit::pass(self)
    }
}

impl Bench {
    /// A unit as it leaves the factory: its flash holds anything.
    pub(crate) fn new() -> Self {
        Self {
            flash: (0..WORDS).map(|_| AtomicU32::new(0)).collect(),
            readings: Rc::new(RefCell::new(vec![Ok(25.0); CHANNELS])),
            counts: Rc::default(),
            fed: Rc::default(),
            late: Rc::default(),
            held: Rc::default(),
            units: UNITS,
            knows_the_answer: known_answer::is_right,
            upset: None,
            places: PLACES,
            line: Line::default(),
            client: Client::new(),
        }
    }

    /// Runs a unit from its start until the test has done with it.
    pub(crate) fn boot<R>(&mut self, test: impl FnOnce(&mut Self, &mut dyn Running) -> R) -> R {
        self.boot_after(ResetCause::PowerOn, None, test)
    }

    pub(crate) fn boot_after<R>(
        &mut self,
        reset_cause: ResetCause,
        crash: Option<u32>,
        test: impl FnOnce(&mut Self, &mut dyn Running) -> R,
    ) -> R {
        let gyro = Counter(self.counts.clone());
        self.boot_with(gyro, &Quiet, reset_cause, crash, test)
    }

    pub(crate) fn boot_with<G: Gyro<CHANNELS, AXES>, R>(
        &mut self,
        gyro: G,
        outside: &dyn Outside,
        reset_cause: ResetCause,
        crash: Option<u32>,
        test: impl FnOnce(&mut Self, &mut dyn Running) -> R,
    ) -> R {
        let cells = self.flash.clone();
        let mut buffer = AlignedBytes([0; IMAGE_LEN]);
        let mut scratch = AlignedBytes([0; IMAGE_LEN]);
        let fits = fits::<G, CHANNELS, AXES>(&self.units);
        let mut places = [const { None }; PLACES];
        let mut room = Room::new(&mut buffer.0, &mut places[..self.places]);
        let (storage, in_use) =
            Storage::boot(Nor(&cells), REGIONS, &fits, &mut room, &mut scratch.0).unwrap();
        let table_crc = in_use.as_ref().map_or(0, InUse::crc);
        let (mut other, upset) = (AlignedBytes([0; IMAGE_LEN]), self.upset.take());
        let damaged = upset.map(|image| {
            other.0[..image.len()].copy_from_slice(&image);
            let accepted = in_use.as_ref().unwrap();
            Accepted {
                tables: Image::read(&other.0).unwrap().tables().unwrap(),
                crc: accepted.crc(),
                sums: accepted.sums().clone(),
            }
        });
        let in_use = damaged.as_ref().map(InUse::new).or(in_use);
        let counts = Counts::new();
        let mut exchange = Exchange::new();
        let (interrupt_ends, ends) = exchange.split(&counts);
        let scale = scale::<G, CHANNELS, AXES>(&self.units, SCHEDULE.sample_rate_hz);
        let limits = Limits::of::<G>(&self.units);
        let offsets = Offsets::new(storage.offsets(table_crc), limits);
        let sampling = Sampling::new(gyro, interrupt_ends, scale);
        let parts = Parts {
            storage,
            in_use,
            room,
            offsets,
            ends,
            clock: Timer {
                sampling: Rc::new(RefCell::new(sampling)),
                inside: Inside::default(),
                late: self.late.clone(),
                held: self.held.clone(),
                outside,
            },
            schedule: SCHEDULE,
            scale_factor_arcsec: G::SCALE_FACTOR_ARCSEC,
            stack_is_sound: || true,
            knows_the_answer: self.knows_the_answer,
        };
        let devices = Devices {
            link: self.line.clone(),
            thermometers: Sensors(self.readings.clone()),
            watchdog: Dog(self.fed.clone()),
            reset_cause,
            faults: FaultSet::NONE,
        };
        let mut unit = Unit::new(parts, devices, crash);
        let result = test(self, &mut unit);
        drop(unit);
        result
    }

    /// Lets time pass \[s\].
    pub(crate) fn wait(&self, unit: &mut dyn Running, time_s: f32) {
        for _ in 0..(time_s * SCHEDULE.sample_rate_hz) as u32 {
            assert_eq!(unit.pass(), Next::GoOn);
        }
    }

    /// Puts bytes on the line.
    pub(crate) fn send(&self, bytes: &[u8]) {
        self.line.to_unit.borrow_mut().extend(bytes);
    }

    /// Opens a session.
    pub(crate) fn connect(&mut self, unit: &mut dyn Running) {
        self.open_session(unit, 1234);
    }

    /// Opens a session, and returns its number. The nonce is to be another one than last time.
    pub(crate) fn open_session(&mut self, unit: &mut dyn Running, nonce: u32) -> u32 {
        let hello = self.client.hello(nonce).unwrap().to_vec();
        self.send(&hello);
        let (number, _) = self.answer(unit, |response| match response {
            Response::Hello { session, .. } => *session,
            other => panic!("{other:?}"),
        });
        number
    }

    /// Asks, and takes from the answer what the test needs; whether the unit goes on.
    pub(crate) fn ask<R>(
        &mut self,
        unit: &mut dyn Running,
        request: &Request,
        read: impl FnOnce(&Response) -> R,
    ) -> R {
        let wire = self.client.request(request).unwrap().to_vec();
        self.send(&wire);
        self.answer(unit, read).0
    }

    /// Asks for what a unit does once it has answered.
    pub(crate) fn ask_next(&mut self, unit: &mut dyn Running, request: &Request) -> Next {
        let wire = self.client.request(request).unwrap().to_vec();
        self.send(&wire);
        self.answer(unit, |_| ()).1
    }

    pub(crate) fn answer<R>(
        &mut self,
        unit: &mut dyn Running,
        read: impl FnOnce(&Response) -> R,
    ) -> (R, Next) {
        for _ in 0..1000 {
            let next = unit.pass();
            let bytes: Vec<u8> = self.line.from_unit.borrow_mut().drain(..).collect();
            for byte in bytes {
                if let Some(Event::Answer(response)) = self.client.receive(byte) {
                    return (read(&response), next);
                }
            }
        }
        panic!("no answer");
    }

    pub(crate) fn done(
        &mut self,
        unit: &mut dyn Running,
        request: &Request,
    ) -> Result<(), Refusal> {
        self.ask(unit, request, |response| match response {
            Response::Done | Response::Expected { .. } => Ok(()),
            Response::Refused(refusal) => Err(*refusal),
            other => panic!("{other:?}"),
        })
    }

    pub(crate) fn telemetry(&mut self, unit: &mut dyn Running) -> Telemetry {
        let request = Request::Telemetry { period_ms: 0 };
        self.ask(unit, &request, |response| match response {
            Response::Telemetry(telemetry) => telemetry.clone(),
            other => panic!("{other:?}"),
        })
    }

    /// Messages of telemetry that came unasked.
    pub(crate) fn unasked(&mut self, unit: &mut dyn Running, time_s: f32) -> Vec<Telemetry> {
        let mut all = Vec::new();
        for _ in 0..(time_s * SCHEDULE.sample_rate_hz) as u32 {
            unit.pass();
            let bytes: Vec<u8> = self.line.from_unit.borrow_mut().drain(..).collect();
            for byte in bytes {
                if let Some(Event::Telemetry(telemetry)) = self.client.receive(byte) {
                    all.push(telemetry);
                }
            }
        }
        all
    }

    pub(crate) fn faults(&mut self, unit: &mut dyn Running) -> FaultSet {
        self.telemetry(unit).faults
    }

    pub(crate) fn log(&mut self, unit: &mut dyn Running) -> Vec<(Fault, FaultEntry)> {
        let mut all: Vec<FaultEntry> = Vec::new();
        loop {
            let from_code = all.last().map_or(0, |entry| entry.code + 1);
            let more = self.ask(
                unit,
                &Request::Faults { from_code },
                |response| match response {
                    Response::Faults(faults) => faults.to_vec(),
                    other => panic!("{other:?}"),
                },
            );
            if more.is_empty() {
                break;
            }
            all.extend(more);
        }
        let named = all
            .into_iter()
            .map(|entry| (Fault::from_code(entry.code).unwrap(), entry));
        named.collect()
    }

    /// Writes an image and activates it; the unit is then to be booted.
    pub(crate) fn update(&mut self, unit: &mut dyn Running, image: &[u8]) -> Result<(), Refusal> {
        self.upload(unit, image)?;
        let spare = self.ask(unit, &Request::Identify, |response| match response {
            Response::Identity { spare, .. } => *spare,
            other => panic!("{other:?}"),
        });
        self.done(unit, &Request::Activate(spare))
    }

    /// Writes an image and stores it.
    pub(crate) fn upload(&mut self, unit: &mut dyn Running, image: &[u8]) -> Result<(), Refusal> {
        let len = image.len() as u32;
        self.done(unit, &Request::UploadBegin { len })?;
        for (number, bytes) in image.chunks(MAX_CHUNK).enumerate() {
            let offset = (number * MAX_CHUNK) as u32;
            self.done(unit, &Request::UploadChunk { offset, bytes })?;
        }
        let crc = tempco_image::CRC.checksum(image);
        self.done(unit, &Request::UploadCommit { len, crc })
    }

    /// Writes an image into the spare bank whatever it is, and chooses it.
    pub(crate) fn load(&mut self, image: &[u8]) {
        let mut flash = Nor(&self.flash);
        let [a, b] = REGIONS.slots;
        let mut store = Store::new(&flash, a, b).unwrap();
        let mut buffer = AlignedBytes([0; IMAGE_LEN]);
        let len = image.len() as u32;
        store.boot(&mut flash, &mut buffer.0, |_| Ok(()));
        let slot = store.begin(&mut flash, len).unwrap();
        store.write(&mut flash, 0, image).unwrap();
        let crc = Store::crc(image);
        store
            .commit(&mut flash, len, crc, &mut buffer.0, |_| Ok(()))
            .unwrap();
        store
            .select(&mut flash, slot, &mut buffer.0, |_| Ok(()))
            .unwrap();
    }

    /// A unit with a table in each slot, of which B is in use.
    pub(crate) fn with_tables() -> Self {
        let mut bench = Self::new();
        for crc in [0xa, 0xb] {
            bench.boot(|bench, unit| {
                bench.connect(unit);
                bench.update(unit, &image(SERIAL, crc)).unwrap();
            });
        }
        bench
    }
}

/// The image of the table that the firmware was built with.
pub(crate) fn image(serial: &str, table_crc: u32) -> Vec<u8> {
    let [table] = &table::TABLES;
    let axes = [Axis::new(AxisUnit::PulsesPerS); AXES];
    image_of(serial, table_crc, &axes, table.cells().as_flattened())
}

/// An image of other axes or cells.
pub(crate) fn image_of(serial: &str, table_crc: u32, axes: &[Axis], cells: &[Terms]) -> Vec<u8> {
    let [table] = &table::TABLES;
    let channel = Channel {
        thermal: *table.thermal().settings(),
        first_edge_c: -15.0,
        last_edge_c: 80.0,
        t_min_c: -15.0,
        t_max_c: 80.0,
        period_s: 0.1,
        axes: Axis::array(axes),
        cells,
    };
    let info = Info {
        serial,
        table_crc,
        ..Info::default()
    };
    let mut bytes = vec![0; IMAGE_LEN];
    let len = encode(&info, &[channel], &mut bytes).unwrap();
    bytes.truncate(len);
    bytes
}
