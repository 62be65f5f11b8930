//! The questions that a log is asked: what leans the glider, what turns both legs alike.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;

use super::findings::{
    LateralCause, LateralDiagnosis, LateralRejected, MOST_CHANCE, RELEVANT_ROLL_RAD, RELEVANT_YAW_RAD_M, ROLL,
    TURN_RATE,
};
use super::fit::Fit;
use super::held_out::{HeldOut, delta_bic, halves};
use super::model::{Row, Term, name, parameter, rolls};
use crate::{HELD_RUDDER_RAD, LEAST_STRETCHES, Stretch, VARIES_RAD, sd};

/// Standard error of the roll sensor's zero where turning does not show it \[rad\]: sensors are mounted within about a degree.
const SENSOR_ZERO_RAD: f64 = 0.0087;

/// What the log can be asked.
pub(super) struct Terms {
    turns: Vec<Term>,
    rolls: Vec<Term>,
    /// Whether the roll varied on both legs, so that turning shows the true roll.
    separates_sensor: bool,
    has_roll_mass: bool,
    has_rudder: bool,
    /// The rudder stands at an angle: what it does is not separated from anything constant.
    rudder_is_held: bool,
    both_legs: bool,
}

impl Terms {
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
        let rudder_is_held = !has_rudder && mean_rudder.abs() > HELD_RUDDER_RAD;
        let has_roll_mass = varies(&roll_mass, VARIES_RAD[2]);
        let separates_sensor = rolls_on(true) && rolls_on(false);
        let mut turns = vec![Term::Attack, Term::Yaw];
        if separates_sensor {
            for down in [true, false] {
                turns.extend([Term::RollTurns(down), Term::RollBends(down), Term::PitchBends(down)]);
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
        Terms { turns, rolls, separates_sensor, has_roll_mass, has_rudder, rudder_is_held, both_legs }
    }

    /// Every term, those of the lean in the form of a list.
    pub(super) fn all(&self) -> Vec<Term> {
        let mut all = self.with(&[Term::List]);
        if self.separates_sensor {
            all.push(Term::Zero);
        }
        all
    }

    pub(super) fn with(&self, lean: &[Term]) -> Vec<Term> {
        [&self.turns[..], &self.rolls[..], lean].concat()
    }

    /// Roll at rest: list, roll mass or sensor.
    pub(super) fn lean(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
        let names = [Term::List, Term::RollMassOffset, Term::Zero];
        let reject = |found: &mut LateralDiagnosis, p_value, predicts_no_better, remark: &str| {
            for term in names {
                let remark = remark.to_owned();
                found.rejected.push(LateralRejected { cause: name(term), p_value, predicts_no_better, remark });
            }
        };
        // Where the roll is not fixed and nothing measured moves it, its mean is the pilot's.
        let moved_unseen = !self.has_roll_mass && sd(&rolls(rows)) > 1.5 * VARIES_RAD[0];
        if self.rudder_is_held || moved_unseen {
            let remark = if self.rudder_is_held {
                "the rudder stands at an angle, and its roll cannot be separated from a list"
            } else {
                "the roll varies, and what moves it is not in the log"
            };
            return reject(found, None, false, remark);
        }
        let at_rest = full.sum(&[Term::List, Term::Zero]);
        let alone =
            [Term::List, Term::Zero].into_iter().filter_map(|term| full.size(term).filter(|_| self.separates_sensor));
        let p_value = alone.chain(at_rest).map(|size| full.chance(size, RELEVANT_ROLL_RAD)).fold(1.0, f64::min);
        if p_value > MOST_CHANCE {
            return reject(
                found,
                Some(p_value),
                false,
                "the roll at rest does not exceed the limit of relevance for certain",
            );
        }
        // One explanation in the place of the other.
        let mut rivals: Vec<(Term, Fit)> = Vec::new();
        for term in names {
            let is_open = match term {
                Term::RollMassOffset => self.has_roll_mass,
                _ => true,
            };
            if let Some(fit) = is_open.then(|| Fit::new(rows, &self.with(&[term]), Some(full.sds))).flatten() {
                rivals.push((term, fit));
            }
        }
        // What is known apart by turning alone: the sensor turns nothing. What is known apart by roll alone: the roll at large
        // angles of the roll mass. A list stands for what is not known apart from it.
        let tells = |a: Term, b: Term| if a == Term::Zero || b == Term::Zero { TURN_RATE } else { ROLL };
        let Some(list) = rivals.iter().position(|(term, _)| *term == Term::List) else { return };
        let mut best = list;
        for other in 0..rivals.len() {
            let quantity = tells(rivals[best].0, rivals[other].0);
            let (at_hand, rival) = (&rivals[best].1, &rivals[other].1);
            // Without a turn per roll a sensor and a list are one figure.
            let is_better = match rivals[other].0 {
                Term::Zero => self.separates_sensor && at_hand.is_worse_than(rival, quantity),
                _ => at_hand.is_worse_than(rival, quantity),
            };
            if is_better {
                best = other;
            }
        }
        let (term, fit) = &rivals[best];
        let alike: Vec<&'static str> = (0..rivals.len())
            .filter(|other| *other != best && !rivals[*other].1.is_worse_than(fit, tells(rivals[*other].0, *term)))
            .map(|other| name(rivals[other].0))
            .collect();
        // With the sensor's zero beside it where turning shows that one.
        let beside = match term {
            Term::Zero => vec![Term::List, Term::Zero],
            other if self.separates_sensor => vec![*other, Term::Zero],
            other => vec![*other],
        };
        let sized = Fit::new(rows, &self.with(&beside), None);
        let separate = sized.as_ref().filter(|_| !alike.contains(&name(Term::Zero)) || !self.separates_sensor);
        let sized = separate.unwrap_or(fit);
        let Some(size) = sized.size(*term) else { return };
        let Some(held_out) = HeldOut::new(rows, ROLL, &self.with(&[]), &self.with(&[*term])) else { return };
        let [before, after] = held_out.rms();
        let gain = held_out.reduction_percent();
        if gain.value <= gain.se {
            return reject(
                found,
                Some(p_value),
                true,
                "held-out dives are not predicted better with it by a standard error",
            );
        }
        let by_scatter = sized.jackknife(rows, |fit| fit.size(*term));
        let knows_sensor = sized.at(Term::Zero).is_some();
        let per_rad = if *term == Term::RollMassOffset { fit.value(Term::Gain).abs().max(0.1) } else { 1.0 };
        let of_sensor = if knows_sensor { 0.0 } else { SENSOR_ZERO_RAD / per_rad };
        let se = size[1].max(by_scatter).hypot(of_sensor);
        let estimate = Some(Estimate::student(size[0], se, sized.freedom(), "rad"));
        let parameters = estimate.map(|estimate| (parameter(*term).to_owned(), estimate)).into_iter().collect();
        let terms = self.with(&[*term]);
        found.causes.push(LateralCause {
            cause: name(*term),
            parameters,
            p_value,
            delta_bic: delta_bic(rows, before, after),
            quantity: ROLL,
            holdout_rms_before: before,
            holdout_rms_after: after,
            reduction_percent: gain,
            expected_rms: full.sds[1],
            size: size[0].abs() * if *term == Term::RollMassOffset { fit.value(Term::Gain).abs() } else { 1.0 },
            relevant_above: RELEVANT_ROLL_RAD,
            halves: halves(rows, &terms, |fit| fit.size(*term)),
            indistinguishable_from: alike.clone(),
        });
        for (other, _) in rivals.iter().filter(|(other, _)| other != term && !alike.contains(&name(*other))) {
            let remark = format!("in the place of {} it fits worse for certain", name(*term).replace('_', " "));
            found.rejected.push(LateralRejected {
                cause: name(*other),
                p_value: None,
                predicts_no_better: true,
                remark,
            });
        }
    }

    /// Both legs turn alike: rudder or drag on one side.
    pub(super) fn yaw(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
        let reject = |found: &mut LateralDiagnosis, p_value, predicts_no_better, remark: &str| {
            for cause in ["rudder_offset", "yaw_asymmetry"] {
                let remark = remark.to_owned();
                found.rejected.push(LateralRejected { cause, p_value, predicts_no_better, remark });
            }
        };
        if self.rudder_is_held || !self.both_legs {
            let remark = if self.rudder_is_held {
                "the rudder stands at an angle, and what it does cannot be separated from an offset"
            } else {
                "one leg alone does not show what turns both alike"
            };
            return reject(found, None, false, remark);
        }
        let Some(size) = full.size(Term::Yaw) else { return };
        let p_value = full.chance(size, RELEVANT_YAW_RAD_M);
        if p_value > MOST_CHANCE {
            let remark = "what turns both legs alike does not exceed the limit of relevance for certain";
            return reject(found, Some(p_value), false, remark);
        }
        let without: Vec<Term> = self.all().into_iter().filter(|term| *term != Term::Yaw).collect();
        let Some(held_out) = HeldOut::new(rows, TURN_RATE, &without, &self.all()) else { return };
        let [before, after] = held_out.rms();
        let gain = held_out.reduction_percent();
        // The noise of turn rates differs from dive to dive: each dive has one vote.
        if !held_out.gains_by_dives() {
            return reject(
                found,
                Some(p_value),
                true,
                "held-out dives are not predicted better with it by a standard error",
            );
        }
        let curvature = full.estimate(Term::Yaw, "rad/m");
        let angle = full.ratio(Term::Yaw, Term::Rudder, "rad").filter(|_| self.has_rudder);
        let cause = if angle.is_some() { "rudder_offset" } else { "yaw_asymmetry" };
        let mut parameters: BTreeMap<String, Estimate> = BTreeMap::new();
        parameters.extend(angle.map(|angle| ("rudder_offset_rad".to_owned(), angle)));
        parameters.extend(curvature.map(|curvature| ("yaw_asymmetry_rad_per_m".to_owned(), curvature)));
        let speed = rows.iter().map(|row| row.speed_m_s).sum::<f64>() / rows.len() as f64;
        let has_channel = rows.iter().any(|row| row.stretch.rudder_rad.is_finite());
        found.causes.push(LateralCause {
            cause,
            parameters,
            p_value,
            delta_bic: delta_bic(rows, before, after),
            quantity: TURN_RATE,
            holdout_rms_before: before,
            holdout_rms_after: after,
            reduction_percent: gain,
            expected_rms: full.sds[0],
            size: size[0].abs() * speed,
            relevant_above: RELEVANT_YAW_RAD_M * speed,
            halves: halves(rows, &self.all(), |fit| fit.size(Term::Yaw)),
            indistinguishable_from: match (cause, has_channel) {
                ("rudder_offset", _) => vec!["yaw_asymmetry"],
                (_, true) => vec!["rudder_offset"],
                _ => Vec::new(),
            },
        });
    }
}
