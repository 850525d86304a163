//! What the tests of the C side share: archives, compilers, and programs in QEMU.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, OnceLock};

use tempco_dist::{Platform, c_package};
use tempco_qemu::{Workspace, checked, ensure_program, ensure_qemu};
use tempfile::TempDir;

/// The checkout.
pub(crate) static WORKSPACE: LazyLock<Workspace> = LazyLock::new(|| Workspace::find().unwrap());

/// Warnings that code for C users must not give.
pub(crate) const WARNINGS: [&str; 5] =
    ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

pub(crate) const PACKAGE: &str = "crates/tempco-c/package";
const BARE_METAL: &str = "crates/tempco-c/package/examples/bare-metal";

/// A path in the checkout.
pub(crate) fn path(name: &str) -> PathBuf {
    WORKSPACE.root().join(name)
}

/// Platforms that programs are run on here.
pub(crate) const PLATFORMS: [Platform; 3] = [Platform::M3, Platform::M4F, Platform::LINUX];

/// The zip with archives for the [`PLATFORMS`], made once.
pub(crate) fn package() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        for platform in PLATFORMS {
            platform.ensure(&WORKSPACE).unwrap();
        }
        let folder = WORKSPACE.target_dir().join("archives");
        c_package(&WORKSPACE, &PLATFORMS, &folder).unwrap_or_else(|error| panic!("{error:?}"))
    })
}

/// The archive for a platform.
pub(crate) fn archive_of(platform: Platform) -> PathBuf {
    let folder = package().parent().unwrap();
    folder.join(platform.target).join("libtempco.a")
}

/// A compiler with its flags.
#[derive(Clone, Copy)]
pub(crate) struct Compiler {
    pub(crate) program: &'static str,
    pub(crate) flags: &'static [&'static str],
    pub(crate) platform: Platform,
    pub(crate) debian: &'static str,
}

impl Compiler {
    /// Whether it is there, or could be installed.
    pub(crate) fn is_there(&self) -> bool {
        ensure_program(&WORKSPACE, self.program, &[self.debian]).is_ok()
    }
}

const C99: &[&str] = &["-std=c99"];
const CPP17: &[&str] = &["-std=c++17", "-x", "c++", "-fno-exceptions", "-fno-rtti"];

const GCC: Compiler = Compiler {
    program: "gcc",
    flags: &["-O2"],
    platform: Platform::LINUX,
    debian: "gcc",
};

/// Compilers of this machine.
pub(crate) const POSIX_COMPILERS: [Compiler; 2] = [
    GCC,
    Compiler {
        program: "clang",
        debian: "clang",
        ..GCC
    },
];

/// The compiler for a Cortex-M4F; none, with a printed reason, where it cannot be had.
pub(crate) fn arm_gcc() -> Option<Compiler> {
    let compiler = Compiler {
        program: "arm-none-eabi-gcc",
        flags: &[
            "-mcpu=cortex-m4",
            "-mthumb",
            "-mfloat-abi=hard",
            "-mfpu=fpv4-sp-d16",
        ],
        platform: Platform::M4F,
        debian: "gcc-arm-none-eabi",
    };
    let is_there = compiler.is_there() && ensure_qemu(&WORKSPACE).is_ok();
    if !is_there {
        println!("skipped: there is no arm-none-eabi-gcc or no qemu-system-arm");
    }
    is_there.then_some(compiler)
}

/// A program that is to be compiled.
#[derive(Clone)]
pub(crate) struct Build {
    name: String,
    sources: Vec<PathBuf>,
    flags: Vec<String>,
    first_libraries: Vec<String>,
    libraries: Vec<String>,
    language: &'static [&'static str],
    is_bare_metal: bool,
}

impl Build {
    /// A program without sources.
    pub(crate) fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            sources: Vec::new(),
            flags: Vec::new(),
            first_libraries: Vec::new(),
            libraries: Vec::new(),
            language: C99,
            is_bare_metal: false,
        }
    }

    /// Adds a source of the checkout.
    pub(crate) fn source(mut self, name: &str) -> Self {
        self.sources.push(path(name));
        self
    }

    pub(crate) fn define(self, name: &str, value: impl std::fmt::Display) -> Self {
        self.flag(&format!("-D{name}={value}"))
    }

    pub(crate) fn flag(mut self, flag: &str) -> Self {
        self.flags.push(flag.to_owned());
        self
    }

    /// Links a library before the archive.
    pub(crate) fn first_library(mut self, library: &str) -> Self {
        self.first_libraries.push(library.to_owned());
        self
    }

    /// Links a library behind the archive.
    pub(crate) fn library(mut self, library: &str) -> Self {
        self.libraries.push(library.to_owned());
        self
    }

    /// As C++17.
    pub(crate) fn cpp(mut self) -> Self {
        self.language = CPP17;
        self
    }

    /// For the board of the example, without a C library.
    pub(crate) fn bare_metal(mut self) -> Self {
        self.is_bare_metal = true;
        self.flag(&format!("-I{}", path(BARE_METAL).display()))
    }

    /// Compiles and links it, without a warning.
    pub(crate) fn with(&self, compiler: &Compiler) -> Program {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join(&self.name);
        let compile = |source: &Path, language: &[&str], object: &Path| {
            let mut command = Command::new(compiler.program);
            command
                .args(compiler.flags)
                .args(WARNINGS)
                .args(["-O2", "-ffp-contract=off", "-ffunction-sections"])
                .args(["-fdata-sections", "-fstack-usage"])
                .arg(format!("-I{}/include", path(PACKAGE).display()))
                .args(&self.flags)
                .args(language)
                .arg("-c")
                .arg(source)
                .arg("-o")
                .arg(object);
            checked(&mut command).unwrap_or_else(|error| panic!("{error}"));
        };
        let mut link = Command::new(compiler.program);
        link.args(compiler.flags).args(&self.flags);
        for (number, source) in self.sources.iter().enumerate() {
            let object = folder.path().join(format!("{number}.o"));
            compile(source, self.language, &object);
            link.arg(object);
        }
        let mut libgcc = None;
        if self.is_bare_metal {
            let object = folder.path().join("startup.o");
            compile(&path(BARE_METAL).join("startup.c"), C99, &object);
            link.arg(object)
                .arg("-T")
                .arg(path(BARE_METAL).join("mps2-an386.ld"))
                .arg("-nostdlib");
            // Floats of the program itself, without an FPU.
            libgcc = Some("-lgcc");
        }
        link.args(&self.first_libraries)
            .arg(archive_of(compiler.platform))
            .args(&self.libraries)
            .args(libgcc)
            .args(["-Wl,--gc-sections", "-o"])
            .arg(&program);
        if self.first_libraries.is_empty() && self.libraries.is_empty() {
            link.arg("-Wl,--fatal-warnings");
        }
        checked(&mut link).unwrap_or_else(|error| panic!("{error}"));
        Program {
            path: program,
            is_bare_metal: self.is_bare_metal,
            machine: if compiler.flags.contains(&"-mcpu=cortex-m3") {
                "mps2-an385"
            } else {
                "mps2-an386"
            },
            _folder: folder,
        }
    }
}

/// A program, removed at the end.
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    is_bare_metal: bool,
    machine: &'static str,
    _folder: TempDir,
}

impl Program {
    /// How it is started, in QEMU where it is for a board.
    pub(crate) fn command(&self) -> Command {
        if !self.is_bare_metal {
            return Command::new(&self.path);
        }
        let mut command = Command::new("timeout");
        command
            .args(["300", "qemu-system-arm", "-machine", self.machine])
            .args(["-nographic", "-monitor", "none", "-serial", "none"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(&self.path);
        command
    }

    /// What it says; it must succeed.
    pub(crate) fn run(&self) -> String {
        said(&mut self.command())
    }
}

/// What a command says in either way; it must succeed.
pub(crate) fn said(command: &mut Command) -> String {
    let output = checked(command).unwrap_or_else(|error| panic!("{error}"));
    // Semihosting speaks on one, programs of this machine on the other.
    let said = [output.stdout, output.stderr].concat();
    String::from_utf8(said).unwrap()
}
