//! The equations of motion against closed forms, published glides and conserved quantities.

use glidepolar_virtual_sea::motion::{Imposed, Inertia, Load, Motion, State};
use glidepolar_virtual_sea::ocean::GRAVITY_M_S2;

/// A glider as Leonard and Graver give it: forces by K's, mass displaced, one published glide.
struct Published {
    inertia: Inertia,
    displaced_kg: f64,
    lift: f64,
    drag: (f64, f64),
    moment: f64,
    damping: f64,
    moving_mass_m: f64,
    angle_deg: f64,
    pitch_deg: f64,
    v1: f64,
    v3: f64,
}

fn inertia(solid_kg: f64, moving_kg: f64, height_m: f64, added: (f64, f64), pitch_kg_m2: f64) -> Inertia {
    Inertia { solid_kg, moving_kg, height_m, added_1_kg: added.0, added_3_kg: added.1, pitch_kg_m2 }
}

/// ROGUE (Leonard and Graver 2001) and the SLOCUM-like set (Graver 2005) on downward glides, recomputed to more digits
/// than the publications print.
fn published() -> [Published; 3] {
    let rogue = |ballast_kg: f64, moving_mass_m, angle_deg, pitch_deg, v1, v3| Published {
        inertia: inertia(8.22 + ballast_kg, 2.0, 0.04, (2.0, 14.0), 0.1),
        displaced_kg: 11.22,
        lift: 306.0,
        drag: (18.0, 109.0),
        moment: -36.5,
        damping: 0.0,
        moving_mass_m,
        angle_deg,
        pitch_deg,
        v1,
        v3,
    };
    [
        rogue(1.35415, 0.0041273, 6.2595, -23.7405, 0.29821, 0.03271),
        rogue(1.36301, 0.0217102, 3.44408, -41.55592, 0.36933, 0.02223),
        Published {
            inertia: inertia(41.047349, 9.0, 0.05, (5.0, 70.0), 12.0),
            displaced_kg: 50.0,
            lift: 132.5,
            drag: (2.15, 25.0),
            moment: -100.0,
            damping: -50.0,
            moving_mass_m: 0.0198303,
            angle_deg: 2.02265,
            pitch_deg: -22.97735,
            v1: 0.299813,
            v3: 0.010588,
        },
    ]
}

impl Published {
    fn load(&self, motion: &Motion) -> Load {
        let speed2 = motion.through_1.powi(2) + motion.through_3.powi(2);
        let angle = motion.through_3.atan2(motion.through_1);
        let lift = self.lift * angle * speed2;
        let drag = (self.drag.0 + self.drag.1 * angle * angle) * speed2;
        Load {
            displaced_kg: self.displaced_kg,
            force_1_n: lift * angle.sin() - drag * angle.cos(),
            force_3_n: -lift * angle.cos() - drag * angle.sin(),
            moment_n_m: self.moment * angle * speed2 + self.damping * motion.pitch_rate,
        }
    }
}

#[test]
fn published_glides_are_reached_and_kept() {
    for glider in published() {
        let imposed = Imposed { moving_mass_m: glider.moving_mass_m, ..Imposed::default() };
        let start = (0.0, 0.0, glider.pitch_deg.to_radians() + 0.03);
        let mut state = glider.inertia.state(start, (glider.v1 * 0.9, glider.v3 * 1.1, 0.0), &imposed);
        for _ in 0..60_000 {
            state = glider.inertia.step(&state, &imposed, 0.02, |_, motion| glider.load(motion));
        }
        let motion = glider.inertia.motion(&state, &imposed, 0.0);
        let angle_deg = motion.through_3.atan2(motion.through_1).to_degrees();
        let pitch_deg = state.pitch_rad.to_degrees();
        // The positions of the moving mass above carry six or seven digits, hence these limits.
        assert!((angle_deg - glider.angle_deg).abs() < 2e-3, "angle {angle_deg} against {}", glider.angle_deg);
        assert!((pitch_deg - glider.pitch_deg).abs() < 3e-3, "pitch {pitch_deg} against {}", glider.pitch_deg);
        assert!((motion.v1 - glider.v1).abs() < 2e-5, "v1 {} against {}", motion.v1, glider.v1);
        assert!((motion.v3 - glider.v3).abs() < 2e-5, "v3 {} against {}", motion.v3, glider.v3);
    }
}

fn slocum() -> Inertia {
    inertia(43.0, 9.0, 0.05, (4.0, 55.0), 18.0)
}

/// Energy with its kinetic part.
fn energies(inertia: &Inertia, state: &State, imposed: &Imposed, displaced_kg: f64) -> (f64, f64) {
    let at_rest = inertia.state((state.x_m, state.depth_m, state.pitch_rad), (0.0, 0.0, 0.0), imposed);
    let total = inertia.energy_j(state, imposed, displaced_kg);
    (total, total - inertia.energy_j(&at_rest, imposed, displaced_kg))
}

#[test]
fn without_lift_and_drag_energy_is_kept() {
    let (inertia, displaced_kg) = (slocum(), 51.7);
    let imposed = Imposed { moving_mass_m: 0.02, ..Imposed::default() };
    let mut state = inertia.state((0.0, 10.0, 0.7), (0.4, -0.2, 0.5), &imposed);
    let (before, kinetic_before) = energies(&inertia, &state, &imposed, displaced_kg);
    for _ in 0..1200 {
        state = inertia.step(&state, &imposed, 0.05, |_, _| Load { displaced_kg, ..Load::default() });
    }
    let (after, kinetic_after) = energies(&inertia, &state, &imposed, displaced_kg);
    assert!(kinetic_after > 5.0 * kinetic_before, "too dull a run: {kinetic_before} J to {kinetic_after} J");
    assert!((after - before).abs() < 1e-5 * kinetic_after, "energy {before} J became {after} J");
}

#[test]
fn a_sliding_mass_leaves_the_common_centre_of_mass_where_it_is() {
    let inertia = Inertia { added_1_kg: 0.0, added_3_kg: 0.0, ..slocum() };
    let mut imposed = Imposed::default();
    let mut state = inertia.state((0.0, 10.0, 0.0), (0.0, 0.0, 0.0), &imposed);
    imposed.sliding_m_s = 0.01;
    let neutral = Load { displaced_kg: 52.0, ..Load::default() };
    let centre = |state: &State, forward: f64| {
        let (sin, cos) = state.pitch_rad.sin_cos();
        let share = 9.0 / 52.0;
        (state.x_m + share * (forward * cos + 0.05 * sin), state.depth_m + share * (0.05 * cos - forward * sin))
    };
    let before = centre(&state, 0.0);
    for _ in 0..40 {
        state = inertia.step(&state, &imposed, 0.25, |_, _| neutral);
        imposed.moving_mass_m += 0.0025;
    }
    // A neutral glider without added mass feels no force: the common centre of mass stays, the hull moves about it.
    let after = centre(&state, 0.1);
    assert!(state.momentum_x.abs() < 1e-12, "{}", state.momentum_x);
    assert!((after.0 - before.0).abs() < 1e-6 && (after.1 - before.1).abs() < 1e-6, "{before:?} {after:?}");
    assert!(state.pitch_rad < -0.1, "{state:?}");
}

#[test]
fn a_neutral_body_goes_with_accelerating_water() {
    let inertia = inertia(52.0, 1e-9, 0.0, (4.0, 55.0), 18.0);
    let imposed = Imposed { water_x_m_s2: 2e-3, water_z_m_s2: -1e-3, ..Imposed::default() };
    let neutral = Load { displaced_kg: 52.0, ..Load::default() };
    let mut state = inertia.state((0.0, 10.0, 0.3), (0.0, 0.0, 0.0), &imposed);
    state = inertia.step(&state, &imposed, 0.25, |_, _| neutral);
    let motion = inertia.motion(&state, &imposed, 0.25);
    let (sin, cos) = state.pitch_rad.sin_cos();
    let (x, z) = (motion.v1 * cos + motion.v3 * sin, motion.v3 * cos - motion.v1 * sin);
    assert!((x - 5e-4).abs() < 1e-9 && (z + 2.5e-4).abs() < 1e-9, "{x} {z}");
    assert!(motion.through_1.abs() < 1e-9 && motion.through_3.abs() < 1e-9);
}

#[test]
fn munks_couple_turns_a_body_across_its_path() {
    let inertia = slocum();
    let imposed = Imposed::default();
    let (v1, v3) = (0.3, 0.05);
    let state = inertia.state((0.0, 10.0, 0.0), (v1, v3, 0.0), &imposed);
    let short_s = 1e-4;
    let after = inertia.step(&state, &imposed, short_s, |_, _| Load { displaced_kg: 52.0, ..Load::default() });
    let couple = (after.spin - state.spin) / short_s;
    // Level and without pitch rate the pendulum pulls nothing and the moving mass carries nothing across.
    assert!((couple - (55.0 - 4.0) * v1 * v3).abs() < 1e-3, "{couple}");
    assert!(GRAVITY_M_S2 * 9.0 * 0.05 * (after.pitch_rad - state.pitch_rad).abs() < 1e-3);
}

/// Through a shear a body takes the velocity over ground along that it had: no water accelerates, so nothing pulls it.
#[test]
fn a_shear_that_is_met_leaves_the_velocity_over_ground_as_it_is() {
    let displaced_kg = 51.7;
    let bare = Inertia { added_1_kg: 0.0, added_3_kg: 0.0, ..slocum() };
    let inertia = Inertia { solid_kg: displaced_kg - bare.moving_kg, ..bare };
    let mut imposed = Imposed { met_x_m_s2: 3e-3, ..Imposed::default() };
    let mut state = inertia.state((0.0, 50.0, -0.4), (0.25, 0.1, 0.0), &imposed);
    let (momentum_x, momentum_z) = (state.momentum_x, state.momentum_z);
    for _ in 0..400 {
        state = inertia.step(&state, &imposed, 0.05, |_, _| Load { displaced_kg, ..Load::default() });
        imposed.water_x_m_s += imposed.met_x_m_s2 * 0.05;
    }
    assert!((state.momentum_x - momentum_x).abs() < 1e-9 && (state.momentum_z - momentum_z).abs() < 1e-9, "{state:?}");
}
