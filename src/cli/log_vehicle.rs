//! The vehicle that a log's own files describe, and what they say against the vehicle that was named.
//!
//! A Seaglider's files carry its mass, its volumes and the flight constants of its pilot. `--vehicle from-file` takes them;
//! what they leave out is that of the built-in Seaglider, and said.

use std::f64::consts::PI;
use std::path::PathBuf;

use super::CliError;
use crate::input::{InputError, Place};
use crate::log::{Calibration, Columns, LogFiles};
use crate::vehicle::Vehicle;

/// How a user asks for it.
pub const FROM_FILE: &str = "from-file";

/// What the built-in vehicle is from which the rest is taken.
const TEMPLATE: &str = "seaglider";

/// Difference of the mass, or of the mass of the displaced water, from which on file and vehicle contradict each other
/// \[kg\]: a quarter of the 200 cc by which a glider's ballast usually drives it, so that speeds differ by a tenth.
const CONTRADICTS_KG: f64 = 0.05;

/// Speed at which the drag of a vehicle with a drag exponent is stated \[m/s\].
const REFERENCE_SPEED_M_S: f64 = 0.3;

/// A vehicle by its name or file, or the one that the files of a log describe.
///
/// # Errors
/// A vehicle that cannot be read, files that describe none.
pub fn load(name: &str, logs: &[PathBuf]) -> Result<Vehicle, CliError> {
    if name != FROM_FILE {
        return Ok(Vehicle::load(name)?);
    }
    // What the files say of the vehicle depends on no choice of a column.
    let files = LogFiles::open(logs, &Columns::default())?;
    let Some(calibration) = files.calibration() else {
        let error = InputError::new(Place::file(&logs[0]), "describes no vehicle");
        return Err(error.help("only the basestation's files of a Seaglider do; name one by --vehicle").into());
    };
    described(calibration)
}

/// The vehicle that a calibration describes.
///
/// # Errors
/// Where neither mass nor volume are in it, or a figure is none of a glider.
fn described(calibration: &Calibration) -> Result<Vehicle, CliError> {
    let mut vehicle = Vehicle::load(TEMPLATE)?;
    vehicle.is_builtin = false;
    let mut left_out = Vec::new();
    let mut set = |path: &str, what: &'static str, value: Option<f64>| -> Result<(), CliError> {
        match value.filter(|value| value.is_finite()) {
            Some(value) => Ok(vehicle.set(path, value)?),
            None => {
                left_out.push(what);
                Ok(())
            }
        }
    };
    let volume_m3 =
        calibration.neutral_volume_m3().map(|volume| volume - calibration.vbd_bias_cc.unwrap_or(0.0) * 1e-6);
    // Without its own volume the glider is neutral in the water for which its pilot ballasted it.
    let volume_m3 = volume_m3.or_else(|| Some(calibration.mass_kg? / calibration.log_rho_kg_m3?));
    let (Some(mass_kg), Some(volume_m3)) = (calibration.mass_kg, volume_m3) else {
        return Err(CliError::Usage(format!(
            "the files of {} state no mass (sg_cal_mass, log_MASS) or no volume (sg_cal_volmax with log_C_VBD, log_VBD_MIN, log_VBD_CNV; or log_RHO): name a vehicle by --vehicle",
            calibration.glider
        )));
    };
    set("mass.mass_kg", "mass", Some(mass_kg))?;
    set("mass.displaced_volume_m3", "volume", Some(volume_m3))?;
    let per_l2 = per_l2(calibration)?;
    let degree = PI / 180.0;
    let exponent = calibration.hd_s.unwrap_or(-0.25);
    let rho0_kg_m3 = calibration.rho0_kg_m3.unwrap_or(1027.5);
    let reference_Pa = 0.5 * rho0_kg_m3 * REFERENCE_SPEED_M_S * REFERENCE_SPEED_M_S;
    set("hydro.a_per_rad", "hd_a", calibration.hd_a.map(|a| a / (per_l2 * degree)))?;
    set("hydro.b", "hd_b", calibration.hd_b.map(|b| b * reference_Pa.powf(exponent) / per_l2))?;
    set("hydro.c_per_rad2", "hd_c", calibration.hd_c.map(|c| c / (per_l2 * degree * degree)))?;
    set("mechanisms.drag_exponent", "hd_s", calibration.hd_s)?;
    set("mass.reference_density_kg_m3", "rho0", calibration.rho0_kg_m3)?;
    const DBAR_PER_PA: f64 = 1e-4;
    let compressibility = calibration.compressibility_1_dbar.map(|per_dbar| per_dbar * DBAR_PER_PA);
    set("hull.compressibility_per_Pa", "abs_compress", compressibility)?;
    set("hull.thermal_expansion_per_K", "therm_expan", calibration.thermal_expansion_1_K)?;
    set("hull.reference_temperature_C", "temp_ref", calibration.reference_temperature_C)?;
    let dive = calibration.dive.map_or(String::new(), |dive| format!(", dive {dive}"));
    let rest = if left_out.is_empty() { "nothing".to_owned() } else { left_out.join(", ") };
    let source = format!(
        "From the calibration in the files of {}{dive}: masses, volumes, flight constants (sg_cal_*, log_*). Not in them, so those of the built-in Seaglider: {rest}, and all else.",
        calibration.glider
    );
    vehicle.describe(&format!("Seaglider {}, from its files", calibration.glider), &source);
    // Read again, so that the bounds of a vehicle file hold.
    let mut checked = Vehicle::parse(&vehicle.to_toml(), format!("{FROM_FILE}: {}", calibration.glider))?;
    checked.is_builtin = false;
    Ok(checked)
}

/// The frontal area of the template over the square of the length in the basestation's formulas.
fn per_l2(calibration: &Calibration) -> Result<f64, CliError> {
    let p = Vehicle::load(TEMPLATE)?.glide_parameters();
    let length_m = calibration.length_m.filter(|length| (0.5..10.0).contains(length)).unwrap_or(p.length_m);
    Ok(p.frontal_area_m2 / (length_m * length_m))
}

/// What the files say against a vehicle of the user's own; of a built-in one, that they describe a glider better.
pub fn contradictions(vehicle: &Vehicle, calibration: &Calibration) -> Vec<String> {
    let (Some(mass_kg), Some(volume_m3)) = (calibration.mass_kg, calibration.neutral_volume_m3()) else {
        return Vec::new();
    };
    if vehicle.is_builtin {
        return Vec::new();
    }
    let volume_m3 = volume_m3 - calibration.vbd_bias_cc.unwrap_or(0.0) * 1e-6;
    let p = vehicle.glide_parameters();
    let mut found = Vec::new();
    if let Some(own_kg) = vehicle.get("mass.mass_kg").filter(|own| (own - mass_kg).abs() > CONTRADICTS_KG) {
        found.push(format!(
            "the vehicle has a mass of {own_kg:.3} kg, the log's files state {mass_kg:.3} kg (sg_cal_mass, else log_MASS)"
        ));
    }
    if let Some(own_m3) = vehicle
        .get("mass.displaced_volume_m3")
        .filter(|own| (own - volume_m3).abs() * p.reference_density_kg_m3 > CONTRADICTS_KG)
    {
        found.push(format!(
            "the vehicle displaces {:.0} cc at ballast volume zero, the log's files state {:.0} cc (sg_cal_volmax, log_C_VBD)",
            own_m3 * 1e6,
            volume_m3 * 1e6
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calibration() -> Calibration {
        Calibration {
            glider: "SG171".to_owned(),
            mass_kg: Some(56.406),
            volmax_m3: Some(0.055_775_411),
            c_vbd_counts: Some(3230.0),
            vbd_min_counts: Some(500.0),
            vbd_cc_per_count: Some(-0.2453),
            hd_a: Some(0.0038),
            hd_b: Some(0.0105),
            hd_c: Some(9.85e-6),
            hd_s: Some(-0.25),
            length_m: Some(1.8),
            rho0_kg_m3: Some(1027.5),
            compressibility_1_dbar: Some(4.1e-6),
            ..Calibration::default()
        }
    }

    /// Lift and drag of the vehicle are those of the basestation's formulas at any angle and speed.
    #[test]
    fn the_vehicle_flies_by_the_basestations_formulas() {
        let c = calibration();
        let vehicle = described(&c).expect("a vehicle");
        let p = vehicle.glide_parameters();
        for (speed_m_s, alpha_deg) in [(0.2, 1.0), (0.3, 3.0), (0.45, 5.0_f64)] {
            let q = 0.5 * 1027.5 * speed_m_s * speed_m_s;
            let l2 = 1.8 * 1.8;
            let alpha: f64 = alpha_deg.to_radians();
            let lift_N = q * p.frontal_area_m2 * p.a_per_rad * alpha;
            assert!((lift_N / (q * l2 * 0.0038 * alpha_deg) - 1.0).abs() < 1e-12);
            let q_ref = 0.5 * 1027.5 * REFERENCE_SPEED_M_S.powi(2);
            let b = p.b * (q / q_ref).powf(p.drag_exponent);
            let drag_N = q * p.frontal_area_m2 * (b + p.c_per_rad2 * alpha * alpha);
            let expected = q * l2 * (0.0105 * q.powf(-0.25) + 9.85e-6 * alpha_deg * alpha_deg);
            assert!((drag_N / expected - 1.0).abs() < 1e-12, "{drag_N} {expected}");
        }
        assert_eq!(vehicle.get("mass.mass_kg"), Some(56.406));
        let volume = vehicle.get("mass.displaced_volume_m3").expect("a volume");
        assert!((volume - (0.055_775_411 + (3230.0 - 500.0) * -0.2453e-6)).abs() < 1e-12);
        assert!(vehicle.source.contains("therm_expan") && !vehicle.is_builtin, "{}", vehicle.source);
    }

    #[test]
    fn what_contradicts_is_named_and_what_agrees_is_not() {
        let c = calibration();
        let own = described(&c).expect("a vehicle");
        assert!(contradictions(&own, &c).is_empty());
        let heavier = Calibration { mass_kg: Some(57.0), ..c.clone() };
        let said = contradictions(&own, &heavier).join("; ");
        assert!(said.contains("56.406") && said.contains("57.000"), "{said}");
        let larger = Calibration { volmax_m3: Some(0.0559), ..c };
        assert!(contradictions(&own, &larger).join("; ").contains("displaces"));
        assert!(described(&Calibration::default()).is_err());
    }
}
