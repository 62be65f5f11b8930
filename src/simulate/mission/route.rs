//! A mission flown in space: dives as in the plane, and a heading held from waypoint to waypoint.
//!
//! At each look, every `period_s`, the autopilot compares the heading with the course to the next waypoint. Within the dead
//! band rudder or roll mass go amidships; beyond it they take the angle that closes the error within a minute or so
//! ([`with_gains`]). Between looks nothing moves: what pilots call a turn.

use glidepolar_ode::{Advance, Integrator};

use super::Mission;
use super::account::Ending;
use super::pilot::Pilot;
use super::route_account::{Account, RouteError, RouteMoment};
use super::space_course::N_EVENTS;
use crate::spatial::{Body, State};

/// Flies a mission in space, handing over a moment every `interval_s`; `on_moment` ends it by returning `false`.
///
/// # Errors
/// Where a leg cannot be flown at all, nothing steers to the waypoints, or the equations give no finite rate of change.
pub fn fly_route(
    body: &Body<f64>,
    mission: &Mission,
    interval_s: f64,
    tolerance: f64,
    mut on_moment: impl FnMut(&RouteMoment) -> bool,
) -> Result<Account, RouteError> {
    let mut pilot = Pilot::new(body, mission)?;
    let mut integrator = Integrator::new(tolerance);
    let mut rows = 1.0;
    if !on_moment(&pilot.moment()) {
        return Ok(pilot.end(Ending::Stopped));
    }
    loop {
        let next_row = rows * interval_s;
        let next_change = pilot.next_change_s().min(mission.duration_s);
        let (mut time_s, mut state) = (pilot.time_s, pilot.state.as_array());
        let advance =
            integrator.follow(&pilot.course, &mut time_s, &mut state, next_row.min(next_change), next_change)?;
        let before = (pilot.time_s, pilot.state.depth_m);
        (pilot.time_s, pilot.state) = (time_s, State::from_array(state));
        pilot.spent.carried(pilot.time_s - before.0, [before.1, pilot.state.depth_m]);
        let which = match advance {
            Advance::Reached => [false; N_EVENTS],
            Advance::Event(which) => which,
        };
        if pilot.decide(which) {
            integrator.restart();
        }
        if let Some(ending) = pilot.ending {
            on_moment(&pilot.moment());
            return Ok(pilot.end(ending));
        }
        if pilot.time_s >= next_row {
            glidepolar_progress::one_more("rows");
            rows += 1.0;
            if !on_moment(&pilot.moment()) {
                return Ok(pilot.end(Ending::Stopped));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::space::COLUMNS;
    use crate::vehicle::Vehicle;
    use std::path::Path;

    const SQUARE: &str = "name = \"Square\"\n[voyage]\nduration_h = 30.0\n[dive]\nmax_depth_m = 100.0\n[glide]\n\
        pitch_down_deg = -25.0\npitch_up_deg = 25.0\nballast_down_cc = -220.0\nballast_up_cc = 220.0\n[surfacing]\n\
        every_h = 3.0\n";

    fn fly(vehicle: &str, more: &str) -> (Account, Vec<RouteMoment>) {
        let mission = Mission::parse(&format!("{SQUARE}{more}"), Path::new("square.toml")).unwrap();
        let body = Vehicle::load(vehicle).unwrap().body().unwrap();
        let mut moments = Vec::new();
        let account = fly_route(&body, &mission, 30.0, 1e-7, |moment| {
            moments.push(*moment);
            true
        })
        .unwrap();
        (account, moments)
    }

    fn value(moment: &RouteMoment, name: &str) -> f64 {
        moment.row[COLUMNS.iter().position(|column| *column == name).unwrap()]
    }

    #[test]
    fn every_waypoint_is_reached_against_a_current_across_it() {
        let way = "[route]\nnorth_km = [2.0, 2.0, 0.0]\neast_km = [0.0, 2.0, 2.0]\n[current]\n\
            depth_m = [0.0, 100.0]\neast_m_s = [0.06, 0.02]\n";
        let (account, moments) = fly("slocum-049", way);
        assert_eq!((account.ended_by, account.waypoints_reached), (Ending::Distance, 3), "{account:?}");
        for (north, east) in [(2e3, 0.0), (2e3, 2e3), (0.0, 2e3)] {
            let nearest = moments
                .iter()
                .map(|moment| (value(moment, "north_m") - north).hypot(value(moment, "east_m") - east))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 215.0, "{nearest} m from {north} {east}");
        }
        // From circle to circle about the waypoints it is 5.4 km.
        assert!(account.distance_m > 5.2e3 && account.steering_moves > 0 && account.dives > 5, "{account:?}");
    }

    #[test]
    fn a_roll_mass_steers_on_both_legs() {
        let (account, _) = fly("seaglider", "[route]\nnorth_km = [0.5, -1.0]\neast_km = [1.5, 1.0]\n");
        assert_eq!((account.ended_by, account.waypoints_reached), (Ending::Distance, 2), "{account:?}");
    }

    #[test]
    fn without_waypoints_it_goes_straight_and_what_does_not_turn_says_so() {
        let (account, moments) = fly("slocum-049", "[route]\nstart_latitude_deg = 50.0\n");
        assert_eq!((account.ended_by, account.steering_moves, account.waypoints), (Ending::Duration, 0, 0));
        let last = moments.last().unwrap();
        assert!(value(last, "east_m").abs() < 1e-9 && value(last, "lat_deg") > 50.1);
        let mission = format!("{SQUARE}[route]\nnorth_km = 1.0\neast_km = 0.0\n[steering]\nactuator = 2\n");
        let mission = Mission::parse(&mission, Path::new("square.toml")).unwrap();
        let body = Vehicle::load("slocum-049").unwrap().body().unwrap();
        let refused = fly_route(&body, &mission, 30.0, 1e-7, |_| true).unwrap_err();
        assert_eq!(refused, RouteError::NothingSteers("roll mass"));
    }
}
