//! What messages show of a file.

/// Characters of a name or a cell that a message shows; what a person wrote is shorter.
const CHARACTERS: usize = 80;

/// Names that a message lists.
const NAMES: usize = 20;

/// The start of a text from a file, with `...` where there is more.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(CHARACTERS) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// The start of bytes from a file that should be text.
pub(super) fn excerpt_of_bytes(bytes: &[u8]) -> String {
    // A character has four bytes at most; one that is cut off here is beyond those that are shown.
    let start = &bytes[..bytes.len().min(4 * (CHARACTERS + 1))];
    excerpt(&String::from_utf8_lossy(start))
}

/// Names from a file, the first twenty of them, each cut.
pub fn list_names(names: &[String]) -> String {
    let shown = names.iter().take(NAMES);
    let shown: Vec<String> = shown.map(|name| format!("`{}`", excerpt(name))).collect();
    let more = match names.len().saturating_sub(NAMES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    shown.join(", ") + &more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_cut_at_a_character() {
        let eighty = "\u{e4}".repeat(80);
        assert_eq!(excerpt(&eighty), eighty);
        assert_eq!(excerpt(&format!("{eighty}x")), format!("{eighty}..."));
        assert_eq!(excerpt_of_bytes(eighty.as_bytes()), eighty);
        assert_eq!(
            excerpt_of_bytes("\u{1f30d}".repeat(1 << 20).as_bytes()),
            "\u{1f30d}".repeat(80) + "..."
        );
        assert_eq!(excerpt_of_bytes(b"a\xff"), "a\u{fffd}");
    }

    #[test]
    fn of_many_names_the_first_are_listed() {
        let names: Vec<String> = (0..22).map(|number| format!("c{number}")).collect();
        assert_eq!(list_names(&names[..2]), "`c0`, `c1`");
        assert!(list_names(&names[..20]).ends_with(", `c19`"));
        assert!(list_names(&names).ends_with(", `c19` and 2 more"));
    }
}
