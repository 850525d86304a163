//! Where the bytes come from and go to.

use std::io;
use std::path::Path;
use std::time::Duration;

use serial2::SerialPort;

use crate::Error;

/// How long a read waits for a first byte. It bounds how late the end of a longer wait is seen.
const READ_TIMEOUT: Duration = Duration::from_millis(20);
/// How long a write waits for room: longer than a frame takes on the slowest usual line.
const WRITE_TIMEOUT: Duration = Duration::from_secs(5);

/// A line to a unit. A read returns what there is, and fails with
/// [`TimedOut`](io::ErrorKind::TimedOut) or [`WouldBlock`](io::ErrorKind::WouldBlock) after a
/// fraction of a second without any.
pub trait Port: io::Read + io::Write + Send {}

impl<P: io::Read + io::Write + Send> Port for P {}

/// Opens the port at a path: the unix-domain socket of an emulator, or else a serial port with 8
/// data bits, no parity, one stop bit and no flow control at `baud`.
///
/// # Errors
/// [`Error::Open`]: nothing there, no permission, a baud rate that it cannot have.
pub fn open(path: &Path, baud: u32) -> Result<Box<dyn Port>, Error> {
    let opened = if is_socket(path) {
        socket(path)
    } else {
        serial(path, baud)
    };
    opened.map_err(|cause| Error::Open {
        port: path.to_owned(),
        baud,
        cause,
    })
}

#[cfg(unix)]
fn is_socket(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let metadata = path.metadata();
    metadata.is_ok_and(|metadata| metadata.file_type().is_socket())
}

#[cfg(unix)]
fn socket(path: &Path) -> io::Result<Box<dyn Port>> {
    let stream = std::os::unix::net::UnixStream::connect(path)?;
    stream.set_read_timeout(Some(READ_TIMEOUT))?;
    stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
    Ok(Box::new(stream))
}

#[cfg(not(unix))]
fn is_socket(_: &Path) -> bool {
    false
}

#[cfg(not(unix))]
fn socket(_: &Path) -> io::Result<Box<dyn Port>> {
    Err(io::ErrorKind::Unsupported.into())
}

fn serial(path: &Path, baud: u32) -> io::Result<Box<dyn Port>> {
    let mut port = SerialPort::open(path, baud)?;
    port.set_read_timeout(READ_TIMEOUT)?;
    port.set_write_timeout(WRITE_TIMEOUT)?;
    // What came before anybody listened is of no session.
    port.discard_buffers()?;
    Ok(Box::new(port))
}
