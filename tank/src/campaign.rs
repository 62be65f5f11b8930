//! A campaign's folder: `campaign.toml` (facility, water, balance, hulls) and `runs.csv` (one row per run).
//!
//! What concerns the campaign as a whole must be right. A row of `runs.csv` that is not is left out and reported; it
//! never loses the rest.

use std::collections::{HashMap, HashSet};
use std::path::{Component, Path, PathBuf};

use glidepolar_input::{InputError, Place, nearest, printable};
use nalgebra::Matrix3;
use serde::Deserialize;
use toml::Spanned;

use crate::hull::{Hull, HullKeys};
use crate::table::{Cells, Table};
use crate::toml_file::Source;
use crate::water::{Water, WaterKeys};

/// A campaign before any reading is looked at.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// Its folder.
    pub folder: PathBuf,
    /// Its name.
    pub name: String,
    /// The facility.
    pub facility: String,
    /// The water.
    pub water: Water,
    /// Width and depth of the tank, where stated \[m\].
    pub cross_section_m: Option<(f64, f64)>,
    /// The balance.
    pub balance: Balance,
    /// The hulls.
    pub hulls: Vec<Hull>,
    /// The runs, in the order in which they were made.
    pub runs: Vec<Run>,
    /// Rows that could not be used, with the reason.
    pub rejected: Vec<Rejected>,
    /// What was ignored or assumed.
    pub notices: Vec<String>,
}

/// A run that was left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Rejected {
    /// Its name.
    pub run_id: String,
    /// Why.
    pub error: InputError,
}

/// The balance as the manifest states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    /// `force = interaction * (reading - zero)`, AF, SF, YM.
    pub interaction: Matrix3<f64>,
    /// Standard uncertainties of the elements of `interaction`, shared by all runs.
    pub interaction_uncertainty: Option<Matrix3<f64>>,
    /// Standard uncertainty of AF, SF \[N\] and YM \[N m\] from the calibration, shared by all runs.
    pub uncertainty: Option<[f64; 3]>,
}

/// What a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Model at rest.
    Zero,
    /// Strut alone under way.
    Tare,
    /// Fixed yaw angle.
    Static,
    /// Pure sway.
    Sway,
    /// Pure yaw.
    Yaw,
    /// Constant-radius turn.
    Arc,
}

/// A row of `runs.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Place in the order in which the runs were made.
    pub order: usize,
    /// Its name.
    pub id: String,
    /// Index of its hull; none for the strut alone.
    pub hull: Option<usize>,
    /// What it is.
    pub kind: Kind,
    /// Commanded speed \[m/s\].
    pub speed_m_s: f64,
    /// Commanded yaw angle \[deg\].
    pub yaw_deg: f64,
    /// Commanded frequency; zero where the run does not oscillate \[Hz\].
    pub frequency_hz: f64,
    /// Commanded sway amplitude, where stated \[m\].
    pub sway_amplitude_m: Option<f64>,
    /// Commanded yaw amplitude, where stated \[deg\].
    pub yaw_amplitude_deg: Option<f64>,
    /// Radius of the turn, positive to starboard \[m\].
    pub radius_m: Option<f64>,
    /// The water at the run's temperature.
    pub water: Water,
    /// Its time history.
    pub file: PathBuf,
    /// What the crew noted.
    pub note: String,
    /// Begin of the run, where stated \[s\].
    pub start_time_s: Option<f64>,
}

const KINDS: [(&str, Kind); 6] = [
    ("zero", Kind::Zero),
    ("tare", Kind::Tare),
    ("static", Kind::Static),
    ("sway", Kind::Sway),
    ("yaw", Kind::Yaw),
    ("arc", Kind::Arc),
];

const REQUIRED: [&str; 4] = ["run_id", "hull", "kind", "speed_m_s"];
/// Columns that some kinds of run need.
const NEEDED_BY: [(&str, &[&str]); 3] =
    [("yaw_deg", &["static", "tare"]), ("frequency_hz", &["sway", "yaw"]), ("radius_m", &["arc"])];
const COLUMNS: [&str; 13] = [
    "run_id",
    "hull",
    "kind",
    "speed_m_s",
    "yaw_deg",
    "sway_amplitude_m",
    "yaw_amplitude_deg",
    "frequency_hz",
    "radius_m",
    "water_temperature_c",
    "file",
    "note",
    "start_time_s",
];

impl Kind {
    /// As `runs.csv` has it.
    pub fn name(self) -> &'static str {
        KINDS.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }
}

impl Campaign {
    /// Reads `campaign.toml` and `runs.csv` of a folder.
    ///
    /// # Errors
    /// Where either file cannot be used as a whole, with file, line and column.
    pub fn read(folder: &Path) -> Result<Campaign, InputError> {
        let help =
            "a campaign's folder has campaign.toml, runs.csv and data/; `tank-reduce demo pmm_runs` writes one to copy";
        std::fs::metadata(folder).map_err(|error| {
            let error = InputError::io(folder, &error);
            if error.help.is_some() { error } else { error.help(help) }
        })?;
        let manifest_file = folder.join("campaign.toml");
        if !manifest_file.exists() {
            let error = InputError::new(Place::file(folder), "is no campaign's folder: it has no campaign.toml");
            return Err(error.help(help));
        }
        let table_file = folder.join("runs.csv");
        if !table_file.exists() {
            let problem = "is missing: the table of the campaign's runs, one row per run";
            return Err(InputError::new(Place::file(table_file), problem).help(help));
        }
        let source = Source::read(&manifest_file)?;
        let manifest: Manifest = source.parse()?;
        let hulls = hulls(&manifest, &source)?;
        let mut campaign = Campaign {
            folder: folder.to_owned(),
            name: manifest.campaign.name,
            facility: manifest.campaign.facility,
            water: manifest.water.water(&source)?,
            cross_section_m: manifest.tank.map(|tank| tank.cross_section(&source)).transpose()?.flatten(),
            balance: manifest.balance.map(|b| b.balance(&source)).transpose()?.unwrap_or_default(),
            hulls,
            runs: Vec::new(),
            rejected: Vec::new(),
            notices: Vec::new(),
        };
        campaign.read_runs(&table_file)?;
        Ok(campaign)
    }

    fn read_runs(&mut self, file: &Path) -> Result<(), InputError> {
        let (table, malformed) = Table::read_what_fits(file)?;
        self.rejected.extend(malformed.into_iter().map(|(run_id, error)| Rejected { run_id, error }));
        table.require(&REQUIRED)?;
        for (column, kinds) in NEEDED_BY {
            if table.rows().any(|row| kinds.contains(&row.text("kind"))) {
                table.require(&[column])?;
            }
        }
        for column in table.header().iter().filter(|c| !COLUMNS.contains(&c.as_str())) {
            self.notices.push(format!("{}: column {} is not used", file.display(), printable(column)));
        }
        let mut lines = HashMap::new();
        for (order, row) in table.rows().enumerate() {
            let id = row.text("run_id").to_owned();
            let run = self.run(order, &row).and_then(|run| match lines.insert(id.clone(), row.line()) {
                None => Ok(run),
                Some(first) => {
                    let problem = format!("run_id {} stands in line {first} already", printable(&id));
                    Err(InputError::new(row.place("run_id"), problem).help("give every run a name of its own"))
                }
            });
            match run {
                Ok(run) => self.runs.push(run),
                Err(error) => self.rejected.push(Rejected { run_id: id, error }),
            }
        }
        self.reject_missing_files();
        self.tell_shared_files();
        if self.runs.is_empty() {
            return Err(self.rejected.first().map_or_else(
                || InputError::new(table.place(), "no runs below the header"),
                |rejected| rejected.error.clone(),
            ));
        }
        Ok(())
    }

    /// Leaves out runs without a file. The one that may have been meant is only one that no other run names: a repeat by
    /// mistake would be worse than a run less.
    fn reject_missing_files(&mut self) {
        let named: HashSet<PathBuf> = self.runs.iter().map(|run| run.file.clone()).collect();
        let is_missing =
            |run: &Run| std::fs::metadata(&run.file).is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound);
        let (missing, runs) = std::mem::take(&mut self.runs).into_iter().partition(is_missing);
        self.runs = runs;
        let missing: Vec<Run> = missing;
        for run in missing {
            let error = InputError::new(Place::file(&run.file), "the run's file is missing");
            let error = match unnamed_neighbour(&run.file, &named) {
                Some(near) => error.help(format!("no run names {near}: is it that one?")),
                None => error.help("export it again, or take its row out of runs.csv"),
            };
            self.rejected.push(Rejected { run_id: run.id, error });
        }
    }

    /// Two runs that read one file are no repeats of each other: their agreement says nothing of the noise.
    fn tell_shared_files(&mut self) {
        let mut first: HashMap<&Path, &str> = HashMap::new();
        for run in &self.runs {
            if let Some(other) = first.insert(&run.file, &run.id) {
                let file = run.file.display().to_string();
                self.notices.push(format!(
                    "runs {} and {} name the same file {}: one reading is counted twice",
                    printable(other),
                    printable(&run.id),
                    printable(&file)
                ));
            }
        }
    }

    fn run(&self, order: usize, row: &Cells) -> Result<Run, InputError> {
        let wrong = |column: &str, problem: String| InputError::new(row.place(column), problem);
        let id = row.text("run_id");
        if id.is_empty() || id.chars().any(char::is_control) {
            return Err(wrong("run_id", "run_id is empty, expected the run's name".to_owned()));
        }
        let kind_text = row.text("kind");
        let kind = KINDS.iter().find(|(name, _)| *name == kind_text).map(|(_, kind)| *kind).ok_or_else(|| {
            let names = KINDS.map(|(name, _)| name);
            let error =
                wrong("kind", format!("kind is `{}`, expected one of {}", printable(kind_text), names.join(", ")));
            match nearest(kind_text, names) {
                Some(near) => error.help(format!("did you mean {near}?")),
                None => error,
            }
        })?;
        let oscillates = matches!(kind, Kind::Sway | Kind::Yaw);
        let speed_m_s = row.optional_number("speed_m_s")?.unwrap_or(0.0);
        if kind != Kind::Zero && speed_m_s <= 0.0 {
            return Err(wrong("speed_m_s", format!("speed_m_s is {speed_m_s}, expected a speed above zero")));
        }
        let yaw_deg = match kind {
            Kind::Static | Kind::Tare => row.number("yaw_deg")?,
            _ => row.optional_number("yaw_deg")?.unwrap_or(0.0),
        };
        if yaw_deg.abs() > 90.0 {
            return Err(wrong("yaw_deg", format!("yaw_deg is {yaw_deg}, expected -90 to 90 degrees")));
        }
        let positive = |column: &str| -> Result<Option<f64>, InputError> {
            match row.optional_number(column)? {
                Some(number) if number <= 0.0 => {
                    Err(wrong(column, format!("{column} is {number}, expected above zero")))
                }
                number => Ok(number),
            }
        };
        let frequency_hz = positive("frequency_hz")?.filter(|_| oscillates);
        if oscillates && frequency_hz.is_none() {
            return Err(wrong("frequency_hz", format!("a run of kind {kind_text} needs frequency_hz")));
        }
        let radius_m = row.optional_number("radius_m")?.filter(|_| kind == Kind::Arc);
        if kind == Kind::Arc && !radius_m.is_some_and(|radius| radius != 0.0) {
            let problem = "a run of kind arc needs radius_m, positive to starboard".to_owned();
            return Err(wrong("radius_m", problem));
        }
        let water = match row.optional_number("water_temperature_c")? {
            None => self.water,
            Some(t) if Water::is_plausible(t) => self.water.at(t),
            Some(t) => {
                let problem = format!("water_temperature_c is {t}, expected 0 to 40 degC");
                return Err(wrong("water_temperature_c", problem));
            }
        };
        let file = match row.text("file") {
            "" => self.folder.join("data").join(format!("{id}.csv")),
            file => self.folder.join(file),
        };
        // What another person's campaign names is not to be read from all over the disk.
        let inside = file
            .strip_prefix(&self.folder)
            .is_ok_and(|name| name.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)));
        if !inside {
            let column = if row.text("file").is_empty() { "run_id" } else { "file" };
            let problem =
                format!("{column} is `{}`, which leads out of the campaign's folder", printable(row.text(column)));
            return Err(wrong(column, problem).help("copy the file to data/"));
        }
        Ok(Run {
            order,
            id: id.to_owned(),
            hull: self.hull_of(row, kind)?,
            kind,
            speed_m_s,
            yaw_deg,
            frequency_hz: frequency_hz.unwrap_or(0.0),
            sway_amplitude_m: positive("sway_amplitude_m")?,
            yaw_amplitude_deg: positive("yaw_amplitude_deg")?,
            radius_m,
            water,
            file,
            note: row.text("note").to_owned(),
            start_time_s: row.optional_number("start_time_s")?,
        })
    }

    fn hull_of(&self, row: &Cells, kind: Kind) -> Result<Option<usize>, InputError> {
        let id = row.text("hull");
        if kind == Kind::Tare || (id.is_empty() && kind == Kind::Zero) {
            return Ok(None);
        }
        let found = self.hulls.iter().position(|hull| hull.id == id);
        found.map(Some).ok_or_else(|| {
            let ids: Vec<&str> = self.hulls.iter().map(|hull| hull.id.as_str()).collect();
            let error = InputError::new(
                row.place("hull"),
                format!("hull `{}` is not in campaign.toml, which has {}", printable(id), ids.join(", ")),
            );
            match nearest(id, ids) {
                Some(near) => error.help(format!("did you mean {near}?")),
                None => error.help("add it as a [[hull]]"),
            }
        })
    }
}

/// The file beside a missing one whose name is nearest to it, of those that no run names.
fn unnamed_neighbour(file: &Path, named: &HashSet<PathBuf>) -> Option<String> {
    let entries = std::fs::read_dir(file.parent()?).ok()?;
    let free = entries.flatten().filter(|entry| !named.contains(&entry.path()));
    let names: Vec<String> = free.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    nearest(file.file_name()?.to_str()?, names.iter().map(String::as_str)).map(printable)
}

impl Default for Balance {
    fn default() -> Self {
        Balance { interaction: Matrix3::identity(), interaction_uncertainty: None, uncertainty: None }
    }
}

fn hulls(manifest: &Manifest, source: &Source) -> Result<Vec<Hull>, InputError> {
    let mut hulls: Vec<Hull> = Vec::new();
    for keys in &manifest.hull {
        let hull = keys.hull(source)?;
        if hulls.iter().any(|other| other.id == hull.id) {
            let problem = format!("hull {} stands twice", printable(&hull.id));
            return Err(InputError::new(source.place(keys.id()), problem));
        }
        hulls.push(hull);
    }
    Ok(hulls)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    #[serde(default)]
    campaign: CampaignKeys,
    water: WaterKeys,
    tank: Option<TankKeys>,
    balance: Option<BalanceKeys>,
    hull: Vec<HullKeys>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct CampaignKeys {
    name: String,
    facility: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TankKeys {
    width_m: Option<Spanned<f64>>,
    depth_m: Option<Spanned<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "units stand in names as they are written")]
struct BalanceKeys {
    interaction: Option<Spanned<[[f64; 3]; 3]>>,
    interaction_uncertainty: Option<Spanned<[[f64; 3]; 3]>>,
    uncertainty_N: Option<[Spanned<f64>; 2]>,
    uncertainty_N_m: Option<Spanned<f64>>,
}

impl TankKeys {
    fn cross_section(&self, source: &Source) -> Result<Option<(f64, f64)>, InputError> {
        let width = self.width_m.as_ref().map(|w| source.positive("width_m", w)).transpose()?;
        let depth = self.depth_m.as_ref().map(|d| source.positive("depth_m", d)).transpose()?;
        Ok(width.zip(depth))
    }
}

impl BalanceKeys {
    fn balance(&self, source: &Source) -> Result<Balance, InputError> {
        let mut balance = Balance::default();
        if let Some(matrix) = &self.interaction {
            balance.interaction = Matrix3::from_fn(|i, j| matrix.get_ref()[i][j]);
            let values = balance.interaction.singular_values();
            let (largest, smallest) = (values.max(), values.min());
            if !(largest.is_finite() && smallest > 1e-6 * largest) {
                let problem = "interaction is singular: it loses a component of the load";
                return Err(InputError::new(source.place(matrix), problem)
                    .help("rows and columns are AF, SF, YM; without interaction write [[1,0,0],[0,1,0],[0,0,1]]"));
            }
        }
        if let Some(matrix) = &self.interaction_uncertainty {
            let elements = Matrix3::from_fn(|i, j| matrix.get_ref()[i][j]);
            if !elements.iter().all(|u| u.is_finite() && *u >= 0.0) {
                let problem = "interaction_uncertainty has an element below zero, expected standard uncertainties of the elements of interaction";
                return Err(InputError::new(source.place(matrix), problem));
            }
            balance.interaction_uncertainty = Some(elements);
        }
        let not_negative = |name: &str, value: &Spanned<f64>| source.within(name, value, 0.0, f64::MAX, "zero or more");
        let forces = self.uncertainty_N.as_ref();
        let [axial, side] = match forces {
            Some([axial, side]) => [not_negative("uncertainty_N", axial)?, not_negative("uncertainty_N", side)?],
            None => [0.0, 0.0],
        };
        let moment = self.uncertainty_N_m.as_ref().map(|m| not_negative("uncertainty_N_m", m)).transpose()?;
        if forces.is_some() || moment.is_some() {
            balance.uncertainty = Some([axial, side, moment.unwrap_or(0.0)]);
        }
        Ok(balance)
    }
}
