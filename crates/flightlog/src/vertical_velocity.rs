//! Vertical velocity from pressure, by a stated filter with its own uncertainty.
//!
//! The rate of pressure is the slope of the least-squares line through the samples within `+-h` of each sample, and
//! through one sample on each side at least. Where samples come evenly none may lie at the edge: a clock that errs by a tenth of a step of
//! 2 s would bring in the second neighbour only where it makes it seem near, and `w` would come out 1 % too large. There the edge is
//! half a step beyond the last sample that usually lies within. With `p` in dbar and the in-situ density,
//! `w = 1e4 dp/dt / (rho g)`, positive down. The filter's answer to a change is that of a moving average of `w` with
//! the parabolic weights `1 - (t/h)^2`: half of an oscillation of the period 2.5 h (10 s for `h` = 4 s) is seen. Its standard
//! error is `sigma_p / sqrt(sum (t - mean t)^2)`, where `sigma_p`, the noise of one pressure sample, is estimated from
//! second differences, which a steady glide does not enter: for three samples of spacing `a`, `b`,
//! `e = p1 - (b p0 + a p2)/(a + b)` has the variance `sigma_p^2 (1 + (a^2 + b^2)/(a + b)^2)`.

use super::median;

/// Steps on each side of a sample of which the median is the usual one: that of so many hardly depends on the clock of any.
const STEPS_NEARBY: usize = 16;

/// Share of the median step by which half of the steps may differ from it where samples come evenly: that of a clock which errs by up to a
/// quarter of a step.
const EVEN: f64 = 0.15;

/// Share of a step by which the last sample within the window may usually lie beyond it: the error of a median of so many.
const BEYOND: f64 = 0.1;

/// What the filter gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Velocity {
    /// Rate of change of the pressure \[dbar/s\], NaN at the ends of a stretch.
    pub rate_dbar_s: Vec<f64>,
    /// Its standard error from the noise of the pressure \[dbar/s\].
    pub se_dbar_s: Vec<f64>,
    /// Between which times, counted from each sample, the rate is a mean \[s\]: the even window with the mean and the standard
    /// deviation of the filter's own weights.
    pub window_s: Vec<[f64; 2]>,
    /// Rate of change of that rate \[dbar/s2\], from the samples within `+-3 h`.
    pub acceleration_dbar_s2: Vec<f64>,
    /// Noise of one sample of pressure \[dbar\].
    pub noise_dbar: f64,
}

/// The rate of pressure on one unbroken stretch of samples; `half_window_s` is `h`.
pub fn vertical_velocity(time_s: &[f64], pressure_dbar: &[f64], half_window_s: f64) -> Velocity {
    let n = time_s.len();
    let mut velocity = Velocity {
        rate_dbar_s: vec![f64::NAN; n],
        se_dbar_s: vec![f64::NAN; n],
        window_s: vec![[0.0; 2]; n],
        acceleration_dbar_s2: vec![f64::NAN; n],
        noise_dbar: noise(time_s, pressure_dbar),
    };
    for (i, (low, high)) in filter_windows(time_s, half_window_s).into_iter().enumerate() {
        if low == high {
            continue;
        }
        let (slope, spread) = slope(&time_s[low..=high], &pressure_dbar[low..=high]);
        velocity.rate_dbar_s[i] = slope;
        velocity.se_dbar_s[i] = velocity.noise_dbar / spread.sqrt();
        velocity.window_s[i] = even_window(&time_s[low..=high], i - low);
    }
    for (i, (low, high)) in filter_windows(time_s, 3.0 * half_window_s).into_iter().enumerate() {
        // There is no rate at the ends.
        let (low, high) = (low.max(1), high.min(n.saturating_sub(2)));
        if high > low + 1 {
            let (acceleration, _) = slope(&time_s[low..=high], &velocity.rate_dbar_s[low..=high]);
            velocity.acceleration_dbar_s2[i] = acceleration;
        }
    }
    velocity
}

/// First and last sample of the filter around each sample; at the ends of a stretch that sample itself, twice.
///
/// Where samples come evenly the window reaches half a median step beyond the last one that usually lies within `half_window_s`: a clock
/// that jitters neither brings one in there nor leaves one out.
pub fn filter_windows(time_s: &[f64], half_window_s: f64) -> Vec<(usize, usize)> {
    let n = time_s.len();
    let steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut nearby = Vec::with_capacity(2 * STEPS_NEARBY);
    let around = |i: usize| {
        if i == 0 || i + 1 == n {
            return (i, i);
        }
        nearby.clear();
        nearby.extend_from_slice(&steps[i.saturating_sub(STEPS_NEARBY)..(i + STEPS_NEARBY).min(n - 1)]);
        let step_s = median(&mut nearby);
        nearby.iter_mut().for_each(|step| *step = (*step - step_s).abs());
        let is_even = step_s > 0.0 && median(&mut nearby) < EVEN * step_s;
        let reach_s = if is_even { ((half_window_s / step_s + BEYOND).floor() + 0.5) * step_s } else { half_window_s };
        let (mut low, mut high) = (i - 1, i + 1);
        while low > 0 && time_s[i] - time_s[low - 1] <= reach_s {
            low -= 1;
        }
        while high + 1 < n && time_s[high + 1] - time_s[i] <= reach_s {
            high += 1;
        }
        (low, high)
    };
    (0..n).map(around).collect()
}

/// Slope of the least-squares line, and the sum of squares of the abscissa about its mean.
fn slope(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    // Counted from the first value, so that Unix times lose no digits.
    let (x0, y0) = (x[0], y[0]);
    let (mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0);
    for (&x, &y) in x.iter().zip(y) {
        let (x, y) = (x - x0, y - y0);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    let spread = sxx - sx * sx / n;
    ((sxy - sx * sy / n) / spread, spread)
}

/// The even window that stands for the weights of a slope through these samples, counted from sample `at` \[s\].
///
/// The slope is the sum of `c_j p_j`, `c_j = (t_j - mean t) / sum (t - mean t)^2`: a weighted mean of the rate of `p`. Where the rate
/// is `t`, `p` is `t^2 / 2`; where it is `t^2`, `p` is `t^3 / 3`: so the slopes of these two are the moments of the weights.
fn even_window(time_s: &[f64], at: usize) -> [f64; 2] {
    let n = time_s.len() as f64;
    let mean = time_s.iter().map(|t| t - time_s[at]).sum::<f64>() / n;
    let (mut spread, mut first, mut second) = (0.0, 0.0, 0.0);
    for t in time_s.iter().map(|t| t - time_s[at]) {
        spread += (t - mean).powi(2);
        first += (t - mean) * t * t / 2.0;
        second += (t - mean) * t * t * t / 3.0;
    }
    let centre = first / spread;
    let half = (3.0 * (second / spread - centre * centre)).max(0.0).sqrt();
    [centre - half, centre + half]
}

/// Noise of one sample, from the median of second differences: a normal variable's median size is 0.6745 sigma.
fn noise(time_s: &[f64], pressure_dbar: &[f64]) -> f64 {
    let mut errors: Vec<f64> = time_s
        .windows(3)
        .zip(pressure_dbar.windows(3))
        .map(|(t, p)| {
            let (a, b) = (t[1] - t[0], t[2] - t[1]);
            let error = p[1] - (b * p[0] + a * p[2]) / (a + b);
            error.abs() / (1.0 + (a * a + b * b) / ((a + b) * (a + b))).sqrt()
        })
        .filter(|error| error.is_finite())
        .collect();
    if errors.is_empty() { f64::NAN } else { median(&mut errors) / 0.6745 }
}
