//! A steady run reduced as far as the force of the water, with every step kept. Plain data: how it came about stands in
//! [`crate::statics`].

use nalgebra::{Matrix3, Vector3};

use crate::campaign::Run;
use crate::motion::Motion;
use crate::readings::Steady;
use crate::zeros::ZeroOfRun;

/// One steady run, reduced as far as the force of the water.
#[derive(Debug, Clone)]
pub struct SteadyRun<'a> {
    /// The run.
    pub run: &'a Run,
    /// Its means.
    pub steady: &'a Steady,
    /// Its zero.
    pub zero: ZeroOfRun,
    /// How the moment centre moves.
    pub motion: Motion,
    /// Dynamic pressure \[Pa\].
    pub dynamic_pressure_Pa: f64,
    /// The steps.
    pub steps: Steps,
    /// Covariance of the force from within the run.
    pub covariance: Matrix3<f64>,
}

/// What became of the readings: AF, SF, YM about the moment centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// Mean reading.
    pub reading: Vector3<f64>,
    /// Zero at the time of the run.
    pub zero: Vector3<f64>,
    /// Force after zero and interaction.
    pub force: Vector3<f64>,
    /// Force of the strut, taken away.
    pub tare: Vector3<f64>,
    /// Inertia, added.
    pub inertia: Vector3<f64>,
}

impl Steps {
    /// The force of the water on the hull.
    pub fn water(&self) -> Vector3<f64> {
        self.force - self.tare + self.inertia
    }
}
