//! What turns both legs alike: rudder or drag on one side.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;

use super::findings::{LateralCause, LateralDiagnosis, MOST_CHANCE, RELEVANT_YAW_RAD_M, TURN_RATE, reject};
use super::fit::Fit;
use super::held_out::{HeldOut, delta_bic, halves};
use super::model::{ATTACK, Row, Term};
use super::terms::{FixedRudder, Terms};

/// So many standard errors two legs may differ by and still have one size, or by half of it: the limit of the vertical plane.
const LEGS_DIFFER: f64 = 3.5;

impl Terms {
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
        let is_unknown = self.rudder_is_fixed_at_angle && self.fixed_rudder.is_none();
        if is_unknown || !self.both_legs {
            let remark = if is_unknown {
                "the rudder stands at an angle, and what it does cannot be separated from an offset"
            } else {
                "one leg alone does not show what turns both alike"
            };
            return reject(found, &names, None, false, remark);
        }
        let Some(size) = found.sizes[1] else { return };
        if self.fixed_rudder.is_some_and(|rudder| rudder.is_flown_against(size[0])) {
            let remark = "the glider turns against its rudder, as with a channel of the other sign";
            return reject(found, &names, None, false, remark);
        }
        let considered = self.fixed_rudder.map_or(0.0, |rudder| rudder.error_of_curvature(size[0]));
        let p_value = full.chance_considering(size, considered, RELEVANT_YAW_RAD_M);
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
        let (curvature, angle) = match self.fixed_rudder {
            Some(rudder) => (rudder.asymmetry(size, full), Some(rudder.offset(size, full))),
            None => {
                let angle =
                    self.has_rudder.then(|| full.ratio_by_dives(rows, Term::Yaw, Term::Rudder, "rad")).flatten();
                (Estimate::student(size[0], size[1], full.freedom(), "rad/m"), angle)
            }
        };
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

impl FixedRudder {
    /// Curvature that its angle gives by the vehicle's figure \[rad/m\].
    fn given(&self) -> f64 {
        self.curvature_per_rudder * self.angle_rad
    }

    /// Curvature that the glider flies, for one that is left without the rudder \[rad/m\].
    fn flown(&self, left: f64) -> f64 {
        left + self.given()
    }

    /// Whether the glider turns against its rudder by half of what that would turn it, or more.
    fn is_flown_against(&self, left: f64) -> bool {
        let (flown, given) = (self.flown(left), self.given());
        flown * given < 0.0 && flown.abs() > 0.5 * given.abs()
    }

    /// What a curvature that is left errs by where there is no offset \[rad/m\]. The glider flies what the rudder gives then, so the
    /// logarithm of their ratio errs as that of the curvature per rudder does. Their difference is that times their logarithmic mean:
    /// nothing where one of them is nothing, since no rudder gives nothing or the opposite.
    fn error_of_curvature(&self, left: f64) -> f64 {
        let (flown, given) = (self.flown(left), self.given());
        let mean = match flown / given {
            ratio if ratio.is_nan() || ratio <= 0.0 || ratio.is_infinite() => 0.0,
            ratio if (ratio - 1.0).abs() < 1e-6 => given,
            ratio => (flown - given) / ratio.ln(),
        };
        self.relative_error * mean.abs()
    }

    /// The offset of the rudder: the angle that gives what is flown, less the angle that is read.
    fn offset(&self, [left, se]: [f64; 2], full: &Fit) -> Estimate {
        let k = self.curvature_per_rudder;
        considering(full, [left / k, se / k], self.relative_error * self.flown(left).abs() / k, "rad")
    }

    /// What turns the glider in place of an offset: what is flown, less what the rudder gives.
    fn asymmetry(&self, size: [f64; 2], full: &Fit) -> Estimate {
        considering(full, size, self.relative_error * self.given().abs(), "rad/m")
    }
}

/// A size that errs by a considered figure too.
fn considering(full: &Fit, [value, se]: [f64; 2], considered: f64, unit: &str) -> Estimate {
    Estimate::student(value, se.hypot(considered), full.freedom_considering(se, considered), unit)
}
