//! What a reduction found, whole: from it follow the JSON, the tables, the figures and the page.

use glidepolar_hull::hull_tests::{ReducedHull, Reduction, SCHEMA, Trend};
use glidepolar_inference::Diagnosis;
use glidepolar_inference::relevance::Relevance;

use crate::campaign::{Kind, Rejected, Run};
use crate::diagnose::{self, Diagnoses};
use crate::fits::NoFit;
pub use crate::hull_results::HullResults;
use crate::readings::Trace;
use crate::steady_run::Steps;
use crate::trend::Lines;

/// Everything that one reduction found.
#[derive(Debug, Clone)]
pub struct Results {
    /// The campaign, or the file of points.
    pub name: String,
    /// Where the figures come from, where it is said.
    pub source: String,
    /// Angles up to this magnitude entered the fits \[deg\].
    pub range_deg: f64,
    /// Hull by hull.
    pub hulls: Vec<HullResults>,
    /// Change with length to diameter ratio, where the hulls are many enough.
    pub trend: Option<Lines>,
    /// Every run that was read, in order; none for a table of points.
    pub runs: Vec<RunResults>,
    /// Runs that were left out.
    pub rejected: Vec<Rejected>,
    /// How the balance behaved and what was taken from it.
    pub balance: Option<BalanceSummary>,
    /// What the reader of the figures has to know.
    pub warnings: Vec<String>,
    /// The steady runs as a diagnosis takes them.
    pub steady: diagnose::Data,
    /// What they depart from, where that was asked for.
    pub diagnoses: Option<Diagnoses>,
}

/// One run.
#[derive(Debug, Clone)]
pub struct RunResults {
    /// As it was planned.
    pub run: Run,
    /// How it went, to be drawn.
    pub trace: Trace,
    /// Steady runs: every step from the reading to the force of the water.
    pub steps: Option<Steps>,
    /// Steady runs: effective number of samples of AF, SF, YM, and length of the window \[s\].
    pub effective: Option<([f64; 3], f64)>,
    /// Reading at rest before the run-up less the zero that was taken: AF, SF, YM.
    pub rest_less_zero: Option<[f64; 3]>,
    /// What the crew should know of it.
    pub notices: Vec<String>,
}

/// Zeros, interaction, tare in figures.
#[derive(Debug, Clone)]
pub struct BalanceSummary {
    /// Zero runs.
    pub zeros: usize,
    /// Whether zeros were interpolated in time rather than in run order.
    pub in_time: bool,
    /// Largest change between successive zeros: AF, SF, YM.
    pub largest_drift: [f64; 3],
    /// The interaction matrix, row by row.
    pub interaction: [[f64; 3]; 3],
    /// Tare runs that entered; zero where there were none.
    pub tare_runs: usize,
    /// The strut's force at 2 m/s, no angle and 10 deg: AF, SF, YM.
    pub tare_at_2_m_s: Option<[[f64; 3]; 2]>,
}

impl RunResults {
    /// Whether its window is worth drawing in detail.
    pub fn is_zero(&self) -> bool {
        self.run.kind == Kind::Zero
    }
}

impl Results {
    /// Whether any hull has coefficients, or derivatives of a campaign without a sweep. Where the sweep was lost with runs
    /// that were left out, or its angles are radians, derivatives of the same campaign are no result.
    pub fn is_usable(&self) -> bool {
        self.hulls.iter().any(|hull| match &hull.fit {
            Ok(_) => true,
            Err(NoFit::TooFewPoints { .. }) => hull.dynamic.is_some() && self.rejected.is_empty(),
            Err(NoFit::Radians { .. }) => false,
        })
    }

    /// Asks what the steady runs depart from by more than is relevant, and keeps the answer.
    pub fn diagnose(&mut self, relevance: &Relevance) {
        let diagnoses = Diagnoses::new(&self.steady, &self.hulls, relevance);
        self.warnings.extend(diagnoses.warnings.iter().cloned());
        self.diagnoses = Some(diagnoses);
    }

    /// The figures in the form of `fits.json`.
    pub fn reduction(&self) -> Reduction {
        Reduction {
            schema: SCHEMA.to_owned(),
            hulls: (0..self.hulls.len()).map(|index| self.reduced(index)).collect(),
            trend: self.trend.as_ref().map(|lines| {
                let [a, b, c, d] = lines.slopes();
                Trend { a, b, c, d }
            }),
            campaign_diagnosis: self.diagnoses.as_ref().and_then(|d| json(d.campaign.as_ref()?)),
            warnings: self.warnings.clone(),
        }
    }

    fn reduced(&self, index: usize) -> ReducedHull {
        let hull = &self.hulls[index];
        let of_hull = self.diagnoses.as_ref().and_then(|d| d.hulls.get(index)?.as_ref());
        ReducedHull {
            id: hull.hull.id.clone(),
            ldr: hull.hull.ldr,
            n_runs: hull.n_runs,
            geometry: hull.hull.geometry,
            fit: hull.fit.as_ref().ok().map(|fit| fit.estimates.clone()),
            dynamic: hull.dynamic.as_ref().map(|d| d.estimates.clone()),
            diagnosis: of_hull.and_then(|d| json(&d.diagnosis)),
            extended: of_hull.and_then(|d| d.extended.clone()),
        }
    }
}

/// Plain numbers and strings: always writable as JSON.
fn json(diagnosis: &Diagnosis) -> Option<serde_json::Value> {
    serde_json::to_value(diagnosis).ok()
}
