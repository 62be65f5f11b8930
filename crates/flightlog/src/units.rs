//! Units of channels: what files call them, and how their numbers become those that are kept here.
//!
//! Knows channels; no file.

use super::channels::{CHANNELS, Channel};
use super::dates::epoch_s;
use super::names;

/// From the number in a file to the one that is kept: `factor * x + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Conversion {
    pub(super) factor: f64,
    pub(super) offset: f64,
}

impl Conversion {
    pub(super) const NONE: Conversion = Conversion::by(1.0);

    pub(super) const fn by(factor: f64) -> Self {
        Conversion { factor, offset: 0.0 }
    }

    pub(super) fn convert(self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Spellings of a unit, its factor, its offset.
type Unit = (&'static [&'static str], f64, f64);

const TIMES: &[Unit] = &[
    (&["s", "sec", "secs", "second", "seconds", "timestamp", "utc", "epochseconds", "unixtime", "posix"], 1.0, 0.0),
    (&["ms", "msec", "millisecond", "milliseconds"], 1e-3, 0.0),
    (&["us", "microsecond", "microseconds"], 1e-6, 0.0),
    (&["ns", "nanosecond", "nanoseconds"], 1e-9, 0.0),
    (&["min", "mins", "minute", "minutes"], 60.0, 0.0),
    (&["h", "hr", "hrs", "hour", "hours"], 3600.0, 0.0),
    (&["d", "day", "days"], 86_400.0, 0.0),
    // Days as programs count them: of Excel from 30 December 1899, of Matlab from the day before year 0, Julian days from noon.
    (&["excel"], 86_400.0, -25_569.0 * 86_400.0),
    (&["matlab", "datenum"], 86_400.0, -719_529.0 * 86_400.0),
    (&["julian", "jd"], 86_400.0, -2_440_587.5 * 86_400.0),
];
const PRESSURES: &[Unit] = &[
    (&["dbar", "dbars", "decibar", "decibars", "db"], 1.0, 0.0),
    (&["bar", "bars"], 10.0, 0.0),
    (&["mbar", "millibar", "millibars", "hpa"], 0.01, 0.0),
    (&["pa", "pascal", "pascals"], 1e-4, 0.0),
    (&["kpa", "kilopascal"], 0.1, 0.0),
    (&["mpa"], 100.0, 0.0),
    (&["psi"], 0.689_475_729, 0.0),
    // Feet of sea water, as divers' gauges count them: 3.0643 kPa.
    (&["ft", "feet", "fsw", "ftsw"], 0.306_43, 0.0),
];
const LENGTHS: &[Unit] = &[
    (&["m", "meter", "meters", "metre", "metres"], 1.0, 0.0),
    (&["cm"], 0.01, 0.0),
    (&["mm"], 0.001, 0.0),
    (&["in", "inch", "inches"], 0.0254, 0.0),
    (&["ft", "feet"], 0.3048, 0.0),
];
const ANGLES: &[Unit] = &[
    (
        &[
            "deg",
            "degs",
            "degree",
            "degrees",
            "arc_degree",
            "arcdeg",
            "angular_degree",
            "angulardegree",
            "angulardegrees",
            "degree_t",
            "degrees_t",
            "degree_true",
            "degrees_true",
            "degreetrue",
            "degreestrue",
            "degree_magnetic",
            "degrees_magnetic",
            "degreesmagnetic",
            "\u{b0}",
        ],
        DEG,
        0.0,
    ),
    (&["rad", "radian", "radians"], 1.0, 0.0),
];
const VOLUMES: &[Unit] = &[
    (
        &[
            "cc",
            "ccs",
            "cm3",
            "cm^3",
            "cm**3",
            "cm\u{b3}",
            "cubic_centimeter",
            "cubic_centimeters",
            "cubiccentimeter",
            "cubiccentimeters",
            "cubic_centimetres",
            "cubiccentimetres",
            "ml",
            "milliliter",
            "milliliters",
            "millilitre",
            "millilitres",
        ],
        1.0,
        0.0,
    ),
    (&["m3", "m^3", "m**3", "m\u{b3}", "cubic_meter", "cubicmeters"], 1e6, 0.0),
    (&["l", "litre", "liter", "litres", "liters", "dm3"], 1e3, 0.0),
];
const DENSITIES: &[Unit] = &[
    (&["kg/m3", "kg/m^3", "kg/m**3", "kgm-3", "kg.m-3", "kgm^-3", "kgm**-3", "kg/m\u{b3}"], 1.0, 0.0),
    (&["g/cm3", "g/cm^3", "g/cc", "gcm-3", "g/ml", "kg/l"], 1000.0, 0.0),
    (&["g/l"], 1.0, 0.0),
    (&["kg/m3-1000", "sigma"], 1.0, 1000.0),
];
const TEMPERATURES: &[Unit] = &[
    (
        &[
            "c",
            "degc",
            "deg_c",
            "degsc",
            "celsius",
            "degree_celsius",
            "degrees_celsius",
            "degreecelsius",
            "degreescelsius",
            "deg_celsius",
            "degcelsius",
            "degreec",
            "degreesc",
            "degree_c",
            "degrees_c",
            "\u{b0}c",
            "its-90",
            "its90",
            "its-90,degc",
        ],
        1.0,
        0.0,
    ),
    (&["k", "kelvin"], 1.0, -273.15),
    (&["f", "degf", "fahrenheit"], 5.0 / 9.0, -160.0 / 9.0),
];
const SALINITIES: &[Unit] = &[
    (
        &[
            "psu",
            "pss",
            "1",
            "1e-3",
            "1e-03",
            "0.001",
            "pss-78",
            "pss78",
            "practical_salinity_unit",
            "practical_salinity_units",
            "practicalsalinityunits",
            "ppt",
            "g/kg",
            "gkg-1",
        ],
        1.0,
        0.0,
    ),
    (&["kg/kg", "kgkg-1"], 1e3, 0.0),
];
const CONDUCTIVITIES: &[Unit] = &[
    (
        &[
            "s/m",
            "sm-1",
            "s.m-1",
            "sm^-1",
            "sm**-1",
            "siemens/m",
            "siemens/meter",
            "siemensmeter-1",
            "siemensm-1",
            "mho/m",
            "mhos/m",
            "mhom-1",
        ],
        1.0,
        0.0,
    ),
    (
        &[
            "ms/cm",
            "mscm-1",
            "ms.cm-1",
            "mscm^-1",
            "mscm**-1",
            "mmho/cm",
            "mmhos/cm",
            "mmhocm-1",
            "millisiemens/cm",
            "millisiemens/centimeter",
            "millisiemenscm-1",
        ],
        0.1,
        0.0,
    ),
    (&["ms/m", "msm-1"], 1e-3, 0.0),
    (&["us/cm", "uscm-1", "\u{b5}s/cm", "microsiemens/cm"], 1e-4, 0.0),
];
const SPEEDS: &[Unit] = &[
    (&["m/s", "ms-1", "m.s-1", "ms^-1", "ms**-1", "meter/second", "meters/second"], 1.0, 0.0),
    (&["cm/s", "cms-1", "cm.s-1"], 0.01, 0.0),
    (&["mm/s", "mms-1"], 0.001, 0.0),
    (&["m/min"], 1.0 / 60.0, 0.0),
    (&["km/h", "kmh", "kmh-1"], 1.0 / 3.6, 0.0),
    (&["ft/s", "fts-1", "fps"], 0.3048, 0.0),
    (&["kn", "kt", "kts", "knot", "knots"], 1852.0 / 3600.0, 0.0),
];
const CHARGES: &[Unit] =
    &[(&["ah", "amp-hrs", "amphours", "a.h"], 1.0, 0.0), (&["mah"], 1e-3, 0.0), (&["c_"], 1.0 / 3600.0, 0.0)];
const VOLTAGES: &[Unit] = &[(&["v", "volt", "volts"], 1.0, 0.0), (&["mv"], 1e-3, 0.0)];
const POSITIONS: &[Unit] = &[(
    &["deg", "degree", "degrees", "degrees_north", "degrees_east", "degree_north", "degree_east", "lat", "lon"],
    1.0,
    0.0,
)];

fn units(channel: Channel) -> &'static [Unit] {
    match channel {
        Channel::Time => TIMES,
        Channel::Pressure => PRESSURES,
        Channel::Depth | Channel::BatteryPosition | Channel::PitchMass => LENGTHS,
        Channel::Pitch | Channel::Roll | Channel::RollMass | Channel::Heading | Channel::Rudder => ANGLES,
        Channel::Ballast => VOLUMES,
        Channel::Density => DENSITIES,
        Channel::Temperature => TEMPERATURES,
        Channel::Salinity => SALINITIES,
        Channel::Conductivity => CONDUCTIVITIES,
        Channel::Speed | Channel::CurrentEast | Channel::CurrentNorth => SPEEDS,
        Channel::Charge => CHARGES,
        Channel::Voltage => VOLTAGES,
        Channel::Latitude | Channel::Longitude => POSITIONS,
        Channel::Dive | Channel::MotorMoving | Channel::SinceMove => &[],
    }
}

/// Numbers that stand for a missing value in files that do not declare one, in whatever unit: no channel has them.
const FILLS: [f64; 13] = [
    -999.0,
    -999.25,
    -999.9,
    -999.99,
    -9999.0,
    -9999.25,
    -9999.9,
    -9999.99,
    -32_768.0,
    -99_999.0,
    -999_999.0,
    -9_999_999.0,
    -2_147_483_648.0,
];

/// As well, in what is no time, depth, count or conductivity.
const LARGE_FILLS: [f64; 4] = [9999.0, 9999.9, 99_999.0, 999_999.0];

/// Larger than any value of a channel \[any unit\]: 1e20, and the fill values of NetCDF.
const LARGEST: f64 = 1e15;

/// Whether a number as it stands in a file means that there is no value.
pub(super) fn is_fill(channel: Channel, value: f64) -> bool {
    let may_be_large = matches!(
        channel,
        Channel::Time | Channel::Pressure | Channel::Depth | Channel::Conductivity | Channel::Charge | Channel::Dive
    );
    FILLS.contains(&value)
        || (!may_be_large && LARGE_FILLS.contains(&value))
        || (channel != Channel::Time && value.abs() >= LARGEST)
}

/// Whether the channel is an angle of the vehicle.
pub(super) fn is_angle(channel: Channel) -> bool {
    matches!(channel, Channel::Pitch | Channel::Roll | Channel::RollMass | Channel::Heading | Channel::Rudder)
}

/// What a unit, as a file or a user writes it, means for a channel; nothing where it is not known.
pub(super) fn conversion(channel: Channel, unit: &str) -> Option<Conversion> {
    // `days since 1950-01-01`: both parts count. Blanks between the parts of a unit say nothing.
    let unit = unit.trim().to_lowercase();
    let (unit, epoch) = match unit.split_once(" since ") {
        Some((unit, epoch)) => (unit.trim(), Some(epoch)),
        None => (unit.as_str(), None),
    };
    let epoch_s = match epoch {
        Some(epoch) if channel == Channel::Time => epoch_s(epoch)?,
        _ => 0.0,
    };
    let plain: String = unit.chars().filter(|c| !c.is_whitespace()).collect();
    units(channel)
        .iter()
        .find(|(names, ..)| names.iter().any(|name| *name == plain || *name == unit))
        .map(|&(_, factor, offset)| Conversion { factor, offset: offset + epoch_s })
}

/// Returns the conversion that a column's name states where it is a known name of the channel with a unit behind it: `time_ms`,
/// `pressure_bar`, `ballast_m3`.
pub(super) fn unit_in_name(channel: Channel, name: &str) -> Option<Conversion> {
    let own = CHANNELS.iter().find(|info| info.channel == channel)?.name;
    let own = parts(own).find(|(_, unit)| spelled(channel, unit).is_some()).map(|(stem, _)| stem);
    let is_known =
        |stem: &str| names::known(channel).iter().copied().chain(own).any(|known| known.eq_ignore_ascii_case(stem));
    // A complete name of any channel keeps its own meaning: `roll_rad` is no roll mass.
    let mut stated = parts(name).filter(|(stem, _)| !names::is_known(name) && is_known(stem));
    stated.find_map(|(_, unit)| spelled(channel, unit))
}

/// Returns the conversion that the end of a column's name states, whatever stands before it: `speed_cm_s`, `u_dvl_m_s`,
/// `cond_mS_cm`.
pub(super) fn unit_at_end(channel: Channel, name: &str) -> Option<Conversion> {
    parts(name).find_map(|(_, unit)| spelled(channel, unit))
}

/// A unit as names spell it, where a quotient has no slash: `cm_s`, `kg_m3`.
fn spelled(channel: Channel, unit: &str) -> Option<Conversion> {
    conversion(channel, unit).or_else(|| conversion(channel, &unit.replacen('_', "/", 1)))
}

/// Whether a name, or the unit that a table states of it, is that of a mass: no volume of ballast follows from it without the
/// density of the water.
pub(super) fn is_mass(name: &str, stated: Option<&str>) -> bool {
    const MASSES: [&str; 6] = ["g", "gr", "gram", "grams", "kg", "kilograms"];
    let is_one = |unit: &str| MASSES.iter().any(|mass| unit.trim().eq_ignore_ascii_case(mass));
    stated.map_or_else(|| parts(name).any(|(_, unit)| is_one(unit)), is_one)
}

/// Splits a name at each place where its unit may begin.
fn parts(name: &str) -> impl Iterator<Item = (&str, &str)> {
    name.match_indices(['_', '-', ' ', '.']).map(|(at, _)| (&name[..at], &name[at + 1..]))
}

/// The units of a channel, the first spelling of each.
pub(super) fn known(channel: Channel) -> String {
    let names: Vec<&str> = units(channel).iter().map(|(names, ..)| names[0]).collect();
    names.join(", ")
}

/// The channel that a user or a table names, by its own name or by another of the contract's, and what that name says of
/// the unit: `pitch_deg` is the pitch, in degrees.
pub(super) fn named(name: &str) -> Option<(Channel, Conversion)> {
    CHANNELS.iter().find_map(|info| {
        if info.name == name {
            return Some((info.channel, Conversion::NONE));
        }
        let alias = info.aliases.iter().find(|(alias, _)| *alias == name)?;
        Some((info.channel, Conversion::by(alias.1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_as_files_write_them_are_known() {
        let near = |channel, unit: &str, x: f64, expected: f64| {
            let found = conversion(channel, unit).unwrap_or_else(|| panic!("{unit}")).convert(x);
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{unit}: {found}, {expected}");
        };
        near(Channel::Time, "seconds since 1970-1-1 00:00:00", 5.0, 5.0);
        near(Channel::Time, "nanoseconds since 1970-01-01", 5e9, 5.0);
        // Julian days as EGO counts them, days of the Modified Julian Date, and of a calendar that begins with year 0.
        near(Channel::Time, "days since 1950-01-01T00:00:00Z", 7305.0, 0.0);
        near(Channel::Time, "days since 1858-11-17", 40_587.5, 43_200.0);
        near(Channel::Time, "days since 0000-01-01 00:00:00", 719_528.0, 0.0);
        near(Channel::Time, "hours since 1900-01-01 00:00:0.0", 613_608.0, 0.0);
        near(Channel::Time, "seconds since 2000-01-01 02:00:00 +02:00", 1.0, 946_684_801.0);
        assert_eq!(conversion(Channel::Time, "seconds since the start"), None);
        near(Channel::Pitch, "degrees", 180.0, std::f64::consts::PI);
        near(Channel::Conductivity, "mS cm-1", 35.0, 3.5);
        near(Channel::Density, "g/cm3", 1.025, 1025.0);
        near(Channel::Density, "kg m-3", 1025.0, 1025.0);
        near(Channel::Temperature, "Kelvin", 283.15, 10.0);
        near(Channel::BatteryPosition, "in", 1.0, 0.0254);
        near(Channel::Speed, "cm/s", 25.0, 0.25);
        // 1 January 2000, 12:00.
        near(Channel::Time, "excel", 36_526.5, 946_728_000.0);
        near(Channel::Time, "matlab", 730_486.5, 946_728_000.0);
        near(Channel::Time, "julian", 2_451_545.0, 946_728_000.0);
        assert_eq!(conversion(Channel::Pitch, "fortnights"), None);
    }

    #[test]
    fn a_name_may_say_its_unit() {
        let factor = |channel, name| unit_in_name(channel, name).map(|conversion| conversion.factor);
        assert_eq!(factor(Channel::Time, "time_ms"), Some(1e-3));
        assert_eq!(factor(Channel::Pressure, "Pressure_bar"), Some(10.0));
        assert_eq!(factor(Channel::Ballast, "ballast_m3"), Some(1e6));
        assert_eq!(factor(Channel::Pitch, "pitch deg"), Some(std::f64::consts::PI / 180.0));
        assert_eq!(factor(Channel::RollMass, "roll_rad").or(factor(Channel::PitchMass, "pitch_m")), None);
        for name in ["time_of_day", "pressure_lag", "ballast", "pitch_offset_rad", "depth_max_m"] {
            assert!(
                [Channel::Time, Channel::Pressure, Channel::Ballast, Channel::Pitch, Channel::Depth]
                    .iter()
                    .all(|channel| unit_in_name(*channel, name).is_none()),
                "{name}"
            );
        }
    }

    #[test]
    fn the_end_of_a_chosen_name_says_its_unit() {
        let factor = |channel, name| unit_at_end(channel, name).map(|conversion| conversion.factor);
        assert_eq!(factor(Channel::Speed, "speed_cm_s"), Some(0.01));
        assert_eq!(factor(Channel::Speed, "U_dvl_m_s"), Some(1.0));
        assert_eq!(factor(Channel::Speed, "dvl speed kn"), Some(1852.0 / 3600.0));
        assert_eq!(factor(Channel::Pressure, "p_hull_bar"), Some(10.0));
        assert_eq!(factor(Channel::Conductivity, "cond_mS_cm"), Some(0.1));
        assert_eq!(factor(Channel::Density, "rho_kg_m3"), Some(1.0));
        assert_eq!(factor(Channel::Speed, "speed_dvl"), None);
        assert_eq!(unit_in_name(Channel::Speed, "speed_through_water_cm_s").map(|found| found.factor), Some(0.01));
    }

    #[test]
    fn a_fill_value_is_no_value() {
        assert!(is_mass("ballast_g", None) && is_mass("ballast", Some("kg")) && !is_mass("ballast_cc", None));
        for fill in [-9999.0, -999.0, -999.25, -32_768.0, 9999.0, 1e20, 9.969_209_968_386_869e36] {
            assert!(is_fill(Channel::Ballast, fill) && is_fill(Channel::Heading, fill), "{fill}");
        }
        for (channel, value) in [
            (Channel::Pressure, 9999.0),
            (Channel::Time, 9999.0),
            (Channel::Time, 1.7e18),
            (Channel::Ballast, -99.0),
            (Channel::Pitch, -24.0),
        ] {
            assert!(!is_fill(channel, value), "{value}");
        }
    }

    #[test]
    fn every_name_of_the_contract_names_its_channel_and_unit() {
        for info in CHANNELS {
            assert_eq!(named(info.name), Some((info.channel, Conversion::NONE)));
            for (alias, factor) in info.aliases {
                assert_eq!(named(alias), Some((info.channel, Conversion::by(*factor))));
            }
        }
        assert_eq!(named("pitch"), None);
    }
}
