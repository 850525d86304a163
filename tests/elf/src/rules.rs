//! What the core's functions may consist of.

use std::path::Path;

use crate::{CallGraph, Error, Image, Kernel, Lines, Site, forbidden_symbols, is_failure_path};

/// The functions that run for every sample.
pub const KERNELS: [&str; 6] = [
    "kernels::step",
    "kernels::thermal",
    "kernels::subtract",
    "kernels::block8",
    "kernels::interval",
    "kernels::pulses",
];

/// A kernel with what was found in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// The kernel.
    pub kernel: Kernel,
    /// What is not allowed, in words; empty for a good kernel.
    pub faults: Vec<String>,
}

/// Judges the functions of [`KERNELS`] in an image.
///
/// # Errors
/// The image cannot be read, or lacks one of them.
pub fn judge_kernels(path: &Path) -> Result<Vec<Judged>, Error> {
    let image = Image::read(path)?;
    let lines = Lines::read(path)?;
    let judged = KERNELS.iter().map(|name| {
        let kernel = Kernel::read(&image, name)?;
        Ok(judge(kernel, |address| lines.functions(address)))
    });
    judged.collect()
}

fn judge(kernel: Kernel, origin: impl Fn(u64) -> Vec<String>) -> Judged {
    let mut judged = Judged {
        faults: Vec::new(),
        kernel,
    };
    for site in &judged.kernel.branches {
        let functions = origin(site.address).join(" in ");
        let text = format!("conditional branch: {} from {functions}", shown(site));
        judged.faults.push(text);
    }
    let kernel = &judged.kernel;
    for (kind, sites) in [
        ("loop", &kernel.loops),
        ("division", &kernel.divisions),
        ("fused multiplication", &kernel.fused),
        ("double precision", &kernel.doubles),
    ] {
        let faults = sites.iter().map(|site| format!("{kind}: {}", shown(site)));
        judged.faults.extend(faults);
    }
    let foreign = kernel
        .callees
        .iter()
        .filter(|name| !name.starts_with("tempco::"));
    let faults = foreign.map(|name| format!("call of {name}"));
    judged.faults.extend(faults);
    judged
}

fn shown(site: &Site) -> String {
    format!(
        "`{}` at {:#x} of {}",
        site.text, site.address, site.function
    )
}

/// A whole image that must not be able to panic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WholeImage {
    /// Worst-case stack from reset on \[bytes\].
    pub stack: u32,
    /// The functions on the way to it, with the bytes each takes.
    pub deepest: Vec<(String, u32)>,
    /// Functions that can be reached.
    pub functions: usize,
    /// Symbols that must not be there, in words.
    pub faults: Vec<String>,
}

/// Judges a whole image: its symbols, and from reset on its calls and its stack.
///
/// # Errors
/// The image cannot be read, it recurses, or calls or the stack cannot be followed.
pub fn judge_image(path: &Path) -> Result<WholeImage, Error> {
    let image = Image::read(path)?;
    // Nothing is cut off: an image that must not panic has no such path.
    let graph = CallGraph::from(&image, image.entry(), |_| false)?;
    let deepest = graph.deepest_stack()?;
    let forbidden = forbidden_symbols(image.symbols());
    Ok(WholeImage {
        stack: deepest.bytes,
        deepest: deepest
            .path
            .into_iter()
            .map(|(name, bytes)| (name.to_owned(), bytes))
            .collect(),
        functions: graph.functions().count(),
        faults: forbidden
            .into_iter()
            .map(|(name, family)| format!("{family:?}: {name}"))
            .collect(),
    })
}

/// Worst-case stack of any image \[bytes\], but for the paths on which it fails.
///
/// # Errors
/// As of [`judge_image`].
pub fn stack_without_failures(path: &Path) -> Result<u32, Error> {
    let image = Image::read(path)?;
    let graph = CallGraph::from(&image, image.entry(), is_failure_path)?;
    Ok(graph.deepest_stack()?.bytes)
}
