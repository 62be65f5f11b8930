//! The tank paper's iterative scheme for a, b, c (Williams, Bachmayer, deYoung 2007, equations 4 to 7), step by step,
//! glide by glide and over a campaign, descents and ascents apart.
//!
//! With `t = |pitch|`, `alpha` the size of the angle of attack and `gamma = t + alpha` the size of the path angle, the
//! balance of a steady glide is `CD = CL tan gamma` and `W = q A (CL cos gamma + CD sin gamma)`, and
//! `q = rho/2 (w / sin gamma)^2`. The paper names the functions and does not print them; these follow:
//! ```text
//! f0  (4)  c T alpha^3 + (a - c) alpha^2 + (a + b) T alpha - b = 0,    T = tan t     from tan alpha = alpha
//! f1  (5)  a = (W sin^2 gamma / (rho/2 A w^2) - (b + c alpha^2) sin gamma) / (alpha cos gamma)   exact
//! f2  (6)  b = a alpha tan gamma - c alpha^2                                                    exact
//! f3  (7)  c = (a alpha tan gamma - b) / alpha^2                                                exact
//! ```
//! (4) is `(b + c alpha^2)(1 - T tan alpha) = a alpha (T + tan alpha)`, the glide equation, with `alpha` for `tan alpha`.
//!
//! What it hides: (6) makes the glide equation hold, so (7) gives back the c that went into (6), always: per glide, c
//! never leaves its first value. And (4) solves the equation that (6) has just made true of the old angle, so that the
//! angle of attack stays where the first guess put it. With (4) exact, every angle would be a fixed point; with the
//! cubic it creeps by its error, a part in some hundreds, in every round, and would do so for ever. The scheme therefore
//! stops when a round moves less than [`STILL`]. Per glide it turns the first guess into numbers that fit any data. Over
//! a campaign the regression of CD on alpha^2 moves b and c together.

use serde::Serialize;

use crate::dynamics::Parameters;
use crate::log::Observation;

/// The three coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coefficients {
    /// Lift slope \[1/rad\].
    pub a: f64,
    /// Drag at zero angle of attack.
    pub b: f64,
    /// Growth of drag with the square of the angle of attack \[1/rad2\].
    pub c: f64,
}

/// The mean of one descent or ascent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeanGlide {
    /// Which leg of the log.
    pub leg: u32,
    /// Pitch, nose up positive \[rad\].
    pub pitch_rad: f64,
    /// Downward velocity \[m/s\].
    pub sink_m_s: f64,
    /// Net weight W - B, positive when heavy \[N\].
    pub net_weight_N: f64,
    /// Density \[kg/m3\].
    pub density_kg_m3: f64,
}

/// What the scheme makes of one glide.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SolvedGlide {
    /// The glide.
    pub glide: MeanGlide,
    /// Its own coefficients.
    pub coefficients: Coefficients,
    /// Angle of attack, positive on descents \[rad\].
    pub angle_of_attack_rad: f64,
    /// Glide path angle, negative on descents \[rad\].
    pub glide_angle_rad: f64,
    /// Speed through the water \[m/s\].
    pub speed_m_s: f64,
    /// Lift coefficient, with the sign of the angle of attack.
    pub lift_coefficient: f64,
    /// Drag coefficient.
    pub drag_coefficient: f64,
    /// Rounds of steps 2 to 5 until nothing moved.
    pub rounds: usize,
}

/// The campaign's coefficients for one leg, and how they came about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Campaign {
    /// Whether these are the descents.
    pub descends: bool,
    /// Where it started.
    pub first_guess: Coefficients,
    /// The coefficients after each round over all glides; the last one is the result.
    pub history: Vec<Coefficients>,
    /// Whether the last round moved nothing any more.
    pub converged: bool,
    /// Glide by glide, in the last round.
    pub glides: Vec<SolvedGlide>,
    /// Glides for which the scheme has no solution: weight, pitch and sink rate do not go together.
    pub unsolved: usize,
    /// Correlation of CL with the angle of attack, that of Figure 14.
    pub lift_correlation: f64,
}

impl Campaign {
    /// The result.
    pub fn coefficients(&self) -> Coefficients {
        self.history.last().copied().unwrap_or(self.first_guess)
    }
}

/// The means of the legs, with the net weight of the parameters (the paper's: `W - B = -rho g vbd`).
pub fn mean_glides(parameters: &Parameters<f64>, observations: &[Observation]) -> Vec<MeanGlide> {
    let mut glides = Vec::new();
    for range in super::ranges(observations, |o| o.leg) {
        let steady: Vec<&Observation> = observations[range].iter().filter(|o| o.steady).collect();
        if steady.is_empty() {
            continue;
        }
        let mean =
            |value: &dyn Fn(&Observation) -> f64| steady.iter().map(|o| value(o)).sum::<f64>() / steady.len() as f64;
        let weight = |o: &Observation| {
            parameters.net_mass_kg(o.ballast_m3, &super::model::surroundings(parameters, o)) * parameters.gravity_m_s2
        };
        glides.push(MeanGlide {
            leg: steady[0].leg,
            pitch_rad: mean(&|o| o.pitch_rad),
            sink_m_s: mean(&|o| o.sink_m_s),
            net_weight_N: mean(&weight),
            density_kg_m3: mean(&|o| o.density_kg_m3),
        });
    }
    glides
}

/// Steps 1 to 9 and on, for one glide; nothing where the balance has no solution.
pub fn solve_glide(glide: &MeanGlide, frontal_area_m2: f64, first_guess: Coefficients) -> Option<SolvedGlide> {
    let t = glide.pitch_rad.abs();
    let weight = glide.net_weight_N.abs();
    let heavy = glide.net_weight_N > 0.0;
    if (glide.pitch_rad < 0.0) != heavy || (glide.sink_m_s > 0.0) != heavy {
        return None;
    }
    let mut now = first_guess;
    let mut alpha = f0(t, now)?;
    let mut rounds = 0;
    while rounds < MOST_ROUNDS {
        rounds += 1;
        let a = f1(glide.sink_m_s, weight, glide.density_kg_m3, frontal_area_m2, t, now.b, now.c, alpha);
        let b = f2(t, alpha, a, now.c);
        let c = f3(t, alpha, a, b);
        let next = Coefficients { a, b, c };
        let still = moved(now, next) < STILL;
        now = next;
        alpha = f0(t, now)?;
        if still {
            break;
        }
    }
    let gamma = t + alpha;
    let speed_m_s = glide.sink_m_s.abs() / gamma.sin();
    let side = if heavy { 1.0 } else { -1.0 };
    let force = 0.5 * glide.density_kg_m3 * speed_m_s * speed_m_s * frontal_area_m2;
    (now.a.is_finite() && now.a > 0.0).then_some(SolvedGlide {
        glide: *glide,
        coefficients: now,
        angle_of_attack_rad: side * alpha,
        glide_angle_rad: -side * gamma,
        speed_m_s,
        lift_coefficient: side * weight * gamma.cos() / force,
        drag_coefficient: weight * gamma.sin() / force,
        rounds,
    })
}

/// The scheme over all glides of one leg: every glide from the campaign's coefficients, then CL against the angle of
/// attack and CD against its square over all of them, until these stay as they are.
pub fn campaign(
    glides: &[MeanGlide],
    descends: bool,
    frontal_area_m2: f64,
    first_guess: Coefficients,
) -> Option<Campaign> {
    let of_leg: Vec<&MeanGlide> = glides.iter().filter(|glide| (glide.sink_m_s > 0.0) == descends).collect();
    let mut history: Vec<Coefficients> = Vec::new();
    let mut solved = Vec::new();
    let mut converged = false;
    let mut now = first_guess;
    while history.len() < MOST_ROUNDS {
        let round: Vec<SolvedGlide> =
            of_leg.iter().filter_map(|glide| solve_glide(glide, frontal_area_m2, now)).collect();
        let Some(next) = regress(&round) else { break };
        converged = moved(now, next) < STILL;
        (now, solved) = (next, round);
        history.push(next);
        if converged {
            break;
        }
    }
    (!solved.is_empty()).then(|| Campaign {
        descends,
        first_guess,
        history,
        converged,
        unsolved: of_leg.len() - solved.len(),
        lift_correlation: correlation(&solved),
        glides: solved,
    })
}

const MOST_ROUNDS: usize = 100;

/// Relative change of a coefficient below which a round is the last: the two digits that the paper gives.
pub const STILL: f64 = 5e-3;

fn moved(from: Coefficients, to: Coefficients) -> f64 {
    let relative = |x: f64, y: f64| (y - x).abs() / x.abs().max(1e-3);
    relative(from.a, to.a).max(relative(from.b, to.b)).max(relative(from.c, to.c))
}

/// (4): the positive root of the cubic next to that of its linear part, by Newton's method.
fn f0(t: f64, Coefficients { a, b, c }: Coefficients) -> Option<f64> {
    let tangent = t.tan();
    let (p3, p2, p1) = (c * tangent, a - c, (a + b) * tangent);
    let mut alpha = b / p1;
    for _ in 0..100 {
        let value = ((p3 * alpha + p2) * alpha + p1) * alpha - b;
        let slope = (3.0 * p3 * alpha + 2.0 * p2) * alpha + p1;
        let step = value / slope;
        alpha -= step;
        if step.abs() < 1e-15 {
            break;
        }
    }
    (alpha > 0.0 && alpha < 0.8).then_some(alpha)
}

/// (5).
#[allow(clippy::too_many_arguments, reason = "the paper's own list")]
fn f1(sink_m_s: f64, weight_N: f64, density_kg_m3: f64, area_m2: f64, t: f64, b: f64, c: f64, alpha: f64) -> f64 {
    let gamma = t + alpha;
    let resultant = weight_N * gamma.sin().powi(2) / (0.5 * density_kg_m3 * area_m2 * sink_m_s * sink_m_s);
    (resultant - (b + c * alpha * alpha) * gamma.sin()) / (alpha * gamma.cos())
}

/// (6).
fn f2(t: f64, alpha: f64, a: f64, c: f64) -> f64 {
    a * alpha * (t + alpha).tan() - c * alpha * alpha
}

/// (7).
fn f3(t: f64, alpha: f64, a: f64, b: f64) -> f64 {
    (a * alpha * (t + alpha).tan() - b) / (alpha * alpha)
}

/// CL through the origin against the angle of attack, CD against its square.
fn regress(glides: &[SolvedGlide]) -> Option<Coefficients> {
    let n = glides.len() as f64;
    if glides.len() < 3 {
        return None;
    }
    let sum = |value: &dyn Fn(&SolvedGlide) -> f64| glides.iter().map(value).sum::<f64>();
    let a = sum(&|g| g.lift_coefficient * g.angle_of_attack_rad) / sum(&|g| g.angle_of_attack_rad.powi(2));
    let mean_x = sum(&|g| g.angle_of_attack_rad.powi(2)) / n;
    let mean_y = sum(&|g| g.drag_coefficient) / n;
    let spread = sum(&|g| (g.angle_of_attack_rad.powi(2) - mean_x).powi(2));
    let c = sum(&|g| (g.angle_of_attack_rad.powi(2) - mean_x) * (g.drag_coefficient - mean_y)) / spread;
    let coefficients = Coefficients { a, b: mean_y - c * mean_x, c };
    [a, coefficients.b, c].iter().all(|v| v.is_finite()).then_some(coefficients)
}

fn correlation(glides: &[SolvedGlide]) -> f64 {
    let n = glides.len() as f64;
    let sum = |value: &dyn Fn(&SolvedGlide) -> f64| glides.iter().map(value).sum::<f64>();
    let (x, y) = (sum(&|g| g.angle_of_attack_rad) / n, sum(&|g| g.lift_coefficient) / n);
    let xy = sum(&|g| (g.angle_of_attack_rad - x) * (g.lift_coefficient - y));
    let xx = sum(&|g| (g.angle_of_attack_rad - x).powi(2));
    let yy = sum(&|g| (g.lift_coefficient - y).powi(2));
    xy / (xx * yy).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: f64 = 0.035_63;

    /// A glide that balances exactly, built from path and coefficients, not from the scheme.
    fn exact(pitch_deg: f64, weight_N: f64, k: Coefficients) -> (MeanGlide, f64) {
        let t = pitch_deg.to_radians();
        // b + c x^2 = a x tan(t + x), by bisection.
        let (mut low, mut high) = (1e-9, 0.4);
        for _ in 0..200 {
            let x = 0.5 * (low + high);
            let excess = k.a * x * f64::tan(t + x) - k.b - k.c * x * x;
            if excess < 0.0 { low = x } else { high = x }
        }
        let (alpha, gamma) = (low, t + low);
        let drag = k.b + k.c * alpha * alpha;
        let speed = (weight_N * gamma.sin() / (0.5 * 1025.0 * AREA * drag)).sqrt();
        let glide = MeanGlide {
            leg: 0,
            pitch_rad: -t,
            sink_m_s: speed * gamma.sin(),
            net_weight_N: weight_N,
            density_kg_m3: 1025.0,
        };
        (glide, alpha)
    }

    #[test]
    fn the_truth_is_a_fixed_point_up_to_the_error_of_the_cubic() {
        let truth = Coefficients { a: 4.7, b: 0.25, c: 6.2 };
        let (glide, alpha) = exact(26.0, 2.5, truth);
        let solved = solve_glide(&glide, AREA, truth).unwrap();
        assert!((solved.angle_of_attack_rad - alpha).abs() < 0.02 * alpha, "{solved:?}");
        assert!((solved.coefficients.a / truth.a - 1.0).abs() < 0.06, "{solved:?}");
    }

    #[test]
    fn c_never_leaves_its_first_value_and_the_result_depends_on_the_first_guess() {
        let truth = Coefficients { a: 21.0, b: 0.42, c: 8.0 };
        let (glide, _) = exact(26.0, 2.5, truth);
        let from = |a: f64, c: f64| solve_glide(&glide, AREA, Coefficients { a, b: 0.25, c }).unwrap();
        let (one, other) = (from(4.7, 6.2), from(20.0, 6.2));
        for solved in [one, other] {
            assert!((solved.coefficients.c - 6.2).abs() < 1e-6, "{solved:?}");
            // Whatever the first guess, the data are met exactly.
            let gamma = solved.glide_angle_rad.abs();
            assert!((solved.speed_m_s * gamma.sin() - glide.sink_m_s).abs() < 1e-12);
        }
        assert!(one.coefficients.a < 0.6 * other.coefficients.a, "{one:?} {other:?}");
    }

    #[test]
    fn ascents_are_descents_upside_down() {
        let truth = Coefficients { a: 4.0, b: 0.19, c: 6.5 };
        let (down, _) = exact(24.0, 2.0, truth);
        let up = MeanGlide { pitch_rad: -down.pitch_rad, sink_m_s: -down.sink_m_s, net_weight_N: -2.0, ..down };
        let (a, b) = (solve_glide(&down, AREA, truth).unwrap(), solve_glide(&up, AREA, truth).unwrap());
        assert_eq!(a.coefficients, b.coefficients);
        assert_eq!(a.angle_of_attack_rad, -b.angle_of_attack_rad);
        assert_eq!(a.glide_angle_rad, -b.glide_angle_rad);
    }

    #[test]
    fn weight_and_pitch_that_contradict_each_other_have_no_solution() {
        let truth = Coefficients { a: 4.0, b: 0.19, c: 6.5 };
        let (glide, _) = exact(24.0, 2.0, truth);
        assert!(solve_glide(&MeanGlide { net_weight_N: -2.0, ..glide }, AREA, truth).is_none());
    }
}
