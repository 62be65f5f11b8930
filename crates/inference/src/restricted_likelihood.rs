//! The noise of greatest restricted likelihood (Patterson and Thompson 1971): what is explained is projected out, so that it does not
//! count as noise. A process is taken where it raises the logarithm of that likelihood by more than its two numbers cost (Akaike 1974).
//!
//! Knows rows of one quantity; not what explains them.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::noise::{Lasting, Noise, Series, Slow, orthonormal, whiten};
use super::order::median;

/// How much of a row's own error a joined neighbour has that is tried: none, and what makes neighbours go against each other by 0.4
/// and, of a difference of positions alone, by a half.
const DIFFERENCED: [f64; 3] = [0.0, 0.5, 0.95];

/// Shares of a slow part in the variance that are tried first.
const SHARES: [f64; 5] = [0.05, 0.2, 0.5, 0.8, 0.96];

/// Shares of the process of hours that are tried first.
const SLOW_SHARES: [f64; 2] = [0.1, 0.35];

/// Correlation times that are tried first, in units of the median step between rows.
const TIMES_IN_STEPS: [f64; 5] = [1.0, 4.0, 16.0, 64.0, 256.0];

/// Shortest correlation time, in the same unit.
const SHORTEST_TIME_IN_STEPS: f64 = 0.5;

/// Longest correlation time, as a share of the whole record: what lasts longer is a level.
const LONGEST_SHARE: f64 = 0.1;

/// Largest variance of the noise, relative to that of the residuals once everything explained is set aside. Beyond it a
/// slow process would stand for a level that no row shows, and hide every effect that is a level.
const MAX_VARIANCE_RATIO: f64 = 1.5;

/// A shape of noise: how it is differenced, logits of the slow parts' shares, logarithms of their times in steps. Unit total variance.
#[derive(Debug, Clone, Copy)]
struct Shape {
    differenced: f64,
    shares: [f64; 2],
    log_times: [f64; 2],
}

impl Shape {
    fn noise(&self, stated: f64, step_s: f64) -> Noise {
        let slow =
            |k: usize| Slow { variance: self.shares[k] * stated, correlation_time_s: self.log_times[k].exp() * step_s };
        Noise { white: 1.0 - self.shares[0] - self.shares[1], differenced: self.differenced, slow: [slow(0), slow(1)] }
    }
}

/// The noise of greatest restricted likelihood. `residual` is what the present model leaves, `explained` the
/// sensitivities to everything that could explain it. `stated_known_to` is the standard deviation of the logarithm of the
/// stated variance as the least that the white part has; infinite where the rows alone say it.
pub fn estimate(
    series: Series<'_>,
    lasting: Lasting,
    stated_known_to: f64,
    residual: &DVector<f64>,
    explained: &DMatrix<f64>,
) -> Noise {
    RestrictedLikelihood::new(series, stated_known_to, residual, explained).most_likely(lasting)
}

/// The restricted likelihood of the noise of some rows, what is explained projected out.
#[derive(Debug, Clone)]
pub struct RestrictedLikelihood<'a> {
    series: Series<'a>,
    stated_known_to: f64,
    /// Directions of what is explained, the residual behind them.
    columns: DMatrix<f64>,
}

/// A shape with the logarithm of its likelihood and its scale.
#[derive(Debug, Clone, Copy)]
struct Found {
    likelihood: f64,
    scale: f64,
    shape: Shape,
}

impl<'a> RestrictedLikelihood<'a> {
    /// That of these residuals; parameters as those of [`estimate`].
    pub fn new(
        series: Series<'a>,
        stated_known_to: f64,
        residual: &DVector<f64>,
        explained: &DMatrix<f64>,
    ) -> RestrictedLikelihood<'a> {
        RestrictedLikelihood { series, stated_known_to, columns: stacked(explained, residual) }
    }

    /// The noise at which it is greatest.
    pub fn most_likely(&self, lasting: Lasting) -> Noise {
        let tried = if self.series.joined_s > 0.0 { &DIFFERENCED[..] } else { &DIFFERENCED[..1] };
        self.most_likely_of(lasting, tried)
    }

    /// The same of those in which joined neighbours err as in this noise: that is the instrument's, and known by many rows.
    pub fn most_likely_joined_as(&self, lasting: Lasting, noise: &Noise) -> Noise {
        self.most_likely_of(lasting, &[noise.differenced])
    }

    fn most_likely_of(&self, lasting: Lasting, differenced: &[f64]) -> Noise {
        let time_s = self.series.time_s;
        let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let step_s = if steps.is_empty() { 1.0 } else { median(&mut steps) };
        let stated_sd = self.series.stated_sd;
        let stated = stated_sd.iter().map(|sd| sd * sd).sum::<f64>() / stated_sd.len().max(1) as f64;

        let at = |shape: &Shape| self.profile(shape, &shape.noise(stated, step_s));
        let white = Shape { differenced: 0.0, shares: [0.0; 2], log_times: [0.0; 2] };
        let Some(Found { scale: most, .. }) = at(&white) else {
            return white.noise(stated, step_s);
        };
        let most = MAX_VARIANCE_RATIO * most;
        let span_s = time_s.last().copied().unwrap_or(0.0) - time_s.first().copied().unwrap_or(0.0);
        let longest = (span_s / step_s * LONGEST_SHARE).clamp(SHORTEST_TIME_IN_STEPS, TIMES_IN_STEPS[4]);
        let try_one = |shape: &Shape| {
            let is_short = shape.log_times.iter().all(|time| *time <= longest.ln() + 1e-9);
            if is_short { at(shape).filter(|found| found.scale <= most) } else { None }
        };
        let mut best: Option<Found> = None;
        for differenced in differenced {
            let without = try_one(&Shape { differenced: *differenced, ..white });
            let Some(found) = without.map(|without| with_processes(without, lasting, &try_one)) else { continue };
            // One number more is to raise the logarithm of the likelihood by more than it costs.
            if best.is_none_or(|best| found.likelihood > best.likelihood + 1.0) {
                best = Some(found);
            }
        }
        let Found { scale, shape, .. } = best.unwrap_or(Found { likelihood: 0.0, scale: 1.0, shape: white });
        let mut noise = shape.noise(stated, step_s);
        noise.white *= scale;
        noise.slow.iter_mut().for_each(|slow| slow.variance *= scale);
        noise
    }

    /// The logarithm of the likelihood of a shape with its best scale; none where the rows are too few.
    fn profile(&self, shape: &Shape, noise: &Noise) -> Option<Found> {
        let Whitened { squares, free, log_determinant } = self.whitened(noise)?;
        let scale = most_likely_scale(squares, free, noise.white, self.stated_known_to);
        let likelihood =
            -0.5 * (free * scale.ln() + squares / scale + log_determinant + self.below_stated(scale * noise.white));
        likelihood.is_finite().then_some(Found { likelihood, scale, shape: *shape })
    }

    /// The logarithm of the likelihood of a noise, up to a constant; none where the rows are too few.
    pub fn log_likelihood(&self, noise: &Noise) -> Option<f64> {
        let Whitened { squares, log_determinant, .. } = self.whitened(noise)?;
        Some(-0.5 * (squares + log_determinant + self.below_stated(noise.white)))
    }

    fn whitened(&self, noise: &Noise) -> Option<Whitened> {
        let (n, k) = (self.columns.nrows(), self.columns.ncols() - 1);
        let mut columns = self.columns.clone();
        let of_rows = whiten(self.series, noise, &mut columns);
        let products = columns.transpose() * &columns;
        let cholesky = products.view((0, 0), (k, k)).into_owned().cholesky()?;
        let moments = products.view((0, k), (k, 1)).into_owned();
        let of_columns = 2.0 * cholesky.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>();
        Some(Whitened {
            squares: products[(k, k)] - moments.dot(&cholesky.solve(&moments)),
            free: n.checked_sub(k).filter(|free| *free > 0)? as f64,
            log_determinant: of_rows + of_columns,
        })
    }

    /// Minus twice the logarithm of the prior of a white part that is smaller than stated.
    fn below_stated(&self, white: f64) -> f64 {
        (white.ln().min(0.0) / self.stated_known_to).powi(2)
    }
}

/// What rows say of a noise.
struct Whitened {
    /// What is left of the residual.
    squares: f64,
    /// Rows less what is explained.
    free: f64,
    /// Logarithms of the determinants of the covariance and of the explained columns' products: what is explained has a scale of its
    /// own, not the noise's.
    log_determinant: f64,
}

/// The most likely shape with as many slow processes as are worth their numbers.
fn with_processes(mut without: Found, lasting: Lasting, try_one: &(impl Fn(&Shape) -> Option<Found> + Sync)) -> Found {
    for process in 0..lasting as usize {
        let mut found = with_process(without, process, try_one);
        refine(&mut found, process + 1, try_one);
        if found.likelihood < without.likelihood + 2.0 {
            break;
        }
        without = found;
    }
    without
}

/// The most likely shape with one slow process more, on a grid; the one without where it is none of them.
fn with_process(without: Found, process: usize, try_one: &(impl Fn(&Shape) -> Option<Found> + Sync)) -> Found {
    let free = 1.0 - without.shape.shares[0];
    // The second process is slow, and a small part of what the first one left.
    let (shares, times): (&[f64], &[f64]) =
        if process == 0 { (&SHARES, &TIMES_IN_STEPS) } else { (&SLOW_SHARES, &TIMES_IN_STEPS[2..]) };
    let shape_of = |share: f64, time: f64| {
        let mut shape = without.shape;
        (shape.shares[process], shape.log_times[process]) = (share * free, time.ln());
        shape
    };
    let shapes: Vec<Shape> = shares.iter().flat_map(|share| times.iter().map(|time| shape_of(*share, *time))).collect();
    let tried: Vec<Option<Found>> = shapes.par_iter().map(try_one).collect();
    let better = |best: Found, other: Found| if other.likelihood > best.likelihood { other } else { best };
    tried.into_iter().flatten().fold(without, better)
}

/// Climbs from a shape: each number up or down by a step that shrinks.
fn refine(found: &mut Found, processes: usize, at: &impl Fn(&Shape) -> Option<Found>) {
    for step in [0.6, 0.2] {
        let mut moved = true;
        for _ in 0..3 {
            if !std::mem::take(&mut moved) {
                break;
            }
            for number in 0..2 * processes {
                for sign in [-1.0, 1.0] {
                    let mut shape = found.shape;
                    let k = number / 2;
                    if number % 2 == 0 {
                        let free = 1.0 - shape.shares[1 - k];
                        let share = (shape.shares[k] / free).clamp(1e-4, 1.0 - 1e-4);
                        let logit = (share / (1.0 - share)).ln() + 2.0 * sign * step;
                        shape.shares[k] = free / (1.0 + (-logit).exp());
                    } else {
                        let time = shape.log_times[k] + 2.0 * sign * step;
                        shape.log_times[k] = time.max(SHORTEST_TIME_IN_STEPS.ln());
                    }
                    if let Some(better) = at(&shape).filter(|other| other.likelihood > found.likelihood + 1e-3) {
                        *found = better;
                        moved = true;
                    }
                }
            }
        }
    }
}

/// The directions of the explained columns, each once and of unit size, with the residual behind them. Sensitivities
/// come in all units, and many are nearly alike: the restricted likelihood only asks for the space that they span.
fn stacked(explained: &DMatrix<f64>, residual: &DVector<f64>) -> DMatrix<f64> {
    let basis = orthonormal(explained.clone());
    let k = basis.ncols();
    let mut columns = basis.insert_column(k, 0.0);
    columns.column_mut(k).copy_from(residual);
    columns
}

/// The scale of greatest likelihood of a sum of squares with `free` degrees of freedom, beside the belief that the white
/// part, `white` of the scale, is no smaller than stated. A few rows can leave next to nothing by chance; a stated variance
/// that comes from within each row has degrees of freedom of its own.
fn most_likely_scale(squares: f64, free: f64, white: f64, stated_known_to: f64) -> f64 {
    let by_rows = (squares / free).max(f64::MIN_POSITIVE);
    let start = (by_rows * white).ln();
    if start >= 0.0 || !start.is_finite() || stated_known_to.is_infinite() {
        return by_rows;
    }
    // With u = ln(scale white) the slope (squares white e^-u - free)/2 - u/sd^2 falls and is convex: Newton's steps from the
    // left of its zero stay there.
    let precision = stated_known_to.powi(-2);
    let mut u = start;
    for _ in 0..50 {
        let of_rows = 0.5 * squares.max(f64::MIN_POSITIVE) * white * (-u).exp();
        let step = (of_rows - 0.5 * free - precision * u) / (of_rows + precision);
        u += step;
        if step.abs() < 1e-9 {
            break;
        }
    }
    u.exp() / white
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::tests::{sample, slow};

    #[test]
    fn the_noise_that_made_the_data_is_found_again() {
        let truth = Noise { white: 1.0, differenced: 0.0, slow: [slow(3.6e-5, 600.0), slow(0.0, 1.0)] };
        let (mut sds, mut times) = (0.0, 0.0);
        for seed in 0..20 {
            let (time_s, stated_sd, residual) = sample(700, &truth, seed);
            let trend = DMatrix::from_fn(700, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
            let found = estimate(
                Series { time_s: &time_s, stated_sd: &stated_sd, place: &[], joined_s: 0.0 },
                Lasting::MinutesAndHours,
                f64::INFINITY,
                &residual,
                &trend,
            );
            sds += found.sd(0.003) / 20.0;
            times += found.slow[0].correlation_time_s.ln() / 20.0;
        }
        assert!((sds / truth.sd(0.003) - 1.0).abs() < 0.1, "sd {sds}");
        assert!((times - 600f64.ln()).abs() < 0.5, "correlation time {}", times.exp());
    }

    #[test]
    fn few_rows_do_not_make_a_noise_far_below_the_stated_one_and_many_do() {
        let scale = |squares: f64, free: f64| most_likely_scale(squares, free, 1.0, 0.5);
        // Where the slope is nought, by hand: squares/u = free + 8 ln u.
        for (squares, free) in [(0.04, 4.0), (0.5, 10.0), (30.0, 300.0)] {
            let found = scale(squares, free);
            assert!((squares / found - free - 8.0 * found.ln()).abs() < 1e-6, "{squares} {free}: {found}");
        }
        assert!(scale(0.04, 4.0) > 0.5);
        assert!(scale(30.0, 300.0) < 0.12);
        // A noise that was stated too small is judged by the rows alone, and so is one that nobody vouches for.
        assert_eq!(scale(8.0, 4.0), 2.0);
        assert_eq!(most_likely_scale(0.04, 4.0, 1.0, f64::INFINITY), 0.01);
    }
}
