//! Texts from elsewhere (serial numbers, names of files, columns and axes, tools) on their way to
//! a terminal, into CSV, HTML, code or the name of a file: one function for each.
//!
//! A log, a set or a unit may hold any text. Every text that leaves for one of these places
//! passes its function here; the report's markup is escaped by `maud`, and string literals of Rust
//! by `{:?}`.

use std::fmt::Write as _;

/// Whether a character is not seen, but acts on what shows it: control characters, separators of
/// lines, and the marks that turn the direction of writing or have no width.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e007f}')
}

fn escaped(text: &str, is_bad: impl Fn(char) -> bool) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if is_bad(c) {
            out.extend(c.escape_default());
        } else {
            out.push(c);
        }
    }
    out
}

/// A text as a part of a line: `\n` in place of a line break, `\u{1b}` in place of an escape
/// character.
pub fn line(text: &str) -> String {
    escaped(text, is_hidden)
}

/// Lines as they are shown; all but line breaks as in [`line()`].
pub fn lines(text: &str) -> String {
    escaped(text, |c| c != '\n' && is_hidden(c))
}

/// JSON with what is [not seen](line()) as `\u` escapes of JSON, so that it can be printed and is
/// the same when read.
///
/// `text` must be JSON on one line: such characters are then within strings only.
pub fn json(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) {
            for unit in c.encode_utf16(&mut [0; 2]) {
                let _ = write!(out, "\\u{unit:04x}");
            }
        } else {
            out.push(c);
        }
    }
    out
}

/// A cell of CSV, which spreadsheets must not take for a formula: a text that begins like one
/// gets an apostrophe before it, a number stays. Quotes and commas are the matter of the writer.
pub fn csv_cell(text: &str) -> String {
    let text = line(text);
    if text.starts_with(['=', '+', '-', '@']) && text.parse::<f64>().is_err() {
        format!("'{text}")
    } else {
        text
    }
}

/// A part of the name of a file: it names no other folder.
pub fn file_name(text: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let plain = text.chars().map(|c| if is_plain(c) { c } else { '_' });
    plain.collect()
}

/// A part of the path of a link: it names no other folder and no scheme, and is plain ASCII.
pub fn url_part(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte) {
            out.push(byte.into());
        } else {
            let _ = write!(out, "%{byte:02X}");
        }
    }
    out
}

/// A text within HTML, also within a quoted attribute.
pub fn html(text: &str) -> String {
    line(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// A text within a comment of Rust that ends with its line, or within one of C, which it cannot
/// end.
pub fn comment(text: &str) -> String {
    line(text).replace("*/", "* /").replace("/*", "/ *")
}

/// A string literal of C; whatever is not plain ASCII becomes octal escapes, which, unlike
/// hexadecimal ones, end after three digits.
pub fn c_literal(text: &str) -> String {
    let mut quoted = String::from("\"");
    for byte in text.bytes() {
        match byte {
            // A question mark could begin a trigraph.
            b'"' | b'\\' | b'?' => quoted.extend(['\\', byte.into()]),
            b' '..=b'~' => quoted.push(byte.into()),
            _ => quoted.push_str(&format!("\\{byte:03o}")),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_on_a_terminal_is_shown_instead() {
        assert_eq!(line("S\u{e9} 7 \u{4e2d}"), "S\u{e9} 7 \u{4e2d}");
        assert_eq!(
            line("a\n\t\u{1b}[2J\u{9b}\u{202e}"),
            "a\\n\\t\\u{1b}[2J\\u{9b}\\u{202e}"
        );
        assert_eq!(lines("a\nb\r\n"), "a\nb\\r\n");
    }

    #[test]
    fn json_stays_the_same_when_read() {
        let text = "\u{9b}\u{7f}\u{202e}\u{e0041}\u{1b}\n\"\\ \u{e9}";
        let printed = json(&serde_json::to_string(text).unwrap());
        assert!(!printed.chars().any(is_hidden), "{printed}");
        assert_eq!(serde_json::from_str::<String>(&printed).unwrap(), text);
    }

    #[test]
    fn no_cell_begins_like_a_formula_unless_it_is_a_number() {
        for (text, cell) in [
            ("=1+1", "'=1+1"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("-cmd|' /C calc'!A0", "'-cmd|' /C calc'!A0"),
            ("\t=1", "\\t=1"),
            ("-1.5e-3", "-1.5e-3"),
            ("S7", "S7"),
        ] {
            assert_eq!(csv_cell(text), cell);
        }
    }

    #[test]
    fn a_name_of_a_file_names_no_folder() {
        assert_eq!(file_name("bias-x_1"), "bias-x_1");
        assert_eq!(file_name("a/../..\\b c\n"), "a_.._.._b_c_");
    }

    #[test]
    fn a_part_of_a_link_is_no_scheme_and_no_path() {
        assert_eq!(url_part("SN-7_a.1~"), "SN-7_a.1~");
        assert_eq!(
            url_part("javascript:x/\u{e9}?#"),
            "javascript%3Ax%2F%C3%A9%3F%23"
        );
    }

    #[test]
    fn markup_is_text() {
        assert_eq!(
            html("<b a='1'>&\"\u{7}"),
            "&lt;b a=&#39;1&#39;&gt;&amp;&quot;\\u{7}"
        );
    }

    #[test]
    fn comments_and_literals_cannot_end_early() {
        let text = comment("x */ int y; /* */*/ \n/*/ z");
        assert!(!text.contains(['\n']) && !text.contains("*/") && !text.contains("/*"));
        assert_eq!(c_literal("SN 7"), "\"SN 7\"");
        assert_eq!(c_literal("a\"b\\c"), "\"a\\\"b\\\\c\"");
        assert_eq!(c_literal("\u{e9}1\n??/"), "\"\\303\\2511\\012\\?\\?/\"");
    }
}
