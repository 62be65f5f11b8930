//! Where the glider's freedom ends: the surface, the seabed, the ends of ballast tank and moving mass.
//!
//! What surface and seabed do to the hull is in [`super::contact`]; meeting them is an event. The ends of ballast and moving
//! mass are modes: they change at events only.

use super::equations::{derivative, holding_force_1_N};
use super::parameters::Parameters;
use super::state::{Actuation, Inputs, Modes, State, Stop};
use glidepolar_number::Number;

/// How many event indicators there are.
pub const N_EVENTS: usize = 6;

/// The event of meeting the surface.
pub const SURFACE: usize = 0;

/// What each event indicator stands for, in order.
pub const EVENT_NAMES: [&str; N_EVENTS] =
    ["surface", "seabed", "ballast at its minimum", "ballast at its maximum", "moving mass aft", "moving mass forward"];

/// A force this far inside a stop does not count as leaving it \[N\] or \[kg/s\].
const RELEASE: f64 = 1e-9;

/// By so much of its range a limit must be passed to be met, and come back from to be left: right after an event no
/// indicator is zero, and each has the sign of its mode.
const PAST_LIMIT: f64 = 1e-12;

/// The least range that [`PAST_LIMIT`] counts from \[m\] or \[m3\]: limits may coincide.
const LEAST_RANGE: f64 = 1e-6;

/// So far off its stop a mass that is held there is still at it \[m\]: an integrator's error moves it, a limit that is set
/// anew moves the stop by more.
const HELD_WITHIN_M: f64 = 1e-6;

/// The limits of ballast or moving mass that stand the wrong way round, by name and value, the lower one first.
pub fn reversed(parameters: &Parameters<f64>) -> Option<[(&'static str, f64); 2]> {
    let p = parameters;
    [
        [("ballast_min_m3", p.ballast_min_m3), ("ballast_max_m3", p.ballast_max_m3)],
        [("moving_mass_min_m", p.moving_mass_min_m), ("moving_mass_max_m", p.moving_mass_max_m)],
    ]
    .into_iter()
    .find(|[(_, low), (_, high)]| low > high)
}

/// How far a limit of this range must be passed to be met.
fn past_limit(low: f64, high: f64) -> f64 {
    PAST_LIMIT * (high - low).abs().max(LEAST_RANGE)
}

/// Functions of the state whose change of sign is an event, in the order of [`EVENT_NAMES`].
///
/// Those of surface and seabed know no mode: whoever keeps one shifts them. A limit that nothing can reach (a servo stops
/// short of its limits) has the constant indicator 1.
pub fn event_indicators<T: Number>(
    parameters: &Parameters<T>,
    actuation: Actuation,
    modes: Modes,
    time_s: T,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> [T; N_EVENTS] {
    let out_of_reach = T::constant(1.0);
    let mut z = [out_of_reach; N_EVENTS];
    z[0] = state.depth_m;
    z[1] = inputs.seabed_depth_m - state.depth_m;
    if actuation == Actuation::Servo {
        return z;
    }
    let ballast = parameters.ballast_m3(state.ballast_mass_kg);
    let (low, high) = (parameters.ballast_min_m3, parameters.ballast_max_m3);
    match modes.ballast {
        Stop::Free => {
            // Twice: within once of it the ballast counts as at its limit.
            let past = 2.0 * past_limit(low.value(), high.value());
            z[2] = ballast - low + past;
            z[3] = high - ballast + past;
        }
        // Taking ballast in (u4 > 0) makes the volume smaller.
        Stop::AtMin => z[2] = -inputs.u4_kg_s - 2.0 * RELEASE,
        Stop::AtMax => z[3] = inputs.u4_kg_s - 2.0 * RELEASE,
    }
    let (low, high) = (parameters.moving_mass_min_m, parameters.moving_mass_max_m);
    match modes.moving_mass {
        Stop::Free => {
            let past = past_limit(low.value(), high.value());
            z[4] = state.moving_mass_1_m - low + past;
            z[5] = high - state.moving_mass_1_m + past;
        }
        stop => {
            let outward = inputs.u1_N - holding_force_1_N(parameters, actuation, time_s, state, inputs);
            match stop {
                Stop::AtMin => z[4] = outward - 2.0 * RELEASE,
                _ => z[5] = -outward - 2.0 * RELEASE,
            }
        }
    }
    z
}

/// The modes that belong to this state, and the state itself where an event makes it jump: a moving mass that runs
/// into its stop hands its momentum to the hull.
pub fn apply(
    parameters: &Parameters<f64>,
    actuation: Actuation,
    modes: Modes,
    time_s: f64,
    state: &State<f64>,
    inputs: &Inputs<f64>,
) -> (Modes, State<f64>) {
    if actuation == Actuation::Servo {
        return (Modes::default(), *state);
    }
    let mut limited = *state;
    let ballast = limit_ballast(parameters, &mut limited, inputs);
    let mut modes = Modes { ballast, ..modes };

    let (low, high) = (parameters.moving_mass_min_m, parameters.moving_mass_max_m);
    let speed = derivative(parameters, actuation, modes, time_s, &limited, inputs).moving_mass_1_m;
    // By where the mass is, not by where it was held: a limit may have moved meanwhile.
    let (position, held) = (limited.moving_mass_1_m, modes.moving_mass);
    let slack = |stop| if held == stop { HELD_WITHIN_M } else { 0.0 };
    modes.moving_mass = if position <= low + slack(Stop::AtMin) && (held == Stop::AtMin || speed <= 0.0) {
        Stop::AtMin
    } else if position >= high - slack(Stop::AtMax) && (held == Stop::AtMax || speed >= 0.0) {
        Stop::AtMax
    } else {
        Stop::Free
    };
    // One that leaves, too, begins on its own side of the stop.
    limited.moving_mass_1_m = match modes.moving_mass {
        Stop::AtMin => low,
        Stop::AtMax => high,
        Stop::Free if position < low => low,
        Stop::Free if position > high => high,
        Stop::Free => position,
    };
    if modes.moving_mass != Stop::Free {
        stop_moving_mass(parameters, actuation, &mut limited, speed);
        let outward = inputs.u1_N - holding_force_1_N(parameters, actuation, time_s, &limited, inputs);
        let leaves = match modes.moving_mass {
            Stop::AtMin => outward > RELEASE,
            _ => outward < -RELEASE,
        };
        if leaves {
            modes.moving_mass = Stop::Free;
        }
    }
    (modes, limited)
}

fn limit_ballast(parameters: &Parameters<f64>, state: &mut State<f64>, inputs: &Inputs<f64>) -> Stop {
    let (low, high) = (parameters.ballast_min_m3, parameters.ballast_max_m3);
    // The rounding of one conversion to volume and back must not open a closed stop again.
    let rounding = past_limit(low, high);
    let ballast = parameters.ballast_m3(state.ballast_mass_kg);
    let (is_low, is_high) = (ballast <= low + rounding, ballast >= high - rounding);
    let (stays_low, stays_high) = (inputs.u4_kg_s >= -RELEASE, inputs.u4_kg_s <= RELEASE);
    // One that leaves, too, begins on its own side of the limit.
    if is_low && (stays_low || ballast < low - rounding) {
        state.ballast_mass_kg = parameters.ballast_mass_kg(low);
    } else if is_high && (stays_high || ballast > high + rounding) {
        state.ballast_mass_kg = parameters.ballast_mass_kg(high);
    }
    if is_low && stays_low {
        Stop::AtMin
    } else if is_high && stays_high {
        Stop::AtMax
    } else {
        Stop::Free
    }
}

/// Takes the moving mass's speed along the hull away; the impulse goes to the hull, so that total momentum stays.
fn stop_moving_mass(parameters: &Parameters<f64>, actuation: Actuation, state: &mut State<f64>, speed_m_s: f64) {
    if speed_m_s == 0.0 {
        return;
    }
    // The equations of motion are linear in u1: their response to 1 N more, times the impulse, is the jump. No other
    // force is impulsive, so the difference of two right-hand sides leaves the impulse alone.
    let respond = |u1_N: f64| {
        let inputs = Inputs { u1_N, ..Inputs::still_water(parameters.reference_density_kg_m3, 0.0) };
        derivative(parameters, actuation, Modes::default(), 0.0, state, &inputs)
    };
    let (with, without) = (respond(1.0), respond(0.0));
    let per_impulse = |f: fn(&State<f64>) -> f64| f(&with) - f(&without);
    let relative = per_impulse(|s| s.momentum_1_kg_m_s) / parameters.moving_mass_kg
        - per_impulse(|s| s.v1_m_s)
        - state.moving_mass_3_m * per_impulse(|s| s.pitch_rate_rad_s);
    let impulse = -speed_m_s / relative;
    state.momentum_1_kg_m_s += impulse * per_impulse(|s| s.momentum_1_kg_m_s);
    state.momentum_3_kg_m_s += impulse * per_impulse(|s| s.momentum_3_kg_m_s);
    state.v1_m_s += impulse * per_impulse(|s| s.v1_m_s);
    state.v3_m_s += impulse * per_impulse(|s| s.v3_m_s);
    state.pitch_rate_rad_s += impulse * per_impulse(|s| s.pitch_rate_rad_s);
}
