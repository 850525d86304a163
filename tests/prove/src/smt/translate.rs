//! Executes a function symbolically: every value becomes a definition in SMT-LIB.
//!
//! Control flow must not loop. Blocks are visited in an order in which every block follows those
//! that lead to it; a store counts where the condition of its block holds, a phi selects by the
//! conditions of the edges. Nothing else changes memory meanwhile. NaNs carry no payload: where the bits of a float are read, they are any
//! bits that stand for the float, which is more than the machine does and so proves no less;
//! but a magnitude has no sign bit, NaN or not.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use super::accesses::Counts;
use super::memory::{FieldType, Memory, Object};
use super::{Address, Value, bits, float_bits, floats, integers};
use crate::ir::{Block, Function, Instruction, Op, Operand, Type, Unsupported};

/// A function in SMT-LIB.
#[derive(Clone, Debug, Default)]
pub struct Translation {
    /// Declarations of the inputs: `temp_c`, `state.age` and so on.
    pub inputs: String,
    /// Definitions of every value, and of the outputs: `result`, `state'.age` and so on.
    pub body: String,
    /// Declarations of the outputs, for queries without the code.
    pub outputs: String,
    /// What must hold lest the behaviour be undefined: the line of code, and the term.
    pub demands: Vec<(String, String)>,
}

/// Translates `function`, whose pointer parameters point to `objects` of the same names.
///
/// # Errors
/// Anything that has no exact counterpart here.
pub fn translate(function: &Function, objects: &[Object]) -> Result<Translation, Unsupported> {
    let mut state = State::default();
    let mut code = function.blocks.iter().flat_map(|block| &block.instructions);
    if code.any(|instruction| instruction.op == Op::Fence(true)) {
        state.stores = Some(<[Counts; 2]>::default());
    }
    for (ty, name) in &function.parameters {
        let value = state.parameter(*ty, name, objects)?;
        state.values.insert(name.clone(), value);
    }
    for block in in_order(&function.blocks)? {
        state.block(block, is_always_reached(&function.blocks, &block.label))?;
    }
    state.outputs(function, objects)?;
    Ok(state.out)
}

#[derive(Default)]
pub(super) struct State {
    pub(super) out: Translation,
    values: HashMap<String, Value>,
    pub(super) memory: Memory,
    objects: HashMap<String, usize>,
    /// How often fields are stored before and after a release fence, by object and offset; once
    /// there is one in the function.
    pub(super) stores: Option<[Counts; 2]>,
    pub(super) is_released: bool,
    /// Conditions of the edges into a block, with the block they come from.
    pub(super) edges: HashMap<String, Vec<(String, String)>>,
    /// The most that a value can be, for those that are masked.
    pub(super) most: HashMap<String, usize>,
    /// Condition of the present block.
    pub(super) here: String,
    pub(super) label: String,
    result: Option<Value>,
    /// Results of `fabs`, whose sign bit is clear even where they are NaN.
    magnitudes: HashSet<String>,
    count: usize,
}

/// Blocks so that each follows all that lead to it.
fn in_order(blocks: &[Block]) -> Result<Vec<&Block>, Unsupported> {
    let mut ordered: Vec<&Block> = Vec::new();
    while ordered.len() < blocks.len() {
        let done = |label: &str| ordered.iter().any(|block| block.label == label);
        let ready = blocks.iter().find(|block| {
            !done(&block.label)
                && blocks
                    .iter()
                    .filter(|from| targets(from).contains(&block.label.as_str()))
                    .all(|from| done(&from.label))
        });
        ordered.push(ready.ok_or_else(|| Unsupported::new("a loop", &blocks[0].label))?);
    }
    Ok(ordered)
}

/// Whether there is no way around the block of this label.
fn is_always_reached(blocks: &[Block], label: &str) -> bool {
    let mut seen = HashSet::from([label]);
    let mut next = vec![blocks[0].label.as_str()];
    while let Some(at) = next.pop() {
        if seen.insert(at) {
            let block = blocks.iter().find(|block| block.label == at);
            let targets = block.map(targets).unwrap_or_default();
            if targets.is_empty() {
                return false;
            }
            next.extend(targets);
        }
    }
    true
}

fn targets(block: &Block) -> Vec<&str> {
    match block.instructions.last().map(|last| &last.op) {
        Some(Op::Jump(to)) => vec![to],
        Some(Op::Branch(_, yes, no)) => vec![yes, no],
        _ => Vec::new(),
    }
}

pub(super) fn and(terms: &[&str]) -> String {
    let terms: Vec<&str> = terms
        .iter()
        .copied()
        .filter(|&term| term != "true")
        .collect();
    match terms[..] {
        [] => "true".to_owned(),
        [one] => one.to_owned(),
        _ => format!("(and {})", terms.join(" ")),
    }
}

impl State {
    fn parameter(
        &mut self,
        ty: Type,
        name: &str,
        objects: &[Object],
    ) -> Result<Value, Unsupported> {
        if ty != Type::Ptr {
            return self.input(name, ty);
        }
        let object = objects.iter().find(|object| object.name == name);
        let object = object.ok_or_else(|| Unsupported::new("a pointer to nothing known", name))?;
        let number = self.memory.add();
        self.objects.insert(object.name.clone(), number);
        for field in object.fields.iter().filter(|_| object.readable) {
            let path = format!("{}.{}", object.name, field.name);
            let value = match field.ty {
                FieldType::Pointer(target) => self.parameter(Type::Ptr, target, objects)?,
                ty => self.input(&path, ty.in_memory())?,
            };
            if let (FieldType::Bool, Value::Bits(_, term)) = (field.ty, &value) {
                // The language allows no other bytes.
                writeln!(self.out.inputs, "(assert (bvule {term} {}))", bits(8, 1)).ok();
            }
            let stored = self.memory.store((number, field.offset), value);
            stored.map_err(|what| Unsupported::new(what, &path))?;
        }
        Ok(Value::Address(Address {
            object: number,
            offset: 0,
            words: None,
        }))
    }

    fn input(&mut self, name: &str, ty: Type) -> Result<Value, Unsupported> {
        let term = format!("|{name}|");
        let value = match ty {
            Type::Int(1) => Value::Bool(term),
            Type::Int(width) => Value::Bits(width, term),
            Type::Float => Value::Float(term),
            Type::Ptr => return Err(Unsupported::new("a pointer as input", name)),
        };
        let sort = value.sort().unwrap_or_default();
        writeln!(self.out.inputs, "(declare-const |{name}| {sort})").ok();
        Ok(value)
    }

    pub(super) fn define(&mut self, value: &Value) -> Value {
        let (Some(sort), Some(term)) = (value.sort(), value.term()) else {
            return value.clone();
        };
        if self.magnitudes.contains(term) {
            return value.clone();
        }
        self.count += 1;
        let name = format!("v{}", self.count);
        writeln!(self.out.body, "(define-fun {name} () {sort} {term})").ok();
        value.named(name)
    }

    /// The magnitude of a float.
    pub(super) fn magnitude(&mut self, term: &str) -> Value {
        let value = self.define(&Value::Float(format!("(fp.abs {term})")));
        self.magnitudes.extend(value.term().map(str::to_owned));
        value
    }

    fn block(&mut self, block: &Block, is_always_reached: bool) -> Result<(), Unsupported> {
        self.label.clone_from(&block.label);
        self.here = match self.edges.get(&block.label) {
            _ if is_always_reached => "true".to_owned(),
            None => "true".to_owned(),
            Some(edges) if edges.len() == 1 => edges[0].1.clone(),
            // Where both ways of a choice meet again.
            Some(edges) if edges.len() == 2 && edges[1].1 == format!("(not {})", edges[0].1) => {
                "true".to_owned()
            }
            Some(edges) => {
                let terms: Vec<&str> = edges.iter().map(|(_, term)| term.as_str()).collect();
                format!("(or {})", terms.join(" "))
            }
        };
        for instruction in &block.instructions {
            let value = self
                .execute(instruction)
                .map_err(|what| Unsupported::new(what, &instruction.line))?;
            match (&instruction.result, value) {
                (Some(name), Some(value)) => {
                    let value = self.define(&value);
                    self.values.insert(name.clone(), value);
                    self.note_most(name, &instruction.op);
                }
                (None, None) => {}
                _ => return Err(Unsupported::new("result", &instruction.line)),
            }
        }
        Ok(())
    }

    pub(super) fn demand(&mut self, what: &str, term: &str) {
        let term = format!("(=> {} {term})", self.here);
        self.out.demands.push((what.trim().to_owned(), term));
    }

    pub(super) fn value(&self, ty: Type, operand: &Operand) -> Result<Value, String> {
        let value = match (operand, ty) {
            (Operand::Local(name), _) => {
                let value = self.values.get(name);
                value
                    .ok_or_else(|| format!("%{name} before it is known"))?
                    .clone()
            }
            (Operand::Int(value), Type::Int(1)) => Value::Bool((*value != 0).to_string()),
            (Operand::Int(value), Type::Int(width)) => Value::Bits(width, bits(width, *value)),
            (Operand::Float(value), Type::Float) => Value::Float(float_bits(*value)),
            _ => return Err("a constant of this type".to_owned()),
        };
        if value.is(ty) {
            Ok(value)
        } else {
            Err("an operand of another type".to_owned())
        }
    }

    pub(super) fn term(&self, ty: Type, operand: &Operand) -> Result<String, String> {
        let value = self.value(ty, operand)?;
        value
            .term()
            .map(str::to_owned)
            .ok_or_else(|| "an address".to_owned())
    }

    fn execute(&mut self, instruction: &Instruction) -> Result<Option<Value>, String> {
        let float = Type::Float;
        let value = match &instruction.op {
            Op::FloatBinary(op, a, b) => {
                let term = floats::binary(op, &self.term(float, a)?, &self.term(float, b)?);
                Value::Float(term.ok_or("float operation")?)
            }
            Op::Negate(a) => Value::Float(format!("(fp.neg {})", self.term(float, a)?)),
            Op::FloatCompare(predicate, a, b) => {
                let term = floats::compare(predicate, &self.term(float, a)?, &self.term(float, b)?);
                Value::Bool(term.ok_or("float comparison")?)
            }
            Op::IntBinary(op, flags, ty, a, b) => {
                self.int_binary(instruction, op, flags, *ty, a, b)?
            }
            Op::IntCompare(predicate, same_sign, ty, a, b) => {
                if *ty == Type::Int(1) {
                    return Err("comparison of truth values".to_owned());
                }
                let (a, b) = (self.term(*ty, a)?, self.term(*ty, b)?);
                if let (true, Type::Int(width)) = (*same_sign, *ty) {
                    let demand = format!("(bvsge (bvxor {a} {b}) {})", bits(width, 0));
                    self.demand(&instruction.line, &demand);
                }
                let term = integers::compare(predicate, &a, &b);
                Value::Bool(term.ok_or("integer comparison")?)
            }
            Op::Select(condition, ty, a, b) => {
                let condition = self.term(Type::Int(1), condition)?;
                let (yes, no) = (self.value(*ty, a)?, self.term(*ty, b)?);
                let term = format!("(ite {condition} {} {no})", yes.term().unwrap_or_default());
                yes.named(term)
            }
            Op::Cast(name, flags, from, value, to) => {
                self.cast(instruction, (name, flags), (*from, value), *to)?
            }
            Op::Load(ty, pointer) => self.load(*ty, pointer)?,
            Op::Store(ty, value, pointer) => {
                self.store(*ty, value, pointer)?;
                return Ok(None);
            }
            Op::Offset(base, bytes) => self.offset(base, *bytes)?,
            Op::Words(base, ty, number) => self.words(base, *ty, number)?,
            Op::Fence(is_release) => {
                self.fence(instruction, *is_release)?;
                return Ok(None);
            }
            Op::Call(name, arguments, range) => {
                let result = self.call(instruction, name, arguments)?;
                if let (Some(value), Some(range)) = (&result, range) {
                    self.in_range(instruction, value, *range)?;
                }
                return Ok(result);
            }
            Op::Phi(ty, incoming) => self.phi(*ty, incoming)?,
            Op::Freeze(ty, value) => self.value(*ty, value)?,
            Op::Jump(to) => {
                let here = self.here.clone();
                self.edge(to, here);
                return Ok(None);
            }
            Op::Branch(condition, yes, no) => {
                let condition = self.term(Type::Int(1), condition)?;
                self.edge(yes, and(&[&self.here, &condition]));
                self.edge(no, and(&[&self.here, &format!("(not {condition})")]));
                return Ok(None);
            }
            Op::Return(None) => return Ok(None),
            Op::Return(Some((ty, value))) => {
                let value = self.value(*ty, value)?;
                self.result = Some(match &self.result {
                    None => value,
                    Some(earlier) => value.named(format!(
                        "(ite {} {} {})",
                        self.here,
                        value.term().ok_or("an address")?,
                        earlier.term().ok_or("an address")?
                    )),
                });
                return Ok(None);
            }
            Op::Unreachable => {
                self.demand("unreachable", "false");
                return Ok(None);
            }
        };
        Ok(Some(value))
    }

    fn edge(&mut self, to: &str, condition: String) {
        let edges = self.edges.entry(to.to_owned()).or_default();
        edges.push((self.label.clone(), condition));
    }

    /// The same bytes as another type.
    pub(super) fn reinterpret(&mut self, value: Value, ty: Type) -> Result<Value, String> {
        match (&value, ty) {
            _ if value.is(ty) => Ok(value),
            (Value::Bits(32, term), Type::Float) => {
                Ok(Value::Float(format!("((_ to_fp 8 24) {term})")))
            }
            (Value::Float(term), Type::Int(32)) => {
                self.count += 1;
                let name = format!("bits{}", self.count);
                writeln!(
                    self.out.body,
                    "(declare-const {name} (_ BitVec 32))\n\
                     (assert (= ((_ to_fp 8 24) {name}) {term}))"
                )
                .ok();
                if self.magnitudes.contains(term) {
                    let sign = format!("((_ extract 31 31) {name})");
                    writeln!(self.out.body, "(assert (= {sign} #b0))").ok();
                }
                Ok(Value::Bits(32, name))
            }
            _ => Err("bytes read as another type".to_owned()),
        }
    }

    fn outputs(&mut self, function: &Function, objects: &[Object]) -> Result<(), Unsupported> {
        let fail = |what: String| Unsupported::new(what, &function.name);
        if let Some(value) = self.result.take() {
            self.output("result", &value);
        }
        for object in objects {
            let Some(&object_number) = self.objects.get(&object.name) else {
                continue;
            };
            for field in &object.fields {
                let ty = field.ty.in_memory();
                let value = self.memory.load((object_number, field.offset), ty);
                let value = value.map_err(fail)?;
                let value = self.reinterpret(value, ty).map_err(fail)?;
                self.output(&format!("{}'.{}", object.name, field.name), &value);
                for (number, when) in [(0, "before"), (1, "after")] {
                    if let Some(count) = self.count_of(number, (object_number, field.offset)) {
                        self.output(&format!("{when}.{}.{}", object.name, field.name), &count);
                    }
                }
            }
        }
        Ok(())
    }

    fn output(&mut self, name: &str, value: &Value) {
        if let (Some(sort), Some(term)) = (value.sort(), value.term()) {
            writeln!(self.out.body, "(define-fun |{name}| () {sort} {term})").ok();
            writeln!(self.out.outputs, "(declare-const |{name}| {sort})").ok();
        }
    }
}
