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
    ///
    /// # Errors
    /// It is to follow from a claim that is not among those before it.
    pub fn query(&self, claim: &Claim) -> Result<String> {
        let mut text = self.preamble();
        for name in &claim.by {
            let earlier = self.spec.claims.iter().take_while(|other| *other != claim);
            let given = earlier.into_iter().find(|other| other.name == *name);
            let given = given.with_context(|| format!("{} by {name}, unknown", claim.name))?;
            writeln!(text, "; {name}\n(assert {})", given.term).ok();
        }
        writeln!(text, "(assert (not {}))", claim.term).ok();
        Ok(text)
    }

    /// The same for any functions in place of the three operations that have exact counterparts
    /// in the specification. Unsatisfiable only if the claim holds; satisfiable says nothing.
    ///
    /// # Errors
    /// As [`query`](Self::query).
    pub fn abstract_query(&self, claim: &Claim) -> Result<String> {
        let mut text = self.query(claim)?.replace("QF_BVFP", "QF_UFBVFP");
        let mut functions = String::new();
        for op in ["add", "sub", "mul"] {
            text = text.replace(&format!("(fp.{op} RNE "), &format!("(any_{op} "));
            writeln!(functions, "(declare-fun any_{op} (F32 F32) F32)").ok();
        }
        // After the line that defines F32.
        let sort = "(define-sort F32 () (_ FloatingPoint 8 24))\n";
        Ok(text.replace(sort, &format!("{sort}{functions}")))
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
