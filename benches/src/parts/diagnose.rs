//! The whole diagnosis, beside the fits that it consists of.

use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::Result;
use glidepolar::diagnose::sea::{DiagnosisSettings, SeaProblem};
use glidepolar::diagnose::{Candidate, Evidence, Point, Problem, diagnose};
use glidepolar::identify::{Question, by_dive, fit};

use super::Context;
use crate::arguments::Sized;
use crate::contest::{Contender, Samples, contest};
use crate::data::{COMET, Log, SG542};
use crate::report::{Goal, Part, Row, Unit, figures};

/// Longest time that a diagnosis may take \[s\]: goals of the two logs.
const GOALS: [(Log, f64); 2] = [(COMET, 10.0), (SG542, 15.0)];

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "Diagnosis",
        "The whole catalogue on a real log. What it needs at least: the model and its slopes, evaluated as often as the \
         diagnosis does.",
    );
    // A short run does without the long log.
    let logs = context.choice.size(Sized { quick: &GOALS[..1], standard: &GOALS[..], full: &GOALS[..] });
    for (log, goal) in logs {
        if let Err(error) = of_log(context, &mut part, log, *goal) {
            part.row(Row::new(format!("diagnosis, {}", log.name), Unit::Seconds, Err(error)));
        }
    }
    Ok(part)
}

fn of_log(context: &Context<'_>, part: &mut Part, log: &Log, goal: f64) -> Result<()> {
    let observations = log.read(context.root())?;
    let baseline = log.baseline(&observations)?;
    let problem = Watched {
        problem: SeaProblem::new(&observations, &baseline, DiagnosisSettings::default())?,
        looked: AtomicUsize::new(0),
    };
    let (found, _) = diagnose(&problem);
    let looked = problem.looked.load(Ordering::Relaxed);
    let start = problem.start();
    let question = Question::new(baseline, log.free())?;
    let dives = by_dive(&observations);
    let evaluations = fit(&question, &mut dives.clone())?.evaluations;
    let rounds = context.choice.size(Sized { quick: 0, standard: 3, full: 7 });
    let [whole, look, single] = contest(
        rounds,
        [
            Contender::timed("diagnosis", 1, || {
                let problem = SeaProblem::new(&observations, &baseline, DiagnosisSettings::default())?;
                std::hint::black_box(diagnose(&problem));
                Ok(())
            }),
            Contender::timed("evaluation", 5, || {
                for _ in 0..5 {
                    std::hint::black_box(problem.evidence(&start));
                }
                Ok(())
            }),
            Contender::timed("fit", 1, || Ok(fit(&question, &mut dives.clone()).map(drop)?)),
        ],
    );
    let scaled = |samples: Result<&Samples>, factor: f64| samples.map(|samples| samples.times(factor));
    let name = log.name;
    part.row(
        Row::new(format!("diagnosis, {name}, {} samples", observations.len()), Unit::Seconds, whole.samples().cloned())
            .against(
                format!("its {looked} evaluations of model and slopes, times one"),
                scaled(look.samples(), looked as f64),
            )
            .goal(Goal::AtMost(goal)),
    );
    let fits = looked as f64 / evaluations as f64;
    part.row(Row::new(format!("diagnosis, {name}"), Unit::Seconds, whole.samples().cloned()).against(
        format!("{} fits of all samples with as many evaluations", figures(fits)),
        scaled(single.samples(), fits),
    ));
    let causes: Vec<&str> = found.causes.iter().map(|cause| cause.cause.as_ref()).collect();
    part.remark(format!(
        "{name}: {} candidates, {} bins; named: {}.",
        problem.candidates().len(),
        problem.problem.n_bins(),
        if causes.is_empty() { "nothing".to_owned() } else { causes.join(", ") }
    ));
    Ok(())
}

/// A problem that counts how often it is evaluated.
struct Watched {
    problem: SeaProblem,
    looked: AtomicUsize,
}

impl Problem for Watched {
    fn baseline(&self) -> &[(&'static str, &'static str)] {
        self.problem.baseline()
    }

    fn candidates(&self) -> &[Candidate] {
        self.problem.candidates()
    }

    fn start(&self) -> Point {
        self.problem.start()
    }

    fn evidence(&self, point: &Point) -> Evidence {
        self.looked.fetch_add(1, Ordering::Relaxed);
        self.problem.evidence(point)
    }
}
