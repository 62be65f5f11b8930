//! What a reduction found, whole: from it follow the JSON, the tables, the figures and the page.

use glidepolar::hull_tests::{ReducedHull, Reduction, SCHEMA, Slope, Trend};

use crate::fits::{SweepFit, TooFewPoints};
use crate::hull::Hull;
use crate::sweep::Sweep;

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
    pub trend: Option<[Slope; 4]>,
    /// What the reader of the figures has to know.
    pub warnings: Vec<String>,
}

/// One hull.
#[derive(Debug, Clone)]
pub struct HullResults {
    /// The hull.
    pub hull: Hull,
    /// Its steady points.
    pub sweep: Sweep,
    /// The fits to them.
    pub fit: Result<SweepFit, TooFewPoints>,
    /// Runs (or points) that were reduced.
    pub n_runs: usize,
}

impl Results {
    /// The figures in the form of `fits.json`.
    pub fn reduction(&self) -> Reduction {
        Reduction {
            schema: SCHEMA.to_owned(),
            hulls: self.hulls.iter().map(HullResults::reduced).collect(),
            trend: self.trend.clone().map(|[a, b, c, d]| Trend { a, b, c, d }),
            campaign_diagnosis: None,
            warnings: self.warnings.clone(),
        }
    }
}

impl HullResults {
    fn reduced(&self) -> ReducedHull {
        ReducedHull {
            id: self.hull.id.clone(),
            ldr: self.hull.ldr,
            n_runs: self.n_runs,
            geometry: self.hull.geometry,
            fit: self.fit.as_ref().ok().map(|fit| fit.estimates.clone()),
            dynamic: None,
            diagnosis: None,
        }
    }
}
