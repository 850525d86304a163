//! Image `fixed_bench`: executed instructions of the integer core, counted in QEMU.
//!
//! The method and the output are those of image `bench`; see there. The f32 core, in software
//! floating point where the processor has none, is `f32_step`, `f32_update` and `f32_compensate`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    tempco_firmware::host_main()
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use tempco_firmware::fixed::{FixedSample, converted};
    use tempco_firmware::fixed_kernels::{self as kernels, Inputs, Kernel, Units};
    use tempco_firmware::measure::{Span, Stopwatch};
    use tempco_firmware::table::{AXES, TABLES};
    use tempco_firmware::target::{banner, exit};
    use tempco_fixed::{FixedTable, FixedTerms, INVALID, from_f32};

    const CELLS: usize = TABLES[0].cells().len();
    static TABLE: FixedTable<AXES, CELLS> = converted(&TABLES[0]);

    const SPECIAL: [i32; 8] = [
        INVALID,
        INVALID + 1,
        -(1 << 30),
        -1,
        0,
        1,
        1 << 30,
        i32::MAX,
    ];

    const KERNELS: [(&str, Kernel<'static, AXES, CELLS>); 8] = [
        ("step", kernels::step),
        ("update", kernels::update),
        ("compensate", kernels::compensate),
        ("interval", kernels::interval),
        ("pulses", kernels::pulses),
        ("f32_step", kernels::f32_step),
        ("f32_update", kernels::f32_update),
        ("f32_compensate", kernels::f32_compensate),
    ];

    #[cortex_m_rt::entry]
    fn main() -> ! {
        banner("fixed_bench");
        let Some(core) = cortex_m::Peripherals::take() else {
            exit(false)
        };
        let stopwatch = Stopwatch::start(core.SYST);

        let mut spans = [Span::NONE; KERNELS.len()];
        let mut inputs = 0_u32;
        for sample in samples() {
            inputs += 1;
            measure(&stopwatch, &sample, &mut spans);
        }
        for ((name, _), span) in KERNELS.iter().zip(spans) {
            // The empty function has one as well, its return.
            defmt::println!(
                "bench {=str} {=u32} {=u32}",
                *name,
                span.min + 1,
                span.max + 1
            );
        }
        defmt::println!("inputs {=u32}", inputs);
        defmt::println!(
            "size compensator {=usize}",
            size_of::<tempco_fixed::FixedCompensator<'static, AXES, CELLS>>()
        );
        defmt::println!(
            "size two_rate_compensator {=usize}",
            size_of::<tempco_fixed::FixedTwoRate<'static, AXES, CELLS>>()
        );
        defmt::println!(
            "size pulse_carry {=usize}",
            size_of::<tempco_fixed::PulseCarry>()
        );
        defmt::println!("size table {=usize}", size_of_val(&TABLE));
        defmt::println!(
            "size cells {=usize}",
            CELLS * size_of::<[FixedTerms; AXES]>()
        );
        exit(spans.iter().all(Span::is_some))
    }

    /// Every temperature with a steady gyro, then every special value as temperature, as gyro
    /// sample and as interval.
    fn samples() -> impl Iterator<Item = FixedSample<AXES>> {
        let sample = |temp, raw, dt_us| FixedSample {
            dt_us,
            temp,
            raw: [raw; AXES],
        };
        let sweep = (-60..=150).flat_map(move |c| {
            (0..2).map(move |half| sample((c << 20) + (half << 19) + 12_345, 77_777, 1_000_000))
        });
        let special = SPECIAL.into_iter().flat_map(move |value| {
            [
                sample(value, 77_777, 1_000_000),
                sample(25 << 20, value, 1_000_000),
                sample(25 << 20, 77_777, value.into()),
                sample(value, value, value.into()),
            ]
        });
        sweep.chain(special)
    }

    /// Measures every kernel at one input, from three states: just switched on, after a minute at
    /// a steady temperature, and with the input as the second of its kind.
    fn measure(stopwatch: &Stopwatch, sample: &FixedSample<AXES>, spans: &mut [Span]) {
        let inputs = Inputs::new(&TABLE, &TABLES[0], sample);
        let second = Inputs::new(
            &TABLE,
            &TABLES[0],
            &FixedSample {
                dt_us: 1_000_000,
                temp: from_f32(25.0),
                ..*sample
            },
        );
        let fresh = Units::new(&TABLE, &TABLES[0], 100);
        let mut steady = fresh.clone();
        steady.start(25 << 20);
        for _ in 0..20 {
            steady.advance(&second);
        }
        let mut again = fresh.clone();
        again.start(sample.temp);
        again.advance(&inputs);

        for state in [&fresh, &steady, &again] {
            let counts = |kernel: Kernel<'static, AXES, CELLS>| {
                let kernel = black_box(kernel);
                stopwatch.counts(state, |units| kernel(units, black_box(&inputs)))
            };
            let of_empty = counts(kernels::empty);
            for ((_, kernel), span) in KERNELS.iter().zip(spans.iter_mut()) {
                span.add(counts(*kernel), of_empty);
            }
        }
    }
}
