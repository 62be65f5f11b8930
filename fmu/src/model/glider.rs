//! The calculated values of a glider: which model's equations give them.

use glidepolar_dynamics::{Actuation, Stop};
use glidepolar_number::Number;
use glidepolar_spatial::Steering;

pub use super::rules::{DiscreteState, Glider, Rules};
use super::rules::{PAST_BOUNDARY_M, is_beyond};
use super::values::{MOST_EVENTS, MOST_OUTPUTS, MOST_STATES, Values};
use super::variable::{Discrete, Slot};
use super::which::Model;
use super::{plane, space};

impl Glider {
    /// Rates of change of the state, one for each state.
    pub fn derivative(&self) -> [f64; MOST_STATES] {
        self.rules().derivative(&self.values)
    }

    /// Functions whose change of sign is an event.
    pub fn indicators(&self) -> [f64; MOST_EVENTS] {
        self.rules().published_indicators(&self.values)
    }

    /// Gives the states that start as others say their values.
    pub fn complete_start(&mut self) {
        if self.starts_in_trim {
            match self.model {
                Model::Plane => plane::trim(self),
                Model::Space => space::trim(self),
            }
        }
        complete_start(self.model, &mut self.values);
    }

    /// Brings the discrete state of a start in line with it: a glider that begins afloat has not surfaced.
    pub fn begin(&mut self) {
        self.discrete.at_surface = is_beyond(-self.depth_m(), false, PAST_BOUNDARY_M);
        self.handle_event();
    }

    /// Whether these parameters have a steady glide down in this water.
    pub fn has_glide(&self) -> bool {
        match self.model {
            Model::Plane => plane::glide(self).is_some(),
            Model::Space => space::glide(self).is_some(),
        }
    }

    /// Brings the discrete state up to date with everything else. Returns whether a continuous state jumped.
    pub fn handle_event(&mut self) -> bool {
        let parameters = self.parameters();
        self.discrete.has_stepped = parameters.steps().map(|(_, at_s)| self.values.time_s >= at_s);
        let before = self.values.state;
        let seabed_depth_m = match self.model {
            Model::Plane => plane::settle(self),
            Model::Space => space::seabed_depth_m(self),
        };
        let depth_m = self.depth_m();
        let was_at_surface = self.discrete.at_surface;
        self.discrete.at_surface = is_beyond(-depth_m, was_at_surface, PAST_BOUNDARY_M);
        if self.discrete.at_surface && !was_at_surface {
            self.values.state[self.model.energy()] += parameters.surfacing_J;
        }
        let below_m = depth_m - seabed_depth_m;
        self.discrete.on_seabed = is_beyond(below_m, self.discrete.on_seabed, PAST_BOUNDARY_M);
        self.corners = match self.model {
            Model::Plane => self.corners.brought_to(&plane::corners(&self.rules(), &self.values)),
            Model::Space => self.corners.brought_to(&space::corners(&self.rules(), &self.values)),
        };
        self.values.state != before
    }

    /// When the next event comes that time alone brings.
    pub fn next_time_event_s(&self) -> Option<f64> {
        let steps = self.parameters().steps().into_iter().zip(self.discrete.has_stepped);
        let ahead = steps.filter(|((size, _), has_stepped)| *size != 0.0 && !has_stepped);
        ahead.map(|((_, at_s), _)| at_s).reduce(f64::min)
    }

    /// A view that computes what is asked for once, and only if it is asked for.
    pub fn read(&self) -> Reading<'_> {
        Reading { glider: self, derivative: None, outputs: None, indicators: None }
    }

    /// The integer of a choice.
    pub fn choice(&self, slot: Slot) -> Option<i32> {
        Some(match slot {
            Slot::Actuation => actuation_number(self.actuation),
            Slot::Steering => steering_number(self.steering),
            Slot::WaterSource => i32::from(self.uses_column),
            Slot::StartInTrim => i32::from(self.starts_in_trim),
            _ => return None,
        })
    }

    /// Sets a choice; false when there is no such choice.
    pub fn choose(&mut self, slot: Slot, number: i32) -> bool {
        match (slot, actuation_of(number), steering_of(number)) {
            (Slot::Actuation, Some(actuation), _) => self.actuation = actuation,
            (Slot::Steering, _, Some(steering)) => self.steering = steering,
            (Slot::WaterSource, ..) => self.uses_column = number == 1,
            (Slot::StartInTrim, ..) => self.starts_in_trim = number == 1,
            _ => return false,
        }
        true
    }
}

impl Rules<'_> {
    /// Rates of change of the state.
    pub fn derivative<T: Number>(&self, values: &Values<T>) -> [T; MOST_STATES] {
        match self.model {
            Model::Plane => plane::derivative(self, values),
            Model::Space => space::derivative(self, values),
        }
    }

    /// The indicators that an importer's integrator watches.
    pub fn published_indicators<T: Number>(&self, values: &Values<T>) -> [T; MOST_EVENTS] {
        match self.model {
            Model::Plane => plane::published_indicators(self, values),
            Model::Space => space::published_indicators(self, values),
        }
    }

    /// The outputs, in the order of the table.
    pub fn outputs<T: Number>(&self, values: &Values<T>) -> [T; MOST_OUTPUTS] {
        match self.model {
            Model::Plane => plane::outputs(self, values),
            Model::Space => space::outputs(self, values),
        }
    }
}

/// Gives the states that start as others say their values, in any kind of number: see [`Glider::complete_start`].
pub(super) fn complete_start<T: Number>(model: Model, values: &mut Values<T>) {
    if model == Model::Plane {
        plane::complete_start(values);
    }
}

/// The kind of actuation of this number.
pub fn actuation_of(number: i32) -> Option<Actuation> {
    match number {
        0 => Some(Actuation::Servo),
        1 => Some(Actuation::Raw),
        2 => Some(Actuation::RawAlongAxis1),
        _ => None,
    }
}

/// The number of this kind of actuation.
pub fn actuation_number(actuation: Actuation) -> i32 {
    match actuation {
        Actuation::Servo => 0,
        Actuation::Raw => 1,
        Actuation::RawAlongAxis1 => 2,
    }
}

/// The kind of steering of this number.
pub fn steering_of(number: i32) -> Option<Steering> {
    match number {
        0 => Some(Steering::Direct),
        1 => Some(Steering::HeadingByRudder),
        2 => Some(Steering::HeadingByRollMass),
        _ => None,
    }
}

/// The number of this kind of steering.
pub fn steering_number(steering: Steering) -> i32 {
    match steering {
        Steering::Direct => 0,
        Steering::HeadingByRudder => 1,
        Steering::HeadingByRollMass => 2,
    }
}

/// -1, 0 or 1 for a stop.
pub fn stop_number(stop: Stop) -> i32 {
    match stop {
        Stop::AtMin => -1,
        Stop::Free => 0,
        Stop::AtMax => 1,
    }
}

/// Computes each group of calculated variables at most once.
pub struct Reading<'a> {
    glider: &'a Glider,
    derivative: Option<[f64; MOST_STATES]>,
    outputs: Option<[f64; MOST_OUTPUTS]>,
    indicators: Option<[f64; MOST_EVENTS]>,
}

impl Reading<'_> {
    /// The number in this place.
    pub fn real(&mut self, slot: Slot) -> Option<f64> {
        let glider = self.glider;
        let values = &glider.values;
        Some(match slot {
            Slot::Derivative(i) => self.derivative.get_or_insert_with(|| glider.derivative())[i],
            Slot::Power => self.derivative.get_or_insert_with(|| glider.derivative())[glider.model.energy()],
            Slot::Output(i) => self.outputs.get_or_insert_with(|| glider.rules().outputs(values))[i],
            Slot::Indicator(i) => self.indicators.get_or_insert_with(|| glider.indicators())[i],
            slot => return values.get(slot),
        })
    }

    /// The integer in this place.
    pub fn integer(&self, slot: Slot) -> Option<i32> {
        let modes = self.glider.discrete.modes;
        match slot {
            Slot::Discrete(Discrete::BallastStop) => Some(stop_number(modes.ballast)),
            Slot::Discrete(Discrete::MovingMassStop) => Some(stop_number(modes.moving_mass)),
            slot => self.glider.choice(slot),
        }
    }

    /// The truth in this place.
    pub fn boolean(&self, slot: Slot) -> Option<bool> {
        match slot {
            Slot::Discrete(Discrete::AtSurface) => Some(self.glider.discrete.at_surface),
            Slot::Discrete(Discrete::OnSeabed) => Some(self.glider.discrete.on_seabed),
            _ => None,
        }
    }
}
