//! Aligned tables in plain text.

/// Prints a heading, then the rows in columns as narrow as they can be: the first flush left, the
/// others flush right.
pub(crate) fn print<const N: usize>(heading: &str, header: [&str; N], rows: &[[String; N]]) {
    println!("\n{heading}\n{}", text(header, rows));
}

fn text<const N: usize>(header: [&str; N], rows: &[[String; N]]) -> String {
    let header = header.map(str::to_owned);
    let all = || std::iter::once(&header).chain(rows);
    let widths: [usize; N] = std::array::from_fn(|column| {
        let lengths = all().map(|row| row[column].len());
        lengths.max().unwrap_or(0)
    });
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(widths).enumerate();
        let cells = cells.map(|(column, (cell, width))| match column {
            0 => format!("{cell:width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    all().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let rows = [["a", "1.25"], ["long", "10.50"]].map(|row| row.map(str::to_owned));
        let expected = "kind   mean\na      1.25\nlong  10.50";
        assert_eq!(text(["kind", "mean"], &rows), expected);
    }
}
