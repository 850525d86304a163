//! Reads, hashes and parses text on several threads, in memory that does not grow with the file. Where
//! there is one core, one block follows the other.
//!
//! ```text
//! one thread: read, hash, unpack, cut into blocks --> some threads: parse --> in order
//! ```

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use super::LogError;
use super::blocks::{Block, BlockError, Blocks};
use super::head::{Body, HeadError, read_head};
use super::layout::{Finder, Layout};
use super::order::Parsed;
use super::parallel::{Ahead, Part, Parts};
use super::rows;
use super::source::{Format, Source};

/// Blocks under way at a time.
const DEPTH: usize = 4;

/// Threads that parse; with more, hashing takes the time.
const MOST_PARSERS: usize = 3;

/// The rows of a text file, parsed block by block.
pub(super) struct Pipeline {
    blocks: Ahead<Receiver<Parsed>>,
}

impl Pipeline {
    /// Reads the header and starts to read on.
    ///
    /// # Errors
    /// An unreadable or empty file, a header that does not name the columns.
    pub(super) fn start(
        source: Source,
        finder: &Finder,
        skip_bad_rows: bool,
        parts: Parts,
    ) -> Result<(Self, Arc<Layout>), LogError> {
        let (path, format) = (finder.path, source.format);
        let text = source.text();
        let (header, body) = read_head(text).map_err(|error| match error {
            HeadError::Read(cause) => failed(path, format, cause),
            HeadError::Doubtful(message) => LogError::file(path, message),
            HeadError::Empty => LogError::file(
                path,
                "the file is empty: expected a header such as `time_s,temp_c,x_dph` and rows",
            ),
        })?;
        let line = u64::from(header.lines) + 1;
        let encoding = body.get_ref().1.encoding;
        let blocks = Blocks::new(
            body,
            parts.block_bytes,
            line,
            header.separator.record_byte(),
        );
        let layout = Arc::new(Layout::of_text(header, encoding, finder)?);

        let (used_in, used) = channel();
        let parse = parser(&layout, skip_bad_rows, used_in);
        let mut hand_over = on_threads(parse, parts.cores);
        let mut reader = BlockReader {
            path: path.to_owned(),
            format,
            blocks: Some(blocks),
        };
        let next = move || {
            let next = reader.next(used.try_recv().unwrap_or_default())?;
            Ok(next.map(|block| {
                let (parsed_in, parsed) = channel();
                hand_over((block, parsed_in));
                parsed
            }))
        };
        let blocks = Ahead::new(parts.cores, DEPTH, next);
        Ok((Self { blocks }, layout))
    }

    /// The next rows, or the hash of the file at its end.
    ///
    /// # Errors
    /// Those of reading and unpacking.
    pub(super) fn next(&mut self) -> Part<Parsed> {
        let parsed = self.blocks.next()?;
        Ok(parsed.map(|parsed| parsed.recv().expect("every block is parsed")))
    }
}

fn failed(path: &Path, format: Format, cause: BlockError) -> LogError {
    match cause {
        BlockError::Stream(cause) => format.error(path, cause),
        BlockError::Endless { line } => LogError::line(path, line, cause.to_string()),
    }
}

type Job = (Block, Sender<Parsed>);

/// Parses a block and hands its memory back.
fn parser(
    layout: &Arc<Layout>,
    skip_bad_rows: bool,
    used: Sender<Vec<u8>>,
) -> impl FnMut(Job) + Clone + Send + 'static {
    let layout = Arc::clone(layout);
    move |(block, parsed)| {
        // Nobody waits any more if a row before was refused.
        let _ = parsed.send(rows::parse(&layout, &block, skip_bad_rows));
        let _ = used.send(block.into_bytes());
    }
}

/// Does `work` on threads, which end when no more jobs can come; at once, where there is one core.
fn on_threads(
    work: impl FnMut(Job) + Clone + Send + 'static,
    cores: usize,
) -> Box<dyn FnMut(Job) + Send> {
    if cores < 2 {
        return Box::new(work);
    }
    let (jobs_in, jobs) = sync_channel::<Job>(DEPTH);
    let jobs = Arc::new(Mutex::new(jobs));
    for _ in 0..cores.min(MOST_PARSERS) {
        let (jobs, mut work) = (Arc::clone(&jobs), work.clone());
        thread::spawn(move || {
            loop {
                let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).recv();
                let Ok(job) = job else { break };
                work(job);
            }
        });
    }
    Box::new(move |job| {
        jobs_in
            .send(job)
            .expect("the threads end after the last job")
    })
}

struct BlockReader {
    path: PathBuf,
    format: Format,
    /// Until the hash of the file was asked for.
    blocks: Option<Blocks<Body>>,
}

impl BlockReader {
    /// The next block, in memory of a former one, or the hash of the file at its end.
    fn next(&mut self, used: Vec<u8>) -> Part<Block> {
        let blocks = self.blocks.as_mut().expect("a log ends once");
        let next = blocks.next(used);
        if let Some(block) = next.map_err(|cause| failed(&self.path, self.format, cause))? {
            return Ok(Ok(block));
        }
        let blocks = self.blocks.take().expect("it was there just now");
        let digest = blocks.into_inner().into_inner().1.into_inner().sha256();
        let digest = digest.map_err(|cause| self.format.error(&self.path, cause))?;
        Ok(Err(digest))
    }
}
