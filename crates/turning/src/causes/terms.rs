//! Which terms of the model a log can identify: by what varies in it, and on which legs. Knows no cause.

use super::findings::PITCH;
use super::fit::Fit;
use super::model::{Row, Term, from_mean_of_leg};
use crate::{HELD_RUDDER_RAD, LEAST_STRETCHES, Stretch, VARIES_RAD, sd};

/// Relative error of a vehicle's roll per roll mass: its height of the moving mass is an estimate. That of the figures of lift without a
/// stated error.
const ROLL_PER_ROLL_MASS_ERROR: f64 = 0.15;

/// Standard error of the logarithm of a vehicle's curvature per rudder: the flap's effectiveness by thin aerofoils, the damping of the
/// yaw and the static moment that it works against, 0.15 each.
const CURVATURE_PER_RUDDER_ERROR: f64 = 0.26;

/// What a log can identify.
pub(super) struct Terms {
    turns: Vec<Term>,
    rolls: Vec<Term>,
    /// Whether the roll varied on both legs, so that turning shows the true roll.
    pub(super) separates_sensor: bool,
    pub(super) has_roll_mass: bool,
    /// The roll mass is read but does not vary, and how much it rolls is the vehicle's: the standard deviation of that figure, relative.
    pub(super) fixed_roll_mass_error: Option<f64>,
    pub(super) has_rudder: bool,
    /// The rudder stands at an angle: how it rolls the glider is not separated from anything constant.
    pub(super) rudder_is_fixed_at_angle: bool,
    /// The rudder is read but does not vary, and how much it turns is the vehicle's.
    pub(super) fixed_rudder: Option<FixedRudder>,
    pub(super) both_legs: bool,
}

/// A rudder that stands still, of a vehicle that says how much it turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct FixedRudder {
    /// Where it stands on average \[rad\].
    pub(super) angle_rad: f64,
    /// The vehicle's curvature per rudder \[1/m\].
    pub(super) curvature_per_rudder: f64,
    /// Standard error of the logarithm of that.
    pub(super) relative_error: f64,
}

impl Terms {
    /// Finds them among the stretches of a log.
    pub(super) fn of(rows: &[Row]) -> Terms {
        let values = |of: fn(&Stretch) -> f64| rows.iter().map(|row| of(&row.stretch)).collect::<Vec<f64>>();
        let varies = |values: &[f64], limit: f64| sd(values) > limit;
        let leg = |down: bool| rows.iter().filter(move |row| row.stretch.descends == down);
        let both_legs = [true, false].into_iter().all(|down| leg(down).count() >= LEAST_STRETCHES / 2);
        let rolls_on = |down: bool| {
            let rolls: Vec<f64> = leg(down).map(|row| row.stretch.roll_rad).collect();
            rolls.len() >= LEAST_STRETCHES / 2 && varies(&rolls, VARIES_RAD[0])
        };
        let (rudder, roll_mass) = (values(|s| s.rudder_rad), values(|s| s.roll_mass_rad));
        let has_rudder = varies(&rudder, VARIES_RAD[1]);
        let mean_rudder = rudder.iter().sum::<f64>() / rudder.len() as f64;
        let rudder_is_fixed_at_angle = !has_rudder && mean_rudder.abs() > HELD_RUDDER_RAD;
        let known = rows[0].curvature_per_rudder;
        let fixed_rudder = (!has_rudder && mean_rudder.is_finite() && known > 0.0).then_some(FixedRudder {
            angle_rad: mean_rudder,
            curvature_per_rudder: known,
            relative_error: CURVATURE_PER_RUDDER_ERROR,
        });
        let has_roll_mass = varies(&roll_mass, VARIES_RAD[2]);
        let separates_sensor = rolls_on(true) && rolls_on(false);
        let mut turns = vec![Term::Attack, Term::Yaw];
        if separates_sensor {
            for down in [true, false] {
                turns.extend([Term::RollTurns(down), Term::RollTurnsByRoll(down), Term::RollTurnsByPitch(down)]);
            }
        } else if both_legs {
            turns.push(Term::RollTurnsAlike);
        }
        let mut rolls = Vec::new();
        if has_rudder {
            turns.push(Term::Rudder);
            rolls.push(Term::RudderRolls);
        }
        if has_roll_mass {
            rolls.extend([Term::Gain, Term::Damped]);
        }
        let is_read = roll_mass.iter().all(|angle| angle.is_finite());
        let fixed_roll_mass_error =
            (!has_roll_mass && is_read && rows[0].roll_per_roll_mass > 0.0).then_some(ROLL_PER_ROLL_MASS_ERROR);
        let terms = Terms {
            turns,
            rolls,
            separates_sensor,
            has_roll_mass,
            fixed_roll_mass_error,
            has_rudder,
            rudder_is_fixed_at_angle,
            fixed_rudder,
            both_legs,
        };
        if has_roll_mass { terms.with_pitch(rows) } else { terms }
    }

    /// With the pitch as a third reading, where roll and roll mass move it for certain: a pitch that something else holds would
    /// speak for one cause of the lean against another without having seen either.
    fn with_pitch(self, rows: &[Row]) -> Terms {
        if !rows.iter().all(|row| row.stretch.battery_forward_m.is_finite()) {
            return self;
        }
        let pitches = pitches(rows);
        let with = |pitches: &[Term]| [&self.rolls[..], pitches].concat();
        let moved =
            Terms { rolls: with(&[&pitches[..], &[Term::RollPitches]].concat()), turns: self.turns.clone(), ..self };
        let unmoved = Terms { rolls: with(&pitches), turns: self.turns.clone(), ..self };
        let zero: &[Term] = if self.separates_sensor { &[Term::Zero] } else { &[] };
        let fit = |terms: &Terms, lean: Term, sds| Fit::new(rows, &terms.with(&[&[lean], zero].concat()), sds);
        let Some(unmoved) = fit(&unmoved, Term::List, None) else { return self };
        let is_better =
            |lean: Term| fit(&moved, lean, Some(unmoved.sds)).is_some_and(|fit| unmoved.is_worse_than(&fit, PITCH));
        if [Term::List, Term::RollMassOffset].into_iter().any(is_better) { moved } else { self }
    }

    /// Every term, those of the lean in the form of a list.
    pub(super) fn all(&self) -> Vec<Term> {
        let mut all = self.with(&[Term::List]);
        if self.separates_sensor {
            all.push(Term::Zero);
        }
        all
    }

    /// Those of turn rate and roll, and some of the lean.
    pub(super) fn with(&self, lean: &[Term]) -> Vec<Term> {
        [&self.turns[..], &self.rolls[..], lean].concat()
    }
}

/// A battery that moves less than this within a leg shows nothing of what its place does \[m\]: some times its reading's noise.
const LEAST_SLIDE_M: f64 = 2e-4;

/// What moves the pitch, or its reading, whatever leans the glider.
fn pitches(rows: &[Row]) -> Vec<Term> {
    let slides = |down: bool| {
        let of_leg: Vec<Row> = rows.iter().filter(|row| row.stretch.descends == down).copied().collect();
        sd(&from_mean_of_leg(&of_leg, |row| row.stretch.battery_forward_m)) > LEAST_SLIDE_M
    };
    let of_mass = [true, false].into_iter().filter(|down| slides(*down)).map(Term::MassPitches);
    of_mass.chain([Term::Askew]).collect()
}
