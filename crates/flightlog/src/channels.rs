//! The columns of a flight log, in one table: what each is called in files, in which unit it is kept, what it is.

use std::ops::Range;

/// One column of [`FlightLog`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelInfo {
    /// The channel.
    pub channel: Channel,
    /// Name with its unit: the column of a CSV file, and how the channel is spoken of.
    pub name: &'static str,
    /// Other columns that hold the same, with the factor to the unit kept here.
    pub aliases: &'static [(&'static str, f64)],
    /// What it is.
    pub meaning: &'static str,
}

macro_rules! channels {
    ($($variant:ident $name:literal [$($alias:literal * $factor:expr),*] $meaning:literal;)*) => {
        /// What a flight log records.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Channel {
            $(#[doc = concat!($meaning, ", `", $name, "`.")] $variant,)*
        }

        /// The table of channels, in the order of [`Channel`].
        pub const CHANNELS: &[ChannelInfo] = &[
            $(ChannelInfo { channel: Channel::$variant, name: $name, aliases: &[$(($alias, $factor)),*], meaning: $meaning },)*
        ];
    };
}

const DEG: f64 = std::f64::consts::PI / 180.0;

channels! {
    Time "time_s" [] "Time, Unix or since the start";
    Pressure "pressure_dbar" [] "Gauge pressure";
    Depth "depth_m" [] "Depth, positive down";
    Pitch "pitch_rad" ["pitch_deg" * DEG] "Pitch, nose up positive";
    Ballast "vbd_cc" ["vbd_m3" * 1e6] "Ballast volume, positive more buoyant";
    Density "density_kg_m3" [] "In-situ density";
    Temperature "temperature_C" [] "Water temperature";
    Salinity "salinity_psu" [] "Practical salinity";
    Conductivity "conductivity_S_m" [] "Conductivity";
    Roll "roll_rad" ["roll_deg" * DEG] "Roll";
    Heading "heading_rad" ["heading_deg" * DEG] "Heading";
    RollMass "roll_mass_rad" ["roll_mass_deg" * DEG] "Angle of the roll mass, to starboard positive";
    Rudder "fin_rad" ["fin_deg" * DEG, "rudder_rad" * 1.0, "rudder_deg" * DEG] "Rudder angle";
    BatteryPosition "battpos_m" [] "Battery position, positive forward";
    PitchMass "pitch_mass_m" [] "Seaglider pitch mass, positive nose up";
    Speed "speed_through_water_m_s" [] "Measured speed through the water";
    Charge "coulomb_Ah" [] "Charge drawn from the battery";
    Voltage "battery_V" [] "Battery voltage";
    Latitude "lat_deg" ["latitude_deg" * 1.0] "Latitude";
    Longitude "lon_deg" ["longitude_deg" * 1.0] "Longitude";
    Dive "dive" [] "Number of the dive";
    CurrentEast "current_east_m_s" [] "Water velocity at the glider's depth, to the east";
    CurrentNorth "current_north_m_s" [] "Water velocity at the glider's depth, to the north";
    MotorMoving "motor_moving" [] "1 while a motor moves";
    SinceMove "since_move_s" [] "Time since the last move of a motor ended, 0 during a move";
}

/// How many channels there are.
const N: usize = CHANNELS.len();

/// A log in columns, one row per sample. A channel that was not recorded is empty, a value that is missing is NaN.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FlightLog {
    columns: [Vec<f64>; N],
    rows: usize,
}

impl FlightLog {
    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Whether the channel was recorded at all.
    pub fn has(&self, channel: Channel) -> bool {
        self.columns[channel as usize].iter().any(|value| value.is_finite())
    }

    /// The column of a channel, as long as the log; empty where it was not recorded.
    pub fn column(&self, channel: Channel) -> &[f64] {
        &self.columns[channel as usize]
    }

    /// One value, NaN where it is missing.
    pub fn at(&self, channel: Channel, row: usize) -> f64 {
        self.columns[channel as usize].get(row).copied().unwrap_or(f64::NAN)
    }

    /// Puts a column in place.
    ///
    /// # Panics
    /// When its length differs from that of the columns already there.
    pub fn set(&mut self, channel: Channel, values: Vec<f64>) {
        assert!(self.rows == 0 || values.len() == self.rows, "columns of one length");
        self.rows = values.len();
        self.columns[channel as usize] = values;
    }

    /// The columns of the channels that were recorded, taken out of the log.
    pub fn into_columns(self) -> Vec<(Channel, Vec<f64>)> {
        let recorded = CHANNELS.iter().zip(self.columns).filter(|(_, values)| values.iter().any(|v| v.is_finite()));
        recorded.map(|(info, values)| (info.channel, values)).collect()
    }

    /// The column of a channel, made of missing values where it was not recorded.
    pub fn column_mut(&mut self, channel: Channel) -> &mut [f64] {
        let rows = self.rows;
        let column = &mut self.columns[channel as usize];
        column.resize(rows, f64::NAN);
        column
    }

    /// Adds one row; channels that are not named are missing.
    pub fn push(&mut self, row: &[(Channel, f64)]) {
        for &(channel, value) in row {
            let column = &mut self.columns[channel as usize];
            column.resize(self.rows, f64::NAN);
            column.push(value);
        }
        self.rows += 1;
        for column in &mut self.columns {
            if !column.is_empty() {
                column.resize(self.rows, f64::NAN);
            }
        }
    }

    /// Adds the rows of another log behind these.
    pub fn append(&mut self, other: &FlightLog) {
        let rows = self.rows + other.rows;
        for (mine, theirs) in self.columns.iter_mut().zip(&other.columns) {
            if mine.is_empty() && theirs.is_empty() {
                continue;
            }
            mine.resize(self.rows, f64::NAN);
            mine.extend_from_slice(theirs);
            mine.resize(rows, f64::NAN);
        }
        self.rows = rows;
    }

    /// Keeps the rows for which `keep` is true.
    pub fn retain(&mut self, keep: &[bool]) {
        let kept = keep.iter().filter(|&&keep| keep).count();
        // Mostly all of them, and moving a value to where it stands takes as long as reading it did.
        if kept == self.rows {
            return;
        }
        for column in self.columns.iter_mut().filter(|column| !column.is_empty()) {
            let mut flags = keep.iter();
            column.retain(|_| *flags.next().unwrap_or(&false));
        }
        self.rows = kept;
    }

    /// These rows, copied.
    ///
    /// # Panics
    /// Where the log has fewer.
    pub fn part(&self, rows: Range<usize>) -> FlightLog {
        let mut part = FlightLog { rows: rows.len(), ..FlightLog::default() };
        for (mine, theirs) in part.columns.iter_mut().zip(&self.columns) {
            if !theirs.is_empty() {
                mine.extend_from_slice(&theirs[rows.clone()]);
            }
        }
        part
    }

    /// Drops all rows but the first `rows`.
    pub fn truncate(&mut self, rows: usize) {
        self.columns.iter_mut().for_each(|column| column.truncate(rows));
        self.rows = self.rows.min(rows);
    }
}
