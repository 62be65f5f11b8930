//! Steady runs step by step: reading, zero, interaction, tare, inertia, force of the water, coefficients. Every step is
//! kept, so that the tables can show it.

use glidepolar_hull::coefficients::BalanceForce;
use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::campaign::{Kind, Run};
use crate::hull::Hull;
use crate::influence::Influence;
use crate::motion::Motion;
use crate::readings::{Readings, Steady};
use crate::run_variance;
use crate::shared::{Common, SharedKind};
use crate::steady_run::{SteadyRun, Steps};
use crate::sweep::{Point, SharedErrors, Sweep};
use crate::tare::TareRun;

impl Common<'_> {
    /// Takes a steady run as far as the force of the water; none if it has no zero. `hull` is none for the strut alone.
    pub fn steady<'a>(
        &self,
        run: &'a Run,
        readings: &Readings,
        steady: &'a Steady,
        hull: Option<&Hull>,
    ) -> Option<SteadyRun<'a>> {
        let zero = self.zeros.at(run, readings, steady.middle_s)?;
        let interaction = self.balance.interaction;
        let speed = steady.speed_squared.sqrt();
        let yaw_rad = if run.kind == Kind::Arc { run.yaw_deg } else { steady.yaw_deg }.to_radians();
        let motion = match run.radius_m {
            Some(radius) => Motion::turning(speed, radius, yaw_rad, steady.acceleration_m_s2),
            None => Motion::straight(speed, yaw_rad, steady.acceleration_m_s2),
        };
        let force = interaction * (steady.readings.mean - zero.reading);
        let tare = match (hull, self.tare) {
            (Some(_), Some(tare)) => tare.force(&motion, run.water.density_kg_m3),
            _ => Vector3::zeros(),
        };
        let inertia = hull.map_or_else(Vector3::zeros, |hull| motion.inertia(hull));
        let mut covariance = interaction * (steady.readings.covariance + zero.own_covariance) * interaction.transpose();
        // The noise of the recorded speed is in the change of speed, and by the mass of the model in the force.
        let per_acceleration =
            hull.map_or_else(Vector3::zeros, |hull| Motion::straight(speed, yaw_rad, 1.0).inertia(hull));
        covariance += per_acceleration * per_acceleration.transpose() * steady.acceleration_variance;
        Some(SteadyRun {
            run,
            steady,
            motion,
            dynamic_pressure_Pa: 0.5 * run.water.density_kg_m3 * steady.speed_squared,
            steps: Steps { reading: steady.readings.mean, zero: zero.reading, force, tare, inertia },
            zero,
            covariance,
        })
    }
}

impl SteadyRun<'_> {
    /// As a tare run.
    pub fn tare_run(&self, common: &Common) -> TareRun {
        TareRun {
            yaw_rad: self.steady.yaw_deg.to_radians(),
            speed_m_s: self.motion.speed(),
            nominal_speed_m_s: self.run.speed_m_s,
            dynamic_pressure_Pa: self.dynamic_pressure_Pa,
            force: self.steps.force,
            variance: self.covariance.diagonal(),
            zero_influence: common.influence(SharedKind::Zeros, self),
        }
    }

    /// Force about the moment centre (AF, SF, YM) to CL, CD, CM about the centre of buoyancy: a linear map.
    pub fn to_coefficients(&self, hull: &Hull) -> Matrix3<f64> {
        let column = |axial_N: f64, side_N: f64, yaw_N_m: f64| {
            let c = BalanceForce { axial_N, side_N, yaw_N_m }
                .moved(hull.mc_m, hull.geometry.cb_m)
                .in_wind_axes(self.steady.yaw_deg.to_radians())
                .coefficients(self.dynamic_pressure_Pa, hull.frontal_area_m2(), hull.geometry.loa_m);
            Vector3::new(c.lift, c.drag, c.moment)
        };
        Matrix3::from_columns(&[column(1.0, 0.0, 0.0), column(0.0, 1.0, 0.0), column(0.0, 0.0, 1.0)])
    }
}

/// Makes a sweep of a hull's static runs.
pub fn sweep(common: &Common, runs: &[SteadyRun], hull: &Hull) -> Sweep {
    let maps: Vec<Matrix3<f64>> = runs.iter().map(|run| run.to_coefficients(hull)).collect();
    let mut points: Vec<Point> = runs.iter().zip(&maps).map(|(run, map)| point(run, map, hull)).collect();
    for coefficient in 0..3 {
        let variances: Vec<f64> = points.iter().map(|p| p.se[coefficient].powi(2)).collect();
        let speeds_m_s: Vec<f64> = points.iter().map(|p| p.nominal_speed_m_s.unwrap_or(1.0)).collect();
        for (point, variance) in points.iter_mut().zip(run_variance::share(&variances, &speeds_m_s)) {
            point.se[coefficient] = variance.sqrt();
        }
    }
    let shared = common.shared().into_iter().map(|kind| {
        let each: Vec<Influence> = runs
            .iter()
            .zip(&maps)
            .map(|(run, map)| common.influence(kind, run).through(&DMatrix::from_column_slice(3, 3, map.as_slice())))
            .collect();
        SharedErrors {
            name: kind.name(),
            is_common: true,
            influence: [0, 1, 2].map(|coefficient| Influence::stacked(each.iter(), coefficient)),
            dof: common.shared_dof(kind),
        }
    });
    let mut shared: Vec<SharedErrors> = shared.collect();
    let [mc, cb] = hull.centre_uncertainties_m;
    shared.extend((mc + cb > 0.0).then(|| lever_errors(runs, &maps, mc.hypot(cb))));
    Sweep { points, shared }
}

/// An error of the distance from moment centre to centre of buoyancy moves the moment by as much times the side force.
fn lever_errors(runs: &[SteadyRun], maps: &[Matrix3<f64>], uncertainty_m: f64) -> SharedErrors {
    let of = |run: &SteadyRun, map: &Matrix3<f64>| map * Vector3::new(0.0, 0.0, uncertainty_m * run.steps.water()[1]);
    let each: Vec<Vector3<f64>> = runs.iter().zip(maps).map(|(run, map)| of(run, map)).collect();
    SharedErrors {
        name: "lever",
        is_common: false,
        influence: [0, 1, 2].map(|k| Influence::of_all(DMatrix::from_fn(runs.len(), 1, |i, _| each[i][k]))),
        dof: f64::INFINITY,
    }
}

/// Gives every one of `runs` the noise that steady runs at its speed show together: the spectral density at frequency zero
/// is theirs in common, the length of the window each one's own. Turns are short and few, and tell it poorly themselves.
pub fn share_noise(runs: &mut [SteadyRun], others: &[SteadyRun]) {
    // A long window tells the density better than a short one, and nearer to frequency zero.
    let known: Vec<(f64, f64, Matrix3<f64>)> = runs
        .iter()
        .chain(others)
        .map(|run| (run.run.speed_m_s, run.steady.duration_s, run.covariance * run.steady.duration_s))
        .collect();
    for run in runs {
        let alike = || known.iter().filter(|(speed, ..)| *speed == run.run.speed_m_s);
        let sum: Matrix3<f64> = alike().map(|(_, duration_s, density)| density * *duration_s).sum();
        let total_s: f64 = alike().map(|(_, duration_s, _)| duration_s).sum();
        run.covariance = sum / (total_s * run.steady.duration_s);
    }
}

fn point(run: &SteadyRun, map: &Matrix3<f64>, hull: &Hull) -> Point {
    let coefficients = map * run.steps.water();
    let covariance = map * run.covariance * map.transpose();
    Point {
        run_id: run.run.id.clone(),
        order: run.run.order,
        start_time_s: run.run.start_time_s,
        yaw_deg: run.steady.yaw_deg,
        nominal_yaw_deg: run.run.yaw_deg,
        speed_m_s: Some(run.steady.speed_m_s),
        nominal_speed_m_s: Some(run.run.speed_m_s),
        dynamic_pressure_Pa: Some(run.dynamic_pressure_Pa),
        reynolds: Some(run.steady.speed_m_s * hull.geometry.loa_m / run.run.water.kinematic_viscosity_m2_s),
        temperature_C: Some(run.run.water.temperature_C),
        coefficients: coefficients.into(),
        se: covariance.diagonal().map(f64::sqrt).into(),
    }
}
