//! Checks of signs and magnitudes that are impossible for a bare hull.

use glidepolar_hull::hull_tests::{Estimate, HullFit};
use glidepolar_input::printable;

use crate::campaign::Rejected;
use crate::derivatives::Derivatives;
use crate::fits::STEEPEST_PER_RAD;
use crate::results::{HullResults, RunResults};
use crate::series::{median, robust_sd};
use crate::theory;
use crate::trend::{COEFFICIENTS, Lines};

/// Whether the slopes have signs that physics forbids, and which entry of the manifest would explain them.
///
/// A hull lifts to the side to which it drifts, and a bare one is turned further by the Munk moment; no towed body pushes
/// itself forward.
pub fn signs(id: &str, fit: &HullFit) -> Vec<String> {
    let negative = |q: &Estimate| q.ci95[1] < 0.0;
    let mut warnings = Vec::new();
    let report = |what: &str, cause: &str| format!("{id}: {what}: impossible for a bare hull; {cause}");
    match (negative(&fit.a), negative(&fit.d)) {
        (true, true) => warnings.push(report(
            &format!("lift slope a = {:.3} and moment slope d = {:.3} per rad are both negative", fit.a.value, fit.d.value),
            "is the yaw angle counted the other way? Expected: yaw_deg positive bow to starboard, SF positive to starboard, YM positive bow to starboard",
        )),
        (true, false) => warnings.push(report(
            &format!("lift slope a = {:.3} per rad is negative", fit.a.value),
            "is SF recorded with the opposite sign? Expected: positive to starboard, the force of the water on the model",
        )),
        (false, true) => warnings.push(report(
            &format!("moment slope d = {:.3} per rad is negative", fit.d.value),
            "is YM recorded with the opposite sign, or are mc_m and cb_m exchanged? Expected: YM positive bow to starboard, both distances aft of the nose",
        )),
        (false, false) => {}
    }
    let steep = [("a", &fit.a), ("d", &fit.d)].into_iter().find(|(_, q)| q.value.abs() > STEEPEST_PER_RAD);
    if let Some((name, q)) = steep {
        warnings.push(report(
            &format!("slope {name} = {:.1} per rad", q.value),
            "are the angles in radians? Expected: yaw_deg in degrees, in runs.csv and in the runs' files",
        ));
    }
    if negative(&fit.b) {
        warnings.push(report(
            &format!("drag b = {:.4} is negative", fit.b.value),
            "is AF recorded with the opposite sign? Expected: positive aft, the force of the water on the model",
        ));
    }
    warnings
}

/// Drag coefficient of a disk normal to the flow (Hoerner 1965), an upper bound for any hull.
const DISK_DRAG: f64 = 1.17;

/// Returns a warning where the drag is below that of a laminar boundary layer or above that of a disk.
pub fn drag(hull: &HullResults) -> Option<String> {
    let (id, b) = (&hull.hull.id, &hull.fit.as_ref().ok()?.estimates.b);
    let reynolds: Vec<f64> = hull.sweep.points.iter().filter_map(|point| point.reynolds).collect();
    let least = if reynolds.is_empty() { 0.0 } else { theory::laminar_drag(&hull.hull, median(&reynolds)) };
    let units = "are the forces in newtons (1 kgf = 9.81 N, 1 lbf = 4.45 N), the speed in m/s and the diameter in m?";
    // A negative drag is reported by `signs`.
    if (0.0..least).contains(&b.ci95[1]) {
        Some(format!(
            "{id}: drag b = {:.4} is below that of a laminar boundary layer, {least:.4}: impossible; {units}",
            b.value
        ))
    } else if b.ci95[0] > DISK_DRAG {
        Some(format!(
            "{id}: drag b = {:.3} is more than that of a disk, {DISK_DRAG}: impossible for a hull; {units}",
            b.value
        ))
    } else {
        None
    }
}

/// Derivatives of impossible sign, kinds of run that disagree, motions too quick.
pub fn dynamic(hull: &HullResults) -> Vec<String> {
    let id = &hull.hull.id;
    let Some(dynamic) = &hull.dynamic else { return Vec::new() };
    let mut warnings = Vec::new();
    let e = &dynamic.estimates;
    let masses = [("Yvdot", e.yvdot.as_ref()), ("Nrdot", e.nrdot.as_ref())];
    for (name, q) in masses.into_iter().filter_map(|(name, q)| Some((name, q?))) {
        if q.ci95[0] > 0.0 {
            warnings.push(format!(
                "{id}: {name}' = {:.2e} is positive: added mass cannot be negative; are live_mass_kg and izz_kg_m2 right, and sway_m and yaw_deg positive to starboard?",
                q.value
            ));
        }
    }
    for comparison in hull.comparisons.iter().chain(&dynamic.turns) {
        if comparison.disagrees() {
            warnings.push(format!(
                "{id}: {}' differs between {} ({:.5}) and {} ({:.5}) by {:.1} standard errors",
                comparison.name,
                comparison.first_from,
                comparison.first.value,
                comparison.second_from,
                comparison.second.value,
                comparison.apart().abs()
            ));
        }
    }
    let (low, high) = dynamic.reduced_frequencies.unwrap_or_default();
    for (name, p_value) in &dynamic.frequency_dependence {
        if *p_value < 1e-4 {
            warnings.push(format!(
                "{id}: {name}' moves with frequency (p = {p_value:.0e}); reduced frequencies {low:.2} to {high:.2} may be too high for a steady value"
            ));
        }
    }
    warnings.extend(left_out(id, dynamic));
    warnings
}

/// Derivatives that the campaign's runs do not identify, and why.
fn left_out(id: &str, dynamic: &Derivatives) -> Option<String> {
    let e = &dynamic.estimates;
    let all = [
        ("Yr", &e.yr),
        ("Nr", &e.nr),
        ("Yvdot", &e.yvdot),
        ("Nvdot", &e.nvdot),
        ("Yrdot", &e.yrdot),
        ("Nrdot", &e.nrdot),
    ];
    let missing: Vec<&str> = all.into_iter().filter(|(_, q)| q.is_none()).map(|(name, _)| name).collect();
    let missing = if missing.is_empty() { return None } else { missing.join(", ") };
    Some(if dynamic.slopes_from_sweep {
        format!("{id}: no usable sway runs: Yv and Nv are those of the steady sweep, and {missing} are left out")
    } else if e.yr.is_none() {
        format!("{id}: no usable yaw runs or turns: {missing} are left out")
    } else {
        format!("{id}: no usable yaw runs: {missing} are left out")
    })
}

/// A tank so narrow that its walls matter.
pub fn blockage(hull: &HullResults) -> Option<String> {
    let share = hull.blockage.filter(|share| *share > 0.01)?;
    Some(format!(
        "{}: the hull fills {:.1} % of the tank's cross-section: blockage is not corrected for",
        hull.hull.id,
        100.0 * share
    ))
}

/// Coefficients that do not lie on a line against length to diameter ratio.
pub fn trend(lines: &Lines) -> Vec<String> {
    let unlikely = lines.0.iter().zip(COEFFICIENTS).filter(|(line, _)| line.p_value < 0.001);
    unlikely
        .map(|(line, (name, ..))| {
            format!("{name} against length to diameter ratio is no straight line (p = {:.0e})", line.p_value)
        })
        .collect()
}

/// Runs whose reading at rest does not agree with the zeros before and after.
pub fn runs(runs: &[RunResults]) -> Vec<String> {
    let mut warnings = Vec::new();
    for (channel, name) in ["AF", "SF", "YM"].into_iter().enumerate() {
        let differences: Vec<f64> = runs.iter().filter_map(|r| r.rest_less_zero.map(|d| d[channel])).collect();
        if differences.len() < 10 {
            continue;
        }
        let sd = robust_sd(&differences);
        let mut off: Vec<&RunResults> =
            runs.iter().filter(|r| r.rest_less_zero.is_some_and(|d| d[channel].abs() > 8.0 * sd)).collect();
        off.truncate(3);
        if let Some(first) = off.first() {
            warnings.push(format!(
                "run {}: {name} at rest is {:.3} off the zero taken from the zero runs (usual {sd:.3}): did the zero jump?",
                first.run.id,
                first.rest_less_zero.map_or(0.0, |d| d[channel])
            ));
        }
    }
    for run in runs {
        warnings.extend(run.notices.iter().map(|notice| format!("run {}: {notice}", run.run.id)));
    }
    warnings
}

/// Runs that were left out.
pub fn rejected(rejected: &[Rejected]) -> Vec<String> {
    rejected.iter().map(|r| format!("run {} is left out: {}", printable(&r.run_id), r.error)).collect()
}
