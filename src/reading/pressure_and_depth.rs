//! The pressure held against the depth, where a log has both: a metre of water makes about a decibar. One of the two in another
//! unit than its column says stands out, the pound per square inch (0.69 dbar) too, which no balance of forces shows.

use std::collections::BTreeMap;

use crate::log::{Channel, FlightLog};

/// Depth or pressure from which on a row counts \[m or dbar\]: above, waves and the zero of a sensor are a part of it.
const LEAST: f64 = 5.0;

/// Fewest rows with both.
const LEAST_ROWS: u64 = 30;

/// What water makes, from fresh water to the deepest sea, with a zero of the sensor that is off by a metre in ten \[dbar/m\].
const OF_WATER: std::ops::RangeInclusive<f64> = 0.87..=1.15;

/// Width of a bin of ratios, in logarithms: narrow against the distance of any two units.
const BIN: f64 = 0.01;

/// What a unit makes of the ratio, and what to say then.
const UNITS: [(f64, &str); 8] = [
    (1.450_4, "is the pressure in psi? --unit pressure_dbar=psi states it"),
    (10.0, "is the pressure in kPa? --unit pressure_dbar=kPa states it"),
    (100.0, "is the pressure in hPa? --unit pressure_dbar=hPa states it"),
    (1e4, "is the pressure in Pa? --unit pressure_dbar=Pa states it"),
    (0.1, "is the pressure in bar? --unit pressure_dbar=bar states it"),
    (0.01, "is the pressure in MPa? --unit pressure_dbar=MPa states it"),
    (0.304_8, "is the depth in feet? --unit depth_m=ft states it"),
    (3.28, "is the pressure a depth in feet? --unit pressure_dbar=ft states it"),
];

/// How often the pressure was so many times the depth, in bins of the logarithm: bounded, however long the log is.
#[derive(Debug, Default)]
pub(super) struct PressureAndDepth {
    bins: BTreeMap<i32, u64>,
    rows: u64,
}

impl PressureAndDepth {
    /// Takes the rows of a piece that have both.
    pub(super) fn take(&mut self, piece: &FlightLog) {
        let (pressure, depth) = (piece.column(Channel::Pressure), piece.column(Channel::Depth));
        for (pressure, depth) in pressure.iter().zip(depth) {
            let (pressure, depth) = (pressure.abs(), depth.abs());
            let ratio = pressure / depth;
            if pressure.max(depth) > LEAST && ratio.is_finite() && ratio > 0.0 {
                *self.bins.entry((ratio.ln() / BIN).round() as i32).or_default() += 1;
                self.rows += 1;
            }
        }
    }

    /// Returns what to say where pressure and depth are not those of one water.
    pub(super) fn contradiction(&self) -> Option<String> {
        if self.rows < LEAST_ROWS {
            return None;
        }
        let mut below = 0;
        let (median, _) = self.bins.iter().find(|(_, rows)| {
            below += **rows;
            2 * below >= self.rows
        })?;
        let ratio = (f64::from(*median) * BIN).exp();
        if OF_WATER.contains(&ratio) {
            return None;
        }
        /// As a ratio, less than half way between any two of the units.
        const NEAR: f64 = 0.07;
        let near = UNITS.iter().find(|(unit, _)| (ratio / unit).ln().abs() < NEAR);
        let cause = near.map_or("check the units of both (--unit)", |(_, says)| says);
        Some(format!(
            "pressure and depth contradict each other: the pressure is {ratio:.3} times the depth (median of {} rows), and a metre of water makes about a decibar; {cause}; the pressure is taken",
            self.rows
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn says(pressure_per_m: f64, offset: f64) -> Option<String> {
        let mut piece = FlightLog::default();
        let depth: Vec<f64> = (0..200).map(|i| 0.5 * f64::from(i)).collect();
        piece.set(Channel::Pressure, depth.iter().map(|depth| pressure_per_m * depth + offset).collect());
        piece.set(Channel::Depth, depth);
        let mut held = PressureAndDepth::default();
        held.take(&piece);
        held.contradiction()
    }

    #[test]
    fn a_pressure_in_another_unit_contradicts_the_depth() {
        for (ratio, unit) in [
            (1.450_4 * 1.01, "=psi"),
            (10.1, "=kPa"),
            (101.0, "=hPa"),
            (0.101, "=bar"),
            (0.308, "depth_m=ft"),
            (2.0, "check the units of both"),
        ] {
            let says = says(ratio, 0.0).unwrap_or_else(|| panic!("{unit}"));
            assert!(says.contains(unit), "{unit}: {says}");
        }
    }

    #[test]
    fn fresh_water_a_deep_sea_and_a_zero_that_is_off_are_no_other_unit() {
        for (ratio, offset) in [(0.98, 0.0), (1.03, 0.0), (1.006, 1.5), (1.006, -1.5)] {
            assert_eq!(says(ratio, offset), None, "{ratio} {offset}");
        }
    }
}
