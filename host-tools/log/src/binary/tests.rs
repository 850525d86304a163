//! Small binary logs, made here by their public formats, whole and damaged.

use std::fs;

use proptest::prelude::*;

use super::super::{Log, LogError, Mapping, ReadOptions, SkippedRows, read_log};

/// A row of a gyro: its source, time \[us\], axes \[rad/s\] and temperature \[degC\].
type Row = (u8, u64, [f32; 3], f32);

/// Rows of some sources in turn, four a second.
fn rows(count: usize, sources: u8) -> Vec<Row> {
    let of = |number: usize, source: u8| {
        let (at, of_source) = (number as f32, f32::from(source));
        let axes = [0.25, -0.5, 1.0].map(|scale| scale * at + of_source);
        (
            source,
            1_000_000 + 250_000 * number as u64,
            axes,
            20.0 + at / 8.0,
        )
    };
    let numbers = 0..count;
    numbers
        .flat_map(|number| (0..sources).map(move |source| of(number, source)))
        .collect()
}

/// A file of PX4.
fn ulog(rows: &[Row]) -> Vec<u8> {
    let mut file = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    let mut record = |kind: u8, content: &[u8]| {
        file.extend((content.len() as u16).to_le_bytes());
        file.push(kind);
        file.extend(content);
    };
    record(b'B', &[0; 40]);
    record(b'F', b"sensor_gyro:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;float temperature;uint32_t error_count;uint8_t[3] clip_counter;uint8_t samples;uint8_t[4] _padding0;");
    record(b'F', b"cpuload:uint64_t timestamp;vector[2] load;");
    record(b'F', b"vector:float[2] part;");
    record(b'I', b"\x10char[4] sys_namePX4_");
    record(b'P', b"\x0dfloat SYS_MCU\0\0\0\0");
    record(b'A', b"\0\x00\0cpuload");
    for source in 0..4 {
        record(
            b'A',
            &[&[source, 1 + source, 0], &b"sensor_gyro"[..]].concat(),
        );
    }
    for (number, &(source, us, axes, temp_c)) in rows.iter().enumerate() {
        let mut row = vec![1 + source, 0];
        row.extend(us.to_le_bytes());
        row.extend((us - 300).to_le_bytes());
        row.extend(2_818_058_u32.to_le_bytes());
        row.extend(axes.map(f32::to_le_bytes).as_flattened());
        row.extend(temp_c.to_le_bytes());
        row.extend([0; 8]);
        record(b'D', &row);
        if number % 3 == 0 {
            record(b'D', &[&[0, 0][..], &us.to_le_bytes(), &[7; 16]].concat());
            record(b'L', &[&b"6"[..], &us.to_le_bytes(), b"hello"].concat());
            record(b'S', b"\x2f\x73\x13\x20\x25\x0c\xbb\x12");
        }
    }
    file
}

/// A message FMT of ArduPilot.
fn fmt(kind: u8, name: &str, types: &str, labels: &str) -> Vec<u8> {
    let size = |letter| match letter {
        'B' => 1,
        'Q' => 8,
        'N' => 16,
        'Z' => 64,
        _ => 4,
    };
    let size: u8 = types.chars().map(size).sum::<u8>() + 3;
    let mut message = vec![0xa3, 0x95, 0x80, kind, size];
    for (text, length) in [(name, 4), (types, 16), (labels, 64)] {
        message.extend(text.as_bytes());
        message.resize(message.len() + length - text.len(), 0);
    }
    message
}

fn parameter(name: &str, value: f32) -> Vec<u8> {
    let mut message = vec![0xa3, 0x95, 2];
    message.extend(7_u64.to_le_bytes());
    message.extend(name.as_bytes());
    message.resize(11 + 16, 0);
    message.extend(value.to_le_bytes());
    message
}

/// A file of ArduPilot, with parameters.
fn dataflash(rows: &[Row], parameters: &[(&str, f32)]) -> Vec<u8> {
    let mut file = fmt(0x80, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
    file[4] = 89;
    file.extend(fmt(2, "PARM", "QNf", "TimeUS,Name,Value"));
    file.extend(fmt(
        3,
        "IMU",
        "QBfffffffff",
        "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T",
    ));
    file.extend(fmt(4, "ATT", "Qf", "TimeUS,Roll"));
    file.extend(
        parameters
            .iter()
            .flat_map(|(name, value)| parameter(name, *value)),
    );
    for (number, &(source, us, axes, temp_c)) in rows.iter().enumerate() {
        file.extend([0xa3, 0x95, 3]);
        file.extend(us.to_le_bytes());
        file.push(source);
        let [x, y, z] = axes;
        let values = [x, y, z, 0.0, 0.0, -9.8, 0.0, 0.0, temp_c];
        file.extend(values.map(f32::to_le_bytes).as_flattened());
        if number % 3 == 0 {
            file.extend([&[0xa3, 0x95, 4][..], &us.to_le_bytes(), &[9; 4]].concat());
        }
    }
    file
}

fn read(name: &str, file: &[u8], options: &ReadOptions) -> Result<Log, LogError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, file).unwrap();
    read_log(&path, options)
}

fn refused(name: &str, file: &[u8], options: &ReadOptions) -> String {
    let error = read(name, file, options).unwrap_err().to_string();
    error.rsplit_once(name).unwrap().1.to_owned()
}

fn of_instance(instance: u32) -> ReadOptions {
    ReadOptions {
        mapping: Mapping {
            instance: Some(instance),
            ..Mapping::default()
        },
        ..ReadOptions::default()
    }
}

fn skipping() -> ReadOptions {
    ReadOptions {
        skip_bad_rows: true,
        ..ReadOptions::default()
    }
}

/// The values of each row that was read: time \[s\], temperature and axes.
fn values(log: &Log) -> Vec<[f64; 5]> {
    let channel = &log.channels[0];
    let axis = |axis: usize, row: usize| channel.axes[axis].raw[row];
    let rows = (0..log.rows()).map(|row| {
        let temp_c = channel.temp_c[row].into();
        [
            log.time_s[row],
            temp_c,
            axis(0, row),
            axis(1, row),
            axis(2, row),
        ]
    });
    rows.collect()
}

/// What the rows of a source should be read as.
fn expected(rows: &[Row], source: u8) -> Vec<[f64; 5]> {
    let rows = rows.iter().filter(|row| row.0 == source);
    rows.map(|&(_, us, [x, y, z], temp_c)| {
        [us as f64 / 1e6, temp_c.into(), x.into(), y.into(), z.into()]
    })
    .collect()
}

/// Both formats of some rows.
fn files(rows: &[Row]) -> [(&'static str, Vec<u8>); 2] {
    [("log.ulg", ulog(rows)), ("log.bin", dataflash(rows, &[]))]
}

#[test]
fn rows_are_read_without_an_option() {
    let rows = rows(40, 1);
    for ((name, file), layout) in files(&rows)
        .iter()
        .zip(["PX4 sensor_gyro", "ArduPilot IMU"])
    {
        let log = read(name, file, &ReadOptions::default()).unwrap();
        assert_eq!(values(&log), expected(&rows, 0));
        assert_eq!(log.reading.layout.as_deref(), Some(layout));
        assert_eq!(log.reading.mapping.unwrap().instance, None);
        assert_eq!(!log.reading.doubts.is_empty(), *name == "log.bin");
        assert_eq!(log.skipped_rows, SkippedRows::default());
        assert_eq!(log.sha256.len(), 64);
    }
}

#[test]
fn of_several_instances_one_is_chosen() {
    let rows = rows(40, 3);
    for (name, file) in &files(&rows) {
        let error = read(name, file, &ReadOptions::default()).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("instances 0, 1, 2 of the sensor are in it: choose one by --instance 0"),
            "{text}"
        );
        assert!(matches!(error, LogError::Sources { instances, .. } if instances == [0, 1, 2]));
        for source in 0..3 {
            let log = read(name, file, &of_instance(source.into())).unwrap();
            assert_eq!(values(&log), expected(&rows, source));
            let mapping = log.reading.mapping.unwrap();
            assert_eq!(mapping.instance, Some(source.into()));
            // What is kept with a set chooses it again.
            let kept = ReadOptions {
                kept: vec![mapping],
                ..ReadOptions::default()
            };
            assert_eq!(
                values(&read(name, file, &kept).unwrap()),
                expected(&rows, source)
            );
        }
        let error = refused(name, file, &of_instance(7));
        assert_eq!(error, ": no instance 7; there are 0, 1, 2");
    }
    // The number stands in a column, so that it may be chosen as in a text.
    let by_column = ReadOptions {
        mapping: Mapping {
            filter: vec!["I=2".to_owned()],
            ..Mapping::default()
        },
        ..ReadOptions::default()
    };
    let log = read("log.bin", &dataflash(&rows, &[]), &by_column).unwrap();
    assert_eq!(values(&log), expected(&rows, 2));
}

/// The crates for these formats read the files of these tests as we do.
#[test]
fn others_read_the_same_numbers() {
    let rows = rows(40, 2);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.ulg");
    fs::write(&path, ulog(&rows)).unwrap();
    let parsed = px4_ulog::full_parser::read_file(path.to_str().unwrap()).unwrap();
    let mut found = 0;
    for (source, columns) in &parsed.messages["sensor_gyro"] {
        let truth = expected(&rows, source.value());
        for (name, place) in [("temperature", 1), ("x", 2), ("y", 3), ("z", 4)] {
            let px4_ulog::full_parser::SomeVec::Float(column) = &columns[name] else {
                panic!("{name} is no float")
            };
            let truth: Vec<f64> = truth.iter().map(|row| row[place]).collect();
            let column: Vec<f64> = column.iter().map(|&value| value.into()).collect();
            assert_eq!(column, truth);
            found += 1;
        }
    }
    assert_eq!(found, 8);
    let file = dataflash(&rows, &[]);
    let entries = ardupilot_binlog::Reader::new(&file[..]).map(Result::unwrap);
    let entries: Vec<_> = entries.filter(|entry| entry.name == "IMU").collect();
    for source in 0..2 {
        let of = entries
            .iter()
            .filter(|entry| entry.get_i64("I") == Some(source.into()));
        let names = ["T", "GyrX", "GyrY", "GyrZ"];
        let read = of.map(|entry| {
            let [temp_c, x, y, z] = names.map(|name| entry.get_f64(name).unwrap());
            [entry.timestamp_usec.unwrap() as f64 / 1e6, temp_c, x, y, z]
        });
        assert_eq!(read.collect::<Vec<_>>(), expected(&rows, source));
    }
}

#[test]
fn older_imus_are_messages_of_their_own() {
    let rows = rows(20, 2);
    let mut file = fmt(0x80, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
    file[4] = 89;
    let labels = "TimeUS,GyrX,GyrY,GyrZ,Temp";
    file.extend(fmt(3, "IMU", "Qffff", labels));
    file.extend(fmt(4, "IMU2", "Qffff", labels));
    for &(source, us, [x, y, z], temp_c) in &rows {
        file.extend([0xa3, 0x95, 3 + source]);
        file.extend(us.to_le_bytes());
        file.extend([x, y, z, temp_c].map(f32::to_le_bytes).as_flattened());
    }
    for source in 0..2 {
        let log = read("log.bin", &file, &of_instance(source.into())).unwrap();
        assert_eq!(values(&log), expected(&rows, source));
    }
}

#[test]
fn rows_that_the_autopilot_corrected_are_refused() {
    let rows = rows(20, 2);
    let parameters = [
        ("INS_TCAL1_ENABLE", 0.0),
        ("INS_TCAL2_ENABLE", 1.0),
        ("INS_GYROFFS_X", 0.02),
    ];
    let file = dataflash(&rows, &parameters);
    let log = read("log.bin", &file, &of_instance(0)).unwrap();
    assert_eq!(log.reading.doubts, []);
    let error = refused("log.bin", &file, &of_instance(1));
    assert!(
        error.starts_with(": INS_TCAL2_ENABLE is 1: the autopilot corrected"),
        "{error}"
    );
    // A log that learns is not corrected; one that was corrected for a while is.
    let learning = dataflash(&rows, &[("INS_TCAL2_ENABLE", 2.0)]);
    assert!(read("log.bin", &learning, &of_instance(1)).is_ok());
    let late = dataflash(
        &rows,
        &[("INS_TCAL2_ENABLE", 1.0), ("INS_TCAL2_ENABLE", 0.0)],
    );
    assert!(read("log.bin", &late, &of_instance(1)).is_err());
}

#[test]
fn a_chip_without_a_thermometer_is_named() {
    let mut rows = rows(20, 1);
    // One reading that is missing is held.
    rows[7].3 = f32::NAN;
    for (name, file) in &files(&rows) {
        let log = read(name, file, &ReadOptions::default()).unwrap();
        assert_eq!(log.channels[0].temp_c[7], rows[6].3);
    }
    rows.iter_mut().for_each(|row| row.3 = f32::NAN);
    for (name, file) in &files(&rows) {
        let error = refused(name, file, &ReadOptions::default());
        assert!(
            error.contains("the chip has no thermometer. Expected temperatures by --join"),
            "{error}"
        );
    }
}

#[test]
fn values_that_no_gyro_has_are_refused() {
    let mut rows = rows(20, 1);
    rows[3].2[1] = 101.0;
    for ((name, file), column) in files(&rows).iter().zip(["column 5 `y`", "column 4 `GyrY`"]) {
        let error = refused(name, file, &ReadOptions::default());
        assert_eq!(
            error,
            format!(": row 4, {column}: 101: expected 100 rad/s at most (is the file damaged?)")
        );
        let log = read(name, file, &skipping()).unwrap();
        assert_eq!((log.rows(), log.skipped_rows.out_of_range), (19, 1));
    }
}

#[test]
fn a_log_without_gyros_names_its_topics() {
    let error = refused("log.ulg", &ulog(&[]), &ReadOptions::default());
    assert_eq!(
        error,
        ": no rows of `sensor_gyro`: expected a log with them; it has no other rows"
    );
    let mut file = ulog(&rows(1, 1));
    let at = file
        .windows(13)
        .position(|bytes| bytes == b"\0\x01\0sensor_gyro"[..13].as_ref())
        .unwrap();
    file[at] = 9;
    assert!(read("log.ulg", &file, &of_instance(0)).is_err());
}

#[test]
fn records_appended_in_a_crash_are_read() {
    let rows = rows(12, 1);
    let mut file = ulog(&rows);
    // The last row stands behind a cut record.
    let record = 3 + 46;
    let at = file.len() - record;
    let (cut, last) = (file[at..at + 20].to_vec(), file.split_off(at));
    file.extend(cut);
    let begin = file.len() as u64;
    file.extend(last);
    file[16 + 3 + 8] = 1;
    file[16 + 3 + 16..][..8].copy_from_slice(&begin.to_le_bytes());
    let log = read("log.ulg", &file, &ReadOptions::default()).unwrap();
    assert_eq!(values(&log), expected(&rows, 0));
}

/// However a file is cut, it is refused with the place, or is a shorter whole one; what is read of
/// it is the beginning of it.
#[test]
fn a_cut_file_is_refused_or_shorter() {
    let rows = rows(12, 1);
    for (name, file) in &files(&rows) {
        let truth = expected(&rows, 0);
        for end in 4..file.len() {
            let cut = &file[..end];
            match read(name, cut, &ReadOptions::default()) {
                Ok(log) => assert_eq!(values(&log)[..], truth[..log.rows()], "{name} {end}"),
                Err(error) => {
                    let error = error.to_string();
                    let is_said = ["damaged at byte", "no rows of", "usable rows"]
                        .iter()
                        .any(|part| error.contains(part));
                    assert!(is_said, "{name} {end}: {error}");
                }
            }
            if let Ok(log) = read(name, cut, &skipping()) {
                assert_eq!(values(&log)[..], truth[..log.rows()], "{name} {end}");
                assert!(log.skipped_rows.damaged <= 1);
            }
        }
    }
}

/// However a byte is spoilt, no number is wrong apart from those that stand at it.
#[test]
fn a_spoilt_byte_is_refused_or_stays_in_its_row() {
    let rows = rows(5, 1);
    for (name, file) in &files(&rows) {
        let truth = expected(&rows, 0);
        let mut file = file.clone();
        for at in 4..file.len() {
            for flip in [1, 0x90] {
                file[at] ^= flip;
                for options in [ReadOptions::default(), skipping()] {
                    if let Ok(log) = read(name, &file, &options) {
                        let wrong = values(&log)
                            .iter()
                            .filter(|row| !truth.contains(row))
                            .count();
                        let missing = truth.len() - log.rows().min(truth.len());
                        assert!(wrong <= 1, "{name} {at} {flip}: {:?}", values(&log));
                        let is_said = log.skipped_rows.total() > 0;
                        assert!(
                            missing == 0 || is_said || missing == 1,
                            "{name} {at} {flip} {missing}"
                        );
                    }
                }
                file[at] ^= flip;
            }
        }
    }
}

/// Records of every kind and size, of zeros: each is read or refused, and none panics.
#[test]
fn short_records_are_refused() {
    for kind in *b"BFADRSOLCIPMQ" {
        for size in 0..45_u16 {
            let mut file = ulog(&rows(2, 1));
            file.extend(size.to_le_bytes());
            file.push(kind);
            file.resize(file.len() + usize::from(size), 0);
            let is_sound = matches!(
                (kind, size),
                (b'R' | b'O', 2) | (b'S', 8) | (b'D', 26) | (b'B', 40..)
            );
            let error = read("log.ulg", &file, &ReadOptions::default()).err();
            assert_eq!(error.is_none(), is_sound, "{kind} {size} {error:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Bytes that are lost in the middle are found and counted; with damaged parts left out, all rows
    /// that are read are right, and few are lost. Where as many bytes are lost as some records have,
    /// the head of one and the tail of another look like one: that row alone may be wrong.
    #[test]
    fn lost_bytes_are_found(count in 20_usize..60, sources in 1_u8..4, place in 0.3_f64..0.95, lost in 1_usize..60) {
        let rows = rows(count, sources);
        for (name, file) in files(&rows) {
            let mut spoilt = file.clone();
            let at = (place * file.len() as f64) as usize;
            spoilt.drain(at..(at + lost).min(file.len()));
            let options = ReadOptions { skip_bad_rows: true, ..of_instance(0) };
            let truth = expected(&rows, 0);
            let Ok(log) = read(name, &spoilt, &options) else { continue };
            let wrong = |log: &Log| values(log).iter().filter(|row| !truth.contains(row)).count();
            prop_assert!(wrong(&log) <= 1);
            let without = read(name, &spoilt, &of_instance(0));
            if let Ok(whole) = &without {
                prop_assert!(wrong(whole) <= 1);
            } else if without.is_err_and(|error| error.to_string().contains("damaged at")) {
                prop_assert_eq!(wrong(&log), 0);
                prop_assert_eq!(log.skipped_rows.damaged, 1);
                prop_assert!(log.reading.to_string().contains("damaged"));
                let least = if name == "log.bin" { truth.len() - 5 } else { 0 };
                prop_assert!(log.rows() >= least, "{} of {}", log.rows(), truth.len());
            }
        }
    }

    /// Any bytes behind the first ones: no panic.
    #[test]
    fn any_bytes_end(bytes in prop::collection::vec(any::<u8>(), 0..400), at in 0_usize..900) {
        for (name, mut file) in files(&rows(4, 2)) {
            file.truncate(at.max(4));
            file.extend(&bytes);
            for options in [of_instance(0), skipping()] {
                let _ = read(name, &file, &options);
            }
        }
    }
}
