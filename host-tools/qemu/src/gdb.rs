//! QEMU's server for debuggers, as far as writing memory needs it.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use crate::Error;

/// Longer than QEMU takes to answer anything.
const PATIENCE: Duration = Duration::from_secs(20);

/// Writes memory of a machine whose server listens at a socket. The machine stands still afterwards.
pub(crate) fn write_memory(socket: &Path, address: u32, bytes: &[u8]) -> Result<(), Error> {
    let mut stream = UnixStream::connect(socket).map_err(Error::file(socket))?;
    let limited = stream.set_read_timeout(Some(PATIENCE));
    limited.map_err(Error::file(socket))?;
    let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let command = format!("M{address:x},{:x}:{hex}", bytes.len());
    match ask(&mut stream, &command).map_err(Error::file(socket))? {
        answer if answer == "OK" => Ok(()),
        reason => Err(Error::Control { command, reason }),
    }
}

/// Sends a packet, and returns the answer.
fn ask(stream: &mut UnixStream, words: &str) -> io::Result<String> {
    let sum = words.bytes().fold(0, u8::wrapping_add);
    stream.write_all(format!("${words}#{sum:02x}").as_bytes())?;
    loop {
        let answer = packet(stream)?;
        // That the machine has stopped may be said in between.
        if !answer.starts_with('T') {
            return Ok(answer);
        }
    }
}

/// The next packet: `$`, the words, `#` and a sum of two digits. It is acknowledged by `+`.
fn packet(stream: &mut UnixStream) -> io::Result<String> {
    let mut bytes = Vec::new();
    let mut byte = [0];
    while !bytes.ends_with(b"#") {
        stream.read_exact(&mut byte)?;
        bytes.push(byte[0]);
    }
    stream.read_exact(&mut [0; 2])?;
    stream.write_all(b"+")?;
    let words = String::from_utf8_lossy(&bytes);
    Ok(words.trim_matches(['+', '$', '#']).to_owned())
}
