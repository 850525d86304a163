//! The same log from every format, however it is cut into parts.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::column::writer::ColumnWriter;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use proptest::prelude::*;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

use super::clock::TimeNotes;
use super::parallel::Parts;
use super::{Chunk, DoubtKind, LogError, LogStream, ReadOptions, read_log};

/// Reads a log in parts of `size` bytes, or rows of a table.
fn read_in_parts(path: &Path, size: usize, skip_bad_rows: bool) -> Result<Chunk, LogError> {
    let options = ReadOptions {
        skip_bad_rows,
        ..ReadOptions::default()
    };
    let read = |cores| {
        let mut stream = LogStream::open_in_parts(path, &options, parts_of(size, cores))?;
        let mut whole = stream.empty_chunk();
        while let Some(chunk) = stream.next_chunk()? {
            whole.append(&chunk);
        }
        assert_eq!(stream.sha256().unwrap().len(), 64);
        assert_eq!(stream.bytes(), Some(stream.bytes_read()));
        Ok(whole)
    };
    // With threads and without, it is the same log, or the same refusal.
    let [threaded, in_turn] = [3, 1].map(read);
    match (threaded, in_turn) {
        (Ok(threaded), Ok(in_turn)) => {
            assert!(bits(&threaded) == bits(&in_turn));
            Ok(threaded)
        }
        (threaded, in_turn) => {
            let text =
                |outcome: &Result<_, LogError>| outcome.as_ref().map_err(ToString::to_string).err();
            assert_eq!(text(&threaded), text(&in_turn));
            threaded
        }
    }
}

/// Parts of that many bytes or rows.
pub(crate) fn parts_of(size: usize, cores: usize) -> Parts {
    Parts {
        block_bytes: size,
        table_rows: size,
        cores,
    }
}

fn bits(chunk: &Chunk) -> Vec<u64> {
    let temps = chunk.temps_c.iter().flatten().map(|t| t.to_bits().into());
    let axes = chunk.axes.iter().flatten().map(|v| v.to_bits());
    let times = chunk.time_s.iter().map(|v| v.to_bits());
    times.chain(temps).chain(axes).collect()
}

/// A good log of two axes with values of many digits.
fn good_csv(rows: usize) -> String {
    let mut text = String::from("time_s,temp_c,x_dph,y_pulses\n");
    for row in 0..rows {
        let t = row as f64 * 0.1;
        let temp_c = 20.0 + 30.0 * (t * 0.01).sin();
        text.push_str(&format!(
            "{t},{temp_c:.4},{:e},{}\n",
            (t + 1.0).ln(),
            row % 5
        ));
    }
    text
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zstandard(bytes: &[u8]) -> Vec<u8> {
    compress_to_vec(bytes, CompressionLevel::Fastest)
}

/// Writes rows as Parquet in groups of `group` rows; a NaN of `x_dph` becomes a null.
fn parquet_of(path: &Path, rows: &Chunk, group: usize) {
    parquet_with(path, rows, group, WriterProperties::default());
}

fn parquet_with(path: &Path, rows: &Chunk, group: usize, properties: WriterProperties) {
    let schema = "message log { required double time_s; required double temp_c; \
                  optional double x_dph; required int32 y_pulses; }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties)).unwrap();
    for start in (0..rows.rows()).step_by(group) {
        let range = start..rows.rows().min(start + group);
        let mut columns = writer.next_row_group().unwrap();
        let mut position = 0;
        while let Some(mut column) = columns.next_column().unwrap() {
            match (column.untyped(), position) {
                (ColumnWriter::DoubleColumnWriter(column), 0) => {
                    let values = &rows.time_s[range.clone()];
                    column.write_batch(values, None, None).unwrap();
                }
                (ColumnWriter::DoubleColumnWriter(column), 1) => {
                    let values = rows.temps_c[0][range.clone()].iter();
                    let values: Vec<f64> = values.map(|&t| t.into()).collect();
                    column.write_batch(&values, None, None).unwrap();
                }
                (ColumnWriter::DoubleColumnWriter(column), _) => {
                    let values = &rows.axes[0][range.clone()];
                    let levels: Vec<i16> = values.iter().map(|v| (!v.is_nan()).into()).collect();
                    let values: Vec<f64> = values.iter().copied().filter(|v| !v.is_nan()).collect();
                    column.write_batch(&values, Some(&levels), None).unwrap();
                }
                (ColumnWriter::Int32ColumnWriter(column), _) => {
                    let values = rows.axes[1][range.clone()].iter();
                    let values: Vec<i32> = values.map(|&v| v as i32).collect();
                    column.write_batch(&values, None, None).unwrap();
                }
                _ => unreachable!("the schema has no other columns"),
            }
            column.close().unwrap();
            position += 1;
        }
        columns.close().unwrap();
    }
    writer.close().unwrap();
}

#[test]
fn packed_logs_and_tables_are_the_same_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let text = good_csv(5000);
    let half = text.len() / 2;
    let (front, back) = text.as_bytes().split_at(half);
    let plain = write(folder.path(), "log.csv", text.as_bytes());
    let expected = read_in_parts(&plain, 1 << 20, false).unwrap();
    assert_eq!(expected.rows(), 5000);
    // The names say nothing: the first bytes do.
    for (name, bytes) in [
        ("gz.csv", gzip(text.as_bytes())),
        ("members", [gzip(front), gzip(back)].concat()),
        ("zst.csv", zstandard(text.as_bytes())),
        ("frames", [zstandard(front), zstandard(back)].concat()),
    ] {
        let path = write(folder.path(), name, &bytes);
        for size in [1000, 1 << 20] {
            let read = read_in_parts(&path, size, false).unwrap();
            assert_eq!(bits(&read), bits(&expected), "{name}");
        }
    }
    let path = folder.path().join("parquet.csv");
    parquet_of(&path, &expected, 1300);
    for size in [7, 1000, 1 << 16] {
        let read = read_in_parts(&path, size, false).unwrap();
        assert_eq!(bits(&read), bits(&expected));
    }
    let log = read_log(&path, &ReadOptions::default()).unwrap();
    assert_eq!(log.time_s, expected.time_s);
    let digest = <sha2::Sha256 as sha2::Digest>::digest(fs::read(&path).unwrap());
    assert_eq!(log.sha256, super::hex(&digest));
}

/// Pages packed or not, with and without a dictionary, of both versions, with nulls. What else they may
/// be packed by is read by the tests of the Python module, which has the writer of most such files.
#[test]
fn pages_of_every_kind_are_the_same_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let csv = write(folder.path(), "log.csv", good_csv(5000).as_bytes());
    let mut rows = read_in_parts(&csv, 1 << 20, false).unwrap();
    rows.axes[0][700] = f64::NAN;
    let path = folder.path().join("table");
    let mut expected = None;
    for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY] {
        for version in [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0] {
            for has_dictionary in [false, true] {
                let properties = WriterProperties::builder()
                    .set_compression(compression)
                    .set_writer_version(version)
                    .set_dictionary_enabled(has_dictionary)
                    .set_data_page_size_limit(5000)
                    .build();
                parquet_with(&path, &rows, 3000, properties);
                let read = read_in_parts(&path, 1000, true).unwrap();
                assert_eq!(read.rows(), 4999);
                let expected = expected.get_or_insert_with(|| bits(&read));
                assert_eq!(bits(&read), *expected, "{compression} {version:?}");
            }
        }
    }
}

/// Memory is bounded by what a row and a part of a table may take, however small the file is.
#[test]
fn what_unpacks_without_end_is_refused_and_called_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let endless = [b"time_s,temp_c,x_dph\n0,20," as &[u8], &[b'1'; 17 << 20]].concat();
    for bytes in [gzip(&endless), zstandard(&endless), endless] {
        let path = write(folder.path(), "endless", &bytes);
        let error = read_log(&path, &ReadOptions::default()).unwrap_err();
        let error = error.to_string();
        let expected = "endless:2: no end within 16 MiB: expected rows of numbers";
        assert!(error.ends_with(expected), "{error}");
    }
    // A footer of 200 MiB.
    let path = write(folder.path(), "footer", b"PAR1");
    let file = File::options().append(true).open(&path).unwrap();
    file.set_len(300 << 20).unwrap();
    let tail = [&(200_u32 << 20).to_le_bytes()[..], b"PAR1"].concat();
    (&file).write_all(&tail).unwrap();
    let error = read_log(&path, &ReadOptions::default()).unwrap_err();
    let expected = "a Parquet page, or the footer, is larger than 128 MiB";
    assert!(error.to_string().contains(expected), "{error}");
}

/// A message is one that a person can read, whatever stands in the file.
#[test]
fn long_cells_names_and_headers_are_cut_in_messages() {
    let folder = tempfile::tempdir().unwrap();
    let long = "x".repeat(1 << 20);
    let many: Vec<String> = (0..70_000).map(|column| format!("c{column}")).collect();
    let many = many.join(",");
    for (text, expected) in [
        (
            format!("time_s,temp_c,x_dph\n0,20,{long}\n"),
            ":2:3: column `x_dph`: `xxx",
        ),
        (
            format!("time_s,temp_c,x_dph\n0,20,\"{long}\"\n"),
            ":2:3: column `x_dph`: `xxx",
        ),
        (
            format!("time_s,temp_c,{long}_dph\n0,20,\n"),
            ":2:3: column `xxx",
        ),
        (format!("{long},{long}\n"), ":1: two columns are named `xxx"),
        (
            format!("time_{long}\n"),
            ":1: one column: columns must be separated by",
        ),
        (
            format!("time_{long},a\n"),
            "xxx...` is not in seconds by its name",
        ),
        (
            format!("time_s,temp_{long}\n"),
            "xxx...` is not in degC by its name",
        ),
        (format!("time_s,temp_c,x_{long}\n"), ":1: column `x_xxx"),
        (
            format!("time_s,temp_a_c,temp_b_c,{long}_dph\n"),
            "belongs to axis `xxx",
        ),
        (format!("{many}\n"), "`c18`, `c19` and 65516 more"),
        (format!("{many},c5\n"), "`c18`, `c19` and 65516 more"),
        (format!("c5,{many}\n"), ":1: two columns are named `c5`"),
    ] {
        let path = write(folder.path(), "long", text.as_bytes());
        let error = read_log(&path, &ReadOptions::default()).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains(expected),
            "{}",
            &error[..error.len().min(1000)]
        );
        assert!(error.len() < 1000, "{}", error.len());
    }
}

#[test]
fn what_is_cut_off_or_spoilt_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = good_csv(5000);
    let table = folder.path().join("table");
    parquet_of(
        &table,
        &read_in_parts(
            &write(folder.path(), "csv", text.as_bytes()),
            1 << 20,
            false,
        )
        .unwrap(),
        5000,
    );
    for (whole, expected) in [
        (
            gzip(text.as_bytes()),
            "the gzip data ends too early: was the file cut off?",
        ),
        (
            zstandard(text.as_bytes()),
            "the zstd data ends too early: was the file cut off?",
        ),
        (
            fs::read(&table).unwrap(),
            "not a sound Parquet file (was it cut off?)",
        ),
    ] {
        for length in [4, 5, 11, whole.len() / 2, whole.len() - 1] {
            let path = write(folder.path(), "cut", &whole[..length]);
            let error = read_log(&path, &ReadOptions::default()).unwrap_err();
            assert!(error.to_string().contains(expected), "{length}: {error}");
        }
    }
    for (mut whole, expected) in [
        (gzip(text.as_bytes()), "not sound gzip data"),
        (zstandard(text.as_bytes()), "not sound zstd data"),
    ] {
        let middle = whole.len() / 2;
        whole[middle..middle + 40].fill(0xa5);
        let path = write(folder.path(), "spoilt", &whole);
        let error = read_log(&path, &ReadOptions::default())
            .unwrap_err()
            .to_string();
        // Spoilt data may unpack to spoilt text before the packing is found wrong.
        assert!(
            error.contains(expected) || error.contains("spoilt:"),
            "{error}"
        );
    }
    let path = write(folder.path(), "bytes", b"\x01\xfe,\x02\n1,2\n");
    let error = read_log(&path, &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains(":1: the header is no text"), "{error}");
}

#[test]
fn what_is_wrong_with_a_row_comes_before_a_failure_to_read_on() {
    let folder = tempfile::tempdir().unwrap();
    let text = good_csv(3000);
    let mut lines: Vec<&str> = text.lines().collect();
    // In the last part that is whole, which waits for the next one.
    lines[2690] = "5,20,1,1";
    let packed = gzip(lines.join("\n").as_bytes());
    let path = write(folder.path(), "log.csv.gz", &packed[..packed.len() - 1]);
    let error = read_in_parts(&path, 1 << 14, false)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains(":2691:1: column `time_s`: 5 s after"),
        "{error}"
    );
}

#[test]
fn bad_values_of_a_table_are_named_by_row_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let csv = write(folder.path(), "csv", good_csv(100).as_bytes());
    let good = read_in_parts(&csv, 1 << 20, false).unwrap();
    let path = folder.path().join("t");
    let refused = |spoil: fn(&mut Chunk)| {
        let mut rows = good.clone();
        spoil(&mut rows);
        parquet_of(&path, &rows, 30);
        let kept = read_in_parts(&path, 7, true).unwrap().rows();
        let error = read_in_parts(&path, 7, false).unwrap_err().to_string();
        (error.rsplit_once("/t: ").unwrap().1.to_owned(), kept)
    };
    for (spoil, error) in [
        (
            (|rows| rows.axes[0][40] = f64::NAN) as fn(&mut Chunk),
            "row 41, column 3 `x_dph`: null: expected a finite number",
        ),
        (
            |rows| rows.axes[0][40] = f64::INFINITY,
            "row 41, column 3 `x_dph`: `inf`: expected a finite number",
        ),
        (
            |rows| rows.temps_c[0][99] = 300.0,
            "row 100, column 2 `temp_c`: 300: expected -100 to 200 degC (is it in kelvin?)",
        ),
        (
            |rows| rows.time_s[35] = rows.time_s[34],
            "row 36, column 1 `time_s`: 3.4000000000000004 s after 3.4000000000000004 s: expected \
             time to increase",
        ),
    ] {
        assert_eq!(refused(spoil), (error.to_owned(), 99));
    }
}

#[test]
fn quoted_cells_and_any_line_end_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        "\"time_s\",\"temp_c\",note,x_dph\n0,20,plain,1\n\"1\",20,\"a, b\nc\",2\n\n2,20,,x\n";
    let path = write(folder.path(), "q", text.as_bytes());
    let error = read_in_parts(&path, 1 << 20, false)
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("/q:6:4: column `x_dph`: `x`: expected a finite number"),
        "{error}"
    );
    assert_eq!(read_in_parts(&path, 5, true).unwrap().time_s, [0.0, 1.0]);
    for end in ["\n", "\r\n", "\r"] {
        let text = ["time_s,temp_c,x_dph", "0,20,1", "", "1,20,2", "2,20,no"].join(end);
        let path = write(folder.path(), "e", text.as_bytes());
        for size in [1, 9, 1 << 20] {
            let error = read_in_parts(&path, size, false).unwrap_err().to_string();
            assert!(error.contains("/e:5:3:"), "{end:?} {size}: {error}");
        }
    }
}

/// Cells of every kind, in rows of every kind, most of them good.
fn any_row() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        8 => "-?[0-9]{1,3}\\.[0-9]{0,6}",
        2 => " [0-9]{1,20}e-[0-9]{1,2} ",
        1 => "\"[0-9]\"",
        1 => "(nan|1e40|x|)",
    ];
    prop_oneof![
        20 => (0.5..1.5, number).prop_map(|(step, value)| format!("{step},20.5,{value},any")),
        1 => Just(String::new()),
        1 => Just("1,2".to_owned()),
        1 => Just("0,20.5,1,\"a \"\"b\"\"\n, c\"".to_owned()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn a_log_is_the_same_in_parts_of_any_size(
        // Less than a minute: no time that goes back is a restart.
        rows in proptest::collection::vec(any_row(), 1..40),
        end in prop_oneof![4 => Just("\n"), 2 => Just("\r\n"), 1 => Just("\r")],
        last_end: bool,
        size in 1_usize..300,
    ) {
        // Steps become times.
        let mut time_s = 0.0;
        let rows = rows.iter().map(|row| match row.split_once(',') {
            Some((step, rest)) if rest.ends_with("any") => {
                time_s += step.parse::<f64>().unwrap();
                format!("{time_s},{rest}")
            }
            _ => row.clone(),
        });
        let header = "time_s,temp_c,x_dph,note".to_owned();
        let mut text = std::iter::once(header).chain(rows).collect::<Vec<_>>().join(end);
        if last_end {
            text.push_str(end);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), "log.csv", text.as_bytes());
        let outcome = |size, skip| match read_in_parts(&path, size, skip) {
            Ok(chunk) => Ok(bits(&chunk)),
            Err(error) => Err(error.to_string()),
        };
        prop_assert_eq!(outcome(size, false), outcome(1 << 20, false));
        prop_assert_eq!(outcome(size, true), outcome(1 << 20, true));

        // The numbers are those of a plain reader with the parser of the standard library.
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
        let mut expected = Vec::new();
        for record in reader.records().map(Result::unwrap) {
            let number = |cell: usize| {
                let value: f64 = record.get(cell)?.trim().parse().ok()?;
                (value.abs() <= 1e20).then_some(value)
            };
            if record.len() == 4
                && let (Some(time_s), Some(value)) = (number(0), number(2))
                && expected.last().is_none_or(|&(before, _)| time_s > before)
            {
                expected.push((time_s, value));
            }
        }
        let read = read_in_parts(&path, size, true).unwrap();
        let read: Vec<_> = read.time_s.into_iter().zip(read.axes[0].iter().copied()).collect();
        prop_assert_eq!(read, expected);
    }
}

/// A log with such stamps, and the whole of it as read in parts of some size.
fn read_stamps(stamps: &[f64], size: usize, skip: bool) -> Result<(Chunk, TimeNotes), LogError> {
    let rows = stamps.iter().enumerate();
    let rows = rows.map(|(row, stamp)| format!("{stamp},20.5,{row}\n"));
    let text = std::iter::once("time_s,temp_c,x_dph\n".to_owned()).chain(rows);
    let folder = tempfile::tempdir().unwrap();
    let path = write(
        folder.path(),
        "log.csv",
        text.collect::<String>().as_bytes(),
    );
    let options = ReadOptions {
        skip_bad_rows: skip,
        ..ReadOptions::default()
    };
    let mut stream = LogStream::open_in_parts(&path, &options, parts_of(size, 2))?;
    let mut whole = stream.empty_chunk();
    while let Some(chunk) = stream.next_chunk()? {
        whole.append(&chunk);
    }
    Ok((whole, stream.time_notes()))
}

#[test]
fn stamps_of_every_logger_become_times_in_parts_of_any_size() {
    let even: Vec<f64> = (0..2000).map(|i| 0.25 * f64::from(i)).collect();
    let wrapped: Vec<f64> = even.iter().map(|t| (t + 4200.0) % 4_294.967_296).collect();
    let restarted: Vec<f64> = even[..1000].iter().chain(&even[..1000]).copied().collect();
    let bursts: Vec<f64> = even.iter().map(|t| (t / 2.5).floor() * 2.5).collect();
    let long_bursts: Vec<f64> = bursts.iter().map(|t| 5.0 * t).collect();
    let kinds = |notes: &TimeNotes| -> Vec<DoubtKind> {
        notes.doubts().iter().map(|doubt| doubt.kind).collect()
    };
    for size in [50, 1000, 1 << 20] {
        let (rows, notes) = read_stamps(&wrapped, size, false).unwrap();
        assert_eq!((rows.rows(), notes.wraps), (2000, 1));
        assert_eq!(kinds(&notes), []);
        assert!((rows.time_s[1999] - rows.time_s[0] - 499.75).abs() < 1e-6);

        let (rows, notes) = read_stamps(&restarted, size, false).unwrap();
        assert_eq!((rows.rows(), &notes.restarts_s[..]), (2000, &[3849.75][..]));
        assert_eq!(kinds(&notes), [DoubtKind::TimeRestarts]);
        assert_eq!(rows.time_s[1999], 3849.75 + 249.75);

        let (rows, notes) = read_stamps(&bursts, size, false).unwrap();
        assert_eq!((rows.rows(), notes.rows_per_burst), (2000, 10));
        assert_eq!(kinds(&notes), []);
        let (_, notes) = read_stamps(&long_bursts, size, false).unwrap();
        assert_eq!(kinds(&notes), [DoubtKind::LongBursts]);
        let steps = rows.time_s.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.into_iter().all(|step| (step - 0.25).abs() < 1e-9));

        let mut ahead = even.clone();
        ahead[700] = 93_877.3;
        let error = read_stamps(&ahead, size, false).unwrap_err().to_string();
        let place =
            "log.csv:702:1: column `time_s`: 93877.3 s between rows of 174.75 s and 175.25 s";
        assert!(error.contains(place), "{error}");
        let (rows, _) = read_stamps(&ahead, size, true).unwrap();
        assert_eq!((rows.rows(), rows.axes[0][700]), (1999, 701.0));
    }
}

/// What pyarrow writes as `ARROW:schema` for a column `time` of durations, `temp_c` and `x_dph`,
/// with the units in a second.
const ARROW_DURATIONS: [(&str, i64); 4] = [
    (
        "/////9gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAAB0AAAANAAAAAQAAACo////AAABAxAAAAAYAAAABAAAAAAAAAAFAAAAeF9kcGgAAACa////AAACANT///8AAAEDEAAAABgAAAAEAAAAAAAAAAYAAAB0ZW1wX2MAAMb///8AAAIAEAAUAAgABgAHAAwAAAAQABAAAAAAAAESEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAAAAAAAAAA=",
        1,
    ),
    (
        "/////9gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAAB8AAAANAAAAAQAAACg////AAABAxAAAAAYAAAABAAAAAAAAAAFAAAAeF9kcGgAAADS////AAACAMz///8AAAEDEAAAACAAAAAEAAAAAAAAAAYAAAB0ZW1wX2MAAAAABgAIAAYABgAAAAAAAgAQABQACAAGAAcADAAAABAAEAAAAAAAARIQAAAAHAAAAAQAAAAAAAAABAAAAHRpbWUAAAAABAAEAAQAAAA=",
        1_000,
    ),
    (
        "/////9gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAAB0AAAANAAAAAQAAACo////AAABAxAAAAAYAAAABAAAAAAAAAAFAAAAeF9kcGgAAACa////AAACANT///8AAAEDEAAAABgAAAAEAAAAAAAAAAYAAAB0ZW1wX2MAAMb///8AAAIAEAAUAAgABgAHAAwAAAAQABAAAAAAAAESEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAACAAAAAAA=",
        1_000_000,
    ),
    (
        "/////9gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAAB0AAAANAAAAAQAAACo////AAABAxAAAAAYAAAABAAAAAAAAAAFAAAAeF9kcGgAAACa////AAACANT///8AAAEDEAAAABgAAAAEAAAAAAAAAAYAAAB0ZW1wX2MAAMb///8AAAIAEAAUAAgABgAHAAwAAAAQABAAAAAAAAESEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAADAAAAAAA=",
        1_000_000_000,
    ),
];

/// Writes a time column of 64-bit integers by its declaration, with a temperature and an axis.
fn timed_parquet(path: &Path, time: &str, times: &[i64], arrow_schema: Option<&str>) {
    let schema =
        format!("message log {{ {time}; required double temp_c; required double x_dph; }}");
    let schema = Arc::new(parse_message_type(&schema).unwrap());
    let pair = |value: &str| KeyValue::new("ARROW:schema".to_owned(), value.to_owned());
    let properties = WriterProperties::builder()
        .set_key_value_metadata(arrow_schema.map(|schema| vec![pair(schema)]));
    let file = File::create(path).unwrap();
    let properties = Arc::new(properties.build());
    let mut writer = SerializedFileWriter::new(file, schema, properties).unwrap();
    // Two groups: the first row of the file is the origin of both.
    for times in times.chunks(times.len() / 2) {
        let mut columns = writer.next_row_group().unwrap();
        while let Some(mut column) = columns.next_column().unwrap() {
            match column.untyped() {
                ColumnWriter::Int64ColumnWriter(column) => {
                    column.write_batch(times, None, None).unwrap();
                }
                ColumnWriter::DoubleColumnWriter(column) => {
                    column
                        .write_batch(&vec![20.0; times.len()], None, None)
                        .unwrap();
                }
                _ => unreachable!("the schema has no other columns"),
            }
            column.close().unwrap();
        }
        columns.close().unwrap();
    }
    writer.close().unwrap();
}

#[test]
fn times_of_a_table_are_seconds_by_their_type() {
    const SECONDS: [(&str, i64); 3] = [
        ("required int64 stamp (TIMESTAMP(MILLIS,true))", 1_000),
        ("required int64 stamp (TIMESTAMP(MICROS,false))", 1_000_000),
        (
            "required int64 stamp (TIMESTAMP(NANOS,true))",
            1_000_000_000,
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t");
    let origin_s = 1_709_542_800;
    for (time, per_second) in SECONDS {
        let times: Vec<i64> = (0..40)
            .map(|i| origin_s * per_second + i * per_second / 4)
            .collect();
        timed_parquet(&path, time, &times, None);
        let rows = read_in_parts(&path, 7, false).unwrap();
        let expected: Vec<f64> = (0..40).map(|i| 0.25 * f64::from(i)).collect();
        assert_eq!(rows.time_s, expected, "{time}");
    }
    // A duration and a time of day count from 0.
    let day = "required int64 clock (TIME(MICROS,true))";
    timed_parquet(
        &path,
        day,
        &[5_000_000, 5_500_000, 6_000_000, 6_500_000],
        None,
    );
    assert_eq!(
        read_in_parts(&path, 7, false).unwrap().time_s,
        [5.0, 5.5, 6.0, 6.5]
    );
    for (schema, per_second) in ARROW_DURATIONS {
        let times: Vec<i64> = (0..4).map(|i| i * per_second).collect();
        timed_parquet(&path, "required int64 time", &times, Some(schema));
        let rows = read_in_parts(&path, 7, false).unwrap();
        assert_eq!(rows.time_s, [0.0, 1.0, 2.0, 3.0], "{per_second}");
    }
    // Without a type, a name must say the unit. A schema that is cut or spoilt says nothing.
    for cut in [0, 1, 20, 100, 200] {
        let (schema, _) = ARROW_DURATIONS[1];
        timed_parquet(
            &path,
            "required int64 time",
            &[0, 1, 2, 3],
            Some(&schema[..4 * (cut / 4)]),
        );
        let error = read_in_parts(&path, 7, false).unwrap_err().to_string();
        assert!(error.contains("`time` has no unit"), "{error}");
    }
    let (schema, _) = ARROW_DURATIONS[1];
    for at in 0..schema.len() {
        let mut spoilt = schema.as_bytes().to_vec();
        spoilt[at] = if spoilt[at] == b'/' { b'A' } else { b'/' };
        let spoilt = String::from_utf8(spoilt).unwrap();
        timed_parquet(
            &path,
            "required int64 time",
            &[0, 1000, 2000, 3000],
            Some(&spoilt),
        );
        let _ = read_in_parts(&path, 7, false);
    }
    // Two columns of times: neither is chosen.
    let two =
        "required int64 a (TIMESTAMP(MILLIS,true)); required int64 b (TIMESTAMP(MILLIS,true))";
    timed_parquet(&path, two, &[0, 1, 2, 3], None);
    let error = read_in_parts(&path, 7, false).unwrap_err().to_string();
    assert!(error.contains("no time column"), "{error}");
}

#[test]
fn a_row_that_was_written_twice_counts_once() {
    let text = "time_s,temp_c,x_dph\n0,20,1\n1,20,2\n1,20,2\n2,20,3\n2,20,4\n";
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "log.csv", text.as_bytes());
    for size in [8, 1 << 20] {
        let error = read_in_parts(&path, size, false).unwrap_err().to_string();
        assert!(
            error.contains(":6:1: column `time_s`: 2 s after 2 s"),
            "{error}"
        );
        assert_eq!(
            read_in_parts(&path, size, true).unwrap().axes[0],
            [1.0, 2.0, 3.0]
        );
    }
}
