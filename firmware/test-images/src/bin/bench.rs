//! Image `bench`: executed instructions of the compensator, counted in QEMU.
//!
//! Every input is measured by `tempco_test_images::measure` in many calls from the same state, and the
//! cost of measuring is measured with an empty function and taken off. A line is `bench NAME MIN MAX`, in instructions
//! per call beyond the empty function, over all inputs; or `size NAME BYTES`.
//!
//! With the feature `c-reference` the C of the same behaviour is measured too, in hostile states; a line
//! is `c COMPILATION NAME MIN MAX`. `bench compare UPDATES` then compares all outputs of the core and the
//! C over so many hostile updates, and `bench trace COMPILATION` calls the functions of a compilation
//! once in each of the measured states.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use tempco::{Interval, Output, Table, ThermalPoint};
    use tempco_firmware::table::{AXES, TABLES};
    use tempco_firmware::target::{banner, exit};
    use tempco_test_images::kernels::{self, BLOCK, Buffers, Inputs, Kernel, Units};
    use tempco_test_images::measure::{Span, Stopwatch};

    static BUFFERS: Buffers<AXES> = Buffers::new();

    /// Double precision takes thousands of instructions, so the baselines see fewer inputs.
    const BASELINES: usize = 4;
    const EVERY: u32 = 16;

    const SPECIAL: [f32; 10] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        0.0,
        -0.0,
        1e-40,
        -1e-40,
        3e38,
        -3e38,
        f32::MIN_POSITIVE,
    ];

    const KERNELS: [(&str, Kernel<'static, AXES>); 10] = [
        ("step", kernels::step),
        ("thermal", kernels::thermal),
        ("subtract", kernels::subtract),
        ("block8", kernels::block8),
        ("interval", kernels::interval),
        ("pulses", kernels::pulses),
        ("cubic_baseline", kernels::cubic),
        ("lookup_14_baseline", kernels::lookup_14),
        ("composite_f32_baseline", kernels::composite_f32),
        ("composite_f64_baseline", kernels::composite_f64),
    ];

    #[cortex_m_rt::entry]
    fn main() -> ! {
        banner("bench");
        #[cfg(feature = "c-reference")]
        super::reference::on_demand();
        let Some(core) = cortex_m::Peripherals::take() else {
            exit(false)
        };
        let stopwatch = Stopwatch::start(core.SYST);

        let mut spans = [Span::NONE; KERNELS.len()];
        let mut inputs = 0;
        for sample in samples() {
            inputs += 1;
            let kernels = match inputs % EVERY {
                0 => KERNELS.len(),
                _ => KERNELS.len() - BASELINES,
            };
            measure(&stopwatch, &sample, &KERNELS[..kernels], &mut spans);
        }
        #[cfg(feature = "c-reference")]
        super::reference::measure(&stopwatch);
        for ((name, _), span) in KERNELS.iter().zip(spans) {
            defmt::println!("bench {=str} {=u32} {=u32}", *name, span.min, span.max);
        }
        defmt::println!("inputs {=u32}", inputs);
        defmt::println!(
            "size compensator {=usize}",
            size_of::<tempco::Compensator<'static, AXES>>()
        );
        defmt::println!(
            "size thermal_half {=usize}",
            size_of::<tempco::ThermalHalf<'static, AXES>>()
        );
        defmt::println!(
            "size ramp_buffer {=usize}",
            size_of::<tempco::RampBuffer<AXES>>()
        );
        defmt::println!(
            "size thermal_state {=usize}",
            size_of::<tempco::ThermalState>()
        );
        defmt::println!("size table {=usize}", size_of::<Table<'static, AXES>>());
        defmt::println!(
            "size cells {=usize}",
            TABLES.iter().map(|table| size_of_val(table.cells())).sum()
        );
        exit(spans.iter().all(Span::is_some))
    }

    /// What is measured: every temperature with a steady gyro, then every special value as
    /// temperature, as gyro sample and as interval.
    fn samples() -> impl Iterator<Item = (f32, f32, f32)> {
        let sweep = (0..=840_u16).map(|quarter| (-60.0 + 0.25 * f32::from(quarter), 0.5, 1.0));
        let special = SPECIAL.into_iter().flat_map(|value| {
            [
                (value, 0.5, 1.0),
                (25.0, value, 1.0),
                (25.0, 0.5, value),
                (value, value, value),
            ]
        });
        sweep.chain(special)
    }

    /// Measures every kernel at one input, from three states: just switched on, after a minute at
    /// a steady temperature (where the input may be a spike), and with the input as the second of
    /// its kind.
    fn measure(
        stopwatch: &Stopwatch,
        &(temp_c, raw, dt_s): &(f32, f32, f32),
        kernels: &[(&str, Kernel<'static, AXES>)],
        spans: &mut [Span],
    ) {
        let table = &TABLES[0];
        let second = Interval::new(table.thermal(), 1.0);
        let inputs = Inputs {
            interval: Interval::new(table.thermal(), dt_s),
            dt_s,
            temp_c,
            raw: [raw; AXES],
            pulses: [raw.to_bits().cast_signed(); AXES],
        };
        let mut output = Output {
            compensated: [0.0; AXES],
            bias: [0.0; AXES],
            point: ThermalPoint::default(),
            status: tempco::Status::OK,
        };
        let fresh = Units::new(table, &BUFFERS, 100);
        let mut steady = fresh.clone();
        steady.start(25.0);
        let calm = Inputs {
            interval: second,
            dt_s: 1.0,
            temp_c: 25.0,
            ..inputs
        };
        for _ in 0..60 {
            steady.advance(&calm, &mut output);
        }
        let mut again = fresh.clone();
        again.start(temp_c);
        again.advance(&inputs, &mut output);
        for mut units in [fresh, steady, again] {
            units.block = [inputs.raw; BLOCK];
            let state = (units, output);
            let counts = |kernel: Kernel<'static, AXES>| {
                let kernel = black_box(kernel);
                stopwatch.counts(&state, |(units, output)| {
                    kernel(units, black_box(&inputs), output);
                })
            };
            let of_empty = counts(kernels::empty);
            for ((_, kernel), span) in kernels.iter().zip(spans.iter_mut()) {
                span.add(counts(*kernel), of_empty);
            }
        }
    }
}

#[cfg(all(target_os = "none", feature = "c-reference"))]
mod reference {
    use core::hint::black_box;

    use tempco::Table;
    use tempco_firmware::table::{AXES, TABLES};
    use tempco_firmware::target::{arguments, exit};
    use tempco_test_images::history::HISTORY;
    use tempco_test_images::measure::{Span, Stopwatch};
    use tempco_test_images::reference::compare::{compare, visit};
    use tempco_test_images::reference::{Compiled, O2, O3};

    const COMPILED: [Compiled; 2] = [O2, O3];
    static CHANNELS: [&Table<'static, AXES>; 2] = [&TABLES[0], &HISTORY[0]];
    /// Hostile updates, and one in how many of their states is measured.
    const UPDATES: u32 = 100_000;
    const EVERY: u32 = 97;

    /// Does what the arguments ask for, if there are any, and ends.
    pub(super) fn on_demand() {
        let Some([what, which]) = arguments::<2>() else {
            return;
        };
        let done = match what.as_str() {
            "compare" => which.parse().is_ok_and(are_equal),
            "trace" => trace(&which),
            _ => false,
        };
        exit(done)
    }

    fn are_equal(updates: u32) -> bool {
        CHANNELS.iter().enumerate().all(|(channel, table)| {
            let compared = compare(&COMPILED, table, updates);
            if let Err(difference) = compared {
                defmt::error!("table {=usize}: {}", channel, difference);
            }
            compared.is_ok()
        })
    }

    /// The states are made by the other compilation, so that every call of this one is in a trace.
    fn trace(name: &str) -> bool {
        let [traced, by] = match COMPILED {
            [first, second] if first.name == name => [first, second],
            [first, second] if second.name == name => [second, first],
            _ => return false,
        };
        for table in CHANNELS {
            visit(&by, table, UPDATES, EVERY, |unit, inputs, outputs| {
                for (_, kernel) in traced.kernels {
                    let (mut unit, mut outputs) = (unit.clone(), *outputs);
                    kernel(&mut unit, inputs, &mut outputs);
                }
            });
        }
        true
    }

    /// Measures both compilations in hostile states.
    pub(super) fn measure(stopwatch: &Stopwatch) {
        let mut spans = COMPILED.map(|compiled| compiled.kernels.map(|_| Span::NONE));
        for table in CHANNELS {
            visit(&O2, table, UPDATES, EVERY, |unit, inputs, outputs| {
                let state = (unit.clone(), *outputs);
                for (compiled, spans) in COMPILED.iter().zip(&mut spans) {
                    let counts = compiled.kernels.map(|(_, kernel)| {
                        let kernel = black_box(kernel);
                        stopwatch.counts(&state, |(unit, outputs)| {
                            kernel(unit, black_box(inputs), outputs);
                        })
                    });
                    for (span, of_kernel) in spans.iter_mut().zip(counts) {
                        span.add(of_kernel, counts[0]);
                    }
                }
            });
        }
        for (compiled, spans) in COMPILED.iter().zip(spans) {
            for ((name, _), span) in compiled.kernels.iter().zip(spans).skip(1) {
                let (min, max) = (span.min, span.max);
                defmt::println!(
                    "c {=str} {=str} {=u32} {=u32}",
                    compiled.name,
                    *name,
                    min,
                    max
                );
            }
        }
    }
}
