//! Names that the makers of gliders and the formats use for columns of tables, and the units that come with them.
//!
//! Knows names; no file.

use super::channels::Channel;

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Names that the makers and the formats use, the factor to the unit kept here: Slocum (bar, rad, inches), Seaglider's
/// basestation (degrees, cm), SeaExplorer (degrees, mm), OG1 (degrees).
pub(super) const MAKERS: &[(Channel, &str, f64)] = &[
    (Channel::Time, "m_present_time", 1.0),
    (Channel::Time, "sci_m_present_time", 1.0),
    (Channel::Time, "Timestamp", 1.0),
    (Channel::Time, "PLD_REALTIMECLOCK", 1.0),
    (Channel::Time, "TIME", 1.0),
    (Channel::Time, "time", 1.0),
    (Channel::Time, "datetime", 1.0),
    (Channel::Time, "Time", 1.0),
    (Channel::Pressure, "sci_water_pressure", 10.0),
    (Channel::Pressure, "m_pressure", 10.0),
    (Channel::Pressure, "ctd_pressure", 1.0),
    (Channel::Pressure, "GPCTD_PRESSURE", 1.0),
    (Channel::Pressure, "LEGATO_PRESSURE", 1.0),
    (Channel::Pressure, "PRES", 1.0),
    (Channel::Pressure, "pressure", 1.0),
    (Channel::Depth, "m_depth", 1.0),
    (Channel::Depth, "Depth", 1.0),
    (Channel::Depth, "DEPTH", 1.0),
    (Channel::Depth, "GLIDER_DEPTH", 1.0),
    (Channel::Depth, "depth", 1.0),
    (Channel::Pitch, "m_pitch", 1.0),
    (Channel::Pitch, "eng_pitchAng", DEG),
    (Channel::Pitch, "Pitch", DEG),
    (Channel::Pitch, "PITCH", DEG),
    (Channel::Pitch, "GLIDER_PITCH", DEG),
    (Channel::Ballast, "m_ballast_pumped", 1.0),
    (Channel::Ballast, "m_de_oil_vol", 1.0),
    (Channel::Ballast, "eng_vbdCC", 1.0),
    (Channel::Ballast, "BallastPos", 1.0),
    (Channel::Ballast, "oil_volume", 1.0),
    (Channel::Ballast, "de_oil_volume", 1.0),
    (Channel::Ballast, "de_oil_vol", 1.0),
    (Channel::Ballast, "ballast_pumped", 1.0),
    (Channel::Ballast, "buoyancy_pump", 1.0),
    (Channel::Density, "DENSITY", 1.0),
    (Channel::Density, "density", 1.0),
    (Channel::Temperature, "sci_water_temp", 1.0),
    (Channel::Temperature, "GPCTD_TEMPERATURE", 1.0),
    (Channel::Temperature, "LEGATO_TEMPERATURE", 1.0),
    (Channel::Temperature, "TEMP", 1.0),
    (Channel::Temperature, "temperature", 1.0),
    (Channel::Salinity, "LEGATO_SALINITY", 1.0),
    (Channel::Salinity, "PSAL", 1.0),
    (Channel::Salinity, "salinity", 1.0),
    (Channel::Conductivity, "sci_water_cond", 1.0),
    (Channel::Conductivity, "GPCTD_CONDUCTIVITY", 1.0),
    (Channel::Conductivity, "LEGATO_CONDUCTIVITY", 0.1),
    (Channel::Roll, "m_roll", 1.0),
    (Channel::Roll, "eng_rollAng", DEG),
    (Channel::Roll, "Roll", DEG),
    (Channel::Roll, "ROLL", DEG),
    (Channel::Roll, "GLIDER_ROLL", DEG),
    (Channel::Heading, "m_heading", 1.0),
    (Channel::Heading, "eng_head", DEG),
    (Channel::Heading, "Heading", DEG),
    (Channel::Heading, "HEADING", DEG),
    (Channel::Rudder, "m_fin", 1.0),
    (Channel::BatteryPosition, "m_battpos", 0.0254),
    (Channel::BatteryPosition, "LinPos", 0.001),
    (Channel::PitchMass, "eng_pitchCtl", 0.01),
    (Channel::Charge, "m_coulomb_amphr_total", 1.0),
    (Channel::Voltage, "m_battery", 1.0),
    (Channel::Latitude, "LATITUDE", 1.0),
    (Channel::Latitude, "latitude", 1.0),
    (Channel::Longitude, "LONGITUDE", 1.0),
    (Channel::Longitude, "longitude", 1.0),
];

/// What a maker's name says of the unit.
pub(super) fn factor(channel: Channel, name: &str) -> Option<f64> {
    MAKERS.iter().find(|(of, known, _)| *of == channel && *known == name).map(|(.., factor)| *factor)
}
