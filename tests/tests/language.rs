//! The language of the project: words of its old dialect stand nowhere in what people read, and
//! the sentences of the documents stay short.

use std::fs;
use std::path::{Path, PathBuf};

use tempco_tests::root;

/// What is forbidden wherever it stands. The glossary in ARCHITECTURE.md has the words in use.
const PHRASES: [&str; 36] = [
    "anew",
    "are none of",
    "believable",
    "believe",
    "believed",
    "believes",
    "beside the",
    "digest",
    "digests",
    "earn",
    "earned",
    "earns",
    "effective temperature",
    "is none of",
    "knows of",
    "leg",
    "legs",
    "make of",
    "makes of",
    "no better than none",
    "no better than without",
    "objection",
    "objections",
    "programme",
    "programmes",
    "remark",
    "remarks",
    "rerun",
    "slow part",
    "slow parts",
    "so-manieth",
    "tells no",
    "that of the",
    "those of the",
    "told apart",
    "told from",
];

/// This list. Names of files and keys need no exception: they stand in backticks.
const EXCEPTIONS: [&str; 1] = ["tests/tests/language.rs"];

/// Most words of a sentence, as a mean over a document.
const WORDS_PER_SENTENCE: f64 = 17.0;

/// Files below a folder, with one of these endings.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            found.extend(files(&path, endings));
        } else if endings.iter().any(|ending| name.ends_with(ending)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Length of the string that a text begins with, quotes included.
fn string_length(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            b'"' if !is_escaped => return at + 1,
            b'\\' => is_escaped = !is_escaped,
            _ => is_escaped = false,
        }
    }
    text.len()
}

/// Comments and texts of a Rust source in their lines. Code and strings of one word, which are
/// names, are left out.
fn prose(source: &str) -> String {
    let mut prose = String::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let (length, is_prose) = if rest.starts_with("//") {
            (rest.find('\n').unwrap_or(rest.len()), true)
        } else if let Some(raw) = rest.strip_prefix("r#\"") {
            (raw.find("\"#").map_or(rest.len(), |end| end + 5), true)
        } else if rest.starts_with("'\"'") {
            (3, false)
        } else if first == '"' {
            let length = string_length(rest);
            (length, rest[..length].contains(' '))
        } else {
            (first.len_utf8(), false)
        };
        let (part, after) = rest.split_at(length);
        if is_prose {
            let part = part.strip_prefix("r#").unwrap_or(part);
            prose.push_str(&part.replace("\\n", " "));
        } else {
            prose.push(' ');
            prose.extend(part.chars().filter(|&character| character == '\n'));
        }
        rest = after;
    }
    prose
}

/// Words in small letters, without punctuation, each with its line.
fn words(text: &str) -> Vec<(String, usize)> {
    let punctuation = |character: char| ".,;:()!?*/\"'\\".contains(character);
    let of_line = |(index, line): (usize, &str)| {
        let words = line.split_whitespace();
        let bare = words.map(|word| word.trim_matches(punctuation).to_lowercase());
        let kept = bare.filter(|word| !word.is_empty());
        kept.map(|word| (word, index + 1)).collect::<Vec<_>>()
    };
    text.lines().enumerate().flat_map(of_line).collect()
}

/// `LINE: PHRASE` for every phrase in a text. A phrase may go on in the next line.
fn found_in(text: &str) -> Vec<String> {
    let words = words(text);
    let mut found = Vec::new();
    for phrase in PHRASES {
        let phrase_words: Vec<&str> = phrase.split(' ').collect();
        for window in words.windows(phrase_words.len()) {
            if window.iter().map(|(word, _)| word).eq(&phrase_words) {
                found.push(format!("{}: {phrase}", window[0].1));
            }
        }
    }
    found
}

#[test]
fn the_old_dialect_is_gone() {
    let root = root();
    let mut paths: Vec<PathBuf> = ["README", "ARCHITECTURE", "CONTRIBUTING", "CHANGELOG"]
        .map(|name| root.join(name).with_extension("md"))
        .into();
    for folder in ["crates", "docs", "firmware", "host-tools", "tests"] {
        paths.extend(files(&root.join(folder), &[".md", ".rs", ".toml"]));
    }
    assert!(paths.len() > 400, "{} files", paths.len());
    let mut found = Vec::new();
    for path in &paths {
        let name = path.strip_prefix(&root).unwrap().to_string_lossy();
        if EXCEPTIONS.contains(&name.replace('\\', "/").as_str()) {
            continue;
        }
        let text = fs::read_to_string(path).unwrap();
        let is_rust = path.extension().is_some_and(|extension| extension == "rs");
        let text = if is_rust { prose(&text) } else { text };
        found.extend(
            found_in(&text)
                .iter()
                .map(|place| format!("{name}:{place}")),
        );
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn phrases_are_found_in_comments_and_texts_only() {
    let source = "\
/// As told
/// apart.
let legs = \"legs\"; // `legs`, '\"'
let message = \"that \\
    of the\\nother\";
let quote = ('\"', r#\"anew \"#);
";
    let expected = ["6: anew", "4: that of the", "1: told apart"];
    assert_eq!(found_in(&prose(source)), expected);
}

/// Mean number of words per sentence of a document, without code, tables and headings. An item
/// of a list ends a sentence.
fn mean_sentence(document: &str) -> f64 {
    let (mut in_code, mut in_sentence) = (false, false);
    let (mut words, mut sentences) = (0, 0);
    for line in document.lines().map(str::trim) {
        let is_fence = line.starts_with("```");
        in_code ^= is_fence;
        let number = line.trim_start_matches(|digit: char| digit.is_ascii_digit());
        let item = line.strip_prefix("- ").or(number.strip_prefix(". "));
        let (begins_item, line) = (item.is_some(), item.unwrap_or(line));
        let is_prose = !in_code && !is_fence && !line.starts_with(['|', '#', '<', '!']);
        if in_sentence && (line.is_empty() || begins_item || !is_prose) {
            (in_sentence, sentences) = (false, sentences + 1);
        }
        if !is_prose {
            continue;
        }
        // What stands in backticks is one word.
        let outside = line.split('`').step_by(2).collect::<Vec<_>>().join("code");
        for word in outside.split_whitespace() {
            words += 1;
            in_sentence = !word
                .trim_end_matches([')', '*', '"'])
                .ends_with(['.', '?', '!']);
            sentences += usize::from(!in_sentence);
        }
    }
    f64::from(words) / (sentences + usize::from(in_sentence)).max(1) as f64
}

#[test]
fn sentences_of_the_documents_are_short() {
    let root = root();
    let mut paths = files(&root.join("docs"), &[".md"]);
    paths.push(root.join("README.md"));
    let mut long = Vec::new();
    for path in paths {
        let mean = mean_sentence(&fs::read_to_string(&path).unwrap());
        if mean > WORDS_PER_SENTENCE {
            long.push(format!("{}: {mean:.1} words per sentence", path.display()));
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
    let example = "# Head\n\nOne two `three 4`. Five\nsix:\n\n- seven eight\n- nine\n";
    assert!((mean_sentence(example) - 2.0).abs() < 0.3);
}
