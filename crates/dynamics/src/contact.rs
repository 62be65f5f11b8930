//! What surface and seabed do to the hull: lost buoyancy, support, friction, and the water at the bed.
//!
//! Every force is continuous in the state and grows from nothing, so that an integrator that ignores events gets it right,
//! and no mode of the contact rings: `docs/theory/contact.md` has the derivation and the sources of the constants. Away
//! from both boundaries every term is exactly what it is without them. Knows no modes and no events.

use super::parameters::Parameters;
use glidepolar_number::Number;

/// Share of the critical damping with which the hull comes to rest, at every load.
const DAMPING_RATIO: f64 = 0.7;

/// Depth of contact, in diameters, below which the damping falls off faster than critical damping would: its root has no
/// slope at zero.
const LEAST_DEPTH: f64 = 0.01;

/// Coulomb friction of a hull on sand (DNV-RP-F109, 3.4.6).
const FRICTION: f64 = 0.6;

/// Speed over ground below which friction falls off \[m/s\].
const FRICTION_SPEED_M_S: f64 = 0.01;

/// Largest rate at which friction and the contact's pitch damping slow the hull \[1/s\]: a blow must not be stiff.
const LARGEST_RATE_1_S: f64 = 8.0;

/// Depth of contact over which the current dies out at the bed, in diameters: water does not slip on the bed.
const BED_LAYER: f64 = 0.005;

/// Where the hull is between surface and seabed, in its own diameters.
#[derive(Debug, Clone, Copy)]
pub struct Place<T> {
    diameter_m: T,
    /// How far the centre of buoyancy is above depth 0, from 0 to 1; none below it.
    emerged: Option<T>,
    /// How far it is below the seabed; none above it.
    sunk: Option<T>,
}

/// What the contact does to the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<T> {
    /// Share of its displacement that the hull has lost above the water.
    pub emerged_fraction: T,
    /// Upward force of the seabed \[N\].
    pub seabed_N: T,
    /// Upward force of surface (negative: lost buoyancy) and seabed \[N\].
    pub support_N: T,
    /// Horizontal force against the speed over ground, per speed \[N s/m\].
    pub friction_N_s_m: T,
    /// Moment against the pitch rate, per rate \[N m s\].
    pub pitch_damping_N_m_s: T,
}

impl<T: Number> Place<T> {
    /// The place of a hull at this depth.
    pub fn new(parameters: &Parameters<T>, depth_m: T, seabed_depth_m: T) -> Self {
        // Not a number is beyond no boundary: it must go on through the equations and not end as a glider afloat.
        let (is_emerged, is_sunk) = (depth_m.value() < 0.0, depth_m.value() > seabed_depth_m.value());
        if !is_emerged && !is_sunk {
            return Place { diameter_m: T::constant(1.0), emerged: None, sunk: None };
        }
        let diameter_m = (parameters.frontal_area_m2 * (4.0 / std::f64::consts::PI)).sqrt();
        let emerged = is_emerged.then(|| (-depth_m / diameter_m).at_most(1.0));
        let sunk = is_sunk.then(|| (depth_m - seabed_depth_m) / diameter_m);
        Place { diameter_m, emerged, sunk }
    }

    /// The share of the current that the hull feels: all of it, and on the bed none.
    pub fn current_share(&self) -> T {
        match self.sunk {
            None => T::constant(1.0),
            Some(sunk) => {
                let x = (sunk / BED_LAYER).at_most(1.0);
                (x * 2.0 - 3.0) * x * x + 1.0
            }
        }
    }

    /// What the contact does to a hull that displaces so much water, sinks and moves over ground so fast: by the square of that
    /// speed, which is smooth at rest in whatever direction it goes.
    pub fn contact(
        &self,
        parameters: &Parameters<T>,
        displaced_kg: T,
        depth_rate_m_s: T,
        ground_speed_squared_m2_s2: T,
    ) -> Contact<T> {
        let zero = T::constant(0.0);
        let free = Contact {
            emerged_fraction: zero,
            seabed_N: zero,
            support_N: zero,
            friction_N_s_m: zero,
            pitch_damping_N_m_s: zero,
        };
        if self.emerged.is_none() && self.sunk.is_none() {
            return free;
        }
        let buoyancy_N = displaced_kg.at_least(0.0) * parameters.gravity_m_s2;
        let heaving_kg = parameters.displaced_mass_kg + parameters.added_mass_3_kg;
        // Critical damping c = 2 zeta sqrt(m k) of a spring k = 6 B w / D.
        let damping = |w: T| {
            let full = (heaving_kg * buoyancy_N * 6.0 / self.diameter_m).at_least(0.0);
            if full.value() > 0.0 { full.sqrt() * w / (w + LEAST_DEPTH).sqrt() * (2.0 * DAMPING_RATIO) } else { zero }
        };
        let mut contact = free;
        let mut damping_N_s_m = zero;
        if let Some(u) = self.emerged {
            // The waterline section of a round hull, within 4 % of the chord's area.
            contact.emerged_fraction = u * u * (-u * 2.0 + 3.0);
            let c = damping(u * (-u + 1.0));
            contact.support_N = depth_rate_m_s * c - buoyancy_N * contact.emerged_fraction;
            damping_N_s_m += c;
        }
        if let Some(u) = self.sunk {
            // As the surface yields at first, then with the stiffness that it has there.
            let spring_N = buoyancy_N * if u.value() < 1.0 { u * u * 3.0 } else { u * 6.0 - 3.0 };
            let c = damping(u.at_most(1.0));
            contact.seabed_N = pushed(spring_N, c * depth_rate_m_s);
            contact.support_N += contact.seabed_N;
            contact.friction_N_s_m = friction(parameters, contact.seabed_N, ground_speed_squared_m2_s2);
            damping_N_s_m += c;
        }
        // The same damping, spread over the length of the hull.
        let spread = damping_N_s_m * parameters.length_m * parameters.length_m / 12.0;
        contact.pitch_damping_N_m_s = spread / (spread / (parameters.pitch_inertia_kg_m2 * LARGEST_RATE_1_S) + 1.0);
        contact
    }
}

/// A spring with a damper that never pulls: at rest the spring's force, with the damper's slope, and always above zero.
fn pushed<T: Number>(spring_N: T, damper_N: T) -> T {
    let square = damper_N * damper_N + spring_N * spring_N;
    if square.value() > 0.0 { damper_N + square.sqrt() } else { T::constant(0.0) }
}

/// Coulomb friction per speed, smooth at rest, and no faster than [`LARGEST_RATE_1_S`] in a blow.
fn friction<T: Number>(parameters: &Parameters<T>, normal_N: T, ground_speed_squared_m2_s2: T) -> T {
    let limit_N = normal_N * FRICTION;
    let surging_kg = parameters.displaced_mass_kg + parameters.added_mass_1_kg;
    let speed = (ground_speed_squared_m2_s2 + FRICTION_SPEED_M_S * FRICTION_SPEED_M_S).sqrt();
    limit_N / (speed + limit_N / (surging_kg * LARGEST_RATE_1_S))
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    fn at(depth_m: f64, depth_rate_m_s: f64, ground_speed_m_s: f64) -> Contact<f64> {
        let p = Parameters::default();
        Place::new(&p, depth_m, 60.0).contact(&p, 50.0, depth_rate_m_s, ground_speed_m_s * ground_speed_m_s)
    }

    fn diameter() -> f64 {
        (Parameters::default().frontal_area_m2 * 4.0 / std::f64::consts::PI).sqrt()
    }

    #[test]
    fn between_surface_and_seabed_there_is_no_contact() {
        let p = Parameters::default();
        for depth in [0.0, 1e-9, 30.0, 60.0] {
            let place = Place::new(&p, depth, 60.0);
            assert_eq!(place.current_share(), 1.0);
            let contact = place.contact(&p, 50.0, 0.3, 0.04);
            assert_eq!((contact.support_N, contact.friction_N_s_m, contact.pitch_damping_N_m_s), (0.0, 0.0, 0.0));
        }
    }

    #[test]
    fn a_hull_in_the_air_has_lost_all_its_displacement_and_no_more() {
        for above in [1.0, 2.0, 700.0] {
            let contact = at(-above * diameter(), 0.0, 0.0);
            assert_eq!(contact.emerged_fraction, 1.0);
            assert!((contact.support_N + 50.0 * 9.81).abs() < 1e-9);
        }
        // Half out at the middle: the section of a circle, by symmetry.
        assert!((at(-0.5 * diameter(), 0.0, 0.0).emerged_fraction - 0.5).abs() < 1e-12);
        // Within 4 % of the chord's area everywhere: (t - sin t cos t) / pi with cos t = 1 - 2 u.
        for i in 1..100 {
            let u = f64::from(i) / 100.0;
            let t = (1.0 - 2.0 * u).acos();
            let chord = (t - t.sin() * t.cos()) / std::f64::consts::PI;
            let found = at(-u * diameter(), 0.0, 0.0).emerged_fraction;
            assert!((found - chord).abs() < 0.04, "{u}: {found} against {chord}");
        }
    }

    #[test]
    fn damping_takes_energy_and_never_gives_any() {
        for depth in [-0.2, -0.1, -0.01, -1e-4, 60.0001, 60.01, 60.2, 61.0] {
            let at_rest = at(depth, 0.0, 0.0).support_N;
            for rate in [-1.0, -0.1, -1e-3, 1e-3, 0.1, 1.0] {
                // Up on a hull that sinks, down on one that rises.
                let more = at(depth, rate, 0.0).support_N - at_rest;
                assert!(more * rate >= 0.0, "{depth} {rate}: {more}");
            }
            assert!(at(depth, -3.0, 0.0).seabed_N >= 0.0, "the seabed never pulls");
        }
    }

    /// The smallest share of critical damping at rest, of heave on the bed and at the surface, over loads of 0.05 to 50 N.
    #[test]
    fn no_load_rings() {
        let p = Parameters::default();
        let mass = p.displaced_mass_kg + p.added_mass_3_kg;
        for load in [0.05, 0.5, 5.0, 50.0] {
            for (sign, boundary) in [(1.0, 60.0), (-1.0, 0.0)] {
                // The depth of contact that carries it, by bisection.
                let (mut low, mut high) = (0.0, diameter());
                for _ in 0..60 {
                    let middle: f64 = 0.5 * (low + high);
                    let carried = at(boundary + sign * middle, 0.0, 0.0).support_N.abs();
                    if carried < load { low = middle } else { high = middle }
                }
                let slope = |depth_rate: bool| {
                    let dual = |value: f64, moves: bool| Dual64::new(value, f64::from(u8::from(moves)));
                    let depth = dual(boundary + sign * low, !depth_rate);
                    let lifted = p.map(Dual64::constant);
                    let place = Place::new(&lifted, depth, Dual64::constant(60.0));
                    place
                        .contact(&lifted, Dual64::constant(50.0), dual(0.0, depth_rate), Dual64::constant(0.0))
                        .support_N
                        .eps
                };
                let ratio = slope(true) / (2.0 * (slope(false) * mass).sqrt());
                assert!((0.35..0.75).contains(&ratio), "{load} N at {boundary} m: {ratio}");
            }
        }
    }

    #[test]
    fn friction_is_coulomb_s_at_speed_and_never_stiff() {
        let p = Parameters::default();
        for normal in [0.1, 10.0, 1e4] {
            for speed in [1e-6, 1e-3, 0.1, 3.0] {
                let per_speed = friction(&p, normal, speed * speed);
                assert!(per_speed * speed <= FRICTION * normal);
                assert!(per_speed <= (p.displaced_mass_kg + p.added_mass_1_kg) * LARGEST_RATE_1_S);
            }
        }
        assert!(friction(&p, 1.0, 0.25) * 0.5 > 0.99 * FRICTION);
    }

    #[test]
    fn on_the_bed_the_water_rests() {
        let p = Parameters::default();
        let share = |depth: f64| Place::new(&p, depth, 60.0).current_share();
        assert_eq!(share(60.0 + 2.0 * BED_LAYER * diameter()), 0.0);
        assert!((share(60.0 + 1e-6) - 1.0).abs() < 1e-4);
    }
}
