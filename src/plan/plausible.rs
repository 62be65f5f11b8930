//! Calibrated constants held against physics and against the vehicle's own: a column in another unit shows as a ratio. Knows
//! no files.

use super::calibrate::{DiveFit, PumpFit};
use crate::vehicle::Vehicle;

/// Ratio of a calibrated constant to the vehicle's own, or the reverse, from which on a unit is doubtful: as `diagnose` judges
/// a coefficient of the polar.
const FAR: f64 = 3.0;

/// Battery energy per energy of the pump, or the reverse, from which on the two tables disagree. Both count the same electricity:
/// losses of cables and of the battery itself are some per cent.
const FAR_FACTOR: f64 = 1.5;

/// Returns what in a calibration contradicts physics, or the constants that the vehicle had before.
pub fn contradictions(before: &Vehicle, pump: &PumpFit, dives: &DiveFit) -> Vec<String> {
    let mut found = Vec::new();
    if pump.efficiency > 1.0 || pump.pump_J_per_dbar_cc.value <= 0.0 {
        found.push(format!(
            "the pump would have an efficiency of {:.0} %, which no pump has: is `depth_m` in feet, `vbd_secs` in another unit, or VBD_CNV_cc_per_count another?",
            100.0 * pump.efficiency
        ));
    }
    let factor = dives.pump_factor.value;
    if !(1.0 / FAR_FACTOR..=FAR_FACTOR).contains(&factor) {
        found.push(format!(
            "the battery gave {factor:.3} times the energy that the pump took, expected about 1: are the charges in A.h and not in mA.h, the voltages in V, and `vbd_A` in A?"
        ));
    }
    for (path, value, of_what) in [
        (
            "energy.pump_J_per_dbar_cc",
            pump.pump_J_per_dbar_cc.value * factor,
            "`depth_m`, `vbd_A`, `vbd_V` and `vbd_secs`",
        ),
        ("energy.hotel_W", dives.hotel_W.value, "`duration_s` and the charges"),
    ] {
        let Some(own) = before.get(path).filter(|own| *own > 0.0) else { continue };
        let ratio = value / own;
        if !(1.0 / FAR..=FAR).contains(&ratio) {
            found.push(format!(
                "`{path}` = {value:.3e} is {ratio:.2} times the vehicle's {own:.3e}: check the units of {of_what}"
            ));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::calibrate::{DiveCount, Stroke, fit_dives, fit_pump};

    /// A pump of 0.03 J/(dbar cc) and 10 J/cc, 0.2 W and 4 kJ a dive, with a column times a factor.
    fn says(depth: f64, charge: f64, energy: f64) -> Vec<String> {
        let (mut strokes, mut dives) = (Vec::new(), Vec::new());
        for dive in 1..=12u32 {
            let mut pump_J = 0.0;
            for i in 1..=3 {
                let (pressure_dbar, volume_cc) =
                    (80.0 * f64::from(i) + 7.0 * f64::from(dive % 5), 30.0 + 5.0 * f64::from(i));
                let energy_J = (0.03 * pressure_dbar + 10.0) * volume_cc;
                pump_J += energy_J;
                let pressure_dbar = depth * pressure_dbar;
                strokes.push(Stroke { dive, pressure_dbar, volume_cc, energy_J: energy * energy_J });
            }
            let duration_s = 6000.0 + 700.0 * f64::from(dive % 4);
            let energy_J = charge * (4000.0 + pump_J + 0.2 * duration_s);
            dives.push(DiveCount { dive, duration_s, charge_Ah: energy_J / 3600.0 / 15.0, energy_J });
        }
        let (pump, of_dives) = (fit_pump(&strokes).expect("a pump"), fit_dives(&strokes, &dives).expect("dives"));
        contradictions(&Vehicle::load("seaglider").expect("built in"), &pump, &of_dives)
    }

    #[test]
    fn another_unit_in_a_table_is_a_ratio() {
        assert_eq!(says(1.0, 1.0, 1.0), Vec::<String>::new());
        let has =
            |found: Vec<String>, text: &str| assert!(found.iter().any(|says| says.contains(text)), "{text}: {found:?}");
        has(says(3.28, 1.0, 1.0), "`depth_m` in feet");
        has(says(1.0, 1000.0, 1.0), "mA.h");
        has(says(1.0, 1.0, 1e-3), "expected about 1");
        has(says(0.1, 1.0, 1.0), "times the vehicle's");
    }
}
