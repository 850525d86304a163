//! The processors and systems that archives are for.

use anyhow::Result;
use tempco_qemu::{Workspace, ensure_program, ensure_rust_target};

/// A processor or system with its binutils.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    /// Its Rust target, by which its archive is called.
    pub target: &'static str,
    /// What the names of its binutils begin with.
    tools: &'static str,
    /// The Debian package that has them.
    package: &'static str,
    /// Functions that an archive takes from the C library.
    pub(crate) from_libc: &'static [&'static str],
    /// Sections that its linker complains of.
    pub(crate) without: &'static [&'static str],
}

const ARM: Platform = Platform {
    target: "",
    tools: "arm-none-eabi-",
    package: "binutils-arm-none-eabi",
    from_libc: &[],
    // Objects of GCC for these processors do not have it, and it is all or none.
    without: &["--remove-section=.note.GNU-stack"],
};

impl Platform {
    /// Cortex-M3, without an FPU.
    pub const M3: Self = Self {
        target: "thumbv7m-none-eabi",
        ..ARM
    };

    /// Cortex-M4F and M7F: the reference board.
    pub const M4F: Self = Self {
        target: "thumbv7em-none-eabihf",
        ..ARM
    };

    /// This machine.
    pub const LINUX: Self = Self {
        target: "x86_64-unknown-linux-gnu",
        tools: "",
        package: "binutils",
        from_libc: &["memcpy"],
        without: &[],
    };

    /// Windows, for programs of the GNU compilers.
    pub const WINDOWS: Self = Self {
        target: "x86_64-pc-windows-gnu",
        tools: "x86_64-w64-mingw32-",
        package: "gcc-mingw-w64-x86-64",
        from_libc: &["memcpy"],
        without: &[],
    };

    /// All of them.
    pub const ALL: [Self; 7] = [
        Self {
            target: "thumbv6m-none-eabi",
            ..ARM
        },
        Self::M3,
        Self {
            target: "thumbv7em-none-eabi",
            ..ARM
        },
        Self::M4F,
        Self {
            target: "thumbv8m.main-none-eabihf",
            ..ARM
        },
        Self::LINUX,
        Self::WINDOWS,
    ];

    /// The path of one of its binutils.
    pub(crate) fn tool(&self, name: &str) -> String {
        format!("{}{name}", self.tools)
    }

    /// Installs the Rust target and the binutils, where they are missing.
    ///
    /// # Errors
    /// They cannot be installed from here; the error says how to.
    pub fn ensure(&self, workspace: &Workspace) -> Result<()> {
        ensure_rust_target(workspace, self.target)?;
        ensure_program(workspace, &self.tool("ld"), &[self.package])?;
        Ok(())
    }
}
