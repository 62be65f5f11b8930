//! Names under which time series of many programs hold a channel: OG1 and EGO, pyglider, the US glider archive, the sensors
//! of a Slocum, the basestation's variables, CF standard names. Capital letters do not matter.
//!
//! Knows names; no file and no unit.

use super::channels::{CHANNELS, Channel, ChannelInfo};

/// Names of each channel, the best first.
pub(super) const NAMES: &[(Channel, &[&str])] = &[
    (
        Channel::Time,
        &[
            "time",
            "m_present_time",
            "sci_m_present_time",
            "ctd_time",
            "ctd_epoch_time",
            "epoch_time",
            "timestamp",
            "datetime",
            "juld",
            "time_adjusted",
            "time_utc",
            "obs_time",
            "sample_time",
        ],
    ),
    (
        Channel::Pressure,
        &[
            "pres",
            "pressure",
            "sci_water_pressure",
            "m_pressure",
            "m_water_pressure",
            "ctd_pressure",
            "gpctd_pressure",
            "legato_pressure",
            "sci_rbrctd_pressure_00",
            "pres_adjusted",
            "press",
            "water_pressure",
            "sea_water_pressure",
            "pressure_ctd",
            "pres_ctd",
        ],
    ),
    (Channel::Depth, &["depth", "glider_depth", "m_depth", "ctd_depth", "depth_ctd", "nav_depth", "depth_z"]),
    (
        Channel::Pitch,
        &[
            "pitch",
            "glider_pitch",
            "m_pitch",
            "eng_pitchang",
            "pitchang",
            "platform_pitch",
            "platform_pitch_angle",
            "vehicle_pitch",
            "nav_pitch",
        ],
    ),
    (
        Channel::Ballast,
        &[
            "vbd_cc",
            "ballast_pumped",
            "m_ballast_pumped",
            "buoyancy_pump",
            "m_de_oil_vol",
            "oil_volume",
            "de_oil_volume",
            "de_oil_vol",
            "oil_vol",
            "ballast_volume",
            "ballastpos",
            "ballast_pos",
            "eng_vbdcc",
            "vbdcc",
            "vbd",
            "vbd_volume",
            "glider_vbd",
            "ballast",
            "ballast_cc",
            "glider_ballast",
            "glider_ballast_volume",
            "ballast_volume_pumped",
            "volume_pumped",
        ],
    ),
    (Channel::Density, &["density", "dens", "density_insitu", "ctd_density", "sea_water_density"]),
    (
        Channel::Temperature,
        &[
            "temp",
            "temperature",
            "sci_water_temp",
            "m_water_temp",
            "gpctd_temperature",
            "legato_temperature",
            "sci_rbrctd_temperature_00",
            "temp_adjusted",
            "sea_water_temperature",
            "water_temperature",
            "temperature_ctd",
            "temp_raw",
            "temperature_raw",
        ],
    ),
    (
        Channel::Salinity,
        &[
            "psal",
            "salinity",
            "practical_salinity",
            "legato_salinity",
            "psal_adjusted",
            "sea_water_practical_salinity",
            "sea_water_salinity",
            "salinity_corrected",
            "sal",
            "psal_raw",
            "salinity_raw",
        ],
    ),
    (
        Channel::Conductivity,
        &[
            "cndc",
            "conductivity",
            "sci_water_cond",
            "m_water_cond",
            "gpctd_conductivity",
            "legato_conductivity",
            "sci_rbrctd_conductivity_00",
            "cndc_adjusted",
            "sea_water_electrical_conductivity",
            "water_conductivity",
            "conductivity_ctd",
            "cond",
            "cndc_raw",
        ],
    ),
    (
        Channel::Roll,
        &[
            "roll",
            "glider_roll",
            "m_roll",
            "eng_rollang",
            "rollang",
            "platform_roll",
            "platform_roll_angle",
            "nav_roll",
        ],
    ),
    (
        Channel::Heading,
        &[
            "heading",
            "glider_heading",
            "m_heading",
            "eng_head",
            "head",
            "hdg",
            "platform_heading",
            "platform_orientation",
            "platform_yaw_angle",
            "yaw",
            "nav_heading",
        ],
    ),
    (Channel::RollMass, &["roll_mass", "angpos", "eng_rollctl", "roll_ctl"]),
    (Channel::Rudder, &["fin", "m_fin", "rudder"]),
    (Channel::BatteryPosition, &["battpos", "battery_position", "m_battpos", "linpos"]),
    (Channel::PitchMass, &["eng_pitchctl", "pitch_ctl"]),
    (Channel::Speed, &["speed_through_water_m_s", "speed_through_water"]),
    (Channel::Charge, &["coulomb", "m_coulomb_amphr_total"]),
    (Channel::Voltage, &["battery", "m_battery", "voltage"]),
    (Channel::Latitude, &["latitude", "lat", "m_lat", "latitude_adjusted", "nav_latitude"]),
    (Channel::Longitude, &["longitude", "lon", "m_lon", "longitude_adjusted", "nav_longitude"]),
    (Channel::Dive, &["dive", "dive_number", "dive_num"]),
];

/// CF standard names of channels.
const STANDARD: &[(Channel, &[&str])] = &[
    (Channel::Time, &["time"]),
    (Channel::Pressure, &["sea_water_pressure", "sea_water_pressure_due_to_sea_water"]),
    (Channel::Depth, &["depth"]),
    (Channel::Pitch, &["platform_pitch", "platform_pitch_fore_up", "platform_pitch_angle"]),
    (Channel::Roll, &["platform_roll", "platform_roll_starboard_down", "platform_roll_angle"]),
    (Channel::Heading, &["platform_orientation", "platform_yaw", "platform_yaw_fore_starboard", "platform_yaw_angle"]),
    (Channel::Temperature, &["sea_water_temperature"]),
    (Channel::Salinity, &["sea_water_practical_salinity", "sea_water_salinity"]),
    (Channel::Conductivity, &["sea_water_electrical_conductivity"]),
    (Channel::Density, &["sea_water_density"]),
    (Channel::Latitude, &["latitude"]),
    (Channel::Longitude, &["longitude"]),
];

/// The names of a channel, the best first.
pub(super) fn known(channel: Channel) -> &'static [&'static str] {
    NAMES.iter().find(|(named, _)| *named == channel).map_or(&[], |(_, names)| names)
}

/// Whether a table's name is a known one; capital letters do not matter, and blanks stand for underscores.
pub(super) fn is_same(name: &str, known: &str) -> bool {
    name.trim().replace(' ', "_").eq_ignore_ascii_case(known)
}

/// Where a channel stands among the names of a table that may state units in brackets behind them.
pub fn column_of(channel: Channel, header: &[String]) -> Option<usize> {
    let info = &CHANNELS[channel as usize];
    let own = std::iter::once(info.name).chain(info.aliases.iter().map(|(alias, _)| *alias));
    let stem = |name: &'_ String| with_unit(name).map_or(name.clone(), |(stem, _)| stem.to_owned());
    let mut all = own.chain(known(channel).iter().copied());
    all.find_map(|known| header.iter().position(|name| is_same(&stem(name), known)))
}

/// Whether a column of this name holds some channel.
pub(super) fn is_known(name: &str) -> bool {
    let is_named = |known: &str| known.eq_ignore_ascii_case(name);
    let of_contract = |info: &ChannelInfo| is_named(info.name) || info.aliases.iter().any(|(alias, _)| is_named(alias));
    NAMES.iter().any(|(_, names)| names.iter().any(|known| is_named(known))) || CHANNELS.iter().any(of_contract)
}

/// The CF standard names of a channel.
pub(super) fn standard(channel: Channel) -> &'static [&'static str] {
    STANDARD.iter().find(|(named, _)| *named == channel).map_or(&[], |(_, names)| names)
}

/// A name with its unit behind it in brackets, `pressure (dbar)` or `pitch[deg]`, in two.
pub(super) fn with_unit(name: &str) -> Option<(&str, &str)> {
    let name = name.trim();
    let (open, close) = if name.ends_with(')') { ('(', ')') } else { ('[', ']') };
    let (stem, unit) = name.strip_suffix(close)?.split_once(open)?;
    Some((stem.trim(), unit.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_stands_for_two_channels() {
        let all: Vec<&str> = NAMES.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        for (i, name) in all.iter().enumerate() {
            assert!(!all[..i].contains(name), "{name}");
            assert_eq!(*name, name.to_lowercase());
        }
    }

    #[test]
    fn a_channel_is_found_by_any_of_its_names() {
        for latitude in ["lat_deg", "Latitude", "lat", "latitude (degrees_north)"] {
            let header = ["lon".to_owned(), latitude.to_owned()];
            assert_eq!(column_of(Channel::Latitude, &header), Some(1), "{latitude}");
        }
        assert_eq!(column_of(Channel::Latitude, &["plate".to_owned()]), None);
    }

    #[test]
    fn a_unit_in_brackets_is_taken_off() {
        assert_eq!(with_unit("pressure (dbar)"), Some(("pressure", "dbar")));
        assert_eq!(with_unit("m_pitch[rad]"), Some(("m_pitch", "rad")));
        assert_eq!(with_unit("pressure_dbar"), None);
    }
}
