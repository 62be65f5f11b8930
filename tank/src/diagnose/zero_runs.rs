//! What the zero runs themselves say of a zero that settles: a drift that runs feel between zeros is one that zeros show.

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use super::drift::{Days, Drift};

/// How far a drift may lie from what the zero runs show, in their standard errors: what one in some ten thousand does.
const STANDARD_ERRORS: f64 = 4.0;

/// By what share of itself a rate may differ beside: it is fitted with a time constant between those that are asked here.
const OTHER_TIME_CONSTANT: f64 = 0.5;

/// Lowest and highest rate per hour of a channel's settling zero that the zero runs allow with any of these time constants;
/// none where they are too few.
pub fn allowed_rates(data: &Data, days: &Days, channel: usize, time_constants_h: &[f64]) -> Option<(f64, f64)> {
    let of_each: Option<Vec<(f64, f64)>> = time_constants_h
        .iter()
        .map(|time_constant_h| allowed_rate(data, days, channel, &Drift { time_constant_h: *time_constant_h }))
        .collect();
    let (low, high) =
        of_each?.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| (all.0.min(one.0), all.1.max(one.1)));
    let beside = OTHER_TIME_CONSTANT * low.abs().max(high.abs());
    Some((low - beside, high + beside))
}

/// The same with one time constant.
/// Each stretch of zeros has its own level and each day an even drift, neither of which a settling zero is.
fn allowed_rate(data: &Data, days: &Days, channel: usize, drift: &Drift) -> Option<(f64, f64)> {
    let zeros = &data.zero_runs;
    let day = |i: usize| days.day_at(zeros[i].when_s);
    let mut levels: Vec<(Option<usize>, Option<usize>)> = (0..zeros.len()).map(|i| (zeros[i].hull, day(i))).collect();
    let keys = levels.clone();
    levels.sort_unstable();
    levels.dedup();
    let n_days = days.count();
    let hours: Vec<f64> =
        (0..zeros.len()).map(|i| day(i).map_or(0.0, |day| (zeros[i].when_s - days.begin_s(day)) / 3600.0)).collect();
    let columns = 1 + levels.len() + n_days;
    let design = DMatrix::from_fn(zeros.len(), columns, |i, j| match j {
        0 => drift.at(hours[i]).0,
        j if j <= levels.len() => f64::from(u8::from(levels[j - 1] == keys[i])),
        j => {
            if day(i) == Some(j - 1 - levels.len()) {
                hours[i]
            } else {
                0.0
            }
        }
    });
    let observed = DVector::from_iterator(zeros.len(), zeros.iter().map(|zero| zero.reading[channel]));
    // Some columns may be alike: a day with one level and two zeros.
    let others = glidepolar_inference::noise::orthonormal(design.columns(1, columns - 1).into_owned());
    let outside = |column: DVector<f64>| {
        let once = &column - &others * others.tr_mul(&column);
        &once - &others * others.tr_mul(&once)
    };
    let dof = zeros.len().checked_sub(others.ncols() + 1).filter(|dof| *dof > 0)?;
    let trace = outside(design.column(0).into_owned());
    let left = outside(observed);
    let size = trace.norm_squared();
    if size < 1e-6 {
        return None;
    }
    let rate = trace.dot(&left) / size;
    let scatter = (&left - trace * rate).norm_squared() / dof as f64;
    let stated = zeros.iter().map(|zero| zero.variance[channel]).sum::<f64>() / zeros.len() as f64;
    let student = glidepolar_inference::estimate::student_975(dof as f64) / 1.96;
    let half = STANDARD_ERRORS * student * (scatter.max(stated) / size).sqrt();
    Some((rate - half, rate + half))
}
