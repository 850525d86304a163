//! QEMU's control socket: one JSON object per line each way.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;
use std::{fmt, io};

use serde_json::{Value, json};

use crate::Error;

/// Longer than QEMU takes to answer anything.
const PATIENCE: Duration = Duration::from_secs(20);

/// A control socket that was greeted.
pub(crate) struct Qmp {
    lines: BufReader<UnixStream>,
}

impl Qmp {
    /// Connects; a socket that is not there yet is an error of the system.
    pub(crate) fn connect(path: &Path) -> io::Result<Result<Self, Error>> {
        let stream = UnixStream::connect(path)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        let lines = BufReader::new(stream);
        let mut qmp = Self { lines };
        let greeted = qmp.line().and_then(|_greeting| {
            qmp.command("qmp_capabilities", json!({}))?;
            Ok(qmp)
        });
        Ok(greeted)
    }

    /// Carries out a command and returns what it returns.
    pub(crate) fn command(&mut self, command: &str, arguments: Value) -> Result<Value, Error> {
        let line = json!({"execute": command, "arguments": arguments}).to_string() + "\n";
        let sent = self.lines.get_mut().write_all(line.as_bytes());
        sent.map_err(|error| refused(command, error))?;
        loop {
            let mut answer = self.line()?;
            if let Some(error) = answer.get("error") {
                return Err(refused(command, &error["desc"]));
            }
            // Events come in between.
            if let Some(value) = answer.get_mut("return") {
                return Ok(value.take());
            }
        }
    }

    fn line(&mut self) -> Result<Value, Error> {
        let mut line = String::new();
        let read = self.lines.read_line(&mut line);
        read.map_err(|error| refused("an answer", error))?;
        serde_json::from_str(&line).map_err(|error| refused("an answer", error))
    }
}

fn refused(command: &str, reason: impl fmt::Display) -> Error {
    Error::Control {
        command: command.to_owned(),
        reason: reason.to_string(),
    }
}
