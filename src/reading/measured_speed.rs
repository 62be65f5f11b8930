//! The measured speed held against vertical velocity and pitch: `U sin(path) = w`, the path being steeper than the pitch by
//! the angle of attack. Neither weight nor ballast is in it, so that a wrong unit of the speed stands out.

use glidepolar_inference::order;

use crate::dynamics::Parameters;
use crate::log::{CHANNELS, Channel, Observation};

/// Pitch from which on a sample counts \[rad\]: at 10 degrees an error of the pitch of 2 degrees makes a fifth of the speed.
const LEAST_PITCH_RAD: f64 = 0.175;

/// Fewest samples with a speed.
const LEAST_SAMPLES: usize = 20;

/// Ratio of the measured speed to that of the path, or the reverse, from which on the unit is doubtful: half way, as a ratio,
/// from the metre per second to the knot, the unit that is closest to it.
const FAR: f64 = 1.394;

/// Units of speed in m/s, as `--unit` takes them.
const UNITS: [(&str, f64); 6] = [
    ("kn", 1852.0 / 3600.0),
    ("km/h", 1.0 / 3.6),
    ("ft/s", 0.3048),
    ("cm/s", 0.01),
    ("mm/s", 0.001),
    ("m/min", 1.0 / 60.0),
];

/// Ratios that a pressure in pounds per square inch makes: vertical velocities are 1.45 times too large.
const PSI: std::ops::Range<f64> = 0.64..0.72;

/// Returns what to say where the measured speed differs from that of the path by a factor.
pub(super) fn contradiction(observations: &[Observation], vehicle: &Parameters<f64>) -> Option<String> {
    let mut ratios: Vec<f64> = observations.iter().filter_map(|o| ratio(o, vehicle)).collect();
    if ratios.len() < LEAST_SAMPLES {
        return None;
    }
    let ratio = order::quantile(&mut ratios, 0.5);
    if (1.0 / FAR..=FAR).contains(&ratio) {
        return None;
    }
    // A speed in a unit of so many m/s reads as many times too large as the unit is smaller.
    let apart = |unit_m_s: f64| (ratio * unit_m_s).ln().abs();
    let near = UNITS.iter().min_by(|a, b| apart(a.1).total_cmp(&apart(b.1))).filter(|unit| apart(unit.1) < FAR.ln());
    let name = CHANNELS[Channel::Speed as usize].name;
    let cause = match near {
        Some((unit, _)) => format!("is it in {unit}? --unit {name}={unit} states it"),
        None if PSI.contains(&ratio) => {
            format!(
                "is the pressure in psi, which makes 0.69 of it (--unit pressure_dbar=psi), or the speed in another unit (--unit {name}=UNIT)?"
            )
        }
        None => format!("check its unit (--unit {name}=UNIT), and those of pressure and pitch"),
    };
    Some(format!(
        "the measured speed is {ratio:.2} times the vertical velocity over the sine of the glide path (median of {} samples), with the angle of attack by the vehicle's polar: {cause}",
        ratios.len()
    ))
}

/// The measured speed over that of the path.
fn ratio(o: &Observation, vehicle: &Parameters<f64>) -> Option<f64> {
    let goes_as_pitched = (o.sink_m_s > 0.0) == o.descends();
    if !(o.steady && goes_as_pitched && o.pitch_rad.abs() > LEAST_PITCH_RAD && o.speed_m_s > 0.0) {
        return None;
    }
    let path_rad = path_rad(o.pitch_rad.abs(), vehicle);
    Some(o.speed_m_s * path_rad.sin() / o.sink_m_s.abs()).filter(|ratio| ratio.is_finite())
}

/// The angle of the path below the horizon at this pitch, both positive: `tan(pitch + alpha) = (b + c alpha^2) / (a alpha)`,
/// whatever the speed.
fn path_rad(pitch_rad: f64, vehicle: &Parameters<f64>) -> f64 {
    /// Beyond this angle of attack the flow leaves wings \[rad\].
    const MOST_RAD: f64 = 0.2;
    let (a, b, c) = (vehicle.a_per_rad, vehicle.b, vehicle.c_per_rad2);
    let (mut low, mut high) = (0.0, MOST_RAD);
    for _ in 0..40 {
        let alpha = 0.5 * (low + high);
        let is_short = (pitch_rad + alpha).tan() * a * alpha < b + c * alpha * alpha;
        if is_short { low = alpha } else { high = alpha }
    }
    (pitch_rad + low).min(std::f64::consts::FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::tests::{glider, sample};

    fn says(factor: f64) -> Option<String> {
        let (_, p) = glider();
        let of = |i: u32| sample(&p, if i.is_multiple_of(2) { -28.0 } else { 33.0 }, 0.3, i / 2, f64::from(i));
        let log: Vec<_> = (0..60).map(of).map(|o| Observation { speed_m_s: factor * o.speed_m_s, ..o }).collect();
        contradiction(&log, &p)
    }

    #[test]
    fn a_speed_in_another_unit_is_named_with_its_ratio() {
        for (factor, unit) in [(1.944, "=kn"), (3.6, "=km/h"), (100.0, "=cm/s")] {
            let says = says(factor).unwrap_or_else(|| panic!("{unit}"));
            assert!(says.contains(unit) && says.contains(&format!("{factor:.2} times")), "{unit}: {says}");
        }
        assert!(says(1.0 / 1.450_4).is_some_and(|says| says.contains("pressure_dbar=psi")));
        assert!(says(0.4).is_some_and(|says| says.contains("check its unit")));
    }

    #[test]
    fn a_speed_that_is_off_by_a_tenth_is_no_other_unit() {
        for factor in [0.85, 1.0, 1.15] {
            assert_eq!(says(factor), None, "{factor}");
        }
    }

    #[test]
    fn the_path_is_that_of_the_closed_form() {
        let (_, p) = glider();
        let o = sample(&p, -30.0, 0.3, 0, 0.0);
        assert!((path_rad(o.pitch_rad.abs(), &p).to_degrees() - 30.0).abs() < 1e-6);
    }
}
