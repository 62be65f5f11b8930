//! The reduction from end to end, in the order in which a tank engineer does it.

use std::path::Path;

use glidepolar::input::InputError;

use crate::results::{HullResults, Results};
use crate::{checks, fits, points};

/// Reduces a table of points of one hull.
///
/// # Errors
/// Where either file cannot be used.
pub fn reduce_points(points: &Path, hull: &Path, range_deg: f64) -> Result<Results, InputError> {
    let read = points::read(points, hull)?;
    let fit = fits::fit(&read.sweep, range_deg);
    let id = &read.hull.id;
    let mut warnings = read.notices;
    match &fit {
        Ok(fit) => {
            warnings.extend(checks::signs(id, &fit.estimates));
            warnings.extend(fits::warnings(id, fit));
        }
        Err(few) => warnings.push(format!("{id}: no fit: {few}")),
    }
    Ok(Results {
        name: points.display().to_string(),
        source: read.source,
        range_deg,
        hulls: vec![HullResults { n_runs: read.sweep.points.len(), hull: read.hull, sweep: read.sweep, fit }],
        trend: None,
        warnings,
    })
}
