//! What the reduction found of one hull: the plain data that results, diagnosis and output share.

use crate::derivatives::{Comparison, Derivatives};
use crate::fits::{NoFit, SweepFit};
use crate::hull::Hull;
use crate::sweep::Sweep;
use crate::theory::Theory;
use crate::water::Water;

/// One hull.
#[derive(Debug, Clone)]
pub struct HullResults {
    /// The hull.
    pub hull: Hull,
    /// Its steady points.
    pub sweep: Sweep,
    /// The fits to them.
    pub fit: Result<SweepFit, NoFit>,
    /// Runs (or points) that were reduced.
    pub n_runs: usize,
    /// Oscillations and turns, where there were any.
    pub dynamic: Option<Derivatives>,
    /// Sweep against oscillation.
    pub comparisons: Vec<Comparison>,
    /// Theory beside measurement.
    pub theory: Vec<Theory>,
    /// The water, where it is known.
    pub water: Option<Water>,
    /// Frontal area over the tank's cross-section, where that is known.
    pub blockage: Option<f64>,
}
