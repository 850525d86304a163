//! The same log in every dialect: separators, decimal signs, encodings, lines before the header.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use proptest::prelude::*;

use super::tests::parts_of;
use super::{Chunk, LogError, LogStream, ReadOptions};

/// A log, column by column, as it stands in plain CSV.
#[derive(Clone, Debug)]
struct Text {
    names: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// How a log is written.
#[derive(Clone, Debug)]
struct Dialect {
    separator: &'static str,
    decimal_comma: bool,
    quoted: bool,
    line_end: &'static str,
    encoding: u8,
    preamble: Vec<&'static str>,
    last_cell: bool,
    comment_mark: &'static str,
}

fn any_log() -> impl Strategy<Value = Text> {
    let row = (1_u32..5000, -40_i32..80, -1_000_000_i32..1_000_000);
    proptest::collection::vec(row, 2..40).prop_map(|rows| {
        let mut time = 0_u32;
        let row = |(step, temp_c, value): (u32, i32, i32)| {
            time += step;
            let time_s = format!("{}.{:03}", time / 1000, time % 1000);
            vec![
                time_s,
                format!("{temp_c}.0625"),
                format!("{:.5}", f64::from(value) * 1e-5),
                format!("{:e}", f64::from(value) * 1e-9),
            ]
        };
        Text {
            names: vec!["time_s", "temp_c", "gx_dps", "gy_dps"],
            rows: rows.into_iter().map(row).collect(),
        }
    })
}

fn any_dialect() -> impl Strategy<Value = Dialect> {
    let separator = prop_oneof![
        Just(","),
        Just(";"),
        Just("\t"),
        Just("|"),
        Just(" "),
        Just("  \t ")
    ];
    let preamble = prop_oneof![
        Just(vec![]),
        Just(vec!["# Logger 7, 2024-03-04 10:00:00", "", "# rate, 5 Hz"]),
        Just(vec!["sep=;", "Serial;123", "Start;04.03.2024;10:00"]),
        Just(vec!["// Start Time: Unknown", "// Update Rate: 100.0Hz"]),
        Just(vec!["Device, Operator, Room, Note", "A7, B, 3, cold start"]),
    ];
    let ends = prop_oneof![Just("\n"), Just("\r\n"), Just("\r")];
    let mark = prop_oneof![3 => Just(""), 1 => Just("#"), 1 => Just("% ")];
    let flags = (any::<bool>(), any::<bool>(), any::<bool>());
    (separator, preamble, ends, mark, 0_u8..6, flags).prop_map(
        |(separator, preamble, line_end, comment_mark, encoding, (comma, quoted, last_cell))| {
            let is_blank = separator.starts_with(' ');
            let is_list = separator == ",";
            Dialect {
                separator,
                decimal_comma: comma && (!is_list || quoted),
                quoted: quoted && !is_blank,
                line_end,
                encoding,
                preamble,
                last_cell: last_cell && !is_blank,
                comment_mark,
            }
        },
    )
}

impl Dialect {
    fn write(&self, log: &Text) -> Vec<u8> {
        let mut text = String::new();
        for line in &self.preamble {
            write!(text, "{line}{}", self.line_end).unwrap();
        }
        let mut line = |mark: &str, cells: Vec<String>| {
            text.push_str(mark);
            text.push_str(&cells.join(self.separator));
            if self.last_cell {
                text.push_str(self.separator);
            }
            text.push_str(self.line_end);
        };
        let quoted = |cell: String| match self.quoted {
            true => format!("\"{cell}\""),
            false => cell,
        };
        let names = log.names.iter().map(|name| (*name).to_owned());
        match self.comment_mark {
            "" => line("", names.map(quoted).collect()),
            mark => line(mark, names.collect()),
        }
        for row in &log.rows {
            let cells = row.iter().map(|cell| match self.decimal_comma {
                true => cell.replace('.', ","),
                false => cell.clone(),
            });
            line("", cells.map(quoted).collect());
        }
        match self.encoding {
            0 => [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            1 => utf16(&format!("\u{feff}{text}"), u16::to_le_bytes),
            2 => utf16(&format!("\u{feff}{text}"), u16::to_be_bytes),
            3 => utf16(&text, u16::to_le_bytes),
            _ => text.into_bytes(),
        }
    }
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

fn read(path: &Path, size: usize) -> Result<Chunk, LogError> {
    let mut stream = LogStream::open_in_parts(path, &ReadOptions::default(), parts_of(size, 2))?;
    let mut whole = stream.empty_chunk();
    while let Some(chunk) = stream.next_chunk()? {
        whole.append(&chunk);
    }
    Ok(whole)
}

fn read_bytes(bytes: &[u8], size: usize) -> Result<Chunk, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    fs::write(&path, bytes).unwrap();
    read(&path, size).map_err(|error| error.to_string())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn a_log_is_the_same_in_every_dialect(
        log in any_log(),
        dialect in any_dialect(),
        size in 1_usize..500,
    ) {
        let plain = log.rows.iter().map(|row| row.join(",") + "\n").collect::<String>();
        let plain = format!("{}\n{plain}", log.names.join(","));
        let expected = read_bytes(plain.as_bytes(), 1 << 20).unwrap();
        prop_assert_eq!(expected.rows(), log.rows.len());
        let read = read_bytes(&dialect.write(&log), size);
        prop_assert_eq!(read, Ok(expected));
    }
}

fn refused(text: &str) -> String {
    let error = read_bytes(text.as_bytes(), 1 << 20).unwrap_err();
    error.rsplit_once("/log").unwrap().1.to_owned()
}

#[test]
fn two_readings_of_a_number_are_both_named() {
    let head = "time_s;temp_c;x_dps\n";
    for (rows, expected) in [
        (
            "0;20,5;1.5\n1;20,5;1.5\n",
            ":2: `20,5` has a decimal comma and `1.5` a decimal point",
        ),
        (
            "0;20;1,234\n1;20;2,345\n",
            ":2: `1,234` may have a decimal comma, or a comma between thousands",
        ),
        (
            "0,0;20,5;1,5\n1,0;20,5;1.234,5\n",
            ":3:3: column `x_dps`: `1.234,5`: expected a finite number",
        ),
        (
            "0,0;20,5;1,5\n1,0;20,5;1,234,5\n",
            ":3:3: column `x_dps`: `1,234,5`: expected a finite number",
        ),
    ] {
        let error = refused(&format!("{head}{rows}"));
        assert!(error.starts_with(expected), "{error}");
    }
    let error = refused("time_s,temp_c,x;y_dps;z_dps\n1,2,no;3;4\n");
    assert!(error.contains("between `,` as between `;`"), "{error}");
    // Which sign it is does not matter where numbers have none, or where a column is not read.
    assert!(read_bytes(b"time_s;temp_c;x_dps\n0;20;1\n1;20;2\n", 100).is_ok());
    let other = "time_s;temp_c;x_dps;version\n0,5;20;1;1.5\n1;20;2;1.5\n";
    assert_eq!(
        read_bytes(other.as_bytes(), 100).unwrap().time_s,
        [0.5, 1.0]
    );
}

/// Lines are numbered as in the file, whatever was passed over.
#[test]
fn lines_are_counted_from_the_start_of_the_file() {
    let text = "# a\n\n# b\ntime_s;temp_c;x_dps\n0,5;20;1\n1,5;20;no\n";
    assert!(refused(text).starts_with(":6:3: column `x_dps`: `no`"));
    let text = "# a\n# b\ntime_s  temp_c  x_dps\n0.5  20 1\n1.5  20  no\n";
    assert!(refused(text).starts_with(":5:3: column `x_dps`: `no`"));
    let text = "# a\ntime_ss;temp_c;x_dps\n0,5;20;1\n1,5;20;no\n";
    assert!(refused(text).starts_with(":2: "), "{}", refused(text));
}

/// Spreadsheets write names of two lines.
#[test]
fn names_in_quotes_may_have_several_lines() {
    let rows = "0,20,1\n1,20,2\n2,20,no\n";
    for (header, line) in [
        ("\"Time\n[s]\",\"Temp\n(\u{b0}C)\",\"Gyro X\n(deg/s)\"\n", 7),
        ("\"Time [s]\r\n\",\"Temp\r\n(degC)\",x_dps\r\n", 6),
        (
            "a \"loose\" mark, 5\" wide\n\"time_s\",\"temp_c\",\"x_dps\"\n",
            5,
        ),
        ("\"never closed\ntime_s,temp_c,x_dps\n", 5),
    ] {
        let error = refused(&format!("{header}{rows}"));
        assert!(error.starts_with(&format!(":{line}:3")), "{error}");
        assert!(error.contains("`no`"), "{error}");
    }
}

/// Garbage between header and numbers, and words for missing numbers, are bad rows.
#[test]
fn bad_first_rows_are_no_header() {
    for row in ["nan,nan,nan", "boot,ok,ready", ",,", "1,20"] {
        let error = refused(&format!("time_s,temp_c,x_dps\n{row}\n1,20,3\n2,20,4\n"));
        assert!(error.starts_with(":2"), "{row}: {error}");
    }
}

#[test]
fn what_was_found_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    let text = "Pr\u{fc}fling 7\nZeit\ntime_s;temp_c;x_dps\n0,5;20;1\n1,5;20;2\n";
    fs::write(&path, utf16(&format!("\u{feff}{text}"), u16::to_le_bytes)).unwrap();
    let stream = LogStream::open(&path, &ReadOptions::default()).unwrap();
    assert_eq!(
        stream.reading().notes,
        [
            "UTF-16",
            "cells separated by `;`",
            "decimal comma",
            "2 lines before the header passed over, from `Pr\u{fc}fling 7` on"
        ]
    );
    fs::write(&path, "time_s,temp_c,x_dps\n0.5,20,1\n1.5,20,2\n").unwrap();
    let stream = LogStream::open(&path, &ReadOptions::default()).unwrap();
    assert!(stream.reading().is_plain());
}
