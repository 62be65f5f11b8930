//! What the data can tell and what they cannot: parameters that must be pinned, why, and the profile that shows it.
//!
//! *Lift slope from vertical velocity alone.* In a steady glide `CD = -CL tan xi` and `q A CL = W cos xi`. With small
//! angle of attack the sink rate at a given pitch is `sin^3|xi| W / (q A CD)`-like: it fixes the drag at that pitch, and
//! the lift slope only moves `xi` against the pitch by `alpha = b/(a tan|xi|)`. What a smaller `alpha` changes, a larger
//! `b` takes back. The derivation is in `docs/theory/identification.md`. A statistical error may look small there; it is the error of
//! the model that then decides, and the speed goes wrong by far more than the vertical velocity shows. So without a
//! measured speed the lift slope is pinned, always, unless the user frees it.

use serde::Serialize;

use super::data::Dive;
use super::joint::{IdentifyError, JointFit, Question, fit};
use super::residuals::Residual;
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};

/// How far a parameter must be known to count as identified: half of its 95 % interval against its own size, or
/// against a natural magnitude where its neutral value is zero. Given what is held: whether these data identify it, not how well it is
/// known in the end.
pub fn is_identified(fit: &JointFit, position: usize) -> bool {
    let row = fit.free[position];
    let half = 2.0 * fit.scatter_se(position);
    let info = &PARAMETERS[row];
    let widest = match info.name {
        "a_per_rad" => 0.5 * fit.value(row).abs(),
        "b" => fit.value(row).abs(),
        "c_per_rad2" => 15.0_f64.max(fit.value(row).abs()).min(40.0),
        "ballast_offset_kg" => 0.5,
        "hull_compressibility_per_Pa" => 2e-10,
        "hull_thermal_expansion_per_K" => 7e-5,
        "ballast_scale" | "pitch_scale" | "pressure_scale" | "climb_dive_drag_ratio" => 0.25,
        "pitch_offset_rad" => 0.1,
        "vertical_current_m_s" => 0.05,
        "drag_exponent" => 0.3,
        "d_per_rad" | "offset_mass_below_m" | "added_mass_1_kg" | "added_mass_3_kg" => fit.value(row).abs(),
        "ballast_forward_m" => 0.1,
        _ => f64::INFINITY,
    };
    let at_bound = fit.value(row) <= info.min || fit.value(row) >= info.max;
    // Drag that falls with the angle of attack is none that a glider has: noise or something else is in it, and the lift slope
    // beside it, whose angle of attack makes that drag, would follow.
    let impossible = info.name == "c_per_rad2" && fit.value(row) < 0.0;
    half.is_finite() && half <= widest && !at_bound && !impossible
}

/// One point of a profile: the parameter held, all others fitted again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ProfilePoint {
    /// The value held.
    pub value: f64,
    /// Vertical velocity, root mean square \[m/s\].
    pub w_rms_m_s: f64,
    /// Mean speed that the model gives \[m/s\].
    pub mean_speed_m_s: f64,
    /// Minus twice the logarithm of the likelihood against that of the best point, correlation of the residuals
    /// allowed for; 3.84 bounds the 95 % interval.
    pub deviance: f64,
}

/// The profile of a parameter over the given values, from the best one outwards on both sides as far as the others can be
/// fitted beside it.
///
/// # Errors
/// A name that is no parameter.
pub fn profile(
    question: &Question,
    best: &Parameters<f64>,
    name: &str,
    values: &[f64],
    dives: &[Dive],
) -> Result<Vec<ProfilePoint>, IdentifyError> {
    let row = parameter_index(name).ok_or_else(|| IdentifyError::UnknownParameter(name.to_owned()))?;
    let free: Vec<usize> = question.free.iter().copied().filter(|&free| free != row).collect();
    let question = Question { free, several_starts: false, ..question.clone() };
    let mut dives = dives.to_vec();
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (below, above) = sorted.split_at(sorted.partition_point(|value| *value < best.as_array()[row]));
    let mut side = |values: &mut dyn Iterator<Item = &f64>| {
        let mut start = *best;
        let mut points: Vec<(ProfilePoint, super::Tally)> = Vec::new();
        for &value in values {
            if name == "a_per_rad" && question.free.iter().any(|&free| PARAMETERS[free].name == "c_per_rad2") {
                // Drag due to lift goes with the square of the slope: from there the fit finds a glide.
                start.c_per_rad2 *= (value / start.a_per_rad).powi(2);
            }
            *start.at(row) = value;
            // Where it cannot be fitted, as where the glider cannot fly as the log does, it cannot be further out.
            let Ok(found) = fit(&Question { baseline: start, ..question.clone() }, &mut dives) else { break };
            start = found.parameters;
            points.push((point(value, &start, &dives), found.tally));
        }
        points
    };
    let mut points = side(&mut below.iter().rev());
    points.reverse();
    points.extend(side(&mut above.iter()));
    // The number of independent bins is that of the best point for all, so that only the fit makes the difference.
    let ratio = |s: &super::Scatter| s.n as f64 / s.correlated_samples();
    let best = points.iter().min_by(|x, y| x.0.w_rms_m_s.total_cmp(&y.0.w_rms_m_s)).map(|point| point.1);
    let Some(best) = best else { return Ok(Vec::new()) };
    let term =
        |s: &super::Scatter, count: f64| if s.n == 0 { 0.0 } else { count * (s.sum_of_squares / s.n as f64).ln() };
    let log_likelihood = |tally: &super::Tally| {
        term(&tally.sink, ratio(&best.sink))
            + if tally.speed.n > 0 { term(&tally.speed, ratio(&best.speed)) } else { 0.0 }
    };
    let least = points.iter().map(|point| log_likelihood(&point.1)).fold(f64::INFINITY, f64::min);
    Ok(points
        .into_iter()
        .map(|(point, tally)| ProfilePoint { deviance: log_likelihood(&tally) - least, ..point })
        .collect())
}

/// A point without its deviance.
fn point(value: f64, parameters: &Parameters<f64>, dives: &[Dive]) -> ProfilePoint {
    let residuals: Vec<Residual> = dives.iter().flat_map(|dive| dive.residuals(parameters)).collect();
    let mean = |of: fn(&Residual) -> f64| {
        let known = residuals.iter().map(of).filter(|value| value.is_finite());
        let (n, sum) = known.fold((0usize, 0.0), |(n, sum), value| (n + 1, sum + value));
        sum / n as f64
    };
    let w_rms_m_s = mean(|r| r.sink_m_s * r.sink_m_s).sqrt();
    ProfilePoint { value, w_rms_m_s, mean_speed_m_s: mean(|r| r.predicted_speed_m_s), deviance: f64::NAN }
}

/// Dives of which only every so many samples are kept.
pub(super) fn subsampled(dives: &[Dive], most: usize) -> Vec<Dive> {
    let samples: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    let every = samples.div_ceil(most).max(1);
    dives.iter().filter_map(|dive| dive.subsampled(every)).collect()
}
