//! Where a simulation starts when nothing else is said: in a steady glide down.

use super::{SteadyGlide, at_path};
use crate::{Inputs, Parameters, State, Surroundings};
use glidepolar_environment::WaterAt;

/// Path angle of the glide down \[deg\]; steeper by [`STEEPER_DEG`] where the glider cannot fly that shallow or its
/// ballast or moving mass does not reach.
const PATH_DEG: f64 = -25.0;
const STEEPER_DEG: f64 = 5.0;
const STEEPEST_DEG: f64 = -80.0;

/// Speed through the water \[m/s\].
const SPEED_M_S: f64 = 0.30;

/// Depth at which the simulation starts \[m\].
const DEPTH_M: f64 = 10.0;

/// A state and the commands that hold it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// The state at the start.
    pub state: State<f64>,
    /// Commands and water at the start: still water of the reference density and temperature.
    pub inputs: Inputs<f64>,
}

impl Start {
    /// Whether no steady glide down was within reach.
    pub fn is_at_rest(&self) -> bool {
        self.state.v1_m_s == 0.0
    }

    /// The same start for a glider with other parameters, which need not glide steadily in it: depth, attitude,
    /// velocities and commands stay, the moving mass sits at its height and at rest in the hull. So starts an FMU whose
    /// parameters were set.
    pub fn with(&self, parameters: &Parameters<f64>) -> Start {
        let (p, s) = (parameters, &self.state);
        let state = State {
            moving_mass_3_m: p.moving_mass_height_m,
            momentum_1_kg_m_s: p.moving_mass_kg * (s.v1_m_s + p.moving_mass_height_m * s.pitch_rate_rad_s),
            momentum_3_kg_m_s: p.moving_mass_kg * (s.v3_m_s - s.moving_mass_1_m * s.pitch_rate_rad_s),
            ..*s
        };
        Start { state, inputs: self.inputs }
    }
}

impl SteadyGlide<f64> {
    /// Whether ballast and moving mass reach what it takes.
    pub fn is_within_reach(&self, p: &Parameters<f64>) -> bool {
        (p.ballast_min_m3..=p.ballast_max_m3).contains(&self.ballast_m3)
            && (p.moving_mass_min_m..=p.moving_mass_max_m).contains(&self.moving_mass_m)
    }

    /// The state of a glider in this glide at a depth \[m\], its moving mass at rest in the hull.
    pub fn state(&self, parameters: &Parameters<f64>, depth_m: f64) -> State<f64> {
        State {
            x_m: 0.0,
            depth_m,
            pitch_rad: self.pitch_rad,
            pitch_rate_rad_s: 0.0,
            v1_m_s: self.v1_m_s,
            v3_m_s: self.v3_m_s,
            moving_mass_1_m: self.moving_mass_m,
            moving_mass_3_m: parameters.moving_mass_height_m,
            momentum_1_kg_m_s: parameters.moving_mass_kg * self.v1_m_s,
            momentum_3_kg_m_s: parameters.moving_mass_kg * self.v3_m_s,
            ballast_mass_kg: self.ballast_mass_kg,
            creep_pressure_Pa: 0.0,
            carried_density_kg_m3: 0.0,
            late_temperature_K: 0.0,
            leaked_back_m3: 0.0,
            energy_J: 0.0,
        }
    }
}

/// The start of this glider: at 10 m depth, in the steady glide down at 25 deg and 0.30 m/s with the commands that hold
/// it; level and at rest where no such glide exists.
pub fn start(parameters: &Parameters<f64>) -> Start {
    let p = parameters;
    start_in(p, |_| WaterAt { density_kg_m3: p.reference_density_kg_m3, temperature_C: p.reference_temperature_C })
}

/// The same start in water that is not that of the reference: `water` gives it at a depth \[m\].
pub fn start_in(parameters: &Parameters<f64>, water: impl Fn(f64) -> WaterAt<f64>) -> Start {
    let p = parameters;
    let water = water(DEPTH_M);
    let mut inputs = Inputs::still_water(water.density_kg_m3, water.temperature_C);
    let mut state = State {
        x_m: 0.0,
        depth_m: DEPTH_M,
        pitch_rad: 0.0,
        pitch_rate_rad_s: 0.0,
        v1_m_s: 0.0,
        v3_m_s: 0.0,
        moving_mass_1_m: 0.0,
        moving_mass_3_m: p.moving_mass_height_m,
        momentum_1_kg_m_s: 0.0,
        momentum_3_kg_m_s: 0.0,
        ballast_mass_kg: p.ballast_nominal_kg,
        creep_pressure_Pa: 0.0,
        carried_density_kg_m3: 0.0,
        late_temperature_K: 0.0,
        leaked_back_m3: 0.0,
        energy_J: 0.0,
    };
    if let Some(glide) = glide_down(p, &inputs) {
        inputs.ballast_command_m3 = glide.ballast_m3;
        inputs.moving_mass_command_m = glide.moving_mass_m;
        state = glide.state(p, DEPTH_M);
    }
    // What a glider carries is the water in which it starts.
    let water = surroundings(p, &inputs);
    state.carried_density_kg_m3 = p.carried_from_kg_m3(&water);
    state.late_temperature_K = p.warmer_than_reference_K(&water);
    Start { state, inputs }
}

fn surroundings(p: &Parameters<f64>, inputs: &Inputs<f64>) -> Surroundings<f64> {
    Surroundings {
        density_kg_m3: inputs.water_density_kg_m3,
        pressure_Pa: p.true_density_kg_m3(inputs.water_density_kg_m3) * p.gravity_m_s2 * DEPTH_M,
        temperature_C: inputs.water_temperature_C,
        time_s: 0.0,
    }
}

fn glide_down(p: &Parameters<f64>, inputs: &Inputs<f64>) -> Option<SteadyGlide<f64>> {
    let water = surroundings(p, inputs);
    let mut path_deg = PATH_DEG;
    while path_deg >= STEEPEST_DEG {
        if let Some(glide) =
            at_path(p, &water, path_deg.to_radians(), SPEED_M_S).ok().filter(|glide| glide.is_within_reach(p))
        {
            return Some(glide);
        }
        path_deg -= STEEPER_DEG;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Actuation, Modes, derivative};

    #[test]
    fn the_start_is_steady() {
        let p = Parameters::default();
        let start = start(&p);
        let rates = derivative(&p, Actuation::Servo, Modes::default(), 0.0, &start.state, &start.inputs);
        let still = State { x_m: 0.0, depth_m: 0.0, ..rates };
        for rate in still.as_array() {
            assert!(rate.abs() < 1e-12, "{rates:?}");
        }
        assert!((rates.depth_m - 0.30 * 25f64.to_radians().sin()).abs() < 1e-12, "{rates:?}");
    }

    #[test]
    fn a_changed_glider_starts_where_the_first_one_did() {
        let p = Parameters::default();
        assert_eq!(start(&p).with(&p), start(&p));
        let heavier = Parameters { moving_mass_kg: 2.0 * p.moving_mass_kg, ..p };
        let (first, second) = (start(&p).state, start(&p).with(&heavier).state);
        assert_eq!(second.momentum_1_kg_m_s, 2.0 * first.momentum_1_kg_m_s);
        assert_eq!((second.pitch_rad, second.v1_m_s), (first.pitch_rad, first.v1_m_s));
    }

    #[test]
    fn a_glider_that_cannot_fly_starts_at_rest() {
        let p = Parameters { a_per_rad: 0.0, ..Parameters::default() };
        let start = start(&p);
        assert_eq!((start.state.v1_m_s, start.state.v3_m_s, start.state.depth_m), (0.0, 0.0, 10.0));
    }
}
