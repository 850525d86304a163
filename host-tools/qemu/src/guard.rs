//! The images that link only if nothing in them can panic.

use std::path::{Path, PathBuf};

use crate::{Board, Error, Options, Variant, Workspace, build_variant, run};

const FEATURES: &[&str] = &["link-guard"];

/// An image and the ways in which it must be free of panics.
#[derive(Clone, Copy, Debug)]
pub struct Guard {
    bin: &'static str,
    /// Optimised for speed and size, each as it is released and with checks.
    pub variants: [Variant; 4],
}

/// What flies per sample. Its checks are overflow checks and debug assertions, the standard
/// library's included; semihosting is only how the image reports, and keeps its own assertions off.
pub const CORE: Guard = Guard::new(
    "guard",
    &[
        "profile.firmware.opt-level=3",
        "profile.firmware.overflow-checks=true",
        "profile.firmware.debug-assertions=true",
        "profile.firmware.package.semihosting.debug-assertions=false",
    ],
    &[
        "profile.firmware.opt-level='s'",
        "profile.firmware.overflow-checks=true",
        "profile.firmware.debug-assertions=true",
        "profile.firmware.package.semihosting.debug-assertions=false",
    ],
);

/// What a unit calls besides: images and their store, fault log, offsets, link and sensors. Its
/// checks are overflow checks of this workspace's crates, which have no debug assertions. Overflow
/// checks of dependencies are off: `postcard`, `heapless`, `cobs`, `zerocopy` and the standard library
/// assert what their unsafe code relies on and what the optimiser cannot prove, and `postcard`,
/// `cobs`, `crc` and `libm` reckon where it cannot see that nothing overflows.
pub const UNIT: Guard = Guard::new(
    "guard_unit",
    &[
        "profile.firmware.opt-level=3",
        "profile.firmware.overflow-checks=true",
        "profile.firmware.package.'*'.overflow-checks=false",
    ],
    &[
        "profile.firmware.opt-level='s'",
        "profile.firmware.overflow-checks=true",
        "profile.firmware.package.'*'.overflow-checks=false",
    ],
);

/// The control: an index that may be out of bounds is put in, so this must not link.
pub const SEEDED: Variant = Variant {
    name: "seeded-panic",
    features: &["seeded-panic"],
    config: &[],
};

/// The symbol whose absence keeps an image that could panic from linking.
pub const MISSING_SYMBOL: &str = "tempco_link_guard_this_image_could_panic";

impl Guard {
    const fn new(
        bin: &'static str,
        checked_for_speed: &'static [&'static str],
        checked_for_size: &'static [&'static str],
    ) -> Self {
        const fn variant(name: &'static str, config: &'static [&'static str]) -> Variant {
            Variant {
                name,
                features: FEATURES,
                config,
            }
        }
        Self {
            bin,
            variants: [
                variant("opt-3", &["profile.firmware.opt-level=3"]),
                variant("opt-s", &["profile.firmware.opt-level='s'"]),
                variant("opt-3-checked", checked_for_speed),
                variant("opt-s-checked", checked_for_size),
            ],
        }
    }

    /// Builds the image; the proof is that this succeeds.
    ///
    /// # Errors
    /// Something in it can panic: the linker then names [`MISSING_SYMBOL`].
    pub fn link(
        &self,
        workspace: &Workspace,
        board: Board,
        variant: &Variant,
    ) -> Result<PathBuf, Error> {
        build_variant(workspace, board, self.bin, None, variant)
    }
}

/// Runs an image and returns how many bytes of stack it used.
///
/// # Errors
/// As of [`run()`], or the image ended in another way than it should.
pub fn stack_used(elf: &Path, board: Board) -> Result<u32, Error> {
    let run = run(elf, board, &[], &Options::default())?;
    match u32::from_str_radix(run.console.trim_end(), 16) {
        Ok(bytes) if run.succeeded() => Ok(bytes),
        _ => Err(Error::image(
            elf,
            format!(
                "it ended with {} and wrote {:?}",
                run.exit_code, run.console
            ),
        )),
    }
}
