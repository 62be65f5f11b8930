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
//!
//! Knows rows of one quantity in the order of time; neither tank nor sea, nor how large a noise is (`restricted_likelihood`).

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    pub(crate) fn slow(variance: f64, correlation_time_s: f64) -> Slow {
        Slow { variance, correlation_time_s }
    }

    /// Times, stated standard deviations and a sample of a noise.
    pub(crate) fn sample(n: usize, noise: &Noise, seed: u64) -> (Vec<f64>, Vec<f64>, DVector<f64>) {
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
}
