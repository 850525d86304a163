//! Replays a log through the firmware in QEMU.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use crate::{Board, Error, Options, Run, run};

/// Slower than QEMU on any host: bytes of samples worked off in a second.
const LEAST_BYTES_PER_S: usize = 100_000;

/// Runs a `replay` image over `samples` and returns the outcomes it wrote, with how it ended.
///
/// Both are streams in the format of `tempco-replay`. After a failure the outcomes are those up
/// to it.
///
/// # Errors
/// As of [`run()`]; a stream that the image refuses shows in the exit code and the log.
pub fn replay(elf: &Path, board: Board, samples: &[u8]) -> Result<(Vec<u8>, Run), Error> {
    let folder = tempfile::tempdir().map_err(Error::file(&std::env::temp_dir()))?;
    let input = folder.path().join("samples.bin");
    let output = folder.path().join("outcomes.bin");
    fs::write(&input, samples).map_err(Error::file(&input))?;

    let patience_s = 60 + samples.len() / LEAST_BYTES_PER_S;
    let options = Options {
        time_limit: Duration::from_secs(patience_s as u64),
        // Names without a folder: no path of the host can be too long or hold a space.
        folder: Some(folder.path().to_owned()),
        ..Options::default()
    };
    let run = run(elf, board, &["samples.bin", "outcomes.bin"], &options)?;
    match fs::read(&output) {
        Ok(outcomes) => Ok((outcomes, run)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok((Vec::new(), run)),
        Err(error) => Err(Error::file(&output)(error)),
    }
}
