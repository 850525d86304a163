//! Floating-point instructions in SMT-LIB's theory, rounding to nearest, ties to even.

use super::{Value, bits, float_bits};

pub(super) fn binary(op: &str, a: &str, b: &str) -> Option<String> {
    let op = match op {
        "fadd" => "fp.add",
        "fsub" => "fp.sub",
        "fmul" => "fp.mul",
        "fdiv" => "fp.div",
        _ => return None,
    };
    Some(format!("({op} RNE {a} {b})"))
}

/// `o..` is false and `u..` true where an operand is NaN.
pub(super) fn compare(predicate: &str, a: &str, b: &str) -> Option<String> {
    let unordered = format!("(or (fp.isNaN {a}) (fp.isNaN {b}))");
    let ordered = |name: &str| -> Option<String> {
        Some(match name {
            "eq" => format!("(fp.eq {a} {b})"),
            "gt" => format!("(fp.gt {a} {b})"),
            "ge" => format!("(fp.geq {a} {b})"),
            "lt" => format!("(fp.lt {a} {b})"),
            "le" => format!("(fp.leq {a} {b})"),
            "ne" => format!("(and (not {unordered}) (not (fp.eq {a} {b})))"),
            _ => return None,
        })
    };
    match predicate {
        "ord" => Some(format!("(not {unordered})")),
        "uno" => Some(unordered),
        "true" => Some("true".to_owned()),
        "false" => Some("false".to_owned()),
        _ => match predicate.split_at_checked(1)? {
            ("o", name) => ordered(name),
            ("u", name) => Some(format!("(or {unordered} {})", ordered(name)?)),
            _ => None,
        },
    }
}

/// Conversion to an integer that saturates and takes NaN to 0.
pub(super) fn saturating(signed: bool, width: u32, a: &str) -> Value {
    let (least, most) = if signed {
        (-(1_i128 << (width - 1)), (1_i128 << (width - 1)) - 1)
    } else {
        (0, (1_i128 << width) - 1)
    };
    let above = float_bits((most as f32).to_bits());
    let below = float_bits((least as f32).to_bits());
    let convert = if signed { "fp.to_sbv" } else { "fp.to_ubv" };
    // `most` rounds up to a power of two, so that all below it are in range.
    let inner = format!("((_ {convert} {width}) RTZ {a})");
    Value::Bits(
        width,
        format!(
            "(ite (fp.isNaN {a}) {zero} (ite (fp.geq {a} {above}) {most} \
             (ite (fp.leq {a} {below}) {least} {inner})))",
            zero = bits(width, 0),
            most = bits(width, most),
            least = bits(width, least),
        ),
    )
}

pub(super) fn from_integer(signed: bool, term: &str) -> Value {
    let convert = if signed { "to_fp" } else { "to_fp_unsigned" };
    Value::Float(format!("((_ {convert} 8 24) RNE {term})"))
}
