//! What is left when the model is right: measurement noise, and water that moves.
//!
//! Each quantity's residuals are taken as white noise plus an Ornstein-Uhlenbeck process that lasts for minutes, plus, where
//! it shows, one that lasts for hours:
//!
//! ```text
//! cov(i, j) = white s_i s_j c(i - j) + red exp(-|t_i - t_j|/tau) + slow exp(-|t_i - t_j|/T) sum_k f_k(z_i) f_k(z_j) / K
//! ```
//!
//! `c` is 1 at 0. A velocity that is the difference of two positions shares each of them with a neighbour: where rows are so joined, `c` is
//! `-d/(1 + d^2)` at 1, a moving average `v_i - d v_(i-1)`; left out, it hides as much of what lasts for minutes.
//!
//! Internal waves of hours keep their shape over depth while they last: what a glider meets at one depth it meets there
//! again on the next leg. So the slow process comes in the first modes of the place `z` (0 to 1 along the water column),
//! `f = 1, sqrt 2 cos pi z, sqrt 2 cos 2 pi z`; where no place is known only `f = 1` is left. All processes are Markov, so a
//! Kalman filter turns residuals and sensitivities into independent numbers of unit variance in one pass over the rows.
//! The numbers are those of greatest restricted likelihood (Patterson and Thompson 1971), with every candidate's
//! sensitivities projected out, so that an effect yet unexplained does not count as noise. A process is taken where it
//! raises the logarithm of that likelihood by more than its two numbers cost (Akaike 1974).
//!
//! Knows rows of one quantity in the order of time; neither tank nor sea.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::order::median;

/// A slow part of a noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slow {
    /// Its variance, in the square of the quantity's unit.
    pub variance: f64,
    /// Its correlation time \[s\].
    pub correlation_time_s: f64,
}

/// Noise of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Factor on the stated variance of the measurement.
    pub white: f64,
    /// How much of a row's own error its joined neighbour has with the other sign, 0 to 1.
    pub differenced: f64,
    /// What lasts for minutes, and what lasts for hours and comes in modes of the place. One that is not there has no
    /// variance.
    pub slow: [Slow; 2],
}

/// As the measurement states, and nothing slow.
pub const WHITE: Noise =
    Noise { white: 1.0, differenced: 0.0, slow: [Slow { variance: 0.0, correlation_time_s: 1.0 }; 2] };

impl Noise {
    /// Standard deviation of one row whose measurement has the stated standard deviation.
    pub fn sd(&self, stated_sd: f64) -> f64 {
        (self.white * stated_sd * stated_sd + self.slow[0].variance + self.slow[1].variance).sqrt()
    }
}

/// The longest correlation time of the noises, s; 0 where all are white.
pub fn longest_correlation_s(noises: &[Noise]) -> f64 {
    let slow = noises.iter().flat_map(|noise| &noise.slow).filter(|slow| slow.variance > 0.0);
    slow.map(|slow| slow.correlation_time_s).fold(0.0, f64::max)
}

/// The rows of one quantity in the order of time.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Time of each row \[s\], not decreasing.
    pub time_s: &'a [f64],
    /// Stated standard deviation of each row's measurement.
    pub stated_sd: &'a [f64],
    /// Place of each row along the water column, 0 to 1; empty where there is none.
    pub place: &'a [f64],
    /// Rows no farther apart than this are joined: they share a reading of which each is a difference \[s\]; 0 where none are.
    pub joined_s: f64,
}

/// Makes every column independent and of unit variance, in place; returns the logarithm of the determinant of the
/// covariance. Columns are the residuals and the sensitivities, rows as in the series.
pub fn whiten(series: Series<'_>, noise: &Noise, columns: &mut DMatrix<f64>) -> f64 {
    // The fewer states the filter has, the quicker it is.
    let is_joined = noise.differenced > 0.0 && series.joined_s > 0.0;
    match (noise.slow[1].variance > 0.0, series.place.is_empty(), is_joined) {
        (false, _, false) => whiten_by::<1, false>(series, noise, columns),
        (true, true, false) => whiten_by::<2, false>(series, noise, columns),
        (true, false, false) => whiten_by::<{ 1 + MODES }, false>(series, noise, columns),
        (false, _, true) => whiten_by::<2, true>(series, noise, columns),
        (true, true, true) => whiten_by::<3, true>(series, noise, columns),
        (true, false, true) => whiten_by::<{ 2 + MODES }, true>(series, noise, columns),
    }
}

/// Modes of the place.
const MODES: usize = 3;

/// How many columns are filtered abreast.
const ABREAST: usize = 8;

/// What the filter does in one row, whatever the data.
struct Step<const N: usize> {
    kept: [f64; N],
    /// How much of each state shows in the row.
    shown: [f64; N],
    gain: [f64; N],
    scale: f64,
}

/// With `JOINED` the last of the states is the error of the row before.
fn whiten_by<const N: usize, const JOINED: bool>(series: Series<'_>, noise: &Noise, columns: &mut DMatrix<f64>) -> f64 {
    let (steps, log_determinant) = filter::<N, JOINED>(series, noise);
    let n = steps.len();
    // Several columns abreast: each alone would wait for its own last row.
    columns.as_mut_slice().par_chunks_mut(ABREAST * n.max(1)).for_each(|abreast| {
        let mut means = [[0.0; N]; ABREAST];
        for (row, step) in steps.iter().enumerate() {
            for (value, mean) in abreast[row..].iter_mut().step_by(n).zip(&mut means) {
                let mut innovation = *value;
                for (mean, (kept, shown)) in mean.iter_mut().zip(step.kept.iter().zip(&step.shown)) {
                    *mean *= kept;
                    innovation -= shown * *mean;
                }
                if JOINED {
                    mean[N - 1] = 0.0;
                }
                for (mean, gain) in mean.iter_mut().zip(&step.gain) {
                    *mean += gain * innovation;
                }
                *value = innovation * step.scale;
            }
        }
    });
    log_determinant
}

fn filter<const N: usize, const JOINED: bool>(series: Series<'_>, noise: &Noise) -> (Vec<Step<N>>, f64) {
    let processes = N - usize::from(JOINED);
    let of = |k: usize| noise.slow[usize::from(k > 0)];
    // The error of a row before which there is none is as uncertain as any.
    let variances: [f64; N] = std::array::from_fn(|k| match k {
        _ if k == processes => noise.white,
        0 => of(k).variance,
        _ => of(k).variance / (processes - 1) as f64,
    });
    // A row's error is its own less `differenced` times that of the row before, at the stated variance.
    let of_own = if JOINED { 1.0 / 1.0f64.hypot(noise.differenced) } else { 1.0 };
    let mut p = [[0.0; N]; N];
    for k in 0..N {
        p[k][k] = variances[k];
    }
    let mut log_determinant = 0.0;
    let steps = (0..series.time_s.len())
        .map(|row| {
            let step_s = if row > 0 { series.time_s[row] - series.time_s[row - 1] } else { f64::INFINITY };
            let stated = series.stated_sd[row];
            let kept: [f64; N] = std::array::from_fn(|k| match k {
                _ if k == processes => f64::from(u8::from(step_s <= series.joined_s)),
                _ => (-step_s / of(k).correlation_time_s).exp(),
            });
            let shown: [f64; N] = std::array::from_fn(|k| match k {
                _ if k == processes => -noise.differenced * of_own * stated,
                0 | 1 => 1.0,
                _ => std::f64::consts::SQRT_2 * (std::f64::consts::PI * (k - 1) as f64 * series.place[row]).cos(),
            });
            for i in 0..N {
                for j in 0..N {
                    let fresh = if i == j { variances[i] * (1.0 - kept[i] * kept[i]) } else { 0.0 };
                    p[i][j] = kept[i] * kept[j] * p[i][j] + fresh;
                }
            }
            let projected: [f64; N] = std::array::from_fn(|i| (0..N).map(|j| p[i][j] * shown[j]).sum());
            let own = of_own * stated;
            let innovation = (0..N).map(|i| shown[i] * projected[i]).sum::<f64>() + noise.white * own * own;
            let mut gain: [f64; N] = projected.map(|value| value / innovation);
            if JOINED {
                // From here on the last state is the error of this row, which nothing but this row shows.
                p[processes] = [0.0; N];
                p.iter_mut().for_each(|row| row[processes] = 0.0);
                p[processes][processes] = noise.white;
                gain[processes] = noise.white * own / innovation;
            }
            for i in 0..N {
                for j in 0..N {
                    p[i][j] -= gain[i] * gain[j] * innovation;
                }
            }
            log_determinant += innovation.ln();
            Step { kept, shown, gain, scale: innovation.sqrt().recip() }
        })
        .collect();
    (steps, log_determinant)
}

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

/// Which slow processes a noise may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lasting {
    /// None: every row errs by itself.
    White,
    /// What lasts for minutes.
    Minutes,
    /// That, and what lasts for hours.
    MinutesAndHours,
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
    let n = residual.len();
    let mut steps: Vec<f64> =
        series.time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let step_s = if steps.is_empty() { 1.0 } else { median(&mut steps) };
    let stated = series.stated_sd.iter().map(|sd| sd * sd).sum::<f64>() / n.max(1) as f64;
    let columns = stacked(explained, residual);

    let at = |shape: &Shape| profile(series, &shape.noise(stated, step_s), stated_known_to, &columns);
    let white = Shape { differenced: 0.0, shares: [0.0; 2], log_times: [0.0; 2] };
    let Some((_, most)) = at(&white) else {
        return white.noise(stated, step_s);
    };
    let most = MAX_VARIANCE_RATIO * most;
    let span_s = series.time_s.last().copied().unwrap_or(0.0) - series.time_s.first().copied().unwrap_or(0.0);
    let longest = (span_s / step_s * LONGEST_SHARE).clamp(SHORTEST_TIME_IN_STEPS, TIMES_IN_STEPS[4]);
    let try_one = |shape: &Shape| {
        let is_short = shape.log_times.iter().all(|time| *time <= longest.ln() + 1e-9);
        if is_short { at(shape).filter(|(_, scale)| *scale <= most) } else { None }
    };
    let tried = if series.joined_s > 0.0 { &DIFFERENCED[..] } else { &DIFFERENCED[..1] };
    let mut best: Option<(f64, f64, Shape)> = None;
    for differenced in tried {
        let Some(found) = most_likely(Shape { differenced: *differenced, ..white }, lasting, &try_one) else {
            continue;
        };
        // One number more is to raise the logarithm of the likelihood by more than it costs.
        if best.is_none_or(|(likelihood, ..)| found.0 > likelihood + 1.0) {
            best = Some(found);
        }
    }
    let (_, scale, best) = best.unwrap_or((0.0, 1.0, white));
    let mut noise = best.noise(stated, step_s);
    noise.white *= scale;
    noise.slow.iter_mut().for_each(|slow| slow.variance *= scale);
    noise
}

/// The most likely shape with slow processes beside this one, with its likelihood and scale.
fn most_likely(
    white: Shape,
    lasting: Lasting,
    try_one: &(impl Fn(&Shape) -> Option<(f64, f64)> + Sync),
) -> Option<(f64, f64, Shape)> {
    let (mut likelihood, mut scale) = try_one(&white)?;
    let mut best = white;
    let processes = lasting as usize;
    for process in 0..processes {
        let free = 1.0 - best.shares[0];
        let mut found = (likelihood, scale, best);
        // The second process is slow, and a small part of what the first one left.
        let (shares, times): (&[f64], &[f64]) =
            if process == 0 { (&SHARES, &TIMES_IN_STEPS) } else { (&SLOW_SHARES, &TIMES_IN_STEPS[2..]) };
        let shape_of = |share: f64, time: f64| {
            let mut shape = best;
            (shape.shares[process], shape.log_times[process]) = (share * free, time.ln());
            shape
        };
        let shapes: Vec<Shape> =
            shares.iter().flat_map(|share| times.iter().map(|time| shape_of(*share, *time))).collect();
        let tried: Vec<Option<(f64, f64)>> = shapes.par_iter().map(try_one).collect();
        for (shape, (l, s)) in shapes.iter().zip(tried).filter_map(|(shape, tried)| Some((shape, tried?))) {
            if l > found.0 {
                found = (l, s, *shape);
            }
        }
        refine(&mut found, process + 1, try_one);
        if found.0 < likelihood + 2.0 {
            break;
        }
        (likelihood, scale, best) = found;
    }
    Some((likelihood, scale, best))
}

/// Climbs from a shape: each number up or down by a step that shrinks.
fn refine(found: &mut (f64, f64, Shape), processes: usize, at: &impl Fn(&Shape) -> Option<(f64, f64)>) {
    for step in [0.6, 0.2] {
        let mut moved = true;
        for _ in 0..3 {
            if !std::mem::take(&mut moved) {
                break;
            }
            for number in 0..2 * processes {
                for sign in [-1.0, 1.0] {
                    let mut shape = found.2;
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
                    if let Some((l, s)) = at(&shape).filter(|(l, _)| *l > found.0 + 1e-3) {
                        *found = (l, s, shape);
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

/// An orthonormal basis of the space of these columns, without the directions that add nothing.
pub fn orthonormal(mut columns: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in columns.column_iter_mut() {
        let size = column.norm();
        if size > 0.0 {
            column.unscale_mut(size);
        }
    }
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in columns.column_iter() {
        let mut rest = column.into_owned();
        for _ in 0..2 {
            for direction in &kept {
                let inside = direction.dot(&rest);
                rest.axpy(-inside, direction, 1.0);
            }
        }
        let size = rest.norm();
        if size > 1e-9 {
            kept.push(rest / size);
        }
    }
    DMatrix::from_fn(columns.nrows(), kept.len(), |row, column| kept[column][row])
}

/// Restricted log-likelihood of a shape with its best scale, and that scale. The last column is the residual.
fn profile(series: Series<'_>, shape: &Noise, stated_known_to: f64, columns: &DMatrix<f64>) -> Option<(f64, f64)> {
    let (n, k) = (columns.nrows(), columns.ncols() - 1);
    let mut columns = columns.clone();
    let log_determinant = whiten(series, shape, &mut columns);
    let products = columns.transpose() * &columns;
    let cholesky = products.view((0, 0), (k, k)).into_owned().cholesky()?;
    let moments = products.view((0, k), (k, 1)).into_owned();
    let explained_squares = moments.dot(&cholesky.solve(&moments));
    let log_gram = 2.0 * cholesky.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>();
    let free = n.checked_sub(k).filter(|free| *free > 0)? as f64;
    let squares = products[(k, k)] - explained_squares;
    let scale = most_likely_scale(squares, free, shape.white, stated_known_to);
    let below = ((scale * shape.white).ln().min(0.0) / stated_known_to).powi(2);
    // The explained columns' own scale, not the noise's, so the determinant of the Gram matrix scales out.
    let log_likelihood = -0.5 * (free * scale.ln() + squares / scale + log_determinant + log_gram + below);
    log_likelihood.is_finite().then_some((log_likelihood, scale))
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
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    fn slow(variance: f64, correlation_time_s: f64) -> Slow {
        Slow { variance, correlation_time_s }
    }

    fn sample(n: usize, noise: &Noise, seed: u64) -> (Vec<f64>, Vec<f64>, DVector<f64>) {
        let mut rng = StdRng::seed_from_u64(seed);
        let mut normal = move || rng.sample::<f64, _>(StandardNormal);
        let time_s: Vec<f64> = (0..n).map(|i| 60.0 * i as f64).collect();
        let stated = vec![0.003; n];
        let [Slow { variance: red, correlation_time_s }, _] = noise.slow;
        let kept = (-60.0 / correlation_time_s).exp();
        let mut slow = red.sqrt() * normal();
        let residual = DVector::from_iterator(
            n,
            (0..n).map(|_| {
                let value = slow + noise.white.sqrt() * 0.003 * normal();
                slow = kept * slow + (red * (1.0 - kept * kept)).sqrt() * normal();
                value
            }),
        );
        (time_s, stated, residual)
    }

    #[test]
    fn whitening_is_the_inverse_square_root_of_the_covariance() {
        // Against the covariance written out: y' S^-1 y and log det S.
        let noise = Noise { white: 1.5, differenced: 0.6, slow: [slow(4e-5, 300.0), slow(2e-5, 5000.0)] };
        let (time_s, stated_sd, residual) = sample(40, &noise, 1);
        let place: Vec<f64> = (0..40).map(|i| (f64::from(i) * 0.37).fract()).collect();
        let covariance = DMatrix::from_fn(40, 40, |i, j| {
            let apart = (time_s[i] - time_s[j]).abs();
            let mode =
                |k: usize, z: f64| if k == 0 { 1.0 } else { 2f64.sqrt() * (k as f64 * std::f64::consts::PI * z).cos() };
            let modes: f64 = (0..3).map(|k| mode(k, place[i]) * mode(k, place[j]) / 3.0).sum();
            let slow: f64 = [(noise.slow[0], 1.0), (noise.slow[1], modes)]
                .iter()
                .map(|(slow, shape)| slow.variance * (-apart / slow.correlation_time_s).exp() * shape)
                .sum();
            let neighbour = -noise.differenced / (1.0 + noise.differenced.powi(2));
            let own = [1.0, neighbour].get(i.abs_diff(j)).map_or(0.0, |share| share * noise.white);
            slow + own * stated_sd[i] * stated_sd[j]
        });
        let cholesky = covariance.cholesky().unwrap();
        let expected = residual.dot(&cholesky.solve(&residual));
        let mut columns = DMatrix::from_column_slice(40, 1, residual.as_slice());
        let log_determinant = whiten(
            Series { time_s: &time_s, stated_sd: &stated_sd, place: &place, joined_s: 70.0 },
            &noise,
            &mut columns,
        );
        assert!((columns.norm_squared() - expected).abs() < 1e-9 * expected);
        let log_expected = 2.0 * cholesky.l().diagonal().map(f64::ln).sum();
        assert!((log_determinant - log_expected).abs() < 1e-9 * log_expected.abs());
    }

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
