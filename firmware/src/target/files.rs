//! Files of the host, through semihosting.

use core::ffi::CStr;

use embedded_io::{ErrorKind, ErrorType};
use heapless::{String, Vec};
use semihosting::experimental::env;
use semihosting::fs::File;
use semihosting::io::{Read as _, Write as _};

/// Most bytes of the command line, and of one argument with its terminator.
const COMMAND_LINE: usize = 1024;

/// An argument of the command line.
pub type Argument = String<COMMAND_LINE>;

/// The first `N` arguments behind the program's name; `None` if there are not exactly `N`.
pub fn arguments<const N: usize>() -> Option<[Argument; N]> {
    let all = env::args::<COMMAND_LINE>().ok()?;
    let mut found = Vec::<Argument, N>::new();
    for argument in (&all).skip(1) {
        found.push(argument.ok()?.try_into().ok()?).ok()?;
    }
    found.into_array().ok()
}

/// Why a file could not be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
#[non_exhaustive]
pub enum FileError {
    /// The path is too long or holds a zero.
    Path,
    /// The host refused.
    Host,
}

/// A file to read from.
#[derive(Debug)]
pub struct Input(File);

/// A file to write to.
#[derive(Debug)]
pub struct Output(File);

impl Input {
    /// Opens an existing file.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn open(path: &str) -> Result<Self, FileError> {
        with_c_str(path, |path| File::open(path).map(Self))
    }
}

impl Output {
    /// Makes a new file, in place of one that is there.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn create(path: &str) -> Result<Self, FileError> {
        with_c_str(path, |path| File::create(path).map(Self))
    }
}

impl ErrorType for Input {
    type Error = ErrorKind;
}

impl embedded_io::Read for Input {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        self.0.read(bytes).map_err(|_| ErrorKind::Other)
    }
}

impl ErrorType for Output {
    type Error = ErrorKind;
}

impl embedded_io::Write for Output {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        match self.0.write(bytes) {
            // A full disk takes nothing, which embedded-io has no Ok for.
            Ok(0) if !bytes.is_empty() => Err(ErrorKind::WriteZero),
            Ok(count) => Ok(count),
            Err(_) => Err(ErrorKind::Other),
        }
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

fn with_c_str<T>(
    path: &str,
    open: impl FnOnce(&CStr) -> semihosting::io::Result<T>,
) -> Result<T, FileError> {
    let mut bytes =
        Vec::<u8, COMMAND_LINE>::from_slice(path.as_bytes()).map_err(|_| FileError::Path)?;
    bytes.push(0).map_err(|_| FileError::Path)?;
    let path = CStr::from_bytes_with_nul(&bytes).map_err(|_| FileError::Path)?;
    open(path).map_err(|_| FileError::Host)
}
