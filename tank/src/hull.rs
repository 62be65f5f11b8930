//! A hull as a manifest describes it: sizes, reference points, and the mass below the balance.
//!
//! ```toml
//! [[hull]]                    # in hull.toml: [hull], one only
//! id = "LDR8.5"
//! ldr = 8.5                   # length to diameter ratio by which the hull is named
//! diameter_m = 0.203          # largest diameter; the frontal area follows
//! loa_m = 1.724               # overall length
//! mc_m = 0.736                # moment centre of the balance, aft of the nose
//! cb_m = 0.815                # centre of buoyancy, aft of the nose
//! mc_uncertainty_m = 0.0005   # optional: standard uncertainties of both
//! cb_uncertainty_m = 0.001
//! live_mass_kg = 55.0         # everything below the balance, entrained water included; for oscillations and turns
//! xg_m = 0.82                 # its centre aft of the nose
//! izz_kg_m2 = 11.0            # its moment of inertia about the moment centre
//! volume_m3 = 0.0446          # optional: displaced volume, for the theory
//! wetted_area_m2 = 0.93       # optional: wetted surface, for the theory
//! base_area_m2 = 0.0          # optional: area where the flow leaves a blunt or separated tail, for the theory
//! ```

use glidepolar_hull::hull_tests::HullGeometry;
use glidepolar_input::InputError;
use serde::Deserialize;
use toml::Spanned;

use crate::toml_file::Source;

/// No model in a towing tank is longer \[m\].
const LONGEST_MODEL_M: f64 = 50.0;

/// A hull.
#[derive(Debug, Clone, PartialEq)]
pub struct Hull {
    /// Its name.
    pub id: String,
    /// Length to diameter ratio by which it is named.
    pub ldr: f64,
    /// Sizes.
    pub geometry: HullGeometry,
    /// Moment centre of the balance aft of the nose \[m\].
    pub mc_m: f64,
    /// Standard uncertainties of moment centre and centre of buoyancy; zero where none is stated \[m\].
    pub centre_uncertainties_m: [f64; 2],
    /// Mass below the balance, where stated.
    pub live: Option<LiveMass>,
    /// Wetted surface, where stated \[m2\].
    pub wetted_area_m2: Option<f64>,
    /// Area of a base where the flow leaves the hull \[m2\].
    pub base_area_m2: f64,
}

/// Everything below the balance that moves with the model, entrained water included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiveMass {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Its centre aft of the nose \[m\].
    pub xg_m: f64,
    /// Its moment of inertia about the moment centre \[kg m2\].
    pub izz_kg_m2: f64,
}

impl Hull {
    /// Frontal area \[m2\].
    pub fn frontal_area_m2(&self) -> f64 {
        self.geometry.frontal_area_m2()
    }

    /// How far the centre of buoyancy lies aft of the moment centre \[m\].
    pub fn cb_aft_of_mc_m(&self) -> f64 {
        self.geometry.cb_m - self.mc_m
    }
}

/// The keys of a hull in a manifest.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HullKeys {
    id: Spanned<String>,
    ldr: Spanned<f64>,
    diameter_m: Spanned<f64>,
    loa_m: Spanned<f64>,
    mc_m: Spanned<f64>,
    cb_m: Spanned<f64>,
    mc_uncertainty_m: Option<Spanned<f64>>,
    cb_uncertainty_m: Option<Spanned<f64>>,
    live_mass_kg: Option<Spanned<f64>>,
    xg_m: Option<Spanned<f64>>,
    izz_kg_m2: Option<Spanned<f64>>,
    volume_m3: Option<Spanned<f64>>,
    wetted_area_m2: Option<Spanned<f64>>,
    base_area_m2: Option<Spanned<f64>>,
}

impl HullKeys {
    /// The name and its place.
    pub(crate) fn id(&self) -> &Spanned<String> {
        &self.id
    }

    /// The hull, once its figures make sense.
    pub(crate) fn hull(&self, source: &Source) -> Result<Hull, InputError> {
        let id = self.id.get_ref().clone();
        if id.trim().is_empty() || id.chars().any(char::is_control) {
            return Err(InputError::new(source.place(&self.id), "id is no name, expected letters and digits"));
        }
        let diameter_m = source.positive("diameter_m", &self.diameter_m)?;
        let loa_m = source.positive("loa_m", &self.loa_m)?;
        if diameter_m > LONGEST_MODEL_M {
            let problem = format!("diameter_m is {diameter_m}, expected far less than {LONGEST_MODEL_M} m");
            let error = InputError::new(source.place(&self.diameter_m), problem);
            return Err(error.help("in millimetres? all sizes are in m"));
        }
        if loa_m > LONGEST_MODEL_M {
            let problem = format!("loa_m is {loa_m}, expected at most {LONGEST_MODEL_M} m");
            return Err(InputError::new(source.place(&self.loa_m), problem).help("in millimetres? all sizes are in m"));
        }
        if loa_m <= diameter_m {
            let problem = format!("loa_m is {loa_m}, expected more than the diameter of {diameter_m} m");
            return Err(InputError::new(source.place(&self.loa_m), problem));
        }
        let ldr = source.positive("ldr", &self.ldr)?;
        if (loa_m / diameter_m / ldr - 1.0).abs() > 0.1 {
            let problem = format!("ldr is {ldr}, but loa_m / diameter_m is {:.3}", loa_m / diameter_m);
            return Err(InputError::new(source.place(&self.ldr), problem).help("one of the three is wrong"));
        }
        let aft = format!("a distance aft of the nose, 0 to {loa_m} m");
        let mc_m = source.within("mc_m", &self.mc_m, 0.0, loa_m, &aft)?;
        let cb_m = source.within("cb_m", &self.cb_m, 0.0, loa_m, &aft)?;
        let uncertainty = |name: &str, value: &Option<Spanned<f64>>| match value {
            Some(value) => source.within(name, value, 0.0, loa_m, "a standard uncertainty in m, zero or more"),
            None => Ok(0.0),
        };
        let centre_uncertainties_m = [
            uncertainty("mc_uncertainty_m", &self.mc_uncertainty_m)?,
            uncertainty("cb_uncertainty_m", &self.cb_uncertainty_m)?,
        ];
        let optional = |name: &str, value: &Option<Spanned<f64>>| {
            value.as_ref().map(|value| source.positive(name, value)).transpose()
        };
        let volume_m3 = optional("volume_m3", &self.volume_m3)?;
        let geometry = HullGeometry { diameter_m, loa_m, cb_m, volume_m3 };
        if let (Some(volume), Some(key)) = (volume_m3, &self.volume_m3) {
            let cylinder = geometry.frontal_area_m2() * loa_m;
            if volume > cylinder {
                let problem =
                    format!("volume_m3 is {volume}, more than the {cylinder:.4} m3 of the cylinder around it");
                return Err(InputError::new(source.place(key), problem));
            }
        }
        let base_area_m2 = match &self.base_area_m2 {
            Some(value) => {
                let area = geometry.frontal_area_m2();
                source.within("base_area_m2", value, 0.0, area, "an area up to the frontal area")?
            }
            None => 0.0,
        };
        Ok(Hull {
            id,
            ldr,
            geometry,
            mc_m,
            centre_uncertainties_m,
            live: self.live(source, &aft, loa_m)?,
            wetted_area_m2: optional("wetted_area_m2", &self.wetted_area_m2)?,
            base_area_m2,
        })
    }

    fn live(&self, source: &Source, aft: &str, loa_m: f64) -> Result<Option<LiveMass>, InputError> {
        match (&self.live_mass_kg, &self.xg_m, &self.izz_kg_m2) {
            (None, None, None) => Ok(None),
            (Some(mass), Some(xg), Some(izz)) => Ok(Some(LiveMass {
                mass_kg: source.positive("live_mass_kg", mass)?,
                xg_m: source.within("xg_m", xg, 0.0, loa_m, aft)?,
                izz_kg_m2: source.positive("izz_kg_m2", izz)?,
            })),
            _ => Err(InputError::new(
                source.place(&self.id),
                "of live_mass_kg, xg_m and izz_kg_m2 one is missing, expected all three or none",
            )
            .help("they take inertia out of oscillations and turns")),
        }
    }
}
