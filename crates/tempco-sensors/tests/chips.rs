//! The drivers byte by byte on mocked buses: what they write, and how they read the answers.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::i2c::ErrorKind as I2cError;
use embedded_hal::spi::{ErrorKind as SpiError, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::i2c::{Mock as I2c, Transaction as I2cTransaction};
use embedded_hal_mock::eh1::spi::{Mock as Spi, Transaction};
use tempco_sensors::{
    Ads1220, ChipSelect, Divider, Filter, Gain, Input, Max31865, Platinum, Rate, SensorFault,
    Thermistor, Tmp117, Wires, for_core,
};

/// One selection of the chip in which bytes are written.
fn written(bytes: &[u8]) -> Vec<Transaction<u8>> {
    vec![
        Transaction::transaction_start(),
        Transaction::write_vec(bytes.to_vec()),
        Transaction::transaction_end(),
    ]
}

/// One selection in which a command is written and its answer read.
fn asked(command: u8, answer: &[u8]) -> Vec<Transaction<u8>> {
    vec![
        Transaction::transaction_start(),
        Transaction::write_vec(vec![command]),
        Transaction::read_vec(answer.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn pt100(expected: &[Vec<Transaction<u8>>]) -> Max31865<Spi<u8>> {
    let spi = Spi::new(&expected.concat());
    Max31865::new(spi, Platinum::PT100, 400.0, Wires::Three, Filter::Hz50)
}

/// What `start` writes and reads.
fn started() -> Vec<Transaction<u8>> {
    [
        // 60.256 ohm at -100 degC is code 4936, 194.098 ohm at 250 degC is code 15900.
        written(&[0x83, 0x7c, 0x38, 0x26, 0x90]),
        written(&[0x80, 0xd3]),
        asked(0x00, &[0xd1]),
    ]
    .concat()
}

/// A reading with a code.
fn converted(high: u8, low: u8) -> Vec<Transaction<u8>> {
    asked(0x00, &[0xd1, high, low])
}

/// The end of a fault-detection cycle that found `faults`, after a conversion of 0 degC.
fn checked(faults: u8) -> Vec<Transaction<u8>> {
    [
        asked(0x00, &[0x91, 0x40, 0x00, 0x7c, 0x38, 0x26, 0x90, faults]),
        written(&[0x80, 0xd3]),
    ]
    .concat()
}

/// Readings from `start` to the first temperature, of 0 degC.
fn started_and_checked() -> Vec<Transaction<u8>> {
    [
        started(),
        converted(0x40, 0x00),
        written(&[0x80, 0x95]),
        checked(0),
    ]
    .concat()
}

fn start_and_check(chip: &mut Max31865<Spi<u8>>) {
    chip.start(-100.0, 250.0).unwrap();
    assert_eq!(chip.read(), Err(SensorFault::NotReady));
    assert_eq!(chip.read(), Ok(0.0));
}

#[test]
fn max31865_is_set_up_and_read() {
    let mut chip = pt100(&[
        started_and_checked(),
        // 8192 of 32768 times 400 ohm is 100 ohm; one more is 0.0122 ohm.
        converted(0x40, 0x00),
        converted(0x40, 0x02),
    ]);
    start_and_check(&mut chip);
    assert_eq!(chip.read(), Ok(0.0));
    let one_step: f32 = chip.read().unwrap();
    assert!((one_step - 0.012_207 / 0.390_83).abs() < 1e-5, "{one_step}");
    chip.release().done();
}

#[test]
fn max31865_names_faults_and_looks_again() {
    for (faults, expected) in [
        (0x80, SensorFault::Open),
        (0x20, SensorFault::Open),
        (0xa4, SensorFault::Open),
        (0x40, SensorFault::Short),
        (0x10, SensorFault::Short),
        (0x08, SensorFault::Short),
        (0x5c, SensorFault::Short),
        (0x04, SensorFault::Rail),
        (0x00, SensorFault::Bus),
        (0xff, SensorFault::Bus),
    ] {
        let mut chip = pt100(&[
            started_and_checked(),
            converted(0x40, 0x01),
            asked(0x07, &[faults]),
            written(&[0x80, 0xd3]),
            converted(0x40, 0x00),
        ]);
        start_and_check(&mut chip);
        assert_eq!(chip.read(), Err(expected), "{faults:02x}");
        assert_eq!(chip.read(), Ok(0.0));
        chip.release().done();
    }
    // No fault reported, but no resistance that a sensor can have.
    let mut chip = pt100(&[
        started_and_checked(),
        converted(0x00, 0x00),
        converted(0xff, 0xfe),
    ]);
    start_and_check(&mut chip);
    assert_eq!(chip.read(), Err(SensorFault::Short));
    assert_eq!(chip.read(), Err(SensorFault::Open));
    chip.release().done();
}

/// One open wire of four may leave a resistance that looks good: only a fault-detection cycle says
/// that it is open. The fault stands until a cycle finds the wire whole.
#[test]
fn max31865_checks_its_wires_again_and_again() {
    let check = || [converted(0x40, 0x00), written(&[0x80, 0x95])].concat();
    let good = || [vec![converted(0x40, 0x00); 29].concat(), check()].concat();
    let mut chip = pt100(&[
        started_and_checked(),
        good(),
        checked(0),
        good(),
        checked(0x20),
        check(),
        checked(0x20),
        check(),
        checked(0),
        converted(0x40, 0x00),
    ]);
    start_and_check(&mut chip);
    for _ in 0..61 {
        assert_eq!(chip.read(), Ok(0.0));
    }
    for _ in 0..4 {
        assert_eq!(chip.read(), Err(SensorFault::Open));
    }
    assert_eq!(chip.read(), Ok(0.0));
    assert_eq!(chip.read(), Ok(0.0));
    chip.release().done();
}

#[test]
fn max31865_is_waited_for_while_it_checks_and_noticed_when_it_was_reset() {
    let mut chip = pt100(&[
        started(),
        converted(0x40, 0x00),
        written(&[0x80, 0x95]),
        asked(0x00, &[0x95, 0x40, 0x00, 0x7c, 0x38, 0x26, 0x90, 0x00]),
        checked(0),
        // As after power-on.
        asked(0x00, &[0x00, 0x00, 0x00]),
        started_and_checked(),
    ]);
    chip.start(-100.0, 250.0).unwrap();
    assert_eq!(chip.read(), Err(SensorFault::NotReady));
    assert_eq!(chip.read(), Err(SensorFault::NotReady));
    assert_eq!(chip.read(), Ok(0.0));
    assert_eq!(chip.read(), Err(SensorFault::Bus));
    start_and_check(&mut chip);
    chip.release().done();

    // During a check.
    for answer in [0x00, 0xff] {
        let mut chip = pt100(&[
            started(),
            converted(0x40, 0x00),
            written(&[0x80, 0x95]),
            asked(0x00, &[answer; 8]),
            written(&[0x80, 0xd3]),
        ]);
        chip.start(-100.0, 250.0).unwrap();
        assert_eq!(chip.read(), Err(SensorFault::NotReady));
        assert_eq!(chip.read(), Err(SensorFault::Bus));
        chip.release().done();
    }
}

/// What a pin and the waits around it did, in order.
#[derive(Clone, Default)]
struct Trace(Rc<RefCell<Vec<String>>>);

impl Trace {
    fn push(&self, what: String) {
        self.0.borrow_mut().push(what);
    }
}

impl digital::ErrorType for Trace {
    type Error = Infallible;
}

impl OutputPin for Trace {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.push("low".to_owned());
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.push("high".to_owned());
        Ok(())
    }
}

impl DelayNs for Trace {
    fn delay_ns(&mut self, ns: u32) {
        self.push(format!("{ns} ns"));
    }
}

#[test]
fn a_chip_select_keeps_its_time_around_every_edge() {
    let trace = Trace::default();
    let ns = Max31865::<Spi<u8>>::SELECT_NS;
    let mut select = ChipSelect::new(trace.clone(), trace.clone(), ns);
    select.set_low().unwrap();
    trace.push("clocks".to_owned());
    select.set_high().unwrap();
    let expected = ["low", "400 ns", "clocks", "400 ns", "high", "400 ns"];
    assert_eq!(*trace.0.borrow(), expected);
}

#[test]
fn a_chip_that_is_not_there_is_a_bus_fault() {
    for answer in [0x00, 0xff] {
        let mut chip = pt100(&[
            written(&[0x83, 0x7c, 0x38, 0x26, 0x90]),
            written(&[0x80, 0xd3]),
            asked(0x00, &[answer]),
        ]);
        assert_eq!(chip.start(-100.0, 250.0), Err(SensorFault::Bus));
        chip.release().done();

        let mut chip = Ads1220::new(Spi::new(
            &[
                written(&[0x43, 0x81, 0x00, 0x50, 0x00]),
                asked(0x23, &[answer; 4]),
            ]
            .concat(),
        ));
        let configured = chip.configure(Input::Ain0, Gain::X1, Rate::Sps20);
        assert_eq!(configured, Err(SensorFault::Bus));
        chip.release().done();
    }
    let mut chip = Max31865::new(Dead, Platinum::PT100, 400.0, Wires::Three, Filter::Hz50);
    assert_eq!(chip.start(-100.0, 250.0), Err(SensorFault::Bus));
    assert_eq!(chip.read(), Err(SensorFault::Bus));
    assert_eq!(Ads1220::new(Dead).start(), Err(SensorFault::Bus));
    assert_eq!(Ads1220::new(Dead).read_share(), Err(SensorFault::Bus));
}

/// A bus that fails; the mock cannot.
struct Dead;

impl ErrorType for Dead {
    type Error = SpiError;
}

impl SpiDevice for Dead {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), SpiError> {
        Err(SpiError::Other)
    }
}

#[test]
fn ads1220_measures_shares_of_the_reference() {
    let registers = [0xb5, 0x40, 0x50, 0x00];
    let mut chip = Ads1220::new(Spi::new(
        &[
            // Nothing is sent for 50 us and 32 clocks of the chip.
            vec![
                Transaction::transaction_start(),
                Transaction::write_vec(vec![0x06]),
                Transaction::delay(60_000),
                Transaction::transaction_end(),
            ],
            written(&[&[0x43][..], &registers].concat()),
            asked(0x23, &registers),
            written(&[0x08]),
            asked(0x10, &[0x40, 0x00, 0x00]),
            asked(0x10, &[0xff, 0xff, 0xff]),
            asked(0x10, &[0x7f, 0xff, 0xff]),
            asked(0x10, &[0x80, 0x00, 0x00]),
        ]
        .concat(),
    ));
    chip.reset().unwrap();
    chip.configure(Input::Ain3, Gain::X4, Rate::Sps90).unwrap();
    chip.start().unwrap();
    assert_eq!(chip.read_share(), Ok(0.125));
    assert_eq!(chip.read_share(), Ok(-1.0 / 8_388_608.0 / 4.0));
    assert_eq!(chip.read_share(), Err(SensorFault::Rail));
    assert_eq!(chip.read_share(), Err(SensorFault::Rail));
    chip.release().done();
}

#[test]
fn a_thermistor_on_an_ads1220_is_a_temperature_or_a_fault() {
    let divider = Divider {
        fixed_ohm: 10_000.0,
    };
    let thermistor = Thermistor::from_beta(10_000.0, 3977.0);
    for (code, expected) in [
        ([0x40, 0x00, 0x00], Ok(25.0)),
        ([0x7f, 0xff, 0xff], Err(SensorFault::Open)),
        ([0x7f, 0xf0, 0x00], Err(SensorFault::Open)),
        ([0x00, 0x10, 0x00], Err(SensorFault::Short)),
        ([0xff, 0xff, 0x00], Err(SensorFault::Short)),
    ] {
        let mut chip = Ads1220::new(Spi::new(&asked(0x10, &code)));
        let found = chip.read_thermistor(&divider, &thermistor);
        assert_eq!(found, expected, "{code:02x?}");
        chip.release().done();
    }
}

#[test]
fn tmp117_is_set_up_and_read() {
    let reads =
        |register, value: [u8; 2]| I2cTransaction::write_read(0x48, vec![register], value.to_vec());
    let mut bus = I2c::new(&[
        reads(0x01, [0x02, 0x20]),
        I2cTransaction::write(0x48, vec![0x01, 0x02, 0x20]),
        // No conversion yet; one that says it is but is none; 25 degC; -25 degC.
        reads(0x01, [0x02, 0x20]),
        reads(0x01, [0x22, 0x20]),
        reads(0x00, [0x80, 0x00]),
        reads(0x01, [0x22, 0x20]),
        reads(0x00, [0x0c, 0x80]),
        reads(0x01, [0x22, 0x20]),
        reads(0x00, [0xf3, 0x80]),
        reads(0x01, [0, 0]).with_error(I2cError::Other),
    ]);
    let mut chip = Tmp117::new(bus.clone(), 0x48);
    chip.start().unwrap();
    assert_eq!(chip.read(), Err(SensorFault::NotReady));
    assert_eq!(chip.read(), Err(SensorFault::NotReady));
    assert_eq!(chip.read(), Ok(25.0));
    assert_eq!(chip.read(), Ok(-25.0));
    assert_eq!(chip.read(), Err(SensorFault::Bus));
    bus.done();
}

#[test]
fn the_core_gets_a_temperature_nan_or_nothing() {
    assert_eq!(for_core(Ok(20.5)), Some(20.5));
    assert_eq!(for_core(Err(SensorFault::NotReady)), None);
    for fault in [
        SensorFault::Bus,
        SensorFault::Open,
        SensorFault::Short,
        SensorFault::Rail,
    ] {
        assert!(for_core(Err(fault)).unwrap().is_nan());
    }
}
