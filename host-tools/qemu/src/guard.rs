//! The images `guard`: they link only if nothing in them can panic.

use std::path::{Path, PathBuf};

use crate::{Board, Error, Options, Variant, Workspace, build_variant, run};

const FEATURES: &[&str] = &["link-guard"];

/// The four ways in which the core must be free of panics. `checked` is with overflow checks and
/// debug assertions, the standard library's included; semihosting is only how the image reports,
/// and keeps its own assertions off.
pub const VARIANTS: [Variant; 4] = [
    Variant {
        name: "opt-3",
        features: FEATURES,
        config: &["profile.release.opt-level=3"],
    },
    Variant {
        name: "opt-s",
        features: FEATURES,
        config: &["profile.release.opt-level='s'"],
    },
    Variant {
        name: "opt-3-checked",
        features: FEATURES,
        config: &[
            "profile.release.opt-level=3",
            "profile.release.overflow-checks=true",
            "profile.release.debug-assertions=true",
            "profile.release.package.semihosting.debug-assertions=false",
        ],
    },
    Variant {
        name: "opt-s-checked",
        features: FEATURES,
        config: &[
            "profile.release.opt-level='s'",
            "profile.release.overflow-checks=true",
            "profile.release.debug-assertions=true",
            "profile.release.package.semihosting.debug-assertions=false",
        ],
    },
];

/// The control: an index that may be out of bounds is put in, so this must not link.
pub const SEEDED: Variant = Variant {
    name: "seeded-panic",
    features: &["seeded-panic"],
    config: &[],
};

/// The symbol whose absence keeps an image that could panic from linking.
pub const MISSING_SYMBOL: &str = "tempco_link_guard_this_image_could_panic";

/// Builds an image `guard`; the proof is that this succeeds.
///
/// # Errors
/// Something in it can panic: the linker then names [`MISSING_SYMBOL`].
pub fn link(workspace: &Workspace, board: Board, variant: &Variant) -> Result<PathBuf, Error> {
    build_variant(workspace, board, "guard", None, variant)
}

/// Runs an image `guard` and returns how many bytes of stack it used.
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
