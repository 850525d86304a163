//! Queries: a translated function, what is assumed, and the negation of what is claimed.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result};

use crate::ir::{Function, parse_functions};
use crate::layout;
use crate::smt::{Object, Translation, translate};
use crate::spec::{Claim, Spec};

const COMMON: &str = include_str!("../spec/common.smt2");

/// Functions of the shims and what their arguments point to.
#[derive(Clone, Debug)]
pub struct Code {
    /// The functions.
    pub functions: Vec<Function>,
    /// The objects.
    pub objects: Vec<Object>,
}

impl Code {
    /// Reads the code of the shims.
    ///
    /// # Errors
    /// Anything in it that is not understood.
    pub fn read(file: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
        Ok(Self {
            functions: parse_functions(&text, "prove_")?,
            objects: layout::objects(&text)?,
        })
    }

    /// The function of this name.
    ///
    /// # Errors
    /// There is none.
    pub fn function(&self, name: &str) -> Result<&Function> {
        let function = self.functions.iter().find(|function| function.name == name);
        function.with_context(|| format!("no function {name}"))
    }
}

/// A specification and the code it is about.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The specification.
    pub spec: Spec,
    /// The code.
    pub code: Translation,
}

impl Problem {
    /// Translates the function of a specification.
    ///
    /// # Errors
    /// Anything in it that is not understood.
    pub fn new(spec: &Spec, function: &Function, objects: &[Object]) -> Result<Self> {
        Ok(Self {
            spec: spec.clone(),
            code: translate(function, objects)?,
        })
    }

    /// All before the claim, of the code and the definitions given.
    fn preamble(&self, code: &str, definitions: &str) -> String {
        let inputs = &self.code.inputs;
        let mut text = format!("{COMMON}\n{inputs}\n{code}\n{definitions}\n");
        // Definitions may come between assumptions, so that all assumptions follow them.
        for assumption in &self.spec.assumptions {
            writeln!(text, "; {}\n(assert {})", assumption.name, assumption.term).ok();
        }
        text
    }

    /// Satisfiable if the preconditions are. They say nothing of the code, so it is left out.
    pub fn possible(&self) -> String {
        self.preamble(&self.code.outputs, &self.spec.definitions)
    }

    fn with_code(&self) -> String {
        self.preamble(&self.code.body, &self.spec.definitions)
    }

    /// Unsatisfiable if the claim holds.
    ///
    /// # Errors
    /// It is to follow from a claim that is not among those before it.
    pub fn query(&self, claim: &Claim) -> Result<String> {
        self.ended(self.with_code(), claim)
    }

    /// The same of what is more general than the code, if the claim is proved that way.
    /// Unsatisfiable only if the claim holds; satisfiable says nothing.
    ///
    /// Without the code its outputs may be anything. Any functions may stand in place of the three
    /// operations that have exact counterparts in the specification.
    ///
    /// # Errors
    /// As [`query`](Self::query), or a definition that is to be free is not found.
    pub fn general_query(&self, claim: &Claim) -> Result<Option<String>> {
        if !claim.abstracted && !claim.alone {
            return Ok(None);
        }
        let mut text = if claim.alone {
            let mut definitions = self.spec.definitions.clone();
            for name in &claim.free {
                definitions = freed(&definitions, name)
                    .with_context(|| format!("{}: no definition {name}", claim.name))?;
            }
            self.preamble(&self.code.outputs, &definitions)
        } else {
            self.with_code()
        };
        text = self.ended(text, claim)?;
        if claim.abstracted {
            text = text.replace("QF_BVFP", "QF_UFBVFP");
            let mut functions = String::new();
            for op in ["add", "sub", "mul"] {
                text = text.replace(&format!("(fp.{op} RNE"), &format!("(any_{op}"));
                writeln!(functions, "(declare-fun any_{op} (F32 F32) F32)").ok();
            }
            // After the line that defines F32.
            let sort = "(define-sort F32 () (_ FloatingPoint 8 24))\n";
            text = text.replace(sort, &format!("{sort}{functions}"));
        }
        Ok(Some(text))
    }

    /// With the claims that this one follows from, and its negation.
    fn ended(&self, mut text: String, claim: &Claim) -> Result<String> {
        for name in &claim.by {
            let earlier = self.spec.claims.iter().take_while(|other| *other != claim);
            let given = earlier.into_iter().find(|other| other.name == *name);
            let given = given.with_context(|| format!("{} by {name}, unknown", claim.name))?;
            writeln!(text, "; {name}\n(assert {})", given.term).ok();
        }
        writeln!(text, "(assert (not {}))", claim.term).ok();
        Ok(text)
    }

    /// Everything that the code's flags demand, as one claim.
    pub fn defined(&self) -> Claim {
        let mut term = "(and true true".to_owned();
        for (line, demand) in &self.code.demands {
            write!(term, "\n  ; {line}\n  {demand}").ok();
        }
        term.push(')');
        Claim {
            name: "defined".to_owned(),
            text: "no operation of the code is undefined or yields poison".to_owned(),
            term,
            ..Claim::default()
        }
    }

    /// All claims, with [`defined`](Self::defined) first.
    pub fn claims(&self) -> Vec<Claim> {
        let mut claims = vec![self.defined()];
        claims.extend(self.spec.claims.iter().cloned());
        claims
    }
}

/// The definitions with a constant of any value in place of the one of this name.
fn freed(definitions: &str, name: &str) -> Option<String> {
    let start = definitions.find(&format!("(define-fun {name} () "))?;
    let (before, rest) = definitions.split_at(start);
    let mut depth = 0;
    let end = rest.find(|letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth == 0
    })?;
    let (definition, after) = rest.split_at(end + 1);
    let sort = definition.split_whitespace().nth(3)?;
    Some(format!("{before}(declare-const {name} {sort}){after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_is_freed_and_no_other() {
        let text = "(define-fun a () F32 (f b))\n(define-fun b () Bool\n  (or c\n  d))\n(e)";
        let expected = "(define-fun a () F32 (f b))\n(declare-const b Bool)\n(e)";
        assert_eq!(freed(text, "b").as_deref(), Some(expected));
        assert_eq!(freed(text, "e"), None);
    }
}
