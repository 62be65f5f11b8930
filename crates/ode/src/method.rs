//! What the integrator asks of a method, and the system in the units in which methods work.

use super::{IntegrationError, Slopes, System};

/// What became of one trial step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trial {
    /// The error is within the tolerance: time and state have moved.
    Accepted,
    /// It is not: nothing moved, the next trial is shorter.
    Rejected,
    /// The method has no way on.
    Failed,
}

/// A method at work about one origin.
pub trait Method<S: System<N, F, E>, const N: usize, const F: usize, const E: usize>: Sized {
    /// The method at a time and place, about to try a step of `step_s`.
    fn begin(stretch: &Stretch<'_, S, N>, tolerance: f64, time_s: f64, step_s: f64) -> Result<Self, IntegrationError>;

    /// Tries the step that is next.
    fn step(&mut self, stretch: &Stretch<'_, S, N>) -> Trial;

    /// The time reached \[s\].
    fn time_s(&self) -> f64;

    /// The state reached, in units of the nominal sizes about the origin.
    fn place(&self) -> &[f64; N];

    /// The step that is next \[s\].
    fn next_step_s(&self) -> f64;

    /// Makes it another.
    fn set_next_step_s(&mut self, step_s: f64);

    /// The state inside the last accepted step.
    fn inside(&mut self, time_s: f64) -> Option<[f64; N]>;
}

/// The system about an origin, in units of the nominal sizes.
pub struct Stretch<'a, S, const N: usize> {
    /// The system.
    pub system: &'a S,
    /// Where the origin lies; the stretch begins there.
    pub origin: [f64; N],
    /// From this time on the rates jump: they are those before it to the end of the stretch \[s\].
    pub last_s: f64,
}

impl<S, const N: usize> Stretch<'_, S, N> {
    /// The state that a scaled one stands for.
    pub fn state<const F: usize, const E: usize>(&self, scaled: &[f64; N]) -> [f64; N]
    where
        S: System<N, F, E>,
    {
        std::array::from_fn(|i| self.origin[i] + scaled[i] * S::NOMINALS[i])
    }

    /// Rates of change of the scaled state.
    pub fn rates<const F: usize, const E: usize>(&self, time_s: f64, scaled: &[f64; N]) -> [f64; N]
    where
        S: System<N, F, E>,
    {
        let derivative = self.system.derivative(time_s.min(self.last_s), &self.state(scaled));
        std::array::from_fn(|i| derivative[i] / S::NOMINALS[i])
    }

    /// Rates of change of the scaled state, and their slopes along what is felt and along time.
    pub fn slopes<const F: usize, const E: usize>(&self, time_s: f64, scaled: &[f64; N]) -> Slopes<N, F>
    where
        S: System<N, F, E>,
    {
        let mut slopes = self.system.slopes(time_s.min(self.last_s), &self.state(scaled));
        for (i, nominal) in S::NOMINALS.into_iter().enumerate() {
            slopes.rates[i] /= nominal;
            slopes.in_time[i] /= nominal;
            slopes.jacobian[i].iter_mut().for_each(|slope| *slope /= nominal);
        }
        slopes
    }

    /// The event indicators at a scaled state.
    pub fn indicators<const F: usize, const E: usize>(&self, time_s: f64, scaled: &[f64; N]) -> [f64; E]
    where
        S: System<N, F, E>,
    {
        self.system.event_indicators(time_s, &self.state(scaled))
    }
}
