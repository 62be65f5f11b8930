//! Heading control: who gives rudder and roll mass their set-points.
//!
//! ```text
//! e = shortest way from heading + lead r to the command, less the dead band
//! rudder    = gain e                                    heading by rudder
//! roll mass = (gain_descent or gain_ascent) e           heading by roll mass: which way a roll turns depends on the leg
//! ```
//! Servos and limits follow. Between the legs the gain goes over from one to the other with the sink rate, as coefficients do.

use glidepolar_dynamics::forces::ascent_fraction;
use glidepolar_number::Number;

use super::lateral::Body;
use super::state::{Inputs, State};
use super::turn::{Setting, Trim, continued};
use super::vector::{Attitude, dot};

/// Who gives rudder and roll mass their set-points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Steering {
    /// The commands, directly.
    #[default]
    Direct,
    /// The rudder follows the heading command.
    HeadingByRudder,
    /// The roll mass follows it.
    HeadingByRollMass,
}

/// Time in which the proposed gains bring the heading to its command \[s\]: several times the seconds that roll and yaw take
/// to settle (`docs/evidence/turning.md` lists their eigenvalues), so that no gain rings.
const CLOSING_S: f64 = 60.0;

/// Commands that the response is taken from \[rad\]: small, in the linear range.
const NUDGE_RAD: f64 = 0.02;

/// Pitch on descents and its opposite on ascents, at which gains are proposed \[rad\].
const PITCH_RAD: f64 = -25.0 / 180.0 * std::f64::consts::PI;

/// Net mass on descents, of the displaced mass.
const NET_SHARE: f64 = 0.003;

impl Steering {
    /// The inputs with the set-points that the autopilot gives.
    pub fn steered<T: Number>(self, body: &Body<T>, state: &State<T>, inputs: &Inputs<T>) -> Inputs<T> {
        let l = &body.lateral;
        match self {
            Steering::Direct => *inputs,
            Steering::HeadingByRudder => {
                Inputs { rudder_command_rad: l.heading_rudder_gain * error(body, state, inputs), ..*inputs }
            }
            Steering::HeadingByRollMass => {
                let down = Attitude::new(state.roll_rad, state.pitch_rad, state.heading_rad).down();
                let ascent = ascent_fraction(dot(down, [state.v1_m_s, state.v2_m_s, state.v3_m_s]));
                let (descents, ascents) = (l.heading_roll_gain_descent, l.heading_roll_gain_ascent);
                let gain = descents + (ascents - descents) * ascent;
                Inputs { roll_mass_command_rad: gain * error(body, state, inputs), ..*inputs }
            }
        }
    }
}

/// Error of the heading beyond the dead band.
fn error<T: Number>(body: &Body<T>, state: &State<T>, inputs: &Inputs<T>) -> T {
    let l = &body.lateral;
    let to_go = shortest(inputs.heading_command_rad - state.heading_rad) - l.heading_lead_s * state.r_rad_s;
    to_go - to_go.held_within(-l.heading_dead_band_rad, l.heading_dead_band_rad)
}

/// The same angle within half a turn to either side.
pub fn shortest<T: Number>(angle_rad: T) -> T {
    const TURN: f64 = std::f64::consts::TAU;
    angle_rad - (angle_rad.value() / TURN).round() * TURN
}

/// The body with gains that bring its heading to a command within a minute or so on either leg, by the turns that it flies
/// with a small rudder angle and a small angle of the roll mass; zero where it has none, or no steady turn.
pub fn with_gains(body: &Body<f64>) -> Body<f64> {
    let turn_rate = |sign: f64, roll_mass_rad: f64, rudder_rad: f64| {
        let p = &body.plane;
        let setting = Setting {
            trim: Trim::Pitch(sign * PITCH_RAD),
            net_mass_kg: sign * NET_SHARE * p.displaced_mass_kg,
            roll_mass_rad,
            rudder_rad,
            density_kg_m3: p.reference_density_kg_m3,
            depth_m: 10.0,
        };
        continued(body, &setting, None).map(|turn| turn.turn_rate_rad_s)
    };
    // Half the difference of two commands: a list or an offset turns the glider, too.
    let gain = |sign: f64, roll: f64, rudder: f64| {
        let rates = turn_rate(sign, roll, rudder).zip(turn_rate(sign, -roll, -rudder));
        let per_rad = rates.map_or(0.0, |(plus, minus)| (plus - minus) / (2.0 * NUDGE_RAD));
        if per_rad.abs() > 1e-6 { 1.0 / (CLOSING_S * per_rad) } else { 0.0 }
    };
    let mut body = *body;
    let l = &mut body.lateral;
    l.heading_roll_gain_descent = gain(1.0, NUDGE_RAD, 0.0);
    l.heading_roll_gain_ascent = gain(-1.0, NUDGE_RAD, 0.0);
    l.heading_rudder_gain = gain(1.0, 0.0, NUDGE_RAD);
    body
}
