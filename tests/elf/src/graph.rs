//! Who calls whom, and how deep the stack gets.

use std::collections::{BTreeMap, BTreeSet};

use crate::{Error, Flow, Function, Image, Instruction, Stack};

/// The functions that can be reached from one, with what each of them calls.
///
/// Paths that end the program because it failed are left out: see [`is_failure_path`].
///
/// [`is_failure_path`]: crate::is_failure_path
#[derive(Debug)]
pub struct CallGraph<'i> {
    nodes: BTreeMap<u64, Node<'i>>,
    root: u64,
}

/// The deepest stack, and how it comes about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Depth<'i> {
    /// Bytes of stack.
    pub bytes: u32,
    /// The functions on the way there, with the bytes each takes.
    pub path: Vec<(&'i str, u32)>,
}

#[derive(Debug)]
struct Node<'i> {
    function: &'i Function,
    callees: BTreeSet<u64>,
    /// Bytes of stack the function takes for itself, on any path.
    frame: u32,
}

impl<'i> CallGraph<'i> {
    /// Follows all calls from the function at `root`, but into functions for which `is_cut` holds.
    ///
    /// # Errors
    /// A call through a register, a branch out of the code, or a stack pointer that is set in an
    /// unknown way.
    pub fn from(image: &'i Image, root: u64, is_cut: fn(&str) -> bool) -> Result<Self, Error> {
        let mut nodes = BTreeMap::new();
        let mut waiting = vec![root];
        while let Some(address) = waiting.pop() {
            let Some(function) = image.at(address) else {
                return Err(Error::Name {
                    name: format!("{address:#x}"),
                    found: 0,
                });
            };
            if nodes.contains_key(&function.address) {
                continue;
            }
            let mut callees = BTreeSet::new();
            let mut frame = 0;
            for instruction in &function.instructions {
                callees.extend(callee(image, function, instruction, is_cut)?);
                frame += sinking(function, instruction)?;
            }
            waiting.extend(&callees);
            let node = Node {
                function,
                callees,
                frame,
            };
            nodes.insert(function.address, node);
        }
        Ok(Self { nodes, root })
    }

    /// The functions, the root among them.
    pub fn functions(&self) -> impl Iterator<Item = &'i Function> {
        self.nodes.values().map(|node| node.function)
    }

    /// The most stack the root and all it calls can take.
    ///
    /// An upper bound: all that a function ever pushes counts, even where it does not do all of
    /// it on the way to the call.
    ///
    /// # Errors
    /// Recursion: there is no bound.
    pub fn deepest_stack(&self) -> Result<Depth<'i>, Error> {
        let mut done = BTreeMap::new();
        self.deepest(self.root, &mut Vec::new(), &mut done)?;
        let mut path = Vec::new();
        let mut here = Some(self.root);
        while let Some(node) = here.and_then(|address| self.nodes.get(&address)) {
            path.push((node.function.name.as_str(), node.frame));
            here = node
                .callees
                .iter()
                .copied()
                .max_by_key(|callee| done.get(callee));
        }
        let bytes = done.get(&self.root).copied().unwrap_or_default();
        Ok(Depth { bytes, path })
    }

    fn deepest(
        &self,
        address: u64,
        callers: &mut Vec<u64>,
        done: &mut BTreeMap<u64, u32>,
    ) -> Result<u32, Error> {
        if let Some(depth) = done.get(&address) {
            return Ok(*depth);
        }
        if let Some(start) = callers.iter().position(|caller| *caller == address) {
            let circle = callers.iter().skip(start).chain([&address]);
            let names = circle.filter_map(|address| self.nodes.get(address));
            return Err(Error::Recursion(
                names.map(|node| node.function.name.clone()).collect(),
            ));
        }
        let Some(node) = self.nodes.get(&address) else {
            return Ok(0);
        };
        callers.push(address);
        let mut below = 0;
        for callee in &node.callees {
            below = below.max(self.deepest(*callee, callers, done)?);
        }
        callers.pop();
        done.insert(address, node.frame + below);
        Ok(node.frame + below)
    }
}

/// The function an instruction calls or jumps to, if it leaves its own.
fn callee(
    image: &Image,
    function: &Function,
    instruction: &Instruction,
    is_cut: fn(&str) -> bool,
) -> Result<Option<u64>, Error> {
    let own = function.address..function.address + function.size;
    let target = match instruction.flow {
        Flow::Call(target) => target,
        Flow::Jump(target) if !own.contains(&target) => target,
        Flow::Indirect => {
            return Err(Error::Indirect {
                function: function.name.clone(),
                instruction: instruction.text.clone(),
                address: instruction.address,
            });
        }
        _ => return Ok(None),
    };
    match image.at(target) {
        Some(callee) if is_cut(&callee.name) => Ok(None),
        Some(callee) => Ok(Some(callee.address)),
        None => Err(Error::Target {
            function: function.name.clone(),
            instruction: instruction.text.clone(),
            address: instruction.address,
        }),
    }
}

fn sinking(function: &Function, instruction: &Instruction) -> Result<u32, Error> {
    match instruction.stack {
        Stack::Kept => Ok(0),
        Stack::Sinks(bytes) => Ok(bytes),
        Stack::Unknown => Err(Error::Stack {
            function: function.name.clone(),
            instruction: instruction.text.clone(),
            address: instruction.address,
        }),
    }
}
