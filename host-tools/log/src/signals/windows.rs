//! Columns that are judged window by window, each window by itself.

use super::Place;

/// A fault is there if the windows that show it make up this share of those judged ...
const SHARE: f64 = 1.0 / 3.0;

/// ... and are so many at least.
const LEAST_WINDOWS: usize = 2;

/// How one column is judged.
pub(super) trait Judged: Clone + Default {
    /// Rows of a window.
    const ROWS: usize;

    /// All of so many windows are judged, then every [`SOME`](Self::SOME) one.
    const ALL: usize;
    const SOME: usize;

    /// Takes in some rows of a window, the first at a place in it.
    fn rows(&mut self, place: usize, values: impl Iterator<Item = f64>);

    /// Judges the window at its end: whether it shows the fault.
    fn end_window(&mut self) -> bool;

    /// What was found, for a person, if so many columns show it.
    fn detail(&self, columns: usize) -> String;
}

/// Finds the rows of a channel that show a fault in a third of the windows.
#[derive(Clone, Debug)]
pub(super) struct Windows<J> {
    rows: usize,
    /// Windows that were judged.
    judged: usize,
    /// Time of the first row of the window \[s\].
    from_s: f64,
    /// The temperature, then the axes.
    columns: Vec<Column<J>>,
}

#[derive(Clone, Debug, Default)]
struct Column<J> {
    judged: J,
    /// Windows that show the fault.
    windows: usize,
    /// Times of the first row of the first of them, and of the last row of the last \[s\].
    from_s: f64,
    to_s: f64,
}

impl<J: Judged> Windows<J> {
    pub(super) fn new(axes: usize) -> Self {
        Self {
            rows: 0,
            judged: 0,
            from_s: 0.0,
            columns: vec![Column::default(); 1 + axes],
        }
    }

    pub(super) fn take(&mut self, time_s: &[f64], temp_c: &[f32], axes: &[&[f64]]) {
        let mut start = 0;
        while start < time_s.len() {
            // Up to the end of the window or of the rows.
            let place = self.rows % J::ROWS;
            let end = time_s.len().min(start + J::ROWS - place);
            let window = self.rows / J::ROWS;
            self.rows += end - start;
            if window < J::ALL || window.is_multiple_of(J::SOME) {
                if place == 0 {
                    self.from_s = time_s[start];
                }
                let (temperature, others) = self.columns.split_first_mut().expect("a temperature");
                let temps_c = temp_c[start..end].iter().map(|&temp_c| f64::from(temp_c));
                temperature.judged.rows(place, temps_c);
                for (column, values) in others.iter_mut().zip(axes) {
                    column
                        .judged
                        .rows(place, values[start..end].iter().copied());
                }
                if self.rows.is_multiple_of(J::ROWS) {
                    self.end_window(time_s[end - 1]);
                }
            }
            start = end;
        }
    }

    fn end_window(&mut self, to_s: f64) {
        self.judged += 1;
        for column in &mut self.columns {
            if column.judged.end_window() {
                if column.windows == 0 {
                    column.from_s = self.from_s;
                }
                column.windows += 1;
                column.to_s = to_s;
            }
        }
    }

    /// The temperature if it shows the fault, otherwise the axis with the most such windows.
    pub(super) fn finish(self) -> Vec<Place> {
        let least = (SHARE * self.judged as f64).max(LEAST_WINDOWS as f64);
        let numbered = self.columns.iter().enumerate();
        let found = numbered.filter(|(_, column)| column.windows as f64 >= least);
        let count = found.clone().count();
        let most = found.max_by_key(|&(number, column)| (number == 0, column.windows));
        let place = |(number, column): (usize, &Column<J>)| Place {
            axis: number.checked_sub(1),
            rows: self.rows * column.windows / self.judged,
            from_s: column.from_s,
            to_s: column.to_s,
            detail: column.judged.detail(count),
        };
        most.into_iter().map(place).collect()
    }
}
