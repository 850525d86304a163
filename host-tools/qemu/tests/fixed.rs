//! The integer core on processors without floating point: the host's bits, and what it costs.

mod support;

use support::{example, image};
use tempco_firmware::fixed::{converted, digest};
use tempco_fixed::FixedTable;
use tempco_qemu::{Board, Options, run};

static TABLE: FixedTable<3, { example::TABLES[0].cells().len() }> = converted(&example::TABLES[0]);

/// Neither has floating point; the M0 has no 64-bit multiplication either.
const BOARDS: [Board; 2] = [Board::Mps2An385, Board::Microbit];

#[test]
fn a_hundred_thousand_samples_are_the_same_on_m0_and_m3() {
    const SAMPLES: u32 = 120_000;
    let expected = format!("digest {:08x} {SAMPLES}", digest(&TABLE, SAMPLES));
    // A digest that does not see the samples would agree too.
    assert_ne!(digest(&TABLE, SAMPLES - 1), digest(&TABLE, SAMPLES));
    for board in BOARDS {
        let run = run(
            &image(board, "fixed", None),
            board,
            &[],
            &Options::default(),
        )
        .unwrap();
        assert!(run.succeeded(), "{board}: {:#?}", run.log);
        assert_eq!(run.log[1], expected, "{board}");
    }
}

/// The stream leads everywhere: every flag is raised, and most of it is taken in.
#[test]
fn the_stream_raises_every_flag() {
    use tempco::Status;
    let mut unit = tempco_fixed::FixedCompensator::new(&TABLE);
    let (mut seen, mut calm) = (Status::OK, 0);
    for sample in tempco_firmware::fixed::samples::<3>(120_000) {
        let interval = tempco_fixed::FixedInterval::from_micros(TABLE.thermal(), sample.dt_us);
        let status = unit.step(&interval, sample.temp, sample.raw).status;
        seen |= status;
        calm += u32::from(status == Status::OK);
    }
    for (flag, name) in Status::NAMES {
        assert!(seen.contains(flag), "{name} is never raised");
    }
    assert!(calm > 2000, "{calm} samples without a remark");
    assert!(unit.thermal_state().restarts() > 10);
}

/// The timing promise: no instruction more or less, whatever the data, also where every selection
/// would be a branch.
#[test]
fn costs_do_not_depend_on_data() {
    let options = Options {
        icount: true,
        time_limit: std::time::Duration::from_secs(300),
        ..Options::default()
    };
    for board in BOARDS {
        let run = run(&image(board, "fixed_bench", None), board, &[], &options).unwrap();
        println!("{:#?}", run.log);
        assert!(run.succeeded());
        for name in ["step", "update", "compensate", "pulses"] {
            let start = format!("bench {name} ");
            let line = run.log.iter().find_map(|line| line.strip_prefix(&start));
            let (least, most) = line.unwrap().split_once(' ').unwrap();
            assert_eq!(least, most, "{board}: {name}");
        }
    }
}
