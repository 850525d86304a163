//! The machine code of a function in an image.

use std::fs;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol};

use crate::Error;

/// The code of the only function whose mangled name contains that of `path`, such as
/// `["kernels", "step"]`, with all that was inlined into it and its constants.
///
/// # Errors
/// The file cannot be read, or there is not one such function.
pub fn code(image: &Path, path: &[&str]) -> Result<Vec<u8>, Error> {
    let bytes = fs::read(image).map_err(Error::file(image))?;
    let elf = object::File::parse(bytes.as_slice()).map_err(|e| Error::image(image, e))?;
    // Each part of a mangled path is preceded by its length.
    let mut mangled: String = path.iter().map(|p| format!("{}{p}", p.len())).collect();
    mangled.push_str("17h");
    let mut found = elf
        .symbols()
        .filter(|symbol| symbol.size() > 0 && symbol.name().is_ok_and(|n| n.contains(&mangled)));
    let (Some(symbol), None) = (found.next(), found.next()) else {
        let reason = format!("it has not one function {}", path.join("::"));
        return Err(Error::image(image, reason));
    };
    // The lowest bit of an address says Thumb.
    let address = symbol.address() & !1;
    elf.sections()
        .find_map(|section| section.data_range(address, symbol.size()).ok().flatten())
        .map(<[u8]>::to_vec)
        .ok_or_else(|| Error::image(image, "a function without code"))
}
