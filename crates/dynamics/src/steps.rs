//! Mechanisms that come at one time: what is lost or caught steps the drag, or the net mass.
//!
//! The list is the only one: whatever carries the glider through time asks it when the next step comes, so that no integrator
//! meets a step inside its own. Knows the parameters alone.

use super::parameters::Parameters;
use glidepolar_number::Number;

/// How many of them there are.
pub const N_STEPS: usize = 2;

/// A mechanism that comes at one time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// What steps, in words.
    pub of: &'static str,
    /// The row of its size in the table of parameters.
    pub size: &'static str,
    /// The row of its time.
    pub time: &'static str,
}

/// All of them, in the order of [`Parameters::steps_mut`].
pub const STEPS: [Step; N_STEPS] = [
    Step { of: "drag", size: "drag_step", time: "step_time_s" },
    Step { of: "net mass", size: "net_mass_step_kg", time: "net_mass_step_time_s" },
];

impl<T: Number> Parameters<T> {
    /// Size and time \[s\] of each of [`STEPS`].
    pub fn steps(&self) -> [(T, T); N_STEPS] {
        [(self.drag_step, self.step_time_s), (self.net_mass_step_kg, self.net_mass_step_time_s)]
    }

    /// The same, to be changed.
    pub fn steps_mut(&mut self) -> [(&mut T, &mut T); N_STEPS] {
        [(&mut self.drag_step, &mut self.step_time_s), (&mut self.net_mass_step_kg, &mut self.net_mass_step_time_s)]
    }
}

impl Parameters<f64> {
    /// When the next step that has a size comes after a time \[s\].
    pub fn next_step_s(&self, time_s: f64) -> Option<f64> {
        let ahead = self.steps().into_iter().filter(|(size, at_s)| *size != 0.0 && *at_s > time_s);
        ahead.map(|(_, at_s)| at_s).reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter_index;

    #[test]
    fn names_and_values_stand_in_one_order() {
        let mut p = Parameters::<f64>::default();
        for (i, step) in STEPS.iter().enumerate() {
            *p.at(parameter_index(step.size).expect("a row")) = 1.0 + i as f64;
            *p.at(parameter_index(step.time).expect("a row")) = 10.0 + i as f64;
        }
        assert_eq!(p.steps(), [(1.0, 10.0), (2.0, 11.0)]);
        assert_eq!(p.clone().steps_mut().map(|(size, at_s)| (*size, *at_s)), p.steps());
    }

    #[test]
    fn steps_come_in_the_order_of_their_times_and_without_a_size_not_at_all() {
        let p = Parameters { step_time_s: 50.0, net_mass_step_time_s: 20.0, ..Parameters::<f64>::default() };
        assert_eq!(p.next_step_s(0.0), None);
        let p = Parameters { drag_step: 0.1, net_mass_step_kg: -0.03, ..p };
        assert_eq!(
            [0.0, 20.0, 49.0, 50.0].map(|time_s| p.next_step_s(time_s)),
            [Some(20.0), Some(50.0), Some(50.0), None]
        );
    }
}
