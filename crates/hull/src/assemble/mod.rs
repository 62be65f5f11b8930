//! From a bare hull, as a towing tank measured it, to a vehicle: wing, tail, fin and an external sensor added by the
//! standard build-up of aerodynamics, each term with its source and standard error.
//!
//! With `A` the frontal area, `L` the hull's length, `S` the area of a surface and `x` its place aft of the centre of
//! buoyancy:
//! ```text
//! a = a_hull + sum a_i S_i/A                       c = c_hull + sum a_i^2 S_i/(pi AR_i e_i A)
//! b = b_hull + sum CD0_i S_i/A + sum (CD A)_pod/A  d = d_hull - sum a_i S_i x_i/(A L)
//! CMq = CMq_hull - sum a_i S_i x_i^2/(A L^2)       CM0 = - sum (CD A)_pod z_pod/(A L)
//! ```
//! A tail behind a wing meets its downwash, `a_tail (1 - 2 a_wing/(pi AR_wing))`. Interference of the parts with the
//! hull is left out but for the standard errors. Knows no files.

mod effect;
mod sensor;
mod stability;
mod surface;

use crate::hull_tests::{ReducedHull, Source};
use glidepolar_dynamics::Parameters;

pub use effect::{Effect, Lateral, Look, effect};
pub use sensor::Sensor;
pub use stability::PitchStability;
pub use surface::{Figure, Surface, ittc_57, plate_friction, wing_lift_slope_per_rad};

/// An external sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pod {
    /// Drag coefficient times the area that it refers to \[m2\].
    pub drag_area_m2: Figure,
    /// Aft of the nose \[m\].
    pub aft_m: f64,
    /// To starboard of the hull's axis; negative to port \[m\].
    pub starboard_m: f64,
    /// Below the hull's axis \[m\].
    pub below_m: f64,
    /// Power \[W\].
    pub power_W: f64,
}

/// What is put together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts<'a> {
    /// The bare hull.
    pub hull: &'a ReducedHull,
    /// The wing.
    pub wing: Option<Surface>,
    /// Horizontal surfaces behind the wing.
    pub tail: Option<Surface>,
    /// The vertical fin with its rudder.
    pub fin: Option<Surface>,
    /// Speed at which friction is taken \[m/s\].
    pub speed_m_s: f64,
    /// Speed at which the hull was towed; with it the hull's drag is taken to the speed of the glider \[m/s\].
    pub tow_speed_m_s: Option<f64>,
    /// Density of the water \[kg/m3\].
    pub density_kg_m3: f64,
    /// Kinematic viscosity of the water \[m2/s\].
    pub kinematic_viscosity_m2_s: f64,
    /// Displaced volume of the hull \[m3\].
    pub volume_m3: f64,
}

/// What one part adds, on the hull's frontal area and length.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
#[allow(missing_docs, reason = "named after the coefficient")]
pub struct Term {
    pub part: &'static str,
    /// Who says so.
    pub source: &'static str,
    pub a_per_rad: Figure,
    pub b: Figure,
    pub c_per_rad2: Figure,
    pub d_per_rad: Figure,
    pub pitch_damping_CMq: Figure,
    /// In N m s2, at the density of the water.
    pub pitch_damping_quadratic: Figure,
    pub m1_kg: Figure,
    pub m3_kg: Figure,
    pub added_pitch_inertia_kg_m2: Figure,
}

/// The sum and its terms.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Buildup {
    /// Term by term.
    pub terms: Vec<Term>,
    /// Their sum; independent errors add in squares.
    pub total: Term,
    /// Whether the sum turns into the flow.
    pub pitch: PitchStability,
}

/// Why there is no build-up.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AssembleError {
    /// The hull was never towed at angles.
    #[error("hull {0} has no fitted coefficients: reduce its static runs first")]
    NoFit(String),
}

/// Adds the parts up.
///
/// # Errors
/// Where the hull has no coefficients.
pub fn build_up(parts: &Parts<'_>) -> Result<Buildup, AssembleError> {
    let hull = parts.hull;
    // Where a diagnosis named what the plain fit gets wrong, the coefficients beside it hold.
    let extended = hull.extended.as_ref().map(|extended| &extended.fit);
    let fit = extended.or(hull.fit.as_ref()).ok_or_else(|| AssembleError::NoFit(hull.id.clone()))?;
    let of = |value: f64, se: f64| Figure { value, se };
    let added = hull.added_mass(parts.density_kg_m3, parts.volume_m3);
    let slender = hull.geometry.loa_m.powi(2) / hull.geometry.frontal_area_m2();
    let (damping, damping_se) = added.pitch_damping_CMq.unwrap_or((SUBOFF_NR * slender, SUBOFF_NR_ERROR * slender));
    let mut terms = vec![Term {
        part: "hull",
        source: match added.m3_kg.2 {
            Source::Measured => "towing tank; surge added mass: Lamb, Hydrodynamics, 114-115",
            Source::Lamb => "towing tank; added mass: Lamb, Hydrodynamics, 114-115",
        },
        a_per_rad: of(fit.a.value, fit.a.se),
        b: of(fit.b.value, fit.b.se),
        c_per_rad2: of(fit.c.value, fit.c.se),
        d_per_rad: of(fit.d.value, fit.d.se),
        pitch_damping_CMq: of(damping, damping_se),
        pitch_damping_quadratic: Figure::default(),
        m1_kg: of(added.m1_kg.0, added.m1_kg.1),
        m3_kg: of(added.m3_kg.0, added.m3_kg.1),
        added_pitch_inertia_kg_m2: of(added.pitch_kg_m2.0, added.pitch_kg_m2.1),
    }];
    terms.push(crossflow_term(parts, added.pitch_damping_CMq.is_none()));
    terms.extend(parts.tow_speed_m_s.map(|tow| reynolds_term(parts, fit.b.value, tow)));
    let downwash = parts.wing.map_or(0.0, |wing| wing.downwash());
    if let Some(wing) = &parts.wing {
        terms.push(lifting_term("wing", parts, wing, 1.0));
    }
    if let Some(tail) = &parts.tail {
        terms.push(lifting_term("tail", parts, tail, 1.0 - downwash));
    }
    if let Some(fin) = &parts.fin {
        let friction = fin.profile_drag(parts.speed_m_s, parts.kinematic_viscosity_m2_s);
        terms.push(Term {
            part: "fin",
            source: "Hoerner, Fluid-Dynamic Drag, 6-6; Blasius",
            b: scaled(friction, fin.area_m2() / hull.geometry.frontal_area_m2()),
            ..Term::default()
        });
    }
    let total = terms.iter().fold(Term { part: "total", source: "sum", ..Term::default() }, |sum, term| Term {
        a_per_rad: plus(sum.a_per_rad, term.a_per_rad),
        b: plus(sum.b, term.b),
        c_per_rad2: plus(sum.c_per_rad2, term.c_per_rad2),
        d_per_rad: plus(sum.d_per_rad, term.d_per_rad),
        pitch_damping_CMq: plus(sum.pitch_damping_CMq, term.pitch_damping_CMq),
        pitch_damping_quadratic: plus(sum.pitch_damping_quadratic, term.pitch_damping_quadratic),
        m1_kg: plus(sum.m1_kg, term.m1_kg),
        m3_kg: plus(sum.m3_kg, term.m3_kg),
        added_pitch_inertia_kg_m2: plus(sum.added_pitch_inertia_kg_m2, term.added_pitch_inertia_kg_m2),
        ..sum
    });
    Ok(Buildup { pitch: PitchStability::new(parts, &total), terms, total })
}

/// A surface in the vertical plane of motion; `flow` is the share of the angle of attack that reaches it.
fn lifting_term(part: &'static str, parts: &Parts<'_>, surface: &Surface, flow: f64) -> Term {
    let geometry = &parts.hull.geometry;
    let (area, length) = (geometry.frontal_area_m2(), geometry.loa_m);
    let share = surface.area_m2() / area;
    let arm = (surface.aft_m - geometry.cb_m) / length;
    let slope = surface.lift_slope_per_rad();
    let added = surface.added_mass_kg(parts.density_kg_m3);
    let aft_m = arm * length;
    Term {
        part,
        source: "lift: DATCOM 4.1.3.2 (Helmbold); induced drag: lifting line; friction: Hoerner 6-6, Blasius; added mass: Newman 4.3",
        a_per_rad: scaled(slope, flow * share),
        b: scaled(surface.profile_drag(parts.speed_m_s, parts.kinematic_viscosity_m2_s), share),
        c_per_rad2: scaled(surface.induced_drag_per_rad2(), flow * flow * share),
        d_per_rad: scaled(slope, -flow * share * arm),
        // Pitching, each surface meets its own motion: no wing's downwash in it.
        pitch_damping_CMq: scaled(slope, -share * arm * arm),
        m3_kg: Figure { value: added, se: ADDED_MASS_ERROR * added },
        added_pitch_inertia_kg_m2: scaled(Figure { value: added, se: ADDED_MASS_ERROR * added }, aft_m * aft_m),
        ..Term::default()
    }
}

/// Yaw damping `Nr'` of a bare hull that was measured, SUBOFF (Roddy 1990, DTRC/SHD-1298-08, configuration 3): stands in
/// for that of a hull which was never oscillated.
const SUBOFF_NR: f64 = -0.001_597;

/// Its standard error as a stand-in: another tail makes another damping.
const SUBOFF_NR_ERROR: f64 = 0.5 * 0.001_597;

/// Crossflow drag coefficient of a hull times its end effect, as SUBOFF's lift at an angle has it (a fit of Roddy's static
/// sweep, 0.62).
const CROSSFLOW_DRAG: f64 = 0.62;

/// A hull that turns fast: crossflow drag on each slice, `M = -rho/2 Cd d L^4/32 Om |Om|` about the middle.
fn crossflow_term(parts: &Parts<'_>, is_stand_in: bool) -> Term {
    let geometry = &parts.hull.geometry;
    let value = -0.5 * parts.density_kg_m3 * CROSSFLOW_DRAG * geometry.diameter_m * geometry.loa_m.powi(4) / 32.0;
    Term {
        part: "hull, turning",
        source: if is_stand_in {
            "quadratic damping: crossflow; the hull's CMq is SUBOFF's (Roddy 1990), +-50 %: it was not oscillated"
        } else {
            "quadratic damping: crossflow, Cd as SUBOFF's (Roddy 1990)"
        },
        pitch_damping_quadratic: Figure { value, se: (0.3 * value).abs() },
        ..Term::default()
    }
}

/// Relative standard error of the strip theory of added mass: it knows no tips.
const ADDED_MASS_ERROR: f64 = 0.2;

/// Relative standard error of the step from tow speed to glide speed: the hull may be laminar over its nose.
const REYNOLDS_STEP_ERROR: f64 = 0.3;

/// The hull's drag at zero angle taken to another speed in proportion to the friction line (ITTC 1978: form factor).
fn reynolds_term(parts: &Parts<'_>, b: f64, tow_speed_m_s: f64) -> Term {
    let reynolds = |speed: f64| speed * parts.hull.geometry.loa_m / parts.kinematic_viscosity_m2_s;
    let step = b * (ittc_57(reynolds(parts.speed_m_s)) / ittc_57(reynolds(tow_speed_m_s)) - 1.0);
    Term {
        part: "hull, slower",
        source: "ITTC-57 friction line with a form factor",
        b: Figure { value: step, se: (REYNOLDS_STEP_ERROR * step).abs() },
        ..Term::default()
    }
}

impl Pod {
    /// The glider with this sensor on it.
    pub fn carried_by(&self, parameters: &Parameters<f64>) -> Parameters<f64> {
        let sensor = Sensor { drag_area_m2: self.drag_area_m2.value, power_W: self.power_W };
        let p = sensor.carried_by(parameters);
        // The drag acts below the axis and pulls the nose down.
        let moment = self.drag_area_m2.value * self.below_m / (p.frontal_area_m2 * p.length_m);
        Parameters { CM0: p.CM0 - moment, ..p }
    }
}

fn scaled(figure: Figure, factor: f64) -> Figure {
    Figure { value: figure.value * factor, se: figure.se * factor.abs() }
}

fn plus(a: Figure, b: Figure) -> Figure {
    Figure { value: a.value + b.value, se: a.se.hypot(b.se) }
}

#[cfg(test)]
mod tests;
