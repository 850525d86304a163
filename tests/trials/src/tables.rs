//! The tables of the trials of units.

use crate::figures::{geometric_mean, worst};
use crate::table;
use crate::trial::{Floor, Outcome, Pair, Spoilt};

/// An axis is worse than by the composite model beyond this ratio; below, it is a matter of chance.
const WORSE: f64 = 1.05;

/// Prints the tables of what was tried.
pub(crate) fn print(kinds: &[String], outcomes: &[Outcome]) {
    accuracy(kinds, outcomes);
    silent(outcomes);
    if outcomes.iter().any(|of| of.start.is_some()) {
        start(kinds, outcomes);
    }
    if outcomes.iter().any(|of| of.spoilt.is_some()) {
        spoilt(kinds, outcomes);
    }
    if outcomes.iter().any(|of| of.floor.is_some()) {
        floor(kinds, outcomes);
    }
}

fn accuracy(kinds: &[String], outcomes: &[Outcome]) {
    let rows = by_kind(kinds, outcomes, |of| {
        let verification = ratios(of, |of| Some(of.verification));
        let wandering = ratios(of, |of| Some(of.wandering));
        [
            format!("{}", of.len()),
            format!("{:.3}", geometric_mean(&verification)),
            format!("{:.2}", worst(&verification)),
            format!("{:.3}", geometric_mean(&wandering)),
            format!("{:.2}", worst(&wandering)),
        ]
    });
    table::print(
        "Error as a ratio to the composite model",
        [
            "kind",
            "axes",
            "verification",
            "worst",
            "wandering",
            "worst",
        ],
        &rows
            .map(|(kind, [a, b, c, d, e])| [kind, a, b, c, d, e])
            .collect::<Vec<_>>(),
    );
}

/// Axes that are worse than by the composite model, and of which the fit says nothing.
fn silent(outcomes: &[Outcome]) {
    let worse = || outcomes.iter().filter(|of| of.verification.ratio() > WORSE);
    let silent: Vec<&Outcome> = worse().filter(|of| of.said.is_empty()).collect();
    println!(
        "\nAxes worse than by the composite model (above {WORSE}): {} of {}; of which the fit says \
         nothing: {}",
        worse().count(),
        outcomes.len(),
        silent.len()
    );
    for of in silent {
        let ratio = of.verification.ratio();
        println!("{}/{}/{}  {ratio:.2}", of.kind, of.seed, of.axis);
    }
}

fn start(kinds: &[String], outcomes: &[Outcome]) {
    let rows = by_kind(kinds, outcomes, |of| {
        let ratios = ratios(of, |of| of.start);
        [
            format!("{:.3}", geometric_mean(&ratios)),
            format!("{:.2}", worst(&ratios)),
        ]
    });
    table::print(
        "Minutes 1 to 10 after power-on in a ramp, as a ratio to the composite model",
        ["kind", "mean", "worst"],
        &rows.map(|(kind, [a, b])| [kind, a, b]).collect::<Vec<_>>(),
    );
}

fn spoilt(kinds: &[String], outcomes: &[Outcome]) {
    let rows = by_kind(kinds, outcomes, |of| {
        let growth = |error: fn(&Spoilt) -> f64| -> Vec<f64> {
            let of = of.iter();
            let growth =
                of.filter_map(|of| Some(error(of.spoilt.as_ref()?) / of.verification.model));
            growth.collect()
        };
        let [outliers, glitch] = [growth(|of| of.outliers), growth(|of| of.glitch)];
        let percent = |ratio: f64| format!("{:+.1} %", 100.0 * (ratio - 1.0));
        [
            percent(geometric_mean(&outliers)),
            percent(worst(&outliers)),
            percent(geometric_mean(&glitch)),
            percent(worst(&glitch)),
        ]
    });
    table::print(
        "Growth of the error by a disturbance of the training logs",
        ["kind", "outliers", "worst", "glitch", "worst"],
        &rows
            .map(|(kind, [a, b, c, d])| [kind, a, b, c, d])
            .collect::<Vec<_>>(),
    );
}

fn floor(kinds: &[String], outcomes: &[Outcome]) {
    let rows = by_kind(kinds, outcomes, |of| {
        let mean = |of_axis: fn(&Floor) -> f64, pair: fn(&Outcome) -> Pair| {
            let of = of.iter();
            let ratios = of.filter_map(|of| Some(of_axis(of.floor.as_ref()?) / pair(of).composite));
            format!("{:.3}", geometric_mean(&ratios.collect::<Vec<_>>()))
        };
        [
            mean(|of| of.verification, |of| of.verification),
            mean(|of| of.wandering, |of| of.wandering),
        ]
    });
    table::print(
        "True states by least squares, as a ratio to the composite model",
        ["kind", "verification", "wandering"],
        &rows.map(|(kind, [a, b])| [kind, a, b]).collect::<Vec<_>>(),
    );
}

/// For each kind that has outcomes, its name and its cells.
fn by_kind<const N: usize>(
    kinds: &[String],
    outcomes: &[Outcome],
    cells: impl Fn(&[&Outcome]) -> [String; N],
) -> impl Iterator<Item = (String, [String; N])> {
    kinds.iter().filter_map(move |kind| {
        let of: Vec<&Outcome> = outcomes.iter().filter(|of| of.kind == *kind).collect();
        (!of.is_empty()).then(|| (kind.clone(), cells(&of)))
    })
}

fn ratios(outcomes: &[&Outcome], pair: impl Fn(&Outcome) -> Option<Pair>) -> Vec<f64> {
    let pairs = outcomes.iter().filter_map(|of| pair(of));
    pairs.map(|pair| pair.ratio()).collect()
}
