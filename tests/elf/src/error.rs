//! Why an image could not be judged.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// Something in the image is not as the checks understand it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is no ELF file for an Arm processor, or its debug information is broken.
    #[error("{path} cannot be read as an image: {reason}")]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Bytes that are marked as code and are none.
    #[error("{function}: no instruction at {address:#x}: {reason}")]
    Instruction {
        /// The function they are in.
        function: String,
        /// Where.
        address: u64,
        /// What the disassembler says.
        reason: String,
    },
    /// No function, or more than one, has a name that ends in this.
    #[error("{found} functions are called `{name}`, not one")]
    Name {
        /// What was looked for.
        name: String,
        /// How many there are.
        found: usize,
    },
    /// A branch to where no function is.
    #[error("{function}: `{instruction}` at {address:#x} leads to no known function")]
    Target {
        /// The function.
        function: String,
        /// The branch.
        instruction: String,
        /// Where.
        address: u64,
    },
    /// A call through a register: what it calls is not known.
    #[error("{function}: `{instruction}` at {address:#x} calls through a register")]
    Indirect {
        /// The function.
        function: String,
        /// The call.
        instruction: String,
        /// Where.
        address: u64,
    },
    /// The stack pointer is set in a way that cannot be followed.
    #[error("{function}: `{instruction}` at {address:#x} sets the stack pointer")]
    Stack {
        /// The function.
        function: String,
        /// The instruction.
        instruction: String,
        /// Where.
        address: u64,
    },
    /// The cycles of a function are known of straight code only.
    #[error("{function} is not straight code: {reason}")]
    NotStraight {
        /// The function.
        function: String,
        /// Why not.
        reason: String,
    },
    /// Functions that call each other in a circle: the stack has no bound.
    #[error("recursion: {}", .0.join(" -> "))]
    Recursion(Vec<String>),
}

impl Error {
    /// The bytes of a file.
    pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Self> {
        fs::read(path).map_err(|source| Self::File {
            path: path.to_owned(),
            source,
        })
    }

    /// For `map_err`: what is wrong with an image.
    pub(crate) fn image<E: ToString>(path: &Path) -> impl Fn(E) -> Self + '_ {
        move |reason| Self::Image {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}
