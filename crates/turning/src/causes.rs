//! What makes a glider turn or lean that should not: list, rudder or roll mass off their zeros, drag on one side, an attitude
//! sensor that is mounted askew.
//!
//! Each steady stretch gives two readings, its turn rate and its roll:
//!
//! ```text
//! turn rate = V (c + k_delta delta + k_leg cot|theta| (roll - e))
//! roll      = e + atan((g sin(gamma + gamma0) + tan list) / (1 + g (cos(gamma + gamma0) - 1))) + k_roll delta V^2 + k_p V r tan theta / cos theta
//! ```
//!
//! `V` is the leg's median speed by depth rate and pitch. The side component of the net weight turns a rolled glider: it is
//! proportional to `cot theta` times the drag and changes its sign with the leg. So the parity in leg and roll separates causes.
//! A rudder's offset or drag on one side (`c`) turns both legs alike. A list (`gamma0` or `list`) turns them apart and is read as
//! roll. A sensor that is askew (`e`) is read as roll and turns nothing. What has the same signs in both is one group: offset of
//! the rudder and drag on one side, and, but for the cosine of large angles, offset of the roll mass and list.
//!
//! A size must be more than chance explains ([`MOST_CHANCE`]) with all other sizes fitted beside it, exceed a limit of relevance by
//! a standard error, and predict held-out dives better by one. Rivals are refitted in its place; those that are not worse
//! for certain are its group.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

use glidepolar_flightlog::Observation;
use glidepolar_inference::estimate::Estimate;
use glidepolar_inference::regression::{Problem, Scatter};

use super::{HELD_RUDDER_RAD, LEAST_DIVES, LEAST_STRETCHES, Stretch, VARIES_RAD, sd, stretches};

/// Probability by chance, corrected for the number of questions, above which nothing is named: the diagnosis' own limit.
pub const MOST_CHANCE: f64 = 0.01;

/// Roll at rest from which a list is worth acting on \[rad\]: attitude sensors are mounted within about a degree, and a list of
/// 2.5 deg adds less than 1 % of drag to the built-in gliders.
pub const RELEVANT_ROLL_RAD: f64 = 0.044;

/// Curvature of the path from which an asymmetry in yaw is worth acting on \[rad/m\]: 15 deg, a usual dead band of a heading
/// control, within five minutes at 0.3 m/s.
pub const RELEVANT_YAW_RAD_M: f64 = 0.003;

/// Standard error of the roll sensor's zero where turning does not show it \[rad\]: sensors are mounted within about a degree.
const SENSOR_ZERO_RAD: f64 = 0.0087;

/// Questions that are asked of a log: roll at rest, list, sensor, yaw.
const QUESTIONS: f64 = 4.0;

/// Speeds of a leg that are taken at their word \[m/s\], and the flattest pitch of a glide \[rad\]: depth rate over its sine is no
/// speed below that.
const SLOWEST_M_S: f64 = 0.05;
const FASTEST_M_S: f64 = 1.0;
const FLATTEST_RAD: f64 = 0.12;

/// Prior standard deviation of the curvature per roll and cotangent of the pitch, where the roll hardly varies \[1/m\]: some times
/// what gliders show (0.03 to 0.1).
const PRIOR_PER_ROLL: f64 = 0.2;

/// Steps of Gauss and Newton: the model is nearly linear.
const STEPS: usize = 12;

/// The quantities of the two readings.
pub const TURN_RATE: &str = "turn_rate";
/// See [`TURN_RATE`].
pub const ROLL: &str = "roll";

/// A cause that is named.
#[derive(Debug, Clone)]
pub struct LateralCause {
    /// Name of the mechanism.
    pub cause: &'static str,
    /// Its parameters; the size has the name of the vehicle file's figure where there is one.
    pub parameters: BTreeMap<String, Estimate>,
    /// Probability by chance of a size like this one.
    pub p_value: f64,
    /// Fall of the Bayesian information criterion, a dive and leg being one observation.
    pub delta_bic: f64,
    /// Quantity of the errors: [`TURN_RATE`] \[rad/s\] or [`ROLL`] \[rad\].
    pub quantity: &'static str,
    /// Error on held-out dives without it.
    pub holdout_rms_before: f64,
    /// Error on held-out dives with it.
    pub holdout_rms_after: f64,
    /// By how many per cent it falls.
    pub reduction_percent: Estimate,
    /// Scatter about the fitted model with it.
    pub expected_rms: f64,
    /// Root mean square of what it does to the quantity.
    pub size: f64,
    /// The limit of relevance in the quantity.
    pub relevant_above: f64,
    /// Its size on the first and second half of the dives, with standard errors; empty where half of them is too few.
    pub halves: Vec<(f64, f64)>,
    /// Mechanisms that the log cannot separate from it.
    pub indistinguishable_from: Vec<&'static str>,
}

/// A mechanism that is not named, with its probability by chance and a sentence.
#[derive(Debug, Clone)]
pub struct LateralRejected {
    /// Name of the mechanism.
    pub cause: &'static str,
    /// Probability by chance; none where the log cannot show it.
    pub p_value: Option<f64>,
    /// Whether held-out dives speak against it.
    pub predicts_no_better: bool,
    /// The reason.
    pub remark: String,
}

/// What a log says of the causes of turning.
#[derive(Debug, Clone)]
pub struct LateralDiagnosis {
    /// Steady stretches.
    pub stretches: usize,
    /// Named mechanisms, the clearest first.
    pub causes: Vec<LateralCause>,
    /// Roll at rest \[rad\] and curvature \[rad/m\] with standard errors, named or not.
    pub sizes: [Option<[f64; 2]>; 2],
    /// The others.
    pub rejected: Vec<LateralRejected>,
    /// Turn rate per roll on a straight course over turn rate per rudder: the rudder that holds a rolled glider straight.
    pub rudder_per_roll: Option<f64>,
}

/// The causes; nothing where [`turning`](super::turning) has too few steady stretches, or the log has no roll.
pub fn causes(observations: &[Observation]) -> Option<LateralDiagnosis> {
    let rows: Vec<Row> = rows(observations);
    let dives = dives(&rows);
    if rows.len() < LEAST_STRETCHES || dives.len() < LEAST_DIVES {
        return None;
    }
    let terms = Terms::of(&rows);
    let full = Fit::new(&rows, &terms.all(), None)?;
    let mut found = LateralDiagnosis {
        stretches: rows.len(),
        causes: Vec::new(),
        rejected: Vec::new(),
        sizes: [full.sum(&[Term::List, Term::Zero]), full.size(Term::Yaw)],
        rudder_per_roll: full.rudder_per_roll(),
    };
    terms.lean(&rows, &full, &mut found);
    terms.yaw(&rows, &full, &mut found);
    found.causes.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    Some(found)
}

/// One steady stretch with what the model needs.
#[derive(Debug, Clone, Copy)]
struct Row {
    stretch: Stretch,
    speed_m_s: f64,
    cot: f64,
}

/// A figure of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Term {
    /// Curvature without roll and rudder \[rad/m\].
    Yaw,
    /// Curvature per roll and cotangent of the pitch on descents, on ascents \[1/m\].
    RollTurns(bool),
    /// The same for both legs, with the sign of the leg.
    RollTurnsAlike,
    /// Curvature per rudder \[1/m\].
    Rudder,
    /// Zero of the roll sensor.
    Zero,
    /// List.
    List,
    /// Offset of the roll mass.
    RollMassOffset,
    /// Roll per roll mass at small angles.
    Gain,
    /// Roll per rudder and squared speed.
    RudderRolls,
    /// Roll by what damps the roll rate of a turn at this pitch.
    Damped,
}

/// What the log can be asked.
struct Terms {
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
    fn of(rows: &[Row]) -> Terms {
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
        let mut turns = vec![Term::Yaw];
        if separates_sensor {
            turns.extend([Term::RollTurns(true), Term::RollTurns(false)]);
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
    fn all(&self) -> Vec<Term> {
        let mut all = self.with(&[Term::List]);
        if self.separates_sensor {
            all.push(Term::Zero);
        }
        all
    }

    fn with(&self, lean: &[Term]) -> Vec<Term> {
        [&self.turns[..], &self.rolls[..], lean].concat()
    }

    /// Roll at rest: list, roll mass or sensor.
    fn lean(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
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
    fn yaw(&self, rows: &[Row], full: &Fit, found: &mut LateralDiagnosis) {
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

fn name(term: Term) -> &'static str {
    match term {
        Term::RollMassOffset => "roll_mass_offset",
        Term::Zero => "roll_offset",
        _ => "static_list",
    }
}

fn parameter(term: Term) -> &'static str {
    match term {
        Term::RollMassOffset => "roll_mass_offset_rad",
        Term::Zero => "roll_offset_rad",
        _ => "static_list_rad",
    }
}

fn rows(observations: &[Observation]) -> Vec<Row> {
    let is_usable = |s: &Stretch| s.roll_rad.is_finite() && s.speed_m_s.is_finite() && s.pitch_rad.abs() > FLATTEST_RAD;
    let found: Vec<Stretch> = stretches(observations).into_iter().filter(is_usable).collect();
    let mut of_leg: BTreeMap<(u32, bool), Vec<f64>> = BTreeMap::new();
    for stretch in &found {
        of_leg.entry((stretch.dive, stretch.descends)).or_default().push(stretch.speed_m_s);
    }
    let of_leg: BTreeMap<(u32, bool), f64> =
        of_leg.into_iter().map(|(leg, mut speeds)| (leg, glidepolar_flightlog::median(&mut speeds))).collect();
    let row = |stretch: Stretch| {
        let speed_m_s = of_leg[&(stretch.dive, stretch.descends)].clamp(SLOWEST_M_S, FASTEST_M_S);
        Row { stretch, speed_m_s, cot: 1.0 / stretch.pitch_rad.abs().tan() }
    };
    found.into_iter().map(row).collect()
}

fn dives(rows: &[Row]) -> Vec<u32> {
    rows.iter().map(|row| row.stretch.dive).collect::<std::collections::BTreeSet<_>>().into_iter().collect()
}

fn rolls(rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| row.stretch.roll_rad).collect()
}

/// Values of the terms at which the steps begin: a roll of half of what the roll mass turns by.
fn start(terms: &[Term]) -> DVector<f64> {
    DVector::from_iterator(terms.len(), terms.iter().map(|term| if *term == Term::Gain { 0.5 } else { 0.0 }))
}

/// Turn rate and roll of a stretch by the model.
fn predicted(row: &Row, terms: &[Term], values: &DVector<f64>) -> [f64; 2] {
    let of = |wanted: Term| terms.iter().position(|term| *term == wanted).map_or(0.0, |at| values[at]);
    let Row { stretch, speed_m_s, cot } = *row;
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let (rudder, roll_mass) = (finite(stretch.rudder_rad), finite(stretch.roll_mass_rad));
    let (zero, gain) = (of(Term::Zero), of(Term::Gain));
    let sign = if stretch.descends { -1.0 } else { 1.0 };
    let per_roll = of(Term::RollTurns(stretch.descends)) + sign * of(Term::RollTurnsAlike);
    let rate =
        speed_m_s * (of(Term::Yaw) + of(Term::Rudder) * rudder + per_roll * cot * (stretch.roll_rad - zero).sin());
    let (sin, cos) = (roll_mass + of(Term::RollMassOffset)).sin_cos();
    let lean = ((gain * sin + of(Term::List).tan()) / (1.0 + gain * (cos - 1.0))).atan();
    let (sin_pitch, cos_pitch) = stretch.pitch_rad.clamp(-1.4, 1.4).sin_cos();
    let damped = of(Term::Damped) * speed_m_s * stretch.rate_rad_s * sin_pitch / (cos_pitch * cos_pitch);
    [rate, zero + lean + damped + of(Term::RudderRolls) * rudder * speed_m_s * speed_m_s]
}

/// The model with some of its terms, fitted.
struct Fit {
    terms: Vec<Term>,
    values: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Scatter of turn rate and roll.
    sds: [f64; 2],
    /// Sums of squares of turn rate and roll, in units of the scatter, for each dive.
    by_dive: Vec<[f64; 2]>,
}

impl Fit {
    /// None where the terms depend on each other. The weights follow from the scatter where they are not given.
    fn new(rows: &[Row], terms: &[Term], sds: Option<[f64; 2]>) -> Option<Fit> {
        let n = rows.len();
        let mut values = start(terms);
        let scatter = |values: &DVector<f64>| {
            let mut squares = [0.0; 2];
            for row in rows {
                let [rate, roll] = predicted(row, terms, values);
                squares[0] += (row.stretch.rate_rad_s - rate).powi(2);
                squares[1] += (row.stretch.roll_rad - roll).powi(2);
            }
            // Perfect readings would leave nothing to weigh by.
            squares.map(|sum| (sum / n as f64).sqrt().max(1e-9))
        };
        let spread = |of: fn(&Stretch) -> f64| sd(&rows.iter().map(|row| of(&row.stretch)).collect::<Vec<_>>());
        let mut weights =
            sds.unwrap_or_else(|| [spread(|s| s.rate_rad_s), spread(|s| s.roll_rad)].map(|sd| sd.max(1e-9)));
        // Twice a dive: rate and roll of one stretch err apart, those of one dive together.
        let mut clusters: Vec<u32> = rows.iter().flat_map(|row| [row.stretch.dive; 2]).collect();
        let prior = terms.iter().position(|term| *term == Term::RollTurnsAlike);
        clusters.extend(prior.map(|_| u32::MAX));
        let length = clusters.len();
        let mut last = None;
        for step in 0..STEPS {
            let of_rows = rows.iter().flat_map(|row| {
                let [rate, roll] = predicted(row, terms, &values);
                [(row.stretch.rate_rad_s - rate) / weights[0], (row.stretch.roll_rad - roll) / weights[1]]
            });
            let of_prior = prior.map(|at| -values[at] / PRIOR_PER_ROLL);
            let residual = DVector::from_iterator(length, of_rows.chain(of_prior));
            let mut design = DMatrix::zeros(length, terms.len());
            if let Some(at) = prior {
                design[(length - 1, at)] = 1.0 / PRIOR_PER_ROLL;
            }
            for column in 0..terms.len() {
                let step = 1e-5;
                let at = |change: f64| {
                    let mut values = values.clone();
                    values[column] += change;
                    values
                };
                let (above, below) = (at(step), at(-step));
                for (i, row) in rows.iter().enumerate() {
                    let (up, down) = (predicted(row, terms, &above), predicted(row, terms, &below));
                    for k in 0..2 {
                        design[(2 * i + k, column)] = (up[k] - down[k]) / (2.0 * step) / weights[k];
                    }
                }
            }
            // While nothing is known of the turn per roll, a sensor's zero is a list: it follows in the next step.
            let is_known = |at: &usize| step > 0 || terms[*at] != Term::Zero || !terms.contains(&Term::List);
            let known: Vec<usize> = (0..terms.len()).filter(is_known).collect();
            let fit = Problem::plain(design.select_columns(&known), residual).solve(Scatter::Equal)?;
            for (place, at) in known.iter().enumerate() {
                values[*at] += fit.parameters[place];
            }
            if !values.iter().all(|value| value.is_finite()) {
                return None;
            }
            if sds.is_none() && step < STEPS / 2 {
                weights = scatter(&values);
            }
            last = (known.len() == terms.len()).then(|| fit.cluster_covariance(&clusters));
        }
        let covariance = last?;
        let mut by_dive: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for row in rows {
            let [rate, roll] = predicted(row, terms, &values);
            let of_dive = by_dive.entry(row.stretch.dive).or_default();
            of_dive[0] += ((row.stretch.rate_rad_s - rate) / weights[0]).powi(2);
            of_dive[1] += ((row.stretch.roll_rad - roll) / weights[1]).powi(2);
        }
        let by_dive = by_dive.into_values().collect();
        Some(Fit { terms: terms.to_vec(), values, covariance, sds: weights, by_dive })
    }

    fn at(&self, term: Term) -> Option<usize> {
        self.terms.iter().position(|known| *known == term)
    }

    fn value(&self, term: Term) -> f64 {
        self.at(term).map_or(0.0, |at| self.values[at])
    }

    /// Value and standard error.
    fn size(&self, term: Term) -> Option<[f64; 2]> {
        self.at(term).map(|at| [self.values[at], self.covariance[(at, at)].max(0.0).sqrt()])
    }

    /// The same of a sum of terms.
    fn sum(&self, terms: &[Term]) -> Option<[f64; 2]> {
        let places: Vec<usize> = terms.iter().filter_map(|term| self.at(*term)).collect();
        let value = places.iter().map(|at| self.values[*at]).sum();
        let variance: f64 = places.iter().flat_map(|a| places.iter().map(|b| self.covariance[(*a, *b)])).sum();
        (!places.is_empty()).then(|| [value, variance.max(0.0).sqrt()])
    }

    /// Standard error of a size by leaving out one dive at a time.
    fn jackknife(&self, rows: &[Row], of: impl Fn(&Fit) -> Option<[f64; 2]>) -> f64 {
        let without = |dive: u32| {
            let kept: Vec<Row> = rows.iter().filter(|row| row.stretch.dive != dive).copied().collect();
            Fit::new(&kept, &self.terms, None).as_ref().and_then(&of).map(|[value, _]| value)
        };
        let parts: Vec<f64> = dives(rows).into_iter().filter_map(without).collect();
        let n = parts.len() as f64;
        let mean = parts.iter().sum::<f64>() / n;
        let se = ((n - 1.0) / n * parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>()).sqrt();
        if se.is_finite() { se } else { 0.0 }
    }

    fn freedom(&self) -> f64 {
        self.by_dive.len() as f64 - 1.0
    }

    fn estimate(&self, term: Term, unit: &str) -> Option<Estimate> {
        self.size(term).map(|[value, se]| Estimate::student(value, se, self.freedom(), unit))
    }

    /// One term over another; none where the denominator may be zero.
    fn ratio(&self, above: Term, below: Term, unit: &str) -> Option<Estimate> {
        let (a, b) = (self.at(above)?, self.at(below)?);
        let (top, bottom) = (self.values[a], self.values[b]);
        let se = |at: usize| self.covariance[(at, at)].max(0.0).sqrt();
        if bottom.abs() < super::SURE * se(b) {
            return None;
        }
        let value = top / bottom;
        let variance = (self.covariance[(a, a)] - 2.0 * value * self.covariance[(a, b)]
            + value * value * self.covariance[(b, b)])
            / (bottom * bottom);
        Some(Estimate::student(value, variance.max(0.0).sqrt(), self.freedom(), unit))
    }

    fn rudder_per_roll(&self) -> Option<f64> {
        let rudder = self.ratio(Term::Yaw, Term::Rudder, "")?;
        let per_roll =
            [Term::RollTurns(true), Term::RollTurns(false), Term::RollTurnsAlike].map(|term| self.value(term).abs());
        rudder.value.is_finite().then(|| per_roll.into_iter().fold(0.0, f64::max) / self.value(Term::Rudder).abs())
    }

    /// Probability by chance of a size like this one, corrected for the number of questions; 1 where it does not exceed the
    /// limit of relevance by a standard error.
    fn chance(&self, [value, se]: [f64; 2], limit: f64) -> f64 {
        let is_relevant = value.abs() - se > limit;
        let chance = 2.0 * student_above(value.abs() / se.max(f64::MIN_POSITIVE), self.freedom());
        if is_relevant { (QUESTIONS * chance).min(1.0) } else { 1.0 }
    }

    /// Whether its misfit in a quantity is larger for certain, the dives being independent (Vuong 1989, with Student's t).
    fn is_worse_than(&self, other: &Fit, quantity: &str) -> bool {
        let at = usize::from(quantity == ROLL);
        let apart: Vec<f64> = self.by_dive.iter().zip(&other.by_dive).map(|(a, b)| a[at] - b[at]).collect();
        let n = apart.len() as f64;
        let mean = apart.iter().sum::<f64>() / n;
        let se = sd(&apart) / n.sqrt();
        student_above(mean / se.max(f64::MIN_POSITIVE), n - 1.0) < MOST_CHANCE
    }
}

fn student_above(t: f64, freedom: f64) -> f64 {
    if t.is_nan() {
        return 1.0;
    }
    StudentsT::new(0.0, 1.0, freedom.max(1.0)).map_or(1.0, |student| student.sf(t))
}

/// Most parts into which the dives are cut, each predicted from the others.
const FOLDS: usize = 10;

/// Errors of a quantity on dives that were not fitted, without and with a term.
struct HeldOut {
    /// Sums of squares for each dive.
    by_dive: Vec<[f64; 2]>,
    rows: usize,
}

impl HeldOut {
    /// None where one of the models cannot be fitted without a part of the dives.
    fn new(rows: &[Row], quantity: &str, without: &[Term], with: &[Term]) -> Option<HeldOut> {
        let dives = dives(rows);
        let mut by_dive = vec![[0.0; 2]; dives.len()];
        let folds = dives.len().min(FOLDS);
        for fold in 0..folds {
            let place = |row: &Row| dives.binary_search(&row.stretch.dive).unwrap_or(0);
            let (left, kept): (Vec<Row>, Vec<Row>) = rows.iter().partition(|row| place(row) % folds == fold);
            for (k, terms) in [without, with].into_iter().enumerate() {
                let fit = Fit::new(&kept, terms, None)?;
                for row in &left {
                    let [rate, roll] = predicted(row, terms, &fit.values);
                    let error =
                        if quantity == ROLL { row.stretch.roll_rad - roll } else { row.stretch.rate_rad_s - rate };
                    by_dive[place(row)][k] += error * error;
                }
            }
        }
        Some(HeldOut { by_dive, rows: rows.len() })
    }

    fn rms(&self) -> [f64; 2] {
        [0, 1].map(|k| (self.by_dive.iter().map(|dive| dive[k]).sum::<f64>() / self.rows as f64).sqrt())
    }

    /// Whether the relative gain exceeds zero by a standard error, each dive being one.
    fn gains_by_dives(&self) -> bool {
        let gains: Vec<f64> = self.by_dive.iter().map(|dive| 0.5 * (dive[0] / dive[1]).ln()).collect();
        let n = gains.len() as f64;
        gains.iter().sum::<f64>() / n > sd(&gains) / n.sqrt()
    }

    /// By how many per cent the error falls, with a 95 % interval by leaving out one dive at a time.
    fn reduction_percent(&self) -> Estimate {
        let n = self.by_dive.len() as f64;
        let [before, after] = [0, 1].map(|k| self.by_dive.iter().map(|dive| dive[k]).sum::<f64>());
        let log = |before: f64, after: f64| 0.5 * (after / before).ln();
        let whole = log(before, after);
        let parts: Vec<f64> = self.by_dive.iter().map(|dive| log(before - dive[0], after - dive[1])).collect();
        let mean = parts.iter().sum::<f64>() / n;
        let se = ((n - 1.0) / n * parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>()).sqrt();
        let percent = |log: f64| 100.0 * (1.0 - log.exp());
        let [low, high] = Estimate::student(whole, se, n - 1.0, "").ci95;
        Estimate {
            value: percent(whole),
            se: 100.0 * whole.exp() * se,
            ci95: [percent(high), percent(low)],
            unit: "%".to_owned(),
        }
    }
}

/// Size and standard error on the first and the second half of the dives.
fn halves(rows: &[Row], terms: &[Term], of: impl Fn(&Fit) -> Option<[f64; 2]>) -> Vec<(f64, f64)> {
    let dives = dives(rows);
    let middle = dives[dives.len() / 2];
    let half = |second: bool| {
        let part: Vec<Row> = rows.iter().filter(|row| (row.stretch.dive >= middle) == second).copied().collect();
        let [value, se] = Fit::new(&part, terms, None).as_ref().and_then(&of)?;
        Some((value, se))
    };
    [false, true].into_iter().map(half).collect::<Option<Vec<_>>>().unwrap_or_default()
}

fn delta_bic(rows: &[Row], before: f64, after: f64) -> f64 {
    let legs: std::collections::BTreeSet<(u32, bool)> =
        rows.iter().map(|row| (row.stretch.dive, row.stretch.descends)).collect();
    let n = legs.len() as f64;
    2.0 * n * (before / after).ln() - n.ln()
}
