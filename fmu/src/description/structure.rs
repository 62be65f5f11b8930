//! Which variable follows from which: found by the exact derivatives themselves, at many points of every mode, so that
//! the declared structure cannot differ from the equations.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use glidepolar_dynamics::state::N_INPUTS;
use glidepolar_dynamics::{Modes, N_STATES, PARAMETERS, Stop, parameter_index};

use glidepolar_environment::WaterColumn;

use crate::model::glider::{Glider, actuation_of};
use crate::model::table::{reference_of, variable_of};
use crate::model::tangent::Tangent;
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Initial, Kind, Slot, Variable, variables};

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

/// The structure of the model.
pub fn structure() -> Structure {
    let states = || (0..N_STATES).map(Slot::State);
    let running: Vec<Slot> = [Slot::Time].into_iter().chain((0..N_INPUTS).map(Slot::Input)).chain(states()).collect();
    let at_start: Vec<Slot> = variables()
        .iter()
        .filter(|v| v.kind == Kind::Real && (v.initial == Some(Initial::Exact) || v.slot == Slot::Time))
        .map(|v| v.slot)
        .collect();
    let running = Probe { knowns: running, starting: false };
    let starting = Probe { knowns: at_start, starting: true };

    let of_all = |probe: &Probe, wanted: &dyn Fn(&Variable) -> bool| {
        let wanted: Vec<&Variable> = variables().iter().filter(|v| wanted(v)).collect();
        probe.unknowns(&wanted)
    };
    // Their order here is that of the states in every call, whatever their value references.
    let derivatives: Vec<&Variable> = (0..N_STATES).map(|i| variable_of(Slot::Derivative(i))).collect();
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
    knowns: Vec<Slot>,
    starting: bool,
}

impl Probe {
    fn unknowns(&self, wanted: &[&Variable]) -> Vec<Unknown> {
        let mut found: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); wanted.len()];
        let parameter = |name| Slot::Parameter(parameter_index(name).expect("a parameter of the library"));
        let (drag_step, step_time) = (parameter("drag_step"), parameter("step_time_s"));
        // Density and temperature.
        let water = [Slot::Input(5), Slot::Input(6)];
        for glider in points() {
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
                        (Slot::Actuation, depends_on_actuation(&glider, variable.slot)),
                        (Slot::StartInTrim, depends_on_trim(&glider, variable.slot)),
                        (step_time, found.contains(&reference_of(drag_step))),
                        (Slot::WaterSource, water.iter().any(|input| found.contains(&reference_of(*input)))),
                    ];
                    found
                        .extend(switches.iter().filter(|(_, switches)| *switches).map(|(slot, _)| reference_of(*slot)));
                }
            }
        }
        let unknown = |(variable, found): (&&Variable, BTreeSet<u32>)| Unknown {
            reference: reference_of(variable.slot),
            dependencies: found.into_iter().collect(),
        };
        wanted.iter().zip(found).map(unknown).collect()
    }
}

fn depends_on_actuation(glider: &Glider, slot: Slot) -> bool {
    let value = |number| {
        let mut glider = glider.clone();
        glider.set_actuation(number);
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

/// Gliders of every kind of actuation and mode, in free water, at the surface and on the seabed, with every mechanism
/// at work and no number at a special value.
fn points() -> Vec<Glider> {
    const DEPTHS_M: [f64; 3] = [37.3, -0.013, 119.7];
    const STOPS: [Stop; 3] = [Stop::Free, Stop::AtMin, Stop::AtMax];
    let column = "depth_m,density_kg_m3,temperature_C\n0,1020,20\n30,1024,15\n60,1027,9\n200,1030,4\n";
    let column = Arc::new(WaterColumn::parse(column, Path::new("column")).expect("a column of water"));
    let mut odd = OddNumbers(0x9e37_79b9_7f4a_7c15);
    let mut points = Vec::new();
    for depth in DEPTHS_M {
        for actuation in [0, 1, 2] {
            for stop in STOPS {
                // Of either sign: a pump costs energy in one direction only.
                for command in [1.0, 1e-3, -1.0, -1e-3] {
                    let gliding = point(&mut odd, depth, actuation, stop, command);
                    let mut turning = gliding.clone();
                    let state = &mut turning.values.state;
                    // Descents and ascents pass into each other at sink rates of millimetres per second.
                    state.pitch_rad = state.v3_m_s.atan2(state.v1_m_s) - 0.01;
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

fn point(odd: &mut OddNumbers, depth: f64, actuation: i32, stop: Stop, command: f64) -> Glider {
    let mut glider = Vehicle::default().glider;
    let values = &mut glider.values;
    for (i, info) in PARAMETERS.iter().enumerate() {
        let place = values.parameters.at(i);
        *place = if info.default == 0.0 {
            (0.01 * info.max.min(1.0) * odd.next()).max(info.min)
        } else {
            (info.default * (1.0 + 0.01 * odd.next())).clamp(info.min, info.max)
        };
    }
    // Shorter ones than a second are one.
    values.parameters.creep_time_s = 100.0 * odd.next();
    values.parameters.exchange_time_s = 100.0 * odd.next();
    values.time_s = 3.7;
    values.state = values.state.map(|value| value + 0.01 * odd.next());
    values.inputs = values.inputs.map(|value| value + 0.01 * odd.next() * command.signum());
    values.state.depth_m = depth;
    values.inputs.seabed_depth_m = 119.6;
    // A set-point near the position is followed in proportion, one far away at the largest rate.
    values.inputs.ballast_command_m3 = values.parameters.ballast_m3(values.state.ballast_mass_kg) + 1e-4 * command;
    values.inputs.moving_mass_command_m = values.state.moving_mass_1_m + 0.05 * command;
    glider.actuation = actuation_of(actuation).expect("a kind of actuation");
    if actuation != 0 {
        glider.discrete.modes = Modes { ballast: stop, moving_mass: stop };
    }
    glider.discrete.drag_has_stepped = true;
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
