//! Which variable follows from which: found by the exact derivatives themselves, at many points of every mode, so that
//! the declared structure cannot differ from the equations.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use glidepolar_dynamics::steps::{N_STEPS, STEPS};
use glidepolar_dynamics::{Modes, PARAMETERS, Parameters, State, Stop};
use glidepolar_environment::WaterColumn;
use glidepolar_spatial::LATERAL;

use crate::model::glider::{Glider, actuation_of, steering_of};
use crate::model::tangent::Tangent;
use crate::model::values::{head, row};
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Initial, Kind, Model, Slot, Variable};

/// A calculated variable and the value references of those that it follows from.
pub struct Unknown {
    /// Its value reference.
    pub reference: u32,
    /// What it follows from. Always a list: leaving it out, which would mean all that is known, is beyond some importers
    /// (CasADi 3.8).
    pub dependencies: Vec<u32>,
}

/// The structure of the model.
pub struct Structure {
    /// All outputs.
    pub outputs: Vec<Unknown>,
    /// The derivatives, in the order of the states.
    pub derivatives: Vec<Unknown>,
    /// What is calculated at the start.
    pub initial: Vec<Unknown>,
    /// The event indicators.
    pub indicators: Vec<Unknown>,
}

/// The structure of a model.
pub fn structure(model: Model) -> Structure {
    let table = model.table();
    let (states, inputs) = ((0..model.n_states()).map(Slot::State), (0..model.n_inputs()).map(Slot::Input));
    let running: Vec<Slot> = [Slot::Time].into_iter().chain(inputs).chain(states).collect();
    let at_start: Vec<Slot> = table
        .rows
        .iter()
        .filter(|v| v.kind == Kind::Real && (v.initial == Some(Initial::Exact) || v.slot == Slot::Time))
        .map(|v| v.slot)
        .collect();
    let running = Probe { model, knowns: running, starting: false };
    let starting = Probe { model, knowns: at_start, starting: true };

    let of_all = |probe: &Probe, wanted: &dyn Fn(&Variable) -> bool| {
        let wanted: Vec<&Variable> = table.rows.iter().filter(|v| wanted(v)).collect();
        probe.unknowns(&wanted)
    };
    // Their order here is that of the states in every call, whatever their value references.
    let derivatives: Vec<&Variable> = (0..model.n_states()).map(|i| table.variable_of(Slot::Derivative(i))).collect();
    let calculated_at_start = |v: &Variable| {
        v.follows_at_start()
            && (v.causality == Causality::Output || matches!(v.slot, Slot::State(_) | Slot::Derivative(_)))
    };
    Structure {
        outputs: of_all(&running, &|v| v.causality == Causality::Output),
        derivatives: running.unknowns(&derivatives),
        initial: of_all(&starting, &calculated_at_start),
        indicators: of_all(&running, &|v| matches!(v.slot, Slot::Indicator(_))),
    }
}

/// Asks which of some unknowns move with which of the knowns.
struct Probe {
    model: Model,
    knowns: Vec<Slot>,
    starting: bool,
}

impl Probe {
    fn unknowns(&self, wanted: &[&Variable]) -> Vec<Unknown> {
        let mut found: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); wanted.len()];
        let table = self.model.table();
        let slot = |name| table.slot_of(name).expect("a variable of every model");
        let reference_of = |slot| table.reference_of(slot);
        let steps = STEPS.map(|step| (slot(step.size), slot(step.time)));
        let water = [slot("water_density_kg_m3"), slot("water_temperature_C")];
        let steering = match self.model {
            Model::Plane => Slot::Actuation,
            Model::Space => Slot::Steering,
        };
        for glider in points(self.model) {
            for &known in &self.knowns {
                let tangent = Tangent::along(&glider, self.starting, [(known, 1.0)]);
                for (variable, found) in wanted.iter().zip(&mut found) {
                    if tangent.of(variable.slot).is_some_and(|change| change != 0.0) {
                        found.insert(reference_of(known));
                    }
                }
            }
            if self.starting {
                for (variable, found) in wanted.iter().zip(&mut found) {
                    let switches = [
                        (steering, depends_on_choice(&glider, steering, variable.slot)),
                        (Slot::StartInTrim, depends_on_trim(&glider, variable.slot)),
                        (Slot::WaterSource, water.iter().any(|input| found.contains(&reference_of(*input)))),
                    ];
                    let at_steps = steps.map(|(size, at_s)| (at_s, found.contains(&reference_of(size))));
                    let switches = switches.iter().chain(&at_steps).filter(|(_, switches)| *switches);
                    found.extend(switches.map(|(slot, _)| reference_of(*slot)));
                }
            }
        }
        let unknown = |(variable, found): (&&Variable, BTreeSet<u32>)| Unknown {
            reference: variable.reference,
            dependencies: found.into_iter().collect(),
        };
        wanted.iter().zip(found).map(unknown).collect()
    }
}

fn depends_on_choice(glider: &Glider, choice: Slot, slot: Slot) -> bool {
    let value = |number| {
        let mut glider = glider.clone();
        glider.choose(choice, number);
        glider.read().real(slot)
    };
    value(0) != value(1) || value(1) != value(2)
}

fn depends_on_trim(glider: &Glider, slot: Slot) -> bool {
    let mut trimmed = glider.clone();
    trimmed.starts_in_trim = true;
    trimmed.complete_start();
    let mut free = glider.clone();
    free.complete_start();
    trimmed.read().real(slot) != free.read().real(slot)
}

/// Gliders of every kind of actuation, steering and mode, in free water, at the surface and on the seabed, with every
/// mechanism at work and no number at a special value.
fn points(model: Model) -> Vec<Glider> {
    const DEPTHS_M: [f64; 3] = [37.3, -0.013, 119.7];
    const STOPS: [Stop; 3] = [Stop::Free, Stop::AtMin, Stop::AtMax];
    let column = "depth_m,density_kg_m3,temperature_C\n0,1020,20\n30,1024,15\n60,1027,9\n200,1030,4\n";
    let column = Arc::new(WaterColumn::parse(column, Path::new("column")).expect("a column of water"));
    let stops = match model {
        Model::Plane => &STOPS[..],
        Model::Space => &STOPS[..1],
    };
    let mut odd = OddNumbers(0x9e37_79b9_7f4a_7c15);
    let mut points = Vec::new();
    for depth in DEPTHS_M {
        for choice in [0, 1, 2] {
            for stop in stops {
                // Of either sign: a pump costs energy in one direction only.
                for command in [1.0, 1e-3, -1.0, -1e-3] {
                    let gliding = point(&mut odd, model, depth, choice, *stop, command);
                    let turning = between_legs(&gliding);
                    let in_column = [&gliding, &turning].map(|glider| Glider {
                        column: Some(column.clone()),
                        uses_column: true,
                        ..glider.clone()
                    });
                    points.extend([gliding, turning]);
                    points.extend(in_column);
                }
            }
        }
    }
    points
}

/// The same glider where it neither sinks nor rises by much: descents and ascents pass into each other at sink rates of
/// millimetres per second.
fn between_legs(glider: &Glider) -> Glider {
    let mut turning = glider.clone();
    let state = &mut turning.values.state;
    match glider.model {
        Model::Plane => {
            let mut it = State::from_array(head(state));
            it.pitch_rad = it.v3_m_s.atan2(it.v1_m_s) - 0.01;
            *state = row(it.as_array());
        }
        Model::Space => {
            let mut it = glidepolar_spatial::State::from_array(*state);
            let sideways = it.v2_m_s * it.roll_rad.sin() + it.v3_m_s * it.roll_rad.cos();
            it.pitch_rad = sideways.atan2(it.v1_m_s) - 0.01;
            *state = it.as_array();
        }
    }
    turning
}

fn point(odd: &mut OddNumbers, model: Model, depth: f64, choice: i32, stop: Stop, command: f64) -> Glider {
    let mut glider = Vehicle::built_in(model).glider;
    let lateral = if model == Model::Space { LATERAL } else { &[] };
    for (i, info) in PARAMETERS.iter().chain(lateral).enumerate() {
        glider.values.parameters[i] = if info.default == 0.0 {
            (0.01 * info.max.min(1.0) * odd.next()).max(info.min)
        } else {
            (info.default * (1.0 + 0.01 * odd.next())).clamp(info.min, info.max)
        };
    }
    let table = model.table();
    let set = |glider: &mut Glider, name: &str, value: f64| {
        glider.values.set(table.slot_of(name).expect("a variable of the model"), value);
    };
    // Shorter ones than a second are one.
    set(&mut glider, "creep_time_s", 100.0 * odd.next());
    set(&mut glider, "exchange_time_s", 100.0 * odd.next());
    set(&mut glider, "expansion_time_s", 100.0 * odd.next());
    let values = &mut glider.values;
    values.time_s = 3.7;
    values.state[..model.n_states()].iter_mut().for_each(|value| *value += 0.01 * odd.next());
    values.inputs[..model.n_inputs()].iter_mut().for_each(|value| *value += 0.01 * odd.next() * command.signum());
    set(&mut glider, "depth_m", depth);
    set(&mut glider, "seabed_depth_m", 119.6);
    // A set-point near the position is followed in proportion, one far away at the largest rate.
    let parameters = Parameters::from_array(head(&glider.values.parameters));
    let get = |glider: &Glider, name: &str| {
        table.slot_of(name).and_then(|slot| glider.values.get(slot)).expect("a variable of the model")
    };
    let (ballast, mass) = (get(&glider, "ballast_mass_kg"), get(&glider, "moving_mass_position_m"));
    set(&mut glider, "ballast_command_m3", parameters.ballast_m3(ballast) + 1e-4 * command);
    set(&mut glider, "moving_mass_command_m", mass + 0.05 * command);
    match model {
        Model::Plane => {
            glider.actuation = actuation_of(choice).expect("a kind of actuation");
            if choice != 0 {
                glider.discrete.modes = Modes { ballast: stop, moving_mass: stop };
            }
        }
        Model::Space => {
            glider.steering = steering_of(choice).expect("a kind of steering");
            let (roll, rudder) = (get(&glider, "roll_mass_rad"), get(&glider, "rudder_rad"));
            for limit in ["rudder_max_rad", "roll_mass_max_rad"] {
                set(&mut glider, limit, 2.0);
            }
            for limit in ["rudder_min_rad", "roll_mass_min_rad"] {
                set(&mut glider, limit, -2.0);
            }
            set(&mut glider, "roll_mass_command_rad", roll + 0.3 * command);
            set(&mut glider, "rudder_command_rad", rudder + 0.3 * command);
            // Within the largest rates of the servos with steering, too, and beyond the dead band.
            let heading = get(&glider, "heading_rad") + 0.02 * odd.next();
            set(&mut glider, "heading_command_rad", heading);
            for gain in ["heading_rudder_gain", "heading_roll_gain_descent", "heading_roll_gain_ascent"] {
                set(&mut glider, gain, odd.next());
            }
        }
    }
    glider.discrete.has_stepped = [true; N_STEPS];
    glider
}

/// Numbers between 0.5 and 1.5 without any pattern (xorshift).
struct OddNumbers(u64);

impl OddNumbers {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        0.5 + (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}
