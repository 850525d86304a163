//! A set run over a log that is read once more, chunk by chunk.

use std::path::Path;

use tempco_fit::{FitOptions, fit};
use tempco_log::{ReadOptions, read_log};
use tempco_set::Model;
use tempco_set::run::{Reread, apply, rerun};

fn written(folder: &Path, bytes: &str) -> Reread {
    let path = folder.join("log.csv");
    std::fs::write(&path, bytes).unwrap();
    let log = read_log(&path, &ReadOptions::default()).unwrap();
    Reread {
        path,
        interval_s: log.interval_s,
        sha256: log.sha256,
    }
}

/// Long enough for many chunks; pulses, and two axes in the other order than in the set.
fn text() -> String {
    let mut text = String::from("time_s,temp_c,x_pulses,y_dph\n");
    for row in 0..120_000 {
        let t = f64::from(row);
        let temp_c = 25.0 + 15.0 * (t * 2e-4).sin();
        let x = (0.3 * temp_c).round();
        text += &format!(
            "{:.1},{temp_c:.2},{x},{:.4}\n",
            0.5 * t,
            1.0 - 0.01 * temp_c
        );
    }
    text
}

#[test]
fn rows_are_answered_as_by_apply() {
    let folder = tempfile::tempdir().unwrap();
    let again = written(folder.path(), &text());
    let log = read_log(&again.path, &ReadOptions::default()).unwrap();
    let options = FitOptions::new("S1", Model::Composite);
    let mut set = fit(std::slice::from_ref(&log), &options).unwrap().set;
    let channel = &mut set.channels[0];
    channel.axes.swap(0, 1);
    channel
        .table
        .cells
        .iter_mut()
        .for_each(|cell| cell.swap(0, 1));
    let applied = apply(&set, &log).unwrap();
    let (mut row, mut chunks) = (0, 0);
    rerun(&set, &again, &ReadOptions::default(), |answers, bytes| {
        let rows = row..row + answers.time_s.len();
        assert_eq!(answers.time_s, log.time_s[rows.clone()]);
        assert_eq!(answers.status, applied.status[rows.clone()]);
        for (found, expected) in answers.channels[0].axes.iter().zip(&applied.axes) {
            assert_eq!(found.raw, expected.raw[rows.clone()]);
            assert_eq!(found.bias, expected.bias[rows.clone()]);
            assert_eq!(found.compensated, expected.compensated[rows.clone()]);
        }
        assert!(bytes > 0);
        (row, chunks) = (rows.end, chunks + 1);
    })
    .unwrap();
    assert_eq!(row, log.rows());
    assert!(
        chunks > 1,
        "one chunk does not test what passes between them"
    );
}

#[test]
fn another_file_of_the_same_name_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = text();
    let again = written(folder.path(), &text);
    let log = read_log(&again.path, &ReadOptions::default()).unwrap();
    let options = FitOptions::new("S1", Model::Static);
    let set = fit(&[log], &options).unwrap().set;
    std::fs::write(&again.path, text + "60000,25,3,1\n").unwrap();
    let error = rerun(&set, &again, &ReadOptions::default(), |_, _| ()).unwrap_err();
    assert!(error.to_string().contains("changed while"), "{error}");
}
