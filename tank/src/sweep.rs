//! A hull's steady drift points: what the fits start from, wherever the points came from.

use crate::influence::Influence;
use glidepolar_inference::regression::Shared;

/// The three coefficients, in the order in which everything here keeps them.
pub const NAMES: [&str; 3] = ["CL", "CD", "CM"];

/// All steady points of one hull.
#[derive(Debug, Clone, Default)]
pub struct Sweep {
    /// The points.
    pub points: Vec<Point>,
    /// Errors that points share, with their influence on every point.
    pub shared: Vec<SharedErrors>,
}

/// One steady point: a run, or a row of a table.
#[derive(Debug, Clone)]
pub struct Point {
    /// The run, or the row's number.
    pub run_id: String,
    /// Place in the order in which the runs were made.
    pub order: usize,
    /// Begin of the run since the first day's begin, where it is known \[s\].
    pub start_time_s: Option<f64>,
    /// Angle of attack: the yaw angle of the hull \[deg\].
    pub yaw_deg: f64,
    /// Angle that was asked for; repeats share it \[deg\].
    pub nominal_yaw_deg: f64,
    /// Speed, where it is known \[m/s\].
    pub speed_m_s: Option<f64>,
    /// Speed that was asked for; repeats share it \[m/s\].
    pub nominal_speed_m_s: Option<f64>,
    /// Dynamic pressure, where it is known \[Pa\].
    pub dynamic_pressure_Pa: Option<f64>,
    /// Reynolds number on the overall length, where it is known.
    pub reynolds: Option<f64>,
    /// Water temperature, where it is known \[degC\].
    pub temperature_C: Option<f64>,
    /// CL, CD, CM.
    pub coefficients: [f64; 3],
    /// Their standard errors from within the run; zero where they are unknown.
    pub se: [f64; 3],
}

/// An error that the points of a hull share, such as that of one tare or one zero.
#[derive(Debug, Clone)]
pub struct SharedErrors {
    /// What it is the error of.
    pub name: &'static str,
    /// Whether other hulls of the campaign share it, too.
    pub is_common: bool,
    /// On CL, CD and CM of every point.
    pub influence: [Influence; 3],
    /// Degrees of freedom with which its size is known.
    pub dof: f64,
}

impl Point {
    /// Angle of attack \[rad\].
    pub fn alpha_rad(&self) -> f64 {
        self.yaw_deg.to_radians()
    }
}

impl Sweep {
    /// Whether the points know their own standard errors.
    pub fn has_errors(&self) -> bool {
        self.points.iter().all(|point| point.se.iter().all(|se| *se > 0.0))
    }

    /// The points up to an angle, as indices.
    pub fn within_deg(&self, range_deg: f64) -> Vec<usize> {
        // A setting of 10 deg reads 9.998 or 10.003: what was asked for decides where it is known to differ by noise only.
        let inside = |point: &Point| point.nominal_yaw_deg.abs() <= range_deg + 1e-9;
        (0..self.points.len()).filter(|i| inside(&self.points[*i])).collect()
    }

    /// The shared errors as some of the points feel them in one coefficient, without those that none of them feels.
    pub fn shared_for(&self, rows: &[usize], coefficient: usize) -> Vec<Shared> {
        let of = |shared: &SharedErrors| Shared {
            influence: shared.influence[coefficient].of_rows(rows).on,
            dof: shared.dof,
        };
        self.shared.iter().map(of).collect()
    }
}
