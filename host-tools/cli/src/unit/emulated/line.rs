//! The unit's serial line as a socket of a name of its own.

use std::io::{self, Read, Write};
use std::net::Shutdown;
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::{fs, thread};

use anyhow::{Context, Result, ensure};

/// Listens at a path. The socket of a unit that was killed gives way.
pub(super) fn listen(path: &Path) -> Result<UnixListener> {
    let shown = || format!("--socket {}", path.display());
    if let Ok(found) = path.symlink_metadata() {
        ensure!(
            found.file_type().is_socket() && UnixStream::connect(path).is_err(),
            "{}: expected a path where nothing is",
            shown()
        );
        fs::remove_file(path).with_context(shown)?;
    }
    UnixListener::bind(path).with_context(shown)
}

/// Passes bytes both ways until one side closes.
pub(super) fn relay(client: &UnixStream, unit: &UnixStream) {
    thread::scope(|scope| {
        scope.spawn(|| pass(client, unit));
        pass(unit, client);
    });
}

/// Passes bytes one way, and closes both sides at the end.
fn pass(mut from: &UnixStream, mut to: &UnixStream) {
    let mut block = [0; 4096];
    let mut step = || -> io::Result<usize> {
        let count = from.read(&mut block)?;
        to.write_all(&block[..count])?;
        Ok(count)
    };
    while matches!(step(), Ok(1..)) {}
    for side in [from, to] {
        // It may be closed already.
        _ = side.shutdown(Shutdown::Both);
    }
}
