//! The Simulink paper's run (its Figures 5 to 8) and what its "shakes" are: flights and eigenvalues, no files.

use glidepolar::dynamics::{
    Actuation, Glider, Inputs, IntegrationError, Integrator, Modes, N_STATES, Parameters, State, Stop, derivative,
};
use glidepolar::glide::at_path;
use glidepolar::simulate::{Row, row};
use num_dual::Dual64;

/// Rate of the ballast pulses [kg/s], Graver 2005.
pub const PULSE_KG_S: f64 = 0.025;

/// Time from one pulse to the next [s], Graver 2005.
pub const LEG_S: f64 = 375.0;

/// Legs flown.
pub const LEGS: usize = 4;

/// Path angle and speed of the glide that the ballast is meant for [deg, m/s], Graver 2005.
pub const GLIDE: (f64, f64) = (-25.0, 0.30);

/// Where the run starts [m].
const START_DEPTH_M: f64 = 10.0;

/// A run by pulses, one row a second.
pub struct Run {
    /// As in every time history.
    pub rows: Vec<Row>,
    /// Ballast rate in force, in each row [kg/s].
    pub rates_kg_s: Vec<f64>,
    /// When a moving mass that is left to forces first ran into one of its stops [s].
    pub stopped_s: Option<f64>,
}

/// The paper's run: at rest and level, the bladder empty, as light as the glide down is heavy; then a pulse of ballast at
/// the start of every leg, in and out in turn. The moving mass either feels `u1 = 0`, its offset along axis 3 held, or is
/// brought by its servo to where each glide needs it.
pub fn run(p: &Parameters<f64>, actuation: Actuation) -> Result<Run, IntegrationError> {
    let still = Inputs::still_water(p.reference_density_kg_m3, p.reference_temperature_C);
    let (heavy, light) = (steady(p, GLIDE.0), steady(p, -GLIDE.0));
    let pulse_s = (heavy.0.ballast_mass_kg - light.0.ballast_mass_kg) / PULSE_KG_S;
    let mut state = State {
        depth_m: START_DEPTH_M,
        pitch_rad: 0.0,
        v1_m_s: 0.0,
        v3_m_s: 0.0,
        moving_mass_1_m: 0.0,
        momentum_1_kg_m_s: 0.0,
        momentum_3_kg_m_s: 0.0,
        ..light.0
    };
    let mut glider = Glider::new(*p, actuation, still);
    let (mut time, mut integrator) = (0.0, Integrator::new(1e-10));
    let mut run = Run { rows: Vec::new(), rates_kg_s: Vec::new(), stopped_s: None };
    for leg in 0..LEGS {
        let begun = time;
        let (goal, sign) = if leg % 2 == 0 { (&heavy, 1.0) } else { (&light, -1.0) };
        for (end, rate) in [(begun + pulse_s, sign * PULSE_KG_S), (begun + LEG_S, 0.0)] {
            glider.inputs.u4_kg_s = rate;
            glider.inputs.ballast_command_m3 = goal.1.ballast_command_m3;
            glider.inputs.moving_mass_command_m = goal.1.moving_mass_command_m;
            integrator.restart();
            glider.apply_limits(time, &mut state);
            while time < end {
                if time == run.rows.len() as f64 {
                    run.rows.push(row(&glider, time, &state));
                    run.rates_kg_s.push(glider_rate(&glider, time, &state));
                }
                let next = (time.floor() + 1.0).min(end);
                let stopped = &mut run.stopped_s;
                glider.fly(&mut integrator, &mut time, &mut state, next, |t, _, which| {
                    if which[4] || which[5] {
                        stopped.get_or_insert(t);
                    }
                    true
                })?;
            }
        }
    }
    Ok(run)
}

fn glider_rate(glider: &Glider, time_s: f64, state: &State<f64>) -> f64 {
    let inputs = glider.inputs_at(time_s);
    derivative(&glider.parameters, glider.actuation, glider.modes, time_s, state, &inputs).ballast_mass_kg
}

/// The steady glide along a path at the speed of [`GLIDE`]: its state and the commands that hold it.
///
/// # Panics
/// Where this vehicle has no such glide.
pub fn steady(p: &Parameters<f64>, angle_deg: f64) -> (State<f64>, Inputs<f64>) {
    let water = glidepolar::dynamics::Surroundings {
        density_kg_m3: p.reference_density_kg_m3,
        pressure_Pa: 0.0,
        temperature_C: p.reference_temperature_C,
        time_s: 0.0,
    };
    let glide = at_path(p, &water, angle_deg.to_radians(), GLIDE.1).expect("a glide along this path");
    let inputs = Inputs {
        ballast_command_m3: glide.ballast_m3,
        moving_mass_command_m: glide.moving_mass_m,
        ..Inputs::still_water(p.reference_density_kg_m3, p.reference_temperature_C)
    };
    (glide.state(p, 1000.0), inputs)
}

/// How the moving mass is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Locked to the hull.
    Locked,
    /// Along axis 1 the force `u1` stays constant; held along axis 3.
    ForceAlongAxis1,
    /// `u1` and `u3` stay constant.
    Forces,
}

/// Eigenvalues of the motion linearised about a steady glide [1/s], the largest real part first. Those of position, of
/// depth, of the ballast and of the constraints are left out: they belong to no motion of the glider.
pub fn eigenvalues(p: &Parameters<f64>, angle_deg: f64, kept: Kept) -> Vec<(f64, f64)> {
    let (state, inputs) = steady(p, angle_deg);
    let (actuation, stop) = match kept {
        Kept::Locked => (Actuation::RawAlongAxis1, Stop::AtMax),
        Kept::ForceAlongAxis1 => (Actuation::RawAlongAxis1, Stop::Free),
        Kept::Forces => (Actuation::Raw, Stop::Free),
    };
    let modes = Modes { moving_mass: stop, ..Modes::default() };
    let mut jacobian = nalgebra::DMatrix::<f64>::zeros(N_STATES, N_STATES);
    for j in 0..N_STATES {
        let mut seeded = state.as_array().map(Dual64::from);
        seeded[j].eps = 1.0;
        let lifted = (p.map(Dual64::from), State::from_array(seeded), inputs.map(Dual64::from));
        let rates = derivative(&lifted.0, actuation, modes, Dual64::from(0.0), &lifted.1, &lifted.2);
        for (i, rate) in rates.as_array().into_iter().enumerate() {
            jacobian[(i, j)] = rate.eps;
        }
    }
    let mut found: Vec<(f64, f64)> = jacobian.complex_eigenvalues().iter().map(|e| (e.re, e.im)).collect();
    found.retain(|e| e.1 >= 0.0 && e.0.hypot(e.1) > 1e-3 && !is_of_a_constraint(*e));
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found
}

/// A held offset returns at 2/s, twice over; a locked mass loses a speed along the hull at 4/s.
fn is_of_a_constraint((re, im): (f64, f64)) -> bool {
    (re + 2.0).hypot(im) < 1e-4 || (re + 4.0).hypot(im) < 1e-9
}

/// The pitch's departure from a steady glide that is disturbed by `disturbance_rad`, `u1 = 0`, four times a second.
pub fn onset(
    p: &Parameters<f64>,
    angle_deg: f64,
    disturbance_rad: f64,
    stop_s: f64,
) -> Result<Vec<(f64, f64)>, IntegrationError> {
    let (mut state, inputs) = steady(p, angle_deg);
    let glide = state.pitch_rad;
    state.pitch_rad += disturbance_rad;
    let mut glider = Glider::new(*p, Actuation::RawAlongAxis1, inputs);
    let (mut time, mut integrator, mut departures) = (0.0, Integrator::new(1e-13), Vec::new());
    while time < stop_s {
        departures.push((time, state.pitch_rad - glide));
        let next = time + 0.25;
        glider.fly(&mut integrator, &mut time, &mut state, next, |_, _, _| true)?;
    }
    Ok(departures)
}
