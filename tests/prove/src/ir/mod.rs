//! The subset of LLVM's textual intermediate code that the core compiles to.
//!
//! Whatever is not listed here is refused by the parser or by the translator: nothing is skipped
//! except metadata and the three intrinsics that mark scopes and lifetimes.

mod lexer;
mod parse;

pub use parse::parse_functions;

/// A first-class type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// An integer of this many bits.
    Int(u32),
    /// An IEEE binary32.
    Float,
    /// A pointer.
    Ptr,
}

impl Type {
    /// Size in memory \[bytes\]; pointers have none, since they are never stored.
    pub const fn bytes(self) -> Option<usize> {
        match self {
            Self::Int(bits) => Some(bits.div_ceil(8) as usize),
            Self::Float => Some(4),
            Self::Ptr => None,
        }
    }
}

/// What an instruction works on.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    /// A named value.
    Local(String),
    /// An integer or truth value.
    Int(i128),
    /// A float by its bits.
    Float(u32),
}

/// An instruction with a result or an effect; a type stands for its operands.
#[derive(Clone, Debug, PartialEq)]
pub enum Op {
    /// `fadd`, `fsub`, `fmul`, `fdiv`.
    FloatBinary(String, Operand, Operand),
    /// `fneg`.
    Negate(Operand),
    /// `fcmp` with its predicate.
    FloatCompare(String, Operand, Operand),
    /// `add`, `sub`, `and`, `or`, `xor` and so on, with the flags that make poison.
    IntBinary(String, Vec<String>, Type, Operand, Operand),
    /// `icmp` with its predicate; whether other signs than equal ones make poison.
    IntCompare(String, bool, Type, Operand, Operand),
    /// `select`.
    Select(Operand, Type, Operand, Operand),
    /// `zext`, `trunc`, `sitofp` and so on: flags, from, value, to.
    Cast(String, Vec<String>, Type, Operand, Type),
    /// `load`; atomic or not.
    Load(Type, Operand),
    /// `store`, atomic or not: type, value, pointer.
    Store(Type, Operand, Operand),
    /// `getelementptr` by a constant number of bytes.
    Offset(Operand, i128),
    /// `getelementptr` by a number of words that depends on data: address, type of the number,
    /// number.
    Words(Operand, Type, Operand),
    /// `fence` of the compiler alone; whether it is of the kind `release`.
    Fence(bool),
    /// `call` of an intrinsic: name, arguments, and the least number that the result is and the
    /// least above that it is not, where the compiler says so.
    Call(String, Vec<(Type, Operand)>, Option<(i128, i128)>),
    /// `phi`: value and block it comes from.
    Phi(Type, Vec<(Operand, String)>),
    /// `freeze`.
    Freeze(Type, Operand),
    /// `br label`.
    Jump(String),
    /// `br i1`.
    Branch(Operand, String, String),
    /// `ret`.
    Return(Option<(Type, Operand)>),
    /// `unreachable`.
    Unreachable,
}

/// An instruction, the name of its result, and its line for messages.
#[derive(Clone, Debug, PartialEq)]
pub struct Instruction {
    /// Name of the result.
    pub result: Option<String>,
    /// What is done.
    pub op: Op,
    /// The line it was read from.
    pub line: String,
}

/// Instructions up to a jump.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its label.
    pub label: String,
    /// Its instructions, the last of which leaves it.
    pub instructions: Vec<Instruction>,
}

/// A function that is defined in the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Name without `@`.
    pub name: String,
    /// Parameters: type and name.
    pub parameters: Vec<(Type, String)>,
    /// Blocks, the first of which is entered.
    pub blocks: Vec<Block>,
}

/// The module cannot be proved, because it holds something that is not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported {
    /// What.
    pub what: String,
    /// Where.
    pub line: String,
}

impl std::fmt::Display for Unsupported {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "not understood: {} in `{}`", self.what, self.line.trim())
    }
}

impl std::error::Error for Unsupported {}

impl Unsupported {
    pub(crate) fn new(what: impl Into<String>, line: &str) -> Self {
        Self {
            what: what.into(),
            line: line.to_owned(),
        }
    }
}
