//! A dive that was held out of a log, flown by a vehicle with the ballast, the pitch and the water that the log has.
//!
//! Ballast and water go into the equations as they were read. The moving mass is set so that the model's pitch becomes the
//! measured one: first where it balances that pitch at rest; then, flight after flight, by what the flight before was off.
//! What remains to be compared is the way down and up.

use std::fmt::Write;
use std::path::Path;

use glidepolar_virtual_sea::log::Log;

use crate::cli::CliError;
use crate::dynamics::Actuation;
use crate::glide::start;
use crate::simulate::{Row, Schedule, SimulationSettings, fly_from};
use crate::vehicle::Vehicle;

/// The flight begins where the glider is this deep: where the FMU begins, too \[m\].
const BEGIN_M: f64 = 10.0;

/// Flights in which the place of the moving mass is learnt.
const FLIGHTS: usize = 6;

/// Share of an error of the pitch that the next flight takes away, and the time over which errors are averaged \[s\].
const LEARNING: f64 = 0.7;
const SMOOTH_S: f64 = 20.0;

/// Time between two rows of a flight \[s\].
const INTERVAL_S: f64 = 4.0;

const PA_PER_DBAR: f64 = 1e4;

/// Vertical velocities are compared as means over this time \[s\].
const MEAN_S: f64 = 60.0;

/// The dive as it was measured, from [`BEGIN_M`] on.
#[derive(Debug, Clone, Default)]
pub(super) struct Dive {
    pub time_s: Vec<f64>,
    pub depth_m: Vec<f64>,
    pitch_rad: Vec<f64>,
    ballast_m3: Vec<f64>,
    density_kg_m3: Vec<f64>,
    temperature_C: Vec<f64>,
}

impl Dive {
    /// A dive of a log by its number, as far as the glider is under way; gravity \[m/s2\] makes depths of pressures.
    pub fn of(log: &Log, number: u32, gravity_m_s2: f64) -> Dive {
        let mut dive = Dive::default();
        let mut begin_s = None;
        for row in (0..log.len()).filter(|row| log.dive[*row] == number) {
            let depth_m = log.pressure_dbar[row] * PA_PER_DBAR / (log.density_kg_m3[row] * gravity_m_s2);
            let read = [depth_m, log.pitch_rad[row], log.vbd_cc[row], log.density_kg_m3[row], log.temperature_c[row]];
            if read.iter().any(|value| !value.is_finite()) || (begin_s.is_none() && depth_m < BEGIN_M) {
                continue;
            }
            if depth_m < 0.5 * BEGIN_M {
                break;
            }
            let begin_s = *begin_s.get_or_insert(log.time_s[row]);
            dive.time_s.push(((log.time_s[row] - begin_s) * 1e3).round() / 1e3);
            dive.depth_m.push(depth_m);
            dive.pitch_rad.push(read[1]);
            dive.ballast_m3.push(read[2] * 1e-6);
            dive.density_kg_m3.push(read[3]);
            dive.temperature_C.push(read[4]);
        }
        dive
    }

    /// Its end \[s\].
    pub fn end_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    /// Depths of a flight less those that were measured, at the times of the measurement \[m\].
    pub fn less_measured(&self, time_s: &[f64], depth_m: &[f64]) -> Vec<f64> {
        let model = interpolated(time_s, depth_m, &self.time_s);
        model.iter().zip(&self.depth_m).map(|(model, read)| model - read).collect()
    }

    /// The inputs of the FMU for these places of the moving mass, as a table.
    fn inputs(&self, moving_mass_m: &[f64]) -> String {
        let mut table =
            "time,ballast_command_m3,moving_mass_command_m,water_density_kg_m3,water_temperature_C\n".to_owned();
        for (row, mass) in moving_mass_m.iter().enumerate() {
            let (time, ballast) = (self.time_s[row], self.ballast_m3[row]);
            // Writing to a string cannot fail.
            let _ = writeln!(table, "{time},{ballast},{mass},{},{}", self.density_kg_m3[row], self.temperature_C[row]);
        }
        table
    }
}

/// The dive as a vehicle flies it.
pub(super) struct Flight {
    /// What went into the equations, as a table that FMPy and `glidepolar simulate` read.
    pub inputs: String,
    pub time_s: Vec<f64>,
    pub depth_m: Vec<f64>,
}

impl Flight {
    /// Flies the dive.
    ///
    /// # Errors
    /// Where the vehicle lacks what a simulation needs, or its equations give no finite rate of change.
    pub fn of(vehicle: &Vehicle, dive: &Dive) -> Result<Flight, CliError> {
        let parameters = vehicle.parameters()?;
        let p = &parameters;
        let mut begin = start(p);
        begin.state.depth_m = dive.depth_m[0];
        let settings = SimulationSettings {
            actuation: Actuation::Servo,
            stop_s: dive.end_s(),
            interval_s: INTERVAL_S,
            tolerance: 1e-8,
        };
        let height_m = p.moving_mass_height_m;
        let mut mass_m: Vec<f64> = dive.pitch_rad.iter().map(|pitch| -height_m * pitch.tan()).collect();
        let mut flown = (String::new(), Vec::<Row>::new());
        for flight in 0..FLIGHTS {
            if flight > 0 {
                let of_rows = |column: usize| flown.1.iter().map(|row| row[column]).collect::<Vec<f64>>();
                let pitch = interpolated(&of_rows(0), &of_rows(3), &dive.time_s);
                let off: Vec<f64> = pitch.iter().zip(&dive.pitch_rad).map(|(model, read)| model - read).collect();
                for ((mass, off), pitch) in mass_m.iter_mut().zip(running_mean(&dive.time_s, &off)).zip(&dive.pitch_rad)
                {
                    *mass += LEARNING * height_m / pitch.cos().powi(2) * off;
                }
            }
            mass_m.iter_mut().for_each(|mass| *mass = mass.clamp(p.moving_mass_min_m, p.moving_mass_max_m));
            let inputs = dive.inputs(&mass_m);
            let schedule = Schedule::parse(&inputs, Path::new("inputs.csv"))?;
            let mut rows = Vec::new();
            fly_from(&begin, p, &schedule, &settings, |row| {
                rows.push(*row);
                true
            })
            .map_err(|error| CliError::Failed(error.to_string()))?;
            flown = (inputs, rows);
        }
        let (inputs, rows) = flown;
        let (time_s, depth_m) = rows.iter().map(|row| (row[0], row[1])).unzip();
        Ok(Flight { inputs, time_s, depth_m })
    }
}

/// How far a flight is from the measured dive.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(super) struct Misfit {
    /// Root mean square of the difference in depth \[m\].
    pub depth_rms_m: f64,
    /// Root mean square of the difference of vertical velocities, means over a minute \[m/s\].
    pub vertical_velocity_rms_m_s: f64,
}

impl Misfit {
    /// Compares at the times of the measurement.
    pub fn of(dive: &Dive, time_s: &[f64], depth_m: &[f64]) -> Misfit {
        let off = dive.less_measured(time_s, depth_m);
        // The mean velocity over a minute is the change of depth over it.
        let later = |i: usize| dive.time_s.partition_point(|t| *t < dive.time_s[i] + MEAN_S);
        let changes: Vec<f64> = (0..off.len())
            .map(|i| (i, later(i)))
            .take_while(|(_, j)| *j < off.len())
            .map(|(i, j)| (off[j] - off[i]) / (dive.time_s[j] - dive.time_s[i]))
            .collect();
        Misfit { depth_rms_m: rms(&off), vertical_velocity_rms_m_s: rms(&changes) }
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Values at other places, on straight lines between those that are known; the ends go on.
fn interpolated(xs: &[f64], ys: &[f64], at: &[f64]) -> Vec<f64> {
    let value = |x: f64| {
        let after = xs.partition_point(|known| *known < x).clamp(1, xs.len() - 1);
        let (left, right) = (after - 1, after);
        let share = ((x - xs[left]) / (xs[right] - xs[left])).clamp(0.0, 1.0);
        ys[left] + share * (ys[right] - ys[left])
    };
    at.iter().map(|x| value(*x)).collect()
}

/// Means of the values within [`SMOOTH_S`] around each.
fn running_mean(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let half = 0.5 * SMOOTH_S;
    let around = |t: f64| {
        let first = time_s.partition_point(|other| *other < t - half);
        let last = time_s.partition_point(|other| *other <= t + half);
        values[first..last].iter().sum::<f64>() / (last - first) as f64
    };
    time_s.iter().map(|t| around(*t)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Dive, Flight, Misfit, interpolated, running_mean};
    use crate::vehicle::Vehicle;

    #[test]
    fn a_constant_offset_is_depth_and_a_slope_is_velocity() {
        let time_s: Vec<f64> = (0..100).map(|i| 10.0 * f64::from(i)).collect();
        let dive = Dive { depth_m: vec![50.0; 100], time_s: time_s.clone(), ..Dive::default() };
        let deeper = Misfit::of(&dive, &[0.0, 990.0], &[52.0, 52.0]);
        assert!((deeper.depth_rms_m - 2.0).abs() < 1e-12 && deeper.vertical_velocity_rms_m_s < 1e-12);
        let sinking = Misfit::of(&dive, &[0.0, 990.0], &[50.0, 50.0 + 0.01 * 990.0]);
        assert!((sinking.vertical_velocity_rms_m_s - 0.01).abs() < 1e-12);
        assert_eq!(interpolated(&[0.0, 2.0], &[1.0, 3.0], &[-1.0, 1.0, 5.0]), [1.0, 2.0, 3.0]);
        assert_eq!(running_mean(&[0.0, 8.0, 30.0], &[1.0, 3.0, 5.0]), [2.0, 2.0, 5.0]);
    }

    /// What the model itself flew is flown again: the place of its moving mass is found from its pitch alone.
    #[test]
    fn the_models_own_dive_is_found_again() {
        let vehicle = Vehicle::load("slocum-049").unwrap();
        let parameters = vehicle.parameters().unwrap();
        let begin = crate::glide::start(&parameters);
        let mut dive = Dive::default();
        let settings = crate::simulate::SimulationSettings {
            actuation: crate::dynamics::Actuation::Servo,
            stop_s: 400.0,
            interval_s: 4.0,
            tolerance: 1e-9,
        };
        crate::simulate::fly(&parameters, &crate::simulate::Schedule::default(), &settings, |row| {
            dive.time_s.push(row[0]);
            dive.depth_m.push(row[1]);
            dive.pitch_rad.push(row[3]);
            true
        })
        .unwrap();
        let rows = dive.time_s.len();
        dive.ballast_m3 = vec![begin.inputs.ballast_command_m3; rows];
        dive.density_kg_m3 = vec![parameters.reference_density_kg_m3; rows];
        dive.temperature_C = vec![parameters.reference_temperature_C; rows];
        let flight = Flight::of(&vehicle, &dive).unwrap();
        let misfit = Misfit::of(&dive, &flight.time_s, &flight.depth_m);
        assert!(misfit.depth_rms_m < 0.1, "{misfit:?}");
    }
}
