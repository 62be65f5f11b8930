//! Reproducible random numbers: one independent stream per part of the virtual sea, so that the same seed gives the same
//! ocean, vehicle and mission whatever effect is hidden.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rand_distr::StandardNormal;

/// The generator: ChaCha8, whose values are the same on every platform.
pub type Stream = ChaCha8Rng;

/// Which part of the sea draws.
#[derive(Debug, Clone, Copy)]
pub enum Part {
    /// Stratification and waves.
    Ocean,
    /// The vehicle and the analyst's beliefs about it.
    Vehicle,
    /// Set-points, courses and turns.
    Mission,
    /// Unsteady water met along the path, steering wander.
    Path,
    /// Measurement noise and sampling.
    Sensors,
    /// Lateral figures of the vehicle.
    LateralFigures,
    /// What disturbs its heading.
    Lateral,
    /// Size of the effect with this place in the table.
    Effect(usize),
}

/// The stream of one part under a seed.
pub fn stream(seed: u64, part: Part) -> Stream {
    let number = match part {
        Part::Ocean => 1,
        Part::Vehicle => 2,
        Part::Mission => 3,
        Part::Path => 4,
        Part::Sensors => 5,
        Part::LateralFigures => 6,
        Part::Lateral => 7,
        Part::Effect(place) => 100 + place as u64,
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(number);
    random
}

/// Uniform between two bounds.
pub fn between(random: &mut Stream, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// Standard normal.
pub fn normal(random: &mut Stream) -> f64 {
    random.sample(StandardNormal)
}

/// +1 or -1.
pub fn sign(random: &mut Stream) -> f64 {
    if random.random::<bool>() { 1.0 } else { -1.0 }
}

/// True with a probability.
pub fn chance(random: &mut Stream, probability: f64) -> bool {
    random.random::<f64>() < probability
}
