//! Image `guard`: calls all that a flying unit calls of the core, and links only if none of it can
//! panic. Needs the feature `link-guard`.
//!
//! It also runs: it calls everything many times and writes what it used of the stack to the console.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(all(target_os = "none", not(feature = "link-guard")))]
#[cortex_m_rt::entry]
fn main() -> ! {
    // Without the feature this would prove nothing: panics link.
    tempco_firmware::target::exit(false)
}

#[cfg(all(target_os = "none", feature = "link-guard"))]
mod image {
    use core::hint::black_box;

    use tempco::{
        Interval, Output, PLAYS, PulseRamp, Schedule, Status, Stream, Table, TableError, Terms,
        Thermal, ThermalChannels, ThermalPoint, ThermalSettings,
    };
    use tempco_firmware::table::{AXES, CHANNELS, CRC, TABLES};
    use tempco_replay::{Header, HeaderError, Record, RecordError, Replay, Sample};
    use tempco_test_images::guard::report_and_exit;
    use tempco_test_images::history::HISTORY;
    use tempco_test_images::kernels::{self, Buffers, Inputs, Units};

    /// Enough for the state to matter; the proof is in the linking.
    const ROUNDS: u32 = 100;

    static BUFFERS: Buffers<AXES> = Buffers::new();

    #[cortex_m_rt::entry]
    fn main() -> ! {
        compensators();
        replays();
        streams();
        // What goes wrong is of no interest, only that it may.
        _ = black_box(tables());
        _ = black_box(records());
        #[cfg(feature = "seeded-panic")]
        black_box(TABLES[black_box(0)]);
        report_and_exit(true)
    }

    /// The core as it flies, through the functions whose costs are published.
    #[inline(never)]
    fn compensators() {
        let mut units = Units::new(black_box(&TABLES[0]), &BUFFERS, black_box(16));
        units.start(black_box(25.0));
        let mut output = Output {
            compensated: [0.0; AXES],
            bias: [0.0; AXES],
            point: ThermalPoint::default(),
            status: Status::OK,
        };
        for _ in 0..ROUNDS {
            let dt_s = black_box(0.1);
            let inputs = Inputs {
                interval: Interval::new(black_box(TABLES[0].thermal()), dt_s),
                dt_s,
                temp_c: black_box(25.0),
                raw: black_box([0.5; AXES]),
                pulses: black_box([5; AXES]),
            };
            // One by one: a loop over function pointers would hide the calls from the ELF check.
            kernels::step(black_box(&mut units), black_box(&inputs), &mut output);
            kernels::thermal(black_box(&mut units), black_box(&inputs), &mut output);
            kernels::subtract(black_box(&mut units), black_box(&inputs), &mut output);
            kernels::block8(black_box(&mut units), black_box(&inputs), &mut output);
            kernels::interval(black_box(&mut units), black_box(&inputs), &mut output);
            kernels::pulses(black_box(&mut units), black_box(&inputs), &mut output);
            black_box(&output);
            let state = units.single.thermal_state();
            black_box((state.rejected(), state.restarts()));
            black_box(units.thermal.thermal_state());
            black_box(units.whole.status());
            let status = Status::from_bits(black_box(output.status.bits()));
            black_box((status.validity(), status.contains(Status::SETTLING)));
        }
    }

    #[inline(never)]
    fn replays() {
        let mut replay = Replay::new(black_box(&TABLES));
        for _ in 0..ROUNDS {
            let sample = Sample::<CHANNELS, AXES> {
                update_s: black_box(Some(0.1)),
                temps_c: [25.0; CHANNELS],
                raw: [[0.5; AXES]; CHANNELS],
            };
            black_box(replay.step(black_box(&sample)));
        }
        black_box(replay.summary().worst());
    }

    #[inline(never)]
    fn streams() {
        let schedule = black_box(Schedule {
            sample_rate_hz: 2000.0,
            samples_per_update: 16,
        });
        let mut stream = Stream::new(black_box(&HISTORY), &schedule);
        for _ in 0..ROUNDS {
            stream.temperatures(black_box(&[25.0]));
            black_box(stream.sample(black_box(&[[0.5; AXES]])));
        }
        let thermal = ThermalChannels::new(black_box(&HISTORY), schedule.samples_per_update);
        black_box((thermal.points(), thermal.rejected()));
        let [ramp] = black_box(thermal.constant());
        black_box(PulseRamp::new(&ramp, black_box([0.5; AXES])));
    }

    /// A table that is not known at build time, as from a parameter store: checked, then used at
    /// any temperature whatever.
    #[inline(never)]
    fn tables() -> Result<f32, TableError> {
        let cells = black_box([[Terms::new([], []); AXES]; 2]);
        let cells = cells.get(..black_box(2)).unwrap_or_default();
        let thermal = Thermal::new(black_box(ThermalSettings::DEFAULT))?;
        let table = Table::new(thermal, black_box(-40.0), black_box(85.0), cells)?;
        let table = table.calibrated(black_box(-30.0), black_box(70.0))?;
        let table = table.with_plays(black_box([[0.5; AXES]; PLAYS]))?;
        let place = black_box(table.place(black_box(25.0)));
        let point = ThermalPoint {
            effective_c: black_box(25.0),
            ..ThermalPoint::default()
        };
        Ok(table.bias(&point).0[0] + place.z)
    }

    #[inline(never)]
    fn records() -> Result<Option<f32>, RecordError> {
        type S = Sample<CHANNELS, AXES>;
        let bytes = black_box([0_u8; 256]);
        let bytes = bytes.get(..black_box(100)).unwrap_or_default();
        let header: Result<(), HeaderError> =
            Header::decode(bytes).and_then(|header| header.expect(&Header::samples::<1, 3>()));
        _ = black_box(header);
        black_box(Header::outcomes::<CHANNELS, AXES>(black_box(CRC)).encode());
        let sample = S::decode(bytes)?;
        let mut encoded = [0; S::LEN];
        sample.encode(encoded.get_mut(..black_box(1)).unwrap_or_default())?;
        black_box(encoded);
        Ok(sample.update_s)
    }
}
