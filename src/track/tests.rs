use super::*;
use crate::vehicle::Vehicle;

fn samples(heading_deg: f64, dives: u32) -> Vec<Sample> {
    // Straight glides of one hour, one sample in ten seconds.
    (0..dives)
        .flat_map(|dive| {
            (0..=360).map(move |i| Sample {
                time_s: f64::from(dive) * 4000.0 + f64::from(i) * 10.0,
                dive,
                depth_m: 50.0,
                pitch_rad: -25f64.to_radians(),
                heading_rad: heading_deg.to_radians(),
                ballast_m3: -200e-6,
                density_kg_m3: 1025.0,
                temperature_C: 15.0,
            })
        })
        .collect()
}

fn glider() -> Parameters<f64> {
    Vehicle::load("slocum-049").unwrap().parameters().unwrap()
}

fn horizontal_m_s(p: &Parameters<f64>) -> f64 {
    let water = Surroundings { density_kg_m3: 1025.0, pressure_Pa: 0.0, temperature_C: 15.0, time_s: 0.0 };
    let attitude = Attitude { pitch_rad: -25f64.to_radians(), net_mass_kg: p.net_mass_kg(-200e-6, &water) };
    at_pitch(p, &water, attitude).unwrap().horizontal_velocity_m_s
}

#[test]
fn a_straight_glide_goes_where_it_points() {
    let p = glider();
    let settings = TrackSettings { declination_rad: -10f64.to_radians(), ..TrackSettings::default() };
    let track = reckon(&p, &[], &samples(100.0, 1), &settings);
    let way = horizontal_m_s(&p) * 3600.0;
    let dive = &track.dives[0];
    assert!((dive.east_m - way).abs() < 1e-6 * way && dive.north_m.abs() < 1e-6 * way, "{dive:?}");
    // Across the way the compass alone errs.
    assert!((dive.north_se_m - way * 3f64.to_radians()).abs() < 1e-6 * way, "{dive:?}");
    assert!(dive.east_se_m < 1e-6 * way);
    assert_eq!(track.points.len(), 361);
}

#[test]
fn an_uncertain_polar_errs_along_the_way() {
    let p = glider();
    let moved = Parameters { b: p.b * 1.1, ..p };
    let track =
        reckon(&p, &[moved], &samples(0.0, 1), &TrackSettings { heading_error_rad: 0.0, ..TrackSettings::default() });
    let expected = (horizontal_m_s(&p) - horizontal_m_s(&moved)).abs() * 3600.0;
    assert!((track.dives[0].north_se_m / expected - 1.0).abs() < 1e-9, "{:?}", track.dives[0]);
}

#[test]
fn fixes_around_a_dive_give_the_current_that_carried_it() {
    let p = glider();
    let mut track = reckon(&p, &[], &samples(90.0, 2), &TrackSettings::default());
    // 0.1 m/s east and -0.05 m/s north on top, in degrees at 43 S, where a minute of latitude is 1851.3 m.
    let way = horizontal_m_s(&p) * 3600.0;
    let mut fixes = vec![Fix { time_s: 0.0, lat_deg: -43.0, lon_deg: 179.99 }];
    for (time_s, ways, drift_s) in [(3600.0, 1.0, 3600.0), (4000.0, 1.0, 4000.0), (7600.0, 2.0, 7600.0)] {
        let (east, north) = (ways * way + 0.1 * drift_s, -0.05 * drift_s);
        let lat_deg = -43.0 + north / 111_097.0;
        let lon_deg = (179.99 + east / 81_541.0 + 180.0) % 360.0 - 180.0;
        fixes.push(Fix { time_s, lat_deg, lon_deg });
    }
    let errors_m = |track: &Track| {
        let current = track.dives[0].current.expect("fixes lie on both sides");
        [current.east_se_m_s * current.duration_s, current.north_se_m_s * current.duration_s]
    };
    track.set_currents(&fixes, 0.0);
    let without = errors_m(&track);
    track.set_currents(&fixes, 50.0);
    for (with, without) in errors_m(&track).iter().zip(without) {
        // Two fixes of 50 m on top of the way reckoned.
        assert!((with.powi(2) - without.powi(2) - 2.0 * 50f64.powi(2)).abs() < 1e-6, "{with} {without}");
    }
    for dive in &track.dives {
        let current = dive.current.expect("fixes lie on both sides");
        assert!((current.east_m_s - 0.1).abs() < 1e-3 && (current.north_m_s + 0.05).abs() < 1e-3, "{current:?}");
    }
    // Without a fix between the dives neither has a current of its own.
    track.dives.iter_mut().for_each(|dive| dive.current = None);
    track.set_currents(&[fixes[0], fixes[3]], 50.0);
    assert!(track.dives.iter().all(|dive| dive.current.is_none()));
}

#[test]
fn turns_and_gaps_are_counted_and_not_flown() {
    let p = glider();
    let mut log = samples(90.0, 1);
    for sample in &mut log[100..110] {
        // Nose down and light: no glide.
        sample.ballast_m3 = 200e-6;
    }
    for sample in &mut log[200..] {
        sample.time_s += 1000.0;
    }
    let track = reckon(&p, &[], &log, &TrackSettings::default());
    let dive = &track.dives[0];
    assert_eq!(dive.without_glide, 10);
    assert_eq!(dive.gaps_s, 1010.0);
    // Eleven of 360 intervals touch the turn, the outer two by half; one is the gap.
    let expected = horizontal_m_s(&p) * 10.0 * (360.0 - 10.0 - 1.0);
    assert!((dive.east_m / expected - 1.0).abs() < 1e-9, "{} against {expected}", dive.east_m);
}

#[test]
fn months_without_a_record_are_in_no_dive_and_no_current() {
    let p = glider();
    let mut log = samples(90.0, 1);
    let months_s = 8065.0 * 3600.0;
    log[200..].iter_mut().for_each(|sample| sample.time_s += months_s);
    let mut track = reckon(&p, &[], &log, &TrackSettings::default());
    assert!((track.dives[0].recorded_s() - 3590.0).abs() < 1e-6, "{:?}", track.dives[0]);
    let gaps = track.long_gaps();
    assert_eq!(gaps, [[1990.0, 2000.0 + months_s]]);
    let said = plausibility::long_gap(gaps[0]);
    assert!(said.contains("336.0 days") && said.contains("from 1990 s"), "{said}");
    let fix = |time_s: f64| Fix { time_s, lat_deg: 54.0, lon_deg: 10.0 };
    let fixes = [fix(0.0), fix(3600.0 + months_s)];
    track.set_currents(&fixes, 50.0);
    assert!(track.dives[0].current.is_none() && track.drifts(&fixes, 50.0).is_empty());
}

#[test]
fn degrees_become_metres_of_the_ellipsoid() {
    let at = |lat_deg: f64, lon_deg: f64| Fix { time_s: 0.0, lat_deg, lon_deg };
    // A degree of latitude at 45 deg is 111132 m, a degree of longitude at the equator 111319.49 m.
    assert!((displacement_m(&at(44.5, 0.0), &at(45.5, 0.0))[1] - 111_132.0).abs() < 2.0);
    assert!((displacement_m(&at(0.0, -0.5), &at(0.0, 0.5))[0] - 111_319.49).abs() < 0.01);
    assert!((displacement_m(&at(60.0, 0.0), &at(60.0, 1.0))[0] - 55_800.0).abs() < 1.0);
}

#[test]
fn positions_in_the_middle_of_dives_give_the_current_between_them() {
    let p = glider();
    let track = reckon(&p, &[], &samples(90.0, 3), &TrackSettings::default());
    // Fixes in the middle of each dive on the equator, carried by 0.08 east and 0.03 north.
    let middle = |dive: u32| f64::from(dive) * 4000.0 + 1800.0;
    let fix = |dive: u32| {
        let way = horizontal_m_s(&p) * (1800.0 + f64::from(dive) * 3600.0);
        let drift = 0.08 * middle(dive);
        Fix { time_s: middle(dive), lat_deg: 0.03 * middle(dive) / 110_574.4, lon_deg: (way + drift) / 111_319.49 }
    };
    let found = track.drifts(&[fix(0), fix(1), fix(2)], 0.0);
    assert_eq!(found.len(), 2);
    for drift in found {
        assert!((drift.current.east_m_s - 0.08).abs() < 1e-4, "{drift:?}");
        assert!((drift.current.north_m_s - 0.03).abs() < 1e-4, "{drift:?}");
        // Half of two dives, each of which errs by 3 deg across its way.
        let expected = horizontal_m_s(&p) * 1800.0 * 3f64.to_radians() * 2f64.sqrt() / 4000.0;
        assert!((drift.current.north_se_m_s / expected - 1.0).abs() < 1e-6, "{drift:?} against {expected}");
    }
}
