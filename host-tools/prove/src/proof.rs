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

/// A specification beside the code it is about.
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

    fn preamble(&self) -> String {
        let mut text = format!(
            "{COMMON}\n{}\n{}\n{}\n",
            self.code.inputs, self.code.body, self.spec.definitions
        );
        // Definitions may come between assumptions, so that all assumptions follow them.
        for assumption in &self.spec.assumptions {
            writeln!(text, "; {}\n(assert {})", assumption.name, assumption.term).ok();
        }
        text
    }

    /// Satisfiable if the preconditions are.
    pub fn possible(&self) -> String {
        self.preamble()
    }

    /// Unsatisfiable if the claim holds.
    pub fn query(&self, claim: &Claim) -> String {
        format!("{}(assert (not {}))\n", self.preamble(), claim.term)
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
            slow: false,
        }
    }

    /// All claims, with [`defined`](Self::defined) first.
    pub fn claims(&self) -> Vec<Claim> {
        let mut claims = vec![self.defined()];
        claims.extend(self.spec.claims.iter().cloned());
        claims
    }
}
