use super::calibrate::{DiveCount, Stroke, fit_dives, fit_pump};
use super::*;
use crate::glide::at_pitch;
use crate::simulate::mission::{LegOrder, Mission, fly_mission};
use crate::vehicle::Vehicle;

fn dive(depth_m: f64) -> Dive {
    let leg = |pitch_deg: f64, cc: f64| LegOrder { pitch_rad: pitch_deg.to_radians(), ballast_m3: cc * 1e-6 };
    Dive {
        depth_m,
        descent: leg(-25.0, -220.0),
        ascent: leg(25.0, 220.0),
        surface_ballast_m3: 220e-6,
        dives_per_surfacing: 1.0,
        stay_s: 0.0,
        pitch_moves: 4.0,
        surface_density_kg_m3: 1025.0,
    }
}

fn energetic() -> Vehicle {
    let mut vehicle = Vehicle::load("slocum-049").unwrap();
    for (path, value) in [
        ("energy.hotel_W", 0.5),
        ("energy.pump_J_per_dbar_cc", 0.02),
        ("energy.pump_J_per_cc", 2.0),
        ("energy.rudder_W", 0.1),
    ] {
        vehicle.set(path, value).unwrap();
    }
    vehicle
}

#[test]
fn a_rigid_glider_in_uniform_water_dives_as_its_steady_glide_says() {
    // Two dives, so that the start from rest, the same in both, drops out; shallow enough for the water's own
    // compressibility to be next to nothing: 4.3e-6 per 10 m of 50 kg, 0.2 g of 220 g.
    let p = energetic().parameters().unwrap();
    let one = per_dive(&p, &dive(1.0)).unwrap();
    let two = per_dive(&p, &dive(2.0)).unwrap();
    let metre_s = two.descent_s - one.descent_s;
    let water = Surroundings { density_kg_m3: 1025.0, pressure_Pa: 0.0, temperature_C: 15.0, time_s: 0.0 };
    let net_mass_kg = p.net_mass_kg(-220e-6, &water);
    let glide = at_pitch(&p, &water, Attitude { pitch_rad: -25f64.to_radians(), net_mass_kg }).unwrap();
    assert!((metre_s * glide.vertical_velocity_m_s - 1.0).abs() < 2e-3, "{metre_s}");
    // 440 cc against 1 m of water: 0.02 J/(dbar cc) at 0.1005 dbar, and 2 J/cc.
    let expected = 440.0 * (0.02 * 1025.0 * 9.81 / 1e4 + 2.0);
    assert!((one.energy.pump_J - expected).abs() < 1e-9 * expected, "{}", one.energy.pump_J);
    assert_eq!(one.pumpings, 1.0);
}

/// The same dives flown by the equations of motion: time, way and pump energy.
#[test]
fn the_plan_agrees_with_the_mission_flown() {
    let p = energetic().parameters().unwrap();
    let density: Vec<String> = (0..=3)
        .map(|i| format!("{}", 1025.0 * (1.0 + WATER_COMPRESSIBILITY_PER_PA * 1025.0 * 9.81 * f64::from(i) * 60.0)))
        .collect();
    let text = format!(
        "name = \"x\"\n[voyage]\nduration_h = 24\n[dive]\nmax_depth_m = 180\n[glide]\npitch_down_deg = -25\n\
         pitch_up_deg = 25\nballast_down_cc = -220\nballast_up_cc = 220\n[surfacing]\nstay_min = 10\n[control]\ndeadband_deg = 0.1\n\
         [water]\ndepth_m = [0, 60, 120, 180]\ndensity_kg_m3 = [{}]\n",
        density.join(", ")
    );
    let mission = Mission::parse(&text, std::path::Path::new("x")).unwrap();
    let flown = fly_mission(&p, &mission, 60.0, 1e-6, |_| true).unwrap();
    let surfacings = flown.legs.iter().filter(|leg| leg.ended_by == crate::simulate::mission::Turn::Surfaced);
    let last = surfacings.clone().next_back().unwrap();
    let dives = surfacings.count() as f64;
    let one = per_dive(&p, &Dive { stay_s: 600.0, ..dive(180.0) }).unwrap();
    // Up to the last surfacing there were as many dives, but one stay less.
    let (time, way) = ((last.end_s + 600.0) / dives, last.end_x_m / dives);
    assert!((one.duration_s / time - 1.0).abs() < 0.03, "{} against {time} s", one.duration_s);
    assert!((one.distance_m / way - 1.0).abs() < 0.03, "{} against {way} m", one.distance_m);
    let pump = flown.energy.pump_J / flown.pumpings as f64;
    assert!((one.energy.pump_J / pump - 1.0).abs() < 0.03, "{} against {pump} J", one.energy.pump_J);
}

#[test]
fn a_sensor_costs_days_by_its_power_and_way_by_its_drag() {
    let vehicle = energetic();
    let ask = Ask {
        dive: Dive { dives_per_surfacing: 5.0, ..dive(180.0) },
        battery_J: 2e6,
        days: None,
        model_error: 0.0,
        sensor: Sensor::default(),
    };
    let without = outlook(&vehicle, &ask).unwrap();
    let power = outlook(&vehicle, &Ask { sensor: Sensor { drag_area_m2: 0.0, power_W: 0.5 }, ..ask.clone() }).unwrap();
    let drag = outlook(&vehicle, &Ask { sensor: Sensor { drag_area_m2: 0.002, power_W: 0.0 }, ..ask }).unwrap();
    assert_eq!(power.dive_duration_h.value, without.dive_duration_h.value);
    // The battery's energy is what it is: power times days.
    let mean_W = 2e6 / (without.days.value * 86_400.0);
    let expected = 2e6 / ((mean_W + 0.5) * 86_400.0);
    assert!((power.days.value / expected - 1.0).abs() < 1e-9, "{} against {expected}", power.days.value);
    assert!(drag.distance_km.value < without.distance_km.value);
    assert!(drag.dive_duration_h.value > without.dive_duration_h.value);
}

#[test]
fn intervals_are_the_sum_of_squares_of_what_moves_the_plan() {
    let mut vehicle = energetic();
    let ask = Ask {
        dive: Dive { pitch_moves: 0.0, ..dive(180.0) },
        battery_J: 2e6,
        days: None,
        model_error: 0.05,
        sensor: Sensor::default(),
    };
    // A polar of which no error is stated is taken for 10 % off in speed, and most of a dive is spent under way.
    let unstated = outlook(&vehicle, &ask).unwrap().dive_duration_h;
    assert!((0.08..0.101).contains(&(unstated.se / unstated.value)), "{unstated:?}");
    vehicle.set("uncertainty.hydro.d_per_rad", 0.0).unwrap();
    let model_only = outlook(&vehicle, &ask).unwrap();
    // Energy and days are proportional and inversely proportional to the factor.
    assert!((model_only.dive_energy_kJ.se / model_only.dive_energy_kJ.value - 0.05).abs() < 1e-9);
    assert!((model_only.days.se / model_only.days.value - 0.05).abs() < 2e-4);
    vehicle.set("uncertainty.energy.hotel_W", 0.05).unwrap();
    let both = outlook(&vehicle, &ask).unwrap();
    let hotel_kJ = 0.05 * both.dive_duration_h.value * 3.6;
    let expected = model_only.dive_energy_kJ.se.hypot(hotel_kJ);
    assert!((both.dive_energy_kJ.se / expected - 1.0).abs() < 1e-9);
    assert_eq!(both.dive_duration_h.se, 0.0);
}

#[test]
fn exact_counters_give_their_constants_back() {
    let (mut strokes, mut dives) = (Vec::new(), Vec::new());
    for dive in 0..10u32 {
        let depth = 500.0 + 50.0 * f64::from(dive % 4);
        let volume = 200.0 + 13.0 * f64::from(dive % 3);
        for (pressure_dbar, volume_cc) in [(depth, volume), (1.0, 40.0 + f64::from(dive))] {
            let energy_J = (0.025 * pressure_dbar + 8.0) * volume_cc;
            strokes.push(Stroke { dive, pressure_dbar, volume_cc, energy_J });
        }
        let duration_s = 9000.0 + 700.0 * f64::from(dive * dive % 7);
        let pump: f64 = strokes.iter().filter(|s| s.dive == dive).map(|s| s.energy_J).sum();
        let energy_J = 700.0 + 1.05 * pump + 0.3 * duration_s;
        dives.push(DiveCount { dive, duration_s, charge_Ah: energy_J / 24.0 / 3600.0, energy_J });
    }
    let pump = fit_pump(&strokes).unwrap();
    assert!((pump.pump_J_per_dbar_cc.value - 0.025).abs() < 1e-12 && (pump.pump_J_per_cc.value - 8.0).abs() < 1e-9);
    assert!((pump.efficiency - 0.4).abs() < 1e-9);
    let fit = fit_dives(&strokes, &dives).unwrap();
    assert!((fit.surfacing_J.value - 700.0).abs() < 1e-6 && (fit.hotel_W.value - 0.3).abs() < 1e-9);
    assert!((fit.pump_factor.value - 1.05).abs() < 1e-9);
    assert!(fit.charge_error_left_out < 1e-9 && fit.charge_error_of_the_mean > 0.01);
    assert!(fit_dives(&strokes, &dives[..3]).is_err());
    let alike: Vec<Stroke> = strokes.iter().map(|s| Stroke { pressure_dbar: 100.0, ..*s }).collect();
    assert!(fit_pump(&alike).unwrap_err().to_string().contains("too alike"));
}
