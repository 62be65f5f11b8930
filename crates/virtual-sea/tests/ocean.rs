//! The water against published values and plain requirements.

use glidepolar_virtual_sea::ocean::{GRAVITY_M_S2, Ocean, Wander, Weather, density_eos80};
use glidepolar_virtual_sea::random::{Part, stream};

/// UNESCO Technical Papers in Marine Science 44 (1983): S, t68 in degrees Celsius, p in dbar, rho in kg/m3.
const PUBLISHED: [(f64, f64, f64, f64); 8] = [
    (0.0, 5.0, 0.0, 999.96675),
    (0.0, 5.0, 10_000.0, 1044.12802),
    (0.0, 25.0, 0.0, 997.04796),
    (0.0, 25.0, 10_000.0, 1037.90204),
    (35.0, 5.0, 0.0, 1027.67547),
    (35.0, 5.0, 10_000.0, 1069.48914),
    (35.0, 25.0, 0.0, 1023.34306),
    (35.0, 25.0, 10_000.0, 1062.53817),
];

#[test]
fn density_agrees_with_the_published_check_values() {
    for (salinity, t68, pressure, expected) in PUBLISHED {
        let found = density_eos80(salinity, t68 / 1.00024, pressure);
        assert!((found - expected).abs() < 6e-6, "S {salinity} t {t68} p {pressure}: {found} against {expected}");
    }
}

fn oceans() -> impl Iterator<Item = Ocean> {
    (0..30).map(|seed| Ocean::draw(&mut stream(seed, Part::Ocean), Weather::default()))
}

#[test]
fn the_column_is_hydrostatic_and_stably_stratified() {
    for ocean in oceans() {
        for depth in (1..900).map(f64::from) {
            let here = ocean.water(depth, 0.0).density_kg_m3;
            let below = ocean.water(depth + 1.0, 0.0).density_kg_m3;
            let weight = (ocean.pressure_pa(depth + 1.0) - ocean.pressure_pa(depth)) / GRAVITY_M_S2;
            assert!((weight - here).abs() < 0.02, "{weight} against {here} at {depth} m");
            // Pressure alone adds 4.4e-3 to 4.7e-3 kg/m3 per metre.
            assert!(below - here > 4.3e-3, "unstable at {depth} m: {}", below - here);
        }
        assert_eq!(ocean.pressure_pa(-1.0), 0.0);
    }
}

#[test]
fn waves_are_still_at_the_surface_and_have_their_rms_below() {
    for ocean in oceans().take(8) {
        let rms_at = |depth: f64| {
            let times = (0..20_000).map(|i| f64::from(i) * 47.0);
            let mean = times.map(|time| ocean.heave(&ocean.waves(time), depth).0.powi(2)).sum::<f64>() / 20_000.0;
            mean.sqrt()
        };
        assert_eq!(rms_at(0.0), 0.0);
        let strongest = (1..40).map(|i| rms_at(f64::from(i) * 10.0)).fold(0.0, f64::max) / ocean.wave_rms_m_s;
        assert!((0.6..1.05).contains(&strongest), "{strongest}");
        assert!((0.003..=0.007).contains(&ocean.wave_rms_m_s));
    }
}

#[test]
fn waves_step_by_step_are_those_of_the_time() {
    for ocean in oceans().take(3) {
        let mut by_step = ocean.waves_by_step(0.25);
        for step in 0..172_800 {
            if step % 1440 == 0 {
                let (velocity, heave) = ocean.heave(&ocean.waves(f64::from(step) * 0.25), 70.0);
                let (stepped_velocity, stepped_heave) = ocean.heave(&by_step.waves(), 70.0);
                assert!((stepped_velocity - velocity).abs() < 1e-12 && (stepped_heave - heave).abs() < 1e-9, "{step}");
            }
            by_step.advance();
        }
    }
}

#[test]
fn heave_is_the_integral_of_the_waves_velocity() {
    for ocean in oceans().take(5) {
        for time in (0..200).map(|i| f64::from(i) * 211.0) {
            let (_, before) = ocean.heave(&ocean.waves(time), 70.0);
            let (_, after) = ocean.heave(&ocean.waves(time + 5.0), 70.0);
            let (velocity, _) = ocean.heave(&ocean.waves(time + 2.5), 70.0);
            assert!(((after - before) / 5.0 - velocity).abs() < 1e-6);
        }
    }
}

#[test]
fn turbulence_has_its_spread_and_memory() {
    let random = &mut stream(3, Part::Path);
    let mut wander = Wander::new(random, 0.004, 40.0, 0.25);
    let values: Vec<f64> = (0..400_000).map(|_| wander.next(random)).collect();
    let product =
        |lag: usize| values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum::<f64>() / (values.len() - lag) as f64;
    // 100 000 s hold 1250 independent stretches of 80 s: the variance is known to 4 %.
    assert!((product(0).sqrt() / 0.004 - 1.0).abs() < 0.1, "{}", product(0).sqrt());
    assert!((product(160) / product(0) - (-1.0_f64).exp()).abs() < 0.1);
}
