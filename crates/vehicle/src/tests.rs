use super::*;
use glidepolar_dynamics::Parameters;

#[test]
fn every_builtin_vehicle_reads_and_can_move() {
    for name in builtin::NAMES {
        let vehicle = Vehicle::load(name).unwrap_or_else(|error| panic!("{error}"));
        vehicle.parameters().unwrap_or_else(|error| panic!("{error}"));
        assert!(!vehicle.source.is_empty(), "{name} states its source");
    }
}

#[test]
fn the_published_constants_come_back_from_the_coefficients() {
    // (name, K_L, K_D0, K_D, K_M): Leonard and Graver 2001; Graver 2005.
    let cases = [
        ("rogue", 306.0, 18.0, 109.0, -36.5),
        ("slocum-graver", 132.5, 2.15, 25.0, -100.0),
        ("adelaide", 132.5, 2.15, 25.0, -100.0),
    ];
    for (name, kl, kd0, kd, km) in cases {
        let p = Vehicle::load(name).unwrap().parameters().unwrap();
        let half = 0.5 * p.reference_density_kg_m3 * p.frontal_area_m2;
        let munk = p.added_mass_3_kg - p.added_mass_1_kg;
        for (found, expected) in [
            (half * p.a_per_rad, kl),
            (half * p.b, kd0),
            (half * p.c_per_rad2, kd),
            (half * p.length_m * p.d_per_rad - munk, km),
        ] {
            assert!((found - expected).abs() < 1e-9 * expected.abs(), "{name}: {found} against {expected}");
        }
    }
}

#[test]
fn the_default_parameters_are_the_slocum_like_vehicle() {
    let vehicle = Vehicle::load("slocum-graver").unwrap().parameters().unwrap().as_array();
    for (i, (a, b)) in vehicle.into_iter().zip(Parameters::default().as_array()).enumerate() {
        // Energy drives nothing: without figures none is counted.
        if ["hotel_W", "pump_J_per_m3", "pump_J_per_Pa_m3", "pitch_move_J", "surfacing_J", "rudder_W"]
            .contains(&PARAMETERS[i].name)
        {
            assert_eq!(b, 0.0);
            continue;
        }
        assert!((a - b).abs() <= 1e-12 * b.abs(), "{}: {a} against {b}", PARAMETERS[i].name);
    }
}

#[test]
fn seawing_has_the_published_constants() {
    // Zhang et al. 2013, moments without the Munk couple.
    let body = Vehicle::load("seawing").unwrap().body().unwrap();
    let (p, l) = (&body.plane, &body.lateral);
    let half = 0.5 * p.reference_density_kg_m3 * p.frontal_area_m2;
    let moment = half * p.length_m;
    let cases = [
        (half * p.a_per_rad, 440.99),
        (half * p.b, 7.19),
        (half * p.c_per_rad2, 386.29),
        (half * p.CL0, -0.36),
        (half * l.CY_beta_per_rad, -115.65),
        (moment * p.CM0, 0.28),
        (moment * p.d_per_rad - (p.added_mass_3_kg - p.added_mass_1_kg), -65.84),
        (moment * l.Cl_beta_per_rad, -58.27),
        (moment * l.ascent_CN_beta_per_rad - (p.added_mass_1_kg - l.added_mass_2_kg), 34.10),
        (moment * l.CN_r, -389.30),
        (moment * l.Cl_p, -19.83),
        (p.pitch_inertia_kg_m2, 7.88 + 15.27 + 10.16),
        (p.displaced_mass_kg, 65.28),
    ];
    for (found, expected) in cases {
        assert!((found - expected).abs() < 1e-9 * expected.abs(), "{found} against {expected}");
    }
    assert_eq!(body.rate_law, RateLaw::SpeedSquared);
}

#[test]
fn the_tables_of_turns_are_read_with_the_same_care_as_the_others() {
    let text = builtin::text("seawing").unwrap();
    let broken = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        Vehicle::parse(&text.replace(from, to), "x.toml").unwrap_err().to_string()
    };
    for (message, expected) in [
        (broken("CN_r = ", "CN_rr = "), "did you mean `lateral.CN_r`?"),
        (broken("rate_law = \"V2\"", "rate_law = \"V3\""), "`lateral.rate_law` is \"V3\", expected \"V\" or \"V2\""),
        (broken("rate_law", "rate_lav"), "did you mean `lateral.rate_law`?"),
        (broken("[0.02, 10.16, 0.17]", "[0.02, 10.16]"), "expected three numbers not below zero [kg.m2]"),
        (broken("[0.02, 10.16, 0.17]", "\"a\""), "expected three numbers not below zero [kg.m2]"),
        (broken("radius_m = 0.014", "radius_m = -0.014"), "`roll_mass.radius_m` is -0.014"),
        (broken("min_rad = -1.57", "min_rad = 2.57"), "`roll_mass.max_rad` = 1.5707963267948966 rad lies below"),
    ] {
        assert!(message.contains(expected), "{message:?} lacks {expected:?}");
    }
    let error = Vehicle::load("rogue").unwrap().body().unwrap_err().to_string();
    assert!(error.contains("lacks what a turn needs") && error.contains("`lateral.m2_kg` [kg]"), "{error}");
}

#[test]
fn legs_that_turn_apart_and_a_list_are_read() {
    let text = builtin::text("seawing").unwrap().replace("[ballast]", "[lateral.ascent]\nCN_r = -0.5\n[ballast]");
    let mut vehicle = Vehicle::parse(&text, "x.toml").unwrap();
    vehicle.set("mass.cg_starboard_m", 0.001).unwrap();
    vehicle.set("mass.cg_forward_m", -0.0677).unwrap();
    let body = vehicle.body().unwrap();
    assert_eq!((body.lateral.ascent_CN_r, body.lateral.starboard_moment_kg_m), (-0.5, 65.28 * 0.001));
    assert!(body.lateral.CN_r < -5.0);
    let p = &body.plane;
    // Forward: moving mass at zero; the height stays that of the offset mass.
    assert!((p.offset_mass_kg * p.offset_mass_forward_m - 65.28 * -0.0677).abs() < 1e-12);
    assert!((p.offset_mass_kg * p.offset_mass_below_m - 54.28 * 0.0032).abs() < 1e-12);
}

#[test]
fn legs_measured_apart_become_ratios() {
    let p = Vehicle::load("slocum-049").unwrap().parameters().unwrap();
    assert_eq!((p.a_per_rad, p.b, p.c_per_rad2), (4.7, 0.25, 6.2));
    assert!((p.a_per_rad * p.ascent_a_ratio - 4.0).abs() < 1e-12);
    assert!((p.b * p.ascent_b_ratio - 0.19).abs() < 1e-12);
    assert_eq!(p.ascent_d_ratio, 1.0);
}

#[test]
fn the_height_of_the_centre_of_gravity_is_the_whole_vehicles() {
    let mut vehicle = Vehicle::load("slocum-graver").unwrap();
    vehicle.set("mass.cg_below_cb_m", 0.006).unwrap();
    let p = vehicle.parameters().unwrap();
    let moment = p.moving_mass_kg * p.moving_mass_height_m + p.offset_mass_kg * p.offset_mass_below_m;
    assert!((moment - 50.0 * 0.006).abs() < 1e-12);
}

const MINIMAL: &str = "name = \"x\"\n[geometry]\nfrontal_area_m2 = 0.03\nlength_m = 1.8\n[mass]\nmass_kg = 50\ndisplaced_volume_m3 = 0.05\n[hydro]\na_per_rad = 7.0\nb = 0.1\nc_per_rad2 = 2.0\n";

#[test]
fn limits_the_wrong_way_round_are_refused_by_their_keys_and_values() {
    let text = builtin::text("slocum-graver").unwrap();
    let mut vehicle = Vehicle::parse(text, "here").unwrap();
    vehicle.set("ballast.max_cc", -600.0).unwrap();
    let error = Vehicle::parse(&vehicle.to_toml(), "here").unwrap_err().to_string();
    assert!(error.contains("`ballast.max_cc` = -600 cm3 lies below `ballast.min_cc` = -500 cm3"), "{error}");
    let mut vehicle = Vehicle::parse(text, "here").unwrap();
    vehicle.set("moving_mass.min_m", 0.3).unwrap();
    let error = Vehicle::parse(&vehicle.to_toml(), "here").unwrap_err().to_string();
    assert!(error.contains("`moving_mass.max_m` = 0.2 m lies below `moving_mass.min_m` = 0.3 m"), "{error}");
    // Limits may coincide.
    vehicle.set("moving_mass.min_m", 0.2).unwrap();
    assert!(Vehicle::parse(&vehicle.to_toml(), "here").is_ok());
}

#[test]
fn a_steady_glide_needs_little_and_a_time_history_says_what_it_lacks() {
    let vehicle = Vehicle::parse(MINIMAL, "x.toml").unwrap();
    assert_eq!(vehicle.glide_parameters().b, 0.1);
    let error = vehicle.parameters().unwrap_err().to_string();
    assert!(error.contains("`added_mass.m1_kg` [kg], the inertia along the hull contains it"), "{error}");
}

#[test]
fn bad_files_are_refused_with_place_cause_and_next_step() {
    let broken = |from: &str, to: &str| Vehicle::parse(&MINIMAL.replace(from, to), "x.toml").unwrap_err().to_string();
    let cases = [
        (broken("b = 0.1", "bb = 0.1"), "x.toml:10:1: unknown key `hydro.bb`"),
        (broken("a_per_rad", "a_per_radd"), "did you mean `hydro.a_per_rad`?"),
        (broken("b = 0.1", "b = \"0,1\""), "x.toml:10:5: `hydro.b` is a string, expected a number"),
        (broken("b = 0.1", "b = nan"), "`hydro.b` is NaN, expected a number not below zero"),
        (broken("mass_kg = 50", "mass_kg = -50"), "`mass.mass_kg` is -50, expected a number above zero [kg]"),
        (broken("[hydro]", "[hydra]"), "unknown key `hydra`"),
        (broken("mass_kg = 50\n", ""), "missing key `mass.mass_kg` [kg]"),
        (broken("b = 0.1", "b = "), "x.toml:10:"),
        (broken("name = \"x\"\n", ""), "missing key `name`"),
        (
            broken("[hydro]", "[mechanisms]\nleek_kg_per_hour = 1\n[hydro]"),
            "did you mean `mechanisms.leak_kg_per_hour`?",
        ),
        (broken("[hydro]", "[mechanisms]\nhotel_W = 1.0\n[hydro]"), "unknown key `mechanisms.hotel_W`"),
        (broken("[hydro]", "[uncertainty]\n\"hydro.bb\" = 1\n[hydro]"), "unknown key `hydro.bb`"),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message:?} lacks {expected:?}");
    }
    let error = Vehicle::load("slocum-gravr").unwrap_err().to_string();
    assert!(error.contains("did you mean the built-in vehicle slocum-graver?"), "{error}");
}

#[test]
fn what_was_not_set_stays_as_it_was_written_comments_included() {
    let text = format!("# my glider\n{MINIMAL}\n[uncertainty]\nhydro.b = 0.01 # from the tank\n")
        .replace("b = 0.1\n", "b = 0.1   # read off Figure 13\n");
    let mut vehicle = Vehicle::parse(&text, "x.toml").unwrap();
    assert_eq!(vehicle.uncertainty["hydro.b"], 0.01);
    assert_eq!(vehicle.to_toml(), text);
    vehicle.set("hydro.b", 0.25).unwrap();
    vehicle.set("mechanisms.leak_kg_per_hour", 0.002).unwrap();
    vehicle.set("hydro.ascent.b", 0.19).unwrap();
    let written = vehicle.to_toml();
    assert!(written.contains("b = 0.25   # read off Figure 13\n"), "{written}");
    assert!(written.starts_with("# my glider\n"));
    let again = Vehicle::parse(&written, "x.toml").unwrap();
    assert_eq!(again.sections, vehicle.sections);
    assert_eq!(again.mechanisms, vehicle.mechanisms);
    assert!(vehicle.set("hydro.bb", 1.0).is_err());
}

#[test]
fn what_is_cleared_is_gone_from_file_and_memory() {
    let mut vehicle = Vehicle::load("slocum-049").unwrap();
    for name in ["a_per_rad", "b", "c_per_rad2"] {
        vehicle.clear(&format!("hydro.descent.{name}"));
    }
    vehicle.clear("hydro.no_such_key");
    assert!(!vehicle.to_toml().contains("[hydro.descent]") && vehicle.to_toml().contains("[hydro.ascent]"));
    let again = Vehicle::parse(&vehicle.to_toml(), "x.toml").unwrap();
    assert_eq!((again.sections, again.get("hydro.descent.b")), (vehicle.sections, None));
}
