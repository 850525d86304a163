//! Specifications: SMT-LIB text in sections.
//!
//! ```text
//! ;@ function NAME       the function that is specified
//! ;@ define              definitions, taken over as they are
//! ;@ assume NAME: TEXT   a term that is taken for granted
//! ;@ claim NAME: TEXT    a term that is to be proved; with `slow` after its name, in more time
//! ```

use anyhow::{Context, Result, bail};

/// A term with its name and what it says in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// Short name.
    pub name: String,
    /// In words.
    pub text: String,
    /// The term.
    pub term: String,
    /// It takes solvers long.
    pub slow: bool,
}

/// Text and claims of a specification, in their order.
#[derive(Clone, Debug, Default)]
pub struct Spec {
    /// The function.
    pub function: String,
    /// Definitions.
    pub definitions: String,
    /// Preconditions.
    pub assumptions: Vec<Claim>,
    /// What is to be proved.
    pub claims: Vec<Claim>,
}

impl Spec {
    /// Reads the sections.
    ///
    /// # Errors
    /// A section of another kind.
    pub fn parse(text: &str) -> Result<Self> {
        let mut spec = Self::default();
        for section in text.split("\n;@ ").skip(1) {
            let (head, body) = section.split_once('\n').unwrap_or((section, ""));
            let (kind, rest) = head.split_once(' ').unwrap_or((head, ""));
            match kind {
                "function" => spec.function = rest.trim().to_owned(),
                "define" => spec.definitions.push_str(body),
                "assume" | "claim" => {
                    let (name, text) = rest.split_once(": ").context("a name and a text")?;
                    let (name, slow) = match name.strip_suffix(" slow") {
                        Some(name) => (name, true),
                        None => (name, false),
                    };
                    let claim = Claim {
                        slow,
                        name: name.to_owned(),
                        text: text.to_owned(),
                        term: body.trim().to_owned(),
                    };
                    match kind {
                        "assume" => spec.assumptions.push(claim),
                        _ => spec.claims.push(claim),
                    }
                }
                _ => bail!("section `{kind}`"),
            }
        }
        Ok(spec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_told_apart() {
        let text = "; head\n;@ function f\n;@ define\n(d)\n;@ assume a: one\n(a)\n\n\
                    ;@ claim c slow: two: three\n(c\n  d)\n";
        let spec = Spec::parse(text).unwrap();
        assert_eq!(
            (spec.function.as_str(), spec.definitions.trim()),
            ("f", "(d)")
        );
        assert_eq!(spec.assumptions[0].term, "(a)");
        let claim = &spec.claims[0];
        assert_eq!(
            (claim.name.as_str(), claim.text.as_str()),
            ("c", "two: three")
        );
        assert!(claim.slow && claim.term == "(c\n  d)");
        assert!(Spec::parse("\n;@ prove x: y\n").is_err());
    }
}
