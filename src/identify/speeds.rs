//! How much of a measured speed there is, and whether it is enough to fit by.
//!
//! A lift slope, and with it every glide angle, rests on the measured speed. A speed on few stretches that are like each
//! other, or in one dive of many, fits any slope: its standard error compares dives, and is no error where few have one.
//! So it takes part where enough independent stretches have it: stretches that scatter together on a leg count once.

use serde::Serialize;

use super::data::Dive;
use super::evaluate::Scatter;

/// Fewest independent stretches with a speed: three for each of the two parameters that it decides, lift slope and drag due
/// to lift, as many residuals left over as there are parameters, twice.
const FEWEST_INDEPENDENT: f64 = 6.0;

/// Fewest dives with a speed, of a log that has more: the standard error of a scatter from two is as large as it is.
const FEWEST_DIVES: usize = 3;

/// What there is of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rows {
    /// Values measured on steady samples.
    pub values: usize,
    /// Stretches of steady glide that have one: rows of the fit.
    pub rows: usize,
    /// Dives that have one.
    pub dives: usize,
    /// How many independent rows those are worth, by how residuals of a leg scatter together.
    pub independent: f64,
}

impl Rows {
    /// The measured speeds of some dives, all rows taken for independent.
    pub(super) fn of_speed(dives: &[Dive]) -> Rows {
        let bins = || dives.iter().flat_map(|dive| &dive.bins).filter(|bin| bin.speeds > 0);
        let rows = bins().count();
        Rows {
            values: bins().map(|bin| bin.speeds).sum(),
            rows,
            dives: dives.iter().filter(|dive| dive.bins.iter().any(|bin| bin.speeds > 0)).count(),
            independent: rows as f64,
        }
    }

    /// The vertical velocities of some dives.
    pub(super) fn of_sink(dives: &[Dive]) -> Rows {
        let rows = dives.iter().map(|dive| dive.bins.len()).sum();
        let values = dives.iter().map(|dive| dive.observations.len()).sum();
        Rows { values, rows, dives: dives.len(), independent: rows as f64 }
    }

    /// The same, worth as many as a fit's residuals say.
    pub(super) fn worth(self, scatter: &Scatter) -> Rows {
        Rows { independent: self.rows as f64 / scatter.correlated_samples(), ..self }
    }

    /// Why this is too little of a speed to fit by; nothing where it is enough.
    pub(super) fn too_few(&self, dives: usize) -> Option<String> {
        let few_rows = self.independent < FEWEST_INDEPENDENT;
        let few_dives = self.dives < FEWEST_DIVES.min(dives);
        (self.rows > 0 && (few_rows || few_dives)).then(|| {
            format!(
                "the measured speed is not used: {} values on {} stretches of {} of {dives} dives, worth {:.1} independent ones; {FEWEST_INDEPENDENT:.0} are needed, on {} dives",
                self.values,
                self.rows,
                self.dives,
                self.independent,
                FEWEST_DIVES.min(dives)
            )
        })
    }
}
