//! What the image `bench` measures.

use tempco_firmware::table::{AXES, TABLES};
use tempco_test_images::kernels::{self, BLOCK, Buffers, Inputs, Units};

/// The bench must measure working code.
#[test]
fn kernels_do_what_they_are_named_after() {
    let table = &TABLES[0];
    let interval = tempco::Interval::new(table.thermal(), 1.0);
    let inputs = Inputs {
        interval,
        dt_s: 1.0,
        temp_c: 26.0,
        raw: [1.0, 2.0, 3.0],
        pulses: [1, 2, 3],
    };
    let buffers = Buffers::new();
    let mut units = Units::new(table, &buffers, 1);
    units.start(25.0);
    let mut single = tempco::Compensator::new(table);
    single.start(25.0);
    let expected = single.step(&interval, 26.0, inputs.raw);

    let mut output = expected;
    output.bias = [f32::NAN; AXES];
    kernels::empty(&mut units, &inputs, &mut output);
    assert!(output.bias[0].is_nan());
    kernels::step(&mut units, &inputs, &mut output);
    assert_eq!(output, expected);
    kernels::thermal(&mut units, &inputs, &mut output);
    output.compensated = [f32::NAN; AXES];
    kernels::subtract(&mut units, &inputs, &mut output);
    assert_eq!(output, expected);
    units.block = [inputs.raw; BLOCK];
    kernels::block8(&mut units, &inputs, &mut output);
    assert_eq!(units.block, [expected.compensated; BLOCK]);
    kernels::interval(&mut units, &inputs, &mut output);
    assert_eq!(units.interval, interval);
    kernels::pulses(&mut units, &inputs, &mut output);
    assert_eq!(units.pulses, [1, 2, 3], "no ramp");

    kernels::cubic(&mut units, &inputs, &mut output);
    for axis in 0..AXES {
        let [c0, c1, c2, c3] = units.baselines.cubic.coefficients[axis].map(f64::from);
        let bias = c0 + c1 + c2 + c3;
        assert!((f64::from(output.bias[axis]) - bias).abs() < 1e-6);
        assert_eq!(
            output.compensated[axis],
            inputs.raw[axis] - output.bias[axis]
        );
    }
    units
        .baselines
        .cubic
        .compensate(1e9, inputs.raw, &mut output);
    let hottest = output.bias;
    units
        .baselines
        .cubic
        .compensate(80.0, inputs.raw, &mut output);
    assert_eq!(output.bias, hottest);
}
