//! `docs/porting.md` is followed to the letter, in a folder next to the checkout, and its tables
//! are what they describe.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

use tempco::{Status, Validity};
use tempco_image::{AlignedBytes, Image};
use tempco_qemu::{Layout, TARGET, Workspace, checked, ensure_qemu, ensure_target};
use tempco_tests::page::follow;
use tempco_tests::{Bench, root};

fn page() -> String {
    fs::read_to_string(root().join("docs/porting.md")).unwrap()
}

/// Brings what the programs of the page are built with, in the versions of the checkout.
fn fetch(workspace: &Workspace) {
    let mut fetch = Command::new("cargo");
    fetch
        .current_dir(workspace.root())
        .args(["fetch", "--quiet", "--locked", "--target", TARGET]);
    checked(&mut fetch).unwrap_or_else(|error| panic!("{error}"));
}

/// Bytes of the cells of a flash image with one channel of three axes.
fn cell_bytes(image: &[u8]) -> u64 {
    let mut place = Box::new(AlignedBytes([0xff; 65_536]));
    place.0[..image.len()].copy_from_slice(image);
    let image = Image::read(&place.0).unwrap();
    size_of_val(image.table::<3>(0).unwrap().cells()) as u64
}

/// The three programs build without a warning and run in QEMU; the `cmp` of the page finds
/// no byte that differs between the log of the first and what `tempco apply` computes.
#[test]
fn the_page_leads_to_units_that_run() {
    let workspace = Workspace::find().unwrap();
    ensure_target(&workspace).unwrap();
    ensure_qemu(&workspace).unwrap();
    fetch(&workspace);
    let bench = Bench::new();
    symlink(workspace.root(), bench.path("tempco")).unwrap();
    let folder = bench.path("my-gyro");
    fs::create_dir(&folder).unwrap();
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();

    let target = workspace.target_dir();
    // What others have built of the dependencies is not built again.
    let environment = [
        ("CARGO_TARGET_DIR", target.to_str().unwrap()),
        ("CARGO_NET_OFFLINE", "true"),
    ];
    let page = page();
    let said = follow(&page, &folder, &environment);
    println!("{said}");
    assert!(!said.contains("warning:"), "{said}");
    let outcome = page
        .split("prints when the validity changes:")
        .nth(1)
        .unwrap();
    let outcome = outcome.split("```").nth(1).unwrap();
    let outcome = outcome.strip_prefix("text\n").unwrap();
    assert!(outcome.contains("Degraded"), "{outcome}");
    assert!(said.contains(outcome), "{outcome}\n{said}");

    let log = fs::read_to_string(folder.join("unit.csv")).unwrap();
    for status in ["settling", "ok"] {
        let rows = log.lines().filter(|row| row.ends_with(status)).count();
        assert!(rows > 100, "{rows} rows of {status}");
    }

    let fifo = Layout::of(&target.join(TARGET).join("release/fifo")).unwrap();
    let cells = cell_bytes(&fs::read(folder.join("set/table.bin")).unwrap());
    let found = (fifo.flash_bytes - cells) as f64;
    let committed = page.split("without its cells: ").nth(1).unwrap();
    let committed: f64 = committed.split(' ').next().unwrap().parse().unwrap();
    // As of the committed sizes of other images.
    assert!((found - committed).abs() <= 0.02 * committed, "{found}");
}

/// The page has every flag with its class, in the order of the bits.
#[test]
fn the_page_has_every_flag_with_its_class() {
    let page = page();
    let table = page.split("| flag | class |").nth(1).unwrap();
    let rows = table.lines().skip(2).take_while(|line| !line.is_empty());
    let found: Vec<(String, String)> = rows
        .map(|row| {
            let mut cells = row
                .split('|')
                .map(|cell| cell.trim().replace('`', ""))
                .skip(1);
            (cells.next().unwrap(), cells.next().unwrap())
        })
        .collect();
    let expected = Status::NAMES.map(|(flag, name)| {
        let is_invalid = flag.validity() == Validity::Invalid;
        let class = if is_invalid { "invalid" } else { "degraded" };
        (name.to_owned(), class.to_owned())
    });
    assert_eq!(found, expected);
}
