//! Symbols that give away what is linked in.

/// What a forbidden symbol belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A path to a panic.
    Panic,
    /// Formatting.
    Formatting,
    /// Double precision in software.
    SoftDouble,
}

/// The symbols of an image that the core must not need, with what they belong to.
pub fn forbidden_symbols(symbols: &[String]) -> Vec<(&str, Family)> {
    symbols
        .iter()
        .filter_map(|name| Some((name.as_str(), family(name)?)))
        .collect()
}

fn family(name: &str) -> Option<Family> {
    if name.contains("core::fmt") {
        Some(Family::Formatting)
    } else if is_failure_path(name) {
        Some(Family::Panic)
    } else if is_soft_double(name) {
        Some(Family::SoftDouble)
    } else {
        None
    }
}

/// Whether a function is part of how a program fails: a panic, or what the standard library calls
/// on the way to one. None of them returns.
pub fn is_failure_path(name: &str) -> bool {
    const EXACT: [&str; 3] = ["rust_begin_unwind", "rust_panic", "abort"];
    const PARTS: [&str; 4] = [
        "core::panicking",
        "::unwrap_failed",
        "::expect_failed",
        "panic_",
    ];
    let last = name.rsplit("::").next().unwrap_or_default();
    EXACT.contains(&last)
        || PARTS.iter().any(|part| name.contains(part))
        || (name.starts_with("core::") && last.ends_with("_fail"))
}

/// The helpers of the run-time ABI for the Arm architecture, and those of GCC, for doubles.
fn is_soft_double(name: &str) -> bool {
    const HELPERS: [&str; 8] = ["drsub", "f2d", "i2d", "ui2d", "l2d", "ul2d", "h2d", "cdcmp"];
    if let Some(helper) = name.strip_prefix("__aeabi_") {
        const OPERATIONS: [&str; 6] = ["dadd", "dsub", "dmul", "ddiv", "dcmp", "dneg"];
        return HELPERS
            .iter()
            .chain(&OPERATIONS)
            .any(|start| helper.starts_with(start))
            || helper.starts_with("d2");
    }
    let gcc = name.strip_prefix("__").unwrap_or_default();
    gcc.len() < 16
        && gcc.contains("df")
        && !gcc.contains("::")
        && gcc.chars().all(|c| c.is_ascii_alphanumeric())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_told_apart() {
        for name in [
            "core::panicking::panic_fmt",
            "core::slice::index::slice_end_index_len_fail",
            "core::option::unwrap_failed",
            "__rustc::rust_begin_unwind",
        ] {
            assert_eq!(family(name), Some(Family::Panic), "{name}");
        }
        for name in [
            "__aeabi_dadd",
            "__aeabi_f2d",
            "__aeabi_d2iz",
            "__muldf3",
            "__floatsidf",
        ] {
            assert_eq!(family(name), Some(Family::SoftDouble), "{name}");
        }
        let name = "<u32 as core::fmt::Display>::fmt";
        assert_eq!(family(name), Some(Family::Formatting));
        for name in [
            "__aeabi_memcpy4",
            "__aeabi_fadd",
            "__sdata",
            "tempco::table::Table<_>::bias",
            "__aeabi_idiv0",
        ] {
            assert_eq!(family(name), None, "{name}");
        }
    }
}
