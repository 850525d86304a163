//! Seeded bugs: the translated code with one instruction changed.
//!
//! They are made by kind of instruction, not by place, so that they follow the code as it changes.

use crate::ir::{Function, Op, Operand, Type};

/// A function with a bug.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// What was changed, and the line it was changed in.
    pub name: String,
    /// The function.
    pub function: Function,
}

/// Every single change of the kinds below.
pub fn mutants(function: &Function) -> Vec<Mutant> {
    let mut mutants: Vec<Mutant> = nan_accepted(function).into_iter().collect();
    for (number, block) in function.blocks.iter().enumerate() {
        for (place, instruction) in block.instructions.iter().enumerate() {
            for (what, op) in changes(&instruction.op) {
                let mut changed = function.clone();
                changed.blocks[number].instructions[place].op = op;
                let line = instruction.line.split(", !").next().unwrap_or_default();
                mutants.push(Mutant {
                    name: format!("{what}: {}", line.trim()),
                    function: changed,
                });
            }
        }
    }
    mutants
}

/// Every comparison true of NaN: where two of them guard each other, one alone shows nothing.
fn nan_accepted(function: &Function) -> Option<Mutant> {
    let mut changed = function.clone();
    for instruction in changed
        .blocks
        .iter_mut()
        .flat_map(|block| &mut block.instructions)
    {
        if let Op::FloatCompare(predicate, ..) = &mut instruction.op {
            predicate.replace_range(..1, "u");
        }
    }
    (changed != *function).then(|| Mutant {
        name: "NaN passes all comparisons".to_owned(),
        function: changed,
    })
}

fn changes(op: &Op) -> Vec<(&'static str, Op)> {
    match op {
        Op::FloatCompare(predicate, a, b) => {
            let compare =
                |predicate: &str| Op::FloatCompare(predicate.to_owned(), a.clone(), b.clone());
            let mut found = Vec::new();
            if let Some(other) = swapped(predicate, [("gt", "ge"), ("lt", "le")]) {
                found.push(("comparison off by equality", compare(&other)));
            }
            let (order, name) = predicate.split_at(1);
            let other = if order == "o" { "u" } else { "o" };
            found.push((
                "NaN passes the comparison",
                compare(&format!("{other}{name}")),
            ));
            found
        }
        Op::IntCompare(predicate, same_sign, ty, a, b) => {
            let compare = |predicate: &str| {
                Op::IntCompare(predicate.to_owned(), *same_sign, *ty, a.clone(), b.clone())
            };
            let mut found = Vec::new();
            if let Some(other) = swapped(predicate, [("gt", "ge"), ("lt", "le")]) {
                found.push(("comparison off by one", compare(&other)));
            }
            if let Some(other) = swapped(predicate, [("gt", "lt"), ("ge", "le")]) {
                found.push(("comparison the wrong way round", compare(&other)));
            }
            found
        }
        Op::Select(_, ty, a, b) => [("clamp or choice left out", 0), ("choice always made", 1)]
            .map(|(what, value)| {
                (
                    what,
                    Op::Select(Operand::Int(value), *ty, a.clone(), b.clone()),
                )
            })
            .into(),
        Op::IntBinary(name, flags, Type::Int(1), a, b) if name == "and" || name == "or" => {
            let other = if name == "and" { "or" } else { "and" };
            let swapped = |flags: &[String]| {
                Op::IntBinary(
                    other.to_owned(),
                    flags.to_vec(),
                    Type::Int(1),
                    a.clone(),
                    b.clone(),
                )
            };
            let none = flags.is_empty();
            none.then(|| ("and for or", swapped(&[])))
                .into_iter()
                .collect()
        }
        Op::IntBinary(name, flags, ty, a, b)
            if matches!(name.as_str(), "add" | "sub") && flags.is_empty() =>
        {
            let other = if name == "add" { "sub" } else { "add" };
            let op = Op::IntBinary(other.to_owned(), Vec::new(), *ty, a.clone(), b.clone());
            vec![("the wrong sign", op)]
        }
        Op::Call(name, arguments, _) if name.contains(".sat.i") && arguments.len() == 2 => {
            let plain = if name.contains("add") { "add" } else { "sub" };
            let (ty, a) = arguments[0].clone();
            let b = arguments[1].1.clone();
            let op = Op::IntBinary(plain.to_owned(), Vec::new(), ty, a, b);
            vec![("overflow wraps", op)]
        }
        Op::Store(Type::Int(32), value @ Operand::Local(_), pointer) => vec![(
            "zero kept instead of the value",
            Op::Store(Type::Int(32), Operand::Int(0), pointer.clone()),
        )]
        .into_iter()
        .filter(|_| *value != Operand::Int(0))
        .collect(),
        _ => Vec::new(),
    }
}

/// The predicate with its last two letters replaced, either way.
fn swapped(predicate: &str, pairs: [(&str, &str); 2]) -> Option<String> {
    let (sign, name) = predicate.split_at_checked(predicate.len().checked_sub(2)?)?;
    pairs.iter().find_map(|&(a, b)| match name {
        _ if name == a => Some(format!("{sign}{b}")),
        _ if name == b => Some(format!("{sign}{a}")),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predicates_are_swapped_both_ways() {
        let pairs = [("gt", "ge"), ("lt", "le")];
        assert_eq!(swapped("ogt", pairs).as_deref(), Some("oge"));
        assert_eq!(swapped("ule", pairs).as_deref(), Some("ult"));
        assert_eq!(swapped("eq", pairs), None);
    }
}
