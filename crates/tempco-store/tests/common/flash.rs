//! A NOR flash as hardware has it: words with error correction that are programmed once between
//! erases, and power that may fail within any operation.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// What a word is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Word {
    Erased,
    Programmed,
    /// Its bits and their check bits do not belong together: reading is a fault.
    Torn,
    /// Reads as erased, but its charge is not what it should be: what is programmed is torn.
    Weak,
}

/// The contents.
#[derive(PartialEq, Eq)]
pub(crate) struct Memory<const W: usize, const E: usize> {
    bytes: Vec<u8>,
    words: Vec<Word>,
}

impl<const W: usize, const E: usize> Clone for Memory<W, E> {
    fn clone(&self) -> Self {
        Self {
            bytes: self.bytes.clone(),
            words: self.words.clone(),
        }
    }

    /// Into the same allocations, since this is done a million times.
    fn clone_from(&mut self, other: &Self) {
        self.bytes.clone_from(&other.bytes);
        self.words.clone_from(&other.words);
    }
}

/// How far an operation came when power failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Nothing has happened.
    Before,
    /// What was worked on cannot be read.
    Torn,
    /// What was worked on reads as a mixture of old and new.
    Mixed,
    /// What was worked on reads as erased but is not.
    Weak,
}

pub(crate) const CUTS: [Cut; 4] = [Cut::Before, Cut::Torn, Cut::Mixed, Cut::Weak];

#[derive(Clone, Copy)]
enum Operation<'b> {
    Program { word: usize, bytes: &'b [u8] },
    Erase { sector: usize },
}

impl<const W: usize, const E: usize> Memory<W, E> {
    fn word(&mut self, word: usize) -> &mut [u8] {
        &mut self.bytes[word * W..][..W]
    }

    fn apply(&mut self, operation: Operation) {
        match operation {
            Operation::Program { word, bytes } => {
                self.word(word).copy_from_slice(bytes);
                self.words[word] = match self.words[word] {
                    Word::Erased => Word::Programmed,
                    _ => Word::Torn,
                };
            }
            Operation::Erase { sector } => {
                self.bytes[sector * E..][..E].fill(0xff);
                self.words[sector * E / W..][..E / W].fill(Word::Erased);
            }
        }
    }

    fn apply_until(&mut self, operation: Operation, cut: Cut) {
        match (operation, cut) {
            (_, Cut::Before) => {}
            (Operation::Program { word, .. }, Cut::Torn) => self.words[word] = Word::Torn,
            (Operation::Program { word, bytes }, Cut::Mixed) => {
                // The bits of the first half have gone to zero where they should.
                self.word(word)[..W / 2].copy_from_slice(&bytes[..W / 2]);
                self.words[word] = Word::Programmed;
            }
            (Operation::Program { word, .. }, Cut::Weak) => self.words[word] = Word::Weak,
            (Operation::Erase { sector }, cut) => {
                for word in sector * E / W..(sector + 1) * E / W {
                    match cut {
                        Cut::Torn => self.words[word] = Word::Torn,
                        // Some words are done, some untouched, some read as anything.
                        Cut::Mixed => match word % 4 {
                            0 => {
                                self.word(word).fill(0xff);
                                self.words[word] = Word::Erased;
                            }
                            1 => self.word(word).iter_mut().for_each(|byte| *byte |= 0x5a),
                            2 => self.words[word] = Word::Torn,
                            _ => {}
                        },
                        _ => {
                            self.word(word).fill(0xff);
                            self.words[word] = Word::Weak;
                        }
                    }
                }
            }
        }
    }
}

type OnCut<'c, const W: usize, const E: usize> = Box<dyn FnMut(&Memory<W, E>, u32, Cut) + 'c>;

/// Flash of words of `W` bytes and sectors of `E` bytes.
pub(crate) struct Flash<'c, const W: usize, const E: usize> {
    pub(crate) memory: Memory<W, E>,
    /// Sees what every cut of every operation would leave.
    on_cut: Option<OnCut<'c, W, E>>,
    scratch: Memory<W, E>,
    /// Operations so far.
    pub(crate) operations: u32,
    /// Programs of words that were not erased, which this kind of flash forbids.
    pub(crate) overwrites: u32,
    /// Operations until power fails for good.
    pub(crate) fails_after: Option<(u32, Cut)>,
}

impl<'c, const W: usize, const E: usize> Flash<'c, W, E> {
    pub(crate) fn new(sectors: usize) -> Self {
        Self::with(&Memory {
            bytes: vec![0xff; sectors * E],
            words: vec![Word::Erased; sectors * E / W],
        })
    }

    pub(crate) fn with(memory: &Memory<W, E>) -> Self {
        Self {
            memory: memory.clone(),
            on_cut: None,
            scratch: memory.clone(),
            operations: 0,
            overwrites: 0,
            fails_after: None,
        }
    }

    /// Calls `on_cut` with what every cut of every operation from now on would leave.
    pub(crate) fn watched<'n>(
        memory: &Memory<W, E>,
        on_cut: impl FnMut(&Memory<W, E>, u32, Cut) + 'n,
    ) -> Flash<'n, W, E> {
        Flash {
            on_cut: Some(Box::new(on_cut)),
            ..Flash::with(memory)
        }
    }

    pub(crate) fn flip(&mut self, bit: usize) {
        self.memory.bytes[bit / 8] ^= 1 << (bit % 8);
    }

    /// Makes the word with a byte unreadable.
    pub(crate) fn tear(&mut self, byte: usize) {
        self.memory.words[byte / W] = Word::Torn;
    }

    fn operate(&mut self, operation: Operation) -> Result<(), NorFlashErrorKind> {
        if let Some(on_cut) = &mut self.on_cut {
            for cut in CUTS {
                self.scratch.clone_from(&self.memory);
                self.scratch.apply_until(operation, cut);
                on_cut(&self.scratch, self.operations, cut);
            }
        }
        if let Operation::Program { word, .. } = operation {
            let used = matches!(self.memory.words[word], Word::Programmed | Word::Torn);
            self.overwrites += u32::from(used);
        }
        self.operations += 1;
        match self.fails_after {
            Some((after, _)) if self.operations > after + 1 => Err(NorFlashErrorKind::Other),
            Some((after, cut)) if self.operations == after + 1 => {
                self.memory.apply_until(operation, cut);
                Err(NorFlashErrorKind::Other)
            }
            _ => {
                self.memory.apply(operation);
                Ok(())
            }
        }
    }
}

impl<const W: usize, const E: usize> ErrorType for Flash<'_, W, E> {
    type Error = NorFlashErrorKind;
}

impl<const W: usize, const E: usize> ReadNorFlash for Flash<'_, W, E> {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        let (from, to) = (offset as usize, offset as usize + bytes.len());
        if self.memory.words[from / W..to.div_ceil(W)].contains(&Word::Torn) {
            return Err(NorFlashErrorKind::Other);
        }
        bytes.copy_from_slice(&self.memory.bytes[from..to]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.memory.bytes.len()
    }
}

impl<const W: usize, const E: usize> NorFlash for Flash<'_, W, E> {
    const WRITE_SIZE: usize = W;
    const ERASE_SIZE: usize = E;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        for sector in from as usize / E..to as usize / E {
            self.operate(Operation::Erase { sector })?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        for (number, bytes) in bytes.chunks(W).enumerate() {
            let word = offset as usize / W + number;
            self.operate(Operation::Program { word, bytes })?;
        }
        Ok(())
    }
}
