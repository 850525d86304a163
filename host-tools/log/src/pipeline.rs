//! Reads, hashes and parses text on several threads, in memory that does not grow with the file.
//!
//! ```text
//! one thread: read, hash, unpack, cut into blocks --> some threads: parse --> in order
//! ```

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use super::LogError;
use super::blocks::{Block, BlockError, Blocks};
use super::head::{Body, HeadError, read_head};
use super::layout::{Finder, Layout};
use super::order::Parsed;
use super::rows;
use super::source::{Format, Source};

/// Blocks under way at a time.
const DEPTH: usize = 4;

/// Threads that parse; with more, hashing takes the time.
const MOST_PARSERS: usize = 3;

/// A block that is being parsed, or how reading ended: with the file's hash or an error.
enum Item {
    Parsing(Receiver<Parsed>),
    Ended(Result<String, LogError>),
}

/// The rows of a text file, parsed block by block.
pub(super) struct Pipeline {
    items: Receiver<Item>,
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
        block_bytes: usize,
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
        let blocks = Blocks::new(body, block_bytes, line, header.separator.record_byte());
        let layout = Arc::new(Layout::of_text(header, encoding, finder)?);

        let (items_in, items) = sync_channel(DEPTH);
        let (used_in, used) = channel();
        let reader = BlockReader {
            path: path.to_owned(),
            format,
            items: items_in,
            jobs: start_parsers(&layout, skip_bad_rows, &used_in),
            used,
        };
        thread::spawn(move || reader.run(blocks));
        Ok((Self { items }, layout))
    }

    /// The next rows, or the hash of the file at its end.
    ///
    /// # Errors
    /// Those of reading and unpacking.
    pub(super) fn next(&mut self) -> Result<Result<Parsed, String>, LogError> {
        const ALIVE: &str = "the threads of a pipeline end after it";
        match self.items.recv().expect(ALIVE) {
            Item::Parsing(parsed) => Ok(Ok(parsed.recv().expect(ALIVE))),
            Item::Ended(digest) => Ok(Err(digest?)),
        }
    }
}

fn failed(path: &Path, format: Format, cause: BlockError) -> LogError {
    match cause {
        BlockError::Stream(cause) => format.error(path, cause),
        BlockError::Endless { line } => LogError::line(path, line, cause.to_string()),
    }
}

type Job = (Block, Sender<Parsed>);

/// Starts the threads that parse; they end when no more jobs can come.
fn start_parsers(
    layout: &Arc<Layout>,
    skip_bad_rows: bool,
    used: &Sender<Vec<u8>>,
) -> SyncSender<Job> {
    let (jobs_in, jobs) = sync_channel::<Job>(DEPTH);
    let jobs = Arc::new(Mutex::new(jobs));
    let cores = thread::available_parallelism().map_or(1, usize::from);
    for _ in 0..cores.min(MOST_PARSERS) {
        let (jobs, layout, used) = (Arc::clone(&jobs), Arc::clone(layout), used.clone());
        thread::spawn(move || {
            loop {
                let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).recv();
                let Ok((block, parsed)) = job else { break };
                // Nobody waits any more if a row before was refused.
                let _ = parsed.send(rows::parse(&layout, &block, skip_bad_rows));
                let _ = used.send(block.into_bytes());
            }
        });
    }
    jobs_in
}

struct BlockReader {
    path: PathBuf,
    format: Format,
    items: SyncSender<Item>,
    jobs: SyncSender<Job>,
    /// Memory of blocks that were parsed.
    used: Receiver<Vec<u8>>,
}

impl BlockReader {
    fn run(self, mut blocks: Blocks<Body>) {
        loop {
            let block = match blocks.next(self.used.try_recv().unwrap_or_default()) {
                Ok(Some(block)) => block,
                Ok(None) => break,
                Err(cause) => {
                    let error = failed(&self.path, self.format, cause);
                    let _ = self.items.send(Item::Ended(Err(error)));
                    return;
                }
            };
            let (parsed_in, parsed) = channel();
            let is_wanted = self.items.send(Item::Parsing(parsed)).is_ok();
            if !is_wanted || self.jobs.send((block, parsed_in)).is_err() {
                return;
            }
        }
        let digest = blocks.into_inner().into_inner().1.into_inner().sha256();
        let digest = digest.map_err(|cause| self.format.error(&self.path, cause));
        // Nobody waits any more if a row before was refused.
        let _ = self.items.send(Item::Ended(digest));
    }
}
