//! From a campaign to a vehicle: what `tank-reduce` writes is what `glidepolar assemble` takes, and the answer about one
//! external sensor has all its rows.

mod support;

use clap::Parser;
use glidepolar::cli::{self, Cli};
use glidepolar::vehicle::Vehicle;

#[test]
fn a_reduced_campaign_becomes_a_vehicle_with_and_without_a_sensor() {
    let (folder, results, truth) = support::campaign(31, &["LDR8.5"], &[]);
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(at("fits.json"), serde_json::to_vec(&results.reduction()).unwrap()).unwrap();
    let assemble = |more: &[&str]| {
        let (fits, json, vehicle) = (at("fits.json"), at("answer.json"), at("vehicle.toml"));
        let mut arguments = vec!["glidepolar", "assemble", &fits, "--hull", "LDR8.5", "--quiet", "--force"];
        arguments.extend([
            "--json",
            &json,
            "-o",
            &vehicle,
            "--base",
            "seaglider",
            "--battery-Wh",
            "4000",
            "--tow-speed-m-s",
            "2",
        ]);
        arguments.extend(["--wing", "span_m=1.01,chord_m=0.12,sweep_deg=43,aft_m=0.88"]);
        arguments.extend(["--fin", "span_m=0.25,chord_m=0.12,sweep_deg=30,aft_m=1.6"]);
        arguments.extend(more);
        cli::run(Cli::try_parse_from(arguments).unwrap()).unwrap();
        let answer: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
        (answer, Vehicle::load(&vehicle).unwrap())
    };
    let sensor = "drag_area_m2=0.002,drag_area_se_m2=0.0005,aft_m=1.0,starboard_m=-0.15,below_m=0.05,power_W=0.2";
    let (answer, vehicle) = assemble(&["--sensor", sensor]);

    // The vehicle carries the hull's own measured figures: added mass is -Yvdot' rho L^3/2 and the wing's.
    let hull = &truth.hulls[0];
    let row = &results.hulls[0].hull;
    let lift = answer["build"]["terms"].as_array().unwrap().iter().map(|t| t["a_per_rad"]["value"].as_f64().unwrap());
    assert!((vehicle.get("hydro.a_per_rad").unwrap() - lift.sum::<f64>()).abs() < 1e-9);
    let of_hull = &answer["build"]["terms"][0];
    assert!((of_hull["a_per_rad"]["value"].as_f64().unwrap() / hull.coefficients.a - 1.0).abs() < 0.02);
    let density = vehicle.get("mass.reference_density_kg_m3").unwrap();
    let across = -hull.dynamic.yvdot * 0.5 * density * row.geometry.loa_m.powi(3);
    assert!((of_hull["m3_kg"]["value"].as_f64().unwrap() / across - 1.0).abs() < 0.02);

    // Before, after, change: the sensor slows, steepens, and takes rudder and way.
    let of = |name: &str, i: usize| answer["sensor"][name][i]["value"].as_f64().unwrap();
    for name in ["speed_m_s", "horizontal_velocity_m_s"] {
        assert!(of(name, 1) < of(name, 0), "{name}");
        assert!((of(name, 1) - of(name, 0) - of(name, 2)).abs() < 1e-9, "{name}");
        // The change is known better than either, which share the uncertainty of the polar.
        let se = |i: usize| answer["sensor"][name][i]["se"].as_f64().unwrap();
        assert!(se(2) > 0.0 && se(2) < se(0), "{name}");
    }
    assert!(of("glide_angle_deg", 1).abs() > of("glide_angle_deg", 0).abs());
    let rudder = answer["sensor"]["rudder_deg"]["value"].as_f64().unwrap();
    assert!((0.01..5.0).contains(&rudder), "{rudder}");
    // Days may even rise, since a slower glider pumps less often: what a sensor surely takes is the way.
    let endurance = |name: &str, i: usize| answer["sensor"]["endurance"][name][i]["value"].as_f64().unwrap();
    assert!(endurance("days", 0) > 1.0 && endurance("days", 0) != endurance("days", 1));
    assert!(endurance("distance_km", 1) < endurance("distance_km", 0));

    // The wing alone does not turn this hull into the flow; a tail does.
    assert_eq!(answer["build"]["pitch"]["is_stable"], false);
    // What weight has to hold, by hand: rho/2 V^2 A L d at the glide speed of 0.35 m/s.
    let (area, d) = (row.frontal_area_m2(), answer["build"]["total"]["d_per_rad"]["value"].as_f64().unwrap());
    let moment = 0.5 * density * 0.35 * 0.35 * area * row.geometry.loa_m * d;
    let stated = answer["build"]["pitch"]["holding_moment_N_m_per_rad"].as_f64().unwrap();
    assert!(d > 0.0 && (stated / moment - 1.0).abs() < 1e-9, "{stated} {moment}");
    let (answer, _) = assemble(&["--tail", "span_m=0.4,chord_m=0.1,sweep_deg=20,aft_m=1.55"]);
    let pitch = &answer["build"]["pitch"];
    assert_eq!((&pitch["is_stable"], &pitch["holding_moment_N_m_per_rad"]), (&true.into(), &0.0.into()));
    // Lift at the neutral point makes the moment: a x = -d L.
    let total = |name: &str| answer["build"]["total"][name]["value"].as_f64().unwrap();
    let arm = pitch["neutral_point_aft_of_cb_m"].as_f64().unwrap() / row.geometry.loa_m;
    assert!((total("a_per_rad") * arm + total("d_per_rad")).abs() < 1e-9);
}

#[test]
fn a_hull_that_was_not_reduced_is_answered_with_those_that_were() {
    let (folder, results, _) = support::campaign(31, &["LDR8.5"], &[]);
    let fits = folder.path().join("fits.json").to_str().unwrap().to_owned();
    std::fs::write(&fits, serde_json::to_vec(&results.reduction()).unwrap()).unwrap();
    let wing = "span_m=1.01,chord_m=0.12,sweep_deg=43,aft_m=0.88";
    let fin = "span_m=0.25,chord_m=0.12,sweep_deg=30,aft_m=1.6";
    let arguments = ["glidepolar", "assemble", &fits, "--hull", "LDR8", "--wing", wing, "--fin", fin, "--quiet"];
    let error = cli::run(Cli::try_parse_from(arguments).unwrap()).unwrap_err().to_string();
    assert!(error.contains("has no hull LDR8 (did you mean LDR8.5?); its hulls are: LDR8.5"), "{error}");
}
