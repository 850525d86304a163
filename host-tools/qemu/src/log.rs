//! Turns defmt frames back into words, with the strings the ELF file kept.

use std::path::Path;

use defmt_decoder::{DecodeError, Table};

use crate::Error;

/// Reads the strings of an image.
pub(crate) fn table(path: &Path, elf: &[u8]) -> Result<Table, Error> {
    table_if_any(path, elf)?.ok_or_else(|| Error::image(path, "it has no defmt strings"))
}

/// Reads the strings of an image that may have been built without logs.
pub(crate) fn table_if_any(path: &Path, elf: &[u8]) -> Result<Option<Table>, Error> {
    Table::parse(elf).map_err(|error| Error::image(path, format!("{error:#}")))
}

/// The lines of a log, each as `level message`, or the message alone where it has no level.
pub(crate) fn lines(table: &Table, bytes: &[u8]) -> Vec<String> {
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
