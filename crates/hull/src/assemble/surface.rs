//! Wings, tails and fins: lift slope, drag and added mass of one lifting surface, on its own area.
//!
//! - Lift slope: `2 pi AR/(2 + sqrt(AR^2 (1 + tan^2 sweep) + 4))`, Helmbold's formula with sweep for a section slope of
//!   2 pi (USAF Stability and Control DATCOM 4.1.3.2; Merckelbach et al. 2010 use it for the Slocum).
//! - Induced drag: `CL^2/(pi AR e)`, Prandtl's lifting line with Oswald's efficiency.
//! - Profile drag: a flat plate wetted on both sides, `2 Cf (1 + 2 t/c)` (Hoerner 1965, Fluid-Dynamic Drag, 6-6), `Cf`
//!   laminar (Blasius, 1.328 Re^-1/2) below a Reynolds number of 5e5, ITTC-57 above.
//! - Added mass across: `rho pi (c/2)^2` per span, a flat plate (Newman 1977, Marine Hydrodynamics, table 4.3).

use std::f64::consts::PI;

/// A value and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Figure {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
}

/// A straight-tapered pair of panels, tip to tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Tip to tip \[m\].
    pub span_m: f64,
    /// Mean chord \[m\].
    pub chord_m: f64,
    /// Sweep \[rad\].
    pub sweep_rad: f64,
    /// Quarter chord of the mean chord aft of the nose \[m\].
    pub aft_m: f64,
    /// Thickness over chord.
    pub thickness: f64,
    /// Oswald's efficiency.
    pub efficiency: f64,
}

/// Relative standard error of the lift slope: the formula against wind tunnel tests of plain wings.
const LIFT_SLOPE_ERROR: f64 = 0.05;

/// Relative standard error of the induced drag: an efficiency of 0.8 may be 0.7 or 0.9.
const INDUCED_DRAG_ERROR: f64 = 0.12;

/// Relative standard error of the profile drag: laminar or turbulent, junctions and edges.
const PROFILE_DRAG_ERROR: f64 = 0.3;

/// Below, a smooth plate stays laminar.
const LAMINAR_REYNOLDS: f64 = 5e5;

impl Surface {
    /// Area \[m2\].
    pub fn area_m2(&self) -> f64 {
        self.span_m * self.chord_m
    }

    /// Aspect ratio.
    pub fn aspect_ratio(&self) -> f64 {
        self.span_m / self.chord_m
    }

    /// Lift slope on its own area \[1/rad\].
    pub fn lift_slope_per_rad(&self) -> Figure {
        wing_lift_slope_per_rad(self.aspect_ratio(), self.sweep_rad)
    }

    /// Growth of the drag coefficient with the square of the angle of attack, on its own area \[1/rad2\].
    pub fn induced_drag_per_rad2(&self) -> Figure {
        let slope = self.lift_slope_per_rad().value;
        let value = slope * slope / (PI * self.aspect_ratio() * self.efficiency);
        Figure { value, se: value * INDUCED_DRAG_ERROR.hypot(2.0 * LIFT_SLOPE_ERROR) }
    }

    /// Drag coefficient at no lift, on its own area.
    pub fn profile_drag(&self, speed_m_s: f64, kinematic_viscosity_m2_s: f64) -> Figure {
        let reynolds = speed_m_s * self.chord_m / kinematic_viscosity_m2_s;
        let value = 2.0 * plate_friction(reynolds) * (1.0 + 2.0 * self.thickness);
        Figure { value, se: PROFILE_DRAG_ERROR * value }
    }

    /// Change of the flow's angle far behind per angle of attack, `2 a/(pi AR)` (lifting line).
    pub fn downwash(&self) -> f64 {
        2.0 * self.lift_slope_per_rad().value / (PI * self.aspect_ratio())
    }

    /// Added mass across the surface \[kg\].
    pub fn added_mass_kg(&self, density_kg_m3: f64) -> f64 {
        density_kg_m3 * PI * (0.5 * self.chord_m).powi(2) * self.span_m
    }
}

/// Lift slope of a plain wing on its own area \[1/rad\].
pub fn wing_lift_slope_per_rad(aspect_ratio: f64, sweep_rad: f64) -> Figure {
    let root = (aspect_ratio * aspect_ratio * (1.0 + sweep_rad.tan().powi(2)) + 4.0).sqrt();
    let value = 2.0 * PI * aspect_ratio / (2.0 + root);
    Figure { value, se: LIFT_SLOPE_ERROR * value }
}

/// Friction of a flat plate, one side.
pub fn plate_friction(reynolds: f64) -> f64 {
    if reynolds < LAMINAR_REYNOLDS { 1.328 / reynolds.sqrt() } else { ittc_57(reynolds) }
}

/// The ship-model correlation line of the ITTC, 1957.
pub fn ittc_57(reynolds: f64) -> f64 {
    0.075 / (reynolds.log10() - 2.0).powi(2)
}
