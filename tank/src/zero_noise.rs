//! How far a balance's zeros err beyond what their own records show: they repeat to a certain degree only, and walk.
//!
//! Two components of variance per channel, estimated over the whole campaign from how far every zero lies off the straight
//! line between its neighbours. A level and an even drift leave these contrasts alone, so that their likelihood is a
//! restricted one (Patterson and Thompson 1971, Biometrika 58, 545-554). Few zeros know their components poorly: each
//! standard deviation is its posterior mean under a half-Cauchy prior at the scale of the record's own error (Gelman
//! 2006, Bayesian Analysis 1, 515-533), which leaves out what is not there and does not say zero where nobody knows.
//! Knows numbers at times; no balance.

use glidepolar_inference::order::median;
use nalgebra::{DMatrix, DVector};

/// What is left between zeros.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Components {
    /// Variance of each zero of its own.
    pub repeat: f64,
    /// Variance that a random walk gains per unit of time.
    pub walk: f64,
}

/// Zeros in one stretch: time and reading, in order.
pub type Stretch = Vec<(f64, f64)>;

/// Fewest contrasts from which components are estimated.
const FEWEST: usize = 2;
/// Contrasts that are taken together; a longer stretch is cut.
const TOGETHER: usize = 40;
/// Variances that are tried, in units of the record's own: none, and from the least to a thousand, even in the logarithm. Steps
/// of a half decade are wider than what a day's zeros know: what the nearest one lacks would go to the other component.
const LEAST_VARIANCE: f64 = 0.03;
const STEPS: i32 = 18;
const STEPS_PER_DECADE: f64 = 4.0;

/// Time constants of a settling zero that are tried, in units of time.
const SETTLING: [f64; 3] = [0.4 * 3600.0, 0.7 * 3600.0, 1.5 * 3600.0];
/// A settling this many standard errors large is no walk.
const CLEARLY: f64 = 4.0;

/// Takes a settling after switching on, alike on every day, out of the readings where the zeros clearly show one: it is a fault
/// with a name, and no scatter of the zeros. `since` are the times since each day's begin.
pub fn without_settling(stretches: &mut [Stretch], since: &[Vec<f64>]) {
    let of = |time_constant: f64| {
        let (mut pairs, mut xx, mut xy) = (Vec::new(), 0.0, 0.0);
        for (stretch, since) in stretches.iter().zip(since) {
            let traces: Vec<(f64, f64)> =
                stretch.iter().zip(since).map(|((when, _), since)| (*when, (-since / time_constant).exp())).collect();
            let (Some(reading), Some(trace)) = (Contrasts::new(stretch), Contrasts::new(&traces)) else { continue };
            for (y, x) in reading.observed.iter().zip(trace.observed.iter()) {
                pairs.push((*x, *y));
                (xx, xy) = (xx + x * x, xy + x * y);
            }
        }
        let size = xy / xx;
        let left: f64 = pairs.iter().map(|(x, y)| (y - size * x).powi(2)).sum();
        let dof = pairs.len().checked_sub(2).filter(|dof| *dof > 0)?;
        (xx > 0.0).then(|| (left, size, size.abs() * (xx * dof as f64 / left.max(f64::MIN_POSITIVE)).sqrt()))
    };
    let tried = SETTLING.iter().filter_map(|time_constant| Some((*time_constant, of(*time_constant)?)));
    let Some((time_constant, (_, size, t))) = tried.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { return };
    if t > CLEARLY {
        for (stretch, since) in stretches.iter_mut().zip(since) {
            stretch
                .iter_mut()
                .zip(since)
                .for_each(|((_, value), since)| *value -= size * (-since / time_constant).exp());
        }
    }
}

/// The components; `within` is the variance of a zero from within its own record.
pub fn components(stretches: &[Stretch], within: f64) -> Components {
    let cut: Vec<Contrasts> =
        stretches.iter().flat_map(|stretch| stretch.chunks(TOGETHER)).filter_map(Contrasts::new).collect();
    let count: usize = cut.iter().map(|contrasts| contrasts.observed.len()).sum();
    if count < FEWEST || within <= 0.0 {
        return Components::default();
    }
    // The unit of the walk is what it gains over the median distance of two zeros.
    let mut gaps: Vec<f64> = stretches.iter().flat_map(|s| s.windows(2).map(|pair| pair[1].0 - pair[0].0)).collect();
    let gap = median(&mut gaps).max(f64::MIN_POSITIVE);
    let variances: Vec<f64> = std::iter::once(0.0)
        .chain((0..=STEPS).map(|step| LEAST_VARIANCE * 10f64.powf(f64::from(step) / STEPS_PER_DECADE)))
        .collect();
    let mut found = Vec::new();
    for &repeat in &variances {
        for &walk in &variances {
            let likelihood: f64 = cut
                .iter()
                .map(|contrasts| contrasts.log_likelihood(within, repeat * within, walk * within / gap))
                .sum();
            found.push((likelihood + prior(repeat).ln() + prior(walk).ln(), repeat, walk));
        }
    }
    let most = found.iter().map(|one| one.0).fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut repeat_sd, mut walk_sd) = (0.0, 0.0, 0.0);
    for (log, repeat, walk) in found {
        let weight = (log - most).exp();
        sum += weight;
        repeat_sd += weight * repeat.sqrt();
        walk_sd += weight * walk.sqrt();
    }
    let variance = |sd: f64| (sd / sum).powi(2) * within;
    Components { repeat: variance(repeat_sd), walk: variance(walk_sd) / gap }
}

/// Half-Cauchy in the standard deviation, per step of the logarithm; none has all that lies below the first step.
fn prior(variance: f64) -> f64 {
    if variance == 0.0 {
        let step = 0.5 * std::f64::consts::LN_10 / STEPS_PER_DECADE;
        return (LEAST_VARIANCE.sqrt() * (-0.5 * step).exp()).atan() / step;
    }
    variance.sqrt() / (1.0 + variance)
}

/// How far zeros lie off the line between their neighbours.
struct Contrasts {
    observed: DVector<f64>,
    /// Contrasts by zeros.
    weights: DMatrix<f64>,
    /// Covariance of a random walk of unit rate at the zeros.
    walk: DMatrix<f64>,
}

impl Contrasts {
    fn new(zeros: &[(f64, f64)]) -> Option<Contrasts> {
        let n = zeros.len();
        if n < 3 {
            return None;
        }
        let mut weights = DMatrix::zeros(n - 2, n);
        for k in 0..n - 2 {
            let share = (zeros[k + 1].0 - zeros[k].0) / (zeros[k + 2].0 - zeros[k].0).max(f64::MIN_POSITIVE);
            (weights[(k, k)], weights[(k, k + 1)], weights[(k, k + 2)]) = (share - 1.0, 1.0, -share);
        }
        let values = DVector::from_iterator(n, zeros.iter().map(|(_, value)| *value));
        let walk = DMatrix::from_fn(n, n, |i, j| zeros[i.min(j)].0 - zeros[0].0);
        Some(Contrasts { observed: &weights * values, walk: &weights * walk * weights.transpose(), weights })
    }

    fn log_likelihood(&self, within: f64, repeat: f64, walk: f64) -> f64 {
        let covariance = &self.weights * self.weights.transpose() * (within + repeat) + &self.walk * walk;
        let Some(root) = covariance.cholesky() else { return f64::NEG_INFINITY };
        let log_determinant = 2.0 * root.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>();
        -0.5 * (log_determinant + self.observed.dot(&root.solve(&self.observed)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    fn zeros(n: usize, within: f64, repeat: f64, walk: f64, seed: u64) -> Stretch {
        let mut rng = StdRng::seed_from_u64(seed);
        let mut at = 5.0;
        (0..n)
            .map(|i| {
                at += 0.1 + walk.sqrt() * rng.sample::<f64, _>(StandardNormal);
                (i as f64, at + (within + repeat).sqrt() * rng.sample::<f64, _>(StandardNormal))
            })
            .collect()
    }

    #[test]
    fn zeros_that_err_by_their_records_alone_have_next_to_no_more() {
        let mean = (0..40)
            .map(|seed| components(&[zeros(20, 1.0, 0.0, 0.0, seed)], 1.0))
            .fold((0.0, 0.0), |sum, c| (sum.0 + c.repeat / 40.0, sum.1 + c.walk / 40.0));
        assert!(mean.0 < 0.25 && mean.1 < 0.15, "{mean:?}");
        assert_eq!(components(&[zeros(3, 1.0, 0.0, 0.0, 1)], 1.0), Components::default());
    }

    fn mean(stretches: u64, repeat: f64, walk: f64) -> (f64, f64) {
        let campaign = |seed: u64| -> Vec<Stretch> {
            (0..stretches).map(|stretch| zeros(30, 1.0, repeat, walk, 1000 * stretch + seed)).collect()
        };
        (0..40)
            .map(|seed| components(&campaign(seed), 1.0))
            .fold((0.0, 0.0), |sum, c| (sum.0 + c.repeat / 40.0, sum.1 + c.walk / 40.0))
    }

    /// Standard deviations that no unbiased estimate goes below: the inverse of Fisher's information of the contrasts.
    fn least_sd(stretches: f64, repeat: f64, walk: f64) -> (f64, f64) {
        let contrasts = Contrasts::new(&zeros(30, 1.0, repeat, walk, 0)).unwrap();
        let white = &contrasts.weights * contrasts.weights.transpose();
        let inverse = (&white * (1.0 + repeat) + &contrasts.walk * walk).try_inverse().unwrap();
        let (by_repeat, by_walk) = (&inverse * &white, &inverse * &contrasts.walk);
        let information = |a: &DMatrix<f64>, b: &DMatrix<f64>| 0.5 * stretches * (a * b).trace();
        let (rr, ww) = (information(&by_repeat, &by_repeat), information(&by_walk, &by_walk));
        let rw = information(&by_repeat, &by_walk);
        let determinant = rr * ww - rw * rw;
        ((ww / determinant).sqrt(), (rr / determinant).sqrt())
    }

    #[test]
    fn repeats_and_walks_are_found_apart() {
        for (repeat, walk) in [(9.0, 0.0), (0.0, 4.0)] {
            let found = mean(4, repeat, walk);
            let is_near = |found: f64, truth: f64| (found - truth).abs() < 0.4 * truth + 0.1 * (repeat + walk);
            assert!(is_near(found.0, repeat) && is_near(found.1, walk), "{repeat} {walk}: {found:?}");
        }
    }

    /// A variance is never negative: of a component that is absent even the best estimate has the mean of a normal error that
    /// is cut off at zero, 0.4 times its least standard deviation. One stretch of zeros does not do worse by more than half.
    #[test]
    fn of_an_absent_component_one_stretch_finds_what_its_information_allows() {
        for (repeat, walk) in [(4.0, 0.0), (9.0, 0.0), (0.0, 2.0), (0.0, 4.0)] {
            let (found, least) = (mean(1, repeat, walk), least_sd(1.0, repeat, walk));
            let (found, least) = if repeat == 0.0 { (found.0, least.0) } else { (found.1, least.1) };
            // The prior reaches as far as the record's own error, whatever the other component.
            let allowed = 1.5 * 0.4 * least.hypot(1.0);
            assert!(found < allowed, "{repeat} {walk}: {found} where {allowed} is allowed");
        }
    }
}
