//! The figures of `docs/` that no command draws are drawn again. `TEMPCO_BLESS=1` writes them.

mod ln100;
mod segments;

use std::fs;

use tempco_tests::root;

/// Blue, vermillion, green and purple of the Okabe-Ito palette, which colour-blind people can tell
/// apart.
const COLOURS: [plotters::style::RGBColor; 4] = [
    plotters::style::RGBColor(0, 114, 178),
    plotters::style::RGBColor(213, 94, 0),
    plotters::style::RGBColor(0, 158, 115),
    plotters::style::RGBColor(204, 121, 167),
];

/// Compares a figure with the committed one, or writes it.
fn compare(name: &str, svg: &str) {
    let path = root().join("docs").join(name);
    if std::env::var_os("TEMPCO_BLESS").is_some() {
        fs::write(&path, svg).unwrap();
        return;
    }
    let committed = fs::read_to_string(&path).unwrap();
    assert!(svg == committed, "docs/{name} is not what is drawn now");
}
