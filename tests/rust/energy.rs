//! The energy account: the same in a plan, a simulation and the FMU; and against the battery counters of a Seaglider at sea,
//! SG542, South Atlantic, dives 304 to 317.

#![allow(non_snake_case, reason = "units stand in names as they are written: J")]

use glidepolar::dynamics::Parameters;
use glidepolar::plan::{Dive, PerDive, WATER_COMPRESSIBILITY_PER_PA, per_dive};
use glidepolar::simulate::COLUMNS;
use glidepolar::simulate::mission::{Flight, LegKind, LegOrder, Mission, Moment, fly_mission};
use glidepolar::vehicle::Vehicle;
use glidepolar_fmu::model::Model;
use glidepolar_tests::{Built, measured_data};
use importer::{Glider3, Options};
use std::path::Path;
use std::process::Command;

#[path = "../../fmu/tests/support/mod.rs"]
mod importer;

const SURFACE_KG_M3: f64 = 1025.0;

fn density_kg_m3(depth_m: f64) -> f64 {
    SURFACE_KG_M3 * (1.0 + WATER_COMPRESSIBILITY_PER_PA * SURFACE_KG_M3 * 9.81 * depth_m.max(0.0))
}

/// A glider of which every consumer has a share of a dive's energy that no tolerance hides.
fn energetic() -> Vehicle {
    let mut vehicle = Vehicle::load("slocum-049").unwrap();
    for (path, value) in [
        ("energy.hotel_W", 0.5),
        ("energy.pump_J_per_dbar_cc", 0.02),
        ("energy.pump_J_per_cc", 2.0),
        ("energy.rudder_W", 0.4),
        ("energy.pitch_move_J", 300.0),
        ("energy.surfacing_J", 800.0),
        // A motor slow enough for every move to be a whole one: the shortest takes most of a second.
        ("moving_mass.rate_m_s", 0.006),
    ] {
        vehicle.set(path, value).unwrap();
    }
    vehicle
}

/// Dives to 180 m, each with a stay of ten minutes, without corrections of the pitch.
fn mission() -> Mission {
    let density: Vec<String> = [0.0, 60.0, 120.0, 180.0].map(|depth| density_kg_m3(depth).to_string()).into();
    let text = format!(
        "name = \"x\"\n[voyage]\nduration_h = 24\n[dive]\nmax_depth_m = 180\n[glide]\npitch_down_deg = -25\n\
         pitch_up_deg = 25\nballast_down_cc = -220\nballast_up_cc = 220\n[surfacing]\nstay_min = 10\n[control]\ndeadband_deg = 45\n\
         [water]\ndepth_m = [0, 60, 120, 180]\ndensity_kg_m3 = [{}]\n",
        density.join(", ")
    );
    Mission::parse(&text, Path::new("x")).unwrap()
}

/// The mission to the end of its third stay at the surface, with all its moments.
fn three_dives(p: &Parameters<f64>) -> (Flight, Vec<Moment>) {
    let whole = fly_mission(p, &mission(), 600.0, 1e-6, |_| true).unwrap();
    let third = whole.legs.iter().filter(|leg| leg.kind == LegKind::Surface && leg.start_s > 0.0).nth(2).unwrap();
    let mut moments = Vec::new();
    let mut mission = mission();
    // Before the order of the next descent.
    mission.duration_s = third.end_s - 0.1;
    let flight = fly_mission(p, &mission, 5.0, 1e-6, |moment| {
        moments.push(*moment);
        true
    });
    (flight.unwrap(), moments)
}

/// The same flight by the FMU, given the simulation's commands at the simulation's times.
fn flown_by_the_fmu(p: &Parameters<f64>, flight: &Flight, moments: &[Moment]) -> f64 {
    let column = |name: &str| COLUMNS.iter().position(|column| *column == name).unwrap();
    let (time, mass) = (column("time"), column("moving_mass_position_m"));
    let begin = moments[0].row;
    let glider = Glider3::of(Model::Plane, Options::default());
    let is_published = |name: &str| Model::Plane.table().rows.iter().any(|variable| variable.name == name);
    let parameters = Parameters::<f64>::NAMES.iter().copied().zip(p.as_array());
    let parameters: Vec<(&str, f64)> = parameters.filter(|(name, _)| is_published(name)).collect();
    glider.set(&parameters);
    let states = ["depth_m", "pitch_rad", "v1_m_s", "v3_m_s", "ballast_mass_kg", "moving_mass_position_m"];
    glider.set(&states.map(|name| (name, begin[column(name)])));
    // Afloat, as the mission begins: at depth 0 itself the FMU's glider would come up and pay for it.
    glider.set(&[("depth_m", -1e-3)]);
    glider.begin(None);
    for leg in &flight.legs {
        // At the end of a leg its commands have long been followed.
        let last = moments.iter().rfind(|moment| moment.row[time] <= leg.end_s).unwrap();
        let ballast_m3 = if leg.kind == LegKind::Descent { -220e-6 } else { 220e-6 };
        let steps = ((leg.end_s - leg.start_s) / 5.0).ceil();
        let size = (leg.end_s - leg.start_s) / steps;
        for i in 0..steps as usize {
            glider.set(&[
                ("ballast_command_m3", ballast_m3),
                ("moving_mass_command_m", last.row[mass]),
                ("water_density_kg_m3", density_kg_m3(glider.get("depth_m"))),
            ]);
            let start_s = leg.start_s + i as f64 * size;
            assert_eq!(glider.step(start_s, size).status, importer::OK, "{:?}", glider.environment.messages.take());
        }
    }
    glider.get("energy_J")
}

/// Simulation and FMU integrate the same power with other steps, the FMU in water that is given every 5 s: 0.5 %. The plan
/// takes steady glides, closed forms for turns, strokes of the pump at the depth of the turn and whole moves: 4 %.
#[test]
fn a_plan_a_simulation_and_the_fmu_count_the_same_energy() {
    let p = energetic().parameters().unwrap();
    let (flight, moments) = three_dives(&p);
    let leg = |pitch_deg: f64, cc: f64| LegOrder { pitch_rad: pitch_deg.to_radians(), ballast_m3: cc * 1e-6 };
    let planned: PerDive = per_dive(
        &p,
        &Dive {
            depth_m: 180.0,
            descent: leg(-25.0, -220.0),
            ascent: leg(25.0, 220.0),
            surface_ballast_m3: 220e-6,
            dives_per_surfacing: 1.0,
            stay_s: 600.0,
            // Down, up, and level at the surface.
            pitch_moves: 3.0,
            surface_density_kg_m3: SURFACE_KG_M3,
        },
    )
    .unwrap();
    let simulated = flight.energy;
    for (name, planned_J, simulated_J) in [
        ("hotel", planned.energy.hotel_J, simulated.hotel_J),
        ("pump", planned.energy.pump_J, simulated.pump_J),
        ("steering", planned.energy.steering_J, simulated.steering_J),
        ("surfacing", planned.energy.surfacing_J, simulated.surfacing_J),
    ] {
        let ratio = 3.0 * planned_J / simulated_J;
        assert!((ratio - 1.0).abs() < 0.04, "{name}: {ratio} of a plan's to a simulation's");
        assert!(simulated_J > 0.07 * simulated.total_J(), "{name} is too small to be tested: {simulated:?}");
    }
    let of_fmu_J = flown_by_the_fmu(&p, &flight, &moments);
    let ratio = of_fmu_J / simulated.total_J();
    assert!((ratio - 1.0).abs() < 5e-3, "{ratio} of the FMU's {of_fmu_J} J to a simulation's {simulated:?}");
}

#[test]
fn a_held_out_dive_is_predicted_within_five_per_cent_of_its_charge() {
    let (Some(program), Some(data)) = (Built::Glidepolar.path(), measured_data()) else {
        return;
    };
    let output = Command::new(program)
        .args(["plan", "seaglider", "--json", "-", "--moves"])
        .arg(data.join("sg542_motor_moves.csv"))
        .arg("--dives")
        .arg(data.join("sg542_dives.csv"))
        .output()
        .expect("glidepolar starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    let calibration = &report["calibration"];
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    assert_eq!((calibration["pump"]["strokes"].as_u64(), calibration["dives"]["dives"].as_u64()), (Some(57), Some(13)));

    let left_out = number(&calibration["dives"]["charge_error_left_out"]);
    let of_the_mean = number(&calibration["dives"]["charge_error_of_the_mean"]);
    assert!(left_out <= 0.05, "{left_out}");
    assert!(left_out < 0.5 * of_the_mean, "{left_out} against {of_the_mean} of the plain mean");
    assert!(number(&calibration["pump"]["relative_rms"]) <= 0.073);
    // The counters' own bill: what the pump's motor took, the battery gave; hotel power is what a Seaglider's is.
    let factor = &calibration["dives"]["pump_factor"]["ci95"];
    assert!(number(&factor[0]) < 1.0 && number(&factor[1]) > 1.0, "{factor}");
    assert!((0.05..0.5).contains(&number(&calibration["dives"]["hotel_W"]["value"])));
}
