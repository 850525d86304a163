//! A set run over a file that is read once more, chunk by chunk.

use std::ops::Range;
use std::path::Path;

use tempco_fit::{FitOptions, fit};
use tempco_log::{Channel, Log, ReadOptions, read_log};
use tempco_set::run::{Applied, KnownLog, Part, apply, apply_to_file, apply_to_log};
use tempco_set::{ChannelSet, CoefficientSet, Model};

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

/// The file gives the rows of the log in memory, and so do its parts, with a set that is compared
/// along.
fn assert_same(set: &CoefficientSet, known: &KnownLog, log: &Log) {
    let expected = apply(set, log).unwrap();
    let static_part = set.static_part().unwrap();
    let compared = apply(&static_part, log).unwrap();
    let options = ReadOptions::default();
    let assert_rows = |found: &Applied, expected: &Applied, rows: Range<usize>| {
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
    };
    let temps_c = |channel: &ChannelSet| {
        let has = |of: &&Channel| of.axes.iter().any(|axis| axis.name == channel.axes[0].name);
        &log.channels.iter().find(has).unwrap().temp_c
    };
    for other in [None, Some(&static_part)] {
        let (mut row, mut parts) = (0, 0);
        let mut take = |part: Part| {
            let rows = row..row + part.time_s.len();
            assert_eq!(part.time_s, &log.time_s[rows.clone()]);
            for input in &part.inputs {
                assert_eq!(input.temp_c, &temps_c(input.channel)[rows.clone()]);
            }
            assert_rows(&part.applied, &expected, rows.clone());
            assert_eq!(part.compared.is_some(), other.is_some());
            if let Some(found) = &part.compared {
                assert_rows(found, &compared, rows.clone());
            }
            (row, parts) = (rows.end % log.rows(), parts + 1);
        };
        let mut bytes = 0;
        apply_to_file(set, other, known, &options, |more| bytes += more, &mut take).unwrap();
        assert_eq!(bytes, std::fs::metadata(&known.path).unwrap().len());
        apply_to_log(set, other, log, &mut take).unwrap();
        assert_eq!(row, 0, "all rows, twice");
        assert!(parts > 4, "one part does not test what passes between them");
    }
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
    let options = ReadOptions::default();
    let error = apply_to_file(&set, None, &known, &options, |_| (), |_| ()).unwrap_err();
    assert!(error.to_string().contains("changed while"), "{error}");
}
