//! Fresh and sea water of towing tanks: density and viscosity against temperature.
//!
//! [`WaterColumn`] holds measured water against depth. The in-situ density of the sea, against temperature, salinity and
//! pressure, belongs to the flight logs.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod column;

pub use column::{WaterAt, WaterColumn};

/// Salinity of standard sea water \[g/kg\] (ITTC 7.5-02-01-03).
pub const STANDARD_SALINITY_G_KG: f64 = 35.165_04;

/// The same on the practical salinity scale.
const STANDARD_PRACTICAL_SALINITY: f64 = 35.0;

/// What fills a towing tank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TankWater {
    /// Fresh water.
    Fresh,
    /// Standard sea water, 35.16504 g/kg.
    Sea,
}

impl TankWater {
    /// Density at atmospheric pressure \[kg/m3\], for 0 to 40 degC.
    ///
    /// Fresh: Kell 1975, J. Chem. Eng. Data 20(1). Sea: the international equation of state at one atmosphere
    /// (UNESCO 1981, Technical Papers in Marine Science 36), within 0.06 kg/m3 of the ITTC's 1026.02 at 15 degC.
    pub fn density_kg_m3(self, temperature_C: f64) -> f64 {
        let t = temperature_C;
        match self {
            TankWater::Fresh => {
                let numerator = horner(
                    t,
                    &[999.839_52, 16.945_176, -7.987_040_1e-3, -46.170_461e-6, 105.563_02e-9, -280.542_53e-12],
                );
                numerator / (1.0 + 16.879_85e-3 * t)
            }
            TankWater::Sea => {
                let s = STANDARD_PRACTICAL_SALINITY;
                let fresh = [999.842_594, 6.793_952e-2, -9.095_290e-3, 1.001_685e-4, -1.120_083e-6, 6.536_332e-9];
                horner(t, &fresh)
                    + s * horner(t, &[0.824_493, -4.0899e-3, 7.6438e-5, -8.2467e-7, 5.3875e-9])
                    + s * s.sqrt() * horner(t, &[-5.724_66e-3, 1.0227e-4, -1.6546e-6])
                    + s * s * 4.8314e-4
            }
        }
    }

    /// Dynamic viscosity \[Pa s\], for 0 to 40 degC: Sharqawy, Lienhard and Zubair 2010, eqs. 22 and 23.
    pub fn dynamic_viscosity_Pa_s(self, temperature_C: f64) -> f64 {
        let t = temperature_C;
        let fresh = 4.2844e-5 + 1.0 / (0.157 * (t + 64.993).powi(2) - 91.296);
        match self {
            TankWater::Fresh => fresh,
            TankWater::Sea => {
                let s = STANDARD_SALINITY_G_KG / 1000.0;
                let a = horner(t, &[1.541, 1.998e-2, -9.52e-5]);
                let b = horner(t, &[7.974, -7.561e-2, 4.724e-4]);
                fresh * (1.0 + a * s + b * s * s)
            }
        }
    }

    /// Kinematic viscosity \[m2/s\].
    pub fn kinematic_viscosity_m2_s(self, temperature_C: f64) -> f64 {
        self.dynamic_viscosity_Pa_s(temperature_C) / self.density_kg_m3(temperature_C)
    }
}

/// `c0 + c1 x + c2 x^2 ...`
fn horner(x: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresh_water_is_that_of_the_tables() {
        // Temperature, density, kinematic viscosity times 1e6.
        for (t, density, viscosity) in [
            (5.0, 999.964, 1.5182),
            (10.0, 999.700, 1.3064),
            (15.0, 999.100, 1.1388),
            (20.0, 998.204, 1.0036),
            (25.0, 997.045, 0.8928),
        ] {
            assert!((TankWater::Fresh.density_kg_m3(t) - density).abs() < 2e-3, "{t}");
            assert!((TankWater::Fresh.kinematic_viscosity_m2_s(t) * 1e6 - viscosity).abs() < 2e-4, "{t}");
        }
    }

    #[test]
    fn sea_water_is_that_of_the_equation_of_state() {
        // Check values of UNESCO 1981 for S = 35; ITTC 7.5-02-01-03 gives 1.1892e-6 m2/s at 15 degC.
        assert!((TankWater::Sea.density_kg_m3(5.0) - 1_027.675_47).abs() < 1e-5);
        assert!((TankWater::Sea.density_kg_m3(25.0) - 1_023.343_06).abs() < 1e-5);
        assert!((TankWater::Sea.kinematic_viscosity_m2_s(15.0) * 1e6 - 1.1892).abs() < 2e-3);
    }
}
