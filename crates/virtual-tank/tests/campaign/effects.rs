//! Hidden effects, without noise: each does what its line in the catalogue says, by hand, and nothing else.

use glidepolar_virtual_tank::{CATALOGUE, Options};

use crate::support::{Campaign, Row, requests};

/// Two campaigns that differ by one effect, run by run.
fn compare(effect: &str, mut check: impl FnMut(&Campaign, &Campaign, &Row)) {
    let (without, with) = (Campaign::quiet("LDR9.5", "none"), Campaign::quiet("LDR9.5", effect));
    assert_eq!(without.rows.len(), with.rows.len(), "{effect} leaves the programme as it was");
    for row in &with.rows {
        check(&without, &with, row);
    }
}

fn near(found: f64, expected: f64, margin: f64, what: &dyn std::fmt::Debug) {
    assert!((found - expected).abs() < margin, "{what:?}: {found} against {expected}");
}

fn at(campaign: &Campaign, speed: f64, yaw_deg: f64) -> &Row {
    campaign.of_kind("static").find(|row| row.speed == speed && row.yaw_deg == Some(yaw_deg)).unwrap()
}

/// Shifts appear in their channel under way with a model, and neither at rest nor with the strut alone.
#[test]
fn zeros_shift_under_way_only() {
    for (effect, column, size) in
        [("axial_force_zero", 4, 0.5), ("side_force_zero", 5, -0.7), ("yaw_moment_zero", 6, 0.4)]
    {
        compare(&format!("{effect}={size}"), |without, with, row| {
            let shift = if matches!(row.kind.as_str(), "zero" | "tare") { 0.0 } else { size };
            let (steady, reference) = (with.steady(row), without.steady(row));
            for (a, b) in steady.iter().zip(&reference) {
                (4..7).for_each(|i| near(a[i] - b[i], if i == column { shift } else { 0.0 }, 2.1e-4, row));
            }
            near(with.samples(row)[0][column], without.samples(row)[0][column], 2e-4, row);
        });
    }
}

#[test]
fn misalignment_is_an_angle_that_nobody_sees() {
    compare("yaw_misalignment=0.8", |_, with, row| {
        if row.kind == "static" {
            let c = with.hull().0.coefficients;
            let true_alpha = (row.yaw_deg.unwrap() + 0.8).to_radians();
            // Turn the recorded frame into the true one: the strut turns with it and is tared at the same true angle.
            let [cl, cd, cm] = with.coefficients(row);
            let (sine, cosine) = 0.8f64.to_radians().sin_cos();
            near(cl * cosine - cd * sine, c.a * true_alpha, 1e-4, row);
            near(cd * cosine + cl * sine, c.b + c.c * true_alpha * true_alpha, 1e-4, row);
            near(cm, c.d * true_alpha, 1e-4, row);
            assert!(with.steady(row).iter().all(|sample| (sample[2] - row.yaw_deg.unwrap()).abs() < 1e-9));
        }
    });
}

#[test]
fn recorded_speed_is_off_by_the_scale() {
    compare("speed_scale=1.03", |without, with, row| {
        if row.kind == "static" || row.kind == "tare" {
            let (a, b) = (with.mean_force(row), without.mean_force(row));
            (0..3).for_each(|i| near(a[i], 1.03 * 1.03 * b[i], 2e-3 + 1e-4 * b[i].abs(), row));
        }
        if row.kind != "arc" {
            assert!(with.steady(row).iter().all(|sample| (sample[1] - row.speed).abs() < 1e-4));
        }
    });
}

#[test]
fn cross_talk_and_moment_centre_act_on_forces() {
    compare("interaction=0.03,moment_centre_error=0.02", |without, with, row| {
        if row.kind == "static" {
            let (a, b) = (with.mean_force(row), without.mean_force(row));
            near(a[0] - b[0], 0.03 * b[1], 5e-4, row);
            near(a[1], b[1], 5e-4, row);
            near(a[2] - b[2], 0.02 * b[1], 5e-4, row);
        }
    });
}

/// The crooked drift is the stated exponential, in one channel, and straight lines between the zeros miss it.
#[test]
fn zero_drift_is_missed_by_straight_lines() {
    let mut greatest_miss: f64 = 0.0;
    compare("zero_drift=4", |without, with, row| {
        let effect = &with.truth.effects[0];
        let channel = if effect.detail.contains("AF") { 0 } else { 1 };
        let time_constant: f64 = effect.detail.split(' ').rev().nth(1).unwrap().parse().unwrap();
        let hours = (row.start_s % 86_400.0) / 3600.0;
        let run_away = 4.0 * time_constant * (1.0 - (-hours / time_constant).exp());
        let drift = [0, 1, 2].map(|i| with.run(row).zero[i] - without.run(row).zero[i]);
        (0..3).for_each(|i| near(drift[i], if i == channel { run_away } else { 0.0 }, 2e-3, row));
        near(with.samples(row)[0][4 + channel] - without.samples(row)[0][4 + channel], run_away, 2e-3, row);
        if row.kind != "zero" {
            let miss = with.zero(row, 0.0)[channel] - with.run(row).zero[channel];
            greatest_miss = greatest_miss.max(miss.abs());
        }
    });
    assert!(greatest_miss > 0.3, "{greatest_miss} N");
}

#[test]
fn an_untared_strut_is_never_towed_alone() {
    let campaign = Campaign::quiet("LDR9.5", "strut_tare=1.7");
    assert_eq!(campaign.of_kind("tare").count(), 0);
    let row = at(&campaign, 2.0, 0.0);
    let [_, cd, _] = campaign.coefficients_of(row, campaign.mean_force(row));
    let scale = 0.5 * crate::support::density(row.temperature_c) * 4.0 * crate::support::area();
    near((cd - campaign.hull().0.coefficients.b) * scale, 1.7, 3e-3, row);
}

/// b falls along the friction line 0.075/(log10 Re - 2)^2 and is itself at 2 m/s.
#[test]
fn reynolds_drag_follows_a_friction_line() {
    let campaign = Campaign::quiet("LDR9.5", "reynolds_drag=-0.15");
    let b = campaign.hull().0.coefficients.b;
    let loa = campaign.hull().1.loa_m;
    let distance = |speed: f64, nu: f64| (speed * loa / nu).log10() - 2.0;
    for speed in [1.0, 1.5, 2.0, 2.5, 3.0] {
        let row = at(&campaign, speed, 0.0);
        // Viscosity within the tank's 11 to 20 C, linear about 15 C, m2/s.
        let nu = 1.1386e-6 * (-0.0258 * (row.temperature_c - 15.0)).exp();
        let power = 2.0 * 0.15 * std::f64::consts::LN_10 * distance(2.0, 1.1386e-6);
        let expected = b * (distance(2.0, 1.1386e-6) / distance(speed, nu)).powf(power);
        near(campaign.coefficients(row)[1], expected, 1.5e-3 * b, row);
    }
}

#[test]
fn a_wrong_temperature_is_on_paper_only() {
    let mut days = Vec::new();
    compare("water_temperature=6", |without, with, row| {
        assert_eq!(with.samples(row), without.samples(row));
        let off = row.temperature_c - without.rows[row.number].temperature_c;
        near(row.temperature_c - off, with.run(row).temperature_c, 0.006, row);
        if off != 0.0 {
            near(off, 6.0, 1e-9, row);
            days.push((row.start_s / 86_400.0) as usize);
        }
    });
    days.dedup();
    assert_eq!(days.len(), 1, "one day: {days:?}");
}

#[test]
fn port_and_starboard_differ_by_the_ratio() {
    compare("port_starboard_asymmetry=1.12", |_, with, row| {
        if row.kind == "static" && row.yaw_deg > Some(1.0) {
            let other = at(with, row.speed, -row.yaw_deg.unwrap());
            let (here, there) = (with.coefficients(row), with.coefficients(other));
            near(-here[0] / there[0], 1.12, 2e-3, row);
            near(-here[2] / there[2], 1.12, 2e-3, row);
            near(here[1], there[1], 2e-4, row);
        }
    });
}

/// Normal force K sin|sin| on top: lift gains its cosine part, drag its sine part.
#[test]
fn crossflow_bends_lift_and_drag() {
    compare("crossflow=5", |_, with, row| {
        if row.kind == "static" && row.speed == 2.0 {
            let c = with.hull().0.coefficients;
            let alpha = row.yaw_deg.unwrap().to_radians();
            let normal = 5.0 * alpha.sin() * alpha.sin().abs();
            let [cl, cd, cm] = with.coefficients(row);
            near(cl, c.a * alpha + normal * alpha.cos(), 1e-4, row);
            near(cd, c.b + c.c * alpha * alpha + normal * alpha.sin(), 1e-4, row);
            assert!(alpha == 0.0 || (cm - c.d * alpha) * alpha < 0.0, "it acts behind the centre of buoyancy");
        }
    });
}

#[test]
fn a_separation_bubble_bursts_on_one_side() {
    compare("uncatalogued-separation-bubble=0.1", |without, with, row| {
        if row.kind == "static" {
            let detail = &with.truth.effects[0].detail;
            let onset: f64 = detail.split(' ').rev().nth(1).unwrap().parse().unwrap();
            let side = if detail.contains("starboard") { 1.0 } else { -1.0 };
            let beyond = side * row.yaw_deg.unwrap() - onset;
            let loss = side * (without.coefficients(row)[0] - with.coefficients(row)[0]);
            if beyond > 1.0 {
                near(loss, 0.1, 1e-3, row);
            } else if beyond < -1.0 {
                near(loss, 0.0, 1e-3, row);
            }
        }
    });
}

#[test]
fn weed_stays_until_the_hull_is_changed() {
    let mut caught = Vec::new();
    compare("uncatalogued-weed=0.015", |without, with, row| {
        if row.kind == "static" {
            let extra = with.coefficients(row)[1] - without.coefficients(row)[1];
            near(extra * (extra - 0.015), 0.0, 1e-5, row);
            caught.push(extra > 0.007);
        }
    });
    assert!(caught.is_sorted() && !caught[0] && caught[caught.len() - 1]);
}

#[test]
fn waves_and_currents_of_the_tank() {
    // Froude numbers 0.23, 0.34, 0.46, 0.58, 0.69: two humps and calm water on either side.
    let mut humps = vec![0.0; 6];
    compare("free_surface=0.02", |without, with, row| {
        if row.kind == "static" && row.yaw_deg == Some(0.0) {
            humps[(2.0 * row.speed) as usize - 1] = with.coefficients(row)[1] - without.coefficients(row)[1];
        }
    });
    let [_, slow, first, second, past, fast] = humps[..] else { panic!() };
    assert!(
        slow < 0.001 && first > 0.007 && second > 0.015 && past > 0.007 && past < second && fast < 0.001,
        "{humps:?}"
    );
    // Following water means less drag, never more; by up to twice the current's share of the speed.
    let mut most: f64 = 0.0;
    compare("uncatalogued-residual-current=0.1", |without, with, row| {
        if row.kind == "static" && row.yaw_deg == Some(0.0) {
            let missing = 1.0 - with.coefficients(row)[1] / without.coefficients(row)[1];
            assert!((-1e-3..0.3).contains(&missing), "{row:?}: {missing}");
            most = most.max(missing);
        }
    });
    assert!(most > 0.01, "{most}");
    // A transverse current swings: side forces at zero yaw of either sign over a day.
    let mut sides = Vec::new();
    compare("uncatalogued-gyre=0.02", |without, with, row| {
        if row.kind == "static" {
            sides.push(with.mean_force(row)[1] - without.mean_force(row)[1]);
        }
    });
    assert!(sides.iter().any(|side| *side > 0.05) && sides.iter().any(|side| *side < -0.05), "{sides:?}");
}

#[test]
fn a_wrong_sign_turns_one_column() {
    for (effect, column) in [("wrong-sign-sf", 5), ("wrong-sign-ym", 6)] {
        compare(effect, |without, with, row| {
            for (a, b) in with.samples(row).iter().zip(without.samples(row)) {
                (0..7).for_each(|i| assert_eq!(a[i], if i == column { -b[i] } else { b[i] }, "{row:?}"));
            }
        });
    }
}

/// Drawn sizes lie within the catalogue's bounds, of both signs where that makes sense, and depend on the seed.
#[test]
fn sizes_are_drawn_from_the_seed() {
    for entry in CATALOGUE {
        let mut sizes = Vec::new();
        for seed in 0..3 {
            let options = Options {
                seed,
                hulls: vec!["LDR8.5".to_owned()],
                effects: requests(entry.name),
                size_mb: Some(3.0),
                ..Options::default()
            };
            let campaign = Campaign::write(&options);
            let effect = &campaign.truth.effects[0];
            assert_eq!((effect.name.as_str(), effect.parameter.as_str()), (entry.name, entry.parameter));
            assert!((entry.bounds.0..=entry.bounds.1).contains(&effect.value));
            sizes.push(effect.value);
        }
        let same = sizes.windows(2).filter(|pair| pair[0] == pair[1]).count();
        let fixed = entry.name.starts_with("wrong-sign");
        assert_eq!(same, if fixed { sizes.len() - 1 } else { 0 }, "{}: {sizes:?}", entry.name);
    }
}
