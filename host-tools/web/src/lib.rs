//! Makes the page that does the work of the command in a browser: one file without a network.
//!
//! ```text
//! tempco-cli --cargo, for WASI--> tempco.wasm --gzip, base 64--+
//! page/: page.html, style.css, scripts of the page ------------+-> tempco.html
//! page/: files.js, wasi.js, worker.js -------------------------+
//!
//! scripts of the page: logs -> fit -> result, by job, elements, zip; page has what the user does
//! ```
//!
//! The command itself runs there, unchanged, so that its tables, verdicts and messages are the same.
//! `wasi.js` is the system that it asks for files, time and chance.
#![forbid(unsafe_code)]

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use data_encoding::BASE64;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};
use tempco_qemu::{Workspace, checked, clean_cargo, ensure_rust_target};

/// What a browser runs: WebAssembly that asks for files by WASI preview 1.
const TARGET: &str = "wasm32-wasip1";

const PAGE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/style.css");
/// The scripts of the page, one text.
const SCRIPT: &str = concat!(
    include_str!("../page/elements.js"),
    include_str!("../page/job.js"),
    include_str!("../page/logs.js"),
    include_str!("../page/zip.js"),
    include_str!("../page/result.js"),
    include_str!("../page/fit.js"),
    include_str!("../page/page.js"),
);
/// The scripts of its workers.
const WORKER: &str = concat!(
    include_str!("../page/files.js"),
    include_str!("../page/wasi.js"),
    include_str!("../page/worker.js")
);

/// Makes `folder/tempco.html`, and returns its path.
///
/// # Errors
/// The command does not build, or a file cannot be read or written.
pub fn page(workspace: &Workspace, folder: &Path) -> Result<PathBuf> {
    ensure_rust_target(workspace, TARGET)?;
    let target_dir = folder.join("build");
    let mut cargo = clean_cargo(workspace, "build", &target_dir);
    cargo
        .args(["--locked", "--package", "tempco-cli", "--profile", "page"])
        .args(["--target", TARGET]);
    checked(&mut cargo)?;
    let built = target_dir.join(TARGET).join("page/tempco.wasm");
    let command = fs::read(&built).with_context(|| built.display().to_string())?;
    let path = folder.join("tempco.html");
    fs::write(&path, assembled(&command)?).with_context(|| path.display().to_string())?;
    Ok(path)
}

/// The page with a command, a program for WASI, in it.
///
/// # Errors
/// The command cannot be packed.
pub fn assembled(command: &[u8]) -> Result<String> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(command)?;
    let command = BASE64.encode(&packed.finish()?);
    // The page's own script alone may run; it may start workers, and connect to nothing.
    let script = BASE64.encode(&Sha256::digest(SCRIPT));
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{script}' 'wasm-unsafe-eval'; worker-src blob:; \
         style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
    );
    let mut page = PAGE.to_owned();
    for (place, text) in [
        ("@POLICY@", &policy[..]),
        ("@STYLE@", STYLE.trim_end()),
        ("@VERSION@", env!("CARGO_PKG_VERSION")),
        ("@WORKER@", WORKER),
        ("@SCRIPT@", SCRIPT),
        ("@COMMAND@", &command),
    ] {
        page = page.replacen(place, text, 1);
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_has_its_place_and_nothing_comes_from_elsewhere() {
        let page = assembled(b"a command").unwrap();
        for place in [
            "@POLICY@",
            "@STYLE@",
            "@VERSION@",
            "@COMMAND@",
            "@WORKER@",
            "@SCRIPT@",
        ] {
            assert!(!page.contains(place), "{place}");
            assert_eq!(PAGE.matches(place).count(), 1, "{place}");
        }
        assert!(page.contains(SCRIPT) && page.contains(WORKER));
        for of_elsewhere in ["http:", "https:", "src=", "import ", "fetch("] {
            assert!(!page.contains(of_elsewhere), "{of_elsewhere}");
        }
        // A script ends at the first end tag, wherever it stands.
        assert!(!SCRIPT.contains("</script") && !WORKER.contains("</script"));
    }
}
