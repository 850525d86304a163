//! A set as a folder of files, and whether they are of one set.
//!
//! `coefficients.json` is moved to its place after all others: where the writing was cut short, it
//! is the one of the set before, or missing, and [`strangers`] finds the files that are newer.

use std::fs;
use std::io;
use std::path::Path;

use thiserror::Error;

use crate::CoefficientSet;
use crate::emit::{table_bin, table_h, table_rs};
use crate::files::replace_with;

/// The file that holds the whole set, written last.
pub const MARK: &str = "coefficients.json";

/// The report, which a set may do without.
pub const REPORT: &str = "report.html";

/// The table as a flash image.
pub const TABLE_BIN: &str = "table.bin";

const TABLE_RS: &str = "table.rs";
const TABLE_H: &str = "table.h";

/// Names of the files of a set, in the order in which they are told of.
pub fn file_names(with_report: bool) -> impl Iterator<Item = &'static str> {
    let names = [MARK, TABLE_BIN, TABLE_RS, TABLE_H].into_iter();
    names.chain(with_report.then_some(REPORT))
}

/// Writes the files of a set into `folder`, which is made if need be: all or none. A report of the
/// set before goes where there is none now; other files stay.
///
/// # Errors
/// What the system says; a set that could not be read back.
pub fn write_set(
    folder: &Path,
    set: &CoefficientSet,
    report: Option<&str>,
) -> Result<(), WriteError> {
    write_set_with(folder, set, report, || ())
}

fn write_set_with(
    folder: &Path,
    set: &CoefficientSet,
    report: Option<&str>,
    before_each: impl FnMut(),
) -> Result<(), WriteError> {
    set.check().map_err(WriteError::Set)?;
    let image = table_bin(set).map_err(WriteError::Set)?;
    let (rust, c) = (table_rs(set), table_h(set));
    let json = set.to_json();
    let mut files = vec![
        (TABLE_BIN, &image[..]),
        (TABLE_RS, rust.as_bytes()),
        (TABLE_H, c.as_bytes()),
    ];
    files.extend(report.map(|report| (REPORT, report.as_bytes())));
    files.push((MARK, json.as_bytes()));
    let obsolete: &[&str] = if report.is_none() { &[REPORT] } else { &[] };
    Ok(replace_with(folder, &files, obsolete, before_each)?)
}

/// A set was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// A file cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The set cannot be held by its files.
    #[error("{0}")]
    Set(String),
}

/// The files in the folder of a set that are of another set, though they have the names of its
/// files: the writing was cut short, or files were exchanged.
///
/// # Errors
/// A file that cannot be read.
pub fn strangers(folder: &Path, set: &CoefficientSet) -> io::Result<Vec<&'static str>> {
    let mut strangers = Vec::new();
    for name in file_names(true).filter(|name| *name != MARK) {
        match fs::read(folder.join(name)) {
            Ok(contents) if is_of(set, name, &contents) => {}
            Ok(_) => strangers.push(name),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
    }
    Ok(strangers)
}

/// Whether a file is of a set: by serial number, CRC, axes and units, which stand in the files of
/// every version.
fn is_of(set: &CoefficientSet, name: &str, contents: &[u8]) -> bool {
    let text = String::from_utf8_lossy(contents);
    let has = |line: String| text.lines().any(|found| found == line);
    match name {
        TABLE_BIN => table_bin::is_of(set, contents),
        TABLE_RS => table_rs::identity(set).into_iter().all(has),
        TABLE_H => table_h::identity(set).into_iter().all(has),
        _ => text.contains(&format!("<code>{}</code>", set.table_crc32)),
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;
    use crate::import::static_coefficients;
    use crate::{SetError, check_folder, load_set};

    fn set(serial: &str, a0: f64) -> CoefficientSet {
        let text = format!(
            "gyro,segment,temp_min_c,temp_max_c,a0_pulses,a1_pulses_per_c,a2_pulses_per_c2\n\
             X,1,-15,80,{a0},-0.0014,0.00001\n"
        );
        let mut set = static_coefficients(Path::new("printed.csv"), &text).unwrap();
        serial.clone_into(&mut set.serial);
        set
    }

    fn report(set: &CoefficientSet) -> String {
        format!("<p><code>{}</code></p>", set.table_crc32)
    }

    /// Ends the writing before each step, as a kill does, and looks at what is there.
    #[test]
    fn a_writing_that_was_cut_short_is_never_taken_for_a_set() {
        struct Killed;
        let (old, new) = (set("S1", 0.01), set("S1", 0.02));
        for new_report in [Some(report(&new)), None] {
            let mut steps = 0;
            for last in 0.. {
                let folder = tempfile::tempdir().unwrap();
                let root = folder.path();
                write_set(root, &old, Some(&report(&old))).unwrap();
                fs::write(root.join("notes.txt"), "mine").unwrap();
                let mut call = 0;
                let written = catch_unwind(AssertUnwindSafe(|| {
                    write_set_with(root, &new, new_report.as_deref(), || {
                        if call == last {
                            std::panic::resume_unwind(Box::new(Killed));
                        }
                        call += 1;
                    })
                }));
                assert_eq!(fs::read(root.join("notes.txt")).unwrap(), b"mine");
                let (mark, image) = (root.join(MARK), root.join(TABLE_BIN));
                let loaded = load_set(&mark);
                assert_eq!(check_folder(&image).is_ok(), loaded.is_ok());
                match (written.is_ok(), last, loaded) {
                    (true, _, Ok(set)) => {
                        assert_eq!(set, new);
                        assert_eq!(root.join(REPORT).exists(), new_report.is_some());
                        break;
                    }
                    (false, 0, Ok(set)) => assert_eq!(set, old),
                    (false, 1.., Err(SetError::Mixed { strangers, .. })) => {
                        assert_eq!(strangers[0], TABLE_BIN);
                    }
                    (ended, _, loaded) => panic!("step {last}, {ended}: {loaded:?}"),
                }
                steps = last + 1;
            }
            assert_eq!(steps, 5);
        }
    }

    #[test]
    fn a_set_written_for_the_first_time_is_there_when_all_of_it_is() {
        let set = set("S1", 0.01);
        for last in 0..4 {
            let folder = tempfile::tempdir().unwrap();
            let mut call = 0;
            let _ = catch_unwind(AssertUnwindSafe(|| {
                write_set_with(folder.path(), &set, None, || {
                    if call == last {
                        std::panic::resume_unwind(Box::new(()));
                    }
                    call += 1;
                })
            }));
            assert!(!folder.path().join(MARK).exists(), "{last}");
        }
    }

    #[test]
    fn files_of_another_set_are_named() {
        let (one, other) = (set("S1", 0.01), set("S2", 0.01));
        assert_eq!(one.crc32(), other.crc32());
        let mut renamed = one.clone();
        "y".clone_into(&mut renamed.channels[0].axes[0].name);
        let further = set("S1", 0.02);
        for (foreign, expected) in [
            (other, &[TABLE_BIN, TABLE_RS, TABLE_H][..]),
            (renamed, &[TABLE_RS, TABLE_H]),
            (further, &[TABLE_BIN, TABLE_RS, TABLE_H, REPORT]),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let root = folder.path();
            write_set(root, &one, Some(&report(&one))).unwrap();
            assert_eq!(strangers(root, &one).unwrap(), [""; 0]);
            assert_eq!(strangers(root, &foreign).unwrap(), expected);
            fs::write(root.join(TABLE_BIN), b"").unwrap();
            assert_eq!(strangers(root, &one).unwrap(), [TABLE_BIN]);
            fs::write(root.join(TABLE_BIN), vec![0; 1 << 20]).unwrap();
            assert_eq!(strangers(root, &one).unwrap(), [TABLE_BIN]);
        }
    }

    /// Texts that try to end the place they stand in.
    const HOSTILE: [&str; 7] = [
        "\npub const EVIL: u8 = 1; //",
        "\r\u{2028}\u{85}int evil;",
        "*/ int evil; /*",
        "\"; const EVIL: u8 = 1; //\\",
        "\\",
        "??/\" ??' \u{202e}\u{0}\u{1b}[2J",
        "/*//*/ \u{e9}",
    ];

    /// Code without its comments and what is in its string literals.
    fn bare(code: &str) -> String {
        let mut bare = String::new();
        let mut rest = code;
        while let Some(c) = rest.chars().next() {
            let len = if rest.starts_with("//") {
                rest.find('\n').unwrap()
            } else if rest.starts_with("/*") {
                rest.find("*/").unwrap() + 2
            } else if c == '"' {
                let mut escaped = false;
                let end = rest[1..].find(|c| {
                    let ends = c == '"' && !escaped;
                    escaped = c == '\\' && !escaped;
                    ends
                });
                end.unwrap() + 2
            } else {
                bare.push(c);
                c.len_utf8()
            };
            rest = &rest[len..];
        }
        bare
    }

    #[test]
    fn no_text_of_a_set_becomes_code() {
        let plain = set("S1", 0.01);
        for text in HOSTILE {
            let mut hostile = plain.clone();
            let channel = &mut hostile.channels[0];
            let texts = [
                &mut hostile.serial,
                &mut hostile.provenance.tool,
                &mut hostile.provenance.created,
                &mut hostile.provenance.inputs[0].file,
                &mut channel.temperature,
                &mut channel.segments[0].terms[0],
                &mut channel.axes[0].name,
            ];
            texts.into_iter().for_each(|field| text.clone_into(field));
            for (emitted, expected) in [
                (table_rs(&hostile), table_rs(&plain)),
                (table_h(&hostile), table_h(&plain)),
            ] {
                assert_eq!(bare(&emitted), bare(&expected), "{text:?}");
                assert!(
                    !emitted.chars().any(|c| c != '\n' && c.is_control()),
                    "{emitted}"
                );
                assert_eq!(emitted.lines().count(), expected.lines().count());
            }
        }
    }
}
