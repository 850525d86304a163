//! Numbers on the command line: whatever is given, every command ends, and none panics.

use tempco_log::parallel;
use tempco_tests::Bench;

/// Numbers that no option can take.
const BAD_NUMBERS: [&str; 6] = ["nan", "inf", "-inf", "1e300", "-1e300", "-1"];

/// Numbers that some can take.
const NUMBERS: [&str; 2] = ["0", "1e-300"];

/// Ranges of such numbers.
const RANGES: [&str; 7] = [
    "nan:1",
    "-inf:inf",
    "0:inf",
    "-1e300:1e300",
    "0:0",
    "0:1e-300",
    "1e15:1000000000000100",
];

/// Options that count row by row.
const BY_ROW: [&str; 6] = [
    "--rate-tau",
    "--kappa",
    "--max-slew",
    "--tau",
    "--scale-factor",
    "--instance",
];

/// Commands, with the options of theirs that take numbers, and those that take ranges. What stands
/// for a serial port is none.
const COMMANDS: [(&str, &[&str], &[&str]); 19] = [
    ("columns log.csv", &["--scale-factor", "--instance"], &[]),
    ("summarise log.csv --out OUT", &BY_ROW, &["--exclude"]),
    (
        "fit log.csv --serial S1 --out OUT --model composite",
        &BY_ROW,
        &["--segments", "--exclude"],
    ),
    (
        "fit log.csv --serial S1 --out OUT --no-report",
        &["--rate-tau", "--kappa", "--max-slew"],
        &["--segments", "--exclude"],
    ),
    (
        "fit --batch units --out OUT --no-report --keep-outliers",
        &["--tau", "--max-slew"],
        &["--segments", "--exclude"],
    ),
    (
        "apply set/coefficients.json log.csv --out OUT",
        &["--scale-factor", "--instance"],
        &[],
    ),
    (
        "evaluate set/coefficients.json log.csv --report OUT",
        &["--tau", "--scale-factor", "--instance"],
        &[],
    ),
    (
        "replay set/coefficients.json log.csv --target /dev/null",
        &["--baud", "--scale-factor", "--instance"],
        &[],
    ),
    (
        "simulate --unit paper --profile short --out OUT",
        &["--draw", "--rate", "--seed"],
        &[],
    ),
    (
        "export imu/coefficients.json --to px4 --out OUT",
        &["--instance", "--device-id"],
        &[],
    ),
    (
        "import imu.params --from px4 --out OUT",
        &["--instance"],
        &[],
    ),
    (
        "flash-set set/coefficients.json --port /dev/null",
        &["--baud", "--scale-factor"],
        &[],
    ),
    (
        "monitor --port /dev/null",
        &["--baud", "--period", "--count"],
        &[],
    ),
    ("faults --port /dev/null", &["--baud"], &[]),
    (
        "record --port /dev/null --out OUT",
        &["--baud", "--period", "--duration"],
        &[],
    ),
    (
        "rezero --port /dev/null",
        &["--baud", "--seconds", "--expected"],
        &[],
    ),
    ("bit --port /dev/null", &["--baud"], &[]),
    ("bank --port /dev/null", &["--baud"], &[]),
    ("unit --qemu --socket /dev/null", &["--seed"], &[]),
];

/// Options whose value is no number.
const OTHERS: [&str; 26] = [
    "--against",
    "--axis",
    "--batch",
    "--board",
    "--figures",
    "--from",
    "--join",
    "--map",
    "--model",
    "--out",
    "--overlap",
    "--port",
    "--profile",
    "--report",
    "--serial",
    "--show",
    "--socket",
    "--table",
    "--target",
    "--temp",
    "--time",
    "--to",
    "--truth",
    "--unit",
    "--use",
    "--where",
];

/// A log of pulses between 10 and 40 degC.
fn log() -> String {
    let mut log = String::from("time_s,temp_c,x_pulses\n");
    for row in 0..600 {
        let temp_c = 25.0 + 15.0 * (f64::from(row) * 0.01).sin();
        let pulses = 100 + (0.5 * temp_c) as u32 + row % 7;
        log.push_str(&format!("{row},{temp_c:.3},{pulses}\n"));
    }
    log
}

/// Parameters of PX4, of a gyro whose bias rises with temperature.
fn parameters() -> String {
    let mut text = String::new();
    let mut line = |name: &str, value: f64| {
        text.push_str(&format!("1\t1\tTC_G0_{name}\t{value}\t9\n"));
    };
    for (name, value) in [("TMIN", 10.0), ("TMAX", 40.0), ("TREF", 25.0)] {
        line(name, value);
    }
    for axis in 0..3 {
        for (power, value) in [(0, 0.01), (1, 1e-4), (2, 1e-6), (3, 1e-8)] {
            line(&format!("X{power}_{axis}"), value);
        }
    }
    text
}

#[test]
fn every_command_ends_whatever_number_it_is_given() {
    let bench = Bench::new();
    bench.write("log.csv", &log());
    bench.write("units/A1.csv", &log());
    bench.write("units/B2.csv", &log());
    bench.ok("fit log.csv --serial S1 --out set --model composite --segments 10:40 --no-report");
    bench.write("imu.params", &parameters());
    bench.ok("import imu.params --from px4 --unit dps --out imu");
    let mut runs = Vec::new();
    for (command, numbers, ranges) in COMMANDS {
        let mut add = |options: &[&str], values: &[&str], is_bad: bool| {
            for option in options {
                runs.extend(values.iter().map(|value| {
                    let command = command.replace("OUT", &format!("out{option}{value}"));
                    (format!("{command} {option}={value}"), is_bad)
                }));
            }
        };
        add(numbers, &BAD_NUMBERS, true);
        add(numbers, &NUMBERS, false);
        add(ranges, &RANGES, false);
    }
    parallel::map(&runs, |(args, is_bad)| {
        let ran = bench.run_to_its_end(args);
        let codes = if *is_bad { 2..=2 } else { 0..=2 };
        assert!(
            codes.contains(&ran.code),
            "{args}: {}: {}",
            ran.code,
            ran.err
        );
        assert!(!ran.err.contains("panicked"), "{args}: {}", ran.err);
        assert!(ran.code == 0 || !ran.err.is_empty(), "{args}");
    });
}

/// An option that is new has to be put above.
#[test]
fn every_option_of_a_number_is_tried() {
    let bench = Bench::new();
    let names = |help: &str| -> Vec<String> {
        let lines = help.lines().map(str::trim_start);
        let options = lines.filter_map(|line| line.strip_prefix("--")?.split_once(" <"));
        options.map(|(name, _)| format!("--{name}")).collect()
    };
    let commands = bench.ok("--help");
    let commands = commands
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1);
    let commands: Vec<&str> = commands
        .map_while(|line| line.split_whitespace().next())
        .filter(|command| *command != "help")
        .collect();
    assert!(commands.contains(&"fit") && commands.contains(&"faults"));
    for command in commands {
        let tried: Vec<&str> = COMMANDS
            .iter()
            .filter(|(args, _, _)| args.split(' ').next() == Some(command))
            .flat_map(|(_, numbers, ranges)| numbers.iter().chain(*ranges).copied())
            .collect();
        for option in names(&bench.ok(&format!("{command} --help"))) {
            let known = tried.contains(&option.as_str()) || OTHERS.contains(&option.as_str());
            assert!(known, "{command} {option}");
        }
    }
}
