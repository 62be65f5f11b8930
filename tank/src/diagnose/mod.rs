//! The diagnosis in the tank: what a campaign's steady runs say against `CL = a alpha, CD = b + c alpha^2, CM = d alpha`.
//!
//! Readings are first held against themselves (signs, temperatures). Then the engine of [`glidepolar_inference`] races
//! the [mechanisms] on all steady runs of all hulls together: each hull has its own a, b, c, d; balance, carriage and
//! water are one for all. What no steady run can show, since a, b, c, d absorb it, stands in the baseline with the belief
//! in it, so that no other mechanism is named in its place, and is said to be not_identifiable.
//!
//! Knows reduced runs; no files, no pages.

mod candidates;
mod consistency;
mod data;
mod drift;
mod effects;
mod findings;
mod independent_rows;
mod level_shift;
pub mod mechanisms;
mod model;
mod problem;
mod reduced;
mod repeats;
mod run_scatter;
#[cfg(test)]
mod tests;
mod zero_runs;

use glidepolar_hull::hull_tests::ExtendedFit;
use glidepolar_inference::relevance::Relevance;
use glidepolar_inference::{Diagnosis, Outcome, Unexplained, diagnose_in_full};

use crate::hull_results::HullResults;
pub use data::{Data, SteadyData, Tared, ZeroRun, ZeroTimes, zero_times};
pub use findings::CHANNEL;
use mechanisms::{IN_TANK, Mechanism, Reach};
use problem::TankProblem;

/// Fewest steady runs from which a diagnosis is tried.
const LEAST_RUNS: usize = 12;

/// What was found.
#[derive(Debug, Clone, Default)]
pub struct Diagnoses {
    /// All hulls together; none for a table of points, which is one hull's.
    pub campaign: Option<Diagnosis>,
    /// Hull by hull; none where nothing could be asked.
    pub hulls: Vec<Option<HullDiagnosis>>,
    /// Run by run, to be drawn.
    pub runs: Vec<RunLeft>,
    /// What the reader has to know.
    pub warnings: Vec<String>,
}

/// One hull.
#[derive(Debug, Clone)]
pub struct HullDiagnosis {
    /// The four answers on this hull's runs.
    pub diagnosis: Diagnosis,
    /// Its coefficients beside its own mechanisms, where any were named.
    pub extended: Option<ExtendedFit>,
}

/// What the baseline and the extended model leave of one run: CL, CD, CM.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunLeft {
    /// Index of the hull.
    pub hull: usize,
    /// Yaw angle \[deg\].
    pub yaw_deg: f64,
    /// Speed, where it is known \[m/s\].
    pub speed_m_s: Option<f64>,
    /// When it was made \[s\].
    pub time_s: f64,
    /// Measured.
    pub measured: [f64; 3],
    /// Measured less modelled by the baseline.
    pub before: [f64; 3],
    /// Measured less modelled with what was named.
    pub after: [f64; 3],
    /// The same, by models that did not see the run: without and with what was named.
    pub held_out: [[f64; 3]; 2],
    /// Standard deviation of the noise.
    pub sd: [f64; 3],
}

impl Diagnoses {
    /// Asks. `hulls` are the reduced hulls of these data.
    pub fn new(data: &Data, hulls: &[HullResults], relevance: &Relevance) -> Diagnoses {
        if data.runs.len() < LEAST_RUNS {
            let warning =
                format!("no diagnosis: {} steady drift runs, at least {LEAST_RUNS} are needed", data.runs.len());
            return Diagnoses { warnings: vec![warning], hulls: vec![None; hulls.len()], ..Diagnoses::default() };
        }
        if let Some(found) = consistency::signs(hulls) {
            return Diagnoses::same_for_all(data, found);
        }
        let mut data = data.clone();
        let wrong_temperature = consistency::temperatures(&mut data);
        let problem = TankProblem::new(&data, hulls, relevance);
        let mut outcome = diagnose_in_full(&problem);
        add_what_no_curve_shows(&mut outcome, &data, &problem);
        let mut diagnoses = findings::write(&data, &problem, &outcome, hulls);
        diagnoses.warnings.extend(run_scatter::warnings(&outcome, &data, &problem));
        if let Some(cause) = wrong_temperature {
            let all = diagnoses.campaign.iter_mut();
            for diagnosis in all.chain(diagnoses.hulls.iter_mut().flatten().map(|hull| &mut hull.diagnosis)) {
                consistency::add(diagnosis, cause.clone());
            }
        }
        diagnoses
    }

    /// Says in which file the extended fits stand.
    pub fn extended_in(&mut self, path: &str) {
        let mut any = false;
        for hull in self.hulls.iter_mut().flatten().filter(|hull| hull.extended.is_some()) {
            hull.diagnosis.extended = Some(path.to_owned());
            any = true;
        }
        if let Some(campaign) = self.campaign.as_mut().filter(|_| any) {
            campaign.extended = Some(path.to_owned());
        }
    }

    /// What is reported first: of the campaign, or of the one hull that there is.
    pub fn overall(&self) -> Option<&Diagnosis> {
        self.campaign.as_ref().or_else(|| self.hulls.iter().flatten().map(|hull| &hull.diagnosis).next())
    }

    /// One answer that holds for every hull alike.
    fn same_for_all(data: &Data, found: Diagnosis) -> Diagnoses {
        let hull = HullDiagnosis { diagnosis: found.clone(), extended: None };
        Diagnoses {
            hulls: vec![Some(hull); data.hulls.len()],
            campaign: data.is_raw.then_some(found),
            ..Diagnoses::default()
        }
    }
}

/// Where runs at one setting, or a step in the order of runs, tell of a misfit that no curve of the engine shows, adds it to what was said:
/// a verdict `none` becomes `unexplained`.
fn add_what_no_curve_shows(outcome: &mut Outcome, data: &Data, problem: &TankProblem<'_>) {
    if outcome.diagnosis.unexplained.is_some() {
        return;
    }
    let mut found = repeats::misfits(outcome, data, problem);
    found.extend(level_shift::misfits(outcome, data, problem));
    let Some(clearest) = found.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value)) else { return };
    let diagnosis = &mut outcome.diagnosis;
    let depends_on = if clearest.regime == level_shift::RUN_ORDER {
        vec![clearest.regime.clone()]
    } else {
        let left = diagnosis.left.iter().filter(|left| left.quantity == clearest.quantity);
        left.map(|left| left.depends_on.clone()).collect()
    };
    diagnosis.leave_unexplained(Unexplained { quantity: clearest.quantity.clone(), rms: clearest.rms, depends_on });
    diagnosis.wrong.extend(found);
}

/// What these runs cannot show of the mechanisms that steady runs may show in general, with the reason.
fn not_identifiable(problem: &TankProblem<'_>, data: &Data) -> Vec<(&'static Mechanism, String)> {
    IN_TANK
        .iter()
        .filter_map(|mechanism| {
            let why = match (mechanism.reach, problem.why_not(mechanism)) {
                (Reach::Absorbed, _) if mechanism.name == "strut_tare" && data.tared != Tared::Never => return None,
                (Reach::Absorbed, _) => "a, b, c, d absorb it",
                (_, Some(why)) => why,
                _ => return None,
            };
            Some((mechanism, format!("these runs cannot show it: {why}; {} would", mechanism.shown_by)))
        })
        .collect()
}

/// The noise-weighted rows of an outcome, run by run.
fn runs_left(data: &Data, problem: &TankProblem<'_>, outcome: &Outcome) -> Vec<RunLeft> {
    let n = problem.order().len();
    let of = |values: &nalgebra::DVector<f64>, i: usize| [0, 1, 2].map(|k| values[k * n + i]);
    problem
        .order()
        .iter()
        .enumerate()
        .map(|(i, run)| {
            let run = &data.runs[*run];
            RunLeft {
                hull: run.hull,
                yaw_deg: run.point.yaw_deg,
                speed_m_s: run.point.speed_m_s,
                time_s: run.time_s,
                measured: run.point.coefficients,
                before: of(&outcome.before.residual, i),
                after: of(&outcome.after.residual, i),
                held_out: [of(&outcome.before.held_out, i), of(&outcome.after.held_out, i)],
                sd: [0, 1, 2].map(|k| outcome.after.sd[k * n + i]),
            }
        })
        .collect()
}
