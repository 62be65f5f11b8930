//! A log without temperature, of a hull that expands with it: the temperature that its density suggests.
//!
//! The hull's buoyancy is `tau rho V (T - T0)` more than at the reference. A density alone does not say `T`: warm water and fresh water
//! are both light. It is taken as
//!
//! ```text
//! T = T0 - (sigma - mean sigma)/(alpha rho)
//! ```
//!
//! with the density `sigma` at p = 0, as if salinity were the same everywhere. The expansion is then fitted with the polar: `s tau` is
//! left of it where a share `s` of the stratification is the temperature's, 0.5 +- 0.5 beforehand. How warm the water is on the
//! whole is left to the trim, which is fitted as one that was assumed. Knows samples and the hull; no search.

use crate::dynamics::Parameters;
use crate::dynamics::buoyancy::WATER_COMPRESSIBILITY_PER_PA;
use crate::log::{DBAR_PA, Observation};

/// The parameter that is fitted.
pub(super) const PARAMETER: &str = "hull_thermal_expansion_per_K";

/// Expected share of the temperature in the stratification, and its standard deviation.
pub(super) const SHARE: [f64; 2] = [0.5, 0.5];

/// Thermal expansion of sea water \[1/K\]: 1e-4 at 5 degC, 2e-4 at 17 degC (TEOS-10 at 35 g/kg).
const WATER_EXPANSION_PER_K: f64 = 1.5e-4;

/// The sea's surface has -2 to 32 degC: no water is farther from a reference of 15 degC \[K\].
const FARTHEST_K: f64 = 17.0;

/// What the reader has to know.
pub(super) const WARNING: &str = "the hull expands with temperature, and the log has none: trim and expansion are fitted, and no offset of the ballast is named that the water's temperature may be";

/// Whether the hull expands and no sample says how warm the water is.
pub(super) fn is_unknown(vehicle: &Parameters<f64>, observations: &[Observation]) -> bool {
    vehicle.hull_thermal_expansion_per_K != 0.0 && observations.iter().all(|o| !o.temperature_C.is_finite())
}

/// The samples with the temperature that their density suggests.
pub(super) fn suggested(vehicle: &Parameters<f64>, observations: &[Observation]) -> Vec<Observation> {
    let at_surface =
        |o: &Observation| o.density_kg_m3 / (1.0 + WATER_COMPRESSIBILITY_PER_PA * DBAR_PA * o.pressure_dbar);
    let known = observations.iter().map(at_surface).filter(|density| density.is_finite());
    let (n, sum) = known.fold((0.0, 0.0), |(n, sum), density| (n + 1.0, sum + density));
    let mean = sum / n;
    let warmer = |o: &Observation| (mean - at_surface(o)) / (WATER_EXPANSION_PER_K * mean);
    let with = |o: &Observation| Observation { temperature_C: vehicle.reference_temperature_C + warmer(o), ..*o };
    observations.iter().map(with).collect()
}

/// What the hull's buoyancy may be off by as the temperature of all of the water is not known \[kg\].
pub(super) fn most_kg(vehicle: &Parameters<f64>) -> f64 {
    vehicle.hull_thermal_expansion_per_K.abs() * vehicle.mass_kg() * FARTHEST_K
}
