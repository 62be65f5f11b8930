//! Whole logs: determinism, plausibility, what the analyst gets to see.

use glidepolar_virtual_sea::catalogue::{TABLE, parse_requests};
use glidepolar_virtual_sea::flight::Instant;
use glidepolar_virtual_sea::vehicle::Hull;
use glidepolar_virtual_sea::{Options, Sea, generate, generate_observed, log};

fn with(seed: u64, effect: &str) -> Options {
    Options { effects: parse_requests(effect).expect("a list of effects"), ..Options::seeded(seed) }
}

#[test]
fn a_seed_gives_the_same_log_to_the_last_bit_and_another_seed_another() {
    let once = generate(&with(5, "leak,pitch_offset"));
    let twice = generate(&with(5, "leak,pitch_offset"));
    assert_eq!(once.log.to_csv(), twice.log.to_csv());
    assert_eq!(once.vehicle_toml, twice.vehicle_toml);
    assert_eq!(once.truth.to_json(), twice.truth.to_json());
    assert_ne!(once.log.to_csv(), generate(&with(6, "leak,pitch_offset")).log.to_csv());
}

#[test]
fn seed_decides_ocean_vehicle_and_mission_whatever_is_hidden() {
    let (plain, hidden) = (generate(&with(8, "none")), generate(&with(8, "drag_growth")));
    assert_eq!(plain.vehicle_toml, hidden.vehicle_toml);
    assert_eq!(plain.truth.vehicle, hidden.truth.vehicle);
    assert_eq!(plain.truth.ocean.wave_rms_m_s, hidden.truth.ocean.wave_rms_m_s);
    let alone = generate(&with(8, "drag_growth")).truth.parameter("drag_growth_per_day");
    let in_company = generate(&with(8, "leak,drag_growth")).truth.parameter("drag_growth_per_day");
    assert!(alone.is_some() && alone == in_company);
}

#[test]
fn logs_look_like_a_gliders() {
    for seed in (0..12).chain([1003]) {
        let mut flight: Vec<Instant> = Vec::new();
        let sea = generate_observed(&Options::seeded(seed), |now| flight.push(*now));
        let log = &sea.log;
        assert!((12..=19).contains(&sea.truth.dives), "seed {seed}: {} dives", sea.truth.dives);
        assert!((5000..10_500).contains(&log.len()), "{} rows", log.len());
        assert!(log.time_s.windows(2).all(|pair| pair[1] > pair[0]));
        let deepest = log.pressure_dbar.iter().copied().fold(0.0, f64::max);
        assert!((150.0..470.0).contains(&deepest), "seed {seed}: {deepest} dbar");
        let gliding: Vec<&Instant> =
            flight.iter().filter(|now| now.depth_m > 25.0 && now.angle_rad.abs() < 0.15).collect();
        // Separated flow is for inflections: it takes little of the time.
        let below = flight.iter().filter(|now| now.depth_m > 25.0).count();
        assert!(gliding.len() as f64 > 0.93 * below as f64, "seed {seed}: {} of {below}", gliding.len());
        let fastest = gliding.iter().map(|now| now.speed_m_s).fold(0.0, f64::max);
        assert!((0.3..0.65).contains(&fastest), "seed {seed}: {fastest} m/s");
        let steepest = flight.iter().map(|now| now.pitch_rad.abs()).fold(0.0, f64::max);
        assert!(steepest < 1.2, "seed {seed}: {steepest} rad");
    }
}

#[test]
fn glides_are_varied_enough_to_learn_from() {
    for seed in 0..12 {
        let mut legs: Vec<(f64, f64)> = Vec::new();
        generate_observed(&Options::seeded(seed), |now| {
            if now.depth_m > 60.0 && now.time_s % 600.0 == 0.0 {
                legs.push((now.pitch_rad, now.engine_cc));
            }
        });
        for leg_sign in [-1.0, 1.0] {
            let pitches = || legs.iter().map(|leg| leg.0 * leg_sign).filter(|pitch| *pitch > 0.0);
            let (low, high) = pitches().fold((9.0_f64, 0.0_f64), |(low, high), p| (low.min(p), high.max(p)));
            assert!(high - low > 10_f64.to_radians(), "seed {seed}: pitch from {low} to {high} rad");
        }
    }
}

#[test]
fn strong_effects_do_not_keep_the_glider_from_diving() {
    for effect in TABLE.iter().map(|effect| effect.name) {
        for seed in 0..2 {
            let sea = generate(&with(seed, effect));
            assert!((10..=20).contains(&sea.truth.dives), "{effect}, seed {seed}: {} dives", sea.truth.dives);
            let last = sea.log.time_s.iter().zip(&sea.log.pressure_dbar).filter(|(time, _)| **time > 36_000.0);
            let (low, high) = last.fold((999.0_f64, 0.0_f64), |(low, high), (_, p)| (low.min(*p), high.max(*p)));
            assert!(low < 15.0 && high > 60.0, "{effect}, seed {seed}: stuck between {low} and {high} dbar");
        }
    }
}

#[test]
fn a_seaglider_dives_deep() {
    let sea = generate(&Options { hull: Some(Hull::Seaglider), dives: 3, ..Options::seeded(2) });
    let deepest = sea.log.pressure_dbar.iter().copied().fold(0.0, f64::max);
    assert!(deepest > 600.0, "{deepest} dbar");
}

#[test]
fn the_vehicle_file_holds_true_masses_and_wrong_coefficients() {
    for seed in 0..20 {
        let sea = generate(&Options { hours: 0.5, ..with(seed, "ballast_offset,hull_compressibility") });
        let file: toml::Table = sea.vehicle_toml.parse().expect("valid TOML");
        let number = |section: &str, key: &str| file[section][key].as_float().expect("a number");
        let vehicle = &sea.truth.vehicle;
        assert_eq!(number("mass", "mass_kg"), vehicle.mass_kg);
        assert_eq!(number("mass", "displaced_volume_m3"), vehicle.displaced_volume_m3);
        assert_eq!(number("hull", "compressibility_per_Pa"), vehicle.compressibility_per_pa);
        assert_ne!(sea.truth.parameter("hull_compressibility_per_Pa"), Some(vehicle.compressibility_per_pa));
        let pairs = [
            ("a_per_rad", vehicle.a_per_rad),
            ("b", vehicle.b),
            ("c_per_rad2", vehicle.c_per_rad2),
            ("d_per_rad", vehicle.d_per_rad),
        ];
        for (key, truth) in pairs {
            let off = (number("hydro", key) / truth - 1.0).abs();
            assert!((0.095..0.205).contains(&off), "{key} off by {off}");
        }
    }
}

#[test]
fn the_speed_is_there_only_when_asked_for() {
    let sea = generate(&Options { speed: false, hours: 1.0, ..Options::seeded(4) });
    assert_eq!(sea.log.speed_through_water_m_s, None);
    assert!(!sea.log.to_csv().contains("speed"));
}

#[test]
fn measurement_noise_is_what_the_truth_says() {
    let mut flight: Vec<Instant> = Vec::new();
    let sea = generate_observed(&Options::seeded(9), |now| flight.push(*now));
    let log = &sea.log;
    let rms = |errors: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = errors.filter(|e| e.is_finite()).fold((0.0, 0.0), |(s, n), e| (s + e * e, n + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    };
    let truth = |row: usize| &flight[(log.time_s[row] * 4.0).round() as usize];
    let pressure = rms(&mut (0..log.len()).map(|i| log.pressure_dbar[i] - truth(i).pressure_pa * 1e-4));
    let pitch = rms(&mut (0..log.len()).map(|i| log.pitch_rad[i] - truth(i).pitch_rad));
    let speeds = log.speed_through_water_m_s.as_ref().expect("a speed");
    let speed = rms(&mut (0..log.len()).map(|i| speeds[i] - truth(i).speed_m_s));
    let quality = sea.truth.quality;
    assert!((pressure / quality.pressure_dbar - 1.0).abs() < 0.1, "{pressure}");
    assert!((pitch / quality.pitch_rad.hypot(quality.pitch_wander_rad) - 1.0).abs() < 0.15, "{pitch}");
    assert!((speed / quality.speed_m_s.hypot(quality.speed_wander_m_s) - 1.0).abs() < 0.05, "{speed}");
}

#[test]
fn the_folder_keeps_the_truth_apart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sea: Sea = generate(&Options { hours: 0.5, ..with(3, "trapped_air=70,uncatalogued-tide") });
    log::write(&sea.log, &sea.vehicle_toml, &sea.truth.to_json(), folder.path()).expect("a folder that can be written");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
    let (log, vehicle, truth) = (read("log.csv"), read("vehicle.toml"), read("truth.json"));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 3);
    for given in [&log, &vehicle] {
        assert!(!given.contains("trapped") && !given.contains("tide") && !given.contains("seed"));
    }
    let truth: serde_json::Value = serde_json::from_str(&truth).expect("valid JSON");
    assert_eq!(truth["effects"][0]["parameters"]["trapped_air_cc"], 70.0);
    assert_eq!(truth["effects"][1]["catalogued"], false);
    let header = log.lines().next().expect("a header");
    assert_eq!(header.split(',').count(), log.lines().nth(100).expect("a row").split(',').count());
}
