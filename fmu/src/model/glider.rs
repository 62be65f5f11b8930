//! The values of all variables, and the equations that give the calculated ones.

use std::sync::Arc;

use glidepolar_dynamics::glide::{Start, start_in};
use glidepolar_dynamics::limits::{N_EVENTS, event_indicators, settle};
use glidepolar_dynamics::{
    Actuation, Inputs, Modes, N_STATES, Parameters, State, Stop, derivative, next_bend_s, outputs, servo_corners,
};
use glidepolar_environment::{WaterAt, WaterColumn};
use glidepolar_number::Number;

use super::table::{Discrete, N_OUTPUTS, Slot, output_array};

/// So far beyond surface or seabed the glider must be to have met it, and back to have left it \[m\]: right after an event
/// no indicator is zero, and each has the sign of its side.
const PAST_BOUNDARY_M: f64 = 1e-9;

/// The place of the energy among the states.
pub const ENERGY: usize = N_STATES - 1;

/// Everything that the glider is at one time: cloned to save and restored to go back, without allocation.
#[derive(Debug, Clone, PartialEq)]
pub struct Glider {
    /// What does not follow from anything else.
    pub values: Values<f64>,
    /// Who moves the moving mass and the ballast.
    pub actuation: Actuation,
    /// What changes at events only.
    pub discrete: DiscreteState,
    /// The water that travels with the glider's archive, if any does.
    pub column: Option<Arc<WaterColumn>>,
    /// Whether density and temperature come from that column and not from the inputs.
    pub uses_column: bool,
    /// Whether the start is the glide of the parameters that were set.
    pub starts_in_trim: bool,
}

/// The quantities that the equations read, in any kind of number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values<T> {
    /// Parameters.
    pub parameters: Parameters<T>,
    /// Time \[s\].
    pub time_s: T,
    /// Continuous states.
    pub state: State<T>,
    /// Inputs.
    pub inputs: Inputs<T>,
}

/// What changes at events only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DiscreteState {
    /// Where ballast and moving mass stand.
    pub modes: Modes,
    /// Whether the jump of drag lies behind.
    pub drag_has_stepped: bool,
    /// Whether the hull breaks the surface.
    pub at_surface: bool,
    /// Whether the hull touches the seabed.
    pub on_seabed: bool,
}

impl Glider {
    /// What the equations go by until the next event.
    pub fn rules(&self) -> Rules<'_> {
        let column = self.column.as_deref().filter(|_| self.uses_column);
        Rules { actuation: self.actuation, discrete: self.discrete, column }
    }

    /// Rates of change of the state.
    pub fn derivative(&self) -> State<f64> {
        self.rules().derivative(&self.values)
    }

    /// Functions whose change of sign is an event.
    pub fn indicators(&self) -> [f64; N_EVENTS] {
        let Values { parameters, time_s, state, inputs } = &self.values;
        let rules = self.rules();
        rules.published_indicators(&rules.parameters(parameters), *time_s, state, inputs)
    }

    /// Gives the states that start as others say their values.
    pub fn complete_start(&mut self) {
        if self.starts_in_trim
            && let Some(glide) = self.glide()
        {
            self.trim(&glide);
        }
        self.values.complete_start();
    }

    /// The steady glide down of these parameters, in the water at this depth, if there is one.
    pub fn glide(&self) -> Option<Start> {
        let Values { parameters, state, inputs, .. } = &self.values;
        let water = self.rules().inputs(state, inputs);
        let glide = start_in(parameters, |_| WaterAt {
            density_kg_m3: water.water_density_kg_m3,
            temperature_C: water.water_temperature_C,
        });
        (!glide.is_at_rest()).then_some(glide)
    }

    /// Puts the glider on this glide. Where, how deep and how much energy was drawn stays.
    fn trim(&mut self, glide: &Start) {
        // Where it is and what it has been through is not for the glide to say.
        let State { x_m, depth_m, creep_pressure_Pa, carried_density_kg_m3, leaked_back_m3, energy_J, .. } =
            self.values.state;
        let kept = State { creep_pressure_Pa, carried_density_kg_m3, leaked_back_m3, ..glide.state };
        self.values.state = State { x_m, depth_m, energy_J, ..kept };
        self.values.inputs.ballast_command_m3 = glide.inputs.ballast_command_m3;
        self.values.inputs.moving_mass_command_m = glide.inputs.moving_mass_command_m;
    }

    /// Brings the discrete state up to date with everything else. Returns whether a continuous state jumped.
    pub fn handle_event(&mut self) -> bool {
        let v = self.values;
        self.discrete.drag_has_stepped = v.time_s >= v.parameters.step_time_s;
        let rules = self.rules();
        let (active, inputs) = (rules.parameters(&v.parameters), rules.inputs(&v.state, &v.inputs));
        let (modes, state) = settle(&active, self.actuation, self.discrete.modes, v.time_s, &v.state, &inputs);
        self.discrete.modes = modes;
        self.values.state = state;
        self.discrete.at_surface = is_beyond(-state.depth_m, self.discrete.at_surface);
        self.discrete.on_seabed = is_beyond(state.depth_m - v.inputs.seabed_depth_m, self.discrete.on_seabed);
        state != v.state
    }

    /// When the next event comes that time alone brings.
    pub fn next_time_event_s(&self) -> Option<f64> {
        let p = &self.values.parameters;
        (p.drag_step != 0.0 && !self.discrete.drag_has_stepped).then_some(p.step_time_s)
    }

    /// A view that computes what is asked for once, and only if it is asked for.
    pub fn read(&self) -> Reading<'_> {
        Reading { glider: self, derivative: None, outputs: None, indicators: None }
    }

    /// Sets the kind of actuation; false when there is no such kind.
    pub fn set_actuation(&mut self, number: i32) -> bool {
        let Some(actuation) = actuation_of(number) else { return false };
        self.actuation = actuation;
        true
    }
}

/// What the equations go by between two events, whatever the kind of number.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    actuation: Actuation,
    discrete: DiscreteState,
    column: Option<&'a WaterColumn>,
}

impl Rules<'_> {
    /// The parameters as the equations must see them until the next event: whether the jump of drag lies behind is a
    /// mode, not a question of the time, so that no integrator meets the jump inside a step.
    pub fn parameters<T: Number>(&self, parameters: &Parameters<T>) -> Parameters<T> {
        let mut active = *parameters;
        if self.discrete.drag_has_stepped {
            active.step_time_s = T::constant(f64::NEG_INFINITY);
        } else {
            active.drag_step = T::constant(0.0);
        }
        active
    }

    /// The inputs, with the water of the column at this depth where there is one.
    pub fn inputs<T: Number>(&self, state: &State<T>, inputs: &Inputs<T>) -> Inputs<T> {
        match self.column {
            None => *inputs,
            Some(column) => {
                let water = column.at(state.depth_m);
                Inputs { water_density_kg_m3: water.density_kg_m3, water_temperature_C: water.temperature_C, ..*inputs }
            }
        }
    }

    /// Rates of change of the state.
    pub fn derivative<T: Number>(&self, values: &Values<T>) -> State<T> {
        let active = self.parameters(&values.parameters);
        self.rates(&active, values.time_s, &values.state, &values.inputs)
    }

    /// The same, from [`Rules::parameters`] made once: the right-hand side of an integrator.
    pub fn rates<T: Number>(
        &self,
        active: &Parameters<T>,
        time_s: T,
        state: &State<T>,
        inputs: &Inputs<T>,
    ) -> State<T> {
        derivative(active, self.actuation, self.discrete.modes, time_s, state, &self.inputs(state, inputs))
    }

    /// Functions whose change of sign is an event, from [`Rules::parameters`].
    pub fn indicators<T: Number>(
        &self,
        active: &Parameters<T>,
        time_s: T,
        state: &State<T>,
        inputs: &Inputs<T>,
    ) -> [T; N_EVENTS] {
        let inputs = self.inputs(state, inputs);
        let mut z = event_indicators(active, self.actuation, self.discrete.modes, time_s, state, &inputs);
        for (z, is_beyond) in z.iter_mut().zip([self.discrete.at_surface, self.discrete.on_seabed]) {
            *z += if is_beyond { -PAST_BOUNDARY_M } else { PAST_BOUNDARY_M };
        }
        z
    }

    /// The indicators that an importer's integrator watches. A servo never reaches the ends of ballast and moving mass; in
    /// their places stand its own corners, where the rates of change have a kink.
    pub fn published_indicators<T: Number>(
        &self,
        active: &Parameters<T>,
        time_s: T,
        state: &State<T>,
        inputs: &Inputs<T>,
    ) -> [T; N_EVENTS] {
        let mut z = self.indicators(active, time_s, state, inputs);
        if self.actuation == Actuation::Servo {
            z[2..].copy_from_slice(&servo_corners(active, state, inputs));
        }
        z
    }

    /// When the rates will bend, as far as that can be foreseen.
    pub fn next_bend_s(
        &self,
        active: &Parameters<f64>,
        time_s: f64,
        state: &State<f64>,
        inputs: &Inputs<f64>,
    ) -> Option<f64> {
        next_bend_s(active, self.actuation, time_s, state, inputs)
    }

    /// The outputs, in the order of the table.
    pub fn outputs<T: Number>(&self, values: &Values<T>) -> [T; N_OUTPUTS] {
        let inputs = self.inputs(&values.state, &values.inputs);
        let outputs = outputs(&self.parameters(&values.parameters), values.time_s, &values.state, &inputs);
        output_array(&outputs, &inputs)
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

/// -1, 0 or 1 for a stop.
pub fn stop_number(stop: Stop) -> i32 {
    match stop {
        Stop::AtMin => -1,
        Stop::Free => 0,
        Stop::AtMax => 1,
    }
}

fn with<T, const N: usize>(mut values: [T; N], index: usize, value: T) -> [T; N] {
    values[index] = value;
    values
}

/// Whether the glider is beyond a boundary, exactly where the indicator has that sign.
fn is_beyond(excess_m: f64, was_beyond: bool) -> bool {
    if was_beyond { excess_m > -PAST_BOUNDARY_M } else { excess_m >= PAST_BOUNDARY_M }
}

impl<T: Number> Values<T> {
    /// A number that does not follow from others.
    pub fn get(&self, slot: Slot) -> Option<T> {
        match slot {
            Slot::Time => Some(self.time_s),
            Slot::Input(i) => self.inputs.as_array().get(i).copied(),
            Slot::State(i) => self.state.as_array().get(i).copied(),
            Slot::Parameter(i) => self.parameters.as_array().get(i).copied(),
            _ => None,
        }
    }

    /// Sets a number that does not follow from others; nothing else can be set.
    pub fn set(&mut self, slot: Slot, value: T) {
        match slot {
            Slot::Time => self.time_s = value,
            Slot::Input(i) => self.inputs = Inputs::from_array(with(self.inputs.as_array(), i, value)),
            Slot::State(i) => self.state = State::from_array(with(self.state.as_array(), i, value)),
            Slot::Parameter(i) => *self.parameters.at(i) = value,
            _ => (),
        }
    }

    /// See [`Glider::complete_start`]: the moving mass starts at its height, at rest in the hull.
    pub fn complete_start(&mut self) {
        let (p, s) = (&self.parameters, &mut self.state);
        s.moving_mass_3_m = p.moving_mass_height_m;
        s.momentum_1_kg_m_s = p.moving_mass_kg * (s.v1_m_s + s.moving_mass_3_m * s.pitch_rate_rad_s);
        s.momentum_3_kg_m_s = p.moving_mass_kg * (s.v3_m_s - s.moving_mass_1_m * s.pitch_rate_rad_s);
    }
}

/// Computes each group of calculated variables at most once.
pub struct Reading<'a> {
    glider: &'a Glider,
    derivative: Option<[f64; N_STATES]>,
    outputs: Option<[f64; N_OUTPUTS]>,
    indicators: Option<[f64; N_EVENTS]>,
}

impl Reading<'_> {
    /// The number in this place.
    pub fn real(&mut self, slot: Slot) -> Option<f64> {
        let glider = self.glider;
        let values = &glider.values;
        Some(match slot {
            Slot::Derivative(i) => self.derivative.get_or_insert_with(|| glider.derivative().as_array())[i],
            Slot::Power => self.derivative.get_or_insert_with(|| glider.derivative().as_array())[ENERGY],
            Slot::Output(i) => self.outputs.get_or_insert_with(|| glider.rules().outputs(values))[i],
            Slot::Indicator(i) => self.indicators.get_or_insert_with(|| glider.indicators())[i],
            slot => return values.get(slot),
        })
    }

    /// The integer in this place.
    pub fn integer(&self, slot: Slot) -> Option<i32> {
        let modes = self.glider.discrete.modes;
        match slot {
            Slot::Actuation => Some(actuation_number(self.glider.actuation)),
            Slot::WaterSource => Some(i32::from(self.glider.uses_column)),
            Slot::StartInTrim => Some(i32::from(self.glider.starts_in_trim)),
            Slot::Discrete(Discrete::BallastStop) => Some(stop_number(modes.ballast)),
            Slot::Discrete(Discrete::MovingMassStop) => Some(stop_number(modes.moving_mass)),
            _ => None,
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
