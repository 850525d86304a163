//! Where an image lies in memory.

use std::fs;
use std::path::Path;

use object::elf::SHF_ALLOC;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind};

use crate::Error;

/// Places and sizes of an image, as its ELF file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Address of the vector table: the start of the flash.
    pub vector_table: u64,
    /// First stack pointer: the end of the RAM.
    pub stack_top: u32,
    /// Lowest address of a variable, where there is one.
    pub ram_start: Option<u64>,
    /// Bytes in flash: code, constants, and first values of variables.
    pub flash_bytes: u64,
    /// Bytes of variables in RAM, without the stack.
    pub ram_bytes: u64,
    /// The same by what they are.
    pub sizes: Sizes,
    /// Addresses between which the stack lies, where the image says; its top is `stack_top`.
    pub stack: Option<(u32, u32)>,
}

/// What an image consists of \[bytes\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Code, with the vector table.
    pub text: u64,
    /// Constants.
    pub rodata: u64,
    /// Variables with first values.
    pub data: u64,
    /// Other variables.
    pub bss: u64,
}

impl Layout {
    /// Reads the layout of an image.
    ///
    /// # Errors
    /// The file cannot be read, or is not an image for a Cortex-M.
    pub fn of(image: &Path) -> Result<Self, Error> {
        let bytes = fs::read(image).map_err(Error::file(image))?;
        let elf = object::File::parse(bytes.as_slice()).map_err(|e| Error::image(image, e))?;
        let vectors = elf
            .section_by_name(".vector_table")
            .ok_or_else(|| Error::image(image, "it has no vector table"))?;
        let stack_top = vectors
            .data()
            .ok()
            .and_then(|data| data.first_chunk())
            .ok_or_else(|| Error::image(image, "its vector table is empty"))?;

        let mut layout = Self {
            vector_table: vectors.address(),
            stack_top: u32::from_le_bytes(*stack_top),
            ram_start: None,
            flash_bytes: 0,
            ram_bytes: 0,
            sizes: Sizes::default(),
            stack: stack(&elf),
        };
        for section in elf.sections().filter(is_loaded) {
            let (in_flash, in_ram) = match section.kind() {
                SectionKind::UninitializedData => (false, true),
                SectionKind::Data => (true, true),
                _ => (true, false),
            };
            *match section.kind() {
                SectionKind::UninitializedData => &mut layout.sizes.bss,
                SectionKind::Data => &mut layout.sizes.data,
                _ if section.name() == Ok(".rodata") => &mut layout.sizes.rodata,
                _ => &mut layout.sizes.text,
            } += section.size();
            if in_flash {
                layout.flash_bytes += section.size();
            }
            if in_ram && section.size() > 0 {
                layout.ram_bytes += section.size();
                let start = layout.ram_start.unwrap_or(u64::MAX);
                layout.ram_start = Some(start.min(section.address()));
            }
        }
        Ok(layout)
    }
}

fn stack<'data>(elf: &impl Object<'data>) -> Option<(u32, u32)> {
    let address = |name: &str| {
        let symbol = elf.symbols().find(|symbol| symbol.name() == Ok(name))?;
        u32::try_from(symbol.address()).ok()
    };
    Some((address("_stack_end")?, address("_stack_start")?))
}

/// Debug information and defmt's strings stay in the file.
fn is_loaded<'data>(section: &impl ObjectSection<'data>) -> bool {
    matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & u64::from(SHF_ALLOC) != 0)
}
