//! Pages of a Parquet column, unpacked in memory that is bounded whatever the file claims.

use std::fs::File;
use std::io::{BufReader, Read};
use std::sync::Arc;

use bytes::Bytes;
use flate2::bufread::MultiGzDecoder;
use lz4_flex::block::DecompressError;
use parquet::basic::Compression;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{ChunkReader, Length};
use parquet::file::serialized_reader::SerializedPageReader;
use thiserror::Error;

use super::zstandard::ZstdDecoder;

/// The largest page, and footer, that is read \[bytes\]: 16 million values of eight bytes.
pub(super) const LARGEST_PAGE: usize = 128 << 20;

/// The least bytes of a number.
const BYTES_PER_VALUE: usize = 4;

/// A page, or a footer, is too large.
#[derive(Debug, Error)]
#[error(
    "a Parquet page, or the footer, is larger than {} MiB: write the file with smaller pages",
    most >> 20
)]
pub(super) struct TooLarge {
    most: usize,
}

fn too_large(most: usize) -> ParquetError {
    ParquetError::External(Box::new(TooLarge { most }))
}

/// A file of which no more than some bytes are read at once.
pub(super) struct BoundedFile {
    file: File,
    most: usize,
}

impl BoundedFile {
    pub(super) fn new(file: File, most: usize) -> Self {
        Self { file, most }
    }
}

impl Length for BoundedFile {
    fn len(&self) -> u64 {
        self.file.len()
    }
}

impl ChunkReader for BoundedFile {
    type T = BufReader<File>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        self.file.get_read(start)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        if length > self.most {
            return Err(too_large(self.most));
        }
        self.file.get_bytes(start, length)
    }
}

/// The pages of a column in a group of rows.
///
/// The library takes the size of an unpacked page from the file, or none at all for gzip. So it
/// gets the column as one that is not packed, and pages are unpacked here.
pub(super) struct Pages {
    packed: SerializedPageReader<BoundedFile>,
    unpacker: Unpacker,
}

impl Pages {
    pub(super) fn new(
        file: &Arc<BoundedFile>,
        column: &ColumnChunkMetaData,
        rows: usize,
    ) -> Result<Self> {
        let plain = column.clone().into_builder();
        let plain = plain.set_compression(Compression::UNCOMPRESSED).build()?;
        Ok(Self {
            packed: SerializedPageReader::new(Arc::clone(file), &plain, rows, None)?,
            unpacker: Unpacker {
                compression: column.compression(),
                most: file.most,
            },
        })
    }
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.packed.get_next_page()?;
        page.map(|page| self.unpacker.page(page)).transpose()
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.packed.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.packed.skip_next_page()
    }
}

impl Iterator for Pages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

/// Unpacks pages of no more than some bytes.
struct Unpacker {
    compression: Compression,
    most: usize,
}

impl Unpacker {
    fn page(&self, mut page: Page) -> Result<Page> {
        match &mut page {
            Page::DataPage { buf, .. } => *buf = self.unpacked(buf, 0)?,
            Page::DataPageV2 {
                buf,
                def_levels_byte_len,
                rep_levels_byte_len,
                is_compressed,
                ..
            } => {
                if *is_compressed {
                    let levels = u64::from(*def_levels_byte_len) + u64::from(*rep_levels_byte_len);
                    *buf = self.unpacked(buf, levels as usize)?;
                }
            }
            Page::DictionaryPage {
                buf, num_values, ..
            } => {
                *buf = self.unpacked(buf, 0)?;
                if *num_values as usize > buf.len() / BYTES_PER_VALUE {
                    let message = "a dictionary claims more values than it has";
                    return Err(ParquetError::General(message.to_owned()));
                }
            }
        }
        Ok(page)
    }

    /// Unpacks what follows the `plain` first bytes.
    fn unpacked(&self, bytes: &Bytes, plain: usize) -> Result<Bytes> {
        let Some((plain, packed)) = bytes.split_at_checked(plain) else {
            let message = "the levels of a page are longer than the page";
            return Err(ParquetError::General(message.to_owned()));
        };
        // A page without values may have nothing that is packed.
        if packed.is_empty() {
            return Ok(bytes.clone());
        }
        let mut unpacked = plain.to_vec();
        match self.compression {
            Compression::UNCOMPRESSED => return Ok(bytes.clone()),
            Compression::SNAPPY => {
                let len = snap::raw::decompress_len(packed)?;
                if len > self.most {
                    return Err(too_large(self.most));
                }
                unpacked.resize(plain.len() + len, 0);
                let values = &mut unpacked[plain.len()..];
                snap::raw::Decoder::new().decompress(packed, values)?;
            }
            Compression::GZIP(_) => self.append(MultiGzDecoder::new(packed), &mut unpacked)?,
            Compression::ZSTD(_) => self.append(ZstdDecoder::new(packed), &mut unpacked)?,
            // The size of the values is not in the data, so room is made until they fit.
            Compression::LZ4_RAW => {
                let mut room = packed.len().saturating_mul(4).clamp(1 << 16, self.most);
                loop {
                    match lz4_flex::block::decompress(packed, room) {
                        Ok(values) => {
                            unpacked.extend_from_slice(&values);
                            break;
                        }
                        Err(DecompressError::OutputTooSmall { .. }) if room < self.most => {
                            room = room.saturating_mul(4).min(self.most);
                        }
                        Err(DecompressError::OutputTooSmall { .. }) => {
                            return Err(too_large(self.most));
                        }
                        Err(cause) => return Err(ParquetError::General(cause.to_string())),
                    }
                }
            }
            other => {
                let name = other.to_string();
                let (name, _) = name.split_once('(').unwrap_or((&name, ""));
                let message =
                    format!("pages packed by {name}: expected Snappy, gzip, zstd or LZ4_RAW");
                return Err(ParquetError::NYI(message));
            }
        }
        Ok(unpacked.into())
    }

    fn append(&self, reader: impl Read, unpacked: &mut Vec<u8>) -> Result<()> {
        let read = reader.take(self.most as u64 + 1).read_to_end(unpacked)?;
        if read > self.most {
            return Err(too_large(self.most));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use flate2::write::GzEncoder;
    use parquet::basic::{Encoding, GzipLevel, ZstdLevel};
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    use super::*;

    const MOST: usize = 1 << 20;

    fn packed(compression: Compression, bytes: &[u8]) -> Vec<u8> {
        match compression {
            Compression::SNAPPY => snap::raw::Encoder::new().compress_vec(bytes).unwrap(),
            Compression::GZIP(_) => {
                let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::fast());
                encoder.write_all(bytes).unwrap();
                encoder.finish().unwrap()
            }
            Compression::ZSTD(_) => compress_to_vec(bytes, CompressionLevel::Fastest),
            Compression::LZ4_RAW => lz4_flex::block::compress(bytes),
            _ => bytes.to_vec(),
        }
    }

    fn is_too_large<T>(result: Result<T>) -> bool {
        matches!(result, Err(ParquetError::External(cause)) if cause.is::<TooLarge>())
    }

    #[test]
    fn a_page_is_as_large_as_it_may_be_and_no_larger() {
        for compression in [
            Compression::SNAPPY,
            Compression::GZIP(GzipLevel::default()),
            Compression::ZSTD(ZstdLevel::default()),
            Compression::LZ4_RAW,
        ] {
            let unpacker = Unpacker {
                compression,
                most: MOST,
            };
            let unpacked = |len| {
                let bytes = packed(compression, &vec![0; len]);
                unpacker.unpacked(&bytes.into(), 0)
            };
            assert_eq!(unpacked(MOST).unwrap().len(), MOST, "{compression}");
            assert!(is_too_large(unpacked(MOST + 1)), "{compression}");
            assert!(is_too_large(unpacked(100 * MOST)), "{compression}");
        }
    }

    #[test]
    fn what_is_read_at_once_is_bounded() {
        let file = tempfile::tempfile().unwrap();
        file.set_len(3 * MOST as u64).unwrap();
        let file = BoundedFile::new(file, MOST);
        assert_eq!(file.get_bytes(5, MOST).unwrap().len(), MOST);
        assert!(is_too_large(file.get_bytes(5, MOST + 1)));
    }

    #[test]
    fn claims_without_bytes_are_refused() {
        let unpacker = Unpacker {
            compression: Compression::UNCOMPRESSED,
            most: MOST,
        };
        let dictionary = |num_values| Page::DictionaryPage {
            buf: vec![0; 80].into(),
            num_values,
            encoding: Encoding::PLAIN,
            is_sorted: false,
        };
        assert!(unpacker.page(dictionary(20)).is_ok());
        assert!(unpacker.page(dictionary(u32::MAX)).is_err());
        let levels = |def_levels_byte_len| Page::DataPageV2 {
            buf: vec![0; 80].into(),
            num_values: 20,
            encoding: Encoding::PLAIN,
            num_nulls: 0,
            num_rows: 20,
            def_levels_byte_len,
            rep_levels_byte_len: 0,
            is_compressed: true,
            statistics: None,
        };
        assert!(unpacker.page(levels(80)).is_ok());
        assert!(unpacker.page(levels(81)).is_err());
        assert!(unpacker.page(levels(u32::MAX)).is_err());
    }
}
