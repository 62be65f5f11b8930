//! The readings against themselves, before any fit: signs that no bare hull shows, a day's temperature that no tank has.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;
use glidepolar_inference::{Cause, Diagnosis, Gain, Verdict};

use super::data::Data;
use super::drift::Days;
use crate::hull_results::HullResults;
use crate::series::median;

/// Thousands of cubic metres change their temperature by tenths of a degree from day to day: this is no tank \[K\].
const NO_TANK_K: f64 = 3.0;

/// A day's departure from the others as tanks have it, a standard deviation \[K\].
const USUAL_K: f64 = 1.0;

/// A channel that is recorded with the wrong sign, as the slopes of every hull say.
pub fn signs(hulls: &[HullResults]) -> Option<Diagnosis> {
    let fits: Vec<_> = hulls.iter().filter_map(|hull| Some(&hull.fit.as_ref().ok()?.estimates)).collect();
    let negative = |of: &dyn Fn(&glidepolar_hull::hull_tests::HullFit) -> Estimate| {
        !fits.is_empty() && fits.iter().all(|fit| of(fit).ci95[1] < 0.0)
    };
    let lift = negative(&|fit| fit.a.clone());
    let moment = negative(&|fit| fit.d.clone());
    let drag = negative(&|fit| fit.b.clone());
    let (channel, parameter) = match (lift, moment, drag) {
        (true, true, _) => ("yaw angle", "yaw_sign"),
        (true, false, _) => ("SF", "sf_sign"),
        (false, true, _) => ("YM", "ym_sign"),
        (_, _, true) => ("AF", "af_sign"),
        _ => return None,
    };
    let slope = fits.iter().map(|fit| if moment { fit.d.value } else { fit.a.value }).sum::<f64>() / fits.len() as f64;
    let cause = Cause {
        cause: "channel_sign".to_owned(),
        parameters: BTreeMap::from([(parameter.to_owned(), Estimate::normal(-1.0, 0.0, "1"))]),
        p_value: 0.0,
        delta_bic: 0.0,
        quantity: if moment { "CM" } else { "CL" }.to_owned(),
        holdout_rms_before: slope.abs(),
        holdout_rms_after: slope.abs(),
        stability: Vec::new(),
        log_likelihood_ratio: BTreeMap::new(),
        indistinguishable_from: Vec::new(),
    };
    let quantity = cause.quantity.clone();
    let nothing =
        Gain { quantity, holdout_rms_before: 0.0, holdout_rms_after: 0.0, reduction_percent: 0.0, ci95: [0.0; 2] };
    let wrong = glidepolar_inference::Wrong {
        quantity: cause.quantity.clone(),
        regime: format!(
            "its slope is {slope:.3} per rad, impossible for a bare hull: {channel} is recorded with the opposite sign"
        ),
        rms: slope.abs(),
        expected_rms: 0.0,
        size: slope.abs(),
        relevant_above: 0.0,
        p_value: 0.0,
    };
    Some(Diagnosis {
        consistency: Vec::new(),
        warnings: Vec::new(),
        schema: "glidepolar.diagnosis/1",
        verdict: Verdict::Explained,
        wrong: vec![wrong],
        causes: vec![cause],
        alternatives: Vec::new(),
        left: Vec::new(),
        trim: None,
        shear_share: None,
        empirical: None,
        rejected: Vec::new(),
        unexplained: None,
        gain: nothing.clone(),
        gains: vec![nothing],
        extended: None,
    })
}

/// A day whose temperatures are no neighbour's: named, and put right in the data by what it departs.
pub fn temperatures(data: &mut Data) -> Option<Cause> {
    let days = Days::new(data);
    let mean = |day: usize| {
        let of_day = (0..data.runs.len()).filter(|run| days.of_run(*run) == Some(day));
        let values: Vec<f64> = of_day.filter_map(|run| data.runs[run].water.map(|water| water.temperature_C)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let means: Vec<(usize, f64)> = (0..days.count()).filter_map(|day| Some((day, mean(day)?))).collect();
    // Of two days nobody can say which one is wrong.
    if means.len() < 3 {
        return None;
    }
    let middle = median(&means.iter().map(|(_, t)| *t).collect::<Vec<_>>());
    let (day, t) = *means.iter().max_by(|a, b| (a.1 - middle).abs().total_cmp(&(b.1 - middle).abs()))?;
    let others: Vec<f64> = means.iter().filter(|(other, _)| *other != day).map(|(_, t)| *t).collect();
    let mean = others.iter().sum::<f64>() / others.len() as f64;
    let spread = others.iter().map(|t| (t - mean).abs()).fold(0.0, f64::max);
    let error = t - mean;
    if error.abs() < NO_TANK_K || error.abs() < 2.5 * spread {
        return None;
    }
    for run in 0..data.runs.len() {
        if days.of_run(run) == Some(day) {
            correct(data, run, error);
        }
    }
    let n = others.len() as f64;
    let variance = others.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    // A day's own temperature scatters as the others' do, and so does the mean that it is held against.
    let se = (variance * (1.0 + 1.0 / n)).sqrt();
    let half = glidepolar_inference::estimate::student_975(n - 1.0) * se;
    Some(Cause {
        cause: "water_temperature".to_owned(),
        parameters: BTreeMap::from([
            ("water_temperature_error_c".to_owned(), Estimate::with_half_width(error, se, half, "degC")),
            ("day".to_owned(), Estimate::normal(day as f64 + 1.0, 0.0, "1")),
        ]),
        p_value: glidepolar_inference::regression::student_p_value(error / se.max(USUAL_K), f64::INFINITY)
            * means.len() as f64,
        delta_bic: 0.0,
        quantity: "water temperature".to_owned(),
        holdout_rms_before: error.abs(),
        holdout_rms_after: variance.sqrt(),
        stability: Vec::new(),
        log_likelihood_ratio: BTreeMap::new(),
        indistinguishable_from: Vec::new(),
    })
}

/// A run's coefficients by the water that it truly was made in.
fn correct(data: &mut Data, run: usize, error_K: f64) {
    let run = &mut data.runs[run];
    let Some(recorded) = run.water else { return };
    let water = recorded.at(recorded.temperature_C - error_K);
    let ratio = recorded.density_kg_m3 / water.density_kg_m3;
    run.point.coefficients.iter_mut().for_each(|c| *c *= ratio);
    run.pressure_Pa /= ratio;
    run.reynolds *= recorded.kinematic_viscosity_m2_s / water.kinematic_viscosity_m2_s;
    run.water = Some(water);
}

/// Adds a cause that the readings themselves show to what the runs say.
pub fn add(diagnosis: &mut Diagnosis, cause: Cause) {
    diagnosis.rejected.retain(|rejected| rejected.cause != cause.cause);
    diagnosis.wrong.push(glidepolar_inference::Wrong {
        quantity: cause.quantity.clone(),
        regime: "one day against the others".to_owned(),
        rms: cause.holdout_rms_before,
        expected_rms: cause.holdout_rms_after,
        size: cause.holdout_rms_before,
        relevant_above: 0.0,
        p_value: cause.p_value,
    });
    diagnosis.verdict = if diagnosis.unexplained.is_some() { Verdict::PartlyExplained } else { Verdict::Explained };
    diagnosis.causes.push(cause);
}
