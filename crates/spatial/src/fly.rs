//! The equations carried through time by DOP853 of the crate `differential-equations`, in units of nominal sizes about an
//! origin that travels with the glider. Commands and water hold through one call.

use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;

use super::equations::derivative;
use super::lateral::Body;
use super::state::{Inputs, N_STATES, NOMINALS, State};

/// Longest step \[s\].
const LONGEST_STEP_S: f64 = 60.0;
/// Accepted steps about one origin.
const STEPS_PER_ORIGIN: usize = 64;
/// First step \[s\].
const FIRST_STEP_S: f64 = 0.1;

/// Why a glider cannot be followed further.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FlightError {
    /// Steps became too short to go on, or a rate of change was not finite.
    #[error(
        "at {time_s} s the equations give no finite rate of change: the glider stands on its nose or tail, or a parameter has no meaning"
    )]
    Stopped {
        /// Time reached \[s\].
        time_s: f64,
    },
}

/// Carries the state from one time to another with this relative tolerance.
///
/// # Errors
/// Where the equations cannot be followed to the end; the state is then the last one reached.
pub fn fly(
    body: &Body<f64>,
    inputs: &Inputs<f64>,
    (mut from_s, to_s): (f64, f64),
    state: &mut State<f64>,
    tolerance: f64,
) -> Result<(), FlightError> {
    let mut step_s = FIRST_STEP_S;
    while from_s < to_s {
        let about = About { body, inputs, origin: *state };
        let stopped = FlightError::Stopped { time_s: from_s };
        let mut method: ExplicitRungeKutta<Ordinary, DormandPrince, f64, Scaled, 8, 12, 16> =
            ExplicitRungeKutta::dop853()
                .rtol(tolerance)
                .atol(tolerance)
                .h0(f64::min(step_s, to_s - from_s))
                .h_max(LONGEST_STEP_S)
                .max_steps(usize::MAX);
        method.init(&about, from_s, from_s + 1e12, &[0.0; N_STATES]).map_err(|_| stopped)?;
        method.set_status(Status::Solving);
        let mut taken = 0;
        while taken < STEPS_PER_ORIGIN && method.t() < to_s {
            let left = to_s - method.t();
            let shortened = method.h() > left;
            if shortened {
                step_s = method.h();
                method.set_h(left);
            }
            match method.step(&about) {
                Err(_) => return Err(stopped),
                Ok(_) if matches!(method.status(), Status::RejectedStep) => {}
                Ok(_) => {
                    taken += 1;
                    if !shortened {
                        step_s = method.h();
                    }
                }
            }
            // The sum of steps may end a rounding error before the end.
            if to_s - method.t() <= 1e-12 * to_s.abs() {
                break;
            }
        }
        *state = about.state(method.y());
        from_s = if to_s - method.t() <= 1e-12 * to_s.abs() { to_s } else { method.t() };
        if state.as_array().iter().any(|value| !value.is_finite()) {
            return Err(stopped);
        }
    }
    Ok(())
}

type Scaled = [f64; N_STATES];

struct About<'a> {
    body: &'a Body<f64>,
    inputs: &'a Inputs<f64>,
    origin: State<f64>,
}

impl About<'_> {
    fn state(&self, scaled: &Scaled) -> State<f64> {
        let (origin, nominal) = (self.origin.as_array(), NOMINALS.as_array());
        State::from_array(std::array::from_fn(|i| origin[i] + scaled[i] * nominal[i]))
    }
}

impl ODE<f64, Scaled> for About<'_> {
    fn diff(&self, time_s: f64, scaled: &Scaled, rates: &mut Scaled) {
        let derivative = derivative(self.body, time_s, &self.state(scaled), self.inputs).as_array();
        let nominal = NOMINALS.as_array();
        *rates = std::array::from_fn(|i| derivative[i] / nominal[i]);
    }
}
