//! Rows of Parquet files that are chosen, and clock times in them.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::tests::parts_of;
use super::{Chunk, LogStream, Mapping, ReadOptions};

/// Cells of a column of a table.
enum Cells {
    Whole(Vec<Option<i64>>),
    Text(Vec<Option<String>>),
    Real(Vec<f64>),
}

/// Writes columns as the schema declares them.
fn table(path: &Path, schema: &str, cells: &[Cells]) {
    let schema = Arc::new(parse_message_type(&format!("message log {{ {schema} }}")).unwrap());
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::default()).unwrap();
    let mut columns = writer.next_row_group().unwrap();
    for cells in cells {
        let mut column = columns.next_column().unwrap().unwrap();
        match (cells, column.untyped()) {
            (Cells::Whole(cells), ColumnWriter::Int64ColumnWriter(column)) => {
                let levels: Vec<i16> = cells.iter().map(|of| of.is_some().into()).collect();
                let values: Vec<i64> = cells.iter().copied().flatten().collect();
                column.write_batch(&values, Some(&levels), None).unwrap();
            }
            (Cells::Text(cells), ColumnWriter::ByteArrayColumnWriter(column)) => {
                let levels: Vec<i16> = cells.iter().map(|of| of.is_some().into()).collect();
                let values: Vec<ByteArray> =
                    cells.iter().flatten().map(|of| of[..].into()).collect();
                column.write_batch(&values, Some(&levels), None).unwrap();
            }
            (Cells::Real(cells), ColumnWriter::DoubleColumnWriter(column)) => {
                column.write_batch(cells, None, None).unwrap();
            }
            _ => unreachable!("the schema has no other columns"),
        }
        column.close().unwrap();
    }
    columns.close().unwrap();
    writer.close().unwrap();
}

fn read_table(path: &Path, mapping: Mapping, skip_bad_rows: bool) -> Result<Chunk, String> {
    let options = ReadOptions {
        mapping,
        skip_bad_rows,
        ..ReadOptions::default()
    };
    let mut stream =
        LogStream::open_in_parts(path, &options, parts_of(7, 2)).map_err(|e| e.to_string())?;
    let mut rows = stream.empty_chunk();
    while let Some(chunk) = stream.next_chunk().map_err(|e| e.to_string())? {
        rows.append(&chunk);
    }
    Ok(rows)
}

#[test]
fn rows_of_a_table_are_chosen_and_its_clock_is_read() {
    const SCHEMA: &str = "optional binary timestamp (STRING); optional int64 I; \
        optional binary name (STRING); required double temp_c; required double x_dph;";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t");
    let write = |bad: Option<usize>| {
        let stamp = |row: usize| match Some(row) == bad {
            true => "noon".to_owned(),
            false => format!("2023-03-04 09:00:{:02}.5", row / 3),
        };
        let rows = 0..90;
        let cells = [
            Cells::Text(rows.clone().map(|row| Some(stamp(row))).collect()),
            Cells::Whole(
                rows.clone()
                    .map(|row| [Some(0), Some(1), None][row % 3])
                    .collect(),
            ),
            Cells::Text(
                rows.clone()
                    .map(|row| [Some("a".to_owned()), Some(" b".to_owned()), None][row % 3].clone())
                    .collect(),
            ),
            Cells::Real(vec![20.0; 90]),
            Cells::Real(rows.map(|row| row as f64).collect()),
        ];
        table(&path, SCHEMA, &cells);
    };
    let choose = |filter: &str| Mapping {
        filter: vec![filter.to_owned()],
        ..Mapping::default()
    };
    write(None);
    for (filter, first) in [("I=0", 0), ("I=1.0", 1), ("name=a", 0), ("name=b", 1)] {
        let rows = read_table(&path, choose(filter), false).unwrap();
        let times: Vec<f64> = (0..30).map(f64::from).collect();
        let axis: Vec<f64> = (0..30).map(|i| f64::from(first + 3 * i)).collect();
        assert_eq!((rows.time_s, &rows.axes[0]), (times, &axis), "{filter}");
    }
    let clock = Mapping {
        time: Some("temp_c:iso".to_owned()),
        ..Mapping::default()
    };
    for (mapping, part) in [
        (
            choose("I=zero"),
            "column `I` holds numbers: expected one instead of `zero`",
        ),
        (choose("J=0"), "no column `J`"),
        (
            clock,
            "column `temp_c` holds no text: expected clock times by ISO 8601",
        ),
    ] {
        let error = read_table(&path, mapping, true).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
    // A row that is wanted must have a time; others need none.
    write(Some(33));
    let error = read_table(&path, choose("I=0"), false).unwrap_err();
    assert!(
        error.contains("row 34, column 1 `timestamp`: expected a time by ISO 8601"),
        "{error}"
    );
    assert_eq!(read_table(&path, choose("I=0"), true).unwrap().rows(), 29);
    assert_eq!(read_table(&path, choose("I=1"), false).unwrap().rows(), 30);
}

#[test]
fn a_table_of_a_known_logger_must_have_one_source() {
    const SCHEMA: &str = "optional int64 TimeUS; optional int64 I; required double GyrX; \
        required double GyrY; required double GyrZ; required double T;";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t");
    let real = || Cells::Real((0..90).map(f64::from).collect());
    let write = |source: fn(i64) -> i64| {
        let stamps = Cells::Whole((0..90).map(|row| Some(200_000 * row)).collect());
        let sources = Cells::Whole((0..90).map(|row| Some(source(row))).collect());
        table(
            &path,
            SCHEMA,
            &[stamps, sources, real(), real(), real(), real()],
        );
    };
    write(|_| 7);
    assert_eq!(
        read_table(&path, Mapping::default(), false).unwrap().rows(),
        90
    );
    write(|row| row % 2);
    let error = read_table(&path, Mapping::default(), true).unwrap_err();
    assert!(
        error.contains("`I` has several sources, `0` and `1`"),
        "{error}"
    );
    write(|row| row / 40);
    let error = read_table(&path, Mapping::default(), true).unwrap_err();
    assert!(
        error.contains("row 41: column `I` has several sources, `0` and `1`"),
        "{error}"
    );
}
