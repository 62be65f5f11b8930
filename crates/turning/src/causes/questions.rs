//! The questions that a log is asked: what leans the glider, what turns both legs alike.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;

use super::findings::{
    LateralCause, LateralDiagnosis, LateralRejected, MOST_CHANCE, PITCH, RELEVANT_ROLL_RAD, RELEVANT_YAW_RAD_M, ROLL,
    TURN_RATE,
};
use super::fit::Fit;
use super::held_out::{HeldOut, delta_bic, halves};
use super::model::{ATTACK, Row, Term, from_mean_of_leg, name, parameter, rolls};
use crate::{HELD_RUDDER_RAD, LEAST_STRETCHES, Stretch, VARIES_RAD, sd};

/// Standard error of the roll sensor's zero where turning does not show it \[rad\]: sensors are mounted within about a degree.
const SENSOR_ZERO_RAD: f64 = 0.0087;

/// Relative error of a vehicle's roll per roll mass: its height of the moving mass is an estimate. That of the figures of lift without a
/// stated error.
const ROLL_PER_ROLL_MASS_ERROR: f64 = 0.15;

/// What the log can be asked.
pub(super) struct Terms {
    turns: Vec<Term>,
    rolls: Vec<Term>,
    /// Whether the roll varied on both legs, so that turning shows the true roll.
    separates_sensor: bool,
    has_roll_mass: bool,
    /// The roll mass is read but does not vary, and how much it rolls is the vehicle's: the standard deviation of that figure, relative.
    holds_roll_mass: Option<f64>,
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
        let is_read = roll_mass.iter().all(|angle| angle.is_finite());
        let holds_roll_mass =
            (!has_roll_mass && is_read && rows[0].roll_per_roll_mass > 0.0).then_some(ROLL_PER_ROLL_MASS_ERROR);
        let terms = Terms {
            turns,
            rolls,
            separates_sensor,
            has_roll_mass,
            holds_roll_mass,
            has_rudder,
            rudder_is_held,
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
        let held = Terms { rolls: with(&pitches), turns: self.turns.clone(), ..self };
        let zero: &[Term] = if self.separates_sensor { &[Term::Zero] } else { &[] };
        let fit = |terms: &Terms, lean: Term, sds| Fit::new(rows, &terms.with(&[&[lean], zero].concat()), sds);
        let Some(held) = fit(&held, Term::List, None) else { return self };
        let is_better =
            |lean: Term| fit(&moved, lean, Some(held.sds)).is_some_and(|fit| held.is_worse_than(&fit, PITCH));
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

    pub(super) fn with(&self, lean: &[Term]) -> Vec<Term> {
        [&self.turns[..], &self.rolls[..], lean].concat()
    }

    /// Roll at rest: list, roll mass or sensor.
    pub(super) fn lean(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
        // Where the roll is not fixed and nothing measured moves it, its mean is the pilot's.
        let moved_unseen = !self.has_roll_mass && sd(&rolls(rows)) > 1.5 * VARIES_RAD[0];
        if self.rudder_is_held || moved_unseen {
            let remark = if self.rudder_is_held {
                "the rudder stands at an angle, and its roll cannot be separated from a list"
            } else {
                "the roll varies, and what moves it is not in the log"
            };
            return reject(found, &LEANS.map(name), None, false, remark);
        }
        if let Some(relative) = self.holds_roll_mass {
            return self.lean_against_held_mass(rows, full, relative, found);
        }
        let parts = Parts::new(self, rows, full);
        let is_sure = |size: [f64; 2]| full.chance(size, RELEVANT_ROLL_RAD) <= MOST_CHANCE;
        // Whether it leans at all is asked before what leans it: parts that undo each other lean nothing.
        let [leans, reads_askew] =
            [Term::List, Term::Zero].map(|term| full.size(term).filter(|_| self.separates_sensor).is_some_and(is_sure));
        let sizes = [full.size(Term::List), full.size(Term::Zero)].into_iter().flatten().chain([parts.sum]);
        let p_value = sizes.map(|size| full.chance(size, RELEVANT_ROLL_RAD)).fold(1.0, f64::min);
        if p_value > MOST_CHANCE {
            let remark = "the roll at rest does not exceed the limit of relevance for certain";
            return reject(found, &LEANS.map(name), Some(p_value), false, remark);
        }
        let size_of = |wanted: Term| parts.sizes.iter().find(|(term, _)| *term == wanted).map(|(_, size)| *size);
        // The lean is established. List alone and roll mass alone are compared by their likelihoods.
        let ratio = |wanted: Term| size_of(wanted).map_or(0.0, |size| full.log_likelihood_ratio(size));
        let mass_over_list = ratio(Term::RollMassOffset) - ratio(Term::List);
        let by_mass = mass_over_list > LEAST_RATIO.ln();
        // A large offset of the roll mass, fitted as a list, leaves some of itself to the sensor.
        let askew = reads_askew && size_of(Term::Zero).is_some_and(is_sure);
        let mut sure: Vec<Term> = Vec::new();
        let mut alike: Vec<Term> = Vec::new();
        if leans || !askew {
            // A list stands for what is not known apart from it.
            sure.push(if by_mass { Term::RollMassOffset } else { Term::List });
            let is_apart = by_mass || mass_over_list < -LEAST_RATIO.ln();
            alike.extend((self.has_roll_mass && !is_apart).then_some(Term::RollMassOffset));
        }
        if askew {
            sure.push(Term::Zero);
        } else if self.separates_sensor && !leans {
            alike.push(Term::Zero);
        }
        if !self.separates_sensor && self.turns_apart(rows, full.sds) == Some(false) {
            alike.push(Term::Zero);
        }
        for term in &sure {
            self.name_lean(rows, full, *term, &alike, (p_value, 0.0), found);
        }
        let excluded: Vec<&'static str> =
            LEANS.into_iter().filter(|term| !sure.contains(term) && !alike.contains(term)).map(name).collect();
        if found.causes.iter().any(|cause| cause.quantity == ROLL) {
            reject(
                found,
                &excluded,
                None,
                true,
                "turn rate and roll together exclude it as the only cause of the roll at rest",
            );
        }
    }

    /// Roll at rest of a glider whose roll mass stands still, as a heading control leaves it against a list: what the roll mass takes
    /// back is the vehicle's figure, a considered parameter. List and offset of the roll mass are one then.
    fn lean_against_held_mass(&self, rows: &[Row], full: &Fit, relative: f64, found: &mut LateralDiagnosis) {
        let both = [(Term::List, 1.0), (Term::Zero, 1.0)];
        let sum = full.sum(&both);
        let moves = |factor: f64| {
            let scaled = |row: &Row| Row { roll_per_roll_mass: factor * row.roll_per_roll_mass, ..*row };
            let rows: Vec<Row> = rows.iter().map(scaled).collect();
            Fit::new(&rows, &self.all(), None).map_or(0.0, |fit| (fit.sum(&both)[0] - sum[0]).abs())
        };
        let considered = moves(1.0 - relative).max(moves(1.0 + relative));
        let p_value = full.chance_considering(sum, considered, RELEVANT_ROLL_RAD);
        if p_value > MOST_CHANCE {
            let remark = "the roll at rest does not exceed the limit of relevance for certain";
            return reject(found, &LEANS.map(name), Some(p_value), false, remark);
        }
        let mut alike = vec![Term::RollMassOffset];
        if self.turns_apart(rows, full.sds) == Some(false) {
            alike.push(Term::Zero);
        }
        self.name_lean(rows, full, Term::List, &alike, (p_value, considered), found);
    }

    /// Whether the legs turn apart as a rolled glider's do, where the roll does not vary: a sensor turns nothing.
    fn turns_apart(&self, rows: &[Row], sds: [f64; 3]) -> Option<bool> {
        let [list, sensor] = [Term::List, Term::Zero].map(|term| Fit::new(rows, &self.with(&[term]), Some(sds)));
        Some(sensor?.is_worse_than(&list?, TURN_RATE))
    }

    /// Names a cause of the roll at rest with its size, where held-out dives are predicted better with it; `considered` is what the
    /// roll at rest errs by beside the fit \[rad\].
    fn name_lean(
        &self,
        rows: &[Row],
        full: &Fit,
        term: Term,
        alike: &[Term],
        (p_value, considered): (f64, f64),
        found: &mut LateralDiagnosis,
    ) {
        let knows_sensor = self.separates_sensor && !alike.contains(&Term::Zero);
        // With the sensor's zero beside it where turning shows that one.
        let beside = match term {
            Term::Zero => vec![Term::List, Term::Zero],
            other if knows_sensor => vec![other, Term::Zero],
            other => vec![other],
        };
        let Some(sized) = Fit::new(rows, &self.with(&beside), None) else { return };
        let Some(size) = sized.size(term) else { return };
        let per_rad = if term == Term::RollMassOffset { sized.value(Term::Gain).abs().max(0.1) } else { 1.0 };
        let se = size[1].max(sized.jackknife(rows, |fit| fit.size(term)));
        // What the sensor's zero errs by is no scatter between dives.
        let of_sensor = if knows_sensor { full.lasting_disturbance(rows) } else { SENSOR_ZERO_RAD };
        let considered = considered.hypot(of_sensor);
        if full.chance_considering([size[0], se].map(|figure| per_rad * figure), considered, RELEVANT_ROLL_RAD)
            > MOST_CHANCE
        {
            let remark = "by itself it does not exceed the limit of relevance for certain";
            return reject(found, &[name(term)], Some(p_value), false, remark);
        }
        let Some(held_out) = HeldOut::new(rows, ROLL, &self.with(&[]), &self.with(&[term])) else { return };
        let [before, after] = held_out.rms();
        let gain = held_out.reduction_percent();
        if gain.value <= gain.se {
            let remark = "held-out dives are not predicted better with it by a standard error";
            return reject(found, &[name(term)], Some(p_value), true, remark);
        }
        let freedom = sized.freedom_considering(per_rad * se, considered);
        let estimate = Estimate::student(size[0], se.hypot(considered / per_rad), freedom, "rad");
        found.causes.push(LateralCause {
            cause: name(term),
            parameters: BTreeMap::from([(parameter(term).to_owned(), estimate)]),
            p_value,
            delta_bic: delta_bic(rows, before, after),
            quantity: ROLL,
            holdout_rms_before: before,
            holdout_rms_after: after,
            reduction_percent: gain,
            expected_rms: full.sds[1],
            size: size[0].abs() * per_rad,
            relevant_above: RELEVANT_ROLL_RAD,
            halves: halves(rows, &self.with(&beside), |fit| fit.size(term)),
            indistinguishable_from: alike.iter().filter(|other| **other != term).map(|other| name(*other)).collect(),
        });
    }

    /// Curvature without roll and rudder with its standard error \[rad/m\].
    ///
    /// It is per speed, and the speed follows from pitch and depth rate with the angle of attack. A log without a measured speed
    /// seems to show that angle by the difference of the legs, but any small error that is opposite on the legs (pitch
    /// sensor, vertical current) makes the same difference. So drag over lift is a considered parameter here: fixed at its
    /// prior, whose error counts in full, besides the larger of the errors by clusters and by leaving out dives.
    pub(super) fn curvature(&self, rows: &[Row]) -> Option<[f64; 2]> {
        let terms: Vec<Term> = self.all().into_iter().filter(|term| *term != Term::Attack).collect();
        let [mean, sd] = ATTACK;
        let at = |drag_per_lift: f64| {
            let rows: Vec<Row> = rows.iter().map(|row| Row { drag_per_lift, ..*row }).collect();
            Fit::new(&rows, &terms, None)
        };
        let fit = at(mean)?;
        let [value, by_clusters] = fit.size(Term::Yaw)?;
        let by_dives = fit.jackknife(rows, |fit| fit.size(Term::Yaw));
        // To both sides: the curvature is not linear in it.
        let considered =
            [mean - sd, mean + sd].map(|other| at(other).map_or(0.0, |fit| (fit.value(Term::Yaw) - value).abs()));
        Some([value, by_clusters.max(by_dives).hypot(considered[0].max(considered[1]))])
    }

    /// Both legs turn alike: rudder or drag on one side.
    pub(super) fn yaw(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
        let names = ["rudder_offset", "yaw_asymmetry"];
        if self.rudder_is_held || !self.both_legs {
            let remark = if self.rudder_is_held {
                "the rudder stands at an angle, and what it does cannot be separated from an offset"
            } else {
                "one leg alone does not show what turns both alike"
            };
            return reject(found, &names, None, false, remark);
        }
        let Some(size) = found.sizes[1] else { return };
        let p_value = full.chance(size, RELEVANT_YAW_RAD_M);
        if p_value > MOST_CHANCE {
            let remark = "what turns both legs alike does not exceed the limit of relevance for certain";
            return reject(found, &names, Some(p_value), false, remark);
        }
        // The legs at the sensor's own zero: with a free one, any two figures are one yaw and one zero.
        let by_leg = Fit::new(rows, &[self.with(&[Term::List]), vec![Term::YawApart]].concat(), Some(full.sds));
        let differ = by_leg.and_then(|fit| Some([fit.size(Term::YawApart)?, fit.size(Term::Yaw)?]));
        if differ
            .is_some_and(|[[half, se], [mean, _]]| half.abs() > LEGS_DIFFER * se && 2.0 * half.abs() > 0.5 * mean.abs())
        {
            let remark = "what turns the descents and what turns the ascents differ by far more than their errors";
            return reject(found, &names, Some(p_value), true, remark);
        }
        let without: Vec<Term> = self.all().into_iter().filter(|term| *term != Term::Yaw).collect();
        let Some(held_out) = HeldOut::new(rows, TURN_RATE, &without, &self.all()) else { return };
        let [before, after] = held_out.rms();
        let gain = held_out.reduction_percent();
        // The noise of turn rates differs from dive to dive: each dive has one vote.
        if !held_out.gains_by_dives() {
            let remark = "held-out dives are not predicted better with it by a standard error";
            return reject(found, &names, Some(p_value), true, remark);
        }
        let curvature = Estimate::student(size[0], size[1], full.freedom(), "rad/m");
        let angle = full.ratio(Term::Yaw, Term::Rudder, "rad").filter(|_| self.has_rudder);
        let cause = if angle.is_some() { "rudder_offset" } else { "yaw_asymmetry" };
        let mut parameters: BTreeMap<String, Estimate> = BTreeMap::new();
        parameters.extend(angle.map(|angle| ("rudder_offset_rad".to_owned(), angle)));
        parameters.insert("yaw_asymmetry_rad_per_m".to_owned(), curvature);
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

/// So many standard errors two legs may differ by and still have one size, or by half of it: the limit of the vertical plane.
const LEGS_DIFFER: f64 = 3.5;

/// Likelihood ratio from which on one cause excludes another: the margin of the diagnosis in the vertical plane.
const LEAST_RATIO: f64 = 20.0;

/// Causes of the roll at rest.
const LEANS: [Term; 3] = [Term::List, Term::RollMassOffset, Term::Zero];

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

fn reject(
    found: &mut LateralDiagnosis,
    causes: &[&'static str],
    p_value: Option<f64>,
    predicts_no_better: bool,
    remark: &str,
) {
    found.rejected.extend(causes.iter().map(|cause| LateralRejected {
        cause,
        p_value,
        predicts_no_better,
        remark: remark.to_owned(),
    }));
}

/// The parts of the roll at rest, fitted together as far as the log shows them apart.
struct Parts {
    /// Each part \[rad\] with its standard error, where the log shows it.
    sizes: Vec<(Term, [f64; 2])>,
    /// All together.
    sum: [f64; 2],
}

impl Parts {
    fn new(terms: &Terms, rows: &[Row], full: &Fit) -> Parts {
        let mut lean = vec![Term::List];
        lean.extend(terms.has_roll_mass.then_some(Term::Share));
        lean.extend(terms.separates_sensor.then_some(Term::Zero));
        let joint = Fit::new(rows, &terms.with(&lean), None);
        let fit = joint.as_ref().unwrap_or(full);
        // The roll mass's part is its offset times the roll per angle; the list is what it leaves.
        let of_mass = fit.at(Term::Share).map(|_| fit.value(Term::Gain));
        let weights = |part: Term| match part {
            Term::List => vec![(Term::List, 1.0), (Term::Share, -of_mass.unwrap_or(0.0))],
            Term::RollMassOffset => vec![(Term::Share, of_mass.unwrap_or(0.0))],
            other => vec![(other, 1.0)],
        };
        let all = LEANS.into_iter().filter(|part| match part {
            Term::RollMassOffset => of_mass.is_some(),
            Term::Zero => fit.at(Term::Zero).is_some(),
            _ => true,
        });
        // The scatter of dives counts where it is more: a control that moves the roll mass far leaves stretches that hardly settle.
        let size = |part: Term| {
            let [value, se] = fit.sum(&weights(part));
            [value, se.max(fit.jackknife(rows, |fit| Some(fit.sum(&weights(part)))))]
        };
        Parts {
            sizes: all.map(|part| (part, size(part))).collect(),
            sum: full.sum(&[(Term::List, 1.0), (Term::Zero, 1.0)]),
        }
    }
}
