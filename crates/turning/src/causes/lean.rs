//! What leans the glider: list, offset of the roll mass, zero of the roll sensor.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;

use super::findings::{LateralCause, LateralDiagnosis, MOST_CHANCE, RELEVANT_ROLL_RAD, ROLL, TURN_RATE, reject};
use super::fit::Fit;
use super::held_out::{HeldOut, delta_bic, halves};
use super::model::{Row, Term, name, parameter, rolls};
use super::terms::Terms;
use crate::{VARIES_RAD, sd};

/// Standard error of the roll sensor's zero where turning does not show it \[rad\]: sensors are mounted within about a degree.
const SENSOR_ZERO_RAD: f64 = 0.0087;

/// Likelihood ratio from which on one cause excludes another: the margin of the diagnosis in the vertical plane.
const LEAST_RATIO: f64 = 20.0;

/// Likelihood ratio from which on an offset of the roll mass stands before a list, which is the commoner of the two: substantial
/// evidence on the scale of Jeffreys (1961), the square root of ten.
const SUBSTANTIAL_RATIO: f64 = 3.162;

/// Causes of the roll at rest.
const LEANS: [Term; 3] = [Term::List, Term::RollMassOffset, Term::Zero];

impl Terms {
    /// Roll at rest: list, roll mass or sensor.
    pub(super) fn lean(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
        // Where the roll is not fixed and nothing measured moves it, its mean is the pilot's.
        let moved_unseen = !self.has_roll_mass && sd(&rolls(rows)) > 1.5 * VARIES_RAD[0];
        if self.rudder_is_fixed_at_angle || moved_unseen {
            let remark = if self.rudder_is_fixed_at_angle {
                "the rudder stands at an angle, and its roll cannot be separated from a list"
            } else {
                "the roll varies, and what moves it is not in the log"
            };
            return reject(found, &LEANS.map(name), None, false, remark);
        }
        if let Some(relative) = self.fixed_roll_mass_error {
            return self.list_against_fixed_roll_mass(rows, full, relative, found);
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
        let by_mass = mass_over_list > SUBSTANTIAL_RATIO.ln();
        // A large offset of the roll mass, fitted as a list, leaves some of itself to the sensor.
        let askew = reads_askew && size_of(Term::Zero).is_some_and(is_sure);
        let mut sure: Vec<Term> = Vec::new();
        let mut alike: Vec<Term> = Vec::new();
        if leans || !askew {
            // A list stands for what is not known apart from it; what is not excluded stands beside.
            let [first, other] =
                if by_mass { [Term::RollMassOffset, Term::List] } else { [Term::List, Term::RollMassOffset] };
            sure.push(first);
            alike.extend((self.has_roll_mass && mass_over_list.abs() <= LEAST_RATIO.ln()).then_some(other));
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
    fn list_against_fixed_roll_mass(&self, rows: &[Row], full: &Fit, relative: f64, found: &mut LateralDiagnosis) {
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
