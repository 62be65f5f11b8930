//! The readings of a steady stretch and what the model says they are: turn rate, roll, and how much steeper than on the rest of its
//! leg the glider pitches.

use std::collections::{BTreeMap, BTreeSet};

use glidepolar_flightlog::Observation;
use nalgebra::DVector;

use crate::{Stretch, stretches};

/// Speeds of a leg that are taken at their word \[m/s\], and the flattest pitch of a glide \[rad\]: depth rate over its sine is no
/// speed below that.
const SLOWEST_M_S: f64 = 0.05;
const FASTEST_M_S: f64 = 1.0;
const FLATTEST_RAD: f64 = 0.12;
/// A stretch whose speed differs by more than this share from the median of its leg is not steady: the glider still accelerates.
const UNSTEADY: f64 = 0.2;

/// One steady stretch with what the model needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) stretch: Stretch,
    pub(super) speed_m_s: f64,
    /// Drag over slope of the lift where [`Term::Attack`] is not fitted.
    pub(super) drag_per_lift: f64,
    /// Roll per roll mass where [`Term::Gain`] is not fitted; zero where it is not known either.
    pub(super) roll_per_roll_mass: f64,
    /// Curvature per rudder where [`Term::Rudder`] is not fitted \[1/m\]; zero where it is not known either.
    pub(super) curvature_per_rudder: f64,
}

/// The angle of attack of a glide at this pitch: `angle tan(pitch + angle) = drag_per_lift`, by Newton's steps from above. With the
/// tangent of the pitch alone it would be half again too large at the flattest pitches.
fn angle_of_attack(pitch_rad: f64, drag_per_lift: f64) -> f64 {
    let drag_per_lift = drag_per_lift.max(0.0);
    let mut angle = (drag_per_lift / pitch_rad.tan()).min(drag_per_lift.sqrt()).min(1.5 - pitch_rad).max(0.0);
    for _ in 0..4 {
        let tan = (pitch_rad + angle).tan();
        angle -= (angle * tan - drag_per_lift) / (tan + angle * (1.0 + tan * tan));
    }
    angle
}

/// A figure of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Term {
    /// Drag over slope of the lift, at small angles of attack: their angle is this over the tangent of the path.
    Attack,
    /// Curvature without roll and rudder \[rad/m\].
    Yaw,
    /// By how much it is larger on descents and smaller on ascents.
    YawApart,
    /// Curvature per roll and cotangent of the pitch on descents, on ascents \[1/m\].
    RollTurns(bool),
    /// The same for both legs, with the sign of the leg.
    RollTurnsAlike,
    /// How the curvature per roll changes with the squared sine of the roll, on descents, on ascents \[1/m\].
    RollTurnsByRoll(bool),
    /// How it changes with the cotangent of the pitch, on descents, on ascents \[1/m\].
    RollTurnsByPitch(bool),
    /// Curvature per rudder \[1/m\].
    Rudder,
    /// Zero of the roll sensor.
    Zero,
    /// List.
    List,
    /// Offset of the roll mass.
    RollMassOffset,
    /// The offset of the roll mass that has a part in the roll at rest, which [`Term::List`] then is as a whole.
    Share,
    /// Roll per roll mass at small angles.
    Gain,
    /// Roll per rudder and squared speed.
    RudderRolls,
    /// Roll by what damps the roll rate of a turn at this pitch.
    Damped,
    /// Relative change of the pitch's tangent with the battery's place on descents, on ascents \[1/m\].
    MassPitches(bool),
    /// The same with the logarithm of the roll's cosine: the part of the sliding mass in the balance of pitch.
    RollPitches,
    /// Pitch that the sensor reads per roll, being askew about the vertical axis.
    Askew,
}

pub(super) fn name(term: Term) -> &'static str {
    match term {
        Term::RollMassOffset => "roll_mass_offset",
        Term::Zero => "roll_offset",
        _ => "static_list",
    }
}

/// The term of a cause of the roll.
pub(super) fn term_of(cause: &str) -> Option<Term> {
    [Term::List, Term::RollMassOffset, Term::Zero].into_iter().find(|term| name(*term) == cause)
}

pub(super) fn parameter(term: Term) -> &'static str {
    match term {
        Term::RollMassOffset => "roll_mass_offset_rad",
        Term::Zero => "roll_offset_rad",
        _ => "static_list_rad",
    }
}

/// Part of the sliding mass in the balance of pitch and its standard deviation, the water's moment being the rest: the built-in gliders
/// have 0.42 to 1.03 at pitches of 15 to 40 deg, ROGUE apart.
pub(super) const SLIDING: [f64; 2] = [0.75, 0.3];

/// Drag over slope of the lift and its standard deviation, of the built-in gliders: 0.016 to 0.059.
pub(super) const ATTACK: [f64; 2] = [0.03, 0.02];

/// The stretches at the speed of their leg, each with its own. At the turn of a leg a glider is slow, and it is there that a heading
/// control leans it: with the leg's speed this would be a turn per roll other to starboard than to port.
pub(super) fn rows(observations: &[Observation]) -> Vec<Row> {
    let is_usable = |s: &Stretch| s.roll_rad.is_finite() && s.speed_m_s.is_finite() && s.pitch_rad.abs() > FLATTEST_RAD;
    let found: Vec<Stretch> = stretches(observations).into_iter().filter(is_usable).collect();
    let mut of_leg: BTreeMap<(u32, bool), Vec<f64>> = BTreeMap::new();
    for stretch in &found {
        of_leg.entry((stretch.dive, stretch.descends)).or_default().push(stretch.speed_m_s);
    }
    let of_leg: BTreeMap<(u32, bool), f64> =
        of_leg.into_iter().map(|(leg, mut speeds)| (leg, glidepolar_flightlog::median(&mut speeds))).collect();
    let is_steady = |s: &Stretch| (s.speed_m_s / of_leg[&(s.dive, s.descends)] - 1.0).abs() < UNSTEADY;
    let row = |stretch: Stretch| Row {
        stretch,
        speed_m_s: stretch.speed_m_s.clamp(SLOWEST_M_S, FASTEST_M_S),
        drag_per_lift: ATTACK[0],
        roll_per_roll_mass: 0.0,
        curvature_per_rudder: 0.0,
    };
    found.into_iter().filter(is_steady).map(row).collect()
}

pub(super) fn dives(rows: &[Row]) -> Vec<u32> {
    rows.iter().map(|row| row.stretch.dive).collect::<BTreeSet<_>>().into_iter().collect()
}

pub(super) fn rolls(rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| row.stretch.roll_rad).collect()
}

/// Values of the terms at which the steps begin: a roll of half of what the roll mass turns by, the angle of attack of the
/// built-in gliders.
pub(super) fn start(terms: &[Term]) -> DVector<f64> {
    DVector::from_iterator(
        terms.len(),
        terms.iter().map(|term| match term {
            Term::Gain => 0.5,
            Term::Attack => ATTACK[0],
            Term::RollPitches => SLIDING[0],
            _ => 0.0,
        }),
    )
}

/// Turn rate and roll of a stretch by the model.
pub(super) fn predicted(row: &Row, terms: &[Term], values: &DVector<f64>) -> [f64; 2] {
    let model = Model::new(terms, values);
    model.predicted(row, model.path(row))
}

/// The way of a stretch through the water: what of the model depends on the angle of attack alone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// Speed along it \[m/s\].
    speed_m_s: f64,
    /// The net weight's component to the side over the drag for a unit of roll.
    cot: f64,
    /// Tangent of the hull's pitch.
    tan_pitch: f64,
}

/// Values of all terms, zero where one is not fitted: looked up once for all stretches.
pub(super) struct Model {
    attack: Option<f64>,
    yaw: f64,
    yaw_apart: f64,
    /// On ascents, on descents; so are the two behind it.
    roll_turns: [f64; 2],
    roll_turns_by_roll: [f64; 2],
    roll_turns_by_pitch: [f64; 2],
    roll_turns_alike: f64,
    rudder: Option<f64>,
    zero: f64,
    tan_list: f64,
    roll_mass_offset: f64,
    share: f64,
    sin_share: f64,
    gain: Option<f64>,
    rudder_rolls: f64,
    damped: f64,
    mass_pitches: [f64; 2],
    /// Where it is not fitted, neither roll nor roll mass moves the pitch.
    roll_pitches: Option<f64>,
    askew: f64,
}

impl Model {
    pub(super) fn new(terms: &[Term], values: &DVector<f64>) -> Self {
        let known = |wanted: Term| terms.iter().position(|term| *term == wanted).map(|at| values[at]);
        let of = |wanted: Term| known(wanted).unwrap_or(0.0);
        Model {
            attack: known(Term::Attack),
            yaw: of(Term::Yaw),
            yaw_apart: of(Term::YawApart),
            roll_turns: [false, true].map(|descends| of(Term::RollTurns(descends))),
            roll_turns_by_roll: [false, true].map(|descends| of(Term::RollTurnsByRoll(descends))),
            roll_turns_by_pitch: [false, true].map(|descends| of(Term::RollTurnsByPitch(descends))),
            roll_turns_alike: of(Term::RollTurnsAlike),
            rudder: known(Term::Rudder),
            zero: of(Term::Zero),
            tan_list: of(Term::List).tan(),
            roll_mass_offset: of(Term::RollMassOffset),
            share: of(Term::Share),
            sin_share: of(Term::Share).sin(),
            gain: known(Term::Gain),
            rudder_rolls: of(Term::RudderRolls),
            damped: of(Term::Damped),
            mass_pitches: [false, true].map(|descends| of(Term::MassPitches(descends))),
            roll_pitches: known(Term::RollPitches),
            askew: of(Term::Askew),
        }
    }

    /// The path is steeper than the hull by the angle of attack, whose product with the tangent of the path is drag over slope of the
    /// lift. Its tangents are most of what a prediction costs, and only [`Term::Attack`] changes them.
    pub(super) fn path(&self, row: &Row) -> Path {
        let pitch = row.stretch.pitch_rad.abs();
        let path = pitch + angle_of_attack(pitch, self.attack.unwrap_or(row.drag_per_lift));
        Path {
            speed_m_s: row.speed_m_s * pitch.sin() / path.sin(),
            cot: pitch.cos() / path.sin(),
            tan_pitch: row.stretch.pitch_rad.clamp(-1.4, 1.4).tan(),
        }
    }

    /// Turn rate and roll of a stretch on its path.
    pub(super) fn predicted(&self, row: &Row, path: Path) -> [f64; 2] {
        let Path { speed_m_s, cot, tan_pitch } = path;
        let stretch = &row.stretch;
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let (rudder, roll_mass) = (finite(stretch.rudder_rad), finite(stretch.roll_mass_rad));
        let (zero, gain) = (self.zero, self.gain.unwrap_or(row.roll_per_roll_mass));
        let leg = usize::from(stretch.descends);
        let sign = if stretch.descends { -1.0 } else { 1.0 };
        let per_roll = self.roll_turns[leg] + sign * self.roll_turns_alike;
        // Turned over, the glider turns the other way: an odd law of the true roll.
        let sin_roll = (stretch.roll_rad - zero).sin();
        let per_roll =
            per_roll + self.roll_turns_by_roll[leg] * sin_roll * sin_roll + self.roll_turns_by_pitch[leg] * cot;
        let side = per_roll * sin_roll;
        let per_rudder = self.rudder.unwrap_or(row.curvature_per_rudder);
        let rate = speed_m_s * (self.yaw - sign * self.yaw_apart + per_rudder * rudder + side * cot);
        let (sin, cos) = (roll_mass + self.roll_mass_offset + self.share).sin_cos();
        // The roll rate of a turn at this pitch is the turn rate times the sine of the pitch; gravity's lever is the cosine of the pitch.
        let damped = self.damped * speed_m_s * stretch.rate_rad_s * tan_pitch;
        let pulled =
            gain * (sin - self.sin_share) + self.tan_list + damped / (stretch.roll_rad - zero).clamp(-1.4, 1.4).cos();
        let lean = (pulled / (1.0 + gain * (cos - 1.0))).atan();
        [rate, zero + lean + self.rudder_rolls * rudder * speed_m_s * speed_m_s]
    }

    /// By how much the logarithm of the pitch's tangent exceeds the mean of the leg, for each stretch. The balance of pitch is
    /// `Sx cos(roll) + Sz tan(pitch) = 0` but for the water's moment: battery and lean move the first, the roll mass the second.
    pub(super) fn steeper(&self, rows: &[Row]) -> Vec<f64> {
        let of_row = |row: &Row| {
            let stretch = &row.stretch;
            let roll = (stretch.roll_rad - self.zero).clamp(-1.4, 1.4);
            let (sin, cos) = stretch.pitch_rad.sin_cos();
            let balanced = self.roll_pitches.map_or(0.0, |part| {
                let turned = stretch.roll_mass_rad + self.roll_mass_offset + self.share;
                let gain = self.gain.unwrap_or(row.roll_per_roll_mass);
                part * roll.cos().ln() - (1.0 + gain * (turned.cos() - 1.0)).max(0.1).ln()
            });
            self.mass_pitches[usize::from(stretch.descends)] * stretch.battery_forward_m
                + self.askew * roll / (sin * cos)
                + balanced
        };
        from_mean_of_leg(rows, of_row)
    }
}

/// The same as [`Model::steeper`], as it was read.
pub(super) fn read_steeper(rows: &[Row]) -> Vec<f64> {
    from_mean_of_leg(rows, |row| row.stretch.pitch_rad.abs().tan().ln())
}

/// Deviations from the mean of the leg.
pub(super) fn from_mean_of_leg(rows: &[Row], of: impl Fn(&Row) -> f64) -> Vec<f64> {
    let is_one_leg = |a: &Row, b: &Row| a.stretch.dive == b.stretch.dive && a.stretch.descends == b.stretch.descends;
    let of_leg = |leg: &[Row]| {
        let values: Vec<f64> = leg.iter().map(&of).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.into_iter().map(move |value| value - mean).collect::<Vec<_>>()
    };
    rows.chunk_by(is_one_leg).flat_map(of_leg).collect()
}
