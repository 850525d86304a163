//! Sets as parameters of autopilots, and back, by the command.

use std::fs;

use tempco_tests::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.ok("simulate --unit mems --profile calibration --rate 0.5 --out log.csv");
    bench.ok("simulate --unit mems --profile verification --seed 2 --rate 0.5 --out other.csv");
    bench.run("fit log.csv --serial M1 --out M1 --no-report --model composite");
    bench
}

/// The improvement of each axis of an evaluation, a share.
fn improvements(bench: &Bench, arguments: &str) -> Vec<f64> {
    let ran = bench.run(arguments);
    let json: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    let axes = json["axes"].as_array().unwrap().iter();
    axes.map(|axis| axis["improvement"].as_f64().unwrap())
        .collect()
}

#[test]
fn the_exported_form_is_judged_after_its_import() {
    let bench = bench();
    let whole = improvements(&bench, "evaluate M1/coefficients.json other.csv --json");
    for (to, name) in [("px4", "TC_G0_X3_2\t"), ("ardupilot", "INS_TCAL1_GYR3_Z,")] {
        let said = bench.run(&format!(
            "export M1/coefficients.json --to {to} --device-id 7 --out {to}.params"
        ));
        assert_eq!(said.code, 0, "{}", said.err);
        assert!(said.out.contains("lost: rate, history"), "{}", said.out);
        let text = fs::read_to_string(bench.path(&format!("{to}.params"))).unwrap();
        assert!(text.contains(name), "{text}");
        let said = bench.ok(&format!("import {to}.params --from {to} --unit dps"));
        assert!(
            said.contains("quadratic cells") && said.contains("% of the bias range"),
            "{said}"
        );
        let cubic = improvements(
            &bench,
            &format!("evaluate {to}/coefficients.json other.csv --json"),
        );
        for (cubic, whole) in cubic.iter().zip(&whole) {
            // Without the rate terms it is worse, but far better than none.
            assert!(0.6 < *cubic && cubic < whole, "{to}: {cubic} {whole}");
        }
    }
}

#[test]
fn parameters_are_printed_without_a_file_and_without_a_device_that_is_said() {
    let bench = bench();
    let ran = bench.run("export M1/coefficients.json --to px4");
    assert_eq!(ran.code, 0);
    assert_eq!(ran.out.lines().count(), 18, "{}", ran.out);
    assert!(
        ran.out
            .lines()
            .skip(1)
            .all(|line| line.split('\t').count() == 5)
    );
    assert!(
        ran.err.contains("cubic off by") && ran.err.contains("TC_G0_ID is 0"),
        "{}",
        ran.err
    );
}

#[test]
fn what_cannot_be_exported_or_imported_is_refused_with_the_reason() {
    let bench = bench();
    bench.write("some.params", "1\t1\tTC_G0_TMIN\t0\t9\n");
    bench.write(
        "pulses.csv",
        "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,\
        a2_pulses_per_c2\nX,1,-15,80,0.0173,-0.0014,0.00001\nY,1,-15,80,0.0064,0.0004,-0.00004\n\
        Z,1,-15,80,0.0064,0.0004,-0.00004\n",
    );
    for (arguments, words) in [
        (
            "export M1/coefficients.json --to px4 --instance 4",
            "expected 0 to 3",
        ),
        (
            "export M1/coefficients.json --to ardupilot --instance 0",
            "expected 1 to 3",
        ),
        ("export pulses.csv --to px4", "--scale-factor"),
        ("export none.json --to px4", "none.json"),
        ("import some.params --from px4", "no parameter TC_G0_X0_0"),
        ("import log.csv --from ardupilot", "log.csv: line 1"),
        (
            "import some.params --from px4 --unit g",
            "expected dph, dps or radps",
        ),
    ] {
        let ran = bench.run(arguments);
        assert_eq!(ran.code, 2, "{arguments}: {}", ran.out);
        assert!(ran.err.contains(words), "{arguments}: {}", ran.err);
    }
}
