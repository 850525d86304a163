//! The images as such: where they lie, how they fail, and what their code costs.

mod support;

use std::fs;
use std::time::Duration;

use support::{WORKSPACE, image};
use tempco_qemu::{Board, Error, Layout, Options, build, run};

#[test]
fn each_board_has_its_own_memory() {
    let memory = |board| match board {
        Board::Stm32F405 => (0x0800_0000, 0x2000_0000, 0x2002_0000),
        Board::Mps2An505 => (0x1000_0000, 0x3800_0000, 0x3820_0000),
        Board::Microbit => (0x0000_0000, 0x2000_0000, 0x2000_4000),
        _ => (0x0000_0000, 0x2000_0000, 0x2040_0000),
    };
    for board in Board::ALL {
        let layout = Layout::of(&image(board, "replay", None)).unwrap();
        println!("{board}: {layout:#x?}");
        let places = (
            layout.vector_table,
            layout.ram_start.unwrap(),
            layout.stack_top,
        );
        assert_eq!(places, memory(board), "{board}");
        assert!((10_000..64_000).contains(&layout.flash_bytes), "{layout:?}");
        assert!(layout.ram_bytes < 1000, "{layout:?}");
    }
}

/// Without it the compiler does not know which instructions are fast.
#[test]
fn images_are_compiled_for_the_processor_of_the_boards() {
    for board in Board::ALL {
        let elf = fs::read(image(board, "replay", None)).unwrap();
        let name = format!("{}\0", board.cpu());
        let found = elf
            .windows(name.len())
            .any(|window| window == name.as_bytes());
        assert!(found, "{board}");
    }
}

#[test]
fn failures_are_reported_and_end_the_run() {
    for board in Board::ALL {
        let faults = image(board, "faults", None);
        let line = |kind| {
            let run = run(&faults, board, &[kind], &Options::default()).unwrap();
            assert_eq!(run.exit_code, 1, "{board}: {kind}");
            assert_eq!(run.log.len(), 2, "{:#?}", run.log);
            run.log[1].clone()
        };
        assert!(line("panic").contains("on purpose"));
        assert!(line("hardfault").contains("hard fault at 0x"));
        assert!(line("interrupt").contains("unexpected interrupt -2"));
        assert!(line("nonsense").contains("usage"));
    }
}

#[test]
fn an_image_that_hangs_is_ended() {
    let board = Board::Mps2An386;
    let options = Options {
        time_limit: Duration::from_secs(2),
        ..Options::default()
    };
    let error = run(&image(board, "faults", None), board, &["hang"], &options).unwrap_err();
    assert!(matches!(&error, Error::TimeLimit { log, .. } if log.len() == 1));
    assert!(error.to_string().contains("did not end within 2s"));
}

#[test]
fn what_is_no_image_is_refused() {
    let manifest = WORKSPACE.root().join("Cargo.toml");
    let board = Board::Mps2An386;
    let error = run(&manifest, board, &[], &Options::default()).unwrap_err();
    assert!(matches!(error, Error::Image { .. }), "{error}");
    assert!(matches!(Layout::of(&manifest), Err(Error::Image { .. })));
    let error = build(&WORKSPACE, board, "no-such-image", None).unwrap_err();
    assert!(error.to_string().contains("no-such-image"), "{error}");
}

/// Instructions of an empty function, which the image does not count and the documents do.
const CALL: u32 = 3;

/// The timing promise of the core: no instruction more or less, whatever the data. The page
/// for who integrates the core has these figures.
#[test]
fn costs_do_not_depend_on_data_and_repeat_exactly() {
    let board = Board::Mps2An386;
    let bench = image(board, "bench", None);
    let options = Options {
        icount: true,
        ..Options::default()
    };
    let first = run(&bench, board, &[], &options).unwrap();
    let second = run(&bench, board, &[], &options).unwrap();
    println!("{:#?}", first.log);
    assert!(first.succeeded());
    assert_eq!(first.log, second.log);
    let words: Vec<Vec<&str>> = first
        .log
        .iter()
        .map(|line| line.split(' ').collect())
        .collect();
    let numbers = |kind: &str, name: &str| {
        let found = words.iter().find(|words| words[..2] == [kind, name]);
        found.unwrap_or_else(|| panic!("{kind} {name}"))[2..].to_vec()
    };
    let cost = |name| {
        let [min, max] = numbers("bench", name)[..] else {
            panic!("{name}")
        };
        assert_eq!(min, max, "{name}");
        min.parse::<u32>().unwrap() + CALL
    };
    let size = |name| numbers("size", name)[0];
    let [step, thermal, correct, block, _] =
        ["step", "thermal", "subtract", "block8", "pulses"].map(cost);

    let page = fs::read_to_string(WORKSPACE.root().join("docs/porting.md")).unwrap();
    for figures in [
        format!("{thermal} per temperature (`update` and `publish`)"),
        format!("{correct} per sample (`correct`), {block} per block of eight"),
        format!("`step` of one rate {step}"),
        format!("`ThermalHalf` {} bytes", size("thermal_half")),
        format!("`RampBuffer` {}", size("ramp_buffer")),
        format!("`Compensator` {}", size("compensator")),
        format!("a `Table` {}", size("table")),
    ] {
        assert!(page.contains(&figures), "porting.md: {figures}");
    }
}
