//! From measured derivatives to the added masses, the added inertia and the pitch damping of a vehicle.
//!
//! A hull of revolution moves in the glider's vertical plane as in the tank's horizontal one: sway becomes heave, yaw
//! becomes pitch. `Yvdot` and `Nrdot` are the negative added mass and inertia; `CMq = Nr' L^2/A`, since
//! `rho/2 L^4 V r Nr' = rho/2 V^2 A L (r L/V) CMq`. The surge added mass shows in neither sway nor yaw: Lamb's spheroid
//! of the same length to diameter ratio stands in for it, a few per cent of the displaced mass.

use super::{LambFactors, ReducedHull};

/// Where a figure comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Oscillations in the tank.
    Measured,
    /// Potential flow about a spheroid of the same length to diameter ratio.
    Lamb,
}

/// Water that moves with a hull, about its centre of buoyancy. Each figure with its standard error and source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedMass {
    /// Along axis 1 \[kg\].
    pub m1_kg: (f64, f64, Source),
    /// Along axis 3 \[kg\].
    pub m3_kg: (f64, f64, Source),
    /// In pitch, to be added to the moment of inertia of the vehicle itself \[kg m2\].
    pub pitch_kg_m2: (f64, f64, Source),
    /// `CMq` on frontal area and overall length, and its standard error; none where it was not measured.
    pub pitch_damping_CMq: Option<(f64, f64)>,
}

/// Standard error of Lamb's factors for a glider's hull: measured hulls lie 20 to 25 % below (Roddy 1990: 0.77, 0.75).
const LAMB_RELATIVE_ERROR: f64 = 0.2;

impl ReducedHull {
    /// Added masses in water of this density; `volume_m3` is the displaced volume \[m3\] that Lamb's factors refer to.
    pub fn added_mass(&self, density_kg_m3: f64, volume_m3: f64) -> AddedMass {
        let lamb = LambFactors::new(self.geometry.slenderness());
        let (length, diameter) = (self.geometry.loa_m, self.geometry.diameter_m);
        let displaced = density_kg_m3 * volume_m3;
        // Of the displaced water as a spheroid: m (l^2 + d^2)/20.
        let inertia = displaced * (length * length + diameter * diameter) / 20.0;
        let estimated = |value: f64| (value, LAMB_RELATIVE_ERROR * value, Source::Lamb);
        let l3 = 0.5 * density_kg_m3 * length.powi(3);
        let measured = |estimate: Option<&super::Estimate>, scale: f64| {
            estimate.map(|e| (-e.value * scale, e.se * scale, Source::Measured))
        };
        let dynamic = self.dynamic.as_ref();
        let yvdot = dynamic.and_then(|d| d.yvdot.as_ref());
        let nrdot = dynamic.and_then(|d| d.nrdot.as_ref());
        let damping = length * length / self.geometry.frontal_area_m2();
        AddedMass {
            m1_kg: estimated(lamb.k1 * displaced),
            m3_kg: measured(yvdot, l3).unwrap_or_else(|| estimated(lamb.k2 * displaced)),
            pitch_kg_m2: measured(nrdot, l3 * length * length).unwrap_or_else(|| estimated(lamb.k_prime * inertia)),
            pitch_damping_CMq: dynamic.and_then(|d| d.nr.as_ref()).map(|nr| (nr.value * damping, nr.se * damping)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull_tests::{DynamicDerivatives, Estimate, HullGeometry};

    /// SUBOFF, bare hull: Roddy 1990 gives Yvdot' -0.013270, Nrdot' -0.000676 and Nr' -0.001597.
    #[test]
    fn the_suboff_derivatives_become_masses() {
        let q = |value: f64| Estimate { value, se: 0.0, ci95: [value, value], unit: "1".to_owned() };
        let hull = ReducedHull {
            id: "SUBOFF".to_owned(),
            ldr: 8.575,
            n_runs: 0,
            geometry: HullGeometry { diameter_m: 0.508, loa_m: 4.356, cb_m: 2.0086, volume_m3: Some(0.6992) },
            fit: None,
            dynamic: Some(DynamicDerivatives {
                yv: q(-0.005948),
                nv: q(-0.012795),
                yr: Some(q(0.001811)),
                nr: Some(q(-0.001597)),
                yvdot: Some(q(-0.013270)),
                nvdot: None,
                yrdot: None,
                nrdot: Some(q(-0.000676)),
            }),
            diagnosis: None,
            extended: None,
        };
        let added = hull.added_mass(1000.0, 0.6992);
        let l3 = 500.0 * 4.356f64.powi(3);
        assert!((added.m3_kg.0 - 0.013270 * l3).abs() < 1e-9);
        // About three quarters of the displaced mass, as Lamb's 0.95 times the 0.77 that the report finds.
        assert!((added.m3_kg.0 / 699.2 - 0.784).abs() < 0.01, "{}", added.m3_kg.0);
        assert!((added.pitch_kg_m2.0 - 0.000676 * l3 * 4.356 * 4.356).abs() < 1e-9);
        let damping = added.pitch_damping_CMq.unwrap().0;
        assert!((damping + 0.001597 * 4.356 * 4.356 / 0.202683).abs() < 1e-6, "{damping}");
        assert_eq!(added.m1_kg.2, Source::Lamb);
    }
}
