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
    let at_s = still("net_mass_step=-0.05").0.truth.parameter("net_mass_step_time_s").expect("a time");
    closes("net_mass_step=-0.05", |now, hand| ByHand {
        mass_kg: hand.mass_kg - if now.time_s >= at_s { 0.05 } else { 0.0 },
        ..hand
    });
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

/// A quantity that follows another as `dy/dt = (x - y) / tau` along a flight, by the mid-point rule.
fn following(flight: &[Instant], start: f64, tau_s: f64, of: fn(&Instant) -> f64) -> Vec<f64> {
    let mut late = start;
    let mut found = vec![late];
    for pair in flight.windows(2) {
        let step_s = pair[1].time_s - pair[0].time_s;
        let middle = 0.5 * (of(&pair[0]) + of(&pair[1]));
        late = (late * (tau_s / step_s - 0.5) + middle) / (tau_s / step_s + 0.5);
        found.push(late);
    }
    found
}

/// Which instant of a flight this one is.
fn place(now: &Instant) -> usize {
    (now.time_s * 4.0).round() as usize
}

#[test]
fn what_goes_by_the_past_is_as_defined() {
    closes("lift_asymmetry=1.3", |now, hand| ByHand {
        lift: hand.lift * if now.pitch_rad > 0.0 { 1.3 } else { 1.0 },
        ..hand
    });

    // Within a step nobody says where the pressure counts: the net mass by hand may differ by what it changes in one.
    let near = |effect: &str, by_hand: &dyn Fn(&Instant, ByHand) -> ByHand| {
        let (sea, flight) = still(effect);
        let mut largest_kg = 0.0_f64;
        for now in flight.iter().filter(|now| now.depth_m > 5.0) {
            let hand = by_hand(now, plain(&sea.truth.vehicle, now));
            let net_kg = hand.mass_kg - now.water.density_kg_m3 * hand.volume_m3;
            assert!((net_kg - now.net_mass_kg).abs() < 2e-5, "{effect}: {} by hand {net_kg}", now.net_mass_kg);
            let without = plain(&sea.truth.vehicle, now);
            largest_kg = largest_kg.max((net_kg - without.mass_kg + now.water.density_kg_m3 * without.volume_m3).abs());
        }
        assert!(largest_kg > 3e-3, "{effect}: {largest_kg} kg is nothing");
    };
    let (sea, flight) = still("hull_creep=3e-10");
    let tau_s = sea.truth.parameter("creep_time_s").expect("a time");
    let followed = following(&flight, 0.0, tau_s, |now| now.pressure_pa);
    let volume_m3 = sea.truth.vehicle.displaced_volume_m3;
    near("hull_creep=3e-10", &|now, hand| ByHand {
        volume_m3: hand.volume_m3 - volume_m3 * 3e-10 * followed[place(now)],
        ..hand
    });

    let (sea, flight) = still("late_expansion=6e-5");
    let tau_s = sea.truth.parameter("expansion_time_s").expect("a time");
    let inside = following(&flight, flight[0].water.temperature_c, tau_s, |now| now.water.temperature_c);
    near("late_expansion=6e-5", &|now, hand| ByHand {
        volume_m3: hand.volume_m3 + volume_m3 * 6e-5 * (inside[place(now)] - now.water.temperature_c),
        ..hand
    });

    let (sea, flight) = still("carried_water=0.02");
    let tau_s = sea.truth.parameter("exchange_time_s").expect("a time");
    let warm = following(&flight, flight[0].water.temperature_c, tau_s, |now| now.water.temperature_c);
    let salt = following(&flight, flight[0].water.salinity_psu, tau_s, |now| now.water.salinity_psu);
    near("carried_water=0.02", &|now, hand| {
        let i = place(now);
        let inside = glidepolar_virtual_sea::ocean::density_eos80(salt[i], warm[i], now.pressure_pa * 1e-4);
        ByHand { mass_kg: hand.mass_kg + 0.02 * inside, volume_m3: hand.volume_m3 + 0.02, ..hand }
    });

    let (_, flight) = still("pump_leakback=25");
    let mut stopped_s = vec![0.0];
    for pair in flight.windows(2) {
        let last = *stopped_s.last().expect("a time");
        stopped_s.push(if pair[0].engine_cc == pair[1].engine_cc { last + 0.25 } else { 0.0 });
    }
    near("pump_leakback=25", &|now, hand| ByHand {
        volume_m3: hand.volume_m3 - 25e-6 / 3600.0 * stopped_s[place(now)],
        ..hand
    });
}

#[test]
fn instruments_that_go_by_the_past_are_as_defined() {
    let (sea, flight) = still("conductivity_drift=0.9");
    for (row, now) in rows(&sea, &flight) {
        let read = now.water.salinity_psu - 0.9 * now.time_s / 86_400.0;
        assert!((sea.log.salinity_psu[row] - read).abs() < 1e-9);
        let density =
            glidepolar_virtual_sea::ocean::density_eos80(read, now.water.temperature_c, sea.log.pressure_dbar[row]);
        assert!((sea.log.density_kg_m3[row] - density).abs() < 1e-9);
    }
    for late_s in [6.0, -6.0] {
        let (sea, flight) = still(&format!("thermal_lag={late_s}"));
        let mut most = 0.0_f64;
        for (row, now) in rows(&sea, &flight).filter(|(_, now)| now.time_s > 60.0) {
            // A cell that is ahead is a row that waits: its water is that of six seconds ago.
            let row_at = if late_s > 0.0 { place(now) } else { place(now) - 24 };
            let cell = if late_s > 0.0 { place(now) - 24 } else { place(now) };
            let (water, cell_c) = (&flight[row_at].water, flight[cell].water.temperature_c);
            // PSS-78 with C(35, 10) = 38.10 and C(35, 20) = 47.92 mS/cm: the same conductivity 1 K off is a salinity of 0.98 off
            // at 10 degrees C, 0.8 at 20 and 1.0 at 5, in proportion to the salinity, here 31.5 to 36.
            let error = sea.log.salinity_psu[row] - water.salinity_psu;
            let warmer = cell_c - water.temperature_c;
            assert!(warmer.abs() < 1e-6 || (0.65..1.1).contains(&(error / warmer)), "{error} at {warmer} K");
            most = most.max(error.abs());
        }
        assert!(most > 0.02, "{most}");
    }
    for late_s in [20.0, -20.0] {
        let (sea, flight) = still(&format!("clock_offset={late_s}"));
        let mut moved = 0.0_f64;
        for (row, now) in rows(&sea, &flight).filter(|(_, now)| now.time_s > 60.0) {
            let (attitude, water) = if late_s > 0.0 { (80, 0) } else { (0, 80) };
            let (attitude, water) = (&flight[place(now) - attitude], &flight[place(now) - water]);
            assert!((sea.log.pitch_rad[row] - attitude.pitch_rad).abs() < 1e-12);
            assert!((sea.log.pressure_dbar[row] - water.pressure_pa * 1e-4).abs() < 1e-8);
            assert!((sea.log.temperature_c[row] - water.water.temperature_c).abs() < 1e-12);
            moved = moved.max((attitude.pitch_rad - water.pitch_rad).abs());
        }
        assert!(moved > 0.3, "{moved}");
    }
    let (sea, flight) = still("pressure_hysteresis=0.003");
    let (mut largest_dbar, mut at) = (0.0_f64, vec![0.0]);
    for now in &flight {
        largest_dbar = if now.depth_m < 2.0 { 0.0 } else { largest_dbar.max(now.pressure_pa * 1e-4) };
        at.push(largest_dbar);
    }
    for (row, now) in rows(&sea, &flight).filter(|(_, now)| now.depth_m > 5.0) {
        let (dbar, largest) = (now.pressure_pa * 1e-4, at[place(now) + 1]);
        let more = 0.012 * dbar * (1.0 - dbar / largest);
        assert!((sea.log.pressure_dbar[row] - dbar - more).abs() < 1e-6, "{more}");
    }
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
        let neutral = Hidden::nothing(&sea.truth.vehicle) == Hidden::new(&sea.truth.effects, &sea.truth.vehicle);
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

#[test]
fn forces_outside_the_catalogue_are_as_defined() {
    let vehicle = still("none").0.truth.vehicle;
    let pressed = |now: &Instant| 0.5 * now.water.density_kg_m3 * now.speed_m_s.powi(2);
    closes("uncatalogued-wing-flex=0.005", |now, hand| ByHand {
        lift: hand.lift * (1.0 - 0.005 * pressed(now)),
        ..hand
    });
    closes("uncatalogued-bearing-friction=0.05", |now, hand| ByHand {
        drag: hand.drag + 0.05 / (pressed(now) * vehicle.frontal_area_m2),
        ..hand
    });
    closes("uncatalogued-tether=0.08", |now, hand| ByHand { drag: hand.drag * (1.0 + 0.0008 * now.depth_m), ..hand });
    closes("uncatalogued-foam-crush=20", |now, hand| ByHand {
        volume_m3: hand.volume_m3 - 20e-6 * (1.0 - (-now.pressure_pa / 5e5).exp()),
        ..hand
    });
    closes("uncatalogued-burped-air=100", |now, hand| {
        let air = if now.pitch_rad < 0.0 { 100e-6 * 101_325.0 / (101_325.0 + now.pressure_pa) } else { 0.0 };
        ByHand { volume_m3: hand.volume_m3 + air, ..hand }
    });
    closes("uncatalogued-engine-backlash=20", |now, hand| {
        let lost = if now.pitch_rad < 0.0 { -10e-6 } else { 10e-6 };
        ByHand { volume_m3: hand.volume_m3 - lost, ..hand }
    });
    let (sea, _) = still("uncatalogued-wing-loss=0.3");
    let from_s = sea.truth.parameter("lift_lost_from_s").expect("a time");
    closes("uncatalogued-wing-loss=0.3", |now, hand| ByHand {
        lift: hand.lift * if now.time_s >= from_s { 0.7 } else { 1.0 },
        ..hand
    });
}

#[test]
fn readings_outside_the_catalogue_are_as_defined() {
    let (sea, flight) = still("uncatalogued-pitch-rounding=0.03");
    for (row, now) in rows(&sea, &flight) {
        let steps = sea.log.pitch_rad[row] / 0.03;
        assert!((steps - steps.round()).abs() < 1e-9 && (sea.log.pitch_rad[row] - now.pitch_rad).abs() < 0.0151);
    }
    let (sea, flight) = still("speed_scale=1.05");
    let speeds = sea.log.speed_through_water_m_s.as_ref().expect("a speed");
    for (row, now) in rows(&sea, &flight) {
        assert!((speeds[row] - 1.05 * now.speed_m_s).abs() < 1e-9);
    }
}
