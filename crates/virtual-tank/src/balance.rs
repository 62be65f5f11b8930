//! Strut and three-component balance: what the water and the inertia of the model do to the balance, and what the
//! balance then shows. Must not know hulls or how anybody reduces a reading.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::effects::Hidden;
use super::hull::Loads;
use super::random::Stream;
use super::water::Water;

/// Part of the strut that stands in the flow, m2.
const STRUT_AREA_M2: f64 = 0.0032;
/// Step of the zeros' random walk, and how long a day lasts at most, h.
const WALK_STEP_H: f64 = 0.05;
const LONGEST_DAY_H: f64 = 16.0;

/// The strut between balance and model, forces along and across its chord; stated in the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Strut {
    /// Axial force over rho/2 area speed times velocity along the chord.
    pub axial_coefficient: f64,
    /// Side force over rho/2 area speed times velocity across the chord.
    pub side_coefficient: f64,
    /// Its side force acts this far ahead of the moment centre, m.
    pub arm_m: f64,
    /// Area, m2.
    pub area_m2: f64,
    /// What hangs below the balance when no model is fitted, kg.
    pub mass_kg: f64,
}

/// Zero of one day: what the channels show at the begin of the day and the hourly drift; AF N, SF N, YM N m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DayZero {
    /// At the begin of the day.
    pub at_begin: [f64; 3],
    /// Change per hour.
    pub per_hour: [f64; 3],
}

/// The balance as it truly is.
#[derive(Debug, Clone)]
pub(super) struct Balance {
    /// Force = matrix (reading - zero).
    pub interaction: [[f64; 3]; 3],
    to_reading: Matrix3<f64>,
    pub strut: Strut,
    pub days: Vec<DayZero>,
    /// Random walk of each day's zeros in steps of [`WALK_STEP_H`]; empty where they do not walk.
    walk: Vec<Vec<[f64; 3]>>,
}

impl Balance {
    pub(super) fn draw(stream: &mut Stream, days: usize, hidden: &Hidden, zero_drift: [f64; 3]) -> Self {
        let mut interaction = [[0.0; 3]; 3];
        for (i, row) in interaction.iter_mut().enumerate() {
            for (j, element) in row.iter_mut().enumerate() {
                let drawn = if i == j { 1.0 + 0.01 * stream.normal() } else { 0.012 * stream.normal() };
                // The manifest prints five places, and they are the matrix.
                *element = (drawn * 1e5).round() / 1e5;
            }
        }
        let rows = interaction.map(|row| Vector3::from(row).transpose());
        let to_reading = Matrix3::from_rows(&rows).try_inverse().unwrap_or_else(Matrix3::identity);

        let drawn_force = stream.between(1.0, 2.0);
        let force = hidden.untared_strut_n.unwrap_or(drawn_force);
        let strut = Strut {
            axial_coefficient: force / (0.5 * Water::fresh(15.0).density_kg_m3 * STRUT_AREA_M2 * 4.0),
            side_coefficient: stream.between(0.9, 1.5),
            arm_m: stream.between(-0.01, 0.01),
            area_m2: STRUT_AREA_M2,
            mass_kg: 2.5,
        };
        let days = (0..days)
            .map(|_| DayZero {
                at_begin: [4.0, 6.0, 3.0].map(|spread| spread * stream.normal()),
                per_hour: zero_drift.map(|spread| spread * stream.normal()),
            })
            .collect();
        Self { interaction, to_reading, strut, days, walk: Vec::new() }
    }

    /// Lets the zeros walk, by so much in an hour (a standard deviation).
    pub(super) fn walk(&mut self, per_root_hour: [f64; 3], stream: &mut Stream) {
        if per_root_hour == [0.0; 3] {
            return;
        }
        let steps = (LONGEST_DAY_H / WALK_STEP_H) as usize;
        self.walk = (0..self.days.len())
            .map(|_| {
                let mut at = [0.0; 3];
                (0..=steps)
                    .map(|_| {
                        let here = at;
                        (0..3).for_each(|i| at[i] += per_root_hour[i] * WALK_STEP_H.sqrt() * stream.normal());
                        here
                    })
                    .collect()
            })
            .collect();
    }

    /// What the channels show without load, `hours` after the begin of `day`.
    pub(super) fn zero(&self, day: usize, hours: f64, hidden: &Hidden) -> [f64; 3] {
        let DayZero { at_begin, per_hour } = self.days[day];
        let mut zero = [0, 1, 2].map(|i| at_begin[i] + per_hour[i] * hours);
        if let Some(walk) = self.walk.get(day) {
            let place = (hours / WALK_STEP_H).min(walk.len() as f64 - 1.001);
            let (from, share) = (place as usize, place.fract());
            (0..3).for_each(|i| zero[i] += walk[from][i] + share * (walk[from + 1][i] - walk[from][i]));
        }
        if let Some(warm_up) = hidden.warm_up {
            let run_away =
                warm_up.rate_per_hour * warm_up.time_constant_h * (1.0 - (-hours / warm_up.time_constant_h).exp());
            zero[warm_up.channel] += run_away;
        }
        zero
    }

    /// What the channels show under a load about the stated moment centre: of the water and of inertia on everything
    /// below the balance.
    #[inline]
    pub(super) fn reading(&self, load: Loads, zero: &[f64; 3], hidden: &Hidden) -> [f64; 3] {
        // AF counts aft; a moment centre further aft sees the side force on a longer lever ahead of it.
        let force = Vector3::new(-load.x, load.y, load.n + hidden.moment_centre_error_m * load.y);
        let side = force.y / (1.0 + hidden.softening_per_n * force.y.abs());
        let force = Vector3::new(force.x + hidden.af_from_sf * force.y, side, force.z);
        let shown = self.to_reading * force;
        [shown.x + zero[0], shown.y + zero[1], shown.z + zero[2]]
    }
}

impl Strut {
    /// Force of the water on the strut about the moment centre; `u`, `v` of the strut through the water.
    #[inline]
    pub(super) fn force_of_water(&self, u: f64, v: f64, water: &Water) -> Loads {
        let scale = -0.5 * water.density_kg_m3 * self.area_m2 * (u * u + v * v).sqrt();
        let y = scale * self.side_coefficient * v;
        Loads { x: scale * self.axial_coefficient * u, y, n: self.arm_m * y }
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::Purpose;
    use super::*;

    /// Force = C (reading - zero), element by element as the manifest states C.
    #[test]
    fn stated_matrix_turns_readings_into_forces() {
        let balance = Balance::draw(&mut Stream::new(3, Purpose::Balance), 2, &Hidden::default(), [0.1; 3]);
        let zero = balance.zero(1, 3.0, &Hidden::default());
        let reading = balance.reading(Loads { x: -7.0, y: 12.0, n: -5.0 }, &zero, &Hidden::default());
        for (row, force) in balance.interaction.iter().zip([7.0, 12.0, -5.0]) {
            let sum: f64 = (0..3).map(|j| row[j] * (reading[j] - zero[j])).sum();
            assert!((sum - force).abs() < 1e-12);
        }
    }

    /// A moment about a point further aft: N_P = N_MC + distance * SF, as for the transfer to the centre of buoyancy.
    #[test]
    fn moment_centre_further_aft_adds_side_force_times_distance() {
        let mut balance = Balance::draw(&mut Stream::new(3, Purpose::Balance), 1, &Hidden::default(), [0.1; 3]);
        balance.to_reading = Matrix3::identity();
        let hidden = Hidden { moment_centre_error_m: 0.02, ..Hidden::default() };
        let reading = balance.reading(Loads { x: 0.0, y: 10.0, n: 1.0 }, &[0.0; 3], &hidden);
        assert!((reading[2] - 1.2).abs() < 1e-12);
    }
}
