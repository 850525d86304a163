//! A set run over a file that is read once more, chunk by chunk.

use std::path::Path;

use tempco_fit::{FitOptions, fit};
use tempco_log::{Log, ReadOptions, read_log};
use tempco_set::run::{KnownLog, apply, apply_to_file, inputs};
use tempco_set::{CoefficientSet, Model};

/// Long enough for many chunks.
const ROWS: u32 = 120_000;

fn written(folder: &Path, text: &str) -> (KnownLog, Log) {
    let path = folder.join("log.csv");
    std::fs::write(&path, text).unwrap();
    let log = read_log(&path, &ReadOptions::default()).unwrap();
    let known = KnownLog {
        path,
        interval_s: log.interval_s,
        sha256: log.sha256.clone(),
    };
    (known, log)
}

fn fitted(log: &Log, model: Model) -> CoefficientSet {
    let options = FitOptions::new("S1", model);
    fit(std::slice::from_ref(log), &options).unwrap().set
}

fn temp_c(t: f64) -> f64 {
    25.0 + 15.0 * (t * 2e-4).sin()
}

/// Pulses and an angular rate.
fn text() -> String {
    let mut text = String::from("time_s,temp_c,x_pulses,y_dph\n");
    for row in 0..ROWS {
        let t = f64::from(row);
        let temp_c = temp_c(t);
        let x = (0.3 * temp_c).round();
        let y = 1.0 - 0.01 * temp_c;
        text += &format!("{:.1},{temp_c:.2},{x},{y:.4}\n", 0.5 * t);
    }
    text
}

/// Two temperatures with two axes each.
fn text_of_channels() -> String {
    let mut text = String::from("time_s,temp_x_c,temp_y_c,gx_pulses,gy_dph,ax_g,ay_mps2\n");
    for row in 0..ROWS {
        let t = f64::from(row);
        let (x_c, y_c) = (temp_c(t), temp_c(t - 700.0) + 1.0);
        let (gx, gy) = ((0.3 * x_c).round(), 1.0 - 0.01 * y_c);
        let (ax, ay) = (1e-4 * x_c, 2e-3 * y_c);
        text += &format!(
            "{:.1},{x_c:.2},{y_c:.2},{gx},{gy:.4},{ax:.6},{ay:.5}\n",
            0.5 * t
        );
    }
    text
}

/// The file gives the rows of the log in memory.
fn assert_same(set: &CoefficientSet, known: &KnownLog, log: &Log) {
    let (expected, all) = (apply(set, log).unwrap(), inputs(set, log).unwrap());
    let (mut row, mut chunks) = (0, 0);
    apply_to_file(
        set,
        known,
        &ReadOptions::default(),
        |time_s, inputs, found, bytes| {
            let rows = row..row + time_s.len();
            assert_eq!(time_s, &log.time_s[rows.clone()]);
            for (found, expected) in inputs.iter().zip(&all) {
                assert_eq!(found.temp_c, &expected.temp_c[rows.clone()]);
            }
            assert_eq!(found.status, expected.status[rows.clone()]);
            assert_eq!(found.points.len(), expected.points.len());
            for (found, expected) in found.points.iter().zip(&expected.points) {
                assert_eq!(found, &expected[rows.clone()]);
            }
            assert_eq!(found.axes.len(), expected.axes.len());
            for (found, expected) in found.axes.iter().zip(&expected.axes) {
                assert_eq!(found.raw, expected.raw[rows.clone()]);
                assert_eq!(found.bias, expected.bias[rows.clone()]);
                assert_eq!(found.compensated, expected.compensated[rows.clone()]);
            }
            assert!(bytes > 0);
            (row, chunks) = (rows.end, chunks + 1);
        },
    )
    .unwrap();
    assert_eq!(row, log.rows());
    assert!(
        chunks > 1,
        "one chunk does not test what passes between them"
    );
}

#[test]
fn a_file_gives_the_rows_of_the_log_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (known, log) = written(folder.path(), &text());
    let mut set = fitted(&log, Model::Composite);
    // The axes in another order than in the log.
    let channel = &mut set.channels[0];
    channel.axes.swap(0, 1);
    channel
        .table
        .cells
        .iter_mut()
        .for_each(|cell| cell.swap(0, 1));
    assert_same(&set, &known, &log);
}

#[test]
fn channels_with_history_terms_are_the_same_in_a_file_and_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (known, log) = written(folder.path(), &text_of_channels());
    let mut set = fitted(&log, Model::Composite);
    for channel in &mut set.channels {
        let table = &mut channel.table;
        table.thermal.half_width1_c = 2.0;
        table.thermal.tau2_s = 900.0;
        (table.thermal.lag2_min_c, table.thermal.lag2_max_c) = (-10.0, 10.0);
        table.play_gains = vec![[0.01, 0.0], [-0.02, 0.0]];
        for cell in &mut table.cells {
            (cell[0].s[0], cell[1].s[0]) = (0.03, 0.01);
        }
    }
    set.channels.swap(0, 1);
    assert_same(&set, &known, &log);
}

#[test]
fn another_file_of_the_same_name_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = text();
    let (known, log) = written(folder.path(), &text);
    let set = fitted(&log, Model::Static);
    std::fs::write(&known.path, text + "60000,25,3,1\n").unwrap();
    let error = apply_to_file(&set, &known, &ReadOptions::default(), |_, _, _, _| ()).unwrap_err();
    assert!(error.to_string().contains("changed while"), "{error}");
}
