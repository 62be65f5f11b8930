//! The glider in six degrees of freedom through given inputs: its state, what follows from it, and where on the earth it is.
//! Equations, integrator and names are those of the FMU `UnderwaterGlider3D`.

use glidepolar_ode::{IntegrationError, Integrator};

use super::schedule::Schedule;
use crate::glide::start;
use crate::spatial::{Body, Inputs, SpatialGlider, State, Steering};

/// The names of the columns of a [`Row`].
pub const COLUMNS: [&str; 27] = [
    "time",
    "depth_m",
    "north_m",
    "east_m",
    "lat_deg",
    "lon_deg",
    "roll_rad",
    "pitch_rad",
    "heading_rad",
    "v1_m_s",
    "v2_m_s",
    "v3_m_s",
    "p_rad_s",
    "q_rad_s",
    "r_rad_s",
    "glide_angle_rad",
    "angle_of_attack_rad",
    "sideslip_rad",
    "turn_rate_rad_s",
    "speed_m_s",
    "vertical_velocity_m_s",
    "net_mass_kg",
    "ballast_mass_kg",
    "moving_mass_position_m",
    "roll_mass_rad",
    "rudder_rad",
    "energy_J",
];

/// One moment, in the order of [`COLUMNS`].
pub type Row = [f64; COLUMNS.len()];

/// The value of a column in a row; not a number where there is no such column.
pub fn column(row: &Row, name: &str) -> f64 {
    COLUMNS.iter().position(|column| *column == name).map_or(f64::NAN, |i| row[i])
}

/// Where on the earth a run begins.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Origin {
    /// Latitude \[deg\].
    pub latitude_deg: f64,
    /// Longitude \[deg\].
    pub longitude_deg: f64,
}

/// Axes of the earth's ellipsoid, WGS 84: large half axis \[m\] and the square of the eccentricity.
const HALF_AXIS_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_14e-3;

impl Origin {
    /// Latitude and longitude of a place so far north and east \[deg\], by the curvatures at the middle latitude: within 1e-4
    /// of the way over some hundred kilometres.
    pub fn place_deg(&self, north_m: f64, east_m: f64) -> [f64; 2] {
        let latitude = |middle_deg: f64| self.latitude_deg + (north_m / radii_m(middle_deg)[0]).to_degrees();
        let middle = 0.5 * (self.latitude_deg + latitude(self.latitude_deg));
        let [_, prime] = radii_m(middle);
        [latitude(middle), self.longitude_deg + (east_m / (prime * middle.to_radians().cos())).to_degrees()]
    }

    /// How far north and east a place is \[m\], the inverse of [`Origin::place_deg`].
    pub fn way_m(&self, latitude_deg: f64, longitude_deg: f64) -> [f64; 2] {
        let middle = 0.5 * (self.latitude_deg + latitude_deg);
        let [meridian, prime] = radii_m(middle);
        // The short way round.
        let east = (longitude_deg - self.longitude_deg + 540.0).rem_euclid(360.0) - 180.0;
        [
            (latitude_deg - self.latitude_deg).to_radians() * meridian,
            east.to_radians() * prime * middle.to_radians().cos(),
        ]
    }
}

/// Radii of curvature along the meridian and across it \[m\].
fn radii_m(latitude_deg: f64) -> [f64; 2] {
    let sin = latitude_deg.to_radians().sin();
    let root = (1.0 - ECCENTRICITY_SQUARED * sin * sin).sqrt();
    [HALF_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / (root * root * root), HALF_AXIS_M / root]
}

/// How a run is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceSettings {
    /// Who gives rudder and roll mass their set-points.
    pub steering: Steering,
    /// End \[s\].
    pub stop_s: f64,
    /// Time between two rows \[s\].
    pub interval_s: f64,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
    /// Where it begins.
    pub origin: Origin,
}

/// Flies a glider from its straight glide down, heading north, through the schedule and hands over each row; `on_row` ends
/// the flight early by returning `false`.
///
/// # Errors
/// Where the equations give no finite rate of change; the rows up to there have been handed over.
pub fn fly(
    body: &Body<f64>,
    schedule: &Schedule,
    settings: &SpaceSettings,
    mut on_row: impl FnMut(&Row) -> bool,
) -> Result<(), IntegrationError> {
    let begin = start(&body.plane);
    let (mut state, otherwise) = (State::in_glide(&begin.state), Inputs::in_glide(&begin.inputs));
    let mut glider = SpatialGlider::new(*body, settings.steering, otherwise);
    let mut integrator = Integrator::new(settings.tolerance);
    let (mut time, mut rows) = (0.0, 0u64);
    let mut until = give(&mut glider, schedule, time, &otherwise);
    if !on_row(&row(&glider, time, &state, settings.origin)) {
        return Ok(());
    }
    while time < settings.stop_s {
        let next_row = ((rows + 1) as f64 * settings.interval_s).min(settings.stop_s);
        glider.fly(&mut integrator, &mut time, &mut state, next_row.min(until))?;
        if time >= until {
            until = give(&mut glider, schedule, time, &otherwise);
            integrator.restart();
        }
        if time >= next_row {
            rows += 1;
            if !on_row(&row(&glider, time, &state, settings.origin)) {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// Gives the glider the inputs that hold from a time on. Returns when their course changes next.
fn give(glider: &mut SpatialGlider, schedule: &Schedule, time_s: f64, otherwise: &Inputs<f64>) -> f64 {
    let Some(course) = schedule.from(time_s, otherwise.as_array()) else { return f64::INFINITY };
    glider.inputs = Inputs::from_array(course.values);
    glider.input_rates = course.rates.map(Inputs::from_array);
    glider.inputs_at_s = course.from_s;
    course.until_s.unwrap_or(f64::INFINITY)
}

/// One row: the state and what follows from it.
pub fn row(glider: &SpatialGlider, time_s: f64, s: &State<f64>, origin: Origin) -> Row {
    let out = glider.outputs(time_s, s);
    let [latitude, longitude] = origin.place_deg(s.north_m, s.east_m);
    [
        time_s,
        s.depth_m,
        s.north_m,
        s.east_m,
        latitude,
        longitude,
        s.roll_rad,
        s.pitch_rad,
        s.heading_rad,
        s.v1_m_s,
        s.v2_m_s,
        s.v3_m_s,
        s.p_rad_s,
        s.q_rad_s,
        s.r_rad_s,
        out.glide_angle_rad,
        out.angle_of_attack_rad,
        out.sideslip_rad,
        out.turn_rate_rad_s,
        out.speed_m_s,
        out.vertical_velocity_m_s,
        out.net_mass_kg,
        s.ballast_mass_kg,
        s.moving_mass_m,
        s.roll_mass_rad,
        s.rudder_rad,
        s.energy_J,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::Vehicle;
    use std::path::Path;

    fn column(name: &str) -> usize {
        COLUMNS.iter().position(|column| *column == name).unwrap()
    }

    #[test]
    fn a_place_and_the_way_to_it_are_inverse_and_a_mile_is_a_mile() {
        let origin = Origin { latitude_deg: 58.0, longitude_deg: 179.9 };
        for (north, east) in [(0.0, 0.0), (50e3, 20e3), (-80e3, 60e3)] {
            let [latitude, longitude] = origin.place_deg(north, east);
            let [n, e] = origin.way_m(latitude, longitude);
            assert!((n - north).abs() < 1.0 && (e - east).abs() < 1.0, "{n} {e}");
        }
        // A minute of latitude at 45 deg: 1852.2 m; of longitude at the equator 1855.3 m.
        let [north, _] = Origin { latitude_deg: 45.0, longitude_deg: 0.0 }.way_m(45.0 + 1.0 / 60.0, 0.0);
        assert!((north - 1852.2).abs() < 0.5, "{north}");
        let [_, east] = Origin::default().way_m(0.0, 1.0 / 60.0);
        assert!((east - 1855.3).abs() < 0.1, "{east}");
    }

    #[test]
    fn a_rudder_from_a_table_turns_it_and_back() {
        let body = Vehicle::load("slocum-graver").unwrap().body().unwrap();
        let text = "time,rudder_command_rad\n0,0\n50,0\n50,0.2\n150,0.2\n150,0\n";
        let schedule = Schedule::of_names(Inputs::NAMES, text, Path::new("inputs.csv")).unwrap();
        let settings = SpaceSettings {
            steering: Steering::Direct,
            stop_s: 300.0,
            interval_s: 50.0,
            tolerance: 1e-8,
            origin: Origin::default(),
        };
        let mut rows = Vec::new();
        fly(&body, &schedule, &settings, |row| {
            rows.push(*row);
            true
        })
        .unwrap();
        let heading = |i: usize| rows[i][column("heading_rad")];
        assert_eq!((rows.len(), heading(1)), (7, 0.0));
        assert!(heading(3) > 1.0, "{}", heading(3));
        assert!((heading(6) - heading(5)).abs() < 1e-3, "{} {}", heading(5), heading(6));
    }
}
