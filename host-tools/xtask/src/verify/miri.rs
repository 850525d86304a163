//! The tests of the core under Miri, which looks at every access and every operation.

use anyhow::Result;
use tempco_qemu::Workspace;

use super::tools::{NIGHTLY, cargo_of, ensure_toolchain};
use super::{Measured, TESTS, output_folder};
use crate::run::run_and_read;
use crate::test::count;

const BIG_ENDIAN: &str = "s390x-unknown-linux-gnu";

pub(super) fn both_endians(workspace: &Workspace) -> Result<Measured> {
    ensure_toolchain(workspace, NIGHTLY, &["miri", "rust-src"])?;
    let mut reached = true;
    let mut figures = Vec::new();
    for target in [None, Some(BIG_ENDIAN)] {
        let mut command = cargo_of(workspace, NIGHTLY, &["miri", "test", "--no-fail-fast"]);
        command.args(TESTS);
        if let Some(target) = target {
            command.args(["--target", target]);
        }
        // A folder of its own: cargo takes the products of another nightly of the same day for
        // its own, and Miri then does not find the crates in them.
        command
            .arg("--target-dir")
            .arg(output_folder(workspace)?.join("miri"));
        // What it reports is to depend on the tests alone.
        command.env_remove("MIRIFLAGS");
        let (output, succeeded) = run_and_read(workspace, &mut command)?;
        let [passed, failed, ignored] =
            ["passed", "failed", "ignored"].map(|what| count(&output, what));
        reached &= succeeded && failed == 0 && passed > 0;
        let target = target.unwrap_or("host");
        let end = if succeeded {
            ""
        } else {
            ", ended with a fault"
        };
        figures.push(format!(
            "{target}: {passed} tests passed, {failed} failed, {ignored} ignored{end}"
        ));
    }
    Ok(Measured {
        reached,
        figure: figures.join("; "),
    })
}
