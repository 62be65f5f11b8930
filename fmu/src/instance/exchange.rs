//! Model Exchange: time and states come from the importer's integrator, rates and event indicators go back. The
//! handling of events is shared with Co-Simulation.

use glidepolar_dynamics::steps::STEPS;
use glidepolar_dynamics::{State, Stop};

use super::Instance;
use super::access::not_finite;
use super::refusal::{Outcome, Refusal, Status};
use crate::model::glider::DiscreteState;
use crate::model::values::{MOST_STATES, head};
use crate::model::{Glider, Model, Slot};

/// What an event brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EventOutcome {
    /// A continuous state jumped.
    pub states_changed: bool,
    /// When the next event comes that time alone brings \[s\].
    pub next_time_event_s: Option<f64>,
}

impl Instance {
    /// Sets the time.
    pub fn set_time(&mut self, time_s: f64) -> Outcome {
        let start = self.core.start_time_s;
        if !time_s.is_finite() || time_s < start - 1e-9 * start.abs().max(1.0) {
            return Err(Refusal::error(format!(
                "time = {time_s}: expected a finite time after the start at {start} s"
            )));
        }
        self.core.glider.values.time_s = time_s;
        Ok(())
    }

    /// Sets the continuous states.
    pub fn set_states(&mut self, states: &[f64]) -> Outcome {
        let n_states = self.core.glider.model.n_states();
        if states.len() != n_states {
            return Err(wrong_length(states.len(), n_states, "continuous states"));
        }
        if let Some((i, value)) = states.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(Refusal::error(format!("continuous state {i} = {value}: expected a finite number")));
        }
        self.core.glider.values.state[..n_states].copy_from_slice(states);
        Ok(())
    }

    /// The continuous states.
    pub fn states(&self, states: &mut [f64]) -> Outcome {
        let glider = self.now();
        fill(states, &glider.values.state[..glider.model.n_states()], "continuous states")
    }

    /// Their rates of change.
    pub fn derivatives(&self, derivatives: &mut [f64]) -> Outcome {
        let glider = self.now();
        let rates = &glider.derivative()[..glider.model.n_states()];
        check_finite(self, rates, Slot::Derivative)?;
        fill(derivatives, rates, "derivatives")
    }

    /// Their usual sizes.
    pub fn nominals(&self, nominals: &mut [f64]) -> Outcome {
        fill(nominals, self.core.glider.model.nominals(), "continuous states")
    }

    /// The event indicators.
    pub fn indicators(&self, indicators: &mut [f64]) -> Outcome {
        let glider = self.now();
        let z = &glider.indicators()[..glider.model.n_events()];
        check_finite(self, z, Slot::Indicator)?;
        fill(indicators, z, "event indicators")
    }

    /// Brings the discrete states up to date.
    pub fn handle_event(&mut self) -> EventOutcome {
        let (before, state) = (self.core.glider.discrete, self.core.glider.values.state);
        // Between limits that stand the wrong way round nothing has its place; the next phase refuses them.
        let states_changed = self.check_limits().is_ok() && self.core.glider.handle_event();
        self.core.unsettled = false;
        self.tell_of_moves(&state, &self.core.glider);
        let after = self.core.glider.discrete;
        if states_changed || before != after {
            self.core.integrator.forget_ahead();
        }
        if before != after && self.log.wants_events() {
            self.log.event(&format!("event at {} s: {}", self.time_s(), news(before, after)));
        }
        EventOutcome { states_changed, next_time_event_s: self.core.glider.next_time_event_s() }
    }
}

impl Instance {
    /// Warns where ballast or moving mass lay beyond a limit and were brought back to it: a limit was narrowed under
    /// them, or a start lies outside. An ordinary arrival at a limit is not worth a word, nor is a start in trim.
    pub(super) fn tell_of_moves(&self, before: &[f64; MOST_STATES], after: &Glider) {
        const WORTH_A_WORD: f64 = 1e-6;
        if after.model != Model::Plane {
            // Servos stop short of every limit.
            return;
        }
        let (p, state) = (after.parameters(), State::from_array(head(&after.values.state)));
        let before = State::from_array(head(before));
        let (from, to) = (before.moving_mass_1_m, state.moving_mass_1_m);
        let is_inside = from >= p.moving_mass_min_m && from <= p.moving_mass_max_m;
        if !is_inside && (to - from).abs() > WORTH_A_WORD {
            let (limit, value) = if to < from {
                ("moving_mass_max_m", p.moving_mass_max_m)
            } else {
                ("moving_mass_min_m", p.moving_mass_min_m)
            };
            self.log.problem(
                Status::Warning,
                &format!(
                    "moving_mass_position_m = {from:?} m lies beyond {limit} = {value:?} m; the mass was moved to {to:?} m"
                ),
            );
        }
        let (from, to) = (before.ballast_mass_kg, state.ballast_mass_kg);
        let [least, most] = [p.ballast_max_m3, p.ballast_min_m3].map(|volume_m3| p.ballast_mass_kg(volume_m3));
        if !(from >= least && from <= most) && (to - from).abs() > WORTH_A_WORD {
            // More mass is less volume.
            let (limit, value) =
                if to < from { ("ballast_min_m3", p.ballast_min_m3) } else { ("ballast_max_m3", p.ballast_max_m3) };
            self.log.problem(
                Status::Warning,
                &format!(
                    "ballast_mass_kg = {from:?} kg lies beyond {limit} = {value:?} m3; the ballast was moved to {to:?} kg"
                ),
            );
        }
    }
}

/// What an event changed, in words.
fn news(before: DiscreteState, after: DiscreteState) -> String {
    let stop = |stop| match stop {
        Stop::Free => "free",
        Stop::AtMin => "at its minimum",
        Stop::AtMax => "at its maximum",
    };
    let mut news = Vec::new();
    if before.at_surface != after.at_surface {
        news.push(if after.at_surface { "at the surface".to_owned() } else { "left the surface".to_owned() });
    }
    if before.on_seabed != after.on_seabed {
        news.push(if after.on_seabed { "on the seabed".to_owned() } else { "left the seabed".to_owned() });
    }
    if before.modes.ballast != after.modes.ballast {
        news.push(format!("ballast {}", stop(after.modes.ballast)));
    }
    if before.modes.moving_mass != after.modes.moving_mass {
        news.push(format!("moving mass {}", stop(after.modes.moving_mass)));
    }
    for (i, step) in STEPS.iter().enumerate() {
        if before.has_stepped[i] != after.has_stepped[i] {
            news.push(format!("the step of the {} lies behind", step.of));
        }
    }
    news.join(", ")
}

fn fill(target: &mut [f64], source: &[f64], what: &str) -> Outcome {
    if target.len() != source.len() {
        return Err(wrong_length(target.len(), source.len(), what));
    }
    target.copy_from_slice(source);
    Ok(())
}

/// Refuses what is not finite, by the name of its place.
fn check_finite(instance: &Instance, values: &[f64], slot: fn(usize) -> Slot) -> Outcome {
    match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((i, value)) => Err(not_finite(instance.table().variable_of(slot(i)), *value)),
        None => Ok(()),
    }
}

fn wrong_length(found: usize, expected: usize, what: &str) -> Refusal {
    Refusal::error(format!("room for {found} {what}, expected {expected}"))
}
