//! Parameters that the balance cannot identify, since others have the same effect. Knows no samples.

use nalgebra::DMatrix;

use crate::identify::joint::JointFit;
use glidepolar_inference::covariance::inverse_symmetric;
use glidepolar_inference::gram::Gram;

/// Largest share of a parameter's effect, by variance, that the others may have as well: with less than two per cent of its
/// size to itself, an error of the model would pass for the parameter.
const INSEPARABLE: f64 = 0.9995;

/// A parameter that the data do not identify, and why; the last of [`ROWS`](super::ROWS) first.
pub(super) fn not_identifiable(fit: &JointFit) -> Option<(usize, String)> {
    let normal = Gram::sum(fit.free.len(), &fit.grams).normal_matrix();
    for name in ["ballast_forward_m", "d_per_rad"] {
        let Some(position) = fit.position(name) else { continue };
        let explained = explained_by_others(&normal, fit.position("offset_mass_forward_m"), position);
        if explained > INSEPARABLE {
            let reason = format!(
                "battery, ballast and speed change together in these data: {:.2} % of what it does, the others do as well",
                100.0 * explained
            );
            return Some((position, reason));
        }
        let (value, se) = (fit.value(fit.free[position]), fit.se(position));
        if se.is_nan() || 2.0 * se > value.abs().max(resolution(name)) {
            return Some((
                position,
                format!("these data leave it open: fitted freely it would be {value:.3} +- {se:.3}"),
            ));
        }
    }
    None
}

/// Share of the variance of one column of the Jacobian that the others explain, the constant set aside.
fn explained_by_others(normal: &DMatrix<f64>, constant: Option<usize>, position: usize) -> f64 {
    let own = match constant.filter(|&c| c != position && normal[(c, c)] > 0.0) {
        Some(c) => normal[(position, position)] - normal[(position, c)].powi(2) / normal[(c, c)],
        None => normal[(position, position)],
    };
    1.0 - 1.0 / (own * inverse_symmetric(normal)[(position, position)]).max(1.0)
}

/// Half a 95 % interval that still says something where the value itself is about zero.
fn resolution(name: &str) -> f64 {
    if name == "d_per_rad" { 0.5 } else { 0.1 }
}
