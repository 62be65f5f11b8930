//! Which mechanisms the runs of a campaign could show, as candidates of the search. Knows what was towed; no residual.

use glidepolar_inference::Candidate;

use super::mechanisms::{IN_TANK, Mechanism, Parameter, PriorSd, Reach};
use super::model::Term;
use super::problem::{Shape, TankProblem};
use super::zero_runs::allowed_rates;

/// Fewest different speeds, and fewest different Froude numbers, of which a bump of drag is no mere slope. Two speeds do not
/// contradict any law of the speed.
const FEWEST_SPEEDS: usize = 3;
const FEWEST_FROUDE: usize = 5;
/// Speeds closer than this are one \[1\].
const SAME_SPEED: f64 = 0.05;
/// Time constants from which the search for a settling zero starts \[h\].
const TIME_CONSTANTS_H: [f64; 4] = [0.35, 0.6, 1.0, 2.0];

impl TankProblem<'_> {
    pub(super) fn find_candidates(&mut self) {
        for mechanism in IN_TANK {
            if self.why_not(mechanism).is_some() {
                continue;
            }
            match mechanism.reach {
                Reach::Campaign => {
                    self.add(Shape::All(mechanism));
                    // The strut's own runs are under way as well: what is at work there the tare has taken for the strut's.
                    let is_tared = self.data.runs.iter().any(|run| !run.tare_weights[0].is_empty());
                    if let [Parameter { term: Term::Zero(channel), .. }] = mechanism.parameters
                        && is_tared
                    {
                        self.add(Shape::WithTare(mechanism, *channel));
                    }
                }
                Reach::Hull => {
                    self.add(Shape::All(mechanism));
                    if self.data.hulls.len() > 1 {
                        self.add(Shape::EachHull(mechanism));
                    }
                }
                Reach::Day => {
                    for day in 0..self.days.count() {
                        if (0..self.data.runs.len()).any(|run| self.days.of_run(run) == Some(day)) {
                            self.add(Shape::Day(mechanism, day));
                        }
                    }
                }
                Reach::Drift => (0..3).for_each(|channel| self.add(Shape::Drift(mechanism, channel))),
                Reach::Before => self.add(Shape::Before(mechanism)),
                Reach::Absorbed => {}
            }
        }
    }

    /// Why these runs cannot show a mechanism at all; none where they can.
    pub fn why_not(&self, mechanism: &Mechanism) -> Option<&'static str> {
        let runs = &self.data.runs;
        let speeds: Vec<f64> = runs.iter().filter_map(|run| run.point.speed_m_s).collect();
        let (low, high) = range(&speeds);
        let one_speed = speeds.len() < runs.len() || high < low * (1.0 + SAME_SPEED);
        let one_sided =
            runs.iter().all(|run| run.point.yaw_deg > -0.5) || runs.iter().all(|run| run.point.yaw_deg < 0.5);
        match mechanism.name {
            "reynolds_drag" if one_speed => Some("all runs were made at one speed, and b absorbs it"),
            "axial_force_zero" if one_speed => Some("all runs were made at one speed, and b absorbs it"),
            "free_surface" if speeds.len() < runs.len() => Some("the speeds are not known"),
            "free_surface" if self.distinct_froude() < FEWEST_FROUDE || distinct_speeds(&speeds) < FEWEST_SPEEDS => {
                Some("too few speeds and lengths of hull: it is a slope with Reynolds number as well")
            }
            "wall_interference" if one_sided => Some("only one side was towed"),
            "balance_hysteresis" if !self.data.is_raw => Some("the points came reduced, without their order"),
            "zero_drift" if !self.data.is_raw => Some("the points came reduced, without their zeros"),
            "zero_drift" if !self.data.in_time => Some("the runs do not say when they were made"),
            "water_temperature" if self.days.count() < 2 => Some("all runs were made on one day"),
            "port_starboard_asymmetry" | "interaction" if one_sided => Some("only one side was towed"),
            _ => None,
        }
    }

    /// Whether there are enough different speeds to contradict a law of the speed.
    pub(super) fn shows_laws_of_speed(&self) -> bool {
        let speeds: Vec<f64> = self.data.runs.iter().filter_map(|run| run.point.speed_m_s).collect();
        distinct_speeds(&speeds) >= FEWEST_SPEEDS
    }

    fn distinct_froude(&self) -> usize {
        distinct_speeds(&self.settings.iter().filter_map(|setting| setting.froude).collect::<Vec<_>>())
    }

    pub(super) fn add(&mut self, shape: Shape) {
        let mechanism = shape.mechanism();
        let prior_sd = |parameter: &Parameter| match parameter.prior_sd {
            PriorSd::Is(prior_sd) => prior_sd,
            PriorSd::ShareOfChannel(channel, share) => share * self.largest(channel),
        };
        let copies = if matches!(shape, Shape::EachHull(_)) { self.data.hulls.len() } else { 1 };
        let parameters: Vec<&Parameter> = (0..copies).flat_map(|_| mechanism.parameters).collect();
        let mut candidate = Candidate {
            name: mechanism.name,
            parameters: parameters.iter().map(|p| (p.name, p.unit)).collect(),
            neutral: parameters.iter().map(|p| p.neutral).collect(),
            prior_sd: parameters.iter().map(|p| prior_sd(p)).collect(),
            usual_sds: f64::INFINITY,
            bounds: parameters.iter().map(|p| p.bounds).collect(),
            possible: [f64::NEG_INFINITY, f64::INFINITY],
            shown: None,
            version: None,
        };
        if let Shape::Drift(_, channel) = shape {
            candidate.prior_sd[0] = 0.1 * self.largest(channel);
            if let Some(allowed) = allowed_rates(self.data, &self.days, channel, &TIME_CONSTANTS_H) {
                candidate.bounds[0] = allowed;
            }
            for time_constant_h in TIME_CONSTANTS_H {
                candidate.neutral[1] = time_constant_h;
                self.candidates.push(candidate.clone());
                self.shapes.push(shape.clone());
            }
        } else {
            self.candidates.push(candidate);
            self.shapes.push(shape);
        }
    }
}

fn distinct_speeds(speeds: &[f64]) -> usize {
    crate::series::distinct(speeds.iter().copied(), |a, b| (a / b - 1.0).abs() < SAME_SPEED)
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}
