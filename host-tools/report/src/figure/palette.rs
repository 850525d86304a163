//! Colours of the figures, and what becomes of them on a dark screen.
//!
//! After Okabe and Ito (2008): distinct with every kind of colour vision. Where two colours
//! carry a meaning, so does the form of the mark.

use plotters::style::RGBColor;

pub(crate) const SURFACE: RGBColor = RGBColor(255, 255, 255);
pub(crate) const INK: RGBColor = RGBColor(27, 31, 36);
pub(crate) const MUTED: RGBColor = RGBColor(91, 100, 112);
pub(crate) const GRID: RGBColor = RGBColor(222, 226, 231);
/// Orange.
pub(crate) const BEFORE: RGBColor = RGBColor(230, 159, 0);
/// Black.
pub(crate) const AFTER: RGBColor = INK;
/// Vermillion.
pub(crate) const HEATING: RGBColor = RGBColor(213, 94, 0);
/// Blue.
pub(crate) const COOLING: RGBColor = RGBColor(0, 114, 178);
/// Bluish green.
pub(crate) const OTHER: RGBColor = RGBColor(0, 158, 115);

/// Each colour with the one that stands for it on a dark screen.
const DARK: [(RGBColor, RGBColor); 8] = [
    (SURFACE, RGBColor(22, 25, 29)),
    (INK, RGBColor(230, 232, 235)),
    (MUTED, RGBColor(163, 171, 181)),
    (GRID, RGBColor(54, 60, 68)),
    (BEFORE, BEFORE),
    (HEATING, RGBColor(242, 130, 60)),
    (COOLING, RGBColor(86, 180, 233)),
    (OTHER, RGBColor(48, 196, 152)),
];

/// The rules of a style sheet that turn figures dark. Figures carry the colours of a light page,
/// so that their files are complete without these.
pub(crate) fn dark_rules() -> String {
    let rule = |(light, dark): &(RGBColor, RGBColor)| {
        let (light, dark) = (hex(*light), hex(*dark));
        format!("svg [fill=\"{light}\"]{{fill:{dark}}}svg [stroke=\"{light}\"]{{stroke:{dark}}}\n")
    };
    DARK.iter().map(rule).collect()
}

/// A colour as SVG has it, found by the rules for a dark screen.
pub(super) fn hex(RGBColor(r, g, b): RGBColor) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}
