//! The equations carried through time with commands and water that hold.

use glidepolar_ode::{IntegrationError, Integrator};

use super::glider::SpatialGlider;
use super::lateral::Body;
use super::state::{Inputs, State};
use super::steering::Steering;

/// Carries the state from one time to another with this relative tolerance.
///
/// # Errors
/// Where the equations cannot be followed to the end; the state is then the last one reached.
pub fn fly(
    body: &Body<f64>,
    inputs: &Inputs<f64>,
    (from_s, to_s): (f64, f64),
    state: &mut State<f64>,
    tolerance: f64,
) -> Result<(), IntegrationError> {
    let glider = SpatialGlider::new(*body, Steering::Direct, *inputs);
    let mut time_s = from_s;
    glider.fly(&mut Integrator::new(tolerance), &mut time_s, state, to_s)
}
