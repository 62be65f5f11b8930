//! Fresh water: density and kinematic viscosity against temperature, for the physics of the virtual tank.
//!
//! Deliberately other formulae than the ones a reduction uses: density after Tanaka et al. (2001), viscosity after
//! Kestin, Sokolov and Wakeham (1978). Must not know the library's own water properties.

/// Fresh water at one temperature and atmospheric pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Water {
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Kinematic viscosity, m2/s.
    pub kinematic_viscosity_m2_s: f64,
}

impl Water {
    /// Fresh water at `temperature_c`, 0 to 40 degrees Celsius.
    pub fn fresh(temperature_c: f64) -> Self {
        let density_kg_m3 = density(temperature_c);
        Self { density_kg_m3, kinematic_viscosity_m2_s: dynamic_viscosity(temperature_c) / density_kg_m3 }
    }
}

/// M. Tanaka, G. Girard, R. Davis, A. Peuto, N. Bignell, "Recommended table for the density of water between 0 C and
/// 40 C based on recent experimental reports", Metrologia 38 (2001) 301-309, equation (1). Air-free water, kg/m3.
fn density(temperature_c: f64) -> f64 {
    const A1: f64 = -3.983_035;
    const A2: f64 = 301.797;
    const A3: f64 = 522_528.9;
    const A4: f64 = 69.348_81;
    const A5: f64 = 999.974_950;
    let t = temperature_c;
    A5 * (1.0 - (t + A1).powi(2) * (t + A2) / (A3 * (t + A4)))
}

/// J. Kestin, M. Sokolov, W. A. Wakeham, "Viscosity of liquid water in the range -8 C to 150 C",
/// J. Phys. Chem. Ref. Data 7 (1978) 941-948: relative to 1.002 mPa s at 20 degrees Celsius. Pa s.
fn dynamic_viscosity(temperature_c: f64) -> f64 {
    let below_20 = 20.0 - temperature_c;
    let exponent = below_20 / (temperature_c + 96.0) * (1.2364 - 1.37e-3 * below_20 + 5.7e-6 * below_20 * below_20);
    1.002e-3 * 10f64.powf(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Density: the handbook table that goes back to Chappuis (1907), which the 2001 formula meets within 3 mg/kg.
    /// Viscosity: Sharqawy, Lienhard and Zubair (2010).
    #[test]
    fn agrees_with_published_tables() {
        for (t, density) in [(4.0, 999.9720), (10.0, 999.7026), (15.0, 999.1026), (20.0, 998.2071), (25.0, 997.0479)] {
            let found = super::density(t);
            assert!((found - density).abs() < 3.1e-3, "{t}: {found}");
        }
        for (t, viscosity) in [(5.0, 1.5182e-6), (10.0, 1.3064e-6), (15.0, 1.1388e-6), (20.0, 1.0036e-6)] {
            let water = Water::fresh(t);
            assert!((water.kinematic_viscosity_m2_s / viscosity - 1.0).abs() < 2e-3, "{t}: {water:?}");
        }
    }
}
