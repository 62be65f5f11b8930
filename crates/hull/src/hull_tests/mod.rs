//! What a hull test hands on: the reduced coefficients and derivatives of a hull, each with its interval, as `fits.json`
//! holds them, and what a vehicle makes of them.
//!
//! Signs and reference values: lift, drag and moment on the frontal area (moment also on the overall length) about the
//! centre of buoyancy; derivatives in SNAME primes on the overall length about the centre of buoyancy. Knows no balance,
//! no tank and no run.

mod added_mass;
mod spheroid;

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::coefficients::frontal_area_m2;
use glidepolar_input::{InputError, Place, printable};

pub use added_mass::{AddedMass, Source};
pub use glidepolar_inference::estimate::Estimate;
pub use spheroid::LambFactors;

/// Name and version of the form of `fits.json`.
pub const SCHEMA: &str = "tank-reduce/1";

/// Everything that one reduction found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reduction {
    /// [`SCHEMA`].
    pub schema: String,
    /// Hull by hull, in the order of the manifest.
    pub hulls: Vec<ReducedHull>,
    /// Change with length to diameter ratio, where the hulls are many enough.
    pub trend: Option<Trend>,
    /// What the campaign as a whole departs from, where that was asked for.
    pub campaign_diagnosis: Option<serde_json::Value>,
    /// What the reader of the figures has to know.
    pub warnings: Vec<String>,
}

/// One hull.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReducedHull {
    /// Its name.
    pub id: String,
    /// Length to diameter ratio.
    pub ldr: f64,
    /// Runs (or points) that were reduced.
    pub n_runs: usize,
    /// Sizes to which the figures refer.
    pub geometry: HullGeometry,
    /// Steady drift; none where too few runs were made.
    pub fit: Option<HullFit>,
    /// Derivatives from oscillations and turns; none where no such runs were made.
    pub dynamic: Option<DynamicDerivatives>,
    /// What the hull's readings depart from, where that was asked for.
    pub diagnosis: Option<serde_json::Value>,
    /// The fit with the hull's own mechanisms in it, where a diagnosis named any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extended: Option<ExtendedFit>,
}

/// Sizes of a hull, distances aft of the nose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HullGeometry {
    /// Largest diameter \[m\].
    pub diameter_m: f64,
    /// Overall length \[m\].
    pub loa_m: f64,
    /// Centre of buoyancy \[m\].
    pub cb_m: f64,
    /// Displaced volume, where it is known \[m3\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume_m3: Option<f64>,
}

/// `CL = a alpha`, `CD = b + c alpha^2`, `CM = d alpha`, alpha in radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HullFit {
    /// Angles up to this magnitude entered \[deg\].
    pub range_deg: f64,
    /// Lift slope \[1/rad\].
    pub a: Estimate,
    /// Drag at zero angle \[1\].
    pub b: Estimate,
    /// Growth of drag with angle \[1/rad2\].
    pub c: Estimate,
    /// Moment slope \[1/rad\].
    pub d: Estimate,
}

/// `CL = a alpha + K alpha|alpha|` and so on: the coefficients beside the mechanisms that a diagnosis named.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExtendedFit {
    /// a, b, c, d beside them; the range is that of all angles.
    #[serde(flatten)]
    pub fit: HullFit,
    /// Crossflow: CL grows by this times alpha |alpha|, CD by it times |alpha|^3 \[1/rad2\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nonlinear_lift_per_rad2: Option<Estimate>,
    /// Crossflow: CM grows by this times alpha |alpha| \[1/rad2\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nonlinear_moment_per_rad2: Option<Estimate>,
    /// b goes with this power of the dynamic pressure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drag_exponent: Option<Estimate>,
}

/// SNAME primes on the overall length about the centre of buoyancy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the symbols of the field")]
pub struct DynamicDerivatives {
    #[serde(rename = "Yv")]
    pub yv: Estimate,
    #[serde(rename = "Nv")]
    pub nv: Estimate,
    #[serde(rename = "Yr")]
    pub yr: Option<Estimate>,
    #[serde(rename = "Nr")]
    pub nr: Option<Estimate>,
    #[serde(rename = "Yvdot")]
    pub yvdot: Option<Estimate>,
    #[serde(rename = "Nvdot")]
    pub nvdot: Option<Estimate>,
    #[serde(rename = "Yrdot")]
    pub yrdot: Option<Estimate>,
    #[serde(rename = "Nrdot")]
    pub nrdot: Option<Estimate>,
}

/// Change of the coefficients per unit of length to diameter ratio.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "named after the coefficient")]
pub struct Trend {
    pub a: Slope,
    pub b: Slope,
    pub c: Slope,
    pub d: Slope,
}

/// One slope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// Change per unit of length to diameter ratio.
    pub slope_per_ldr: Estimate,
}

impl HullGeometry {
    /// Frontal area \[m2\].
    pub fn frontal_area_m2(&self) -> f64 {
        frontal_area_m2(self.diameter_m)
    }

    /// Length to diameter ratio of the overall length.
    pub fn slenderness(&self) -> f64 {
        self.loa_m / self.diameter_m
    }
}

impl Reduction {
    /// Reads a `fits.json`.
    ///
    /// # Errors
    /// Where the file cannot be read or is not of this form; with file, line and column.
    pub fn load(file: &Path) -> Result<Self, InputError> {
        let text = std::fs::read_to_string(file).map_err(|error| InputError::io(file, &error))?;
        let reduction: Reduction = serde_json::from_str(&text).map_err(|error| {
            let place = Place::line(file, error.line()).column(error.column());
            InputError::new(place, format!("not a reduction: {}", printable(&error.to_string())))
                .help("name a fits.json that tank-reduce wrote")
        })?;
        if reduction.schema != SCHEMA {
            let problem = format!("schema is {}, expected {SCHEMA}", printable(&reduction.schema));
            return Err(InputError::new(Place::file(file), problem).help("reduce the campaign anew with this version"));
        }
        Ok(reduction)
    }

    /// The hull of this name.
    pub fn hull(&self, id: &str) -> Option<&ReducedHull> {
        self.hulls.iter().find(|hull| hull.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_kind_is_refused_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("fits.json");
        std::fs::write(&file, "{\n  \"schema\": 3\n}").unwrap();
        let error = Reduction::load(&file).unwrap_err().to_string();
        assert!(error.contains("fits.json:2"), "{error}");
        std::fs::write(
            &file,
            r#"{"schema":"tank-reduce/9","hulls":[],"trend":null,"campaign_diagnosis":null,"warnings":[]}"#,
        )
        .unwrap();
        let error = Reduction::load(&file).unwrap_err().to_string();
        assert!(error.contains("tank-reduce/9") && error.contains("tank-reduce/1"), "{error}");
    }
}
