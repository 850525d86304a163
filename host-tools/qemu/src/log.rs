//! Turns defmt frames back into words, with the strings the ELF file kept.

use std::path::Path;

#[cfg(feature = "messages")]
use defmt_decoder::{DecodeError, Table};

use crate::Error;

/// The messages of an image: its strings, if it was built with logs. Without the feature `messages`
/// there are none.
pub(crate) struct Messages {
    #[cfg(feature = "messages")]
    table: Option<Table>,
}

#[cfg(feature = "messages")]
impl Messages {
    /// Reads the strings of an image.
    pub(crate) fn of(path: &Path, elf: &[u8]) -> Result<Self, Error> {
        let table = Table::parse(elf).map_err(|error| Error::image(path, format!("{error:#}")))?;
        Ok(Self { table })
    }

    /// The lines of a log, each as `level message`, or the message alone where it has no level.
    pub(crate) fn lines(&self, bytes: &[u8]) -> Vec<String> {
        let Some(table) = &self.table else {
            return Vec::new();
        };
        let mut decoder = table.new_stream_decoder();
        decoder.received(bytes);
        let mut lines = Vec::new();
        loop {
            match decoder.decode() {
                Ok(frame) => {
                    let message = frame.display_message();
                    lines.push(match frame.level() {
                        Some(level) => format!("{} {message}", level.as_str()),
                        None => message.to_string(),
                    });
                }
                Err(DecodeError::UnexpectedEof) => return lines,
                Err(DecodeError::Malformed) => {
                    lines.push("(a frame that is not defmt)".to_owned());
                    if !table.encoding().can_recover() {
                        return lines;
                    }
                }
            }
        }
    }
}

#[cfg(not(feature = "messages"))]
impl Messages {
    pub(crate) fn of(_path: &Path, _elf: &[u8]) -> Result<Self, Error> {
        Ok(Self {})
    }

    pub(crate) fn lines(&self, _bytes: &[u8]) -> Vec<String> {
        Vec::new()
    }
}
