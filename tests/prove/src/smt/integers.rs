//! Integer instructions in SMT-LIB's theory of bit vectors.

use super::bits;

/// The result, and the terms that must hold lest it be poison.
pub(super) struct Checked {
    pub(super) term: String,
    pub(super) demands: Vec<String>,
}

pub(super) fn binary(op: &str, flags: &[String], width: u32, a: &str, b: &str) -> Option<Checked> {
    let name = match op {
        "add" => "bvadd",
        "sub" => "bvsub",
        "mul" => "bvmul",
        "sdiv" => "bvsdiv",
        "and" => "bvand",
        "or" => "bvor",
        "xor" => "bvxor",
        "shl" => "bvshl",
        "lshr" => "bvlshr",
        "ashr" => "bvashr",
        _ => return None,
    };
    let term = format!("({name} {a} {b})");
    let mut demands = Vec::new();
    if matches!(op, "shl" | "lshr" | "ashr") {
        demands.push(format!("(bvult {b} {})", bits(width, i128::from(width))));
    }
    if op == "sdiv" {
        let least = bits(width, 1 << (width - 1));
        demands.push(format!("(distinct {b} {})", bits(width, 0)));
        let ends = format!("(and (= {a} {least}) (= {b} {}))", bits(width, -1));
        demands.push(format!("(not {ends})"));
    }
    for flag in flags {
        demands.push(match (op, flag.as_str()) {
            ("or", "disjoint") => format!("(= (bvand {a} {b}) {})", bits(width, 0)),
            // Shifted back, it must be the same number.
            ("shl", "nuw") => format!("(= (bvlshr {term} {b}) {a})"),
            ("shl", "nsw") => format!("(= (bvashr {term} {b}) {a})"),
            ("add" | "sub" | "mul", "nsw" | "nuw") => {
                let signed = flag == "nsw";
                let extra = if op == "mul" { width } else { 1 };
                let wide = |x: &str| extend(signed, extra, x);
                format!(
                    "(= ({name} {} {}) {})",
                    wide(a),
                    wide(b),
                    extend(signed, extra, &term)
                )
            }
            _ => return None,
        });
    }
    Some(Checked { term, demands })
}

pub(super) fn extend(signed: bool, extra: u32, term: &str) -> String {
    let name = if signed { "sign_extend" } else { "zero_extend" };
    format!("((_ {name} {extra}) {term})")
}

pub(super) fn compare(predicate: &str, a: &str, b: &str) -> Option<String> {
    Some(match predicate {
        "eq" => format!("(= {a} {b})"),
        "ne" => format!("(distinct {a} {b})"),
        "sgt" => format!("(bvsgt {a} {b})"),
        "sge" => format!("(bvsge {a} {b})"),
        "slt" => format!("(bvslt {a} {b})"),
        "sle" => format!("(bvsle {a} {b})"),
        "ugt" => format!("(bvugt {a} {b})"),
        "uge" => format!("(bvuge {a} {b})"),
        "ult" => format!("(bvult {a} {b})"),
        "ule" => format!("(bvule {a} {b})"),
        _ => return None,
    })
}

/// Addition or subtraction that stops at the ends of the range.
pub(super) fn saturating(name: &str, width: u32, a: &str, b: &str) -> Option<String> {
    let (op, signed) = match name {
        "sadd" => ("bvadd", true),
        "ssub" => ("bvsub", true),
        "uadd" => ("bvadd", false),
        "usub" => ("bvsub", false),
        _ => return None,
    };
    let exact = format!("({op} {} {})", extend(signed, 2, a), extend(signed, 2, b));
    let (least, most) = if signed {
        (-(1_i128 << (width - 1)), (1_i128 << (width - 1)) - 1)
    } else {
        (0, (1_i128 << width) - 1)
    };
    Some(format!(
        "(ite (bvsgt {exact} {}) {} (ite (bvslt {exact} {}) {} ({op} {a} {b})))",
        bits(width + 2, most),
        bits(width, most),
        bits(width + 2, least),
        bits(width, least),
    ))
}
