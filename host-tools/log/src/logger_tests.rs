//! Logs as known loggers write them, mappings, held and joined temperatures.

use std::fs;
use std::path::Path;

use super::{AxisUnit, DoubtKind, Log, Mapping, ReadOptions, read_log};

fn read_as(file: &str, text: &str, options: &ReadOptions) -> Result<Log, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    fs::write(&path, text).unwrap();
    let error = |error: super::LogError| {
        let error = error.to_string();
        let start = error.rfind(&format!("/{file}")).unwrap_or(0);
        error[start..].to_owned()
    };
    read_log(&path, options).map_err(error)
}

fn read(file: &str, text: &str) -> Result<Log, String> {
    read_as(file, text, &ReadOptions::default())
}

fn mapped(mapping: Mapping) -> ReadOptions {
    ReadOptions {
        mapping,
        ..ReadOptions::default()
    }
}

fn names(log: &Log) -> Vec<(&str, AxisUnit)> {
    let axes = log.channels.iter().flat_map(|channel| &channel.axes);
    axes.map(|axis| (&axis.name[..], axis.unit)).collect()
}

fn layout(log: &Log) -> &str {
    log.reading.layout.as_deref().unwrap()
}

const GYROS: [(&str, AxisUnit); 3] = [
    ("gx", AxisUnit::Radps),
    ("gy", AxisUnit::Radps),
    ("gz", AxisUnit::Radps),
];

const PX4: &str = "timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count,samples\n\
                   12345678,12345378,2818058,0.1,0.2,0.3,21.5,0,8\n\
                   12545678,12545378,2818058,0.4,0.5,0.6,22.5,0,8\n";

#[test]
fn px4_is_known_by_columns_and_the_name_of_the_file() {
    let log = read("log_12_sensor_gyro_0.csv", PX4).unwrap();
    assert_eq!(layout(&log), "PX4 sensor_gyro");
    assert_eq!(names(&log), GYROS);
    assert_eq!(log.time_s, [12.345678, 12.545678]);
    assert_eq!(log.channels[0].temp_c, [21.5, 22.5]);
    assert_eq!(log.channels[0].axes[2].raw, [0.3, 0.6]);
    let log = read("log_12_sensor_accel_0.csv", PX4).unwrap();
    assert_eq!(names(&log)[0], ("ax", AxisUnit::Mps2));
    // The same columns under another name could be either.
    let error = read("run7.csv", PX4).unwrap_err();
    assert!(
        error.contains("gx=x:radps") && error.contains("ax=x:mps2"),
        "{error}"
    );
    let axis = ["gx=x:radps", "gy=y:radps", "gz=z:radps"].map(str::to_owned);
    let options = mapped(Mapping {
        axis: axis.to_vec(),
        ..Mapping::default()
    });
    let log = read_as("run7.csv", PX4, &options).unwrap();
    assert_eq!((names(&log), log.time_s[0]), (GYROS.to_vec(), 12.345678));
    let combined = "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0]\n\
                    1,2,3,4,5\n2,2,3,4,5\n";
    let error = read("log_sensor_combined_0.csv", combined).unwrap_err();
    assert!(
        error.contains("sensor_combined without a temperature: expected --join FILE"),
        "{error}"
    );
}

fn ardupilot(rows: usize, source: impl Fn(usize) -> usize) -> String {
    let header = "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T";
    let rows = (0..rows).map(|row| {
        let us = 200_000 * row;
        format!(
            "\n1696150000.{row},{us},{},0.{row},2,3,4,5,6,25",
            source(row)
        )
    });
    header.to_owned() + &rows.collect::<String>() + "\n"
}

#[test]
fn ardupilot_must_have_one_source() {
    let log = read("log.csv", &ardupilot(300, |_| 1)).unwrap();
    assert_eq!(
        (layout(&log), names(&log)),
        ("ArduPilot IMU", GYROS.to_vec())
    );
    assert!(
        log.reading
            .to_string()
            .contains("temperature correction may be in it")
    );
    assert_eq!(log.reading.doubts.len(), 1);
    assert_eq!(log.reading.doubts[0].kind, DoubtKind::OwnCorrection);
    assert!(log.ignored_columns.contains(&"AccX".to_owned()));
    let two = ardupilot(300, |row| row % 2);
    let error = read("log.csv", &two).unwrap_err();
    assert!(
        error.starts_with("/log.csv:1: column `I` has several sources"),
        "{error}"
    );
    assert!(error.contains("--where I=0"), "{error}");
    let options = mapped(Mapping {
        filter: vec!["I=1".to_owned()],
        ..Mapping::default()
    });
    let log = read_as("log.csv", &two, &options).unwrap();
    assert_eq!(
        (log.rows(), log.time_s[0], log.skipped_rows.total()),
        (150, 0.2, 0)
    );
    // Columns that were kept from a log of one source are not enough for a log of two.
    let kept = ReadOptions {
        kept: vec![Mapping {
            filter: Vec::new(),
            ..log.reading.mapping.clone().unwrap()
        }],
        ..ReadOptions::default()
    };
    let error = read_as("log.csv", &two, &kept).unwrap_err();
    assert!(error.contains("--where I=0"), "{error}");
    // A second source that begins late is refused even where bad rows are skipped.
    let late = ardupilot(300, |row| row / 250);
    let options = ReadOptions {
        skip_bad_rows: true,
        ..ReadOptions::default()
    };
    let error = read_as("log.csv", &late, &options).unwrap_err();
    assert!(
        error.starts_with("/log.csv:252: column `I` has several"),
        "{error}"
    );
}

#[test]
fn flysight_rows_are_taken_from_those_of_other_sensors() {
    let text = "$FLYS,1\n$VAR,FIRMWARE_VER,v2023.09.22\n$COL,BARO,time,pressure,temperature\n\
                $UNIT,BARO,s,Pa,deg C\n$COL,IMU,time,wx,wy,wz,ax,ay,az,temperature\n\
                $UNIT,IMU,s,deg/s,deg/s,deg/s,g,g,g,deg C\n$COL,VBAT,time,voltage\n\
                $UNIT,VBAT,s,volt\n$DATA\n$BARO,59970.1,98943.08,27.98\n\
                $IMU,59970.376,-0.427,1.770,1.953,-0.01464,-0.00732,0.94287,25.64\n\
                $VBAT,59970.4,3.7\n\
                $IMU,59970.476,-0.5,1.8,1.9,-0.01,-0.007,0.94,25.65\n";
    let log = read("SENSOR.CSV", text).unwrap();
    assert_eq!(layout(&log), "FlySight 2");
    assert_eq!(names(&log)[0], ("gx", AxisUnit::Dps));
    assert_eq!(log.time_s, [59970.376, 59970.476]);
    assert_eq!(log.channels[0].temp_c, [25.64, 25.65]);
    let error = read("SENSOR.CSV", &text.replace("1.8,1.9", "no,1.9")).unwrap_err();
    assert!(
        error.starts_with("/SENSOR.CSV:13:4: column `wy [deg/s]`: `no`"),
        "{error}"
    );
    let error = read(
        "SENSOR.CSV",
        &text.replace("$UNIT,IMU,s,deg/s", "$UNIT,IMU,s,"),
    )
    .unwrap_err();
    assert!(error.contains("$UNIT,IMU"), "{error}");
}

#[test]
fn xsens_counts_time_in_ticks_or_packets() {
    let text = "// Start Time: Unknown\n// Update Rate: 100.0Hz\n// Firmware Version: 4.6.0\n\
                PacketCounter\tSampleTimeFine\tAcc_X\tGyr_X\tGyr_Y\tGyr_Z\tTemperature\n\
                23593\t1000\t9.4\t0.1\t0.2\t0.3\t30.5\n23594\t1100\t9.4\t0.4\t0.5\t0.6\t30.5\n";
    let log = read("MT.txt", text).unwrap();
    assert_eq!((layout(&log), names(&log)), ("Xsens text", GYROS.to_vec()));
    assert_eq!(log.time_s, [0.1, 0.11]);
    let packets = text.replace("\t1000\t", "\t\t").replace("\t1100\t", "\t\t");
    let log = read("MT.txt", &packets).unwrap();
    assert_eq!(log.time_s, [235.93, 235.94]);
    let error = read("MT.txt", &packets.replace("// Update Rate: 100.0Hz\n", "")).unwrap_err();
    assert!(error.contains("Xsens text without time"), "{error}");
}

#[test]
fn kalibr_and_euroc_have_no_temperature() {
    let euroc = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                 a_RS_S_x [m s^-2]\n1403636579758555392,1,2,3,4\n1403636579763555392,1,2,3,4\n";
    let kalibr = "timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z\n\
                  1403636579758555392,1,2,3,4,5,6\n1403636579763555392,1,2,3,4,5,6\n";
    for (text, name) in [(euroc, "EuRoC"), (kalibr, "Kalibr")] {
        let error = read("imu0.csv", text).unwrap_err();
        let expected = format!("{name} without a temperature: expected --join FILE");
        assert!(error.contains(&expected), "{error}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu0.csv");
        let join = folder.path().join("t.csv");
        fs::write(&path, text).unwrap();
        fs::write(
            &join,
            "timestamp [ns],temp_c\n1403636579758555391,20.5\n1403636579761555391,21\n",
        )
        .unwrap();
        let log = read_log(&path, &joined(&join)).unwrap();
        assert_eq!((layout(&log), names(&log)), (name, GYROS.to_vec()));
        // Counted from the first row, without loss.
        assert_eq!(log.time_s, [0.0, 0.005]);
        assert_eq!(log.channels[0].temp_c, [20.5, 21.0]);
    }
}

fn joined(path: &Path) -> ReadOptions {
    mapped(Mapping {
        join: Some(path.display().to_string()),
        ..Mapping::default()
    })
}

#[test]
fn joined_temperatures_are_the_last_ones_for_ten_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let (path, join) = (folder.path().join("g.csv"), folder.path().join("t.csv"));
    let rows: String = (0..60).map(|row| format!("{row},{row}\n")).collect();
    fs::write(&path, format!("time_s,x_dps\n{rows}")).unwrap();
    fs::write(
        &join,
        "millis;temp_c\n3500;20,5\n9000;21,5\n19000;22,5\n29500;23,5\n",
    )
    .unwrap();
    let error = read_log(&path, &joined(&join)).unwrap_err().to_string();
    assert!(
        error.contains("g.csv:31: no temperature in the 10 s before 29.0")
            || error.contains("g.csv:42: no temperature in the 10 s before 40 s in "),
        "{error}"
    );
    assert!(error.ends_with("t.csv (3.5 to 29.5 s)"), "{error}");
    let skipping = ReadOptions {
        skip_bad_rows: true,
        ..joined(&join)
    };
    let log = read_log(&path, &skipping).unwrap();
    assert_eq!((log.rows(), log.time_s[0]), (36, 4.0));
    let temp_at = |time_s: f64| {
        let row = log.time_s.iter().position(|&at| at == time_s).unwrap();
        log.channels[0].temp_c[row]
    };
    assert_eq!(
        (temp_at(8.0), temp_at(9.0), temp_at(28.0)),
        (20.5, 21.5, 22.5)
    );
    // Clock times in one of them only.
    fs::write(
        &join,
        "timestamp,temp_c\n2023-03-04 09:00:00,20.5\n2023-03-04 09:00:01,20.5\n",
    )
    .unwrap();
    let error = read_log(&path, &joined(&join)).unwrap_err().to_string();
    assert!(
        error.contains("expected clock times in both or in neither"),
        "{error}"
    );
    fs::write(
        &path,
        "timestamp,x_dps\n2023-03-04 09:00:00.5,1\n2023-03-04 09:00:01.5,2\n",
    )
    .unwrap();
    fs::write(
        &join,
        "timestamp,temp_c\n2023-03-04 09:00:00,20.5\n2023-03-04 09:00:01,21.5\n",
    )
    .unwrap();
    let log = read_log(&path, &joined(&join)).unwrap();
    assert_eq!(
        (log.time_s, &log.channels[0].temp_c[..]),
        (vec![0.0, 1.0], &[20.5, 21.5][..])
    );
}

#[test]
fn blank_temperatures_hold_the_last_one_for_ten_seconds() {
    let with = |temp: &dyn Fn(usize) -> &'static str, end: &str| {
        let rows = (0..40).map(|row| format!("{row},{},{row}{end}", temp(row)));
        format!("time_s,temp_c,x_dps{end}") + &rows.collect::<String>()
    };
    for end in ["\n", "\r\n"] {
        let log = read(
            "log.csv",
            &with(&|row| ["20.5", ""][usize::from(row % 10 > 0)], end),
        )
        .unwrap();
        assert_eq!((log.rows(), log.channels[0].temp_c[39]), (40, 20.5));
        let log = read(
            "log.csv",
            &with(&|row| ["21", ""][usize::from(row < 5)], end),
        )
        .unwrap();
        assert_eq!(
            (log.rows(), log.time_s[0], log.skipped_rows.total()),
            (35, 5.0, 5)
        );
        let late = with(&|row| ["21", ""][usize::from((5..16).contains(&row))], end);
        let error = read("log.csv", &late).unwrap_err();
        assert!(
            error.starts_with("/log.csv:17:2: column `temp_c`: an empty cell, and no"),
            "{error}"
        );
        let late = with(&|row| ["21", ""][usize::from(row < 12)], end);
        assert!(
            read("log.csv", &late)
                .unwrap_err()
                .starts_with("/log.csv:13:2:")
        );
    }
    let error = read("log.csv", "time_s,temp_c,x_dps\n0,nan,1\n1,20,2\n").unwrap_err();
    assert!(error.contains("`nan`: expected a finite number"), "{error}");
}

#[test]
fn temperatures_and_times_are_converted() {
    let text = "Time [ms],Temp [degF],x_dps\n0,212,1\n500,32,2\n";
    let log = read("log.csv", text).unwrap();
    assert_eq!(
        (&log.time_s[..], &log.channels[0].temp_c[..]),
        (&[0.0, 0.5][..], &[100.0, 0.0][..])
    );
    let log = read(
        "log.csv",
        "micros,temp_k,x_dps\n0,273.15,1\n500000,298.15,2\n",
    )
    .unwrap();
    assert_eq!(
        (&log.time_s[..], &log.channels[0].temp_c[..]),
        (&[0.0, 0.5][..], &[0.0, 25.0][..])
    );
    let error = read("log.csv", "time_s,temp_k,x_dps\n0,20,1\n1,21,2\n").unwrap_err();
    assert!(error.contains("expected -100 to 200 degC"), "{error}");
    let counts = mapped(Mapping {
        time: Some("millis".to_owned()),
        temp: vec!["tmp*0.5+36".to_owned()],
        axis: vec![
            "gx=gyx*0.25:dps".to_owned(),
            "n=n-1*-2+1:pulses_per_s".to_owned(),
        ],
        ..Mapping::default()
    });
    let log = read_as(
        "log.csv",
        "millis,tmp,gyx,n-1\n0,-20,4,1\n250,-21,8,2\n",
        &counts,
    )
    .unwrap();
    assert_eq!(log.channels[0].temp_c, [26.0, 25.5]);
    assert_eq!(log.channels[0].axes[0].raw, [1.0, 2.0]);
    assert_eq!(log.channels[0].axes[1].raw, [-1.0, -3.0]);
}

#[test]
fn clock_times_need_no_option_and_are_refused_by_cell() {
    let text = "timestamp,temp_c,x_dps\n2023-03-04 09:00:00,20,1\n2023-03-04 09:00:00.2,20,2\n";
    let log = read("log.csv", text).unwrap();
    assert_eq!(log.time_s, [0.0, 0.2]);
    assert_eq!(
        log.reading.mapping.unwrap().time.as_deref(),
        Some("timestamp:iso")
    );
    let error = read("log.csv", &text.replace("00.2", "00.2x")).unwrap_err();
    let expected =
        "/log.csv:3:1: column `timestamp`: `2023-03-04 09:00:00.2x`: expected a time by ISO";
    assert!(error.starts_with(expected), "{error}");
    let error = read("log.csv", &text.replace("2023-03-04", "03/04/2023")).unwrap_err();
    assert!(
        error.contains("`03/04/2023 09:00:00` in `timestamp` is not a time by ISO 8601"),
        "{error}"
    );
}

/// What was recognised is a mapping with which the log is read alike, whatever its file is called.
#[test]
fn a_kept_mapping_reads_what_was_recognised() {
    let two = ardupilot(40, |row| row % 2);
    for (file, text, filter) in [
        ("log_sensor_gyro_0.csv", PX4.to_owned(), None),
        ("log.csv", two, Some("I=0")),
        (
            "log.csv",
            "Zeit [s];Temp [K];gx (deg/s)\n0,5;290,5;1\n1;290;2\n".to_owned(),
            None,
        ),
        (
            "log.csv",
            "t;T;imu0_temp_c;imu1_temp_c;imu0_x_dps;imu1_x_dps\n1;2;3;4;5;6\n2;2;3;4;5;6\n"
                .replace("t;", "time_s;"),
            None,
        ),
    ] {
        let given = mapped(Mapping {
            filter: filter.into_iter().map(str::to_owned).collect(),
            ..Mapping::default()
        });
        let log = read_as(file, &text, &given).unwrap();
        let kept = ReadOptions {
            kept: vec![log.reading.mapping.clone().unwrap()],
            ..ReadOptions::default()
        };
        let again = read_as("verification.csv", &text, &kept).unwrap();
        assert_eq!(again.reading.mapping, log.reading.mapping);
        assert_eq!(again.time_s, log.time_s);
        let values = |log: &Log| {
            let channels = log.channels.iter();
            let values =
                channels.map(|channel| (channel.temp_c.clone(), channel.axes[0].raw.clone()));
            values.collect::<Vec<_>>()
        };
        assert_eq!(values(&again), values(&log));
        // A log without these columns is read by its names.
        let plain = "time_s,temp_c,gx_dps\n0,20,1\n1,20,2\n";
        assert!(
            read_as("plain.csv", plain, &kept)
                .unwrap()
                .reading
                .is_plain()
        );
    }
}
