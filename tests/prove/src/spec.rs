//! Specifications: SMT-LIB text in sections.
//!
//! ```text
//! ;@ function NAME       the function that is specified
//! ;@ define              definitions, taken over as they are
//! ;@ assume NAME: TEXT   a term that is taken for granted
//! ;@ claim NAME: TEXT    a term that is to be proved
//! ```
//!
//! Words after the name of a claim say how it is proved: `slow` in more time; `by a,b` with the
//! claims a and b, proved before it, taken for granted; `abstract` for any functions in place of
//! addition, subtraction and multiplication, which spares the solver the rounding where code and
//! specification name the same operations; `alone` without the code, from assumptions and earlier
//! claims, for any outputs; `free a,b` like `alone`, for any values in place of the definitions a
//! and b.

use anyhow::{Context, Result, bail};

/// A term with its name and what it says in words.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Claim {
    /// Short name.
    pub name: String,
    /// In words.
    pub text: String,
    /// The term.
    pub term: String,
    /// It takes solvers long.
    pub slow: bool,
    /// It holds whatever arithmetic does.
    pub abstracted: bool,
    /// It follows without the code.
    pub alone: bool,
    /// Names of definitions that may have any value.
    pub free: Vec<String>,
    /// Names of the claims it follows from.
    pub by: Vec<String>,
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
                "define" => {
                    spec.definitions.push_str(body);
                    spec.definitions.push('\n');
                }
                "assume" | "claim" => {
                    let (manner, text) = rest.split_once(": ").context("a name and a text")?;
                    let mut claim = Claim::in_manner(manner)?;
                    claim.text = text.to_owned();
                    claim.term = body.trim().to_owned();
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

impl Claim {
    /// A name and how the claim is proved.
    fn in_manner(text: &str) -> Result<Self> {
        let mut words = text.split(' ');
        let mut claim = Self {
            name: words.next().context("a name")?.to_owned(),
            ..Self::default()
        };
        while let Some(word) = words.next() {
            let mut names = || -> Result<Vec<String>> {
                let names = words.next().context("names are missing")?;
                Ok(names.split(',').map(str::to_owned).collect())
            };
            match word {
                "slow" => claim.slow = true,
                "abstract" => claim.abstracted = true,
                "alone" => claim.alone = true,
                "free" => {
                    claim.alone = true;
                    claim.free = names()?;
                }
                "by" => claim.by = names()?,
                _ => bail!("`{word}` after the name {}", claim.name),
            }
        }
        Ok(claim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_told_apart() {
        let text = "; head\n;@ function f\n;@ define\n(d)\n;@ assume a: one\n(a)\n\n\
                    ;@ claim c slow abstract by a,b: two: three\n(c\n  d)\n";
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
        assert!(claim.slow && claim.abstracted && claim.term == "(c\n  d)");
        assert_eq!(claim.by, ["a", "b"]);
        assert!(!claim.alone);
        let spec = Spec::parse("\n;@ claim c free d: one\n(c)\n").unwrap();
        assert!(spec.claims[0].alone && spec.claims[0].free == ["d"]);
        assert!(Spec::parse("\n;@ claim x soon: y\n").is_err());
        assert!(Spec::parse("\n;@ prove x: y\n").is_err());
    }
}
