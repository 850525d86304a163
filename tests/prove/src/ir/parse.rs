//! Reads function definitions line by line.

use super::lexer::Words;
use super::{Block, Function, Instruction, Op, Operand, Type, Unsupported};

/// Reads the functions whose names begin with `prefix`; others are not looked at.
///
/// # Errors
/// The first thing in one of them that is not understood.
pub fn parse_functions(text: &str, prefix: &str) -> Result<Vec<Function>, Unsupported> {
    let mut functions = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if !line.starts_with("define ") || !line.contains(&format!("@{prefix}")) {
            continue;
        }
        let mut function = header(line)?;
        for line in lines.by_ref().take_while(|line| *line != "}") {
            let label = label(line);
            if let Some(label) = label {
                function.blocks.push(Block {
                    label,
                    instructions: Vec::new(),
                });
            } else if let Some(instruction) = instruction(line)? {
                let block = function.blocks.last_mut();
                let block = block.ok_or_else(|| Unsupported::new("no label before", line))?;
                block.instructions.push(instruction);
            }
        }
        functions.push(function);
    }
    Ok(functions)
}

fn label(line: &str) -> Option<String> {
    let mut words = Words::new(line);
    let name = words.word().ok()?;
    (!line.starts_with(' ') && words.take(":")).then(|| name.trim_matches('"').to_owned())
}

fn header(line: &str) -> Result<Function, Unsupported> {
    let mut words = Words::new(line);
    let name = loop {
        if let Some(name) = words.word()?.strip_prefix('@') {
            break name.to_owned();
        }
    };
    words.expect("(")?;
    let mut parameters = Vec::new();
    while !words.take(")") {
        let (ty, operand) = words.typed()?;
        let Operand::Local(name) = operand else {
            return Err(words.error("parameter without a name"));
        };
        parameters.push((ty, name));
        words.take(",");
    }
    Ok(Function {
        name,
        parameters,
        blocks: Vec::new(),
    })
}

/// Marks that have no effect on values.
const MARKS: [&str; 3] = [
    "@llvm.experimental.noalias.scope.decl",
    "@llvm.lifetime.start.p0",
    "@llvm.lifetime.end.p0",
];

fn instruction(line: &str) -> Result<Option<Instruction>, Unsupported> {
    let mut words = Words::new(line);
    let Some(first) = words.peek() else {
        return Ok(None);
    };
    let mut result = None;
    if let Some(name) = first.strip_prefix('%') {
        result = Some(name.to_owned());
        words.word()?;
        words.expect("=")?;
    }
    let name = words.word()?;
    if matches!(name, "tail" | "call" | "notail") && MARKS.iter().any(|mark| line.contains(mark)) {
        return Ok(None);
    }
    Ok(Some(Instruction {
        op: operation(name, &mut words)?,
        result,
        line: line.to_owned(),
    }))
}

fn operation(name: &str, words: &mut Words) -> Result<Op, Unsupported> {
    let op = match name {
        "fadd" | "fsub" | "fmul" | "fdiv" => {
            let (a, b) = pair(words, Some(Type::Float))?.1;
            Op::FloatBinary(name.to_owned(), a, b)
        }
        "fneg" => Op::Negate(words.typed()?.1),
        "fcmp" => {
            let predicate = words.word()?.to_owned();
            let (a, b) = pair(words, Some(Type::Float))?.1;
            Op::FloatCompare(predicate, a, b)
        }
        "add" | "sub" | "mul" | "sdiv" | "and" | "or" | "xor" | "shl" | "lshr" | "ashr" => {
            let flags = words.flags(&["nuw", "nsw", "disjoint", "exact"]);
            let (ty, (a, b)) = pair(words, None)?;
            Op::IntBinary(name.to_owned(), flags, ty, a, b)
        }
        "icmp" => {
            let same_sign = words.take("samesign");
            let predicate = words.word()?.to_owned();
            let (ty, (a, b)) = pair(words, None)?;
            Op::IntCompare(predicate, same_sign, ty, a, b)
        }
        "select" => {
            let (condition_ty, condition) = words.typed()?;
            if condition_ty != Type::Int(1) {
                return Err(words.error("condition of another type"));
            }
            words.expect(",")?;
            let (ty, a) = words.typed()?;
            words.expect(",")?;
            let (other, b) = words.typed()?;
            if other != ty {
                return Err(words.error("types that differ"));
            }
            Op::Select(condition, ty, a, b)
        }
        "zext" | "sext" | "trunc" | "sitofp" | "uitofp" | "fptoui" | "fptosi" | "bitcast" => {
            let flags = words.flags(&["nneg", "nuw", "nsw"]);
            let (from, value) = words.typed()?;
            words.expect("to")?;
            Op::Cast(name.to_owned(), flags, from, value, words.ty()?)
        }
        "load" => {
            let is_atomic = words.take("atomic");
            let ty = words.ty()?;
            words.expect(",")?;
            let pointer = words.typed()?.1;
            order(words, is_atomic, ty)?;
            Op::Load(ty, pointer)
        }
        "store" => {
            let is_atomic = words.take("atomic");
            let (ty, value) = words.typed()?;
            words.expect(",")?;
            let pointer = words.typed()?.1;
            order(words, is_atomic, ty)?;
            Op::Store(ty, value, pointer)
        }
        "fence" => fence(words)?,
        "getelementptr" => address(words)?,
        "phi" => phi(words)?,
        "freeze" => {
            let (ty, value) = words.typed()?;
            Op::Freeze(ty, value)
        }
        "br" => branch(words)?,
        "ret" if words.take("void") => Op::Return(None),
        "ret" => Op::Return(Some(words.typed()?)),
        "unreachable" => Op::Unreachable,
        "tail" | "notail" => {
            words.expect("call")?;
            call(words)?
        }
        "call" => call(words)?,
        _ => return Err(words.error(format!("instruction `{name}`"))),
    };
    words.end()?;
    Ok(op)
}

/// The order of an atomic access: the one that orders nothing, and words only.
fn order(words: &mut Words, is_atomic: bool, ty: Type) -> Result<(), Unsupported> {
    if is_atomic {
        words.expect("monotonic")?;
        if ty != Type::Int(32) {
            return Err(words.error("an atomic access that is no word"));
        }
    }
    Ok(())
}

fn fence(words: &mut Words) -> Result<Op, Unsupported> {
    for word in ["syncscope", "(", "\"singlethread\"", ")"] {
        words.expect(word)?;
    }
    match words.word()? {
        "release" => Ok(Op::Fence(true)),
        "acquire" => Ok(Op::Fence(false)),
        _ => Err(words.error("a fence of this kind")),
    }
}

/// An address and how far from it: bytes if constant, words if it depends on data.
fn address(words: &mut Words) -> Result<Op, Unsupported> {
    words.flags(&["inbounds", "nuw", "nusw"]);
    // The library says that it has the size of the number it holds.
    let in_words = words.take("%\"core::sync::atomic::AtomicU32\"");
    if !in_words && words.ty()? != Type::Int(8) {
        return Err(words.error("an address not in bytes"));
    }
    words.expect(",")?;
    let base = words.typed()?.1;
    words.expect(",")?;
    match (words.typed()?, in_words) {
        ((_, Operand::Int(bytes)), false) => Ok(Op::Offset(base, bytes)),
        ((ty @ Type::Int(32), number), true) => Ok(Op::Words(base, ty, number)),
        _ => Err(words.error("an address that depends on data")),
    }
}

/// `ty a, b`
fn pair(
    words: &mut Words,
    expected: Option<Type>,
) -> Result<(Type, (Operand, Operand)), Unsupported> {
    let (ty, a) = words.typed()?;
    if expected.is_some_and(|expected| expected != ty) || ty == Type::Ptr {
        return Err(words.error("operands of this type"));
    }
    words.expect(",")?;
    Ok((ty, (a, words.operand(ty)?)))
}

fn call(words: &mut Words) -> Result<Op, Unsupported> {
    words.attributes()?;
    let range = words.take("range").then(|| range(words)).transpose()?;
    words.attributes()?;
    if !words.take("void") {
        words.ty()?;
    }
    let name = words.word()?;
    let name = name
        .strip_prefix('@')
        .ok_or_else(|| words.error("an indirect call"))?;
    words.expect("(")?;
    let mut arguments = Vec::new();
    while !words.take(")") {
        arguments.push(words.typed()?);
        words.take(",");
    }
    Ok(Op::Call(name.to_owned(), arguments, range))
}

/// `(ty low, high)`
fn range(words: &mut Words) -> Result<(i128, i128), Unsupported> {
    words.expect("(")?;
    let (_, low) = words.typed()?;
    words.expect(",")?;
    let high = words.operand(Type::Int(64))?;
    words.expect(")")?;
    match (low, high) {
        (Operand::Int(low), Operand::Int(high)) if low < high => Ok((low, high)),
        _ => Err(words.error("a range of this kind")),
    }
}

fn phi(words: &mut Words) -> Result<Op, Unsupported> {
    let ty = words.ty()?;
    let mut incoming = Vec::new();
    while words.take("[") {
        let value = words.operand(ty)?;
        words.expect(",")?;
        incoming.push((value, label_name(words)?));
        words.expect("]")?;
        words.take(",");
    }
    Ok(Op::Phi(ty, incoming))
}

fn branch(words: &mut Words) -> Result<Op, Unsupported> {
    if words.take("label") {
        return Ok(Op::Jump(label_name(words)?));
    }
    let (ty, condition) = words.typed()?;
    if ty != Type::Int(1) {
        return Err(words.error("condition of another type"));
    }
    let mut targets = Vec::new();
    while words.take(",") {
        words.expect("label")?;
        targets.push(label_name(words)?);
    }
    match <[String; 2]>::try_from(targets) {
        Ok([yes, no]) => Ok(Op::Branch(condition, yes, no)),
        Err(_) => Err(words.error("a branch without two targets")),
    }
}

fn label_name(words: &mut Words) -> Result<String, Unsupported> {
    let word = words.word()?;
    match word.strip_prefix('%') {
        Some(name) => Ok(name.trim_matches('"').to_owned()),
        None => Err(words.error("label")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(instruction: &str) -> Result<Vec<Function>, Unsupported> {
        let text = format!("define void @prove_x(float noundef %a) {{\nstart:\n{instruction}\n}}");
        parse_functions(&text, "prove_")
    }

    #[test]
    fn what_is_not_known_stops_the_proof() {
        for line in [
            "  %1 = fadd fast float %a, %a",
            "  %1 = fadd double %a, %a",
            "  %1 = fadd <2 x float> %a, %a",
            "  %1 = frem float %a, %a",
            "  %1 = getelementptr inbounds i8, ptr %a, i32 %b",
            "  %1 = load atomic i32, ptr %a seq_cst, align 4",
            "  %1 = load atomic i16, ptr %a monotonic, align 2",
            "  store atomic i32 1, ptr %a release, align 4",
            "  fence release",
            "  fence syncscope(\"singlethread\") seq_cst",
            "  %1 = getelementptr inbounds %\"a::B\", ptr %a, i32 %b",
            "  %1 = load volatile i32, ptr %a, align 4",
            "  switch i32 %a, label %b [",
            "  %1 = tail call float %f(float %a)",
            "  %1 = atomicrmw add ptr %a, i32 1 monotonic",
            "  %1 = alloca [80 x i8], align 8",
            "  %1 = icmp fast ult i32 %a, 4",
        ] {
            assert!(body(line).is_err(), "{line}");
        }
    }

    #[test]
    fn a_call_keeps_its_arguments() {
        let functions = body("  %1 = tail call noundef i32 @llvm.smax.i32(i32 %a, i32 0)").unwrap();
        assert_eq!(
            functions[0].blocks[0].instructions[0].op,
            Op::Call(
                "llvm.smax.i32".to_owned(),
                vec![
                    (Type::Int(32), Operand::Local("a".to_owned())),
                    (Type::Int(32), Operand::Int(0)),
                ],
                None
            )
        );
    }
}
