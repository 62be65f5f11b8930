//! Where real logs lie, and their samples ready for a fit.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use glidepolar::dynamics::Parameters;
use glidepolar::identify::Trim;
use glidepolar::log::{Channel, Columns, Observation};
use glidepolar::reading;
use glidepolar::vehicle::Vehicle;

/// A log, and the vehicle that it is read against.
#[derive(Debug, Clone, Copy)]
pub struct Log {
    pub name: &'static str,
    file: &'static str,
    vehicle: &'static str,
    speed: Option<&'static str>,
    pitch: Option<&'static str>,
}

/// Slocum "comet": 36 legs to 42 m, 13,140 samples, with the speed through the water from a Doppler log.
pub const COMET: Log = Log {
    name: "comet",
    file: "comet_2016_baltic_1hz.csv",
    vehicle: "slocum-graver",
    speed: Some("U_dvl_m_s"),
    pitch: Some("pitch_rad=pitch_corr_rad"),
};

/// Seaglider SG542: 14 dives to 1000 m, vertical velocity alone.
pub const SG542: Log = Log { name: "sg542", file: "sg542_samples.csv", vehicle: "seaglider", speed: None, pitch: None };

impl Log {
    /// The file: where `GLIDEPOLAR_DATA` says, in `shared/data` beside the checkout, or in `data`.
    pub fn path(&self, root: &Path) -> Result<PathBuf> {
        let named = std::env::var_os("GLIDEPOLAR_DATA").map(PathBuf::from);
        let folders = named.into_iter().chain([root.join("../shared/data"), root.join("data")]);
        let found = folders.map(|folder| folder.join(self.file)).find(|file| file.is_file());
        found.with_context(|| format!("{} is not there; GLIDEPOLAR_DATA names its folder", self.file))
    }

    pub fn vehicle(&self) -> Result<Vehicle> {
        Ok(Vehicle::load(self.vehicle)?)
    }

    /// Options that name vehicle and columns.
    pub fn words(&self) -> Vec<&'static str> {
        let mut words = vec!["--vehicle", self.vehicle];
        words.extend(self.speed.iter().flat_map(|name| ["--speed-column", name]));
        words.extend(self.pitch.iter().flat_map(|choice| ["--column", choice]));
        words
    }

    /// The whole log as the command reads it.
    pub fn read(&self, root: &Path) -> Result<Vec<Observation>> {
        let mut columns = Columns::default();
        if let Some(choice) = self.pitch {
            columns.choose_text(choice).map_err(anyhow::Error::msg)?;
        }
        if let Some(name) = self.speed {
            columns.choose(Channel::Speed, name);
        }
        let request = reading::Request { columns, ..reading::Request::default() };
        Ok(reading::read(&[self.path(root)?], &self.vehicle()?, &request)?.observations)
    }

    /// What the fit begins with: neutral at ballast zero, since the vehicle is no description of this very glider.
    pub fn baseline(&self, observations: &[Observation]) -> Result<Parameters<f64>> {
        Ok(Trim::Neutral.baseline(&self.vehicle()?.glide_parameters(), observations))
    }

    /// The parameters that the data tell.
    pub fn free(&self) -> &'static [&'static str] {
        match self.speed {
            // comet does not identify c: the command fixes it, too.
            Some(_) => &["a_per_rad", "b", "ballast_offset_kg"],
            None => &["b", "c_per_rad2", "ballast_offset_kg"],
        }
    }
}

/// The steady samples of the same dives again and again, until there are `n`, as a log of as many dives.
pub fn repeated(observations: &[Observation], n: usize) -> Vec<Observation> {
    let dives = observations.iter().map(|observation| observation.dive + 1).max().unwrap_or(1);
    let steady = observations.iter().filter(|observation| observation.steady);
    let copies = (0..).flat_map(|copy| steady.clone().map(move |o| Observation { dive: o.dive + copy * dives, ..*o }));
    copies.take(n).collect()
}
