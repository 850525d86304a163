//! What one function and all it calls consist of.

use crate::{Arithmetic, CallGraph, Error, Flow, Image};

/// An instruction of a kernel, with the function it is in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Site {
    /// The function.
    pub function: String,
    /// Where.
    pub address: u64,
    /// The instruction.
    pub text: String,
}

/// A function, and the functions it calls, taken apart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Kernel {
    /// The function's name.
    pub name: String,
    /// Every function that is called, directly or not.
    pub callees: Vec<String>,
    /// Instructions, of all functions together.
    pub instructions: usize,
    /// Instructions in IT blocks: they take their place in time whether carried out or not.
    pub predicated: usize,
    /// Branches that are taken or not.
    pub branches: Vec<Site>,
    /// Branches backwards, and jumps through a table.
    pub loops: Vec<Site>,
    /// Divisions and square roots.
    pub divisions: Vec<Site>,
    /// Fused multiplications and additions.
    pub fused: Vec<Site>,
    /// Multiplications and additions in one instruction, with two roundings.
    pub chained: Vec<Site>,
    /// Double precision.
    pub doubles: Vec<Site>,
    /// Worst-case stack \[bytes\].
    pub stack: u32,
}

impl Kernel {
    /// Takes the function of a name apart.
    ///
    /// # Errors
    /// There is no such function, it calls through a register, or it recurses.
    pub fn read(image: &Image, name: &str) -> Result<Self, Error> {
        let root = image.named(name)?;
        let graph = CallGraph::from(image, root.address, |_| false)?;
        let mut kernel = Self {
            name: name.to_owned(),
            stack: graph.deepest_stack()?.bytes,
            ..Self::default()
        };
        for function in graph.functions() {
            if function.address != root.address {
                kernel.callees.push(function.name.clone());
            }
            for instruction in &function.instructions {
                kernel.instructions += 1;
                let site = || Site {
                    function: function.name.clone(),
                    address: instruction.address,
                    text: instruction.text.clone(),
                };
                match (instruction.conditional, instruction.flow) {
                    (true, Flow::Next) => kernel.predicated += 1,
                    (true, _) => kernel.branches.push(site()),
                    (false, _) => {}
                }
                match instruction.flow {
                    Flow::Jump(target) if target <= instruction.address => {
                        kernel.loops.push(site())
                    }
                    Flow::Table => kernel.loops.push(site()),
                    _ => {}
                }
                match instruction.arithmetic {
                    Arithmetic::Other => {}
                    Arithmetic::Division => kernel.divisions.push(site()),
                    Arithmetic::Fused => kernel.fused.push(site()),
                    Arithmetic::Chained => kernel.chained.push(site()),
                    Arithmetic::Double => kernel.doubles.push(site()),
                }
            }
        }
        Ok(kernel)
    }
}
