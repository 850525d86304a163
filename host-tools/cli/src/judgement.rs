//! The verdict on a set with its reasons: for people, and as JSON.

use std::io::Write;

use anstyle::{AnsiColor, Style};
use anyhow::Result;
use serde::Serialize;
use tempco_evaluate::{Evaluation, Role};
use tempco_set::{CoefficientSet, Judged, Judgement, Verdict};

use crate::output::{print, print_json, say, shorten, wrap};

/// Prints `of`, an object, and the judgement as one JSON object.
pub(crate) fn print_as_json(of: impl Serialize, judgement: &Judgement) -> Result<()> {
    print_json(&Judged { of, judgement })
}

/// Prints the verdict; its word has a colour on a terminal.
pub(crate) fn print_verdict(
    judgement: &Judgement,
    set: &CoefficientSet,
    evaluation: Option<&Evaluation>,
) -> Result<()> {
    let verdict = judgement.verdict();
    let colour = match verdict {
        Verdict::Accepted => AnsiColor::Green,
        Verdict::AcceptedWithWarnings => AnsiColor::Yellow,
        Verdict::Rejected => AnsiColor::Red,
    };
    let style = Style::new().bold().fg_color(Some(colour.into()));
    let word = verdict.name().replace('_', " ");
    let verification = evaluation.is_some_and(|of| of.log.role == Role::Verification);
    let standing = if judgement.verified && judgement.is_accepted() {
        ", verified"
    } else if verification || !set.sign_offs.is_empty() {
        ""
    } else {
        ", not yet verified"
    };
    // Every text here is our own, so that the escape codes need no care.
    let mut out = anstream::stdout().lock();
    writeln!(out, "verdict: {style}{word}{style:#}{standing}")?;
    Ok(())
}

/// Prints every reason of the verdict in full.
pub(crate) fn print_reasons(judgement: &Judgement) -> Result<()> {
    for (kind, code, _, message) in all(judgement) {
        print(format_args!("{kind} {code}: {message}"))?;
    }
    Ok(())
}

/// Says on standard error why a set is rejected.
pub(crate) fn say_rejections(subject: impl std::fmt::Display, judgement: &Judgement) {
    let reasons = Reason::group(judgement);
    for reason in reasons.iter().filter(|of| of.kind == REJECTION) {
        say!("{subject} rejected, {}", reason.name());
    }
}

/// The reasons in at most `room` lines, if that can be: every code, each once, and of the messages
/// what there is room for.
pub(crate) fn reasons_within(judgement: &Judgement, room: usize) -> Vec<String> {
    let reasons = Reason::group(judgement);
    let count = reasons.len();
    // How many reasons have their whole message, and how many at least the beginning of it.
    let all_have_one = (0..=count).rev().map(|whole| (whole, count));
    let codes_alone = (0..count).rev().map(|begun| (0, begun));
    let mut lines = Vec::new();
    for (whole, begun) in all_have_one.chain(codes_alone) {
        lines = Reason::lines(&reasons, whole, begun);
        if lines.len() <= room {
            break;
        }
    }
    lines
}

const REJECTION: &str = "rejection";
const WARNING: &str = "warning";

/// Every reason: its kind, code, axis and message.
fn all(
    judgement: &Judgement,
) -> impl Iterator<Item = (&'static str, &'static str, Option<&str>, &str)> {
    let rejections = judgement.rejections.iter().map(|of| {
        let axis = of.axis.as_deref();
        (REJECTION, of.code.name(), axis, &of.message[..])
    });
    let warnings = judgement.warnings.iter().map(|of| {
        let axis = of.axis.as_deref();
        (WARNING, of.code.name(), axis, &of.message[..])
    });
    rejections.chain(warnings)
}

/// All reasons of one code.
struct Reason<'a> {
    kind: &'static str,
    code: &'static str,
    axes: Vec<&'a str>,
    /// Each once, without its axis where it begins with it.
    messages: Vec<&'a str>,
}

impl<'a> Reason<'a> {
    /// Rejections first, otherwise in the order of the judgement.
    fn group(judgement: &'a Judgement) -> Vec<Self> {
        let mut reasons: Vec<Self> = Vec::new();
        for (kind, code, axis, message) in all(judgement) {
            let known = reasons.iter().position(|of| of.code == code);
            let place = known.unwrap_or_else(|| {
                reasons.push(Self {
                    kind,
                    code,
                    axes: Vec::new(),
                    messages: Vec::new(),
                });
                reasons.len() - 1
            });
            let reason = &mut reasons[place];
            let found = axis.and_then(|axis| {
                let rest = message.strip_prefix("axis ")?.strip_prefix(axis)?;
                rest.strip_prefix(": ")
            });
            push_new(&mut reason.messages, found.unwrap_or(message));
            if let Some(axis) = axis {
                push_new(&mut reason.axes, axis);
            }
        }
        reasons
    }

    /// The code, and the axes it is of.
    fn name(&self) -> String {
        let Self { code, axes, .. } = self;
        match axes[..] {
            [] => (*code).to_owned(),
            [axis] => format!("{code}: axis {axis}"),
            _ => format!("{code}: axes {}", axes.join(", ")),
        }
    }

    /// The first message stands for all of them.
    fn text(&self) -> String {
        let (name, first) = (self.name(), self.messages[0]);
        let more = match self.messages.len() - 1 {
            0 => String::new(),
            count => format!("; and {count} more"),
        };
        format!("{} {name}: {first}{more}", self.kind)
    }

    /// The first `whole` reasons with their message, those up to `begun` with its beginning, and
    /// the codes of the others.
    fn lines(reasons: &[Self], whole: usize, begun: usize) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for reason in &reasons[..whole] {
            lines.extend(wrap(&reason.text()));
        }
        for reason in &reasons[whole..begun] {
            lines.push(shorten(&reason.text()));
        }
        for (kind, also) in [(REJECTION, "rejections also"), (WARNING, "warnings also")] {
            let others = reasons[begun..].iter().filter(|of| of.kind == kind);
            let others: Vec<&str> = others.map(|of| of.code).collect();
            if !others.is_empty() {
                lines.extend(wrap(&format!("{also}: {}", others.join(", "))));
            }
        }
        if whole < reasons.len() || reasons.iter().any(|of| of.messages.len() > 1) {
            lines.push("(--verbose has every message in full)".to_owned());
        }
        lines
    }
}

fn push_new<'a>(list: &mut Vec<&'a str>, text: &'a str) {
    if !list.contains(&text) {
        list.push(text);
    }
}

#[cfg(test)]
mod tests {
    use tempco_set::{Rejection, RejectionCode, Warning, WarningCode};

    use super::*;

    /// Every code, each for all axes, with a long message that differs.
    fn worst(axes: &[&str]) -> Judgement {
        let mut judgement = Judgement::default();
        for axis in axes {
            let found = format!("found on {axis} {}", "and on others ".repeat(12));
            for &code in RejectionCode::ALL {
                judgement
                    .rejections
                    .push(Rejection::of_axis(code, axis, &found));
            }
            for &code in WarningCode::ALL {
                judgement
                    .warnings
                    .push(Warning::of_axis(code, axis, &found));
            }
        }
        judgement
    }

    #[test]
    fn every_code_is_there_however_little_room_there_is() {
        let codes = RejectionCode::ALL.iter().map(|code| code.name());
        let codes = codes.chain(WarningCode::ALL.iter().map(|code| code.name()));
        let codes: Vec<&str> = codes.collect();
        let long = [
            "a_long_name_1",
            "a_long_name_2",
            "a_long_name_3",
            "d",
            "e",
            "f",
        ];
        for axes in [&["x"][..], &["x", "y", "z"], &long] {
            for room in (16..28).chain([40, 60, 79, 80, 99]) {
                let lines = reasons_within(&worst(axes), room);
                assert!(lines.len() <= room, "{room}: {lines:#?}");
                assert!(
                    lines.iter().all(|line| line.chars().count() <= 80),
                    "{lines:#?}"
                );
                let words: Vec<&str> = lines
                    .iter()
                    .flat_map(|line| line.split([' ', ',', ':']))
                    .collect();
                for code in &codes {
                    let count = words.iter().filter(|word| *word == code).count();
                    assert_eq!(count, 1, "{code}: {lines:#?}");
                }
                let is_shortened = axes.len() > 1 || room < 80;
                assert!(!is_shortened || lines.concat().contains("--verbose"));
            }
        }
    }

    #[test]
    fn axes_of_one_code_share_a_line_and_a_message() {
        let mut judgement = Judgement::default();
        for (axis, found) in [("x", "r = 0.6"), ("y", "r = 0.6"), ("z", "r = 0.7")] {
            let warning = Warning::of_axis(WarningCode::ResidualFollowsRate, axis, found);
            judgement.warnings.push(warning);
        }
        let lines = reasons_within(&judgement, 20);
        let expected = "warning residual_follows_rate: axes x, y, z: r = 0.6; and 1 more";
        assert_eq!(lines, [expected, "(--verbose has every message in full)"]);

        judgement.warnings.truncate(1);
        let expected = "warning residual_follows_rate: axis x: r = 0.6";
        assert_eq!(reasons_within(&judgement, 20), [expected]);
        assert_eq!(reasons_within(&Judgement::default(), 20), [""; 0]);
    }
}
