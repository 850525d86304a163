//! Where in the sources an instruction comes from.

use std::path::Path;
use std::sync::Arc;

use addr2line::Context;
use gimli::{Dwarf, EndianArcSlice, LittleEndian, SectionId};
use object::{Object, ObjectSection};

use crate::Error;

/// The debug information of an image.
pub struct Lines(Context<EndianArcSlice<LittleEndian>>);

impl Lines {
    /// Reads the debug information of an image.
    ///
    /// # Errors
    /// It has none that can be read.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = Error::read(path)?;
        let elf = object::File::parse(&*bytes).map_err(Error::image(path))?;
        let load = |id: SectionId| -> Result<_, object::Error> {
            let data = match elf.section_by_name(id.name()) {
                Some(section) => section.data()?,
                None => &[],
            };
            Ok(EndianArcSlice::new(Arc::from(data), LittleEndian))
        };
        let dwarf = Dwarf::load(load).map_err(Error::image(path))?;
        let context = Context::from_dwarf(dwarf).map_err(Error::image(path))?;
        Ok(Self(context))
    }

    /// The functions of the sources an instruction belongs to, the innermost first: those that
    /// were inlined, and the one they were inlined into.
    pub fn functions(&self, address: u64) -> Vec<String> {
        let mut names = Vec::new();
        let Ok(mut frames) = self.0.find_frames(address).skip_all_loads() else {
            return names;
        };
        while let Ok(Some(frame)) = frames.next() {
            let name = frame.function.and_then(|function| {
                let name = function.raw_name().ok()?;
                Some(format!("{:#}", rustc_demangle::demangle(&name)))
            });
            names.extend(name);
        }
        names
    }
}
