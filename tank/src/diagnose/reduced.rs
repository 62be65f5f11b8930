//! What the reduction hands to the diagnosis: where its coefficients start, what was set in each run, how far each run
//! scatters. Knows no mechanism.

use glidepolar_inference::decorrelation::RunErrors;
use nalgebra::{DMatrix, Vector3};

use super::data::{Data, SteadyData};
use super::model::Setting;
use crate::hull_results::HullResults;
use crate::series::median;

/// a, b, c, d that the reduction found; what is usual for a hull that it could not fit.
pub(super) fn start_of(hull: &HullResults) -> [f64; 4] {
    match &hull.fit {
        Ok(fit) => [&fit.estimates.a, &fit.estimates.b, &fit.estimates.c, &fit.estimates.d].map(|q| q.value),
        Err(_) => [1.0, 0.1, 1.0, 1.0],
    }
}

/// What was set in each run, and what its water does to it.
pub(super) fn settings(data: &Data) -> Vec<Setting> {
    let reference_reynolds = median(&data.runs.iter().map(|run| run.reynolds).collect::<Vec<_>>());
    data.runs
        .iter()
        .map(|run| {
            let hull = &data.hulls[run.hull];
            let change = |of: &dyn Fn(f64) -> f64| {
                run.water.map_or(0.0, |water| {
                    let t = water.temperature_C;
                    (of(t + 1.0) - of(t - 1.0)) / (2.0 * of(t))
                })
            };
            let water_at = |t: f64| run.water.map(|water| water.at(t));
            Setting {
                yaw_rad: run.point.alpha_rad(),
                pressure_Pa: run.pressure_Pa,
                reynolds: run.reynolds,
                froude: run.point.speed_m_s.map(|speed| speed / (9.81 * hull.geometry.loa_m).sqrt()),
                reference_reynolds: reference_reynolds * hull.geometry.loa_m / mean_length(data),
                density_per_K: change(&|t| water_at(t).map_or(1.0, |w| w.density_kg_m3)),
                viscosity_per_K: change(&|t| water_at(t).map_or(1.0, |w| w.kinematic_viscosity_m2_s)),
                area_m2: hull.frontal_area_m2(),
                length_m: hull.geometry.loa_m,
                length_ratio: hull.geometry.loa_m / mean_length(data),
                mc_m: hull.mc_m,
                cb_m: hull.geometry.cb_m,
                interaction: run.interaction,
            }
        })
        .collect()
}

fn mean_length(data: &Data) -> f64 {
    median(&data.runs.iter().map(|run| data.hulls[run.hull].geometry.loa_m).collect::<Vec<_>>())
}

/// What errs in each run: its own scatter, the setting of its angle as repeats show it in the moment, and what it shares with
/// others.
pub(super) fn run_errors(data: &Data, coefficients: &[[f64; 4]]) -> Vec<RunErrors> {
    let setting_rad = setting_rad(data, coefficients);
    let largest = |k: usize| data.runs.iter().map(|run| run.point.coefficients[k].abs()).fold(0.0, f64::max);
    let known = data.runs.iter().all(|run| run.point.se.iter().all(|se| *se > 0.0));
    let shared = shared_errors(data);
    let of = |(run, shared): (&SteadyData, DMatrix<f64>)| {
        let [a, _, c, d] = coefficients[run.hull];
        // Drag is turned with the wind axes: less the lift.
        let slopes = Vector3::new(a, (2.0 * c - a) * run.point.alpha_rad(), d);
        RunErrors {
            // Points without errors of their own: all alike, and their scatter tells how large.
            own_sd: [0, 1, 2].map(|k| if known { run.point.se[k] } else { 0.01 * largest(k).max(1e-6) }),
            setting: if known { slopes * setting_rad } else { Vector3::zeros() },
            shared,
        }
    };
    data.runs.iter().zip(shared).map(of).collect()
}

/// Parts of the zeros' errors that no run feels by this share of its own scatter are left out.
const FELT: f64 = 0.1;

/// For each run, what one standard error of each error that runs share does to CL, CD, CM: tare and calibration, then those
/// of the zeros that matter beside the runs' own scatter.
fn shared_errors(data: &Data) -> Vec<DMatrix<f64>> {
    let mut parts: Vec<usize> = Vec::new();
    for run in &data.runs {
        let zeros = &run.zero_errors;
        let felt = zeros.on.column_iter().map(|column| (0..3).any(|k| column[k].abs() > FELT * run.point.se[k]));
        parts.extend(zeros.parts.iter().zip(felt).filter(|(_, felt)| *felt).map(|(part, _)| *part));
    }
    parts.sort_unstable();
    parts.dedup();
    let of = |run: &SteadyData| {
        let rig = run.rig_errors.ncols();
        let mut all = run.rig_errors.clone().resize_horizontally(rig + parts.len(), 0.0);
        for (part, column) in run.zero_errors.parts.iter().zip(run.zero_errors.on.column_iter()) {
            if let Ok(place) = parts.binary_search(part) {
                all.column_mut(rig + place).copy_from(&column);
            }
        }
        all
    };
    data.runs.iter().map(of).collect()
}

/// Standard deviation of the angle to which runs are set, from repeats \[rad\].
fn setting_rad(data: &Data, coefficients: &[[f64; 4]]) -> f64 {
    let key = |run: &SteadyData| {
        (run.hull, run.point.nominal_yaw_deg.to_bits(), run.point.nominal_speed_m_s.map(f64::to_bits))
    };
    let (mut sum, mut dof) = (0.0, 0);
    let mut is_done = vec![false; data.runs.len()];
    for i in 0..data.runs.len() {
        if is_done[i] {
            continue;
        }
        let alike: Vec<&SteadyData> = (i..data.runs.len())
            .filter(|j| key(&data.runs[*j]) == key(&data.runs[i]))
            .inspect(|j| is_done[*j] = true)
            .map(|j| &data.runs[j])
            .collect();
        // The angle as recorded may differ between repeats, and the moment goes with it.
        let d = coefficients[data.runs[i].hull][3];
        let moments: Vec<f64> = alike.iter().map(|run| run.point.coefficients[2] / d - run.point.alpha_rad()).collect();
        let mean = moments.iter().sum::<f64>() / moments.len() as f64;
        sum += moments.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        sum -= alike.iter().map(|run| (run.point.se[2] / d).powi(2)).sum::<f64>() * (alike.len() - 1) as f64
            / alike.len() as f64;
        dof += alike.len() - 1;
    }
    if dof == 0 { 0.0 } else { (sum / dof as f64).max(0.0).sqrt() }
}
