//! The image `unit` in the emulator, with its line, its flash and a bench for its sensors.

use std::fs::File;
use std::io::Write;
use std::os::unix::fs::FileExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use tempco::{Terms, ThermalSettings};
use tempco_hil::{Error, Patience, Unit};
use tempco_image::{Axis, Channel, Info, Unit as AxisUnit, encode};
use tempco_link::{Fault, FaultSet, Telemetry};
use tempco_qemu::{
    Board, Layout, Machine, MachineOptions, MachineTime, Variant, Workspace, build_variant,
    ensure_qemu, ensure_target,
};

/// Where slot B of the flash begins \[bytes\].
pub const SLOT_B: u64 = 0x8000;

/// Serial number of the unit, as in the example table built in.
pub const SERIAL: &str = "EXAMPLE";

/// A request is sent again soon, since a unit that lost its supply does not answer.
const ANSWER: Duration = Duration::from_millis(100);

/// An instruction takes 64 ns: less than two counts of the sampling timer, so that latency and load
/// are known to the instruction, and a busy host slows the unit's time instead of cutting it short.
pub const ICOUNT_SHIFT: u8 = 6;

/// A unit in the emulator.
pub struct Rig {
    /// The line to it.
    pub unit: Unit,
    /// Where it runs.
    pub machine: Machine,
    /// What stands for its flash.
    pub flash: File,
    /// The line again, for bytes outside the protocol.
    pub line: UnixStream,
    bench: UnixStream,
    /// Holds the flash and the sockets.
    _folder: tempfile::TempDir,
}

impl Rig {
    /// A unit whose flash has never been used, booted.
    ///
    /// # Panics
    /// If any of it fails.
    pub fn start() -> Self {
        let time = MachineTime::Counted {
            shift: ICOUNT_SHIFT,
        };
        Self::with(&image(), time)
    }

    /// As [`start`](Self::start), with another image or another time.
    ///
    /// # Panics
    /// If any of it fails.
    pub fn with(image: &Path, time: MachineTime) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let bench = folder.path().join("bench");
        let memory = folder.path().join("flash");
        let chardev = format!(
            "socket,id=bench,path={},server=on,wait=off",
            bench.display()
        );
        let options = MachineOptions {
            time,
            memory: Some(memory.clone()),
            extra: ["-chardev", &chardev, "-serial", "chardev:bench"]
                .map(str::to_owned)
                .to_vec(),
        };
        let machine = Machine::start(image, Board::Mps2An386, &options).expect("a machine");
        let bench = UnixStream::connect(&bench).expect("the bench");
        let line = UnixStream::connect(machine.link()).expect("the line");
        line.set_read_timeout(Some(Duration::from_millis(5)))
            .expect("the line");
        // Where the host's time does not bind the unit's, the answer may take long on a busy host. A
        // request that comes again too soon would keep it from ever being ready.
        let (answer, tries) = match time {
            MachineTime::Unbound { .. } => (10 * ANSWER, 60),
            _ => (ANSWER, 600),
        };
        let patience = Patience {
            answer,
            tries,
            boot: Duration::from_secs(20),
        };
        let port = Box::new(line.try_clone().expect("the line"));
        let unit = Unit::connect(port, patience).expect("a session");
        let flash = File::options().read(true).write(true).open(memory);
        Self {
            unit,
            machine,
            flash: flash.expect("the flash"),
            line,
            bench,
            _folder: folder,
        }
    }

    /// Does something with the unit while the supply fails after some time. Afterwards it is
    /// booted again; what came of it before.
    ///
    /// # Panics
    /// If the unit does not boot.
    pub fn cut_during<T: Send>(
        &mut self,
        after: Duration,
        work: impl FnOnce(&mut Unit) -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        let Self { unit, machine, .. } = self;
        let result = thread::scope(|scope| {
            scope.spawn(|| {
                thread::sleep(after);
                machine.reset().expect("a machine");
            });
            work(unit)
        });
        unit.reconnect().expect("the unit boots");
        result
    }

    /// Samples of the simulated chip of the feature `gyro-simulated`, and counts of 40 ns that its model
    /// took: what its image notes behind the flash.
    ///
    /// # Panics
    /// If the memory cannot be read.
    pub fn simulated_chip(&self) -> [u32; 2] {
        let mut words = [0; 8];
        self.flash
            .read_exact_at(&mut words, 0x10_0000)
            .expect("memory");
        let word = |place: usize| words[4 * place..][..4].try_into().expect("a word");
        [0, 1].map(|place| u32::from_le_bytes(word(place)))
    }

    /// Sets the temperature of a sensor \[degC\].
    pub fn temperature(&mut self, temp_c: f32) {
        self.say(b'T', temp_c.to_bits());
    }

    /// Lets a sensor give one code for ever.
    pub fn stuck(&mut self, temp_c: f32) {
        self.say(b'C', temp_c.to_bits());
    }

    /// Sets the fault of a sensor, by its code on the bench.
    pub fn sensor_fault(&mut self, code: u32) {
        self.say(b'E', code);
    }

    /// Sets the gyro's counts per sample of axis 0.
    pub fn counts(&mut self, counts: i32) {
        self.say(b'G', counts.cast_unsigned());
    }

    /// Stops the unit's main loop.
    pub fn stop(&mut self) {
        self.say(b'S', 0);
    }

    fn say(&mut self, letter: u8, value: u32) {
        let mut message = [0xa5, letter, 0, 0, 0, 0, 0, 0];
        message[4..].copy_from_slice(&value.to_le_bytes());
        self.bench.write_all(&message).expect("the bench");
    }

    /// Turns over a bit of a byte of the flash.
    pub fn damage(&self, place: u64) {
        let mut byte = [0];
        self.flash.read_exact_at(&mut byte, place).expect("flash");
        self.flash
            .write_all_at(&[byte[0] ^ 0x10], place)
            .expect("flash");
    }

    /// Where some bytes are in the variables of [`image()`].
    ///
    /// # Panics
    /// If the memory cannot be read.
    pub fn find_in_memory(&mut self, bytes: &[u8]) -> Vec<u32> {
        let layout = Layout::of(&image()).expect("an image");
        let start = layout.ram_start.expect("variables") as u32;
        let memory = self.machine.read_memory(start, layout.ram_bytes as usize);
        let memory = memory.expect("memory");
        let places = memory.windows(bytes.len()).zip(start..);
        let found = places.filter(|(window, _)| *window == bytes);
        found.map(|(_, address)| address).collect()
    }

    /// Turns over a bit of the unit's memory.
    ///
    /// # Panics
    /// If there is no such memory.
    pub fn upset(&mut self, address: u32, bit: u32) {
        let byte = self.machine.read_memory(address, 1).expect("memory");
        let written = self.machine.write_memory(address, &[byte[0] ^ 1 << bit]);
        written.expect("memory");
    }

    /// The state of the unit.
    pub fn telemetry(&mut self) -> Telemetry {
        self.unit.telemetry(0).expect("telemetry")
    }

    /// Waits until a state is reached, and returns it.
    ///
    /// # Panics
    /// If it does not come within `limit_s`.
    pub fn wait(
        &mut self,
        limit_s: f32,
        what: &str,
        is_so: impl Fn(&Telemetry) -> bool,
    ) -> Telemetry {
        let start = Instant::now();
        loop {
            let telemetry = self.telemetry();
            if is_so(&telemetry) {
                return telemetry;
            }
            assert!(
                start.elapsed().as_secs_f32() < limit_s,
                "{what}: {telemetry:?}, log {:?}",
                self.machine.log()
            );
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits for a fault.
    pub fn wait_for(&mut self, fault: Fault, limit_s: f32) -> Telemetry {
        self.wait(limit_s, fault.name(), |state| state.faults.contains(fault))
    }

    /// Waits until nothing is wrong.
    pub fn wait_until_well(&mut self, limit_s: f32) -> Telemetry {
        self.wait(limit_s, "healing", |state| {
            state.faults == FaultSet::NONE && state.outcome.channels[0].status == 0
        })
    }
}

/// The image, built once.
///
/// # Panics
/// If it does not build.
pub fn image() -> PathBuf {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    let built = IMAGE.get_or_init(|| {
        let workspace = Workspace::find().expect("the sources");
        ensure_target(&workspace).expect("the target");
        ensure_qemu(&workspace).expect("the emulator");
        build_variant(
            &workspace,
            Board::Mps2An386,
            "unit",
            None,
            &Variant::APPLICATION,
        )
        .expect("the image")
    });
    built.clone()
}

/// The image of a small table whose unit settles and gives up within seconds, so that tests need
/// not wait for minutes.
///
/// # Panics
/// Never.
pub fn quick_table(table_crc: u32) -> Vec<u8> {
    table_in(AxisUnit::PulsesPerS, table_crc)
}

/// As [`quick_table`], in any unit.
///
/// # Panics
/// Never.
pub fn table_in(unit: AxisUnit, table_crc: u32) -> Vec<u8> {
    const CELLS: [[Terms; 3]; 2] = [[Terms::new([0.5, 0.25, 0.125], [0.0625, 0.0]); 3]; 2];
    let channel = Channel {
        thermal: ThermalSettings {
            hold_s: 2.0,
            heal_s: 0.5,
            tau_s: 2.0,
            ..ThermalSettings::DEFAULT
        },
        first_edge_c: -40.0,
        last_edge_c: 80.0,
        t_min_c: -40.0,
        t_max_c: 80.0,
        period_s: 0.0,
        axes: Axis::array(&[Axis::new(unit); 3]),
        cells: CELLS.as_flattened(),
    };
    let info = Info {
        serial: SERIAL,
        table_crc,
        ..Info::default()
    };
    let mut bytes = vec![0; 4096];
    let len = encode(&info, &[channel], &mut bytes).expect("an image");
    bytes.truncate(len);
    bytes
}
