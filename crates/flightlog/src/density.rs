//! In-situ density of sea water by TEOS-10, from practical salinity or conductivity, in-situ temperature and pressure.
//!
//! Specific volume: the 75-term polynomial of Roquet et al. 2015 (crate `gsw`). Two functions of the toolbox that the
//! crate has not are stood in for:
//! - *Absolute Salinity* is taken as Reference Salinity, `SA = SR`, without the atlas of its anomaly. The anomaly is
//!   largest in the deep North Pacific, 0.027 g/kg, which is 0.02 kg/m3; below 0.005 g/kg in the Atlantic. In the
//!   Baltic, where it reaches 0.087 g/kg, its own formula is used (Feistel et al. 2010), position given.
//! - *Conservative Temperature* from the in-situ one is found from `h_CT(SA, CT, p) = cp0 (T0 + t) / (T0 + theta)`, an
//!   identity of TEOS-10, with the crate's enthalpy polynomial: within 2e-5 K of the toolbox's own function.

use gsw::conversions::{ct_from_pt, sr_from_sp};
use gsw::practical_salinity::{c_from_sp, sp_from_c};
use gsw::volume::{beta, enthalpy_first_derivatives, rho, sa_from_rho};

/// Zero of the Celsius scale \[K\].
const ZERO_CELSIUS_K: f64 = 273.15;

/// The heat capacity that defines Conservative Temperature \[J/(kg K)\].
const CP0: f64 = 3_991.867_957_119_63;

/// In-situ density \[kg/m3\] from practical salinity, in-situ temperature \[degC\] and pressure \[dbar\]; position in
/// degrees, NaN where it is unknown. NaN where a value is missing or outside the range of the equation.
pub fn in_situ_density_kg_m3(
    practical_salinity: f64,
    temperature_C: f64,
    pressure_dbar: f64,
    latitude_deg: f64,
    longitude_deg: f64,
) -> f64 {
    densities_kg_m3(practical_salinity, temperature_C, pressure_dbar, latitude_deg, longitude_deg)[0]
}

/// As [`in_situ_density_kg_m3`], and beside it the density of the same water brought to p = 0.
pub(super) fn densities_kg_m3(
    practical_salinity: f64,
    temperature_C: f64,
    pressure_dbar: f64,
    latitude_deg: f64,
    longitude_deg: f64,
) -> [f64; 2] {
    let salinity = absolute_salinity_g_kg(practical_salinity, latitude_deg, longitude_deg);
    let pressure = pressure_dbar.max(0.0);
    let in_situ = conservative_temperature_C(salinity, temperature_C, pressure);
    // Logs that evaluate at p = 0 do so with the temperature as it was read.
    let at_surface = conservative_temperature_C(salinity, temperature_C, 0.0);
    [rho(salinity, in_situ, pressure), rho(salinity, at_surface, 0.0)].map(|density| density.unwrap_or(f64::NAN))
}

/// Practical salinity from conductivity \[S/m\], in-situ temperature \[degC\] and pressure \[dbar\].
pub fn practical_salinity(conductivity_S_m: f64, temperature_C: f64, pressure_dbar: f64) -> f64 {
    sp_from_c(conductivity_S_m * 10.0, temperature_C, pressure_dbar.max(0.0)).unwrap_or(f64::NAN)
}

/// How the density that a CTD computes goes with what it measures, in water of one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DensitySlopes {
    /// Along the practical salinity \[kg/m3\]: 0.81 at 0 degC, 0.78 at 10, 0.74 at 25.
    pub per_salinity: f64,
    /// Along the temperature that is taken for the conductivity cell's, at one conductivity \[kg/(m3 K)\]: -0.92 at 0 degC, -0.75 at 10,
    /// -0.58 at 25.
    pub per_cell_K: f64,
}

/// The slopes in water of this density \[kg/m3\], in-situ temperature \[degC\] and pressure \[dbar\]; none where no sea water is like this.
pub fn density_slopes(density_kg_m3: f64, temperature_C: f64, pressure_dbar: f64) -> Option<DensitySlopes> {
    // The salinity changes the Conservative Temperature by millikelvins, and what is sought by some 1e-4 of it.
    const USUAL_SALINITY_G_KG: f64 = 35.0;
    const STEP_K: f64 = 0.01;
    let pressure = pressure_dbar.max(0.0);
    let conservative = conservative_temperature_C(USUAL_SALINITY_G_KG, temperature_C, pressure);
    let slopes = || {
        let salinity = sa_from_rho(density_kg_m3, conservative, pressure)?;
        let per_practical = sr_from_sp(1.0);
        let per_salinity = density_kg_m3 * beta(salinity, conservative, pressure)? * per_practical;
        let conductivity = c_from_sp(salinity / per_practical, temperature_C, pressure)?;
        let practical = |step_K: f64| sp_from_c(conductivity, temperature_C + step_K, pressure);
        let salinity_per_K = (practical(STEP_K)? - practical(-STEP_K)?) / (2.0 * STEP_K);
        Ok::<_, gsw::Error>(DensitySlopes { per_salinity, per_cell_K: per_salinity * salinity_per_K })
    };
    slopes().ok().filter(|slopes| slopes.per_cell_K.is_finite() && slopes.per_salinity.is_finite())
}

/// Absolute Salinity \[g/kg\]: Reference Salinity, in the Baltic its own formula.
pub fn absolute_salinity_g_kg(practical_salinity: f64, latitude_deg: f64, longitude_deg: f64) -> f64 {
    if practical_salinity.is_nan() || practical_salinity < 0.0 {
        return f64::NAN;
    }
    if in_the_baltic(latitude_deg, longitude_deg) {
        (35.165_04 - 0.087) / 35.0 * practical_salinity + 0.087
    } else {
        sr_from_sp(practical_salinity)
    }
}

/// Conservative Temperature \[degC\] from the in-situ one \[degC\] at a pressure \[dbar\].
pub fn conservative_temperature_C(salinity_g_kg: f64, temperature_C: f64, pressure_dbar: f64) -> f64 {
    let in_situ_K = temperature_C + ZERO_CELSIUS_K;
    let mut potential_C = temperature_C;
    // The difference is a few hundredths of a kelvin and hardly depends on the temperature: each round gains three digits.
    for _ in 0..4 {
        let Ok(conservative) = ct_from_pt(salinity_g_kg, potential_C) else { return f64::NAN };
        let Ok((_, slope)) = enthalpy_first_derivatives(salinity_g_kg, conservative, pressure_dbar) else {
            return f64::NAN;
        };
        let found_K = slope / CP0 * (potential_C + ZERO_CELSIUS_K);
        potential_C += in_situ_K - found_K;
        if (in_situ_K - found_K).abs() < 1e-10 {
            break;
        }
    }
    ct_from_pt(salinity_g_kg, potential_C).unwrap_or(f64::NAN)
}

/// The Baltic as TEOS-10 bounds it: east of a broken line through (12.6 E, 50 N), (7 E, 59 N), (26 E, 69 N), west of
/// one from (45 E, 50 N) to (26 E, 69 N).
fn in_the_baltic(latitude_deg: f64, longitude_deg: f64) -> bool {
    if !(50.0..69.0).contains(&latitude_deg) {
        return false;
    }
    let west = if latitude_deg < 59.0 {
        12.6 + (7.0 - 12.6) * (latitude_deg - 50.0) / 9.0
    } else {
        7.0 + (26.0 - 7.0) * (latitude_deg - 59.0) / 10.0
    };
    let east = 45.0 + (26.0 - 45.0) * (latitude_deg - 50.0) / 19.0;
    (west..east).contains(&longitude_deg)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conservative_temperature_is_that_of_the_toolbox() {
        // Check values of gsw_CT_from_t, TEOS-10 toolbox documentation: SA, t, p, CT.
        let cases = [
            (34.7118, 28.7856, 10.0, 28.809_919_826_700_28),
            (34.8915, 28.4329, 50.0, 28.439_227_816_091_14),
            (35.0256, 22.8103, 125.0, 22.786_176_893_078_498),
            (34.8472, 10.2600, 250.0, 10.226_189_266_620_782),
            (34.7366, 6.8863, 600.0, 6.827_213_633_479_988),
            (34.7324, 4.4036, 1000.0, 4.323_575_748_610_455),
        ];
        for (salinity, t, p, expected) in cases {
            let found = conservative_temperature_C(salinity, t, p);
            // The polynomial and the Gibbs function agree to some microkelvin; 2e-5 K is 4e-6 kg/m3.
            assert!((found - expected).abs() < 2e-5, "{found} against {expected}");
        }
    }

    /// By the toolbox in Python (gsw 3.6, `SP_from_C`, `rho`, `beta`), at 10 dbar: temperature, practical salinity, and both slopes.
    #[test]
    fn the_slopes_of_the_density_are_those_of_the_toolbox() {
        let cases = [
            (0.0, 35.0, 0.80638, -0.92403),
            (10.0, 35.0, 0.77751, -0.75415),
            (25.0, 35.0, 0.74389, -0.57651),
            (10.0, 30.0, 0.77663, -0.64427),
        ];
        for (temperature_C, salinity, per_salinity, per_cell_K) in cases {
            let density = in_situ_density_kg_m3(salinity, temperature_C, 10.0, 0.0, 0.0);
            let found = density_slopes(density, temperature_C, 10.0).expect("sea water");
            assert!((found.per_salinity / per_salinity - 1.0).abs() < 1e-3, "{found:?} against {per_salinity}");
            assert!((found.per_cell_K / per_cell_K - 1.0).abs() < 1e-3, "{found:?} against {per_cell_K}");
        }
        assert_eq!(density_slopes(900.0, 10.0, 0.0), None);
        assert_eq!(density_slopes(f64::NAN, 10.0, 0.0), None);
    }

    #[test]
    fn the_baltic_is_where_it_is() {
        assert!(in_the_baltic(54.7, 15.1) && in_the_baltic(60.0, 20.0) && !in_the_baltic(48.6, -123.5));
        assert!(!in_the_baltic(56.0, 5.0) && !in_the_baltic(f64::NAN, f64::NAN));
    }

    #[test]
    fn missing_and_impossible_values_give_nan_and_no_panic() {
        for salinity in [f64::NAN, -1.0, f64::INFINITY] {
            assert!(in_situ_density_kg_m3(salinity, 10.0, 100.0, 0.0, 0.0).is_nan());
        }
        assert!(in_situ_density_kg_m3(35.0, f64::NAN, 100.0, 0.0, 0.0).is_nan());
    }
}
