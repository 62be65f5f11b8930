//! Added mass of prolate spheroids in closed form (Lamb, Hydrodynamics, sections 114 and 115).

/// Added mass of a prolate spheroid over the displaced mass, and added moment of inertia over that of the displaced water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LambFactors {
    /// Along the axis.
    pub k1: f64,
    /// Across the axis.
    pub k2: f64,
    /// In yaw or pitch, over the moment of inertia of the displaced water.
    pub k_prime: f64,
}

impl LambFactors {
    /// For a length to diameter ratio above 1.
    ///
    /// With the eccentricity `e = sqrt(1 - 1/f^2)` and `l = ln((1 + e)/(1 - e))`:
    /// `a0 = 2 (1 - e^2)/e^3 (l/2 - e)`, `b0 = 1/e^2 - (1 - e^2)/(2 e^3) l`, `k1 = a0/(2 - a0)`, `k2 = b0/(2 - b0)`,
    /// `k' = e^4 (b0 - a0)/((2 - e^2) (2 e^2 - (2 - e^2)(b0 - a0)))`.
    pub fn new(slenderness: f64) -> Self {
        let e2 = 1.0 - 1.0 / (slenderness * slenderness);
        let e = e2.sqrt();
        let l = ((1.0 + e) / (1.0 - e)).ln();
        let a0 = 2.0 * (1.0 - e2) / (e2 * e) * (l / 2.0 - e);
        let b0 = 1.0 / e2 - (1.0 - e2) / (2.0 * e2 * e) * l;
        let difference = b0 - a0;
        LambFactors {
            k1: a0 / (2.0 - a0),
            k2: b0 / (2.0 - b0),
            k_prime: e2 * e2 * difference / ((2.0 - e2) * (2.0 * e2 - (2.0 - e2) * difference)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_are_those_of_the_published_tables() {
        for (f, k1, k2, k_prime) in [
            (4.0, 0.0816, 0.8598, 0.6079),
            (6.0, 0.0452, 0.9171, 0.7623),
            (8.0, 0.0293, 0.9447, 0.8394),
            (10.5, 0.0192, 0.9631, 0.8916),
            (15.0, 0.0109, 0.9787, 0.9371),
        ] {
            let lamb = LambFactors::new(f);
            assert!((lamb.k1 - k1).abs() < 6e-5, "{f}: {lamb:?}");
            assert!((lamb.k2 - k2).abs() < 6e-5, "{f}: {lamb:?}");
            assert!((lamb.k_prime - k_prime).abs() < 6e-5, "{f}: {lamb:?}");
        }
    }
}
