//! The functions of an ELF file.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use crate::decode::Decoder;
use crate::{Error, Instruction};

/// A function, as it lies in the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its name in the sources, without the compiler's hash; of several names, one.
    pub name: String,
    /// Address of the first instruction.
    pub address: u64,
    /// Bytes, with the constants among the code.
    pub size: u64,
    /// All instructions, in their order.
    pub instructions: Vec<Instruction>,
}

/// A disassembled image.
#[derive(Clone, Debug)]
pub struct Image {
    functions: BTreeMap<u64, Function>,
    symbols: Vec<String>,
    entry: u64,
}

impl Image {
    /// Disassembles all code of an image.
    ///
    /// # Errors
    /// The file is not such an image, or holds code that is none.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = Error::read(path)?;
        let elf = object::File::parse(&*bytes).map_err(Error::image(path))?;
        if elf.architecture() != object::Architecture::Arm {
            let reason = format!("it is for {:?}", elf.architecture());
            return Err(Error::image(path)(reason));
        }
        let decoder = Decoder::new().map_err(Error::image(path))?;
        let mut functions = BTreeMap::new();
        for section in elf
            .sections()
            .filter(|section| section.kind() == SectionKind::Text)
        {
            let data = section.data().map_err(Error::image(path))?;
            let here = section.address()..section.address() + section.size();
            let starts = starts(&elf, &here);
            let marks = marks(&elf, &here);
            let ends = starts.keys().copied().skip(1).chain([here.end]);
            for ((address, (name, size)), next) in starts.iter().zip(ends) {
                // Assembly may not say how long it is.
                let end = if *size == 0 { next } else { address + size };
                let mut function = Function {
                    name: name.clone(),
                    address: *address,
                    size: end - address,
                    instructions: Vec::new(),
                };
                for code in code(&marks, *address..end) {
                    let offset = |address: u64| (address - here.start) as usize;
                    let bytes = data.get(offset(code.start)..offset(code.end));
                    function.decode(&decoder, bytes.unwrap_or_default(), code.start)?;
                }
                functions.insert(*address, function);
            }
        }
        if functions.is_empty() {
            return Err(Error::image(path)("it has no code"));
        }
        let symbols = elf
            .symbols()
            .filter_map(|symbol| symbol.name().ok().map(demangled));
        Ok(Self {
            functions,
            symbols: symbols.collect(),
            entry: elf.entry() & !1,
        })
    }

    /// All functions by their addresses.
    pub fn functions(&self) -> impl Iterator<Item = &Function> {
        self.functions.values()
    }

    /// The names of all symbols, functions or not.
    pub fn symbols(&self) -> &[String] {
        &self.symbols
    }

    /// Where the processor starts, after the bootloader if there is one.
    pub fn entry(&self) -> u64 {
        self.entry
    }

    /// The function in which an address lies.
    pub fn at(&self, address: u64) -> Option<&Function> {
        let (_, function) = self.functions.range(..=address).next_back()?;
        (address < function.address + function.size).then_some(function)
    }

    /// The function of a name: a path of modules, of which the first may be left out.
    ///
    /// # Errors
    /// There is none, or several.
    pub fn named(&self, name: &str) -> Result<&Function, Error> {
        let tail = format!("::{name}");
        let mut found = self
            .functions()
            .filter(|function| function.name == name || function.name.ends_with(&tail));
        match (found.next(), found.count()) {
            (Some(function), 0) => Ok(function),
            (first, more) => Err(Error::Name {
                name: name.to_owned(),
                found: usize::from(first.is_some()) + more,
            }),
        }
    }

    /// An image of functions that were put together by a test, the first being the entry.
    #[cfg(test)]
    pub(crate) fn of(functions: Vec<Function>) -> Self {
        Self {
            entry: functions[0].address,
            symbols: functions.iter().map(|f| f.name.clone()).collect(),
            functions: functions.into_iter().map(|f| (f.address, f)).collect(),
        }
    }
}

impl Function {
    pub(crate) fn decode(
        &mut self,
        decoder: &Decoder,
        bytes: &[u8],
        address: u64,
    ) -> Result<(), Error> {
        match decoder.decode(bytes, address) {
            Ok(instructions) => self.instructions.extend(instructions),
            Err(done) => {
                return Err(Error::Instruction {
                    function: self.name.clone(),
                    address: address + done as u64,
                    reason: "it does not decode".to_owned(),
                });
            }
        }
        Ok(())
    }
}

/// The functions that start in a range: by address, name and size.
fn starts(elf: &object::File<'_>, here: &Range<u64>) -> BTreeMap<u64, (String, u64)> {
    let mut starts = BTreeMap::<u64, (String, u64)>::new();
    for symbol in elf
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text)
    {
        // The lowest bit says that the code is Thumb code.
        let address = symbol.address() & !1;
        let Ok(name) = symbol.name() else { continue };
        if here.contains(&address) && !is_mark(name) {
            let start = starts.entry(address).or_default();
            // Handlers that do the same share an address; the longest description wins.
            if symbol.size() > start.1 || start.0.is_empty() {
                *start = (demangled(name), symbol.size());
            }
        }
    }
    starts
}

/// Where code (`true`) and constants begin, as the assembler marked it.
fn marks(elf: &object::File<'_>, here: &Range<u64>) -> BTreeMap<u64, bool> {
    elf.symbols()
        .filter(|symbol| here.contains(&symbol.address()))
        .filter_map(|symbol| Some((symbol.address(), symbol.name().ok()?)))
        .filter(|(_, name)| is_mark(name))
        .map(|(address, name)| (address, !name.starts_with("$d")))
        .collect()
}

fn is_mark(name: &str) -> bool {
    matches!(name.split('.').next(), Some("$t" | "$d" | "$a"))
}

/// The parts of a range that are code.
fn code(marks: &BTreeMap<u64, bool>, range: Range<u64>) -> Vec<Range<u64>> {
    let mut parts = Vec::new();
    let before = marks.range(..=range.start).next_back();
    let mut is_code = before.is_none_or(|(_, is_code)| *is_code);
    let mut start = range.start;
    for (&mark, &next) in marks.range(range.start + 1..range.end) {
        if is_code && mark > start {
            parts.push(start..mark);
        }
        (start, is_code) = (mark, next);
    }
    if is_code {
        parts.push(start..range.end);
    }
    parts
}

fn demangled(name: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(name))
}
