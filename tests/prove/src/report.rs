//! Runs the queries and tells what came of them.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, anyhow, bail};

use crate::ir::Function;
use crate::mutant::mutants;
use crate::proof::{Code, Problem};
use crate::smt::{Answer, Solver, Verdict};
use crate::spec::{Claim, Spec};

const SPECS: [(&str, &str); 6] = [
    ("place", include_str!("../spec/place.smt2")),
    ("bias", include_str!("../spec/bias.smt2")),
    ("interval", include_str!("../spec/interval.smt2")),
    ("update", include_str!("../spec/update.smt2")),
    ("play", include_str!("../spec/play.smt2")),
    ("second_lag", include_str!("../spec/second_lag.smt2")),
];

/// A specification of the sample half, with what all of them share: the buffer, and the lines in it.
macro_rules! sample_half {
    ($name:literal) => {
        (
            $name,
            concat!(
                include_str!("../spec/ramps.smt2"),
                include_str!("../spec/lines.smt2"),
                include_str!(concat!("../spec/", $name, ".smt2"))
            ),
        )
    };
}

const SAMPLE_HALF: [(&str, &str); 10] = [
    sample_half!("publish"),
    sample_half!("take_over"),
    sample_half!("advance"),
    sample_half!("correct"),
    sample_half!("correct_block"),
    sample_half!("status"),
    sample_half!("pulses"),
    sample_half!("pulse_status"),
    ("pulse_ramp", include_str!("../spec/pulse_ramp.smt2")),
    ("of_raw", include_str!("../spec/of_raw.smt2")),
];

/// Times the limit for claims that take long.
const SLOW: f64 = 4.0;
/// Time limit of a query about a seeded bug \[s\].
const MUTANT_LIMIT_S: f64 = 15.0;

/// How long to try.
#[derive(Clone, Copy, Debug)]
pub struct Effort<'a> {
    /// Time limit of a query \[s\].
    pub limit_s: f64,
    /// Whether the seeded bugs are tried.
    pub mutants: bool,
    /// The only function to prove, where one is named.
    pub only: Option<&'a str>,
}

/// Totals over all specifications.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Claims that both solvers proved.
    pub by_two: usize,
    /// Claims that one solver proved and the other did not decide.
    pub by_one: usize,
    /// Claims that neither decided.
    pub open: usize,
    /// Seeded bugs that some claim refuted.
    pub killed: usize,
    /// Seeded bugs that all claims hold of.
    pub survived: usize,
    /// Seeded bugs that were not decided.
    pub undecided: usize,
}

/// Proves all claims about the code in `ir`; queries are written to `folder`.
///
/// # Errors
/// A claim that does not hold, preconditions that contradict each other, code that is not
/// understood.
pub fn prove(
    ir: &Path,
    solvers: &[Solver; 2],
    folder: &Path,
    effort: Effort<'_>,
) -> Result<Totals> {
    let code = Code::read(ir)?;
    let mut totals = Totals::default();
    let wanted = |name: &str| effort.only.is_none_or(|only| only == name);
    for (name, text) in SPECS
        .into_iter()
        .chain(SAMPLE_HALF)
        .filter(|(name, _)| wanted(name))
    {
        let spec = Spec::parse(text)?;
        let function = code.function(&spec.function)?;
        let problem = Problem::new(&spec, function, &code.objects)?;
        let run = Run {
            folder: folder.join(name),
            solvers,
            effort,
        };
        fs::create_dir_all(&run.folder)?;
        println!("\n{}", spec.function);
        run.preconditions(&problem)?;
        run.claims(&problem, &mut totals)?;
        if effort.mutants {
            run.mutants(&spec, &code, function, &mut totals)?;
        }
    }
    Ok(totals)
}

struct Run<'a> {
    folder: PathBuf,
    solvers: &'a [Solver; 2],
    effort: Effort<'a>,
}

impl Run<'_> {
    /// Both solvers at once.
    fn ask(&self, name: &str, query: &str, limit_s: f64) -> Result<[Answer; 2]> {
        let file = self.folder.join(format!("{name}.smt2"));
        fs::write(&file, query).with_context(|| file.display().to_string())?;
        std::thread::scope(|scope| {
            let [a, b] = self.solvers;
            let a = scope.spawn(|| a.check(&file, limit_s));
            let b = b.check(&file, limit_s)?;
            match a.join() {
                Ok(a) => Ok([a?, b]),
                Err(_) => bail!("a solver's thread failed"),
            }
        })
    }

    fn show(&self, mark: &str, name: &str, answers: &[Answer; 2], text: &str) {
        let [a, b] = answers.each_ref().map(|answer| match answer.verdict {
            Verdict::Unknown => "     -  ".to_owned(),
            _ => format!("{:6.1} s", answer.seconds),
        });
        println!("  {mark:9} {name:16} {a} {b}  {text}");
    }

    fn preconditions(&self, problem: &Problem) -> Result<()> {
        let answers = self.ask("_preconditions", &problem.possible(), self.effort.limit_s)?;
        let [first, second] = self.solvers.each_ref().map(|solver| solver.name);
        println!("  {:26} {first:8} {second:8}", "");
        match answers.each_ref().map(|answer| answer.verdict) {
            [Verdict::Satisfiable, Verdict::Satisfiable] => {
                self.show(
                    "possible",
                    "preconditions",
                    &answers,
                    "they can all hold at once",
                );
                Ok(())
            }
            verdicts => bail!("the preconditions are not shown to be possible: {verdicts:?}"),
        }
    }

    fn claims(&self, problem: &Problem, totals: &mut Totals) -> Result<()> {
        let mut known = HashMap::new();
        for claim in problem.claims() {
            let limit_s = self.effort.limit_s * if claim.slow { SLOW } else { 1.0 };
            let answers = self.answers(problem, &claim, limit_s)?;
            let refuted = answers
                .iter()
                .find(|answer| answer.verdict == Verdict::Satisfiable);
            if let Some(answer) = refuted {
                bail!(
                    "{} does not hold ({}), for instance of\n{}",
                    claim.name,
                    claim.text,
                    answer.model
                );
            }
            // What follows from a claim is not better known than that.
            let proofs = answers
                .iter()
                .filter(|answer| answer.verdict == Verdict::Unsatisfiable)
                .count();
            let given = claim.by.iter().filter_map(|name| known.get(name));
            let proofs = given.copied().fold(proofs, usize::min);
            known.insert(claim.name.clone(), proofs);
            let (mark, count) = match proofs {
                2 => ("proved", &mut totals.by_two),
                1 => ("by one", &mut totals.by_one),
                _ => ("open", &mut totals.open),
            };
            *count += 1;
            self.show(mark, &claim.name, &answers, &claim.text);
        }
        Ok(())
    }

    /// A more general query that is satisfiable says nothing: then the plain one is asked.
    fn answers(&self, problem: &Problem, claim: &Claim, limit_s: f64) -> Result<[Answer; 2]> {
        if let Some(query) = problem.general_query(claim)? {
            let general = self.ask(&claim.name, &query, limit_s)?;
            let is_refuted = |answer: &Answer| answer.verdict == Verdict::Satisfiable;
            if !general.iter().any(is_refuted) {
                return Ok(general);
            }
        }
        self.ask(&claim.name, &problem.query(claim)?, limit_s)
    }

    /// Tries all seeded bugs, two at a time.
    fn mutants(
        &self,
        spec: &Spec,
        code: &Code,
        function: &Function,
        totals: &mut Totals,
    ) -> Result<()> {
        let mutants = mutants(function);
        let next = AtomicUsize::new(0);
        let work = |worker: usize| -> Result<Totals> {
            let mut totals = Totals::default();
            while let Some(mutant) = mutants.get(next.fetch_add(1, Ordering::Relaxed)) {
                let problem = Problem::new(spec, &mutant.function, &code.objects)?;
                self.mutant(&mutant.name, &problem, worker, &mut totals)?;
            }
            Ok(totals)
        };
        std::thread::scope(|scope| {
            let other = scope.spawn(|| work(1));
            let first = work(0)?;
            let other = other.join().map_err(|_| anyhow!("a thread failed"))??;
            for found in [first, other] {
                totals.killed += found.killed;
                totals.survived += found.survived;
                totals.undecided += found.undecided;
            }
            Ok(())
        })
    }

    /// A seeded bug is found as soon as one claim is refuted by one solver.
    fn mutant(
        &self,
        name: &str,
        problem: &Problem,
        worker: usize,
        totals: &mut Totals,
    ) -> Result<()> {
        let file = self.folder.join(format!("mutant{worker}.smt2"));
        let limit_s = self.effort.limit_s.min(MUTANT_LIMIT_S);
        let mut undecided = Vec::new();
        // What follows without the code follows of a seeded bug as well.
        let tried = |claim: &Claim| !claim.slow && !claim.alone;
        for claim in problem.claims().into_iter().filter(tried) {
            fs::write(&file, problem.query(&claim)?)?;
            let mut answer = self.solvers[0].check(&file, limit_s)?;
            if answer.verdict == Verdict::Unknown
                && let Some(query) = problem.general_query(&claim)?
            {
                fs::write(&file, query)?;
                let general = self.solvers[0].check(&file, limit_s)?;
                if general.verdict == Verdict::Unsatisfiable {
                    answer = general;
                }
            }
            match answer.verdict {
                Verdict::Satisfiable => {
                    totals.killed += 1;
                    println!("  refuted   by {:13} {name}", claim.name);
                    return Ok(());
                }
                Verdict::Unknown => undecided.push(claim.name),
                Verdict::Unsatisfiable => {}
            }
        }
        if undecided.is_empty() {
            totals.survived += 1;
            println!("  survives                   {name}");
        } else {
            totals.undecided += 1;
            println!("  undecided ({}) {name}", undecided.join(", "));
        }
        Ok(())
    }
}
