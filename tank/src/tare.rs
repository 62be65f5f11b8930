//! The strut's own force against angle and speed, from runs without a model.
//!
//! Each channel over the dynamic pressure is a short series in the sine of the drift angle; the axial force also in the
//! logarithm of the speed, since friction does not go with its square. As many terms as the angles and speeds support, and
//! at least what a strut has by its symmetry: an axial force that is even in the angle, a side force and a moment that go
//! with its sine. A strut that was tared straight ahead alone is taken to feel its drag along the flow, as a round one does,
//! give or take as much.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::influence::{self, Influence};
use crate::motion::Motion;
use crate::run_variance;
use crate::series::distinct;
use glidepolar_inference::regression::{Problem, Regression, Scatter, Shared};

/// The strut's force.
#[derive(Debug, Clone)]
pub struct Tare {
    channels: [Channel; 3],
    reference_speed_m_s: f64,
    /// Tare runs that entered.
    pub runs: usize,
    /// Drift angles between which was tared \[deg\].
    pub between_deg: [f64; 2],
    /// Whether it was tared straight ahead alone.
    pub is_ahead_alone: bool,
    /// What a short programme of tare runs leaves open, in sentences.
    pub warnings: Vec<&'static str>,
}

#[derive(Debug, Clone)]
struct Channel {
    terms: Vec<Term>,
    /// How many of them the tare runs show.
    shown: usize,
    /// Degrees of freedom of its errors.
    dof: f64,
    fit: Regression,
    /// What a change of force in each run does to the terms.
    response: DMatrix<f64>,
    /// Of the covariance of the terms.
    root: DMatrix<f64>,
}

type Term = fn(Argument) -> f64;

/// What the strut's force depends on.
#[derive(Debug, Clone, Copy)]
struct Argument {
    sine: f64,
    log_speed: f64,
}

/// One tare run: force less zero, through the interaction.
#[derive(Debug, Clone)]
pub struct TareRun {
    /// Mean yaw angle \[rad\].
    pub yaw_rad: f64,
    /// Root mean square of the speed \[m/s\].
    pub speed_m_s: f64,
    /// Speed that was asked for \[m/s\].
    pub nominal_speed_m_s: f64,
    /// Dynamic pressure \[Pa\].
    pub dynamic_pressure_Pa: f64,
    /// AF, SF, YM.
    pub force: Vector3<f64>,
    /// Their variances.
    pub variance: Vector3<f64>,
    /// Of the zeros on the force.
    pub zero_influence: Influence,
}

/// Standard deviation of the exponent of the speed in a strut's axial force over the dynamic pressure: nothing where the drag is one
/// of form, -0.25 where it is friction of a turbulent chord (the ITTC-57 line at a Reynolds number of 3e5). Even between the two,
/// the root of the mean square is 0.25/sqrt 3.
const FRICTION_EXPONENT: f64 = 0.144;
/// Side force over dynamic pressure and sine of the angle of a strut that was tared straight ahead alone, over its axial force: one
/// for a round strut, whose drag is along the flow at every angle (independence of direction), and its standard deviation, as
/// large. A streamlined strut has more, as its lift slope is to its drag; no tare straight ahead tells.
const SIDE_OVER_AXIAL: f64 = 1.0;
/// A belief is a row of its own, of which the fit must not doubt more than is believed: its own variance, as a share.
const SMALL_SHARE: f64 = 1e-6;
/// Angles and speeds closer than this are one.
const SAME_DEG: f64 = 0.3;
const SAME_SPEED: f64 = 0.05;

impl Tare {
    /// Fits the tare runs; none if they are too few.
    pub fn fit(runs: &[TareRun], zero_dof: f64) -> Option<Tare> {
        let programme = Programme::new(runs);
        let reference_speed_m_s = crate::series::median(&runs.iter().map(|run| run.speed_m_s).collect::<Vec<_>>());
        let axial_m2 = crate::series::median(&per_pressure(runs, 0));
        let channel = |index: usize| {
            let (terms, belief) = programme.terms(index, axial_m2);
            let fit = fit(index, &terms, belief, runs, reference_speed_m_s, zero_dof)?;
            let mut response = fit.gain.columns(0, runs.len()).into_owned();
            for (mut column, run) in response.column_iter_mut().zip(runs) {
                column /= run.dynamic_pressure_Pa;
            }
            let root = influence::root(&fit.covariance);
            // What is believed of the side force outweighs what a few runs show of its level.
            let dof = if belief.is_some_and(|belief| belief.is_shared) {
                fit.parameter_dof[terms.len() - 1]
            } else {
                fit.dof as f64
            };
            Some(Channel { shown: terms.len() - usize::from(belief.is_some()), terms, dof, fit, response, root })
        };
        let channels = [channel(0)?, channel(1)?, channel(2)?];
        let yaw_deg = || runs.iter().map(|run| run.yaw_rad.to_degrees());
        let between_deg = [yaw_deg().fold(f64::INFINITY, f64::min), yaw_deg().fold(f64::NEG_INFINITY, f64::max)];
        let mut warnings = Vec::new();
        match programme.angles {
            1 if programme.at_zero => warnings.push(
                "the strut was tared straight ahead alone: its side force at drift angles is taken to be that of a round strut, give or take as much, and intervals allow for that; what a streamlined strut has beyond it is still in CL and CM, its yaw moment in CM, and an axial force that grows with the angle in CD; tare at the largest angles of the sweep as well",
            ),
            1 => warnings.push(
                "the strut was tared at one angle alone: its side force and yaw moment are taken to go with the sine of the angle; tare at several angles of both sides",
            ),
            _ => {}
        }
        if channels.iter().any(|channel| channel.shown == runs.len()) {
            warnings.push(
                "there are no more tare runs than terms of the strut's force: how far tare runs scatter is not known, and intervals take them to scatter within themselves alone; repeat a tare run",
            );
        }
        let is_ahead_alone = programme.is_ahead_alone();
        Some(Tare { channels, reference_speed_m_s, runs: runs.len(), between_deg, is_ahead_alone, warnings })
    }

    /// AF, SF, YM of the strut in a motion; `density_kg_m3` of the water.
    pub fn force(&self, motion: &Motion, density_kg_m3: f64) -> Vector3<f64> {
        Vector3::from_fn(|channel, _| {
            let gradient = self.gradient(channel, motion, density_kg_m3);
            gradient.dot(&self.channels[channel].fit.parameters)
        })
    }

    /// The force's change with the parameters of one channel.
    pub fn gradient(&self, channel: usize, motion: &Motion, density_kg_m3: f64) -> DVector<f64> {
        let speed = motion.speed();
        let pressure = 0.5 * density_kg_m3 * speed * speed;
        let argument = Argument {
            sine: if speed > 0.0 { -motion.v / speed } else { 0.0 },
            log_speed: (speed / self.reference_speed_m_s).ln(),
        };
        let terms = &self.channels[channel].terms;
        DVector::from_iterator(terms.len(), terms.iter().map(|term| pressure * term(argument)))
    }

    /// What a change of force in each tare run does to the parameters of one channel: parameters by runs.
    pub fn response(&self, channel: usize) -> &DMatrix<f64> {
        &self.channels[channel].response
    }

    /// What one standard error of each independent part of a channel's errors does to its parameters: parameters by parts.
    pub fn root(&self, channel: usize) -> &DMatrix<f64> {
        &self.channels[channel].root
    }

    /// The same where no degrees of freedom are allowed for: never less than what the runs themselves show. A few residuals are
    /// small by chance, for which an interval has Student's quantiles.
    pub fn considered_root(&self, channel: usize) -> DMatrix<f64> {
        let fit = &self.channels[channel].fit;
        if fit.chi2_per_dof >= 1.0 {
            return self.channels[channel].root.clone();
        }
        let variances = DMatrix::from_diagonal(&fit.weights.map(f64::recip));
        influence::root(&(&fit.covariance - &fit.own_covariance + &fit.gain * variances * fit.gain.transpose()))
    }

    /// Degrees of freedom of a channel's errors.
    pub fn dof(&self, channel: usize) -> f64 {
        self.channels[channel].dof
    }

    /// Parameters of a channel.
    pub fn terms(&self, channel: usize) -> usize {
        self.channels[channel].terms.len()
    }
}

/// What the tare runs were made at.
struct Programme {
    runs: usize,
    /// Different angles, and different ones whatever their sign.
    angles: usize,
    sizes: usize,
    speeds: usize,
    /// Whether all angles are zero.
    at_zero: bool,
}

impl Programme {
    fn new(runs: &[TareRun]) -> Programme {
        let yaw_deg = || runs.iter().map(|run| run.yaw_rad.to_degrees());
        let same = |a: f64, b: f64| (a - b).abs() < SAME_DEG;
        Programme {
            runs: runs.len(),
            angles: distinct(yaw_deg(), same),
            sizes: distinct(yaw_deg().map(f64::abs), same),
            speeds: distinct(runs.iter().map(|run| run.speed_m_s), |a, b| (a / b - 1.0).abs() < SAME_SPEED),
            at_zero: yaw_deg().all(|yaw_deg| yaw_deg.abs() < SAME_DEG),
        }
    }

    /// The terms of one channel: what a strut must have, and more of them where two runs more than terms judge the scatter; and
    /// what is believed of the last one where these runs cannot show it.
    fn terms(&self, channel: usize, axial_m2: f64) -> (Vec<Term>, Option<Belief>) {
        let constant: Term = |_| 1.0;
        let sine: Term = |x| x.sine;
        let mut terms = match (channel, self.angles) {
            (0, _) if self.sizes >= 2 => vec![constant, |x: Argument| x.sine * x.sine],
            (0, _) => vec![constant],
            (1, 1) if self.at_zero => vec![constant, sine],
            (_, 1) if self.at_zero => vec![constant],
            (_, 1) => vec![sine],
            _ => vec![constant, sine],
        };
        let odd: (bool, Term) =
            if channel == 0 { (self.angles >= 3, sine) } else { (self.angles >= 5, |x| x.sine.powi(3)) };
        let is_shown = |is_supported: bool, terms: &[Term]| is_supported && self.runs >= terms.len() + 3;
        if is_shown(odd.0, &terms) {
            terms.push(odd.1);
        }
        let side = SIDE_OVER_AXIAL * axial_m2;
        let belief = match channel {
            0 if !is_shown(self.speeds >= 2, &terms) => {
                Some(Belief { value: 0.0, sd: FRICTION_EXPONENT * axial_m2.abs(), is_shared: false })
            }
            1 if self.is_ahead_alone() => Some(Belief { value: side, sd: side.abs(), is_shared: true }),
            _ => None,
        };
        if channel == 0 {
            terms.push(|x| x.log_speed);
        }
        (terms, belief)
    }

    fn is_ahead_alone(&self) -> bool {
        self.angles == 1 && self.at_zero
    }
}

/// What is believed of a term that the runs do not show, over the dynamic pressure.
#[derive(Debug, Clone, Copy)]
struct Belief {
    value: f64,
    sd: f64,
    /// Whether its error is apart from the scatter of the runs, which says nothing of it.
    is_shared: bool,
}

/// Fits one channel; a row below those of the runs states what is believed of the last term.
fn fit(
    channel: usize,
    terms: &[Term],
    belief: Option<Belief>,
    runs: &[TareRun],
    reference_speed_m_s: f64,
    zero_dof: f64,
) -> Option<Regression> {
    let n = runs.len();
    let rows = n + usize::from(belief.is_some());
    let argument =
        |run: &TareRun| Argument { sine: run.yaw_rad.sin(), log_speed: (run.speed_m_s / reference_speed_m_s).ln() };
    let mut zeros = Influence::stacked(runs.iter().map(|run| &run.zero_influence), channel).on;
    for (mut row, run) in zeros.row_iter_mut().zip(runs) {
        row /= run.dynamic_pressure_Pa;
    }
    let mut observed = per_pressure(runs, channel);
    let mut variance = run_variance::share(
        &runs.iter().map(|run| run.variance[channel] / run.dynamic_pressure_Pa.powi(2)).collect::<Vec<_>>(),
        &runs.iter().map(|run| run.nominal_speed_m_s).collect::<Vec<_>>(),
    );
    let mut shared = vec![Shared { influence: zeros.resize_vertically(rows, 0.0), dof: zero_dof }];
    if let Some(Belief { value, sd, is_shared }) = belief {
        observed.push(value);
        let own = if is_shared { SMALL_SHARE } else { 1.0 };
        variance.push((own * sd * sd).max(f64::MIN_POSITIVE));
        if is_shared {
            let mut influence = DMatrix::zeros(rows, 1);
            influence[(n, 0)] = sd;
            shared.push(Shared { influence, dof: f64::INFINITY });
        }
    }
    let last = terms.len() - 1;
    let problem = Problem {
        design: DMatrix::from_fn(rows, terms.len(), |i, j| match runs.get(i) {
            Some(run) => terms[j](argument(run)),
            None => f64::from(u8::from(j == last)),
        }),
        observed: DVector::from_vec(observed),
        variance: DVector::from_vec(variance),
        shared,
    };
    let given = Scatter::Given { dof: run_variance::OWN_DOF as usize * n };
    problem.solve(if rows > terms.len() { Scatter::BetweenRuns } else { given })
}

/// A channel's force in each run over the dynamic pressure.
fn per_pressure(runs: &[TareRun], channel: usize) -> Vec<f64> {
    runs.iter().map(|run| run.force[channel] / run.dynamic_pressure_Pa).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED_M_S: f64 = 2.0;
    const PRESSURE_PA: f64 = 2000.0;

    /// A strut whose axial force is even in the angle, and whose side force and moment go with its sine.
    fn strut(yaw_deg: f64) -> Vector3<f64> {
        let sine = yaw_deg.to_radians().sin();
        Vector3::new(2.4 + 3.0 * sine * sine, 8.0 * sine, 0.5 * sine)
    }

    fn tared_at(yaw_deg: &[f64]) -> Tare {
        let run = |yaw_deg: &f64| TareRun {
            yaw_rad: yaw_deg.to_radians(),
            speed_m_s: SPEED_M_S,
            nominal_speed_m_s: SPEED_M_S,
            dynamic_pressure_Pa: PRESSURE_PA,
            force: strut(*yaw_deg),
            variance: Vector3::repeat(1e-6),
            zero_influence: Influence::none(3),
        };
        Tare::fit(&yaw_deg.iter().map(run).collect::<Vec<_>>(), 10.0).expect("a tare")
    }

    fn at(tare: &Tare, yaw_deg: f64) -> Vector3<f64> {
        let motion = Motion::straight(SPEED_M_S, yaw_deg.to_radians(), 0.0);
        tare.force(&motion, PRESSURE_PA / (0.5 * SPEED_M_S * SPEED_M_S))
    }

    #[test]
    fn few_tare_runs_give_what_the_symmetry_of_a_strut_allows() {
        for angles in
            [&[-8.0, -4.0, 0.0, 4.0, 8.0][..], &[-8.0, 0.0, 8.0], &[-4.0, 0.0, 4.0], &[0.0, 8.0], &[-8.0, -4.0]]
        {
            let tare = tared_at(angles);
            for yaw_deg in [-8.0, -3.0, 0.0, 5.0] {
                let error = at(&tare, yaw_deg) - strut(yaw_deg);
                assert!(error.norm() < 1e-9, "{angles:?} at {yaw_deg}: {error}");
            }
        }
    }

    #[test]
    fn one_tare_angle_is_used_and_what_it_leaves_open_is_said() {
        let ahead = tared_at(&[0.0]);
        // A round strut's drag is along the flow.
        let side = 2.4 * 8f64.to_radians().sin();
        assert!((at(&ahead, 8.0) - Vector3::new(2.4, side, 0.0)).norm() < 1e-9);
        assert!(ahead.warnings[0].contains("straight ahead alone") && ahead.warnings[1].contains("repeat a tare run"));
        let aside = tared_at(&[-8.0, -8.0]);
        // The side force goes with the sine; of the axial force only the level at that angle is known.
        let expected = Vector3::new(strut(8.0)[0], strut(4.0)[1], strut(4.0)[2]);
        assert!((at(&aside, 4.0) - expected).norm() < 1e-9);
        assert_eq!(aside.warnings.len(), 1);
        assert!(aside.warnings[0].contains("at one angle alone"));
        assert!(tared_at(&[-8.0, 0.0, 8.0]).warnings.is_empty());
    }

    /// Four runs that agree by chance do not make the strut known better than each of them is.
    #[test]
    fn a_diagnosis_considers_at_least_what_the_tare_runs_themselves_show() {
        let tare = tared_at(&[0.0; 4]);
        assert!(tare.root(2).norm() < 1e-9);
        let expected = (1e-6f64 / 4.0).sqrt() / PRESSURE_PA;
        assert!((tare.considered_root(2).norm() / expected - 1.0).abs() < 1e-6);
    }

    /// Whatever the runs scatter, the side force is believed to within its own size, with the quantile of a known variance.
    #[test]
    fn the_side_force_that_a_tare_straight_ahead_cannot_show_is_in_the_error() {
        for tare in [tared_at(&[0.0]), tared_at(&[0.0; 2]), tared_at(&[0.0; 6])] {
            let motion = Motion::straight(SPEED_M_S, 8f64.to_radians(), 0.0);
            let gradient = tare.gradient(1, &motion, PRESSURE_PA / (0.5 * SPEED_M_S * SPEED_M_S));
            let sd = tare.root(1).tr_mul(&gradient).norm();
            assert!((sd / (2.4 * 8f64.to_radians().sin()) - 1.0).abs() < 1e-3, "{sd}");
            assert!(tare.dof(1) > 1e4, "{}", tare.dof(1));
        }
    }

    /// Three runs straight ahead at three speeds show no term of friction; the strut's error at other speeds is what friction allows.
    #[test]
    fn friction_that_the_tare_runs_cannot_show_is_in_the_error() {
        let axial = |speed_m_s: f64| 2.0 * speed_m_s.powf(-0.15);
        let run = |speed_m_s: &f64| {
            let pressure = 500.0 * speed_m_s.powi(2);
            TareRun {
                yaw_rad: 0.0,
                speed_m_s: *speed_m_s,
                nominal_speed_m_s: *speed_m_s,
                dynamic_pressure_Pa: pressure,
                force: Vector3::new(1e-3 * pressure * axial(*speed_m_s), 0.0, 0.0),
                variance: Vector3::repeat(1e-6),
                zero_influence: Influence::none(3),
            }
        };
        for speeds in [&[0.7, 1.4, 2.1][..], &[1.4], &[1.4, 1.4, 1.4]] {
            let tare = Tare::fit(&speeds.iter().map(run).collect::<Vec<_>>(), 10.0).expect("a tare");
            let motion = Motion::straight(0.7, 0.0, 0.0);
            let gradient = tare.gradient(0, &motion, 1000.0);
            let error = (tare.force(&motion, 1000.0)[0] / 245.0 / 1e-3 / axial(0.7) - 1.0).abs();
            let se = tare.root(0).tr_mul(&gradient).norm() / 0.245 / axial(0.7);
            assert!(error < 2.0 * se && se < 0.15, "{speeds:?}: {error} and {se}");
        }
    }
}
