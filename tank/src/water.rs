//! The water of the tank as a manifest states it, and at the temperature of a run.

use glidepolar_environment::TankWater;
use glidepolar_input::InputError;
use serde::Deserialize;
use toml::Spanned;

use crate::toml_file::Source;

/// Temperatures at which a towing tank can be \[degC\].
const TEMPERATURES_C: std::ops::RangeInclusive<f64> = 0.0..=40.0;

/// Water of a tank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Water {
    /// Fresh or sea.
    pub kind: TankWater,
    /// Temperature \[degC\].
    pub temperature_C: f64,
    /// Density \[kg/m3\].
    pub density_kg_m3: f64,
    /// Kinematic viscosity \[m2/s\].
    pub kinematic_viscosity_m2_s: f64,
    fixed_density_kg_m3: Option<f64>,
    fixed_viscosity_m2_s: Option<f64>,
}

impl Water {
    /// The same water at another temperature; figures that the manifest fixes stay.
    pub fn at(self, temperature_C: f64) -> Self {
        Water {
            temperature_C,
            density_kg_m3: self.fixed_density_kg_m3.unwrap_or_else(|| self.kind.density_kg_m3(temperature_C)),
            kinematic_viscosity_m2_s: self
                .fixed_viscosity_m2_s
                .unwrap_or_else(|| self.kind.kinematic_viscosity_m2_s(temperature_C)),
            ..self
        }
    }

    /// Whether a temperature can be that of a tank.
    pub fn is_plausible(temperature_C: f64) -> bool {
        TEMPERATURES_C.contains(&temperature_C)
    }
}

/// Section `[water]` of a manifest.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WaterKeys {
    kind: Kind,
    temperature_c: Spanned<f64>,
    density_kg_m3: Option<Spanned<f64>>,
    kinematic_viscosity_m2_s: Option<Spanned<f64>>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Fresh,
    Sea,
}

impl WaterKeys {
    pub(crate) fn water(&self, source: &Source) -> Result<Water, InputError> {
        let (low, high) = (*TEMPERATURES_C.start(), *TEMPERATURES_C.end());
        let temperature_C =
            source.within("temperature_c", &self.temperature_c, low, high, "a water temperature of 0 to 40 degC")?;
        let density = self.density_kg_m3.as_ref();
        let viscosity = self.kinematic_viscosity_m2_s.as_ref();
        let water = Water {
            kind: match self.kind {
                Kind::Fresh => TankWater::Fresh,
                Kind::Sea => TankWater::Sea,
            },
            temperature_C,
            density_kg_m3: f64::NAN,
            kinematic_viscosity_m2_s: f64::NAN,
            fixed_density_kg_m3: density
                .map(|value| source.within("density_kg_m3", value, 900.0, 1300.0, "900 to 1300 kg/m3"))
                .transpose()?,
            fixed_viscosity_m2_s: viscosity
                .map(|value| {
                    source.within("kinematic_viscosity_m2_s", value, 1e-7, 1e-5, "about 1e-6 m2/s (1e-7 to 1e-5)")
                })
                .transpose()?,
        };
        Ok(water.at(temperature_C))
    }
}
