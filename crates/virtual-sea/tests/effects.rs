//! Every effect against a computation by hand: in the force balance of true steady flight, and in what the log reads.

use glidepolar_virtual_sea::catalogue::{TABLE, parse_requests};
use glidepolar_virtual_sea::effects::Hidden;
use glidepolar_virtual_sea::flight::Instant;
use glidepolar_virtual_sea::ocean::{GRAVITY_M_S2, Weather};
use glidepolar_virtual_sea::sensors::Quality;
use glidepolar_virtual_sea::vehicle::{Hull, Vehicle};
use glidepolar_virtual_sea::{Options, Sea, generate_observed};

/// Perfect instruments in a still but stratified ocean.
fn still(effect: &str) -> (Sea, Vec<Instant>) {
    let options = Options {
        effects: parse_requests(effect).expect("a list of effects"),
        weather: Weather { roughness: 0.0, ..Weather::default() },
        quality: Some(Quality::perfect(5.0)),
        hull: Some(Hull::SlocumDeep),
        hours: 4.0,
        dives: 5,
        ..Options::seeded(11)
    };
    let mut flight = Vec::new();
    let sea = generate_observed(&options, |now| flight.push(*now));
    (sea, flight)
}

/// Instants amid a minute of unchanged flight, where the forces balance within a fraction of a percent.
fn steady(flight: &[Instant]) -> impl Iterator<Item = &Instant> {
    flight.windows(241).filter_map(|window| {
        let (first, now, last) = (&window[0], &window[120], &window[240]);
        let calm = window.iter().all(|w| {
            w.depth_m > 20.0
                && (w.speed_m_s - now.speed_m_s).abs() < 1e-3
                && (w.pitch_rad - now.pitch_rad).abs() < 1e-3
                && w.engine_cc == now.engine_cc
                && (w.roll_rad - now.roll_rad).abs() < 0.04
        });
        (calm && first.dive == last.dive).then_some(now)
    })
}

/// What the hand computation says of one instant.
struct ByHand {
    mass_kg: f64,
    volume_m3: f64,
    lift: f64,
    drag: f64,
}

/// The vehicle without any effect.
fn plain(vehicle: &Vehicle, now: &Instant) -> ByHand {
    let warmer = now.water.temperature_c - 15.0;
    let strain = vehicle.thermal_expansion_per_k * warmer - vehicle.compressibility_per_pa * now.pressure_pa;
    ByHand {
        mass_kg: vehicle.mass_kg,
        volume_m3: vehicle.displaced_volume_m3 * (1.0 + strain) + now.engine_cc * 1e-6,
        lift: vehicle.a_per_rad * now.angle_rad,
        drag: vehicle.b + vehicle.c_per_rad2 * now.angle_rad * now.angle_rad,
    }
}

/// Worst relative misfit of the balance of forces along and across the path over all steady instants, and how many.
fn misfit(flight: &[Instant], vehicle: &Vehicle, by_hand: impl Fn(&Instant, ByHand) -> ByHand) -> (f64, usize) {
    let mut worst = 0.0_f64;
    let mut count = 0;
    for now in steady(flight) {
        let hand = by_hand(now, plain(vehicle, now));
        let net_kg = hand.mass_kg - now.water.density_kg_m3 * hand.volume_m3;
        assert!((net_kg - now.net_mass_kg).abs() < 1e-9, "net mass {} by hand {net_kg}", now.net_mass_kg);
        let path = now.pitch_rad - now.angle_rad;
        let pressed = 0.5 * now.water.density_kg_m3 * now.speed_m_s.powi(2) * vehicle.frontal_area_m2;
        let weight = GRAVITY_M_S2 * net_kg;
        let along = -weight * path.sin() - pressed * hand.drag;
        let across = weight * path.cos() - pressed * hand.lift * now.roll_rad.cos();
        worst = worst.max(along.abs() / weight.abs()).max(across.abs() / weight.abs());
        count += 1;
    }
    (worst, count)
}

/// Asserts that the balance closes with the effect counted by hand, and does not without it.
fn closes(effect: &str, by_hand: impl Fn(&Instant, ByHand) -> ByHand) {
    let (sea, flight) = still(effect);
    let (worst, count) = misfit(&flight, &sea.truth.vehicle, by_hand);
    assert!(count > 5000, "{effect}: only {count} steady instants");
    assert!(worst < 0.006, "{effect}: forces miss by {worst} of the net weight");
}

#[test]
fn forces_balance_on_steady_glides_with_nothing_hidden() {
    closes("none", |_, hand| hand);
}

#[test]
fn a_wrong_hand_computation_does_not_close() {
    let (sea, flight) = still("drag_step=0.2,ballast_scale=1.0");
    let (worst, _) = misfit(&flight, &sea.truth.vehicle, |_, hand| hand);
    assert!(worst > 0.05, "the check sees nothing: {worst}");
}

#[test]
fn masses_and_volumes_are_as_defined() {
    closes("ballast_offset=0.08", |_, hand| ByHand { mass_kg: hand.mass_kg + 0.08, ..hand });
    closes("leak=0.009", |now, hand| ByHand { mass_kg: hand.mass_kg + 0.009 * now.time_s / 3600.0, ..hand });
    closes("ballast_scale=0.9", |now, hand| ByHand { volume_m3: hand.volume_m3 - 0.1e-6 * now.engine_cc, ..hand });
    closes("trapped_air=80", |now, hand| {
        let air = 80e-6 * 101_325.0 / (101_325.0 + now.pressure_pa);
        ByHand { volume_m3: hand.volume_m3 + air, ..hand }
    });
    let vehicle = still("none").0.truth.vehicle;
    closes("hull_compressibility=2e-10", |now, hand| {
        let stiffer = (vehicle.compressibility_per_pa - 2e-10) * now.pressure_pa;
        ByHand { volume_m3: hand.volume_m3 + vehicle.displaced_volume_m3 * stiffer, ..hand }
    });
    closes("thermal_expansion=1e-4", |now, hand| {
        let more = (1e-4 - vehicle.thermal_expansion_per_k) * (now.water.temperature_c - 15.0);
        ByHand { volume_m3: hand.volume_m3 + vehicle.displaced_volume_m3 * more, ..hand }
    });
}

#[test]
fn drag_and_lift_are_as_defined() {
    let scaled = |hand: ByHand, factor: f64| ByHand { drag: hand.drag * factor, ..hand };
    closes("drag_growth=0.9", |now, hand| scaled(hand, 1.0 + 0.9 * now.time_s / 86_400.0));
    closes("roll_drag=4", |now, hand| scaled(hand, 1.0 + 4.0 * now.roll_rad.powi(2)));
    closes("rudder_drag=3", |now, hand| scaled(hand, 1.0 + 3.0 * now.rudder_rad.powi(2)));
    closes("climb_dive_asymmetry=1.3", |now, hand| scaled(hand, if now.pitch_rad > 0.0 { 1.3 } else { 1.0 }));
    closes("nonlinear_lift=90", |now, hand| ByHand {
        lift: hand.lift + 90.0 * now.angle_rad * now.angle_rad.abs(),
        ..hand
    });
    let (sea, _) = still("drag_step=-0.25");
    let step_s = sea.truth.parameter("step_time_s").expect("a step time");
    assert!((0.25 * 14_400.0..0.75 * 14_400.0).contains(&step_s));
    closes("drag_step=-0.25", |now, hand| scaled(hand, if now.time_s >= step_s { 0.75 } else { 1.0 }));
    let b = sea.truth.vehicle.b;
    closes("reynolds_drag=-0.3", |now, hand| {
        let pressure = 0.5 * now.water.density_kg_m3 * now.speed_m_s.powi(2);
        let factor = (pressure / (0.5 * 1025.0 * 0.09)).powf(-0.3);
        ByHand { drag: hand.drag + b * (factor - 1.0), ..hand }
    });
}

#[test]
fn moving_water_carries_the_glider() {
    for (effect, sinking) in [("vertical_current=0.02", 0.02), ("vertical_current=-0.015", -0.015)] {
        closes(effect, |_, hand| hand);
        let (_, flight) = still(effect);
        for now in steady(&flight).filter(|now| now.depth_m > 30.0) {
            let through = -now.speed_m_s * (now.pitch_rad - now.angle_rad).sin();
            assert!((now.sinking_m_s - through - sinking).abs() < 1e-6, "{} {through}", now.sinking_m_s);
        }
    }
}

/// Rows of the log beside the true instants of the same time.
fn rows<'a>(sea: &'a Sea, flight: &'a [Instant]) -> impl Iterator<Item = (usize, &'a Instant)> {
    sea.log.time_s.iter().enumerate().map(|(row, &time_s)| (row, &flight[(time_s * 4.0).round() as usize]))
}

#[test]
fn readings_are_as_defined() {
    let (sea, flight) = still("pitch_offset=0.03,pitch_scale=0.86,pressure_scale=1.05,density_bias=1.2");
    for (row, now) in rows(&sea, &flight) {
        let pitch = 0.86 * sea.log.pitch_rad[row] + 0.03;
        assert!((pitch - now.pitch_rad).abs() < 1e-12);
        assert!((1.05 * sea.log.pressure_dbar[row] - now.pressure_pa * 1e-4).abs() < 1e-8);
        let density = glidepolar_virtual_sea::ocean::density_eos80(
            sea.log.salinity_psu[row],
            sea.log.temperature_c[row],
            sea.log.pressure_dbar[row],
        );
        assert!((sea.log.density_kg_m3[row] + 1.2 - density).abs() < 1e-9);
    }
}

#[test]
fn density_at_zero_pressure_leaves_the_compression_out() {
    let (sea, flight) = still("density_at_zero_pressure");
    for (row, now) in rows(&sea, &flight).filter(|(_, now)| now.pressure_pa > 1e6) {
        let missing = now.water.density_kg_m3 - sea.log.density_kg_m3[row];
        // Sea water gains 0.42 to 0.48 kg/m3 per 100 dbar.
        assert!((0.0042..0.0048).contains(&(missing / (now.pressure_pa * 1e-4))), "{missing}");
    }
}

#[test]
fn late_pressure_is_the_true_one_under_an_exponential_memory() {
    let (sea, flight) = still("pressure_lag=25");
    for (row, now) in rows(&sea, &flight).filter(|(row, now)| row % 40 == 0 && now.time_s > 300.0) {
        let here = (now.time_s * 4.0).round() as usize;
        // Integral of p(t - s) exp(-s/25) / 25 over the ten time constants past, by the trapezoidal rule.
        let memory = |back: usize| (-(back as f64) * 0.25 / 25.0).exp();
        let (sum, weight) = (0..=1000).fold((0.0, 0.0), |(sum, weight), back| {
            let share = memory(back) * if back == 0 { 0.5 } else { 1.0 };
            (sum + share * flight[here - back].pressure_pa * 1e-4, weight + share)
        });
        let late_dbar = sum / weight;
        assert!((sea.log.pressure_dbar[row] - late_dbar).abs() < 0.05, "{} {late_dbar}", sea.log.pressure_dbar[row]);
    }
    let furthest = rows(&sea, &flight).map(|(row, now)| (now.pressure_pa * 1e-4 - sea.log.pressure_dbar[row]).abs());
    assert!(furthest.fold(0.0, f64::max) > 3.0);
}

#[test]
fn uncatalogued_effects_are_as_defined() {
    let (sea, flight) = still("uncatalogued-compass-pitch=0.03,uncatalogued-warm-ballast-reading=0.01");
    for (row, now) in rows(&sea, &flight) {
        assert!((sea.log.pitch_rad[row] - now.pitch_rad - 0.03 * now.heading_rad.sin()).abs() < 1e-12);
        let read = now.engine_cc * (1.0 + 0.01 * (now.water.temperature_c - 10.0));
        assert!((sea.log.vbd_cc[row] - read).abs() < 1e-6);
    }
    let a = sea.truth.vehicle.a_per_rad;
    closes("uncatalogued-wing-stall=0.05", |now, hand| {
        let beyond = (now.angle_rad.abs() - 0.05).max(0.0);
        ByHand { lift: hand.lift - 0.7 * a * beyond * now.angle_rad.signum(), ..hand }
    });
    let (sea, _) = still("uncatalogued-sloughing=0.5");
    let period_s = sea.truth.parameter("regrowth_s").expect("a period");
    closes("uncatalogued-sloughing=0.5", |now, hand| ByHand {
        drag: hand.drag * (1.0 + 0.5 * (now.time_s / period_s).fract()),
        ..hand
    });
    let (sea, flight) = still("uncatalogued-tide=0.02,uncatalogued-layer=-0.02");
    let parameter = |name| sea.truth.parameter(name).expect("a parameter");
    let (top_m, bottom_m) = (parameter("layer_top_m"), parameter("layer_bottom_m"));
    for now in flight.iter().filter(|now| now.depth_m > bottom_m + 30.0) {
        let turned = std::f64::consts::TAU * now.time_s / (12.4206 * 3600.0);
        let tide = 0.02 * (turned + parameter("tidal_phase_rad")).cos();
        assert!((now.water_sinking_m_s - tide).abs() < 1e-5, "{} against {tide}", now.water_sinking_m_s);
    }
    let middle = 0.5 * (top_m + bottom_m);
    assert!(flight.iter().any(|now| (now.depth_m - middle).abs() < 1.0));
    for now in flight.iter().filter(|now| (now.depth_m - middle).abs() < 1.0) {
        let turned = std::f64::consts::TAU * now.time_s / (12.4206 * 3600.0);
        let both = 0.02 * (turned + parameter("tidal_phase_rad")).cos() - 0.02;
        assert!((now.water_sinking_m_s - both).abs() < 2e-4, "{} against {both}", now.water_sinking_m_s);
    }
}

#[test]
fn battery_hysteresis_moves_the_balance_of_moments_alone() {
    let (sea, flight) = still("uncatalogued-battery-hysteresis=0.004");
    let vehicle = &sea.truth.vehicle;
    closes("uncatalogued-battery-hysteresis=0.004", |_, hand| hand);
    let mut sides = [false; 2];
    for now in steady(&flight) {
        let needed = vehicle.moving_mass_for(now.pitch_rad, now.angle_rad, now.speed_m_s, now.water.density_kg_m3);
        let off = now.moving_mass_m - needed;
        assert!((off.abs() - 0.002).abs() < 2e-4, "{off}");
        sides[usize::from(off > 0.0)] = true;
    }
    assert_eq!(sides, [true, true]);
}

#[test]
fn every_effect_changes_something_and_inertia_nothing() {
    let (plain, _) = still("none");
    for effect in TABLE {
        let (sea, _) = still(effect.name);
        let same = sea.log == plain.log;
        assert_eq!(same, effect.name == "inertia", "{}", effect.name);
        let neutral = Hidden::nothing(&sea.truth.vehicle) == Hidden::of(&sea.truth.effects, &sea.truth.vehicle);
        assert_eq!(neutral, effect.name == "inertia", "{} reaches no term", effect.name);
    }
}

#[test]
fn requests_are_read_and_bad_ones_refused() {
    assert_eq!(parse_requests("none"), Ok(Vec::new()));
    let two = parse_requests("leak=0.01, drag_step").expect("two effects");
    assert_eq!((two[0].size, two[1].size), (Some(0.01), None));
    for bad in ["leek", "leak=x", "leak=inf", "inertia=1", "leak,leak"] {
        let message = parse_requests(bad).expect_err(bad).to_string();
        assert!(message.contains(bad.split([',', '=']).next().unwrap_or(bad)), "{message}");
    }
}
