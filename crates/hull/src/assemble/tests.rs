use super::*;
use crate::hull_tests::{HullFit, HullGeometry};
use glidepolar_dynamics::Surroundings;
use glidepolar_vehicle::Vehicle;

/// gliderflight's wing: aspect ratio 7, sweep 43 deg, 0.1 m2.
fn slocum_wing() -> Surface {
    let chord_m = (0.1f64 / 7.0).sqrt();
    Surface {
        span_m: 7.0 * chord_m,
        chord_m,
        sweep_rad: 43f64.to_radians(),
        aft_m: 0.95,
        thickness: 0.02,
        efficiency: 0.8,
    }
}

/// A hull with gliderflight's lift slope, 3.8 per rad on 0.1 m2.
fn hull() -> ReducedHull {
    let q = |value: f64| crate::hull_tests::Estimate { value, se: 0.0, ci95: [value, value], unit: String::new() };
    let area = std::f64::consts::PI / 4.0 * 0.213 * 0.213;
    ReducedHull {
        id: "slocum".to_owned(),
        ldr: 8.4,
        n_runs: 20,
        geometry: HullGeometry { diameter_m: 0.213, loa_m: 1.8, cb_m: 0.9, volume_m3: None },
        fit: Some(HullFit { range_deg: 10.0, a: q(3.8 * 0.1 / area), b: q(0.15), c: q(1.5), d: q(1.2) }),
        dynamic: None,
        diagnosis: None,
        extended: None,
    }
}

fn parts(hull: &ReducedHull) -> Parts<'_> {
    Parts {
        hull,
        wing: Some(slocum_wing()),
        tail: None,
        fin: None,
        speed_m_s: 0.35,
        tow_speed_m_s: None,
        density_kg_m3: 1027.0,
        kinematic_viscosity_m2_s: 1.19e-6,
        volume_m3: 0.05,
    }
}

/// Merckelbach et al.: a_w = 3.7 and a_h = 3.8 per rad on 0.1 m2 make 7.5, which is 21 per rad on the frontal area.
#[test]
fn the_winged_slocum_has_the_lift_slope_that_its_users_know() {
    let wing = slocum_wing();
    assert!((wing.area_m2() - 0.1).abs() < 1e-12);
    assert!((wing.lift_slope_per_rad().value - 3.734).abs() < 1e-3, "{:?}", wing.lift_slope_per_rad());
    let hull = hull();
    let total = build_up(&parts(&hull)).unwrap().total;
    let on_wing_area = total.a_per_rad.value * hull.geometry.frontal_area_m2() / 0.1;
    assert!((on_wing_area - 7.534).abs() < 1e-3, "{on_wing_area}");
    assert!((total.a_per_rad.value - 21.1).abs() < 0.1, "{}", total.a_per_rad.value);
}

/// The formula's own limits: 2 pi for the infinite wing, pi AR/2 for the very short one (Jones).
#[test]
fn the_lift_slope_has_the_limits_of_long_and_short_wings() {
    let wing = |ratio: f64| Surface { span_m: ratio, chord_m: 1.0, sweep_rad: 0.0, ..slocum_wing() };
    assert!((wing(1e6).lift_slope_per_rad().value / (2.0 * std::f64::consts::PI) - 1.0).abs() < 1e-5);
    assert!((wing(1e-3).lift_slope_per_rad().value / (std::f64::consts::PI * 1e-3 / 2.0) - 1.0).abs() < 1e-3);
}

#[test]
fn a_wing_behind_the_centre_of_buoyancy_brings_the_nose_down_and_damps() {
    let hull = hull();
    let build = build_up(&parts(&hull)).unwrap();
    let wing = build.terms.iter().find(|term| term.part == "wing").unwrap();
    let (share, arm) = (0.1 / hull.geometry.frontal_area_m2(), 0.05 / 1.8);
    assert!((wing.d_per_rad.value + 3.734 * share * arm).abs() < 1e-3);
    assert!((wing.pitch_damping_CMq.value + 3.734 * share * arm * arm).abs() < 1e-4);
    assert!(build.total.d_per_rad.value < 1.2 && build.total.c_per_rad2.value > 1.5);
    // Terms and total agree, value by value and in squares of the errors.
    let sum: f64 = build.terms.iter().map(|term| term.b.value).sum();
    let squares: f64 = build.terms.iter().map(|term| term.b.se.powi(2)).sum();
    assert!((build.total.b.value - sum).abs() < 1e-12 && (build.total.b.se - squares.sqrt()).abs() < 1e-12);
}

#[test]
fn a_sensor_to_port_slows_the_glider_and_takes_rudder_to_starboard() {
    let p = Vehicle::load("slocum-graver").unwrap().parameters().unwrap();
    let hull = hull();
    let pod = Pod {
        drag_area_m2: Figure { value: 0.002, se: 0.0004 },
        aft_m: 1.0,
        starboard_m: -0.15,
        below_m: 0.05,
        power_W: 0.2,
    };
    let fin = Surface { span_m: 0.25, chord_m: 0.12, sweep_rad: 0.3, aft_m: 1.9, thickness: 0.05, efficiency: 0.8 };
    let lateral = Lateral {
        hull_a_per_rad: Figure { value: 1.0, se: 0.1 },
        hull_d_per_rad: Figure { value: 1.2, se: 0.05 },
        fin,
        cb_aft_m: hull.geometry.cb_m,
        rudder_chord: 0.4,
    };
    let water = Surroundings { density_kg_m3: 1027.0, pressure_Pa: 0.0, temperature_C: 15.0, time_s: 0.0 };
    let look = Look { pitch_rad: -25f64.to_radians(), ballast_m3: -200e-6, water };
    let effect = effect(&p, &[], &pod, Some(&lateral), &look).unwrap();
    assert!(effect.speed_m_s[1].value < effect.speed_m_s[0].value);
    assert!(effect.horizontal_velocity_m_s[1].value < effect.horizontal_velocity_m_s[0].value);
    assert!(effect.glide_angle_deg[1].value < effect.glide_angle_deg[0].value, "a steeper path");
    let rudder = effect.rudder_deg.unwrap();
    assert!(rudder.value > 0.0 && rudder.value < 20.0 && rudder.se > 0.0, "{rudder:?}");

    // Side force and yaw moment of drift, rudder and sensor balance, each computed apart from the solution.
    let (a_f, tau) = (lateral.fin_slope(&p), lateral.effectiveness());
    let delta = rudder.value.to_radians();
    let beta = tau * a_f * delta / (1.0 + a_f);
    let arm_m = fin.aft_m - hull.geometry.cb_m;
    let area = p.frontal_area_m2;
    let fin_force = area * a_f * (beta - tau * delta);
    let yaw = area * p.length_m * 1.2 * beta - fin_force * arm_m + 0.002 * -0.15;
    assert!((area * 1.0 * beta + fin_force).abs() < 1e-12, "side force");
    assert!(yaw.abs() < 1e-9, "{yaw}");
}

#[test]
fn a_flap_of_the_whole_chord_is_the_fin_itself() {
    let lateral = |rudder_chord: f64| Lateral {
        hull_a_per_rad: Figure::default(),
        hull_d_per_rad: Figure::default(),
        fin: slocum_wing(),
        cb_aft_m: 0.9,
        rudder_chord,
    };
    assert!((lateral(1.0).effectiveness() - 1.0).abs() < 1e-12);
    assert!(lateral(0.0).effectiveness().abs() < 1e-12);
    // Glauert: a flap of a quarter chord turns the flow by 0.61 of its angle.
    assert!((lateral(0.25).effectiveness() - 0.609).abs() < 1e-3);
}
