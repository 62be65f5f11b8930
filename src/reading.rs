//! From the files of a log to the samples of a fit: cleaned, prepared, shortened where memory asks for it, and held against
//! itself. Commands, tests and benchmarks take this one way, so that all refuse the same logs in the same words.
//!
//! Knows no command and no fit.

mod added_mass;
mod force_balance;
mod measured_speed;
mod prepared_log;
mod pressure_and_depth;

use std::path::{Path, PathBuf};

use crate::diagnose::Check;
use crate::diagnose::sea::SeaError;
use crate::diagnose::sea::consistency;
use crate::input::{InputError, Place, printable};
use crate::log::{
    CHANNELS, Channel, Columns, Condenser, FlightLog, ForwardFilled, LogFiles, MOST_OBSERVATIONS, Observation, Piece,
    Preparation, PreparationSettings, Shorten, take_out_interpolated_speeds, take_out_lost_speeds,
};
use crate::vehicle::Vehicle;
pub use prepared_log::PreparedLog;
use pressure_and_depth::PressureAndDepth;

/// Why a log gives no samples.
#[derive(Debug, thiserror::Error)]
pub enum ReadingError {
    /// Files that cannot be read, or in which nothing is left to use.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A log that contradicts itself. What was taken out in the reading may be what is wrong, so the notes stand with it.
    #[error("{}{}; {REMEDY}{}", named(.log.as_deref()), SeaError::Inconsistent(.checks.clone()), noted(.notes))]
    Inconsistent {
        /// The first file of the log, where it is known.
        log: Option<PathBuf>,
        /// The checks that the log does not pass.
        checks: Vec<Check>,
        /// What was found in the reading.
        notes: Vec<String>,
    },
}

impl ReadingError {
    /// With what was warned of before, which may be the cause: files that were left out.
    pub fn beside(self, warnings: &[String]) -> Self {
        match self {
            ReadingError::Input(error) => ReadingError::Input(error.beside(warnings)),
            ReadingError::Inconsistent { log, checks, mut notes } => {
                notes.splice(0..0, warnings.iter().cloned());
                ReadingError::Inconsistent { log, checks, notes }
            }
        }
    }
}

/// What to do with a log that contradicts itself.
const REMEDY: &str =
    "choose another column by --column CHANNEL=COLUMN, state its unit by --unit CHANNEL=UNIT, or correct the file";

/// The file as the beginning of an error.
fn named(log: Option<&Path>) -> String {
    log.map(|log| format!("{}: ", printable(&log.to_string_lossy()))).unwrap_or_default()
}

/// Notes of the reading as the end of an error.
pub fn noted(notes: &[String]) -> String {
    if notes.is_empty() { String::new() } else { format!("; the reading noted: {}", notes.join("; ")) }
}

/// How a log is read.
#[derive(Debug, Default)]
pub struct Request {
    /// Which columns hold the channels.
    pub columns: Columns,
    /// Half window of the filter for vertical velocity \[s\]; none: that of [`PreparationSettings`].
    pub half_window_s: Option<f64>,
    /// In-situ density where the log gives none \[kg/m3\].
    pub density_kg_m3: Option<f64>,
    /// How a log that is too long for the memory is shortened.
    pub shorten: Shorten,
}

/// Reads the files of a log into samples, for a glider like this vehicle.
///
/// # Errors
/// What cannot be read, where nothing is left to use, and where a column is in another unit than it says.
pub fn read(logs: &[PathBuf], vehicle: &Vehicle, request: &Request) -> Result<PreparedLog, ReadingError> {
    read_watched(logs, vehicle, request, &|_| {})
}

/// The same; how far it is goes to `watch` after each piece.
///
/// # Errors
/// As [`read`].
pub fn read_watched(
    logs: &[PathBuf],
    vehicle: &Vehicle,
    request: &Request,
    watch: &dyn Fn(Progress),
) -> Result<PreparedLog, ReadingError> {
    let mut settings = settings(vehicle, request.density_kg_m3);
    settings.half_window_s = request.half_window_s.unwrap_or(settings.half_window_s);
    let mut gathering = Gathering::new(logs.first().cloned(), settings, request.shorten);
    gathering.gravity_is_known = states_gravity(vehicle);
    let mut files = LogFiles::open(logs, &request.columns)?;
    let mut log = gathered(logs, vehicle, request, gathering, &mut files, watch)
        .map_err(|error| error.beside(files.warnings()))?;
    log.notes.splice(0..0, files.notes().iter().cloned());
    log.left_out.splice(0..0, files.warnings().iter().cloned());
    log.calibration = files.calibration().cloned();
    Ok(log)
}

fn gathered(
    logs: &[PathBuf],
    vehicle: &Vehicle,
    request: &Request,
    mut gathering: Gathering,
    files: &mut LogFiles,
    watch: &dyn Fn(Progress),
) -> Result<PreparedLog, ReadingError> {
    while let Some(piece) = files.next_piece(PIECE_ROWS)? {
        match piece {
            Piece::Series(piece) => gathering.push(*piece),
            Piece::Glides(glides) => gathering.push_glides(with_density(glides, request.density_kg_m3, &logs[0])?),
        }
        watch(gathering.progress(files));
    }
    let assumed_temperature = gathering.assumed_temperature(vehicle);
    let nothing_left = gathering.nothing_left(&logs[0], request.density_kg_m3.is_some(), files);
    let mut log = gathering.finish()?;
    if log.observations.is_empty() {
        return Err(nothing_left.into());
    }
    check_pitch(&logs[0], &log.observations)?;
    log.notes.splice(0..0, assumed_temperature);
    Ok(log)
}

/// How far the reading of a log is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Files that were begun.
    pub begun: usize,
    /// All files; those of one segment count once.
    pub files: usize,
    /// Rows read so far.
    pub rows: usize,
}

/// Samples of a CSV file that are read at once.
const PIECE_ROWS: usize = 50_000;

/// What a log is prepared by that is flown with this vehicle.
pub fn settings(vehicle: &Vehicle, density_kg_m3: Option<f64>) -> PreparationSettings {
    let parameters = vehicle.glide_parameters();
    PreparationSettings {
        density_kg_m3,
        gravity_m_s2: parameters.gravity_m_s2,
        needs_temperature: parameters.hull_thermal_expansion_per_K != 0.0,
        ..PreparationSettings::default()
    }
}

/// A table of glides, each with a density.
fn with_density(
    mut glides: Vec<Observation>,
    density_kg_m3: Option<f64>,
    log: &Path,
) -> Result<Vec<Observation>, InputError> {
    if let Some(density) = density_kg_m3 {
        glides.iter_mut().filter(|g| !g.density_kg_m3.is_finite()).for_each(|g| g.density_kg_m3 = density);
    }
    if glides.iter().any(|glide| !glide.density_kg_m3.is_finite()) {
        let error = InputError::new(Place::file(log), "no density: expected a column `density_kg_m3`");
        return Err(error.help("give it with --density"));
    }
    Ok(glides)
}

/// Whether the vehicle's file states its acceleration of gravity.
fn states_gravity(vehicle: &Vehicle) -> bool {
    vehicle.sections.mass.gravity_m_s2.is_some()
}

/// Acceleration of gravity at the surface of the sea \[m/s2\], by the normal gravity of GRS 80 (Moritz 2000, as TEOS-10 has it).
pub fn gravity_m_s2(latitude_deg: f64) -> f64 {
    let sin2 = latitude_deg.to_radians().sin().powi(2);
    9.780_327 * (1.0 + (5.279_041_4e-3 + (2.327_18e-5 + (1.262e-7 + 7e-10 * sin2) * sin2) * sin2) * sin2)
}

/// Pitch that no glider keeps within on nearly all of its way \[rad\]: 1.6 degrees, which radians labelled degrees do.
const LEAST_PITCH_RAD: f64 = 0.028;

/// Samples from which the pitch is judged.
const FEWEST_PITCHES: usize = 50;

/// Refuses a pitch that is too small for any glider.
///
/// # Errors
/// Where 95 % of the samples pitch by less than 1.6 degrees.
pub fn check_pitch(log: &Path, observations: &[Observation]) -> Result<(), InputError> {
    let under_way = consistency::under_way(observations);
    let flat = under_way.iter().filter(|o| o.pitch_rad.abs() < LEAST_PITCH_RAD).count();
    if under_way.len() < FEWEST_PITCHES || flat * 20 < under_way.len() * 19 {
        return Ok(());
    }
    let problem = format!(
        "the log contradicts itself: unit of pitch: it stays within {:.1} degrees on {flat} of {} samples under way; no glider glides so",
        LEAST_PITCH_RAD.to_degrees(),
        under_way.len()
    );
    Err(InputError::new(Place::file(log), problem)
        .help("are its numbers radians, under a name that says degrees? --unit pitch_rad=rad states what they are"))
}

/// A log without a density, nor anything from which it follows.
pub fn no_density(log: &Path, files: &LogFiles) -> InputError {
    let help = files.help(Channel::Density).map_or_else(String::new, |help| format!("{help}, or "));
    InputError::new(Place::file(log), "no density, nor temperature with salinity or conductivity")
        .help(format!("{help}give it with --density"))
}

/// A log of column names only.
pub fn no_rows(log: &Path) -> InputError {
    InputError::new(Place::file(log), "no row of data below the names of the columns").help("is the file whole?")
}

/// Pieces of a log on their way to samples, in bounded memory.
pub struct Gathering {
    preparation: Preparation,
    /// Speeds that were repeated until the next one.
    repeated: ForwardFilled,
    condenser: Condenser,
    batch: Vec<Observation>,
    /// Samples that show turns and nothing else.
    turns_only: Condenser,
    has_tables: bool,
    pressure_and_depth: PressureAndDepth,
    /// Channels that had a value anywhere.
    recorded: Vec<Channel>,
    rows: usize,
    steady: [usize; 2],
    gravity_is_known: bool,
    gravity_m_s2: Option<f64>,
    log: Option<PathBuf>,
}

impl Gathering {
    /// Begins with nothing; `log` is the file that errors name.
    pub fn new(log: Option<PathBuf>, settings: PreparationSettings, how: Shorten) -> Self {
        Gathering {
            preparation: Preparation::new(settings),
            repeated: ForwardFilled::default(),
            condenser: Condenser::new(how, MOST_OBSERVATIONS),
            batch: Vec::new(),
            // None of them is steady: whole dives go where they are too many.
            turns_only: Condenser::new(Shorten::Dives, MOST_OBSERVATIONS),
            has_tables: false,
            pressure_and_depth: PressureAndDepth::default(),
            recorded: Vec::new(),
            rows: 0,
            steady: [0; 2],
            gravity_is_known: false,
            gravity_m_s2: None,
            log,
        }
    }

    fn condense(&mut self) {
        self.steady[0] += self.batch.iter().filter(|o| o.steady).count();
        self.steady[1] += self.batch.len();
        self.condenser.take(&mut self.batch);
        self.turns_only.take(&mut self.preparation.take_turns_only());
    }

    /// Gravity where the log begins, for all of it: over a hundred kilometres it changes by a ten-thousandth.
    fn locate(&mut self, piece: &FlightLog) {
        if self.gravity_is_known || self.gravity_m_s2.is_some() {
            return;
        }
        let latitude = piece.column(Channel::Latitude).iter().find(|latitude| latitude.abs() <= 90.0);
        if let Some(gravity) = latitude.copied().map(gravity_m_s2) {
            self.gravity_m_s2 = Some(gravity);
            self.preparation.set_gravity(gravity);
        }
    }

    /// Takes the next piece of a time series.
    pub fn push(&mut self, mut piece: FlightLog) {
        self.rows += piece.len();
        self.locate(&piece);
        for info in CHANNELS.iter().filter(|info| piece.has(info.channel)) {
            if !self.recorded.contains(&info.channel) {
                self.recorded.push(info.channel);
            }
        }
        self.pressure_and_depth.take(&piece);
        // Before rows are left out: the first of a run is the one that was measured.
        self.repeated.take_out(&mut piece);
        self.preparation.push(piece, &mut self.batch);
        self.condense();
    }

    /// How far it is with these files.
    pub fn progress(&self, files: &LogFiles) -> Progress {
        let [begun, files] = files.begun_of();
        Progress { begun, files, rows: self.rows }
    }

    /// Takes a table of glides.
    pub fn push_glides(&mut self, mut glides: Vec<Observation>) {
        self.has_tables = true;
        self.steady[0] += glides.iter().filter(|o| o.steady).count();
        self.steady[1] += glides.len();
        self.condenser.take(&mut glides);
    }

    /// What is assumed of the temperature of a log that has none, for a hull that expands with it.
    fn assumed_temperature(&self, vehicle: &Vehicle) -> Option<String> {
        let p = vehicle.glide_parameters();
        let is_assumed =
            p.hull_thermal_expansion_per_K != 0.0 && self.rows > 0 && !self.recorded.contains(&Channel::Temperature);
        is_assumed.then(|| {
            format!(
                "no water temperature in the log: {} degC assumed, at which the volume of the hull is stated",
                p.reference_temperature_C
            )
        })
    }

    /// Why no sample came of a log.
    fn nothing_left(&self, log: &Path, has_density: bool, files: &LogFiles) -> InputError {
        let has = |channel: Channel| self.recorded.contains(&channel);
        let of_sea_water = has(Channel::Temperature) && (has(Channel::Salinity) || has(Channel::Conductivity));
        let error = |problem: String| InputError::new(Place::file(log), problem);
        if self.rows == 0 {
            return no_rows(log);
        }
        for channel in [Channel::Pitch, Channel::Ballast] {
            if !has(channel) {
                let name = CHANNELS[channel as usize].name;
                let help = files.help(channel);
                return error(format!("not a single value of `{name}`"))
                    .help(help.unwrap_or_else(|| format!("choose another column by --column {name}=COLUMN")));
            }
        }
        if !(has_density || has(Channel::Density) || of_sea_water) {
            return no_density(log, files);
        }
        let leg_dbar = PreparationSettings::default().least_leg_dbar;
        error(format!("no descent or ascent of more than {leg_dbar} dbar with pitch, ballast volume and density on it"))
            .help("is it the log of a dive, with pressure in decibar, or depth in metres?")
    }

    /// The samples.
    ///
    /// # Errors
    /// Where a column is in another unit than it says, so that its values were taken out.
    pub fn finish(mut self) -> Result<PreparedLog, ReadingError> {
        self.preparation.finish(&mut self.batch);
        self.condense();
        let (mut observations, shortened) = self.condenser.finish();
        // Means over a stretch of a long log show no lines any more.
        let interpolated = shortened.is_none().then(|| take_out_interpolated_speeds(&mut observations)).flatten();
        let never_measured = self.repeated.report().into_iter().chain(interpolated);
        let lost = never_measured.chain(take_out_lost_speeds(&mut observations));
        let lost: Vec<String> = lost.chain(self.pressure_and_depth.contradiction()).collect();
        let w_filter =
            if self.has_tables { "the column w_m_s of the table".to_owned() } else { self.preparation.filter() };
        let w_filter = match &shortened {
            Some(said) => format!("{w_filter}; {said}"),
            None => w_filter,
        };
        let notes: Vec<String> = self.preparation.notes().sentences().into_iter().chain(shortened).collect();
        let wrong = consistency::taken_out(&self.preparation);
        if wrong.is_empty() {
            Ok(PreparedLog {
                observations,
                turns_only: self.turns_only.finish().0,
                w_filter,
                notes,
                left_out: lost,
                calibration: None,
                steady: self.steady,
                gravity_m_s2: self.gravity_m_s2,
                log: self.log,
            })
        } else {
            let notes = notes.into_iter().chain(lost).collect();
            Err(ReadingError::Inconsistent { log: self.log, checks: wrong, notes })
        }
    }
}
