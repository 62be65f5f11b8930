//! The drag that ballast and vertical velocity imply, held against what a hull of this size can have. Pressure in feet or
//! kilopascal multiplies the vertical velocity and divides that drag by the square; nothing else in a log shows it.
//!
//! Descents and ascents together are free of the trim:
//! ```text
//! g (V_up - V_down) = CD A / 2 (mean of w^2 / sin^3 pitch on descents + the same on ascents)
//! ```
//! The path is steeper than the pitch, so that this `CD` is a lower bound, by some ten to thirty per cent.
//!
//! Units closer to the decibar than a factor of 1.7, as the pound per square inch (1.45), stay within what fouling and
//! hulls explain: only a measured speed, a depth column, or a density column beside temperature and salinity shows them.

use glidepolar_inference::order;

use crate::dynamics::Parameters;
use crate::log::Observation;

/// Pitch from which on a sample counts \[rad\]: below 6 degrees the angle of attack is as large as the pitch.
const LEAST_PITCH_RAD: f64 = 0.1;

/// Fewest samples on descents and on ascents.
const LEAST_SAMPLES: usize = 20;

/// Smallest change of the ballast volume between the legs: a column that never moves says nothing \[m3\].
const LEAST_BALLAST_M3: f64 = 5e-6;

/// Drag coefficient of a disc across the flow (Hoerner 1965, Fluid-Dynamic Drag, 3-15): no hull has more on its frontal area.
const DISC: f64 = 1.17;

/// Smallest drag over the vehicle's own, as `diagnose` judges a fitted coefficient: the published drags of one kind of glider
/// lie within this factor, and fouling only adds to it.
const LEAST_OF_VEHICLE: f64 = 1.0 / 3.0;

/// Kinematic viscosity of warm sea water, 25 degC: in colder water the smallest drag is larger \[m2/s\].
const VISCOSITY_M2_S: f64 = 0.95e-6;

/// What a pressure of another unit does to the vertical velocity, and what to say then.
const UNITS: [(f64, &str); 5] = [
    (3.28, "are depths in feet (--unit depth_m=ft, --unit pressure_dbar=ft)?"),
    (10.0, "is the pressure in kPa (--unit pressure_dbar=kPa)?"),
    (100.0, "is the pressure in hPa (--unit pressure_dbar=hPa)?"),
    (0.1, "is the pressure in bar (--unit pressure_dbar=bar)?"),
    (0.01, "is the pressure in MPa (--unit pressure_dbar=MPa), or a depth in hectometres?"),
];

/// Returns what to say where the drag that the log implies is none that this vehicle can have.
pub(super) fn contradiction(observations: &[Observation], vehicle: &Parameters<f64>) -> Option<String> {
    let (down, up) = (Leg::of(observations, true)?, Leg::of(observations, false)?);
    let ballast_m3 = up.ballast_m3 - down.ballast_m3;
    if ballast_m3 < LEAST_BALLAST_M3 {
        return None;
    }
    let drag = 2.0 * vehicle.gravity_m_s2 * ballast_m3 / (vehicle.frontal_area_m2 * (down.per_drag + up.per_drag));
    let least = least_drag(vehicle, down.speed_m_s.max(up.speed_m_s));
    let beyond = if drag > DISC {
        format!("more than the {DISC} of a disc across the flow")
    } else if drag < least {
        format!("less than the {least:.3} of a smooth hull of this size alone, without wings")
    } else if drag < LEAST_OF_VEHICLE * vehicle.b {
        format!("less than a third of the vehicle's {:.3}", vehicle.b)
    } else {
        return None;
    };
    let factor = (vehicle.b / drag).sqrt();
    Some(format!(
        "ballast and vertical velocity contradict each other: together they imply a drag coefficient of {drag:.2e}, {beyond}; the vertical velocity is {factor:.2} times what the vehicle's drag allows; {}",
        cause(factor)
    ))
}

/// The unit that would explain a vertical velocity so many times too large.
fn cause(factor: f64) -> &'static str {
    /// As a ratio half way from feet to kPa, the two units that are closest to each other.
    const NEAR: f64 = 1.7;
    let near = UNITS.iter().find(|(unit, _)| (1.0 / NEAR..=NEAR).contains(&(factor / unit)));
    near.map_or("check the units of pressure or depth, time and ballast volume (--unit)", |(_, says)| says)
}

/// Drag coefficient of a smooth streamlined hull of this length and frontal area, laminar from bow to stern: friction of a
/// plate (Blasius) with the form factor of streamlined bodies (Hoerner 1965, Fluid-Dynamic Drag, 6-19).
fn least_drag(vehicle: &Parameters<f64>, speed_m_s: f64) -> f64 {
    let diameter_m = (4.0 * vehicle.frontal_area_m2 / std::f64::consts::PI).sqrt();
    let slenderness = vehicle.length_m / diameter_m;
    let friction = 1.328 / (speed_m_s * vehicle.length_m / VISCOSITY_M2_S).sqrt();
    friction * (3.0 * slenderness + 4.5 / slenderness.sqrt() + 21.0 / slenderness.powi(2))
}

/// Medians of the steady samples of one direction.
struct Leg {
    ballast_m3: f64,
    /// `w^2 / sin^3 pitch` \[m2/s2\].
    per_drag: f64,
    speed_m_s: f64,
}

impl Leg {
    fn of(observations: &[Observation], descends: bool) -> Option<Leg> {
        let is_of_leg = |o: &&Observation| {
            let goes_as_pitched = (o.sink_m_s > 0.0) == descends && o.descends() == descends;
            o.steady && goes_as_pitched && o.pitch_rad.abs() > LEAST_PITCH_RAD && o.ballast_m3.is_finite()
        };
        let samples: Vec<&Observation> = observations.iter().filter(is_of_leg).collect();
        if samples.len() < LEAST_SAMPLES {
            return None;
        }
        let median = |of: &dyn Fn(&Observation) -> f64| {
            let mut values: Vec<f64> = samples.iter().map(|o| of(o)).collect();
            order::quantile(&mut values, 0.5)
        };
        let sine = |o: &Observation| o.pitch_rad.abs().sin();
        Some(Leg {
            ballast_m3: median(&|o| o.ballast_m3),
            per_drag: median(&|o| o.sink_m_s.powi(2) / sine(o).powi(3)),
            speed_m_s: median(&|o| o.sink_m_s.abs() / sine(o)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::tests::{glider, sample};

    /// Descents and ascents in turn, their vertical velocities times a factor.
    fn log(factor: f64) -> Vec<Observation> {
        let (_, p) = glider();
        let path_deg = |i: u32| if i.is_multiple_of(2) { -30.0 } else { 30.0 };
        let of = |i: u32| sample(&p, path_deg(i), 0.3 + 1e-3 * f64::from(i), i / 2, f64::from(i));
        (0..80).map(of).map(|o| Observation { sink_m_s: factor * o.sink_m_s, ..o }).collect()
    }

    #[test]
    fn a_vertical_velocity_in_another_unit_contradicts_the_ballast() {
        let (_, p) = glider();
        assert_eq!(contradiction(&log(1.0), &p), None);
        for (factor, unit) in [(3.28, "feet"), (9.81, "kPa"), (0.1, "in bar"), (100.0, "hPa"), (0.01, "MPa")] {
            let says = contradiction(&log(factor), &p).unwrap_or_else(|| panic!("{unit}"));
            assert!(says.contains(unit) && says.contains("drag coefficient"), "{unit}: {says}");
        }
    }

    #[test]
    fn fouling_and_a_trim_that_is_off_are_no_other_unit() {
        let (_, p) = glider();
        // Three times the drag slows a glider by the root of it.
        assert_eq!(contradiction(&log(1.0 / 3.0f64.sqrt()), &p), None);
        let off: Vec<_> = log(1.0).iter().map(|o| Observation { ballast_m3: o.ballast_m3 + 2e-4, ..*o }).collect();
        assert_eq!(contradiction(&off, &p), None);
        let descents: Vec<_> = log(10.0).into_iter().filter(Observation::descends).collect();
        assert_eq!(contradiction(&descents, &p), None, "one direction alone says nothing");
    }

    #[test]
    fn the_smallest_drag_is_that_of_laminar_friction() {
        // A hull of 1.8 m by 0.30 m at 1 m/s: 1.328 / sqrt(1.8 / 0.95e-6) times 18 + 1.84 + 0.58.
        let (_, mut p) = glider();
        (p.frontal_area_m2, p.length_m) = (0.25 * std::f64::consts::PI * 0.09, 1.8);
        assert!((least_drag(&p, 1.0) - 0.01970).abs() < 1e-4, "{}", least_drag(&p, 1.0));
    }
}
