//! Flight logs: what a glider recorded of itself, from a file to samples that a fit can use.
//!
//! ```text
//! CSV, Seaglider NetCDF, Slocum/OG1 NetCDF -> FlightLog -> clean -> density -> vertical velocity -> legs -> Observation
//! per-glide table                          ------------------------------------------------------> Observation
//! ```
//! - [`FlightLog`]: columns, one row per sample, a missing value is NaN.
//! - [`LogFiles`]: any number of the files above in any order, known by their content, read piece by piece; [`open`] for one.
//! - [`Calibration`], [`GpsFix`]: what the files say of the vehicle, and where it was at the surface.
//! - [`Preparation`]: cleaning, density, vertical velocity, legs; what it did to the data stands in its [`Notes`].
//! - [`take_out_lost_speeds`]: legs on which the speed sensor had lost the water;
//!   [`take_out_interpolated_speeds`], [`ForwardFilled`]: what was never measured.
//! - [`Condenser`]: a log of any length in bounded memory.
//! - [`Observation`]: one sample of one leg, ready for a fit.
//!
//! Knows nothing of vehicles or of hydrodynamics.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

mod ad2cp;
mod calibration;
mod cells;
mod channels;
mod clean;
mod columns;
mod condense;
mod csv;
mod dates;
mod density;
mod dialect;
mod dinkum_ascii;
mod file_order;
mod files;
mod fix;
mod forward_filled_speed;
mod glide_table;
mod gzip;
mod in_memory;
mod interpolated_speed;
mod lost_speed;
mod makers;
mod motors;
mod names;
mod netcdf;
mod observation;
mod og1;
mod on_change;
mod open;
mod plain_table;
mod prepare;
mod pressure;
mod resample;
mod row_dates;
mod seaexplorer;
mod seaglider;
mod segment;
mod settings;
mod slocum;
mod slocum_readings;
mod source;
mod time_again;
mod times;
mod units;
mod vertical_velocity;

pub use self::csv::CsvLog;
pub use calibration::Calibration;
pub use channels::{CHANNELS, Channel, ChannelInfo, FlightLog};
pub use clean::Notes;
pub use columns::Columns;
pub use condense::{Condenser, MOST_OBSERVATIONS, Shorten};
pub use dates::shown_time;
pub use density::{
    DensitySlopes, absolute_salinity_g_kg, conservative_temperature_C, density_slopes, in_situ_density_kg_m3,
    practical_salinity,
};
pub use files::{LogFiles, Piece};
pub use fix::{GpsFix, degrees};
pub use forward_filled_speed::ForwardFilled;
pub use glide_table::read_glide_table;
pub use glidepolar_inference::order::median;
pub use interpolated_speed::take_out_interpolated_speeds;
pub use lost_speed::take_out_lost_speeds;
pub use names::column_of;
pub use observation::{DBAR_PA, Observation};
pub use open::{LogPieces, Opened, open};
pub use plain_table::{Dates, plain_table};
pub use prepare::{Preparation, Prepared};
pub use segment::{Leg, legs};
pub use settings::PreparationSettings;
pub use vertical_velocity::{Velocity, filter_windows, vertical_velocity};

#[cfg(test)]
mod tests;
