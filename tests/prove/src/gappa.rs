//! Gappa scripts for a table's rounding, and one for any table.

use std::fmt::{Display, Write};
use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use tempco_set::TableData;

const ROUNDING: &str = "@rnd = float<ieee_32, ne>;\n";

/// Gappa's bounds for one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GappaBound {
    /// Error of the polynomial \[unit of the axis\].
    pub evaluation: f64,
    /// Error of the place \[cells\].
    pub place: f64,
}

/// The bias as the core computes it, exactly or rounded, of the named terms.
fn bias<T: Display>(a: [T; 3], r: [T; 2]) -> String {
    let ([a0, a1, a2], [r0, r1]) = (a, r);
    format!("({a0} + z * ({a1} + z * {a2})) + t * ({r0} + z * {r1})")
}

/// A float exactly: mantissa times power of two.
fn exactly(value: f32) -> String {
    let bits = value.to_bits();
    let exponent = ((bits >> 23) & 0xFF) as i32;
    let mantissa = (bits & 0x7F_FFFF) | if exponent == 0 { 0 } else { 0x80_0000 };
    let sign = if value.is_sign_negative() { "-" } else { "" };
    format!("{sign}{mantissa}b{}", exponent.max(1) - 150)
}

/// The question for the bounds of an axis over all cells.
pub fn script(table: &TableData, axis: usize) -> String {
    let mut text = format!("{ROUNDING}z = rnd(z_); t = rnd(t_); u = rnd(u_);\n");
    let mut goals = Vec::new();
    for (number, cell) in table.cells.iter().enumerate() {
        let terms = cell[axis];
        let bias = bias(terms.a.map(exactly), terms.r.map(exactly));
        writeln!(text, "f{number} rnd= {bias};\ne{number} = {bias};").ok();
        goals.push(format!("f{number} - e{number} in ?"));
    }
    let first = exactly(table.first_edge_c);
    let factor = exactly(table.cells_per_c());
    let exact = format!(
        "{}b0 / ({} - {first})",
        table.cells.len(),
        exactly(table.last_edge_c)
    );
    writeln!(
        text,
        "p rnd= {factor} * (u - {first});\nq = {factor} * (u - {first});\n\
         e = (u - {first}) * ({exact});"
    )
    .ok();
    let thermal = &table.thermal;
    writeln!(
        text,
        "{{ z in [0,1] /\\ t in [{},{}] /\\ u in [{},{}]\n  -> {} /\\ p - e in ? }}\n\
         p - e -> (p - q) + (u - {first}) * ({factor} - {exact});",
        exactly(thermal.rate_min_c_per_min),
        exactly(thermal.rate_max_c_per_min),
        exactly(table.t_min_c),
        exactly(table.t_max_c),
        goals.join(" /\\ "),
    )
    .ok();
    text
}

/// Error of the bias for coefficients and rates of magnitude 1 at most, with a hysteresis term and
/// a second lag of gains and figures of magnitude 1 at most, or without \[2^-24\].
pub const GENERIC_UNITS: u32 = 20;

/// The theorem for any table, scaled by powers of two.
pub fn generic_script() -> String {
    let table = bias(["a0", "a1", "a2"], ["r0", "r1"]);
    let bias = format!("(({table}) + g * p) + h * s");
    let names = ["a0", "a1", "a2", "r0", "r1", "t", "z", "g", "p", "h", "s"];
    let mut text = ROUNDING.to_owned();
    for name in names {
        writeln!(text, "{name} = rnd({name}_);").ok();
    }
    let ranges: Vec<String> = names
        .iter()
        .map(|name| format!("{name} in [{},1]", if *name == "z" { 0 } else { -1 }))
        .collect();
    writeln!(
        text,
        "f rnd= {bias};\ne = {bias};\n{{ {} -> |f - e| <= {GENERIC_UNITS}b-24 }}",
        ranges.join(" /\\ ")
    )
    .ok();
    text
}

/// Runs Gappa and reads the bounds it found.
///
/// # Errors
/// Gappa fails, or its answer is not understood.
pub fn bounds(table: &TableData, axis: usize, folder: &Path) -> Result<GappaBound> {
    let file = folder.join(format!("axis{axis}.g"));
    fs::write(&file, script(table, axis))?;
    let output = Command::new("gappa").arg(&file).output()?;
    // Results go to the standard error stream.
    let text = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "gappa: {text}");
    let mut bound = GappaBound::default();
    let mut answers = 0;
    for line in text.lines().filter(|line| line.contains(" in [")) {
        let (name, range) = line.trim().split_once(" in [").context("a bound")?;
        let largest = range
            .split([',', ']'])
            .filter_map(|part| dyadic(part.split_whitespace().next()?))
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        let target = match name.starts_with('p') {
            true => &mut bound.place,
            false => &mut bound.evaluation,
        };
        *target = target.max(largest);
        answers += 1;
    }
    ensure!(answers == table.cells.len() + 1, "gappa answered: {text}");
    Ok(bound)
}

/// `mantissa` or `mantissa b exponent`; Gappa's explanations in braces are something else.
fn dyadic(text: &str) -> Option<f64> {
    let (mantissa, exponent) = text.split_once('b').unwrap_or((text, "0"));
    let mantissa: i128 = mantissa.parse().ok()?;
    // Rounded upwards by a little, where the mantissa is longer than an f64 holds.
    Some(mantissa as f64 * 2.0_f64.powi(exponent.parse().ok()?) * (1.0 + f64::EPSILON))
}

/// Proves the theorem for any table with Gappa, and has Coq check that proof if it is there.
///
/// # Errors
/// The theorem is not proved, or Coq refuses the proof.
pub fn prove_generic(folder: &Path) -> Result<bool> {
    let file = folder.join("generic.g");
    fs::write(&file, generic_script())?;
    let output = Command::new("gappa").arg(&file).output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "gappa: {text}");
    let has_coq = Command::new("coqc").arg("--version").output().is_ok();
    if !has_coq {
        return Ok(false);
    }
    let proof = Command::new("gappa").arg("-Bcoq").arg(&file).output()?;
    fs::write(folder.join("generic.v"), &proof.stdout)?;
    let check = Command::new("coqc")
        .current_dir(folder)
        .arg("generic.v")
        .output()?;
    if !check.status.success() {
        bail!("coqc: {}", String::from_utf8_lossy(&check.stderr));
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_written_exactly() {
        for value in [1.0, -0.1, 80.0, f32::from_bits(1), 3e-39, -0.0] {
            let text = exactly(value);
            let (mantissa, exponent) = text.split_once('b').unwrap();
            let mantissa: f64 = mantissa.parse().unwrap();
            let read = mantissa * 2.0_f64.powi(exponent.parse().unwrap());
            assert_eq!(read, f64::from(value), "{text}");
        }
    }

    #[test]
    fn answers_are_read() {
        assert_eq!(dyadic("{-3.2e-06"), None);
        let value = dyadic("-43b-26").unwrap();
        assert!((value / -43.0 * 2.0_f64.powi(26) - 1.0).abs() < 1e-15);
    }
}
