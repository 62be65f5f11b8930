//! DOP853 (Dormand and Prince, order 8 with error estimates of order 5 and 3, dense output of order 7) of the crate
//! `differential-equations`, for tight tolerances.

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;

use super::method::{Method, Stretch, Trial};
use super::{IntegrationError, LONGEST_STEP_S, System};

/// The method.
pub struct Explicit<const N: usize>(ExplicitRungeKutta<Ordinary, DormandPrince, f64, [f64; N], 8, 12, 16>);

impl<S: System<N, F, E>, const N: usize, const F: usize, const E: usize> Method<S, N, F, E> for Explicit<N> {
    fn begin(stretch: &Stretch<'_, S, N>, tolerance: f64, time_s: f64, step_s: f64) -> Result<Self, IntegrationError> {
        let far = time_s + 1e12;
        let start = [0.0; N];
        let mut method = ExplicitRungeKutta::dop853()
            .rtol(tolerance)
            .atol(tolerance)
            .h0(step_s)
            .h_max(LONGEST_STEP_S)
            .max_steps(usize::MAX);
        let started = method.init(&Equations(stretch), time_s, far, &start);
        method.set_status(Status::Solving);
        if started.is_err() {
            return Err(IntegrationError::StepTooSmall { time_s });
        }
        Ok(Explicit(method))
    }

    fn step(&mut self, stretch: &Stretch<'_, S, N>) -> Trial {
        let step = self.0.step(&Equations(stretch)).is_ok();
        self.0.set_h(rounded(self.0.h()));
        match self.0.status() {
            _ if !step => Trial::Failed,
            Status::RejectedStep => Trial::Rejected,
            _ => Trial::Accepted,
        }
    }

    fn time_s(&self) -> f64 {
        self.0.t()
    }

    fn place(&self) -> &[f64; N] {
        self.0.y()
    }

    fn next_step_s(&self) -> f64 {
        self.0.h()
    }

    fn set_next_step_s(&mut self, step_s: f64) {
        self.0.set_h(step_s);
    }

    fn inside(&mut self, time_s: f64) -> Option<[f64; N]> {
        self.0.interpolate(time_s.clamp(self.0.t_prev(), self.0.t())).ok()
    }
}

/// Rounds the next step down to 12 binary places. The crate takes it from the system's power function, whose last place is
/// another one on another system: rounded, the steps are the same.
fn rounded(step_s: f64) -> f64 {
    f64::from_bits(step_s.to_bits() & !0 << 40)
}

/// The stretch as the crate of the method knows equations.
struct Equations<'a, S, const N: usize, const F: usize, const E: usize>(&'a Stretch<'a, S, N>);

impl<S: System<N, F, E>, const N: usize, const F: usize, const E: usize> ODE<f64, [f64; N]>
    for Equations<'_, S, N, F, E>
{
    fn diff(&self, time_s: f64, scaled: &[f64; N], rates: &mut [f64; N]) {
        *rates = self.0.rates(time_s, scaled);
    }
}
