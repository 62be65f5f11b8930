//! The identified vehicle as a file, and the same figures in a Seaglider's own constants.

use std::f64::consts::PI;

use super::CliError;
use crate::dynamics::{PARAMETERS, Parameters};
use crate::identify::names::{long_name, short_name};
use crate::identify::pitch_balance::PitchBalance;
use crate::identify::{Identification, IdentifyReport, JointFit};
use crate::input::InputError;
use crate::log::Calibration;
use crate::vehicle::Vehicle;

/// Where a vehicle file states what a fit calls by another name.
const KEYS: [(&str, &str); 12] = [
    ("CL0", "hydro.CL0"),
    ("CM0", "hydro.CM0"),
    ("a_per_rad", "hydro.a_per_rad"),
    ("b", "hydro.b"),
    ("c_per_rad2", "hydro.c_per_rad2"),
    ("d_per_rad", "hydro.d_per_rad"),
    ("hull_compressibility_per_Pa", "hull.compressibility_per_Pa"),
    ("hull_thermal_expansion_per_K", "hull.thermal_expansion_per_K"),
    ("added_mass_1_kg", "added_mass.m1_kg"),
    ("added_mass_3_kg", "added_mass.m3_kg"),
    ("ballast_forward_m", "ballast.forward_m"),
    ("cg_below_cb_m", "mass.cg_below_cb_m"),
];

/// What follows from the balance of moments, which has no say in the polar.
const OF_MOMENTS: [&str; 4] = ["d_per_rad", "ballast_forward_m", "cg_below_cb_m", "CM0"];

/// The vehicle with everything that was fitted or held in place, and the standard errors of it; the rest of its file as it
/// was.
///
/// # Errors
/// Where a figure has no place in a vehicle file.
pub(super) fn identified(
    vehicle: &Vehicle,
    found: &Identification,
    report: &IdentifyReport,
) -> Result<Vehicle, CliError> {
    let mut identified = vehicle.clone();
    // What the trim took for the mass belongs to the vehicle as well, or it would fly at another weight.
    let trimmed_kg = found.baseline.hull_mass_kg - vehicle.glide_parameters().hull_mass_kg;
    if trimmed_kg != 0.0 {
        identified.set("mass.mass_kg", vehicle.get("mass.mass_kg").unwrap_or(0.0) + trimmed_kg)?;
    }
    for (name, quantity) in &report.parameters {
        let Some(quantity) = quantity else { continue };
        let name = long_name(name);
        // These balance only together.
        if OF_MOMENTS.contains(&name) {
            continue;
        }
        for (path, value, se) in places(&identified, &found.best_fit().parameters, name, quantity.value, quantity.se) {
            identified.set(&path, value)?;
            if se > 0.0 {
                identified.set(&format!("uncertainty.{path}"), se)?;
            }
        }
    }
    if let Some(balance) = found.pitch_balance.as_ref().filter(|balance| balance.is_identified) {
        write_balance(&mut identified, balance)?;
    }
    let source = format!(
        "{}\nIdentified by `glidepolar identify` from {} glides, {}: {}. Errors are standard errors; their correlations are in the command's JSON.",
        vehicle.source.trim_end(),
        report.n_glides,
        report.trim_meaning,
        fitted_names(found.best_fit()),
    );
    identified.describe(&format!("{}, identified", vehicle.name), &source);
    Ok(identified)
}

/// The balance of moments: what was fitted of it and what was held beside, so that the battery stands in the file's vehicle
/// where it stood in the log.
fn write_balance(vehicle: &mut Vehicle, balance: &PitchBalance) -> Result<(), InputError> {
    let p = &balance.fit.parameters;
    let se = |name: &str| balance.fit.position(name).map_or(0.0, |position| balance.fit.se(position));
    let share = p.offset_mass_kg / balance.mass_kg;
    let of_battery_m = p.moving_mass_kg * p.moving_mass_height_m / balance.mass_kg;
    let mut figures = vec![
        ("mass.moving_mass_kg", p.moving_mass_kg, 0.0),
        ("mass.cg_below_cb_m", of_battery_m + share * p.offset_mass_below_m, share * se("offset_mass_below_m")),
        ("mass.cg_forward_m", share * p.offset_mass_forward_m, share * se("offset_mass_forward_m")),
        ("hydro.d_per_rad", p.d_per_rad, se("d_per_rad")),
        ("ballast.forward_m", p.ballast_forward_m, se("ballast_forward_m")),
    ];
    // One d was fitted to both legs.
    let of_legs = ["hydro.descent.d_per_rad", "hydro.ascent.d_per_rad"].into_iter();
    figures.extend(of_legs.filter(|path| vehicle.get(path).is_some()).map(|path| (path, p.d_per_rad, se("d_per_rad"))));
    for (path, value, se) in figures {
        vehicle.set(path, value)?;
        if se > 0.0 {
            vehicle.set(&format!("uncertainty.{path}"), se)?;
        }
    }
    Ok(())
}

fn fitted_names(fit: &JointFit) -> String {
    fit.free.iter().map(|&row| short_name(PARAMETERS[row].name)).collect::<Vec<_>>().join(", ")
}

/// The keys of a figure with their values and errors: those of the legs as well, where the vehicle has a polar for each.
fn places(vehicle: &Vehicle, fitted: &Parameters<f64>, name: &str, value: f64, se: f64) -> Vec<(String, f64, f64)> {
    let is_mechanism = crate::mechanisms::of_parameter(name).is_some();
    let key = match KEYS.iter().find(|(row, _)| *row == name) {
        Some((_, key)) if !vehicle.mechanisms.contains_key(name) => key,
        _ if is_mechanism => return vec![(format!("mechanisms.{name}"), value, se)],
        // What stands behind another figure, as the mass that gives the centre of gravity its height.
        _ => return Vec::new(),
    };
    let mut places = vec![((*key).to_owned(), value, se)];
    let ratio = match name {
        "a_per_rad" => fitted.ascent_a_ratio,
        "b" => fitted.ascent_b_ratio,
        "c_per_rad2" => fitted.ascent_c_ratio,
        "d_per_rad" => fitted.ascent_d_ratio,
        _ => return places,
    };
    let legs = [("descent", 1.0), ("ascent", ratio)]
        .map(|(leg, ratio)| (format!("hydro.{leg}.{name}"), value * ratio, se * ratio));
    if ratio != 1.0 || legs.iter().any(|(path, ..)| vehicle.get(path).is_some()) {
        places[0].1 = value * 0.5 * (1.0 + ratio);
        places[0].2 = se * 0.5 * (1.0 + ratio);
        places.extend(legs);
    }
    places
}

/// Speed at which the drag of a vehicle with a drag exponent is stated \[m/s\].
const REFERENCE_SPEED_M_S: f64 = 0.3;

/// One constant of a Seaglider's pilot.
struct Constant {
    name: &'static str,
    value: f64,
    se: f64,
    unit: &'static str,
}

/// Prints the figures in the constants of a Seaglider's pilot, where the vehicle is one: those of the basestation's model,
/// lift `q l^2 hd_a alpha`, drag `q l^2 (hd_b q^hd_s + hd_c alpha^2)`, `q` the dynamic pressure \[Pa\], `alpha` in degrees.
pub(super) fn print_for_seagliders(
    vehicle: &Vehicle,
    found: &Identification,
    report: &IdentifyReport,
    calibration: Option<&Calibration>,
) {
    let lines = for_seagliders(vehicle, found, report, calibration);
    if lines.is_empty() {
        return;
    }
    println!();
    println!("as a Seaglider's pilot types it in (+- standard error):");
    for [name, value, se, unit] in lines {
        println!("  {name:<14} {value:>12} +- {se:<11} {unit}");
    }
    println!("  VOLMAX or C_VBD, not both: they correct the same offset.");
}

/// Name, value, standard error and unit of each constant; none where the vehicle is no Seaglider.
pub(super) fn for_seagliders(
    vehicle: &Vehicle,
    found: &Identification,
    report: &IdentifyReport,
    calibration: Option<&Calibration>,
) -> Vec<[String; 4]> {
    if !vehicle.name.to_lowercase().contains("seaglider") {
        return Vec::new();
    }
    let p = &found.best_fit().parameters;
    let own = calibration.filter(|own| is_described_by(vehicle, own));
    let all =
        constants(p, report, calibration).into_iter().chain(own.into_iter().flat_map(|own| absolute(p, report, own)));
    let line = |c: Constant| [c.name.to_owned(), digits(c.value), digits(c.se), c.unit.to_owned()];
    all.map(line).collect()
}

/// Whether the vehicle has the mass and the volume of the files: then the offset counts from these.
fn is_described_by(vehicle: &Vehicle, own: &Calibration) -> bool {
    let same = |path: &str, value: Option<f64>| {
        value.zip(vehicle.get(path)).is_some_and(|(own, here)| (own - here).abs() <= 1e-9 * own.abs())
    };
    let volume = own.neutral_volume_m3().map(|volume| volume - own.vbd_bias_cc.unwrap_or(0.0) * 1e-6);
    same("mass.mass_kg", own.mass_kg) && same("mass.displaced_volume_m3", volume)
}

/// `VOLMAX` and `C_VBD` as such: the largest volume that explains the fitted weight, and the counts at which the glider is
/// neutral in the water of `RHO`.
fn absolute(p: &Parameters<f64>, report: &IdentifyReport, own: &Calibration) -> Vec<Constant> {
    let Some(Some(offset)) = report.parameters.get("ballast_offset_kg") else { return Vec::new() };
    let cc_per_kg = 1e6 / p.reference_density_kg_m3;
    let mut found = Vec::new();
    if let Some(volmax_m3) = own.volmax_m3 {
        let value = volmax_m3 * 1e6 - offset.value * cc_per_kg;
        found.push(Constant { name: "VOLMAX", value, se: offset.se * cc_per_kg, unit: "cc" });
    }
    let neutral = || {
        let heavy_kg = own.mass_kg? + offset.value - own.neutral_volume_m3()? * own.log_rho_kg_m3?;
        let counts_per_kg = 1e6 / own.log_rho_kg_m3? / own.vbd_cc_per_count?;
        let value = own.c_vbd_counts? + heavy_kg * counts_per_kg;
        Some(Constant { name: "C_VBD", value, se: (offset.se * counts_per_kg).abs(), unit: "counts, neutral in RHO" })
    };
    found.extend(neutral());
    found
}

fn constants(p: &Parameters<f64>, report: &IdentifyReport, own: Option<&Calibration>) -> Vec<Constant> {
    let per_l2 = p.frontal_area_m2 / (p.length_m * p.length_m);
    let degree = PI / 180.0;
    let reference_Pa = 0.5 * p.reference_density_kg_m3 * REFERENCE_SPEED_M_S * REFERENCE_SPEED_M_S;
    // A glider that is heavier by so much displaces so much less; in counts by the files' own cc a count, else the nominal.
    const NOMINAL_CC_PER_COUNT: f64 = -0.245_296;
    let own_count = own.and_then(|own| own.vbd_cc_per_count).filter(|count| count.abs() > 1e-3);
    let count_unit = if own_count.is_some() { "counts" } else { "counts, at -0.245296 cc a count" };
    let cc_per_kg = 1e6 / p.reference_density_kg_m3;
    [
        ("a", "HD_A", per_l2 * degree, "per deg"),
        ("b", "HD_B", per_l2 * reference_Pa.powf(-p.drag_exponent), "Pa^(1/4)"),
        ("c", "HD_C", per_l2 * degree * degree, "per deg^2"),
        ("ballast_offset_kg", "VOLMAX change", -cc_per_kg, "cc"),
        ("ballast_offset_kg", "C_VBD change", cc_per_kg / own_count.unwrap_or(NOMINAL_CC_PER_COUNT), count_unit),
    ]
    .into_iter()
    .filter_map(|(row, name, factor, unit)| {
        let of_row = report.parameters.get(row)?.as_ref()?;
        Some(Constant { name, value: of_row.value * factor, se: (of_row.se * factor).abs(), unit })
    })
    .collect()
}

fn digits(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !size.is_finite() => "unknown".to_owned(),
        size if size < 1e-2 => format!("{value:.3e}"),
        size if size < 10.0 => format!("{value:.4}"),
        _ => format!("{value:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The basestation's public defaults, from which the built-in Seaglider was made, come back.
    #[test]
    fn the_built_in_seaglider_has_the_basestations_constants() {
        let vehicle = Vehicle::load("seaglider").expect("a built-in vehicle");
        let p = vehicle.glide_parameters();
        let per_l2 = p.frontal_area_m2 / (p.length_m * p.length_m);
        let degree = PI / 180.0;
        let reference_Pa = 0.5 * p.reference_density_kg_m3 * REFERENCE_SPEED_M_S * REFERENCE_SPEED_M_S;
        assert!((p.a_per_rad * per_l2 * degree / 0.003548 - 1.0).abs() < 1e-4);
        assert!((p.b * per_l2 * reference_Pa.powf(-p.drag_exponent) / 0.011220 - 1.0).abs() < 1e-3);
        assert!((p.c_per_rad2 * per_l2 * degree * degree / 5.7e-6 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn both_legs_of_a_vehicle_with_two_polars_are_written() {
        let vehicle = Vehicle::load("slocum-049").expect("a built-in vehicle");
        let p = vehicle.glide_parameters();
        let mut written = vehicle.clone();
        for (path, value, _) in places(&vehicle, &p, "b", 1.1 * p.b, 0.0) {
            written.set(&path, value).expect("a key");
        }
        let q = written.glide_parameters();
        assert!((q.b / p.b - 1.1).abs() < 1e-12 && (q.ascent_b_ratio / p.ascent_b_ratio - 1.0).abs() < 1e-12);
    }
}
