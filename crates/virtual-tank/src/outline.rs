//! Shape of the five hulls: Table I, an outline that agrees with it, and what follows from the outline alone.

/// Mid-body diameter of every hull, m.
pub const DIAMETER_M: f64 = 0.203;

/// One hull of the "Phoenix" series: Table I of Williams, Bachmayer and deYoung, metres from the nose.
#[derive(Debug, Clone, Copy)]
pub struct TableRow {
    /// Hull id in the manifest.
    pub id: &'static str,
    /// Length to diameter ratio.
    pub ldr: f64,
    /// Overall length, m.
    pub loa_m: f64,
    /// Moment centre aft of the nose, m.
    pub mc_m: f64,
    /// Centre of buoyancy aft of the nose, m.
    pub cb_m: f64,
}

/// Table I.
pub const PHOENIX: [TableRow; 5] = [
    TableRow { id: "LDR8.5", ldr: 8.5, loa_m: 1.724, mc_m: 0.736, cb_m: 0.815 },
    TableRow { id: "LDR9.5", ldr: 9.5, loa_m: 1.927, mc_m: 0.838, cb_m: 0.915 },
    TableRow { id: "LDR10.5", ldr: 10.5, loa_m: 2.130, mc_m: 0.940, cb_m: 1.017 },
    TableRow { id: "LDR11.5", ldr: 11.5, loa_m: 2.333, mc_m: 1.041, cb_m: 1.118 },
    TableRow { id: "LDR12.5", ldr: 12.5, loa_m: 2.536, mc_m: 1.143, cb_m: 1.220 },
];

/// A slice of the hull, for crossflow: place ahead of the centre of buoyancy, m, and share of the normal force per m2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    pub ahead_m: f64,
    pub share: f64,
}

/// Frontal area pi d^2 / 4, m2.
pub(super) fn frontal_area() -> f64 {
    std::f64::consts::PI * DIAMETER_M * DIAMETER_M / 4.0
}

/// Nose: half an ellipsoid; tail: a paraboloid. The series' outline is not published; these two lengths put the centre
/// of buoyancy of every hull within 2 mm of Table I.
const NOSE_M: f64 = 0.367;
const TAIL_M: f64 = 0.445;

fn radius(row: &TableRow, from_nose: f64) -> f64 {
    let to_tail = row.loa_m - from_nose;
    let share = if from_nose < NOSE_M {
        (1.0 - (1.0 - from_nose / NOSE_M).powi(2)).sqrt()
    } else if to_tail < TAIL_M {
        (to_tail / TAIL_M).sqrt()
    } else {
        1.0
    };
    share * DIAMETER_M / 2.0
}

/// Displaced volume, m3.
pub(super) fn volume(row: &TableRow) -> f64 {
    frontal_area() * (row.loa_m - NOSE_M / 3.0 - TAIL_M / 2.0)
}

/// Strips of one campaign's crossflow: width times a crossflow drag that grows along the hull as the vortices build up
/// (two diameters' length scale), scaled so that the shares add up to the frontal area.
pub(super) fn strips(row: &TableRow) -> Vec<Strip> {
    const COUNT: usize = 48;
    let length = row.loa_m / COUNT as f64;
    let mut strips: Vec<Strip> = (0..COUNT)
        .map(|i| (i as f64 + 0.5) * length)
        .map(|from_nose| Strip {
            ahead_m: row.cb_m - from_nose,
            share: 2.0 * radius(row, from_nose) * length * (1.0 - (-from_nose / (2.0 * DIAMETER_M)).exp()),
        })
        .collect();
    let scale = frontal_area() / strips.iter().map(|strip| strip.share).sum::<f64>();
    strips.iter_mut().for_each(|strip| strip.share *= scale);
    strips
}

/// Lamb's inertia factors of a prolate spheroid (Hydrodynamics, art. 373): surge, sway, yaw.
pub(super) struct Spheroid {
    pub surge: f64,
    pub sway: f64,
    pub yaw: f64,
}

impl Spheroid {
    pub(super) fn new(fineness: f64) -> Self {
        let e2 = 1.0 - 1.0 / (fineness * fineness);
        let e = e2.sqrt();
        let logarithm = ((1.0 + e) / (1.0 - e)).ln();
        let alpha = 2.0 * (1.0 - e2) / (e2 * e) * (0.5 * logarithm - e);
        let beta = 1.0 / e2 - (1.0 - e2) / (2.0 * e2 * e) * logarithm;
        let yaw = e2 * e2 * (beta - alpha) / ((2.0 - e2) * (2.0 * e2 - (2.0 - e2) * (beta - alpha)));
        Self { surge: alpha / (2.0 - alpha), sway: beta / (2.0 - beta), yaw }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outline_has_the_centre_of_buoyancy_of_table_one() {
        for row in &PHOENIX {
            let count = 20_000;
            let slice = row.loa_m / f64::from(count);
            let (mut volume, mut moment) = (0.0, 0.0);
            for i in 0..count {
                let x = (f64::from(i) + 0.5) * slice;
                let part = std::f64::consts::PI * radius(row, x).powi(2) * slice;
                volume += part;
                moment += part * x;
            }
            assert!((volume / super::volume(row) - 1.0).abs() < 1e-4, "{}", row.id);
            assert!((moment / volume - row.cb_m).abs() < 0.002, "{}: {} against {}", row.id, moment / volume, row.cb_m);
        }
    }

    /// Values of Lamb's table as printed in textbooks for 6:1 (k1 0.045, k2 0.918, k' 0.764).
    #[test]
    fn spheroid_factors_are_lambs() {
        let six = Spheroid::new(6.0);
        assert!(
            (six.surge - 0.045).abs() < 1e-3 && (six.sway - 0.918).abs() < 1.5e-3 && (six.yaw - 0.764).abs() < 2e-3
        );
    }
}
