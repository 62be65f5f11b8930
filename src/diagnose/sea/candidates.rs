//! Which mechanisms a log could show.

use std::collections::BTreeMap;

use super::jumps::{self, Jump};
use super::salinity::{self, Shown};
use super::time_constants;
use crate::diagnose::evidence::{Candidate, Version};
use crate::dynamics::buoyancy::WATER_COMPRESSIBILITY_PER_PA;
use crate::dynamics::{PARAMETERS, Parameters};
use crate::identify::{Bin, median_step_s};
use crate::log::{DBAR_PA, Observation};
use crate::mechanisms::{AT_SEA, Enters};

/// Range of temperature over the log below which nothing that goes by its changes can show \[K\]: ten times the noise of a
/// thermistor's bin.
const LEAST_RANGE_K: f64 = 0.1;

/// The same of the density of the water brought to p = 0 \[kg/m3\]: some grams in the largest flooded spaces.
const LEAST_RANGE_KG_M3: f64 = 0.1;

/// Error of the density that a fouled conductivity cell makes of the salinity, one standard deviation \[kg/m3\]: 0.2 to 0.3 in
/// practical salinity, as biofouled cells are found to be off before they are cleaned. Judgement.
const FOULED_CELL_KG_M3: f64 = 0.2;

/// What the log shows beside its bins.
#[derive(Debug, Clone, Default)]
pub struct Channels {
    /// What other channels show of sizes, by the name of the mechanism.
    shown: Vec<(&'static str, Shown)>,
    /// Median time from one sample to the next \[s\].
    step_s: f64,
}

impl Channels {
    /// From the samples of a log.
    pub fn new(samples: &[Observation]) -> Channels {
        let of = |mechanism: &crate::mechanisms::Mechanism| {
            Some((mechanism.name, salinity::shown(mechanism.name, samples)?))
        };
        Channels { shown: AT_SEA.iter().filter_map(of).collect(), step_s: median_step_s(samples.iter()) }
    }

    fn shown(&self, mechanism: &str) -> Option<Shown> {
        self.shown.iter().find(|(name, _)| *name == mechanism).map(|(_, shown)| *shown)
    }
}

/// Mechanisms that go with temperature or pressure: what of them does not vary over the log is an offset of the ballast.
pub const WITH_A_LEVEL: [&str; 4] = ["hull_compressibility", "thermal_expansion", "trapped_air", "hull_creep"];

/// Mechanisms that depend on a channel on which no other mechanism depends.
pub const WITH_OWN_CHANNEL: [&str; 2] = ["roll_drag", "rudder_drag"];

/// Mechanisms that are a constant added to a reading or a weight.
pub const LEVELS: [&str; 4] = ["ballast_offset", "pitch_offset", "density_bias", "vertical_current"];

/// The versions of mechanisms that are tried.
#[derive(Debug, Clone, Default)]
pub struct Tried {
    /// Times at which something may have been lost or caught.
    pub jumps: Vec<Jump>,
    /// Mechanisms whose time constant is looked for closely.
    pub closer: BTreeMap<&'static str, time_constants::Closer>,
}

/// The mechanisms that these data could show, with the row of their parameter.
pub fn list(bins: &[Bin], channels: &Channels, tried: &Tried, parameters: &Parameters<f64>) -> Vec<(Candidate, usize)> {
    let varies = |value: fn(&Bin) -> f64| bins.iter().any(|bin| value(bin).is_finite() && value(bin).abs() > 1e-4);
    let has_salinity = bins.iter().any(|bin| bin.mean.teos10_density_kg_m3.is_finite());
    let mut found = Vec::new();
    for mechanism in AT_SEA {
        let Some(index) = crate::mechanisms::size_parameter(mechanism) else {
            continue;
        };
        let missing = match mechanism.name {
            "roll_drag" => !varies(|bin| bin.mean.roll_rad),
            "rudder_drag" => !varies(|bin| bin.mean.rudder_rad),
            "thermal_expansion" => !varies(|bin| bin.mean.temperature_C),
            // A temperature that is the same everywhere tells nothing of a lag.
            // A part of the expansion that the vehicle states: without one there is nothing to be late.
            "late_expansion" if parameters.hull_thermal_expansion_per_K <= 0.0 => true,
            "thermal_lag" | "late_expansion" => range(bins, |bin| bin.mean.temperature_C) < LEAST_RANGE_K,
            "carried_water" => range(bins, surface_density_kg_m3) < LEAST_RANGE_KG_M3,
            // Between two samples the pitch is not known: an offset of less than their step cannot be distinguished from its motion.
            "clock_offset" => channels.step_s > mechanism.size.prior_sd,
            // A density that the user stated has no cell that could drift.
            "conductivity_drift" => !has_salinity,
            _ => mechanism.enters == Enters::Consistency,
        };
        if missing {
            continue;
        }
        let row = &PARAMETERS[index];
        let version = |jump: &Jump| {
            let (value, between) = (jump.time_s, jump.between_s);
            mechanism.parameters.get(1).map(|name| Version { name, value, is_onset: true, between, unit: "s" })
        };
        let versions: Vec<Option<Version>> = match mechanism.name {
            name if jumps::MECHANISMS.contains(&name) => tried.jumps.iter().map(version).collect(),
            name => time_constants::versions(name, tried.closer.get(name).copied()),
        };
        // Where the density follows from temperature and salinity, a bias of it is one of the salinity.
        let prior_sd = match mechanism.name {
            "density_bias" if has_salinity => FOULED_CELL_KG_M3,
            _ => mechanism.size.prior_sd,
        };
        // A channel that shows less than is believed anyhow says nothing.
        let shown = channels.shown(mechanism.name).filter(|shown| shown.se < prior_sd);
        let neutral = *parameters.clone().at(index);
        let furthest = mechanism.size.furthest;
        let least = mechanism.size.least.max(neutral - furthest);
        let (usual_sds, [least, most]) = if mechanism.size.is_open_ended {
            (super::MOST_USUAL, [least, neutral + furthest])
        } else {
            let most = super::MOST_USUAL * prior_sd;
            let lowest = if mechanism.size.is_ratio { neutral / (1.0 + most) } else { neutral - most };
            (f64::INFINITY, [least.max(lowest), neutral + most.min(furthest)])
        };
        let possible = match mechanism.name {
            // No more comes late than expands at all.
            "late_expansion" => [least, most.min(parameters.hull_thermal_expansion_per_K)],
            // Without salinity the density may be that at p = 0, which looks like a hull that is stiffer by as much.
            "hull_compressibility" if !has_salinity => [least - WATER_COMPRESSIBILITY_PER_PA, most],
            _ => [least, most],
        };
        for version in versions {
            let candidate = Candidate {
                name: mechanism.name,
                parameters: vec![(row.name, row.unit)],
                neutral: vec![neutral],
                prior_sd: vec![shown.map_or(prior_sd, |shown| shown.se)],
                usual_sds,
                bounds: vec![(row.min, row.max)],
                possible,
                shown: shown.map(|shown| shown.value),
                version,
            };
            found.push((candidate, index));
        }
    }
    found
}

/// Density of the water brought to p = 0, by the compressibility of sea water \[kg/m3\].
fn surface_density_kg_m3(bin: &Bin) -> f64 {
    bin.mean.density_kg_m3 / (1.0 + WATER_COMPRESSIBILITY_PER_PA * DBAR_PA * bin.mean.pressure_dbar)
}

/// Largest less smallest value; none where it was not measured.
fn range(bins: &[Bin], value: impl Fn(&Bin) -> f64) -> f64 {
    let (least, most) = bins
        .iter()
        .map(value)
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
    (most - least).max(0.0)
}
