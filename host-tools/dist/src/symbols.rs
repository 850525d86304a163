//! The names in an object, and what is wrong with them.

use std::path::Path;
use std::process::Command;

use anyhow::Result;
use tempco_qemu::checked;

/// Words in names of functions that a core without panics and unwinding does not have.
const FORBIDDEN: [&str; 4] = ["panic", "unwind", "personality", "rust_alloc"];

/// A name in an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// The name.
    pub name: String,
    /// As `nm` shows it: capital for what other objects see, `U` for what they must have.
    pub kind: char,
}

impl Symbol {
    /// Whether the object has it and other objects see it.
    pub const fn is_defined(&self) -> bool {
        self.kind.is_ascii_uppercase() && self.kind != 'U'
    }
}

/// The names in an object or an archive.
///
/// # Errors
/// `nm` fails.
pub fn names(nm: &str, object: &Path) -> Result<Vec<Symbol>> {
    // `--format=posix`: the name, its kind, and what else there is.
    let output = checked(Command::new(nm).arg("--format=posix").arg(object))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let symbols = text.lines().filter_map(|line| {
        let mut words = line.split_whitespace();
        let (name, kind) = (words.next()?, words.next()?);
        Some(Symbol {
            name: name.to_owned(),
            kind: kind.chars().next()?,
        })
    });
    Ok(symbols.collect())
}

/// What is wrong: names that others see without the prefix, what is missing but for some functions of
/// the C library, and panics or unwinding.
pub fn faults(symbols: &[Symbol], prefix: &str, from_libc: &[&str]) -> Vec<String> {
    let fault = |symbol: &Symbol| {
        let name = symbol.name.as_str();
        let what = if symbol.kind == 'U' && !from_libc.contains(&name) {
            "is not there"
        } else if symbol.is_defined() && !name.starts_with(prefix) {
            "is seen by others"
        } else if FORBIDDEN.iter().any(|word| name.contains(word)) {
            "has no place in it"
        } else {
            return None;
        };
        Some(format!("{name} {what}"))
    };
    let mut faults: Vec<String> = symbols.iter().filter_map(fault).collect();
    if !symbols.iter().any(Symbol::is_defined) {
        faults.push("it has no functions".to_owned());
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_have_no_place_are_found() {
        let symbol = |name: &str, kind| Symbol {
            name: name.to_owned(),
            kind,
        };
        let good = [
            symbol("tempco3_correct", 'T'),
            symbol("memcpy", 'U'),
            symbol("__aeabi_fadd", 't'),
        ];
        assert_eq!(faults(&good, "tempco", &["memcpy"]), [""; 0]);
        assert_eq!(faults(&good, "tempco", &[]), ["memcpy is not there"]);
        for (name, kind, what) in [
            ("rust_begin_unwind", 'T', "is seen by others"),
            ("__aeabi_fadd", 'W', "is seen by others"),
            ("core::panicking::panic_fmt", 't', "has no place in it"),
            ("rust_eh_personality", 't', "has no place in it"),
            ("tempco_c_can_panic", 'U', "is not there"),
        ] {
            let found = faults(&[symbol(name, kind), good[0].clone()], "tempco", &[]);
            assert_eq!(found, [format!("{name} {what}")]);
        }
        assert_eq!(faults(&[], "tempco", &[]), ["it has no functions"]);
    }
}
