//! Instructions of several forms: integer arithmetic, conversions, intrinsics and phi.

use super::translate::State;
use super::{Value, bits, floats, integers};
use crate::ir::{Instruction, Operand, Type};

impl State {
    pub(super) fn int_binary(
        &mut self,
        instruction: &Instruction,
        op: &str,
        flags: &[String],
        ty: Type,
        a: &Operand,
        b: &Operand,
    ) -> Result<Value, String> {
        let (a, b) = (self.value(ty, a)?, self.term(ty, b)?);
        let first = a.term().ok_or("an address")?;
        match &a {
            Value::Bool(_) => {
                let disjoint = flags == ["disjoint"];
                if !(flags.is_empty() || op == "or" && disjoint)
                    || !matches!(op, "and" | "or" | "xor")
                {
                    return Err("operation on truth values".to_owned());
                }
                if disjoint {
                    self.demand(&instruction.line, &format!("(not (and {first} {b}))"));
                }
                Ok(Value::Bool(format!("({op} {first} {b})")))
            }
            Value::Bits(width, _) => {
                let checked = integers::binary(op, flags, *width, first, &b);
                let checked = checked.ok_or("integer operation")?;
                for term in &checked.demands {
                    self.demand(&instruction.line, term);
                }
                Ok(Value::Bits(*width, checked.term))
            }
            _ => Err("operands".to_owned()),
        }
    }

    pub(super) fn cast(
        &mut self,
        instruction: &Instruction,
        (name, flags): (&str, &[String]),
        (from, value): (Type, &Operand),
        to: Type,
    ) -> Result<Value, String> {
        let value = self.value(from, value)?;
        if name == "bitcast" {
            return self.reinterpret(value, to);
        }
        let term = value.term().ok_or("an address")?;
        let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
        Ok(match (name, &value, to, &flags[..]) {
            ("zext", Value::Bool(_), Type::Int(width), []) => Value::Bits(
                width,
                format!("(ite {term} {} {})", bits(width, 1), bits(width, 0)),
            ),
            ("zext" | "sext", Value::Bits(width, _), Type::Int(wide), [] | ["nneg"])
                if wide > *width =>
            {
                if flags == ["nneg"] {
                    let demand = format!("(bvsge {term} {})", bits(*width, 0));
                    self.demand(&instruction.line, &demand);
                }
                Value::Bits(wide, integers::extend(name == "sext", wide - width, term))
            }
            ("trunc", Value::Bits(width, _), Type::Int(narrow), [] | ["nuw"] | ["nuw", "nsw"])
                if narrow < *width =>
            {
                let cut = format!("((_ extract {} 0) {term})", narrow - 1);
                // Extended again, by zeros and by the sign, it must be the same number.
                for signed in [false, true].into_iter().take(flags.len()) {
                    let wide = integers::extend(signed, width - narrow, &cut);
                    self.demand(&instruction.line, &format!("(= {wide} {term})"));
                }
                match narrow {
                    1 => Value::Bool(format!("(= {cut} #b1)")),
                    _ => Value::Bits(narrow, cut),
                }
            }
            ("sitofp", Value::Bits(..), Type::Float, []) => floats::from_integer(true, term),
            ("uitofp", Value::Bits(width, _), Type::Float, [] | ["nneg"]) => {
                if flags == ["nneg"] {
                    let demand = format!("(bvsge {term} {})", bits(*width, 0));
                    self.demand(&instruction.line, &demand);
                }
                floats::from_integer(false, term)
            }
            _ => return Err(format!("cast `{name}`")),
        })
    }

    pub(super) fn call(
        &mut self,
        instruction: &Instruction,
        name: &str,
        arguments: &[(Type, Operand)],
    ) -> Result<Option<Value>, String> {
        let values = arguments
            .iter()
            .map(|(ty, operand)| self.value(*ty, operand))
            .collect::<Result<Vec<_>, _>>()?;
        let name = name.strip_prefix("llvm.").ok_or("a call")?;
        let parts: Vec<&str> = name.split('.').collect();
        let value = match (&parts[..], &values[..]) {
            (["fabs", "f32"], [Value::Float(a)]) => self.magnitude(a),
            (["copysign", "f32"], [Value::Float(a), Value::Float(b)]) => {
                // The sign of a NaN is not known.
                self.demand(&instruction.line, &format!("(not (fp.isNaN {b}))"));
                let size = format!("(fp.abs {a})");
                Value::Float(format!("(ite (fp.isNegative {b}) (fp.neg {size}) {size})"))
            }
            ([op @ ("fptosi" | "fptoui"), "sat", _, "f32"], [Value::Float(a)]) => {
                let width = parts[2]
                    .strip_prefix('i')
                    .and_then(|bits| bits.parse().ok());
                floats::saturating(*op == "fptosi", width.ok_or("width")?, a)
            }
            ([op, "sat", _], [Value::Bits(width, a), Value::Bits(_, b)]) => {
                let term = integers::saturating(op, *width, a, b);
                Value::Bits(*width, term.ok_or("saturating operation")?)
            }
            (
                [op @ ("smax" | "smin" | "umax" | "umin"), _],
                [Value::Bits(width, a), Value::Bits(_, b)],
            ) => {
                let compare = match *op {
                    "smax" => "bvsge",
                    "smin" => "bvsle",
                    "umax" => "bvuge",
                    _ => "bvule",
                };
                Value::Bits(*width, format!("(ite ({compare} {a} {b}) {a} {b})"))
            }
            (
                ["fshl", _],
                [
                    Value::Bits(width, a),
                    Value::Bits(_, b),
                    Value::Bits(_, shift),
                ],
            ) => {
                let size = bits(*width, i128::from(*width));
                // A shift by the whole width gives 0, so that none at all leaves the first.
                let left = format!("(bvurem {shift} {size})");
                let right = format!("(bvsub {size} {left})");
                let term = format!("(bvor (bvshl {a} {left}) (bvlshr {b} {right}))");
                Value::Bits(*width, term)
            }
            (["assume"], [Value::Bool(condition)]) => {
                let condition = condition.clone();
                self.demand(&instruction.line, &condition);
                return Ok(None);
            }
            _ => return Err(format!("a call of `{name}`")),
        };
        Ok(Some(value))
    }

    /// The result is poison unless it is at least the first and below the second number.
    pub(super) fn in_range(
        &mut self,
        instruction: &Instruction,
        value: &Value,
        (low, high): (i128, i128),
    ) -> Result<(), String> {
        let Value::Bits(width, term) = value else {
            return Err("a range of no integer".to_owned());
        };
        let (low, high) = (bits(*width, low), bits(*width, high));
        let term = format!("(and (bvsge {term} {low}) (bvslt {term} {high}))");
        self.demand(&instruction.line, &term);
        Ok(())
    }

    pub(super) fn phi(&self, ty: Type, incoming: &[(Operand, String)]) -> Result<Value, String> {
        let edges = self
            .edges
            .get(&self.label)
            .ok_or("a phi in the first block")?;
        let mut merged: Option<Value> = None;
        for (from, condition) in edges {
            let entry = incoming.iter().find(|(_, label)| label == from);
            let value = self.value(ty, &entry.ok_or("a phi without an edge")?.0)?;
            merged = Some(match merged {
                None => value,
                Some(others) => value.named(format!(
                    "(ite {condition} {} {})",
                    value.term().ok_or("an address")?,
                    others.term().ok_or("an address")?
                )),
            });
        }
        merged.ok_or_else(|| "a phi without edges".to_owned())
    }
}
