//! Words of a line of LLVM's textual code.

use super::{Operand, Type, Unsupported};

/// The words of one line, read from left to right.
pub(super) struct Words<'a> {
    words: Vec<&'a str>,
    next: usize,
    line: &'a str,
}

impl<'a> Words<'a> {
    /// Splits a line; a comment and the metadata at its end are left out.
    pub(super) fn new(line: &'a str) -> Self {
        Self {
            words: split(line),
            next: 0,
            line,
        }
    }

    pub(super) fn error(&self, what: impl Into<String>) -> Unsupported {
        Unsupported::new(what, self.line)
    }

    pub(super) fn peek(&self) -> Option<&'a str> {
        self.words.get(self.next).copied()
    }

    pub(super) fn word(&mut self) -> Result<&'a str, Unsupported> {
        let word = self.peek().ok_or_else(|| self.error("end of line"))?;
        self.next += 1;
        Ok(word)
    }

    /// Takes the word if it comes next.
    pub(super) fn take(&mut self, word: &str) -> bool {
        let found = self.peek() == Some(word);
        self.next += usize::from(found);
        found
    }

    pub(super) fn expect(&mut self, word: &str) -> Result<(), Unsupported> {
        if self.take(word) {
            Ok(())
        } else {
            Err(self.error(format!("`{word}` expected")))
        }
    }

    /// Takes the given words as far as they come next.
    pub(super) fn flags(&mut self, known: &[&str]) -> Vec<String> {
        let mut flags = Vec::new();
        while let Some(word) = self.peek().filter(|word| known.contains(word)) {
            flags.push(word.to_owned());
            self.next += 1;
        }
        flags
    }

    /// The end of the line, but for an alignment.
    pub(super) fn end(&mut self) -> Result<(), Unsupported> {
        if self.take(",") {
            self.expect("align")?;
            self.word()?;
        }
        match self.peek() {
            None => Ok(()),
            Some(word) => Err(self.error(format!("`{word}` at the end"))),
        }
    }

    pub(super) fn ty(&mut self) -> Result<Type, Unsupported> {
        let word = self.word()?;
        match word {
            "float" => Ok(Type::Float),
            "ptr" => Ok(Type::Ptr),
            _ => match word.strip_prefix('i').map(str::parse) {
                Some(Ok(bits)) if bits > 0 => Ok(Type::Int(bits)),
                _ => Err(self.error(format!("type `{word}`"))),
            },
        }
    }

    pub(super) fn operand(&mut self, ty: Type) -> Result<Operand, Unsupported> {
        let word = self.word()?;
        if let Some(name) = word.strip_prefix('%') {
            return Ok(Operand::Local(name.to_owned()));
        }
        let constant = match (ty, word) {
            (Type::Int(1), "true") => Some(Operand::Int(1)),
            (Type::Int(1), "false") => Some(Operand::Int(0)),
            (Type::Int(_), _) => word.parse().ok().map(Operand::Int),
            (Type::Float, _) => float(word).map(Operand::Float),
            _ => None,
        };
        constant.ok_or_else(|| self.error(format!("operand `{word}`")))
    }

    /// A value with its type; attributes in between are left out.
    pub(super) fn typed(&mut self) -> Result<(Type, Operand), Unsupported> {
        let ty = self.ty()?;
        self.attributes()?;
        Ok((ty, self.operand(ty)?))
    }

    /// Skips the attributes of a parameter or argument, with their brackets.
    pub(super) fn attributes(&mut self) -> Result<(), Unsupported> {
        const KNOWN: [&str; 12] = [
            "noundef",
            "noalias",
            "nonnull",
            "readonly",
            "writeonly",
            "align",
            "captures",
            "dereferenceable",
            "initializes",
            "nocapture",
            "immarg",
            "returned",
        ];
        while let Some(word) = self.peek().filter(|word| KNOWN.contains(word)) {
            self.next += 1;
            if word == "align" {
                self.next += 1;
            } else if self.peek() == Some("(") {
                let mut depth = 0;
                loop {
                    match self.word()? {
                        "(" => depth += 1,
                        ")" => depth -= 1,
                        _ => {}
                    }
                    if depth == 0 {
                        break;
                    }
                }
            }
        }
        Ok(())
    }
}

/// A float as LLVM writes it: decimal, or the bits of the equal double in hexadecimal.
fn float(word: &str) -> Option<u32> {
    let value = match word.strip_prefix("0x") {
        Some(bits) => f64::from_bits(u64::from_str_radix(bits, 16).ok()?),
        None => word.parse().ok()?,
    };
    let narrow = value as f32;
    (f64::from(narrow).to_bits() == value.to_bits() || value.is_nan()).then(|| narrow.to_bits())
}

fn split(line: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = line.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = match first {
            ';' | '!' | '#' => break,
            '"' => quoted(rest, 0),
            '%' | '@' if rest[1..].starts_with('"') => quoted(rest, 1),
            '(' | ')' | '[' | ']' | '{' | '}' | '<' | '>' | ',' | '=' | '*' | ':' => 1,
            _ => rest
                .find(|c: char| c.is_whitespace() || "()[]{}<>,=*:".contains(c))
                .unwrap_or(rest.len()),
        };
        words.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    // The comma that led to the metadata.
    if rest.starts_with('!') && words.last() == Some(&",") {
        words.pop();
    }
    words
}

/// Length of a word in quotes after `start` bytes.
fn quoted(text: &str, start: usize) -> usize {
    let inner = &text[start + 1..];
    inner.find('"').map_or(text.len(), |end| start + end + 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metadata_and_comments_are_left_out() {
        let line = "  %_7.i = load i32, ptr %\"a b\", align 4, !range !3, !noundef !1";
        let words = split(line);
        assert_eq!(
            words,
            [
                "%_7.i", "=", "load", "i32", ",", "ptr", "%\"a b\"", ",", "align", "4"
            ]
        );
        assert_eq!(split("bb1:    ; preds = %start"), ["bb1", ":"]);
    }

    #[test]
    fn floats_are_read_to_the_bit() {
        assert_eq!(float("0x3FD5555560000000"), Some((1.0_f32 / 3.0).to_bits()));
        assert_eq!(float("5.000000e-01"), Some(0.5_f32.to_bits()));
        assert_eq!(float("-0.000000e+00"), Some((-0.0_f32).to_bits()));
        // A double that is no float would be another number.
        assert_eq!(float("0x3FD5555555555555"), None);
    }
}
