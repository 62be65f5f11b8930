//! The values of all variables, and the equations that give the calculated ones.

use glidepolar::Number;
use glidepolar::dynamics::limits::{N_EVENTS, event_indicators, settle};
use glidepolar::dynamics::{Actuation, Inputs, Modes, N_STATES, Outputs, Parameters, State, Stop, derivative, outputs};

use super::table::{Discrete, N_OUTPUTS, Slot};

/// Depth or height within which the direction of motion tells on which side of a boundary the glider is \[m\].
const BOUNDARY_M: f64 = 1e-6;

/// Everything that the glider is at one time: plain numbers, copied to save and restored to go back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glider {
    /// What does not follow from anything else.
    pub values: Values<f64>,
    /// Who moves the moving mass and the ballast.
    pub actuation: Actuation,
    /// What changes at events only.
    pub discrete: DiscreteState,
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
    /// Rates of change of the state.
    pub fn derivative(&self) -> State<f64> {
        let Values { time_s, state, inputs, .. } = &self.values;
        derivative(&self.active_parameters(), self.actuation, self.discrete.modes, *time_s, state, inputs)
    }

    /// Functions whose change of sign is an event.
    pub fn indicators(&self) -> [f64; N_EVENTS] {
        let Values { time_s, state, inputs, .. } = &self.values;
        event_indicators(&self.active_parameters(), self.actuation, self.discrete.modes, *time_s, state, inputs)
    }

    /// The parameters as the equations must see them until the next event: whether the jump of drag lies behind is a
    /// mode, not a question of the time, so that no integrator meets the jump inside a step.
    pub fn active_parameters(&self) -> Parameters<f64> {
        self.values.active_parameters(self.discrete)
    }

    /// Gives the states that start as others say their values.
    pub fn complete_start(&mut self) {
        self.values.complete_start();
    }

    /// Brings the discrete state up to date with everything else. Returns whether a continuous state jumped.
    pub fn handle_event(&mut self) -> bool {
        let v = self.values;
        self.discrete.drag_has_stepped = v.time_s >= v.parameters.step_time_s;
        let active = self.active_parameters();
        let (modes, state) = settle(&active, self.actuation, self.discrete.modes, v.time_s, &v.state, &v.inputs);
        self.discrete.modes = modes;
        self.values.state = state;
        let depth_rate = self.derivative().depth_m;
        self.discrete.at_surface = is_beyond(-state.depth_m, -depth_rate);
        self.discrete.on_seabed = is_beyond(state.depth_m - v.inputs.seabed_depth_m, depth_rate);
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

fn is_beyond(excess_m: f64, rate_m_s: f64) -> bool {
    if excess_m.abs() > BOUNDARY_M { excess_m > 0.0 } else { rate_m_s > 0.0 }
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

    /// See [`Glider::active_parameters`].
    pub fn active_parameters(&self, discrete: DiscreteState) -> Parameters<T> {
        let mut active = self.parameters;
        if discrete.drag_has_stepped {
            active.step_time_s = T::constant(f64::NEG_INFINITY);
        } else {
            active.drag_step = T::constant(0.0);
        }
        active
    }

    /// The outputs, in the order of the table.
    pub fn outputs(&self, discrete: DiscreteState) -> [T; N_OUTPUTS] {
        output_array(&outputs(&self.active_parameters(discrete), self.time_s, &self.state, &self.inputs))
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
            Slot::Output(i) => self.outputs.get_or_insert_with(|| values.outputs(glider.discrete))[i],
            Slot::Indicator(i) => self.indicators.get_or_insert_with(|| glider.indicators())[i],
            slot => return values.get(slot),
        })
    }

    /// The integer in this place.
    pub fn integer(&self, slot: Slot) -> Option<i32> {
        let modes = self.glider.discrete.modes;
        match slot {
            Slot::Actuation => Some(actuation_number(self.glider.actuation)),
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

fn output_array<T: Copy>(outputs: &Outputs<T>) -> [T; N_OUTPUTS] {
    [
        outputs.glide_angle_rad,
        outputs.angle_of_attack_rad,
        outputs.speed_m_s,
        outputs.vertical_velocity_m_s,
        outputs.net_mass_kg,
        outputs.ballast_m3,
        outputs.lift_N,
        outputs.drag_N,
        outputs.pitching_moment_N_m,
        outputs.pitch_read_rad,
        outputs.pressure_read_dbar,
    ]
}
