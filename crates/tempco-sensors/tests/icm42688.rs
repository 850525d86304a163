//! The ICM-42688-P: byte by byte on a mocked bus, and on a simulated chip what happens to samples.

use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use tempco_sensors::icm42688::simulated::{DEPTH, Simulated};
use tempco_sensors::icm42688::{
    AntiAlias, BURST, Burst, ChipFault, INVALID, Icm42688, OutputRate, Range, Settings,
};

const SETTINGS: Settings = Settings {
    range: Range::Dps250,
    rate: OutputRate::Hz2000,
    filter: AntiAlias::Hz536,
    block: 1,
};

fn written(bytes: &[u8]) -> Vec<Transaction<u8>> {
    vec![
        Transaction::transaction_start(),
        Transaction::write_vec(bytes.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn asked(address: u8, answer: &[u8]) -> Vec<Transaction<u8>> {
    vec![
        Transaction::transaction_start(),
        Transaction::write_vec(vec![address]),
        Transaction::read_vec(answer.to_vec()),
        Transaction::transaction_end(),
    ]
}

/// Registers of bank 0 and their values, by the data sheet.
const BANK_0: [(u8, u8); 14] = [
    (0x14, 0x03),
    (0x4c, 0x33),
    (0x4d, 0x51),
    (0x4f, 0x65),
    (0x50, 0x05),
    (0x52, 0x00),
    (0x54, 0x21),
    (0x5f, 0x2f),
    (0x60, 0x10),
    (0x61, 0x00),
    (0x64, 0x60),
    (0x65, 0x04),
    (0x16, 0xc0),
    (0x4e, 0x0f),
];

/// A reset and a start.
fn started() -> Vec<Transaction<u8>> {
    let mut all = [
        written(&[0x76, 0]),
        written(&[0x11, 0x01]),
        asked(0xf5, &[0x47]),
        written(&[0x76, 1]),
        written(&[0x0c, 12, 144, 0x80]),
        asked(0x8c, &[12, 144, 0x80]),
        written(&[0x76, 0]),
    ]
    .concat();
    for (register, value) in BANK_0 {
        all.extend(written(&[register, value]));
    }
    for (register, value) in BANK_0 {
        all.extend(asked(register | 0x80, &[value]));
    }
    all.extend(asked(0xad, &[0x10]));
    all
}

/// A packet of three axes and a time stamp.
fn packet(header: u8, counts: [i16; 3], stamp: u16) -> [u8; 16] {
    let mut packet = [0x55; 16];
    packet[0] = header;
    for (bytes, count) in packet[7..13].chunks_mut(2).zip(counts) {
        bytes.copy_from_slice(&count.to_be_bytes());
    }
    packet[14..].copy_from_slice(&stamp.to_be_bytes());
    packet
}

#[test]
fn the_chip_is_set_up_and_read_as_the_data_sheet_says() {
    // Half a second after the first one, so that the samples are good.
    let mut expected = started();
    for number in 0..100_u32 {
        expected.extend(asked(0xad, &[0x08, 0, 16]));
        let stamp = (7500 * number / 16) as u16;
        expected.extend(asked(0xb0, &packet(0x68, [1, 2, 3], stamp)));
    }
    let counts = [[-32_767, 0x0102, 32_767], [INVALID, -1, 0]];
    let stamps = [100, 101_u32].map(|number| (7500 * number / 16) as u16);
    // A header may say that a rate was changed.
    let packets = [
        packet(0x6b, counts[0], stamps[0]),
        packet(0x68, counts[1], stamps[1]),
    ];
    expected.extend(asked(0xad, &[0x0c, 0, 32]));
    expected.extend(asked(0xb0, &packets.concat()));
    expected.extend(asked(0xad, &[0x00, 0, 0]));

    let mut chip = Icm42688::new(Mock::new(&expected), SETTINGS);
    chip.reset().unwrap();
    chip.configure().unwrap();
    let mut found = Vec::new();
    for _ in 0..100 {
        assert!(!chip.is_settled());
        chip.read(|counts| found.push(counts)).unwrap();
    }
    assert!(found.is_empty() && chip.is_settled(), "50 ms");
    let burst = chip.read(|counts| found.push(counts)).unwrap();
    assert_eq!((burst.waiting, burst.lost), (2, 0));
    assert_eq!(found, counts);
    let burst = chip.read(|_| panic!("nothing there")).unwrap();
    assert_eq!(burst, Burst::default());
    chip.release().done();
}

#[test]
fn settings_are_as_the_tables_of_the_data_sheet() {
    let ranges = [
        Range::Dps2000,
        Range::Dps1000,
        Range::Dps500,
        Range::Dps250,
        Range::Dps125,
        Range::Dps62,
        Range::Dps31,
        Range::Dps15,
    ];
    // Counts per deg/s.
    let sensitivities = [16.4, 32.8, 65.5, 131.0, 262.0, 524.3, 1048.6, 2097.2];
    for (range, sensitivity) in ranges.into_iter().zip(sensitivities) {
        assert!(
            (range.deg_per_s() * sensitivity - 1.0).abs() < 2e-3,
            "{range:?}"
        );
    }
    let rates = [
        OutputRate::Hz8000,
        OutputRate::Hz4000,
        OutputRate::Hz2000,
        OutputRate::Hz1000,
    ];
    assert_eq!(rates.map(OutputRate::hz), [8000, 4000, 2000, 1000]);
}

#[test]
fn a_chip_that_is_another_one_or_forgets_is_refused() {
    let mut other = Icm42688::new(Mock::new(&asked(0xf5, &[0x44])), SETTINGS);
    assert_eq!(other.configure(), Err(ChipFault::Identity));
    other.release().done();

    // Each register in turn holds another value.
    for wrong in 0..BANK_0.len() {
        let mut expected = Vec::new();
        for (place, (register, value)) in BANK_0.into_iter().enumerate() {
            let found = value ^ u8::from(place == wrong);
            expected.extend(asked(register | 0x80, &[found]));
        }
        let mut chip = Icm42688::new(Mock::new(&expected), SETTINGS);
        for place in 0..Icm42688::<Mock<u8>>::REGISTERS {
            assert_eq!(chip.check().is_err(), place == wrong);
        }
        chip.release().done();
    }
}

/// What cannot be, and what says that it was reset.
#[test]
fn a_bus_that_fails_and_a_chip_that_was_reset_give_no_samples() {
    for (answer, fault) in [
        ([0xff, 0xff, 0xff], ChipFault::Bus),
        ([0x00, 0x08, 0x30], ChipFault::Bus),
        ([0x18, 0x00, 0x10], ChipFault::Restarted),
    ] {
        let mut chip = Icm42688::new(Mock::new(&asked(0xad, &answer)), SETTINGS);
        assert_eq!(chip.read(|_| panic!("a sample")), Err(fault), "{answer:?}");
        chip.release().done();
    }
    let mut broken = Icm42688::new(Broken, SETTINGS);
    assert_eq!(broken.reset(), Err(ChipFault::Bus));
    assert_eq!(broken.configure(), Err(ChipFault::Bus));
    assert_eq!(broken.read(|_| ()), Err(ChipFault::Bus));
}

struct Broken;

impl ErrorType for Broken {
    type Error = ErrorKind;
}

impl SpiDevice for Broken {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        Err(ErrorKind::Other)
    }
}

/// Counts per millisecond of the time that follows.
const PER_MS: u32 = 1000;

type Chip = Simulated<Box<dyn FnMut() -> u32>>;

/// A simulated chip that a test holds too.
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

/// Number `n` of the samples, in 15 bits, and twice it.
fn numbered(number: u32) -> [i16; 3] {
    let number = (number % 0x4000) as i16;
    [number, 2 * (number % 0x2000), -number]
}

struct Bench {
    chip: Wire,
    driver: Icm42688<Wire>,
    now: Rc<Cell<u32>>,
    samples: Vec<u16>,
}

impl Bench {
    /// A chip that was started and has settled.
    fn new(settings: Settings, error_ppm: i32) -> Self {
        // The time wraps soon.
        let now = Rc::new(Cell::new(u32::MAX - 100 * PER_MS));
        let time = now.clone();
        let chip = Simulated::new(
            Box::new(move || time.get()) as Box<dyn FnMut() -> u32>,
            PER_MS,
            error_ppm,
            numbered,
        );
        let chip = Wire(Rc::new(RefCell::new(chip)));
        let driver = Icm42688::new(chip.clone(), settings);
        let mut bench = Self {
            chip,
            driver,
            now,
            samples: Vec::new(),
        };
        bench.start();
        bench
    }

    fn start(&mut self) {
        self.driver.reset().unwrap();
        self.wait(PER_MS + 1);
        self.driver.configure().unwrap();
        while self.samples.is_empty() {
            self.wait(PER_MS / 2);
            self.read().unwrap();
        }
    }

    fn wait(&self, counts: u32) {
        self.now.set(self.now.get().wrapping_add(counts));
    }

    fn read(&mut self) -> Result<Burst, ChipFault> {
        let Self {
            driver, samples, ..
        } = self;
        driver.read(|[x, y, z]| {
            assert_eq!([x, y, z], numbered(x as u32));
            samples.push(x as u16);
        })
    }

    /// Reads until the FIFO is empty; the samples that were lost.
    fn drain(&mut self) -> u32 {
        let mut lost = 0;
        loop {
            let burst = self.read().unwrap();
            lost += u32::from(burst.lost);
            if burst.waiting == 0 {
                return lost;
            }
        }
    }

    /// Steps between the numbers of the samples that were found.
    fn gaps(&self) -> Vec<u16> {
        let steps = self.samples.windows(2);
        let steps = steps.map(|pair| pair[1].wrapping_sub(pair[0]) & 0x3fff);
        steps.filter(|step| *step != 1).collect()
    }
}

/// Three seconds, in blocks of one to four, by a clock that is off.
#[test]
fn every_sample_comes_once_and_in_order() {
    for (rate, block, error_ppm) in [
        (OutputRate::Hz2000, 1, 20_000),
        (OutputRate::Hz2000, 1, -20_000),
        (OutputRate::Hz8000, 4, 20_000),
        (OutputRate::Hz8000, 4, -20_000),
    ] {
        let settings = Settings {
            rate,
            block,
            ..SETTINGS
        };
        let mut bench = Bench::new(settings, error_ppm);
        bench.samples.clear();
        let period = 1000 * PER_MS * u32::from(block) / u32::from(rate.hz());
        let mut lost = 0;
        for _ in 0..3000 * PER_MS / period {
            bench.wait(period);
            lost += u32::from(bench.read().unwrap().lost);
        }
        assert_eq!((bench.gaps(), lost), (vec![], 0), "{rate:?} {error_ppm}");
        let expected = 3.0 * f64::from(rate.hz()) * (1.0 + f64::from(error_ppm) / 1e6);
        let found = bench.samples.len() as f64;
        // The period of the simulated chip is in whole counts.
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }
}

/// A reader that is late by up to a second finds what the FIFO has kept, and what was lost behind it.
#[test]
fn an_overrun_is_seen_and_counted() {
    for late in [100, DEPTH as u32, 140, 160, 200, 250, 2000] {
        let mut bench = Bench::new(SETTINGS, 10_000);
        bench.drain();
        bench.samples.clear();
        let before = bench.chip.0.borrow().samples();
        let period = bench.chip.0.borrow().period_at(2000);
        bench.wait(late * period);
        let mut lost = bench.drain();
        bench.wait(period);
        lost += bench.drain();
        let measured = bench.chip.0.borrow().samples() - before;
        let really = measured - bench.samples.len() as u32;
        match late {
            // The time stamps have come round.
            250.. => assert!(lost >= 1 && lost <= really, "{late}: {lost} of {really}"),
            // That nothing was lost after it had become full is not known.
            128 => assert_eq!((really, lost), (0, 1)),
            _ => assert_eq!(lost, really, "{late}"),
        }
        let gaps = bench.gaps();
        assert!(gaps.len() <= 1, "{gaps:?}: it is one stretch");
        // What is new after it comes without a gap.
        bench.samples.clear();
        for _ in 0..100 {
            bench.wait(period);
            assert_eq!(bench.read().unwrap().lost, 0);
        }
        assert_eq!((bench.gaps(), bench.samples.len()), (vec![], 100));
    }
}

/// A header that is wrong, and a count that is no multiple of packets: no sample is given out from
/// there on, and the time stamps show how many it were.
#[test]
fn a_torn_read_is_seen_and_counted() {
    for (is_torn, excess) in [(true, 0), (false, 1), (false, 15)] {
        let mut bench = Bench::new(SETTINGS, 0);
        bench.drain();
        bench.samples.clear();
        let period = bench.chip.0.borrow().period_at(2000);
        bench.wait(period);
        bench.read().unwrap();
        bench.wait(5 * period);
        bench.chip.0.borrow_mut().is_torn = is_torn;
        bench.chip.0.borrow_mut().excess = excess;
        assert_eq!(bench.read(), Err(ChipFault::Torn));
        assert_eq!(bench.samples.len(), 1, "no torn sample");
        bench.chip.0.borrow_mut().excess = 0;
        bench.wait(3 * period);
        assert_eq!(bench.drain(), 5);
        assert_eq!(bench.samples.len(), 4);
        assert_eq!(bench.gaps(), [6]);
    }
    // A full FIFO of which the first read is torn.
    let mut bench = Bench::new(SETTINGS, 0);
    bench.drain();
    let period = bench.chip.0.borrow().period_at(2000);
    bench.wait(136 * period);
    bench.chip.0.borrow_mut().is_torn = true;
    assert_eq!(bench.read(), Err(ChipFault::Torn));
    bench.wait(period);
    assert_eq!(bench.drain(), 136);
    // An empty FIFO that says it had a packet.
    let mut bench = Bench::new(SETTINGS, 0);
    bench.drain();
    bench.chip.0.borrow_mut().excess = 16;
    assert_eq!(bench.read(), Err(ChipFault::Torn));
}

/// A supply that fails for a moment: no sample until the chip is started again, and then none of the
/// first 50 ms.
#[test]
fn a_chip_that_reset_itself_is_seen_and_settles_again() {
    let mut bench = Bench::new(SETTINGS, 0);
    bench.drain();
    bench.chip.0.borrow_mut().restart();
    bench.wait(10 * PER_MS);
    let checked = (0..Icm42688::<Wire>::REGISTERS).map(|_| bench.driver.check());
    assert!(
        checked
            .into_iter()
            .any(|checked| checked == Err(ChipFault::Settings))
    );
    assert_eq!(bench.read(), Err(ChipFault::Restarted));
    bench.samples.clear();
    let before = bench.chip.0.borrow().samples();
    bench.start();
    let first = bench.chip.0.borrow().samples() - before;
    assert!((100..=102).contains(&first), "{first}");
    assert_eq!(bench.drain(), 0);
    // One that is gone.
    bench.chip.0.borrow_mut().is_away = true;
    assert_eq!(bench.read(), Err(ChipFault::Bus));
    assert_eq!(bench.driver.configure(), Err(ChipFault::Identity));
}

#[test]
fn a_long_queue_is_read_in_bursts() {
    let mut bench = Bench::new(SETTINGS, 0);
    bench.drain();
    let period = bench.chip.0.borrow().period_at(2000);
    bench.wait(40 * period);
    for left in [40, 32, 24, 16, 8, 0] {
        bench.samples.clear();
        let burst = bench.read().unwrap();
        assert_eq!((burst.waiting, burst.lost), (left, 0));
        assert_eq!(bench.samples.len(), BURST.min(left.into()));
    }
}
