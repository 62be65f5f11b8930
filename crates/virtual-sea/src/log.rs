//! The log as columns, and the folder of files that a diagnosis is given.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A flight log: one value per row in every column, NaN where a value is missing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Log {
    /// Time since the first row, s.
    pub time_s: Vec<f64>,
    /// Gauge pressure, dbar.
    pub pressure_dbar: Vec<f64>,
    /// Pitch, rad, nose up positive.
    pub pitch_rad: Vec<f64>,
    /// Roll, rad.
    pub roll_rad: Vec<f64>,
    /// Heading, rad.
    pub heading_rad: Vec<f64>,
    /// Rudder, rad.
    pub fin_rad: Vec<f64>,
    /// Angle of the roll mass, rad, where the glider has one.
    pub roll_mass_rad: Option<Vec<f64>>,
    /// Ballast volume, cc, + = more buoyant.
    pub vbd_cc: Vec<f64>,
    /// Moving mass forward of the centre of buoyancy, m.
    pub battpos_m: Vec<f64>,
    /// Temperature, degrees Celsius.
    pub temperature_c: Vec<f64>,
    /// Practical salinity.
    pub salinity_psu: Vec<f64>,
    /// In-situ density, kg/m3.
    pub density_kg_m3: Vec<f64>,
    /// Speed through the water, m/s, where it was measured.
    pub speed_through_water_m_s: Option<Vec<f64>>,
    /// Number of the dive, from 1.
    pub dive: Vec<u32>,
}

impl Log {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// The log as CSV; units stand in the header, an empty cell is a missing value.
    pub fn to_csv(&self) -> String {
        let mut columns: Vec<(&str, &[f64], usize)> = vec![
            ("time_s", &self.time_s, 2),
            ("pressure_dbar", &self.pressure_dbar, 3),
            ("pitch_rad", &self.pitch_rad, 5),
            ("roll_rad", &self.roll_rad, 5),
            ("heading_rad", &self.heading_rad, 4),
            ("fin_rad", &self.fin_rad, 4),
            ("vbd_cc", &self.vbd_cc, 2),
            ("battpos_m", &self.battpos_m, 6),
            ("temperature_C", &self.temperature_c, 4),
            ("salinity_psu", &self.salinity_psu, 4),
            ("density_kg_m3", &self.density_kg_m3, 4),
        ];
        if let Some(roll_mass) = &self.roll_mass_rad {
            columns.push(("roll_mass_rad", roll_mass, 4));
        }
        if let Some(speed) = &self.speed_through_water_m_s {
            columns.push(("speed_through_water_m_s", speed, 4));
        }
        let mut out = String::with_capacity(self.len() * 110 + 200);
        for (name, ..) in &columns {
            out.push_str(name);
            out.push(',');
        }
        out.push_str("dive\n");
        for (row, dive) in self.dive.iter().enumerate() {
            for (_, values, decimals) in &columns {
                if values[row].is_finite() {
                    let _ = write!(out, "{:.*}", *decimals, values[row]);
                }
                out.push(',');
            }
            let _ = writeln!(out, "{dive}");
        }
        out
    }
}

/// A folder that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", .path.display())]
pub struct WriteError {
    /// Which file.
    pub path: PathBuf,
    /// Why.
    pub cause: std::io::Error,
}

/// Writes `log.csv`, `vehicle.toml` and, apart from what the analyst is given, `truth.json`; each whole or not at all.
///
/// # Errors
/// Where the folder cannot be made or a file cannot be written.
pub fn write(log: &Log, vehicle_toml: &str, truth: &serde_json::Value, folder: &Path) -> Result<(), WriteError> {
    std::fs::create_dir_all(folder).map_err(|cause| WriteError { path: folder.to_owned(), cause })?;
    let truth = format!("{truth:#}\n");
    for (name, text) in [("log.csv", log.to_csv()), ("vehicle.toml", vehicle_toml.to_owned()), ("truth.json", truth)] {
        let path = folder.join(name);
        write_whole(&path, folder, &text).map_err(|cause| WriteError { path, cause })?;
    }
    Ok(())
}

fn write_whole(path: &Path, folder: &Path, text: &str) -> std::io::Result<()> {
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.persist(path)?;
    Ok(())
}
