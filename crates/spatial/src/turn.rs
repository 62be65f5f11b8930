//! Steady turns: every rate of change zero but position and heading, `Om = w k`.
//!
//! Six equations, the accelerations, in roll, pitch (or the place of the moving mass), speed, angle of attack, sideslip and
//! turn rate; Newton's method with exact derivatives. Starts, stated in reports: every straight glide of the symmetric
//! glider with this net mass and trim, followed while roll mass, rudder, their offsets and the static list grow from zero;
//! then every combination of [`ROLLS_DEG`], [`TURN_RATES_RAD_S`] and [`SIDESLIPS_DEG`] about each of those glides.

use glidepolar_dynamics::Surroundings;
use glidepolar_dynamics::glide::{Attitude, SteadyGlide, at_pitch};
use glidepolar_number::{Number, functions};
use nalgebra::{SMatrix, SVector};
use num_dual::{Derivative, DualSVec64};

use super::equations::{accelerations, derivative};
use super::lateral::Body;
use super::state::{Inputs, N_STATES, State};

/// Roll of the further starts \[deg\].
pub const ROLLS_DEG: [f64; 4] = [-50.0, -15.0, 15.0, 50.0];
/// Turn rate of the further starts \[rad/s\].
pub const TURN_RATES_RAD_S: [f64; 6] = [-0.06, -0.015, -0.004, 0.004, 0.015, 0.06];
/// Sideslip of the further starts \[deg\].
pub const SIDESLIPS_DEG: [f64; 2] = [-4.0, 4.0];

/// Beyond these angles of attack and sideslip no hull was towed, and no solution is listed \[rad\].
const WIDEST_ANGLE_RAD: f64 = 0.6;
/// Roll and pitch of a solution that is listed lie within a quarter turn less this \[rad\].
const SHORT_OF_VERTICAL_RAD: f64 = 0.02;
/// Slower than this nothing flies \[m/s\].
const LEAST_SPEED_M_S: f64 = 0.01;
/// Slower turns are straight glides: a full turn takes longer than any battery lasts \[rad/s\].
const STRAIGHT_RAD_S: f64 = 1e-10;
/// Two solutions closer than this, relative to the scale of each quantity, are one.
const SAME: f64 = 1e-6;

/// What is held in a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Net mass, positive when heavy \[kg\].
    pub net_mass_kg: f64,
    /// What fixes the pitch.
    pub trim: Trim,
    /// Angle of the roll mass, to starboard positive \[rad\].
    pub roll_mass_rad: f64,
    /// Rudder angle, positive turns the bow to starboard \[rad\].
    pub rudder_rad: f64,
    /// In-situ density of the water as it is read \[kg/m3\].
    pub density_kg_m3: f64,
    /// Depth \[m\].
    pub depth_m: f64,
}

/// What fixes the pitch of a glide or turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trim {
    /// Place of the moving mass \[m\]; the pitch follows.
    MovingMass(f64),
    /// Pitch \[rad\]; the place of the moving mass follows.
    Pitch(f64),
}

/// A steady turn, or a straight glide.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Roll, starboard down positive \[rad\].
    pub roll_rad: f64,
    /// Pitch, nose-up positive \[rad\].
    pub pitch_rad: f64,
    /// Speed through the water \[m/s\].
    pub speed_m_s: f64,
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: f64,
    /// Sideslip \[rad\].
    pub sideslip_rad: f64,
    /// Turn rate, clockwise from above positive \[rad/s\].
    pub turn_rate_rad_s: f64,
    /// Place of the moving mass \[m\].
    pub moving_mass_m: f64,
    /// Radius, positive; infinite on a straight glide \[m\].
    pub radius_m: f64,
    /// Vertical velocity through the water, positive down \[m/s\].
    pub vertical_velocity_m_s: f64,
    /// Eigenvalues of roll, pitch, velocities and rates about it, masses and rudder fixed, as (real, imaginary), the fastest
    /// first \[1/s\].
    pub eigenvalues: Vec<[f64; 2]>,
    /// Whether every disturbance dies out.
    pub stable: bool,
}

impl Setting {
    fn inputs(&self, body: &Body<f64>) -> Inputs<f64> {
        Inputs::still_water(self.density_kg_m3, body.plane.reference_temperature_C)
    }

    fn water(&self, body: &Body<f64>) -> Surroundings<f64> {
        let p = &body.plane;
        Surroundings {
            density_kg_m3: self.density_kg_m3,
            pressure_Pa: p.true_density_kg_m3(self.density_kg_m3) * p.gravity_m_s2 * self.depth_m,
            temperature_C: p.reference_temperature_C,
            time_s: 0.0,
        }
    }

    /// Ballast mass that gives the net mass \[kg\].
    pub fn ballast_mass_kg(&self, body: &Body<f64>) -> f64 {
        let p = &body.plane;
        let water = self.water(body);
        let volume = (p.net_mass_kg(0.0, &water) - self.net_mass_kg)
            / (p.true_density_kg_m3(self.density_kg_m3) * p.ballast_scale);
        p.ballast_mass_kg(volume)
    }
}

impl Turn {
    /// Whether it does not turn at all, rounding apart.
    pub fn is_straight(&self) -> bool {
        self.turn_rate_rad_s.abs() < STRAIGHT_RAD_S
    }

    /// The state of a glider in this turn, its masses and rudder at rest in the hull.
    pub fn state(&self, body: &Body<f64>, setting: &Setting) -> State<f64> {
        unknowns_of(self, setting.trim).state(body, setting)
    }
}

/// All steady turns that are found, stable ones first, then by turn rate from the straight glide.
pub fn find(body: &Body<f64>, setting: &Setting) -> Vec<Turn> {
    let symmetric = fraction(body, setting, 0.0);
    let mut found: Vec<Unknowns<f64>> = Vec::new();
    let mut keep = |x: Unknowns<f64>| {
        if x.is_flight() && !found.iter().any(|known| known.distance(&x) < SAME) {
            found.push(x);
        }
    };
    for glide in straight(body, setting) {
        let begin = Unknowns::straight(&glide, setting.trim);
        let Some(begin) = newton(&symmetric.0, &symmetric.1, begin) else { continue };
        if let Some(turn) = follow(body, setting, begin) {
            keep(turn);
        }
        for roll in ROLLS_DEG {
            for rate in TURN_RATES_RAD_S {
                for slip in SIDESLIPS_DEG {
                    let start =
                        Unknowns([roll.to_radians(), begin.0[1], begin.0[2], begin.0[3], slip.to_radians(), rate]);
                    if let Some(turn) = newton(body, setting, start) {
                        keep(turn);
                    }
                }
            }
        }
    }
    let mut turns: Vec<Turn> = found.iter().map(|x| x.turn(body, setting)).collect();
    turns.sort_by(|a, b| {
        let order = |t: &Turn| (!t.stable, t.turn_rate_rad_s.abs());
        order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    turns
}

/// The turn into which the straight glide with the least drag for this trim goes over, as its commands grow; none where
/// that way ends. A sweep continues from the one before it, `from`.
pub fn continued(body: &Body<f64>, setting: &Setting, from: Option<&Turn>) -> Option<Turn> {
    if let Some(from) = from
        && let Some(turn) = newton(body, setting, unknowns_of(from, setting.trim)).filter(Unknowns::is_flight)
    {
        return Some(turn.turn(body, setting));
    }
    let symmetric = fraction(body, setting, 0.0);
    straight(body, setting)
        .into_iter()
        .filter_map(|glide| newton(&symmetric.0, &symmetric.1, Unknowns::straight(&glide, setting.trim)))
        .filter_map(|begin| follow(body, setting, begin))
        .find(Unknowns::is_flight)
        .map(|x| x.turn(body, setting))
}

/// Straight glides of the symmetric glider: one at a given pitch, every one at a given place of the moving mass.
fn straight(body: &Body<f64>, setting: &Setting) -> Vec<SteadyGlide<f64>> {
    let water = setting.water(body);
    let glide =
        |pitch_rad: f64| at_pitch(&body.plane, &water, Attitude { pitch_rad, net_mass_kg: setting.net_mass_kg }).ok();
    let wanted = match setting.trim {
        Trim::Pitch(pitch_rad) => return glide(pitch_rad).into_iter().collect(),
        Trim::MovingMass(wanted) => wanted,
    };
    let off = |pitch_rad: f64| glide(pitch_rad).map(|g| g.moving_mass_m - wanted);
    let mut glides = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    for halves in -170..=170 {
        let pitch = (0.5 * f64::from(halves)).to_radians();
        let here = off(pitch).map(|off| (pitch, off));
        if let (Some((low, off_low)), Some((high, off_high))) = (before, here)
            && off_low * off_high <= 0.0
        {
            let (mut low, mut high) = (low, high);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                match off(middle) {
                    Some(value) if value * off_low <= 0.0 => high = middle,
                    Some(_) => low = middle,
                    None => break,
                }
            }
            glides.extend(glide(0.5 * (low + high)));
        }
        before = here;
    }
    glides
}

/// Body and setting with a fraction of everything that makes the glider turn.
fn fraction(body: &Body<f64>, setting: &Setting, fraction: f64) -> (Body<f64>, Setting) {
    let mut body = *body;
    body.lateral.starboard_moment_kg_m *= fraction;
    body.lateral.roll_mass_offset_rad *= fraction;
    body.lateral.rudder_offset_rad *= fraction;
    let setting = Setting {
        roll_mass_rad: setting.roll_mass_rad * fraction,
        rudder_rad: setting.rudder_rad * fraction,
        ..*setting
    };
    (body, setting)
}

/// Continuation from the symmetric glide to the whole of what turns it; the step halves where Newton's method fails.
fn follow(body: &Body<f64>, setting: &Setting, begin: Unknowns<f64>) -> Option<Unknowns<f64>> {
    let (mut here, mut at, mut step) = (begin, 0.0, 0.1);
    let mut slope = Unknowns([0.0; 6]);
    while at < 1.0 {
        let next = f64::min(at + step, 1.0);
        let (part_body, part_setting) = fraction(body, setting, next);
        let guess = Unknowns(std::array::from_fn(|i| here.0[i] + slope.0[i] * (next - at)));
        match newton(&part_body, &part_setting, guess).filter(|x| x.distance(&guess) < 2.0) {
            Some(x) => {
                slope = Unknowns(std::array::from_fn(|i| (x.0[i] - here.0[i]) / (next - at)));
                (here, at) = (x, next);
                step = f64::min(step * 1.5, 0.1);
            }
            None if step < 1e-4 => return None,
            None => step *= 0.5,
        }
    }
    Some(here)
}

/// Roll, pitch or moving mass, speed, angle of attack, sideslip, turn rate.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unknowns<T>([T; 6]);

/// On which scale each of them differs.
const SCALES: [f64; 6] = [0.1, 0.1, 0.1, 0.05, 0.05, 0.005];

fn unknowns_of(turn: &Turn, trim: Trim) -> Unknowns<f64> {
    let second = match trim {
        Trim::MovingMass(_) => turn.pitch_rad,
        Trim::Pitch(_) => turn.moving_mass_m,
    };
    Unknowns([turn.roll_rad, second, turn.speed_m_s, turn.angle_of_attack_rad, turn.sideslip_rad, turn.turn_rate_rad_s])
}

impl Unknowns<f64> {
    fn straight(glide: &SteadyGlide<f64>, trim: Trim) -> Self {
        let second = match trim {
            Trim::MovingMass(_) => glide.pitch_rad,
            Trim::Pitch(_) => glide.moving_mass_m,
        };
        Unknowns([0.0, second, glide.speed_m_s, glide.angle_of_attack_rad, 0.0, 0.0])
    }

    fn distance(&self, other: &Self) -> f64 {
        (0..6).map(|i| (self.0[i] - other.0[i]).abs() / SCALES[i]).fold(0.0, f64::max)
    }

    fn is_flight(&self) -> bool {
        let [roll, _, speed, alpha, beta, _] = self.0;
        let upright = std::f64::consts::FRAC_PI_2 - SHORT_OF_VERTICAL_RAD;
        roll.abs() < upright
            && speed > LEAST_SPEED_M_S
            && alpha.abs() < WIDEST_ANGLE_RAD
            && beta.abs() < WIDEST_ANGLE_RAD
    }

    fn turn(&self, body: &Body<f64>, setting: &Setting) -> Turn {
        let state = self.state(body, setting);
        let [roll_rad, _, speed_m_s, angle_of_attack_rad, sideslip_rad, turn_rate_rad_s] = self.0;
        let rates = derivative(body, 0.0, &state, &setting.inputs(body));
        let sink = rates.depth_m - body.plane.vertical_current_m_s;
        let eigenvalues = eigenvalues(body, setting, &state);
        let along_the_ground = f64::max(speed_m_s * speed_m_s - sink * sink, 0.0).sqrt();
        Turn {
            roll_rad,
            pitch_rad: state.pitch_rad,
            speed_m_s,
            angle_of_attack_rad,
            sideslip_rad,
            turn_rate_rad_s,
            moving_mass_m: state.moving_mass_m,
            radius_m: along_the_ground / turn_rate_rad_s.abs(),
            vertical_velocity_m_s: sink,
            stable: eigenvalues.iter().all(|[real, _]| *real < 0.0),
            eigenvalues,
        }
    }
}

impl<T: Number> Unknowns<T> {
    fn state(&self, body: &Body<f64>, setting: &Setting) -> State<T> {
        let [roll, second, speed, alpha, beta, turn_rate] = self.0;
        let (pitch, moving_mass) = match setting.trim {
            Trim::MovingMass(place) => (second, T::constant(place)),
            Trim::Pitch(pitch) => (T::constant(pitch), second),
        };
        let ((sr, cr), (sp, cp)) = (functions::sin_cos(roll), functions::sin_cos(pitch));
        let ((sa, ca), (sb, cb)) = (functions::sin_cos(alpha), functions::sin_cos(beta));
        let mut state = State::from_array([T::constant(0.0); N_STATES]);
        state.depth_m = T::constant(setting.depth_m);
        (state.roll_rad, state.pitch_rad) = (roll, pitch);
        (state.v1_m_s, state.v2_m_s, state.v3_m_s) = (speed * ca * cb, speed * sb, speed * sa * cb);
        (state.p_rad_s, state.q_rad_s, state.r_rad_s) = (-turn_rate * sp, turn_rate * sr * cp, turn_rate * cr * cp);
        state.moving_mass_m = moving_mass;
        state.roll_mass_rad = T::constant(setting.roll_mass_rad);
        state.rudder_rad = T::constant(setting.rudder_rad);
        state.ballast_mass_kg = T::constant(setting.ballast_mass_kg(body));
        state
    }
}

/// Newton's method, its steps limited to where the equations are still like themselves.
fn newton(body: &Body<f64>, setting: &Setting, start: Unknowns<f64>) -> Option<Unknowns<f64>> {
    type Jet = DualSVec64<6>;
    const LONGEST: [f64; 6] = [0.2, 0.2, 0.2, 0.1, 0.1, 0.02];
    let jets = body.map(Jet::constant);
    let inputs = setting.inputs(body).map(Jet::constant);
    let mut x = start;
    for _ in 0..80 {
        let seeded = Unknowns(std::array::from_fn(|i| seeded::<6>(x.0[i], i)));
        let state = seeded.state(body, setting);
        let (along, about) = accelerations(&jets, Jet::constant(0.0), &state, &inputs);
        let residual = [along[0], along[1], along[2], about[0], about[1], about[2]];
        let slopes = SMatrix::<f64, 6, 6>::from_fn(|i, j| residual[i].eps.0.map_or(0.0, |eps| eps[j]));
        let right = SVector::<f64, 6>::from_fn(|i, _| residual[i].re);
        let step = slopes.lu().solve(&right).filter(|step| step.iter().all(|s| s.is_finite()))?;
        let over = (0..6).map(|i| step[i].abs() / LONGEST[i]).fold(1.0, f64::max);
        let size = (0..6).map(|i| step[i].abs() / SCALES[i]).fold(0.0, f64::max);
        x = Unknowns(std::array::from_fn(|i| x.0[i] - step[i] / over));
        if x.0[2] <= 0.0 || x.0.iter().any(|v| v.abs() > 20.0) {
            return None;
        }
        if size < 1e-12 {
            return Some(x);
        }
    }
    None
}

fn seeded<const N: usize>(value: f64, lane: usize) -> DualSVec64<N> {
    let mut eps = SVector::zeros();
    eps[lane] = 1.0;
    DualSVec64::new(value, Derivative::some(eps))
}

/// Eigenvalues of roll, pitch, velocities and rates about a steady state.
fn eigenvalues(body: &Body<f64>, setting: &Setting, at: &State<f64>) -> Vec<[f64; 2]> {
    type Jet = DualSVec64<8>;
    let jets = body.map(Jet::constant);
    let inputs = setting.inputs(body).map(Jet::constant);
    let mut state = at.map(Jet::constant);
    let slots = [
        &mut state.roll_rad,
        &mut state.pitch_rad,
        &mut state.v1_m_s,
        &mut state.v2_m_s,
        &mut state.v3_m_s,
        &mut state.p_rad_s,
        &mut state.q_rad_s,
        &mut state.r_rad_s,
    ];
    for (lane, slot) in slots.into_iter().enumerate() {
        *slot = seeded::<8>(slot.re, lane);
    }
    let (along, about) = accelerations(&jets, Jet::constant(0.0), &state, &inputs);
    let attitude = derivative(&jets, Jet::constant(0.0), &state, &inputs);
    let rates = [attitude.roll_rad, attitude.pitch_rad, along[0], along[1], along[2], about[0], about[1], about[2]];
    let matrix = SMatrix::<f64, 8, 8>::from_fn(|i, j| rates[i].eps.0.map_or(0.0, |eps| eps[j]));
    let mut values: Vec<[f64; 2]> = matrix.complex_eigenvalues().iter().map(|z| [z.re, z.im]).collect();
    values.sort_by(|a, b| a[0].total_cmp(&b[0]).then(b[1].total_cmp(&a[1])));
    values
}
