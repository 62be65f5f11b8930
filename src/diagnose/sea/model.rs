//! The steady glide of one bin, with its slopes in every direction that a fit may go.

use nalgebra::{Const, U1};
use num_dual::{Derivative, DualSVec64};

use crate::dynamics::{Parameters, parameter_index};
use crate::glide::Glider;
use crate::identify::{Bin, Inside, usual_step_s};

/// Most parameters that can be varied at once.
pub const MAX_DIRECTIONS: usize = 24;

type Dual = DualSVec64<MAX_DIRECTIONS>;

/// A value and its slopes.
pub type Slopes = (f64, [f64; MAX_DIRECTIONS]);

/// Which rows of the table of parameters are varied, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions {
    rows: Vec<usize>,
}

impl Directions {
    pub fn new(baseline: &[usize]) -> Self {
        Directions { rows: baseline.to_vec() }
    }

    /// The direction of a row, a new one where it has none yet; none where there is no room.
    pub fn of(&mut self, row: usize) -> Option<usize> {
        if let Some(direction) = self.rows.iter().position(|known| *known == row) {
            return Some(direction);
        }
        (self.rows.len() < MAX_DIRECTIONS).then(|| {
            self.rows.push(row);
            self.rows.len() - 1
        })
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn parameter(&self, direction: usize) -> usize {
        self.rows[direction]
    }
}

/// The vehicle at one point of a fit, before and after the jump of its drag.
pub struct Vehicle {
    before: Glider<Dual>,
    after: Glider<Dual>,
    jump_s: f64,
}

impl Vehicle {
    pub fn new(parameters: &Parameters<f64>, directions: &Directions) -> Self {
        let mut p = parameters.map(Dual::from);
        for (direction, row) in directions.rows.iter().enumerate() {
            let value = p.at(*row).re;
            *p.at(*row) = Dual::new(value, Derivative::derivative_generic(Const, U1, direction));
        }
        // The slope along a jump is wanted on both sides of it: the caller knows which rows a jump reaches.
        let jump_s = p.step_time_s.re;
        p.step_time_s = Dual::from(f64::NEG_INFINITY);
        let after = Glider::new(p);
        if let Some(row) = parameter_index("drag_step") {
            let step = *p.at(row);
            *p.at(row) = step - step.re;
        }
        Vehicle { before: Glider::new(p), after, jump_s }
    }

    /// Vertical velocity and speed as the instruments would read them. Where no glide balances the glider stands still:
    /// no velocity, no slope.
    pub fn fly(&self, bin: &Bin, inside: &Inside) -> (Slopes, Slopes) {
        let glider = if bin.mean.time_s < self.jump_s { &self.before } else { &self.after };
        match inside.predict(glider, bin, None) {
            Some(read) => (parts(read.sink_m_s), parts(read.speed_m_s)),
            None => ((0.0, [0.0; MAX_DIRECTIONS]), (0.0, [0.0; MAX_DIRECTIONS])),
        }
    }
}

/// Whether the vehicle flies at all as this bin says.
pub fn flies(parameters: &Parameters<f64>, bin: &Bin) -> bool {
    Inside::NOTHING.predict(&Glider::new(*parameters), bin, None).is_some()
}

/// Largest share of the drag that the inertia may have where a glide counts as steady.
const LARGEST_INERTIA: f64 = 0.2;

/// What net mass is uncertain by where everything is as it should be \[kg\]: a cubic centimetre of ballast, 0.02 kg/m3 of
/// density.
const WEIGHING_ERROR_KG: f64 = 1e-3;

/// Drag coefficient of usual gliders on their frontal area, where a rough figure will do: the vehicle's own may be wrong by
/// as much as is to be found out.
const USUAL_DRAG_COEFFICIENT: f64 = 0.3;

/// Angle of attack of a usual glide \[rad\], where a small term needs the path rather than the pitch.
const USUAL_ANGLE_OF_ATTACK_RAD: f64 = 0.05;

/// Which bins are steady: `M |w'| / sin xi` below a share of the drag `rho A b w^2 / (2 sin^2 xi)`, all as measured. A
/// glider that hangs near neutral is not, whatever the time since its last turn.
pub fn steady(parameters: &Parameters<f64>, bins: &[Bin]) -> Vec<bool> {
    let mass = parameters.mass_kg() + parameters.added_mass_1_kg;
    let reach_s = reach_s(bins);
    (0..bins.len())
        .map(|i| {
            let (low, high) = neighbours(bins, i, reach_s);
            if high == low {
                return true;
            }
            let [a, b] = [low, high].map(|j| &bins[j].mean);
            let acceleration = (b.sink_m_s - a.sink_m_s) / (b.time_s - a.time_s);
            let sin = path_rad(&bins[i]).sin();
            mass * acceleration.abs() / sin <= LARGEST_INERTIA * drag_N(parameters, &bins[i])
        })
        .collect()
}

/// Adds to the errors of a bin what the uncertainty of its net mass makes of them. By the balance along the path,
/// `dw/dm = g sin xi w / (2 D)`: it grows without bound towards neutral.
pub fn add_weighing_error(parameters: &Parameters<f64>, bin: &mut Bin) {
    let sin = path_rad(bin).sin();
    let per_kg = parameters.gravity_m_s2 * sin * bin.mean.sink_m_s.abs() / (2.0 * drag_N(parameters, bin));
    bin.sink_sd_m_s = bin.sink_sd_m_s.hypot(per_kg * WEIGHING_ERROR_KG);
    bin.speed_sd_m_s = bin.speed_sd_m_s.hypot(per_kg * WEIGHING_ERROR_KG / sin);
}

fn path_rad(bin: &Bin) -> f64 {
    bin.mean.pitch_rad.abs() + USUAL_ANGLE_OF_ATTACK_RAD
}

/// Drag by the measured vertical velocity.
fn drag_N(parameters: &Parameters<f64>, bin: &Bin) -> f64 {
    let speed = bin.mean.sink_m_s / path_rad(bin).sin();
    let size = 0.5 * bin.mean.density_kg_m3 * parameters.frontal_area_m2 * USUAL_DRAG_COEFFICIENT;
    (size * speed * speed).max(f64::MIN_POSITIVE)
}

/// The bins before and after one on the same leg, itself where there is none: what lies beyond a gap, as where the pump
/// ran, is another glide.
fn neighbours(bins: &[Bin], i: usize, reach_s: f64) -> (usize, usize) {
    let is_near = |other: usize| {
        let (here, there) = (&bins[i].mean, &bins[other].mean);
        here.leg == there.leg && (here.time_s - there.time_s).abs() <= reach_s
    };
    let low = if i > 0 && is_near(i - 1) { i - 1 } else { i };
    let high = if i + 1 < bins.len() && is_near(i + 1) { i + 1 } else { i };
    (low, high)
}

/// Longest time between neighbours \[s\]: one and a half times the usual.
fn reach_s(bins: &[Bin]) -> f64 {
    1.5 * usual_step_s(bins.iter().map(|bin| &bin.mean))
}

fn parts(value: Dual) -> Slopes {
    let slopes = value.eps.0.map_or([0.0; MAX_DIRECTIONS], |eps| std::array::from_fn(|i| eps[i]));
    (value.re, slopes)
}
