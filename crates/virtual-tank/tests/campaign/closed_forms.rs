//! Without noise every run is a closed form of the stated truth.

use std::f64::consts::TAU;

use crate::support::{Campaign, Row, Sample, area, density, regress};

/// Static runs: CL = a alpha, CD = b + c alpha^2, CM = d alpha about the centre of buoyancy, at every speed and angle.
#[test]
fn static_runs_obey_the_stated_law() {
    for hull in ["LDR8.5", "LDR12.5"] {
        let campaign = Campaign::quiet(hull, "none");
        let stated = campaign.hull().0.coefficients;
        let mut count = 0;
        for row in campaign.of_kind("static") {
            let alpha = row.yaw_deg.unwrap().to_radians();
            let [cl, cd, cm] = campaign.coefficients(row);
            let expected = [stated.a * alpha, stated.b + stated.c * alpha * alpha, stated.d * alpha];
            // One unit of the last place of a reading at this speed.
            let last_place = 2e-4 / (500.0 * row.speed * row.speed * area());
            for (found, expected) in [cl, cd, cm].into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < last_place + 1e-4 * expected.abs(),
                    "{row:?}: {found} against {expected}"
                );
            }
            count += 1;
        }
        assert_eq!(count, 34);
    }
}

/// Derivatives about the moment centre, with dimensions, from the stated primes about the centre of buoyancy:
/// F^MC = F^CB + x F', the transfer for a point at x ahead turned round.
struct AboutMomentCentre {
    yv: f64,
    nv: f64,
    yr: f64,
    nr: f64,
    yvdot: f64,
    nvdot: f64,
    yrdot: f64,
    nrdot: f64,
}

impl AboutMomentCentre {
    fn new(campaign: &Campaign, row: &Row) -> Self {
        let (truth, hull) = campaign.hull();
        let (d, l) = (truth.dynamic, hull.loa_m);
        let l2 = 0.5 * density(row.temperature_c) * l * l;
        // The centre of buoyancy ahead of the moment centre.
        let x = hull.mc_m - hull.cb_m;
        let transfer =
            |yv: f64, nv: f64, yr: f64, nr: f64| (yv, nv + x * yv, yr + x * yv, nr + x * (nv + yr) + x * x * yv);
        let (yv, nv, yr, nr) = transfer(l2 * d.yv, l2 * l * d.nv, l2 * l * d.yr, l2 * l * l * d.nr);
        let l3 = l2 * l;
        let (yvdot, nvdot, yrdot, nrdot) =
            transfer(l3 * d.yvdot, l3 * l * d.nvdot, l3 * l * d.yrdot, l3 * l * l * d.nrdot);
        Self { yv, nv, yr, nr, yvdot, nvdot, yrdot, nrdot }
    }
}

/// The strut by its stated coefficients.
fn strut(campaign: &Campaign, row: &Row, u: f64, v: f64) -> (f64, f64) {
    let strut = campaign.truth.balance.strut;
    let y = -0.5 * density(row.temperature_c) * strut.area_m2 * (u * u + v * v).sqrt() * strut.side_coefficient * v;
    (y, strut.arm_m * y)
}

/// Whole cycles of the periodic part with the phase counted from where the sway column goes up through zero.
fn whole_cycles(campaign: &Campaign, row: &Row) -> (f64, Vec<(f64, Sample)>) {
    let omega = TAU * row.frequency_hz.unwrap();
    let steady = campaign.steady(row);
    let (sine, cosine) = regress(steady.iter().map(|s| ((omega * s[0]).sin(), (omega * s[0]).cos(), s[3])));
    let phase = cosine.atan2(sine);
    assert!(((sine * sine + cosine * cosine).sqrt() / row.amplitude_m.unwrap() - 1.0).abs() < 1e-4);
    let from = steady[0][0];
    let cycles = ((steady[steady.len() - 1][0] - from) * omega / TAU).floor();
    assert!(cycles >= 2.0, "{row:?} has {cycles} whole cycles");
    let to = from + cycles * TAU / omega;
    (omega, steady.into_iter().filter(|s| s[0] < to - 1e-6).map(|s| (omega * s[0] + phase, s)).collect())
}

/// Pure sway y = y0 sin(wt): in phase with y the balance shows (m - Yvdot) y0 w^2 and (m xG - Nvdot) y0 w^2; in phase
/// with the velocity Yv V0 and Nv V0, but for terms of third order.
#[test]
fn sway_runs_show_mass_added_mass_and_damping() {
    let campaign = Campaign::quiet("LDR9.5", "none");
    let (truth, hull) = campaign.hull();
    let mass = truth.live.live_mass_kg;
    let ahead = hull.mc_m - truth.live.xg_m;
    for row in campaign.of_kind("sway") {
        let about = AboutMomentCentre::new(&campaign, row);
        let (omega, samples) = whole_cycles(&campaign, row);
        let y0 = row.amplitude_m.unwrap();
        let peak = y0 * omega;
        let zero = campaign.zero(row, 20.0);
        let forces: Vec<(f64, f64, f64)> = samples
            .iter()
            .map(|(phase, s)| {
                let force = campaign.force(&[s[4], s[5], s[6]], &zero);
                let (y, n) = strut(&campaign, row, row.speed, peak * phase.cos());
                (*phase, force[1] - y, force[2] - n)
            })
            .collect();
        let harmonics =
            |pick: fn(&(f64, f64, f64)) -> f64| regress(forces.iter().map(|f| (f.0.sin(), f.0.cos(), pick(f))));
        let (y_sin, y_cos) = harmonics(|f| f.1);
        let (n_sin, n_cos) = harmonics(|f| f.2);
        let acceleration = peak * omega;
        let close = |found: f64, expected: f64, share: f64, what: &str| {
            assert!((found / expected - 1.0).abs() < share, "{row:?} {what}: {found} against {expected}");
        };
        close(y_sin, (mass - about.yvdot) * acceleration, 1e-4, "Y in phase with sway");
        close(n_sin, (mass * ahead - about.nvdot) * acceleration, 1e-3, "N in phase with sway");
        // Third order: Y and N of the static law go as sqrt(1 + s^2) and the like in s = v/U; under s^2 of their size.
        let third_order = (peak / row.speed).powi(2);
        close(y_cos, about.yv * row.speed * peak, third_order * 2.0, "Y in phase with velocity");
        close(n_cos, about.nv * row.speed * peak, third_order * 2.0, "N in phase with velocity");
        // And exactly, by quadrature of the stated law over a cycle.
        let (mut y_exact, mut n_exact) = (0.0, 0.0);
        let steps = 720;
        for i in 0..steps {
            let cosine = (TAU * f64::from(i) / f64::from(steps)).cos();
            let (u, v) = (row.speed, peak * cosine);
            let alpha = (-v).atan2(u);
            let scale = 0.5 * density(row.temperature_c) * (u * u + v * v) * area();
            let c = truth.coefficients;
            let y = scale * (c.a * alpha * alpha.cos() + (c.b + c.c * alpha * alpha) * alpha.sin());
            let n = scale * hull.loa_m * c.d * alpha + (hull.mc_m - hull.cb_m) * y;
            y_exact += 2.0 * y * cosine / f64::from(steps);
            n_exact += 2.0 * n * cosine / f64::from(steps);
        }
        close(y_cos, y_exact, 1e-3, "Y by quadrature");
        close(n_cos, n_exact, 1e-3, "N by quadrature");
    }
}

/// Pure yaw: the model follows its path, so v = 0 and the water's force is that of r and its rate alone.
#[test]
fn yaw_runs_show_the_rotary_derivatives() {
    let campaign = Campaign::quiet("LDR10.5", "none");
    let (truth, hull) = campaign.hull();
    let live = truth.live;
    let ahead = hull.mc_m - live.xg_m;
    for row in campaign.of_kind("yaw") {
        let about = AboutMomentCentre::new(&campaign, row);
        let (omega, samples) = whole_cycles(&campaign, row);
        let p0 = row.amplitude_m.unwrap() * omega / row.speed;
        assert!((p0.atan().to_degrees() - row.yaw_amplitude_deg.unwrap()).abs() < 1e-3);
        let zero = campaign.zero(row, 20.0);
        let mut rows = Vec::new();
        for (phase, s) in &samples {
            // tan(heading) = p; speed along the path; turning rate and its rate; acceleration across the path.
            let (p, p1, p2) = (p0 * phase.cos(), -p0 * omega * phase.sin(), -p0 * omega * omega * phase.cos());
            assert!((p.atan().to_degrees() - s[2]).abs() < 1e-3, "heading along the path");
            let (path_speed, squeeze) = (row.speed * (1.0 + p * p).sqrt(), 1.0 / (1.0 + p * p));
            let (r, rdot) = (p1 * squeeze, (p2 - 2.0 * p * p1 * p1 * squeeze) * squeeze);
            let across = path_speed * r;
            let force = campaign.force(&[s[4], s[5], s[6]], &zero);
            let y = force[1] + live.live_mass_kg * (across + ahead * rdot);
            let n = force[2] + live.izz_kg_m2 * rdot + live.live_mass_kg * ahead * across;
            rows.push((path_speed * r, rdot, y, n));
        }
        let (yr, yrdot) = regress(rows.iter().map(|row| (row.0, row.1, row.2)));
        let (nr, nrdot) = regress(rows.iter().map(|row| (row.0, row.1, row.3)));
        let pairs =
            [(yr, about.yr, "Yr"), (nr, about.nr, "Nr"), (yrdot, about.yrdot, "Yrdot"), (nrdot, about.nrdot, "Nrdot")];
        for (found, expected, name) in pairs {
            assert!((found / expected - 1.0).abs() < 5e-3, "{row:?} {name}: {found} against {expected}");
        }
    }
}

/// Constant-radius turns, both ways: the same rotary derivatives, and the strut's drag in AF.
#[test]
fn arcs_show_the_rotary_derivatives() {
    let campaign = Campaign::quiet("LDR8.5", "none");
    let (truth, hull) = campaign.hull();
    let live = truth.live;
    let ahead = hull.mc_m - live.xg_m;
    let mut count = 0;
    for row in campaign.of_kind("arc") {
        let about = AboutMomentCentre::new(&campaign, row);
        let [_, sf, ym] = campaign.mean_force(row);
        let r = row.speed / row.radius_m.unwrap();
        let (y, n) = (sf + live.live_mass_kg * row.speed * r, ym + live.live_mass_kg * ahead * row.speed * r);
        for (found, expected, name) in [(y / (row.speed * r), about.yr, "Yr"), (n / (row.speed * r), about.nr, "Nr")] {
            assert!((found / expected - 1.0).abs() < 4e-3, "{row:?} {name}: {found} against {expected}");
        }
        count += 1;
    }
    assert_eq!(count, 8);
}

/// Newton during the run-up: at zero yaw the balance shows, on top of drag, mass and added mass times acceleration.
#[test]
fn run_up_shows_the_live_mass() {
    let campaign = Campaign::quiet("LDR8.5", "none");
    let (truth, _) = campaign.hull();
    let row = campaign.of_kind("static").find(|row| row.yaw_deg == Some(0.0) && row.speed == 3.0).unwrap();
    let zero = campaign.zero(row, 5.0);
    let samples = campaign.samples(row);
    // Momentum taken up: the integral of the force over the run-up, less the drag, over the speed reached.
    let (mut impulse, mut drag) = (0.0, 0.0);
    let end = campaign.run(row).steady_from_s;
    let steady = campaign.mean_force(row)[0] / 9.0;
    for s in samples.iter().filter(|s| s[0] < end) {
        impulse += 0.02 * campaign.force(&[s[4], s[5], s[6]], &zero)[0];
        drag += 0.02 * steady * s[1] * s[1];
    }
    let mass = (impulse - drag) / 3.0;
    // Surge added mass of a slender body: two to four per cent of the displaced mass.
    let excess = mass / truth.live.live_mass_kg - 1.0;
    assert!((0.01..0.05).contains(&excess), "{mass} kg for {} kg", truth.live.live_mass_kg);
}
