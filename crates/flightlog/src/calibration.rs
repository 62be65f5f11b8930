//! What a Seaglider's file says of the vehicle: masses, volumes and flight constants of its pilot and of the basestation.

/// Figures of one dive, as the file has them; a figure that it has not is `None`.
///
/// Flight constants are those of the basestation's model: lift `q l^2 hd_a alpha`, drag `q l^2 (hd_b q^hd_s + hd_c alpha^2)`,
/// `q` the dynamic pressure \[Pa\], `l` the length, `alpha` in degrees.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Calibration {
    /// The glider, as `SG171`.
    pub glider: String,
    /// The dive from which the figures are.
    pub dive: Option<f64>,
    /// `sg_cal_mass`, else `log_MASS` \[kg\].
    pub mass_kg: Option<f64>,
    /// Largest displaced volume, `sg_cal_volmax` \[m3\].
    pub volmax_m3: Option<f64>,
    /// `sg_cal_hd_a` \[1/deg\].
    pub hd_a: Option<f64>,
    /// `sg_cal_hd_b` \[Pa^-hd_s\].
    pub hd_b: Option<f64>,
    /// `sg_cal_hd_c` \[1/deg^2\].
    pub hd_c: Option<f64>,
    /// `sg_cal_hd_s`, -1/4 unless stated.
    pub hd_s: Option<f64>,
    /// Length in these formulas, `sg_cal_glider_length` \[m\].
    pub length_m: Option<f64>,
    /// Density at which hull constants are stated, `sg_cal_rho0` \[kg/m3\].
    pub rho0_kg_m3: Option<f64>,
    /// Density for which the pilot ballasted the glider, `log_RHO` \[kg/m3\].
    pub log_rho_kg_m3: Option<f64>,
    /// Counts of the ballast pump at which `vbd_cc` is zero, `log_C_VBD`.
    pub c_vbd_counts: Option<f64>,
    /// Counts at the largest volume, `log_VBD_MIN`.
    pub vbd_min_counts: Option<f64>,
    /// Volume of one count, negative, `log_VBD_CNV` \[cc\].
    pub vbd_cc_per_count: Option<f64>,
    /// Ballast that the basestation takes off `vbd_cc`, `sg_cal_vbdbias` \[cc\].
    pub vbd_bias_cc: Option<f64>,
    /// Compressibility of the hull, `sg_cal_abs_compress` \[1/dbar\].
    pub compressibility_1_dbar: Option<f64>,
    /// Thermal expansion of the hull, `sg_cal_therm_expan` \[1/K\].
    pub thermal_expansion_1_K: Option<f64>,
    /// Temperature at which the volume is stated, `sg_cal_temp_ref` \[degC\].
    pub reference_temperature_C: Option<f64>,
    /// Roll counts at which a dive goes straight, `log_C_ROLL_DIVE`.
    pub c_roll_dive_counts: Option<f64>,
    /// Roll counts at which a climb goes straight, `log_C_ROLL_CLIMB`.
    pub c_roll_climb_counts: Option<f64>,
    /// Roll of the mass in one count, `log_ROLL_CNV` \[deg\].
    pub roll_deg_per_count: Option<f64>,
    /// Magnetic declination at the fixes, east positive, `log_gps_magvar` \[deg\].
    pub declination_deg: Option<f64>,
}

impl Calibration {
    /// Displaced volume where `vbd_cc` is zero: the largest volume less what the pump has drawn in \[m3\].
    pub fn neutral_volume_m3(&self) -> Option<f64> {
        let drawn_in_cc = (self.c_vbd_counts? - self.vbd_min_counts?) * self.vbd_cc_per_count?;
        Some(self.volmax_m3? + drawn_in_cc * 1e-6)
    }

    /// By how much `vbd_cc` has to be raised to count from another `C_VBD` \[cc\]; nothing where it is not known.
    pub(super) fn ballast_shift_cc(&self, c_vbd_counts: f64) -> Option<f64> {
        Some((self.c_vbd_counts? - c_vbd_counts) * self.vbd_cc_per_count?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_neutral_volume_and_mass_give_the_density_of_the_water_it_was_ballasted_for() {
        // SG171, dive 3: ballasted for 1.023 g/cm3 by log_RHO.
        let c = Calibration {
            mass_kg: Some(56.406),
            volmax_m3: Some(0.055_775_411),
            c_vbd_counts: Some(3230.0),
            vbd_min_counts: Some(500.0),
            vbd_cc_per_count: Some(-0.2453),
            ..Calibration::default()
        };
        let density = c.mass_kg.unwrap() / c.neutral_volume_m3().unwrap();
        assert!((density - 1023.0).abs() < 1.5, "{density}");
        // Counted from 100 counts less, the same volume is 24.53 cc less.
        assert!((c.ballast_shift_cc(3130.0).unwrap() + 24.53).abs() < 1e-9);
    }
}
