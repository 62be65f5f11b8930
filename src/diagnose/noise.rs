//! What is left when the model is right: measurement noise, and water that moves.
//!
//! Each quantity's residuals are taken as white noise plus an Ornstein-Uhlenbeck process (internal waves at sea, slow
//! drift in a tank), with variance `white s_i^2 + red exp(-|t - t'| / tau)`. The process is Markov, so a Kalman filter
//! turns residuals and sensitivities into independent numbers of unit variance in one pass over the rows. The three
//! numbers are those of greatest restricted likelihood (Patterson and Thompson 1971), with every candidate's
//! sensitivities projected out, so that an effect yet unexplained does not count as noise.

use nalgebra::{DMatrix, DVector};

/// Noise of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Factor on the stated variance of the measurement.
    pub white: f64,
    /// Variance of the slow part, in the square of the quantity's unit.
    pub red: f64,
    /// Correlation time of the slow part \[s\].
    pub correlation_time_s: f64,
}

impl Noise {
    /// Standard deviation of one row whose measurement has the stated standard deviation.
    pub fn sd(&self, stated_sd: f64) -> f64 {
        (self.white * stated_sd * stated_sd + self.red).sqrt()
    }
}

/// The rows of one quantity in the order of time.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Time of each row \[s\], not decreasing.
    pub time_s: &'a [f64],
    /// Stated standard deviation of each row's measurement.
    pub stated_sd: &'a [f64],
}

/// Makes every column independent and of unit variance, in place; returns the logarithm of the determinant of the
/// covariance. Columns are the residuals and the sensitivities, rows as in the series.
pub fn whiten(series: Series<'_>, noise: &Noise, columns: &mut DMatrix<f64>) -> f64 {
    let n_columns = columns.ncols();
    let mut means = vec![0.0; n_columns];
    let mut variance = noise.red;
    let mut log_determinant = 0.0;
    for row in 0..series.time_s.len() {
        if row > 0 {
            let step_s = series.time_s[row] - series.time_s[row - 1];
            let kept = (-step_s / noise.correlation_time_s).exp();
            means.iter_mut().for_each(|mean| *mean *= kept);
            variance = kept * kept * variance + noise.red * (1.0 - kept * kept);
        }
        let stated = series.stated_sd[row];
        let innovation = variance + noise.white * stated * stated;
        let gain = variance / innovation;
        let scale = innovation.sqrt().recip();
        for (column, mean) in means.iter_mut().enumerate() {
            let difference = columns[(row, column)] - *mean;
            columns[(row, column)] = difference * scale;
            *mean += gain * difference;
        }
        variance *= 1.0 - gain;
        log_determinant += innovation.ln();
    }
    log_determinant
}

/// Shares of the slow part in the variance that are tried.
const RED_SHARES: [f64; 12] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.96, 0.99];

/// Correlation times that are tried, in units of the median step between rows.
const TIMES_IN_STEPS: [f64; 9] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];

/// Largest variance of the noise, relative to that of the residuals once everything explained is set aside. Beyond it a
/// slow process would stand for a level that no row shows, and hide every effect that is a level.
const MAX_VARIANCE_RATIO: f64 = 1.5;

/// The noise of greatest restricted likelihood. `residual` is what the present model leaves, `explained` the
/// sensitivities to everything that could explain it.
pub fn estimate(series: Series<'_>, residual: &DVector<f64>, explained: &DMatrix<f64>) -> Noise {
    let n = residual.len();
    let mut steps: Vec<f64> =
        series.time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let step_s = steps.get(steps.len() / 2).copied().unwrap_or(1.0);
    let stated = series.stated_sd.iter().map(|sd| sd * sd).sum::<f64>() / n.max(1) as f64;

    let white = Noise { white: 1.0, red: 0.0, correlation_time_s: step_s };
    let seen = profile(series, &white, residual, explained).map_or(f64::INFINITY, |(_, scale)| scale);
    let mut best = (f64::NEG_INFINITY, white);
    for share in RED_SHARES {
        for time in TIMES_IN_STEPS {
            // Shape first; the common scale has a closed form.
            let shape = Noise { white: 1.0 - share, red: share * stated, correlation_time_s: time * step_s };
            let Some((log_likelihood, scale)) = profile(series, &shape, residual, explained) else {
                continue;
            };
            if log_likelihood > best.0 && scale <= MAX_VARIANCE_RATIO * seen {
                let noise = Noise { white: shape.white * scale, red: shape.red * scale, ..shape };
                best = (log_likelihood, noise);
            }
            if share == 0.0 {
                // Without a slow part its correlation time means nothing.
                break;
            }
        }
    }
    best.1
}

/// Restricted log-likelihood of a shape with its best scale, and that scale.
fn profile(series: Series<'_>, shape: &Noise, residual: &DVector<f64>, explained: &DMatrix<f64>) -> Option<(f64, f64)> {
    let (n, k) = (residual.len(), explained.ncols());
    let mut columns = DMatrix::zeros(n, k + 1);
    columns.columns_mut(0, k).copy_from(explained);
    // Sensitivities come in all units: each in its own size, or the small ones drown in the rounding of the large ones.
    for mut column in columns.columns_mut(0, k).column_iter_mut() {
        let size = column.norm();
        if size > 0.0 {
            column.unscale_mut(size);
        }
    }
    columns.column_mut(k).copy_from(residual);
    let log_determinant = whiten(series, shape, &mut columns);
    let design = columns.columns(0, k).into_owned();
    let gram = design.transpose() * &design;
    let eigen = gram.symmetric_eigen();
    let largest = eigen.eigenvalues.max().max(f64::MIN_POSITIVE);
    let moments = design.transpose() * columns.column(k);
    let (mut explained_squares, mut log_gram, mut rank) = (0.0, 0.0, 0);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        // A direction that no row sees takes no degree of freedom.
        if *value > 1e-10 * largest {
            explained_squares += vector.dot(&moments).powi(2) / value;
            log_gram += value.ln();
            rank += 1;
        }
    }
    let free = n.checked_sub(rank).filter(|free| *free > 0)? as f64;
    let squares = columns.column(k).norm_squared() - explained_squares;
    let scale = (squares / free).max(f64::MIN_POSITIVE);
    // The explained columns' own scale, not the noise's, so the determinant of the Gram matrix scales out.
    let log_likelihood = -0.5 * (free * scale.ln() + log_determinant + log_gram + free);
    log_likelihood.is_finite().then_some((log_likelihood, scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    fn sample(n: usize, noise: &Noise, seed: u64) -> (Vec<f64>, Vec<f64>, DVector<f64>) {
        let mut rng = StdRng::seed_from_u64(seed);
        let mut normal = move || rng.sample::<f64, _>(StandardNormal);
        let time_s: Vec<f64> = (0..n).map(|i| 60.0 * i as f64).collect();
        let stated = vec![0.003; n];
        let kept = (-60.0 / noise.correlation_time_s).exp();
        let mut slow = noise.red.sqrt() * normal();
        let residual = DVector::from_iterator(
            n,
            (0..n).map(|_| {
                let value = slow + noise.white.sqrt() * 0.003 * normal();
                slow = kept * slow + (noise.red * (1.0 - kept * kept)).sqrt() * normal();
                value
            }),
        );
        (time_s, stated, residual)
    }

    #[test]
    fn whitening_is_the_inverse_square_root_of_the_covariance() {
        // Against the covariance written out: y' S^-1 y and log det S.
        let noise = Noise { white: 1.5, red: 4e-5, correlation_time_s: 300.0 };
        let (time_s, stated_sd, residual) = sample(40, &noise, 1);
        let covariance = DMatrix::from_fn(40, 40, |i, j| {
            let slow = noise.red * (-(time_s[i] - time_s[j]).abs() / noise.correlation_time_s).exp();
            if i == j { slow + noise.white * stated_sd[i].powi(2) } else { slow }
        });
        let cholesky = covariance.cholesky().unwrap();
        let expected = residual.dot(&cholesky.solve(&residual));
        let mut columns = DMatrix::from_column_slice(40, 1, residual.as_slice());
        let log_determinant = whiten(Series { time_s: &time_s, stated_sd: &stated_sd }, &noise, &mut columns);
        assert!((columns.norm_squared() - expected).abs() < 1e-9 * expected);
        let log_expected = 2.0 * cholesky.l().diagonal().map(f64::ln).sum();
        assert!((log_determinant - log_expected).abs() < 1e-9 * log_expected.abs());
    }

    #[test]
    fn the_noise_that_made_the_data_is_found_again() {
        let truth = Noise { white: 1.0, red: 3.6e-5, correlation_time_s: 600.0 };
        let (mut sds, mut times) = (0.0, 0.0);
        for seed in 0..20 {
            let (time_s, stated_sd, residual) = sample(700, &truth, seed);
            let trend = DMatrix::from_fn(700, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
            let found = estimate(Series { time_s: &time_s, stated_sd: &stated_sd }, &residual, &trend);
            sds += found.sd(0.003) / 20.0;
            times += found.correlation_time_s.ln() / 20.0;
        }
        assert!((sds / truth.sd(0.003) - 1.0).abs() < 0.1, "sd {sds}");
        assert!((times - 600f64.ln()).abs() < 0.5, "correlation time {}", times.exp());
    }
}
