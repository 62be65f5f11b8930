//! The mechanisms by which a real glider, or a real tank, departs from the baseline: one table.
//!
//! A mechanism is one entry: its name, its physics in a line with the source, its parameters, where it should be seen.
//! At sea its parameters are rows of [`PARAMETERS`](crate::PARAMETERS), so that fit, simulation, vehicle file
//! and FMU all read the same number in the same equation. To add one: a row there, its term in the equations, an entry
//! here. Knows no data.

use crate::parameter_index;

/// Where a mechanism enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Enters {
    /// The motion itself: the FMU flies differently.
    Motion,
    /// The instruments: the glider flies the same, its log reads differently.
    Instruments,
    /// A check of the data against themselves; no parameter to fit.
    Consistency,
}

/// The sizes that a mechanism is found with, in the unit of its first parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// How far from neutral it is usually found, a standard deviation: generous, to keep a fit from sizes that nobody has seen.
    pub prior_sd: f64,
    /// The least size that nature has. A fit may go below it, and is then refused: held there, it would leave its place to
    /// something else that resembles it as little.
    pub least: f64,
    /// Whether nothing bounds it: what accumulates, what is carried or caught, what is late, what the water does. Others are
    /// bounded by design and calibration.
    pub is_open_ended: bool,
    /// How far from neutral it may lie at most, whatever its prior says.
    pub furthest: f64,
    /// Whether it is a ratio that may as well be taken the other way round: one leg to the other, what is to what is read. Its least is then
    /// the reciprocal of its most.
    pub is_ratio: bool,
}

impl Size {
    const fn no_less_than(self, least: f64) -> Size {
        Size { least, ..self }
    }

    const fn no_further_than(self, furthest: f64) -> Size {
        Size { furthest, ..self }
    }
}

const fn bounded(prior_sd: f64) -> Size {
    Size { prior_sd, least: f64::NEG_INFINITY, is_open_ended: false, furthest: f64::INFINITY, is_ratio: false }
}

const fn ratio(prior_sd: f64) -> Size {
    Size { is_ratio: true, ..bounded(prior_sd) }
}

const fn open_ended(prior_sd: f64) -> Size {
    Size { is_open_ended: true, ..bounded(prior_sd) }
}

/// Of what has no parameter to fit.
const NO_SIZE: Size = bounded(0.0);

/// One mechanism at sea.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanism {
    /// Name, as the diagnosis gives it.
    pub name: &'static str,
    /// The physics in a line.
    pub physics: &'static str,
    /// Who describes it.
    pub source: &'static str,
    /// Its parameters, rows of the table of parameters; the first is its size.
    pub parameters: &'static [&'static str],
    /// Which sizes it is found with.
    pub size: Size,
    /// Where it enters.
    pub enters: Enters,
    /// In which data it shows.
    pub regime: &'static str,
}

macro_rules! mechanism {
    ($name:literal, $enters:ident, [$($parameter:literal),*], $size:expr, $physics:literal, $source:literal, $regime:literal) => {
        Mechanism { name: $name, physics: $physics, source: $source, parameters: &[$($parameter),*], size: $size, enters: Enters::$enters, regime: $regime }
    };
}

/// The mechanisms at sea.
pub const AT_SEA: &[Mechanism] = &[
    mechanism!(
        "ballast_offset",
        Motion,
        ["ballast_offset_kg"],
        bounded(0.2),
        "The glider is heavier or lighter than its masses and volumes say",
        "Williams, Bachmayer, deYoung 2007",
        "both legs, with opposite sign"
    ),
    mechanism!(
        "hull_compressibility",
        Motion,
        ["hull_compressibility_per_Pa"],
        // Hulls lie between a rigid one and one as soft as sea water, 4.4e-10 1/Pa; rubber and foam add to it.
        bounded(5e-10).no_less_than(0.0).no_further_than(7.5e-10),
        "The hull loses volume with pressure",
        "Merckelbach et al. 2010",
        "grows with depth"
    ),
    mechanism!(
        "thermal_expansion",
        Motion,
        ["hull_thermal_expansion_per_K"],
        bounded(1e-4).no_less_than(0.0),
        "The hull gains volume with temperature",
        "Seaglider basestation",
        "across a thermocline"
    ),
    mechanism!(
        "ballast_scale",
        Motion,
        ["ballast_scale"],
        ratio(0.15),
        "The buoyancy engine moves more or less than it reads",
        "calibration of the engine",
        "grows with the ballast volume"
    ),
    mechanism!(
        "pitch_offset",
        Instruments,
        ["pitch_offset_rad"],
        // A millimetre or two over the length of an attitude module, 50 mm, with which it is mounted in the hull.
        bounded(0.03),
        "The attitude sensor is mounted askew",
        "mounting of the attitude sensor",
        "shallow glides most, opposite on the two legs"
    ),
    mechanism!(
        "pitch_scale",
        Instruments,
        ["pitch_scale"],
        ratio(0.15),
        "The attitude sensor reads angles too large or too small",
        "Merckelbach et al. 2019",
        "steep glides most, alike on the two legs"
    ),
    mechanism!(
        "pressure_scale",
        Instruments,
        ["pressure_scale"],
        ratio(0.1),
        "The pressure sensor reads too much or too little",
        "calibration of the pressure sensor",
        "in proportion to vertical velocity"
    ),
    mechanism!(
        "speed_scale",
        Instruments,
        ["speed_scale"],
        // Acoustic speeds go with the angle at which the sensor is mounted and the speed of sound that is set: some per cent.
        ratio(0.1),
        "The measured speed reads too much or too little",
        "calibration of the speed sensor",
        "in proportion to speed"
    ),
    mechanism!(
        "pressure_lag",
        Instruments,
        ["pressure_lag_s"],
        open_ended(30.0),
        "The pressure reading follows the pressure late, as a first-order lag",
        "filters in the instrument",
        "after inflections"
    ),
    mechanism!(
        "drag_growth",
        Motion,
        ["drag_growth_per_day"],
        open_ended(1.0).no_less_than(0.0),
        "Fouling: drag grows in proportion to time",
        "Seaglider basestation",
        "grows through the log"
    ),
    mechanism!(
        "drag_step",
        Motion,
        ["drag_step", "step_time_s"],
        open_ended(0.5),
        "Something added, caught or lost: drag jumps at one time",
        "Williams, Bachmayer, deYoung 2007",
        "after one moment"
    ),
    mechanism!(
        "net_mass_step",
        Motion,
        ["net_mass_step_kg", "net_mass_step_time_s"],
        // An instrument or a fishing line weighs tens of grams to some hundred in water.
        open_ended(0.1),
        "Something with weight is lost or caught: the net mass steps at one time",
        "conservation of mass",
        "after one moment, opposite on the two legs"
    ),
    mechanism!(
        "reynolds_drag",
        Motion,
        ["drag_exponent"],
        bounded(0.3),
        "Friction: b varies with a power of the dynamic pressure",
        "Seaglider basestation",
        "with speed"
    ),
    mechanism!(
        "nonlinear_lift",
        Motion,
        ["nonlinear_lift_per_rad2"],
        bounded(150.0).no_less_than(0.0),
        "Crossflow lift, in proportion to alpha |alpha|",
        "Allen and Perkins 1951",
        "large angles of attack"
    ),
    mechanism!(
        "climb_dive_asymmetry",
        Motion,
        ["climb_dive_drag_ratio"],
        ratio(0.5),
        "The drag differs between ascents and descents",
        "Williams, Bachmayer, deYoung 2007",
        "one leg against the other"
    ),
    mechanism!(
        "trapped_air",
        Motion,
        ["trapped_air_cc"],
        open_ended(150.0).no_less_than(0.0),
        "Air carried down is compressed by Boyle's law",
        "ideal gas",
        "the first tens of metres"
    ),
    mechanism!(
        "leak",
        Motion,
        ["leak_kg_per_hour"],
        // Water does not leave a leak.
        open_ended(0.02).no_less_than(0.0),
        "Water taken in at a steady rate",
        "conservation of mass",
        "grows through the log, opposite on the two legs"
    ),
    mechanism!(
        "lift_asymmetry",
        Motion,
        ["climb_dive_lift_ratio"],
        // The legs of slocum-049, 4.7 and 4.0 1/rad (Williams, Bachmayer, deYoung 2007), differ by a seventh; twice that.
        ratio(0.3),
        "The lift slope differs between ascents and descents",
        "Williams, Bachmayer, deYoung 2007: lift by leg",
        "one leg against the other, at large angles of attack"
    ),
    mechanism!(
        "hull_creep",
        Motion,
        ["hull_creep_per_Pa", "creep_time_s"],
        // Viscoelastic parts give way no more than the whole hull does at once.
        open_ended(5e-10).no_less_than(0.0),
        "The hull goes on losing volume under pressure for hours, and regains it late (standard linear solid)",
        "viscoelasticity of composites and syntactic foam",
        "deeper and later; the legs of one dive differ"
    ),
    mechanism!(
        "late_expansion",
        Motion,
        ["late_expansion_per_K", "expansion_time_s"],
        // Between nothing and all of what an aluminium hull expands, 7e-5/K: an rms of 7e-5 over the root of three.
        bounded(4e-5).no_less_than(0.0),
        "The inside of the hull takes the water's temperature slowly, and a part of the expansion comes late",
        "conduction of heat into a hull and what it holds, its slowest part",
        "after a thermocline, opposite on the two legs"
    ),
    mechanism!(
        "carried_water",
        Motion,
        ["carried_water_m3", "exchange_time_s"],
        // Some litres in a Slocum; the fairing of a Seaglider, 1.8 m by 0.3 m, has room for 20 L beside the hull.
        open_ended(0.01).no_less_than(0.0),
        "Water in flooded spaces keeps the density of where it was taken in, and exchanges slowly",
        "first-order exchange",
        "after a thermocline, opposite on the two legs"
    ),
    mechanism!(
        "pump_leakback",
        Motion,
        ["pump_leakback_cc_per_hour"],
        // A leak that empties a usual stroke of 200 cc within a leg of some hours would be noticed.
        open_ended(20.0).no_less_than(0.0),
        "Oil leaks back past the pump after it has stopped, unseen by the volume's reading",
        "conservation of volume",
        "grows along each leg since the pump ran"
    ),
    mechanism!(
        "conductivity_drift",
        Instruments,
        ["salinity_drift_per_day"],
        // Fouled cells drift by hundredths to some tenths a day, in a bloom by more. Salinity itself shows it where it was
        // measured.
        open_ended(1.0),
        "The conductivity cell drifts: an error of salinity that grows with time",
        "fouling of conductivity cells",
        "grows through the log, opposite on the two legs"
    ),
    mechanism!(
        "thermal_lag",
        Instruments,
        ["thermal_lag_s"],
        // Amplitude times time constant of unpumped cells: 0.1 to 0.3 times 5 to 30 s (Garau et al. 2011).
        open_ended(3.0),
        "Cell and thermistor do not feel the same temperature at the same time: salinity spikes across a thermocline",
        "Lueck and Picklo 1990; Garau et al. 2011",
        "within a thermocline, opposite on the two legs"
    ),
    mechanism!(
        "clock_offset",
        Instruments,
        ["clock_offset_s"],
        // Clocks of flight and science computers are set at each surfacing; half a minute is much.
        open_ended(30.0),
        "The clock of the attitude is late against that of the pressure",
        "two computers, two clocks",
        "where the pitch changes"
    ),
    mechanism!(
        "pressure_hysteresis",
        Instruments,
        ["pressure_hysteresis"],
        // Makers of strain gauges state 0.1 % of the range, hysteresis included: 0.2 % of a dive that uses half of it, and 1 % of one that
        // uses a tenth. More is no hysteresis but a broken gauge.
        open_ended(0.002).no_further_than(0.01),
        "The pressure sensor reads more on the way up than on the way down",
        "hysteresis of strain-gauge transducers",
        "ascents, opposite above and below the middle of the dive"
    ),
    mechanism!(
        "vertical_current",
        Motion,
        ["vertical_current_m_s"],
        // A current of half a metre per second over a slope of 1 in 25 rises by 2 cm/s; more does not last for a log.
        open_ended(0.02),
        "The water itself rises or sinks steadily",
        "kinematics",
        "adds to vertical velocity, alike on the two legs"
    ),
    mechanism!(
        "roll_drag",
        Motion,
        ["roll_drag_per_rad2"],
        // On a course the roll is some degrees: at 0.05 rad this is 0.05, a quarter of a usual drag coefficient.
        open_ended(20.0).no_less_than(0.0),
        "A rolled glider has more drag",
        "tilted lift, sideslip",
        "in turns"
    ),
    mechanism!(
        "rudder_drag",
        Motion,
        ["rudder_drag_per_rad2"],
        // As of the roll.
        open_ended(20.0).no_less_than(0.0),
        "A deflected rudder has drag",
        "Williams, Bachmayer, deYoung 2007",
        "while steering"
    ),
    mechanism!(
        "inertia",
        Motion,
        [],
        NO_SIZE,
        "Unsteady flight: the glider and its added mass take time to change speed",
        "Leonard and Graver 2001",
        "near inflections"
    ),
    mechanism!(
        "shear",
        Motion,
        [],
        NO_SIZE,
        "Water whose velocity changes with depth accelerates the glider that passes through it",
        "Thomasson and Woolsey 2013",
        "within sheared layers, opposite on the two legs"
    ),
    mechanism!(
        "density_at_zero_pressure",
        Consistency,
        [],
        NO_SIZE,
        "The log's density was evaluated at p = 0, not in situ",
        "TEOS-10",
        "grows with depth"
    ),
    mechanism!(
        "density_bias",
        Motion,
        ["density_bias_kg_m3"],
        bounded(0.5),
        "The conductivity sensor reads a wrong density",
        "fouled or uncalibrated conductivity cell",
        "both legs, with opposite sign"
    ),
];

/// The mechanisms that turn or lean a glider. Their parameters are figures of the vehicle file's tables for three dimensions, no
/// rows of [`PARAMETERS`](crate::PARAMETERS): the vertical plane knows none of them, and the turn rate and the roll show them.
pub const LATERAL: &[Mechanism] = &[
    mechanism!(
        "static_list",
        Motion,
        ["static_list_rad"],
        bounded(0.1),
        "The centre of gravity is off the plane of symmetry: the glider leans, slips and turns",
        "Zhang et al. 2013",
        "roll; turn rate opposite on the two legs"
    ),
    mechanism!(
        "rudder_offset",
        Motion,
        ["rudder_offset_rad"],
        bounded(0.1),
        "The rudder stands at another angle than it reads",
        "zero of the rudder's sensor, a bent rudder",
        "turn rate alike on the two legs; the rudder that holds a course"
    ),
    mechanism!(
        "roll_mass_offset",
        Motion,
        ["roll_mass_offset_rad"],
        bounded(0.3),
        "The roll mass stands at another angle than it reads",
        "roll centres of the Seaglider basestation",
        "roll; a list but for large angles of the roll mass"
    ),
    mechanism!(
        "yaw_asymmetry",
        Motion,
        ["yaw_asymmetry_rad_per_m"],
        bounded(0.03),
        "Drag on one side, as of a pod, turns the glider",
        "tank tests of a glider with a CTD on its side",
        "turn rate alike on the two legs"
    ),
    mechanism!(
        "roll_offset",
        Instruments,
        ["roll_offset_rad"],
        bounded(0.05),
        "The attitude sensor is mounted askew in roll",
        "mounting of the attitude sensor",
        "roll that turns nothing"
    ),
];

/// The mechanism of this name.
pub fn at_sea(name: &str) -> Option<&'static Mechanism> {
    AT_SEA.iter().chain(LATERAL).find(|mechanism| mechanism.name == name)
}

/// Whether a vehicle file may have this parameter among its mechanisms: one of a mechanism, or of the empirical table.
pub fn is_of_vehicle(parameter: &str) -> bool {
    vehicle_parameters().any(|known| known == parameter)
}

/// The mechanism to which a parameter belongs.
pub fn of_parameter(parameter: &str) -> Option<&'static Mechanism> {
    AT_SEA.iter().find(|mechanism| mechanism.parameters.contains(&parameter))
}

/// The names of all mechanism parameters, as `[mechanisms]` in a vehicle file takes them.
pub fn vehicle_parameters() -> impl Iterator<Item = &'static str> {
    AT_SEA.iter().flat_map(|mechanism| mechanism.parameters.iter().copied()).chain(crate::empirical::PARAMETERS)
}

/// The row of the table of parameters that gives the size of a mechanism, where it has one.
pub fn size_parameter(mechanism: &Mechanism) -> Option<usize> {
    mechanism.parameters.first().and_then(|name| parameter_index(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PARAMETERS, Parameters};

    #[test]
    fn every_parameter_of_a_mechanism_is_a_row_and_is_without_effect_by_default() {
        let mut defaults = Parameters::default();
        for mechanism in AT_SEA {
            for name in mechanism.parameters {
                let index = parameter_index(name).unwrap_or_else(|| panic!("{name} is no parameter"));
                let neutral = if ["scale", "ratio"].iter().any(|word| name.contains(word)) { 1.0 } else { 0.0 };
                assert_eq!(*defaults.at(index), neutral, "{}", PARAMETERS[index].name);
            }
        }
    }
}
