//! The bytes of a log file: their format, and their hash as they pass.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use flate2::bufread::MultiGzDecoder;
use sha2::{Digest, Sha256};

use super::LogError;
use super::zstandard::ZstdDecoder;

/// Bytes read from a compressed file at a time.
const BUFFER_BYTES: usize = 1 << 18;

/// What a file is, by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Text,
    Gzip,
    Zstd,
    Parquet,
    /// Of PX4.
    Ulog,
    /// Of ArduPilot.
    DataFlash,
}

impl Format {
    fn of(head: &[u8]) -> Self {
        match head {
            [0x1f, 0x8b, ..] => Self::Gzip,
            // A zstd frame, or one of the frames to be skipped that may stand before it.
            [0x28, 0xb5, 0x2f, 0xfd] | [0x50..=0x5f, 0x2a, 0x4d, 0x18] => Self::Zstd,
            b"PAR1" => Self::Parquet,
            b"ULog" => Self::Ulog,
            [0xa3, 0x95, ..] => Self::DataFlash,
            _ => Self::Text,
        }
    }

    /// The error of a stream of this format, said so that the user knows what to do.
    pub(super) fn error(self, path: &Path, cause: io::Error) -> LogError {
        let name = match self {
            Self::Text | Self::Parquet | Self::Ulog | Self::DataFlash => {
                return LogError::io(path)(cause);
            }
            Self::Gzip => "gzip",
            Self::Zstd => "zstd",
        };
        if cause.kind() == io::ErrorKind::UnexpectedEof {
            let message = format!("the {name} data ends too early: was the file cut off?");
            LogError::file(path, message)
        } else if cause.raw_os_error().is_some() {
            LogError::io(path)(cause)
        } else {
            LogError::file(path, format!("not sound {name} data: {cause}"))
        }
    }
}

/// A file whose bytes are hashed and counted as they are read.
pub(super) struct Tapped {
    file: File,
    digest: Sha256,
    bytes_read: Arc<AtomicU64>,
}

impl Read for Tapped {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.digest.update(&buffer[..read]);
        self.bytes_read.fetch_add(read as u64, Ordering::Relaxed);
        Ok(read)
    }
}

type Bytes = io::Chain<Cursor<Vec<u8>>, Tapped>;

/// An opened file.
pub(super) struct Source {
    pub(super) format: Format,
    /// Its length, where it has one.
    pub(super) bytes: Option<u64>,
    pub(super) bytes_read: Arc<AtomicU64>,
    content: Bytes,
}

impl Source {
    /// Opens a file and looks at its first bytes.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        let bytes_read = Arc::new(AtomicU64::new(0));
        let mut tapped = Tapped {
            file,
            digest: Sha256::new(),
            bytes_read: Arc::clone(&bytes_read),
        };
        let mut head = Vec::new();
        (&mut tapped).take(4).read_to_end(&mut head)?;
        Ok(Self {
            format: Format::of(&head),
            bytes: metadata.is_file().then_some(metadata.len()),
            bytes_read,
            content: Cursor::new(head).chain(tapped),
        })
    }

    /// The text of the file, unpacked if it is packed.
    pub(super) fn text(self) -> Text {
        let buffered = |content| BufReader::with_capacity(BUFFER_BYTES, content);
        match self.format {
            Format::Gzip => Text::Gzip(Box::new(MultiGzDecoder::new(buffered(self.content)))),
            Format::Zstd => Text::Zstd(Box::new(ZstdDecoder::new(buffered(self.content)))),
            _ => Text::Plain(Box::new(self.content)),
        }
    }
}

/// The text of a file.
pub(super) enum Text {
    Plain(Box<Bytes>),
    Gzip(Box<MultiGzDecoder<BufReader<Bytes>>>),
    Zstd(Box<ZstdDecoder<BufReader<Bytes>>>),
}

impl Read for Text {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(content) => content.read(buffer),
            Self::Gzip(decoder) => decoder.read(buffer),
            Self::Zstd(decoder) => decoder.read(buffer),
        }
    }
}

impl Text {
    /// SHA-256 of the bytes of the whole file.
    pub(super) fn sha256(self) -> io::Result<String> {
        let mut content = match self {
            Self::Plain(content) => *content,
            Self::Gzip(decoder) => decoder.into_inner().into_inner(),
            Self::Zstd(decoder) => decoder.into_inner().into_inner(),
        };
        io::copy(&mut content, &mut io::sink())?;
        Ok(hex(&content.into_inner().1.digest.finalize()))
    }
}

/// Bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
