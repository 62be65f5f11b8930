//! The log held against itself, before anything is fitted: units, signs, time base, and the density against
//! temperature, salinity and pressure.
//!
//! The density column `r` stands against TEOS-10 of the same row, in situ `r_s` and at p = 0 `r_0`:
//!
//! ```text
//! r - r_s = -bias - missing (r_s - r_0)
//! ```
//!
//! Without errors both numbers are 0. `missing` = 1 says that the column was evaluated at p = 0, any other value that it
//! was evaluated at `1 - missing` times the pressure that is read. Equations of state in use differ by 0.01 kg/m3, and
//! salinity anomalies that a log without a position cannot know by some 0.03 kg/m3.
//!
//! Knows observations; no vehicle.

use glidepolar_inference::order;

use crate::diagnose::findings::{Check, Checked};
use crate::log::{Observation, Preparation};

/// The check of the density.
pub const DENSITY: &str = "density against temperature, salinity and pressure";

/// The check of the unit of pitch.
const PITCH_UNIT: &str = "unit of pitch";

/// An error of the density column, known from the column's own temperature, salinity and pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DensityError {
    /// It was evaluated at p = 0.
    AtZeroPressure,
    /// It is off by a constant: true density less density read \[kg/m3\], beyond what the vehicle adds already, with its
    /// standard error.
    Bias(f64, f64),
}

/// Smallest constant difference that is called an error \[kg/m3\]: three times what equations of state and salinity
/// anomalies differ by.
const LEAST_BIAS_KG_M3: f64 = 0.1;

/// Standard error of a constant difference, by the equations of state and the anomaly \[kg/m3\].
const BIAS_SE_KG_M3: f64 = 0.03;

/// Spread of the water's own compression from which on the pressure in a density can be identified \[kg/m3\]: 30 dbar.
const LEAST_COMPRESSION_KG_M3: f64 = 0.13;

/// By how much the share of the pressure may be off.
const SHARE_MARGIN: f64 = 0.1;

/// Quantile of the pressure that stands for the deepest: a hundredth of the samples may be spikes.
const DEEPEST: f64 = 0.99;

/// Fewest samples with a density and a water sample.
const LEAST_SAMPLES: usize = 30;

/// Share of a channel's values from which on it is in another unit than its column says. Damage takes single values or a
/// stretch; degrees in a column of radians leave only the pitches under 1.6 deg, which a glider has in turns.
const MOST: f64 = 0.5;

/// Share of rows before which the time goes back above which a log counts as unsorted; a random order has 0.5.
const UNSORTED: f64 = 0.1;

/// Returns the errors in what the reading of a log corrected or removed: the samples do not show them any more.
pub fn taken_out(log: &Preparation) -> Vec<Check> {
    let (pitch, density) = (log.share_of_pitch_beyond(), log.share_of_density_less_1000());
    let wrong = |check, says| Check { check, outcome: Checked::Wrong, says };
    let pitch = (pitch > MOST).then(|| {
        let share = 100.0 * pitch;
        wrong(
            PITCH_UNIT,
            format!(
                "{share:.0} % of the pitch angles lie beyond 90 deg = 1.571 rad: are degrees in a column of radians?"
            ),
        )
    });
    let density = (density > MOST).then(|| {
        let share = 100.0 * density;
        wrong(
            "unit of density",
            format!("{share:.0} % of the densities are below 100 kg/m3: is it the density less 1000 kg/m3? (--unit density_kg_m3=sigma)"),
        )
    });
    let share = 100.0 * log.share_of_density_in_g_cm3();
    let g_cm3 = (share > 100.0 * MOST).then(|| {
        wrong(
            "unit of density",
            format!("{share:.0} % of the densities lie at 1: are they in g/cm3? (--unit density_kg_m3=g/cm3)"),
        )
    });
    let share = 100.0 * log.share_of_depth_beyond();
    let depth = (share > 100.0 * MOST).then(|| {
        wrong(
            "unit of pressure or depth",
            format!("{share:.0} % of the depths are beyond 11 000 m, which no sea has: is the pressure in Pa, or the depth in cm? (--unit pressure_dbar=Pa, --unit depth_m=cm)"),
        )
    });
    let share = 100.0 * log.share_of_speed_beyond();
    let speed = (share > 100.0 * MOST).then(|| {
        wrong(
            "unit of measured speed",
            format!("{share:.0} % of the measured speeds are beyond 5 m/s, which no glider has: are they in cm/s? (--unit speed_through_water_m_s=cm/s)"),
        )
    });
    let back = log.share_of_backward_steps();
    let order = (back > UNSORTED).then(|| {
        let share = 100.0 * back;
        wrong(
            "order of time",
            format!("the time goes back from one row to the next in {share:.0} % of the rows: sort them by time"),
        )
    });
    order.into_iter().chain(pitch).chain(density).chain(g_cm3).chain(depth).chain(speed).collect()
}

/// Holds a log against itself. `carried_bias_kg_m3` is what the vehicle already adds to the density that is read.
pub fn checks(observations: &[Observation], carried_bias_kg_m3: f64) -> (Vec<Check>, Option<DensityError>) {
    let (density, error) = density(observations, carried_bias_kg_m3);
    let under_way = under_way(observations);
    let checks = vec![
        vertical_velocity(&under_way),
        pressure(observations),
        pitch_unit(&under_way),
        pitch_sign(observations),
        ballast_unit(observations),
        ballast_sign(observations),
        density,
    ];
    (checks, error)
}

/// The observations with the density as it should have been recorded, for a vehicle that adds `carried_bias_kg_m3` to it.
/// Velocities that came from the rate of the pressure by the recorded density come by that of the water.
pub fn corrected(observations: &[Observation], error: DensityError, carried_bias_kg_m3: f64) -> Vec<Observation> {
    let corrected = |o: &Observation| match error {
        DensityError::AtZeroPressure if o.teos10_density_kg_m3.is_finite() => {
            o.teos10_density_kg_m3 - carried_bias_kg_m3
        }
        DensityError::AtZeroPressure => f64::NAN,
        DensityError::Bias(bias, _) => o.density_kg_m3 + bias,
    };
    let of = |o: &Observation| {
        let density_kg_m3 = corrected(o);
        let per_dbar = o.density_kg_m3 / (density_kg_m3 + carried_bias_kg_m3);
        Observation {
            density_kg_m3,
            sink_m_s: o.sink_m_s * per_dbar,
            sink_se_m_s: o.sink_se_m_s * per_dbar,
            sink_rate_m_s2: o.sink_rate_m_s2 * per_dbar,
            ..*o
        }
    };
    observations.iter().map(of).collect()
}

/// The samples between a tenth and nine tenths of the way down, in whatever unit the pressure is: there a glider is under way. At
/// the surface it lies still, in shallow water for longer than it dives. The way begins where the sensor reads least: its zero may be off.
pub fn under_way(observations: &[Observation]) -> Vec<Observation> {
    let of = |share| quantile(observations.iter().map(|o| o.pressure_dbar.abs()), share);
    let (Some(least), Some(deepest)) = (of(1.0 - DEEPEST), of(DEEPEST)) else { return observations.to_vec() };
    let at = |share: f64| least + share * (deepest - least);
    let is_between = |o: &&Observation| (at(0.1)..=at(0.9)).contains(&o.pressure_dbar.abs());
    observations.iter().filter(is_between).copied().collect()
}

fn vertical_velocity(observations: &[Observation]) -> Check {
    let check = "time base and pressure unit";
    let Some(w) = quantile(observations.iter().map(|o| o.sink_m_s.abs()), 0.5) else {
        return not_checked(check, "no vertical velocity");
    };
    judge(
        check,
        (0.005..=2.0).contains(&w),
        || format!("the median vertical velocity is {w:.3} m/s; gliders do 0.05 to 0.5 m/s"),
        "is time in seconds, and pressure in decibar?",
    )
}

fn pressure(observations: &[Observation]) -> Check {
    let check = "sign of pressure or depth";
    let of = |share| quantile(observations.iter().map(|o| o.pressure_dbar), share);
    let (Some(low), Some(high)) = (of(1.0 - DEEPEST), of(DEEPEST)) else {
        return not_checked(check, "no pressure");
    };
    // A zero that is off by a little is no wrong sign, however long the glider lay at the surface.
    judge(
        check,
        high > -low,
        || format!("the pressure goes from {low:.1} to {high:.1} dbar"),
        "pressure and depth are positive below the surface",
    )
}

fn pitch_unit(observations: &[Observation]) -> Check {
    let check = PITCH_UNIT;
    let Some(pitch) = quantile(observations.iter().map(|o| o.pitch_rad.abs()), 0.9) else {
        return not_checked(check, "no pitch");
    };
    let half_turn = std::f64::consts::FRAC_PI_2;
    judge(
        check,
        (0.04..=half_turn).contains(&pitch),
        || format!("nine in ten pitch angles are below {pitch:.3} rad = {:.1} deg", pitch.to_degrees()),
        if pitch > half_turn { "are degrees in a column of radians?" } else { "are radians in a column of degrees?" },
    )
}

fn pitch_sign(observations: &[Observation]) -> Check {
    let check = "sign of pitch";
    let (mut alike, mut n) = (0, 0);
    for o in observations.iter().filter(|o| o.pitch_rad.abs() > 0.05 && o.sink_m_s.abs() > 0.02) {
        n += 1;
        alike += usize::from((o.pitch_rad < 0.0) == (o.sink_m_s > 0.0));
    }
    if n == 0 || n < LEAST_SAMPLES.min(observations.len()) {
        return not_checked(check, "too few samples under way");
    }
    let share = 100.0 * alike as f64 / n as f64;
    judge(
        check,
        share > 50.0,
        || format!("the nose points the way the glider goes in {share:.0} % of the samples"),
        "pitch is positive nose up",
    )
}

fn ballast_unit(observations: &[Observation]) -> Check {
    let check = "unit of ballast volume";
    let of = |share| quantile(observations.iter().map(|o| o.ballast_m3 * 1e6), share);
    let (Some(low), Some(high)) = (of(0.05), of(0.95)) else {
        return not_checked(check, "no ballast volume");
    };
    // One ballast volume is enough for a log of descents alone.
    let goes = |down: bool| observations.iter().any(|o| o.steady && (o.sink_m_s > 0.0) == down);
    if high - low < 5.0 && !(goes(true) && goes(false)) {
        return not_checked(check, "the log goes one way alone");
    }
    if high - low < 1e-6 * high.abs().max(1.0) {
        let says = format!(
            "the ballast volume is {high:.3} cc on descents and ascents alike: is it a setting? choose the column of the measured volume by --column vbd_cc=COLUMN"
        );
        return Check { check, outcome: Checked::Wrong, says };
    }
    judge(
        check,
        (5.0..=5000.0).contains(&(high - low)),
        || format!("the ballast volume goes from {low:.3} to {high:.3} cc"),
        "is it in the unit that the column's name says?",
    )
}

fn ballast_sign(observations: &[Observation]) -> Check {
    let check = "sign of ballast volume";
    let of = |sinks: bool| {
        let here = observations.iter().filter(move |o| (o.sink_m_s > 0.0) == sinks && o.sink_m_s.abs() > 0.02);
        quantile(here.map(|o| o.ballast_m3 * 1e6), 0.5)
    };
    let (Some(down), Some(up)) = (of(true), of(false)) else {
        return not_checked(check, "descents and ascents are needed");
    };
    judge(
        check,
        down < up,
        || format!("the median ballast volume is {down:.0} cc on descents and {up:.0} cc on ascents"),
        "the volume is positive when more buoyant",
    )
}

fn density(observations: &[Observation], carried_bias_kg_m3: f64) -> (Check, Option<DensityError>) {
    let check = DENSITY;
    let rows: Vec<(f64, f64)> = observations
        .iter()
        .map(|o| {
            let compression = o.teos10_density_kg_m3 - o.teos10_surface_density_kg_m3;
            (compression, o.density_kg_m3 + carried_bias_kg_m3 - o.teos10_density_kg_m3)
        })
        .filter(|(compression, difference)| compression.is_finite() && difference.is_finite())
        .collect();
    if rows.len() < LEAST_SAMPLES {
        return (not_checked(check, "no temperature with salinity or conductivity beside the density"), None);
    }
    let (level, slope, spread) = robust_line(&rows);
    // Without a range of pressure all of the difference is a level.
    let (bias, missing) =
        if spread >= LEAST_COMPRESSION_KG_M3 { (-level, -slope) } else { (-median(rows.iter().map(|row| row.1)), 0.0) };
    let of = |outcome, mut says: String| {
        if carried_bias_kg_m3 != 0.0 {
            says.push_str(&format!(", with the density bias of {carried_bias_kg_m3:+.3} kg/m3 that the vehicle has"));
        }
        Check { check, outcome, says }
    };
    if missing.abs() < SHARE_MARGIN && bias.abs() < LEAST_BIAS_KG_M3 {
        return (
            of(
                Checked::Consistent,
                format!("TEOS-10 in situ gives the density within {:.3} kg/m3", bias.abs().max(0.001)),
            ),
            None,
        );
    }
    if (missing - 1.0).abs() < SHARE_MARGIN && bias.abs() < LEAST_BIAS_KG_M3 {
        let says = format!(
            "the density is that of the same water at p = 0 (share of the compression that it lacks: {missing:.3})"
        );
        return (of(Checked::Corrected, says), Some(DensityError::AtZeroPressure));
    }
    if missing.abs() < SHARE_MARGIN {
        let says = format!("the density differs from TEOS-10 in situ by a constant, {:+.3} kg/m3", -bias);
        return (of(Checked::Corrected, says), Some(DensityError::Bias(bias, BIAS_SE_KG_M3)));
    }
    let says = format!(
        "the density fits its temperature and salinity at {:.2} times the pressure that is read, {:+.3} kg/m3 apart; density, salinity, temperature or pressure is in another unit than its column says",
        1.0 - missing,
        -bias
    );
    (of(Checked::Wrong, says), None)
}

/// Level and slope of the line through most of the points, and the range of the abscissa from its 5th to its 95th
/// hundredth. Points further from the line than six median distances are left out, as interpolated cells are.
fn robust_line(rows: &[(f64, f64)]) -> (f64, f64, f64) {
    let of = |share| quantile(rows.iter().map(|row| row.0), share).unwrap_or(0.0);
    let spread = of(0.95) - of(0.05);
    let (mut level, mut slope, mut reach) = (0.0, 0.0, f64::INFINITY);
    for _ in 0..5 {
        let (mut n, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (x, y) in rows.iter().filter(|(x, y)| (y - level - slope * x).abs() <= reach) {
            (n, sx, sy, sxx, sxy) = (n + 1.0, sx + x, sy + y, sxx + x * x, sxy + x * y);
        }
        let square = sxx - sx * sx / n;
        slope = if square > 0.0 { (sxy - sx * sy / n) / square } else { 0.0 };
        level = (sy - slope * sx) / n;
        reach = 6.0 * median(rows.iter().map(|(x, y)| (y - level - slope * x).abs())).max(1e-4);
    }
    (level, slope, spread)
}

fn judge(check: &'static str, is_right: bool, found: impl Fn() -> String, otherwise: &str) -> Check {
    let says = if is_right { found() } else { format!("{}: {otherwise}", found()) };
    Check { check, outcome: if is_right { Checked::Consistent } else { Checked::Wrong }, says }
}

fn not_checked(check: &'static str, why: &str) -> Check {
    Check { check, outcome: Checked::NotChecked, says: why.to_owned() }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    quantile(values, 0.5).unwrap_or(0.0)
}

fn quantile(values: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut finite: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    (!finite.is_empty()).then(|| order::quantile(&mut finite, share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::tests::{glider, sample};

    /// Dives of three minutes to 30 m, ten minutes at the surface after each, where the sensor reads 4 dbar.
    #[test]
    fn a_glider_that_waits_at_the_surface_is_not_under_way_whatever_the_zero_of_its_pressure() {
        let (_, p) = glider();
        let diving = sample(&p, -25.0, 0.4, 0, 0.0);
        let log: Vec<Observation> = (0..800)
            .map(|i| {
                let within = i % 80;
                let is_diving = within < 20;
                let pressure_dbar = if is_diving { 4.0 + 1.5 * f64::from(within) } else { 4.0 };
                let sink_m_s = if is_diving { 0.17 } else { 0.001 };
                Observation { pressure_dbar, sink_m_s, time_s: 9.0 * f64::from(i), ..diving }
            })
            .collect();
        let found = vertical_velocity(&under_way(&log));
        assert_eq!(found.outcome, Checked::Consistent, "{}", found.says);
    }
}
