//! What can be hidden in a log: one table of names, exact definitions and realistic sizes, and how a request for effects
//! is read and sized.
//!
//! [`TABLE`] defines every effect; `virtual-sea --list` prints it. Where each acts stands in [`crate::effects`].

use crate::random::{Part, Stream, between, sign, stream};
use crate::vehicle::Vehicle;
use std::f64::consts::TAU;
use std::fmt::Write;

/// What a drawn size is added to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Neutral {
    /// Without the effect the parameter is 0.
    Zero,
    /// Without the effect the parameter is 1: scales and ratios.
    One,
    /// Without the effect the parameter is the vehicle file's figure.
    Compressibility,
    /// Without the effect the parameter is the vehicle file's figure.
    Expansion,
    /// There is nothing to size.
    Nothing,
}

/// Which way a size may go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signs {
    /// Only up from the neutral value.
    Up,
    /// Up or down.
    Either,
}

/// How a glider is steered on which an effect shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turns {
    /// By its battery.
    ByRollMass,
    /// By its rudder.
    ByRudder,
}

/// One effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Name as the diagnosis gives it, or `uncatalogued-...` where it knows none.
    pub name: &'static str,
    /// Parameter that states its size, with its unit; empty where there is none.
    pub parameter: &'static str,
    /// What the parameter means, exactly.
    pub definition: &'static str,
    /// The value without the effect.
    pub neutral: Neutral,
    /// Smallest and largest departure from it that is drawn.
    pub drawn: (f64, f64),
    /// Which way it departs.
    pub signs: Signs,
}

impl Effect {
    /// Whether it needs equations of motion for roll, sideslip and yaw, and what then turns the glider: a roll mass or
    /// rudder.
    pub fn turns(&self) -> Option<Turns> {
        match self.name {
            "static_list" | "roll_mass_offset" | "yaw_asymmetry" | "roll_offset" => Some(Turns::ByRollMass),
            "rudder_offset" => Some(Turns::ByRudder),
            _ => None,
        }
    }

    /// Whether the diagnosis has a name for it.
    pub fn is_catalogued(&self) -> bool {
        !self.name.starts_with("uncatalogued-")
    }

    /// The effect of this name.
    pub fn named(name: &str) -> Option<&'static Effect> {
        TABLE.iter().find(|effect| effect.name == name)
    }
}

macro_rules! effect {
    ($name:literal, $parameter:literal, $neutral:ident, $signs:ident, $low:literal .. $high:literal, $definition:literal) => {
        Effect {
            name: $name,
            parameter: $parameter,
            definition: $definition,
            neutral: Neutral::$neutral,
            drawn: ($low, $high),
            signs: Signs::$signs,
        }
    };
}

/// Every effect. Time t counts from the first row of the log; P is gauge pressure; "read" is what the log says.
#[rustfmt::skip]
pub const TABLE: &[Effect] = &[
    effect!("ballast_offset", "ballast_offset_kg", Zero, Either, 0.04..0.10,
        "true mass = mass of the vehicle file + this; + = heavy"),
    effect!("hull_compressibility", "hull_compressibility_per_Pa", Compressibility, Either, 1.2e-10..2.4e-10,
        "the hull's eps itself, in place of the vehicle file's: V = V0 (1 - eps P + tau (T - T_ref))"),
    effect!("thermal_expansion", "hull_thermal_expansion_per_K", Expansion, Either, 2.5e-5..5.0e-5,
        "the hull's tau itself, in place of the vehicle file's"),
    effect!("ballast_scale", "ballast_scale", One, Either, 0.10..0.25, "true ballast volume = this x volume read"),
    effect!("pitch_offset", "pitch_offset_rad", Zero, Either, 0.020..0.050,
        "true pitch = pitch_scale x pitch read + this"),
    effect!("pitch_scale", "pitch_scale", One, Either, 0.11..0.18, "true pitch = this x pitch read + pitch_offset"),
    effect!("pressure_scale", "pressure_scale", One, Either, 0.06..0.12, "true pressure = this x pressure read"),
    effect!("pressure_lag", "pressure_lag_s", Zero, Up, 12.0..40.0,
        "pressure read follows the true one as d(read)/dt = (true - read)/this; other columns are not late"),
    effect!("drag_growth", "drag_growth_per_day", Zero, Up, 0.3..0.8, "CD x (1 + this x t in days)"),
    effect!("drag_step", "drag_step", Zero, Either, 0.15..0.35, "CD x (1 + this) from t = step_time_s on"),
    effect!("reynolds_drag", "drag_exponent", Zero, Either, 0.15..0.35,
        "b x (q/q0)^this, c as it is; q0 = dynamic pressure at 0.3 m/s in water of the reference density"),
    effect!("nonlinear_lift", "nonlinear_lift_per_rad2", Zero, Up, 80.0..160.0,
        "CL = a alpha + this x alpha |alpha|, CD as it is"),
    effect!("climb_dive_asymmetry", "climb_dive_drag_ratio", One, Either, 0.15..0.35,
        "CD x this while the glider rises through the water; descents keep theirs"),
    effect!("trapped_air", "trapped_air_cc", Zero, Up, 40.0..110.0, "volume + this x P0/(P0 + P), P0 = 101325 Pa"),
    effect!("leak", "leak_kg_per_hour", Zero, Up, 0.004..0.010, "mass + this x t in hours"),
    effect!("vertical_current", "vertical_current_m_s", Zero, Either, 0.012..0.030,
        "vertical velocity of the water, steady, + = down; it fades in the uppermost 10 m"),
    effect!("roll_drag", "roll_drag_per_rad2", Zero, Up, 2.0..5.0, "CD x (1 + this x roll^2), roll in rad"),
    effect!("rudder_drag", "rudder_drag_per_rad2", Zero, Up, 1.5..4.0, "CD x (1 + this x rudder^2), rudder in rad"),
    effect!("inertia", "", Nothing, Up, 0.0..0.0,
        "unsteady flight with added mass: always there, whether named or not"),
    effect!("density_at_zero_pressure", "", Nothing, Up, 0.0..0.0,
        "density column = rho(S, T, p = 0); temperature, salinity and pressure columns are right"),
    effect!("density_bias", "density_bias_kg_m3", Zero, Either, 0.6..1.8,
        "true density = density read + this; temperature, salinity and pressure columns are right"),
    effect!("uncatalogued-wing-stall", "stall_angle_rad", Zero, Up, 0.045..0.060,
        "beyond this angle of attack CL grows with 0.3 a instead of a, CD as it is"),
    effect!("uncatalogued-compass-pitch", "pitch_error_rad", Zero, Either, 0.020..0.045,
        "pitch read = true pitch + this x sin(heading)"),
    effect!("uncatalogued-battery-hysteresis", "backlash_m", Zero, Up, 0.002..0.005,
        "the moving mass lags its reading by half of this, against its last move; seen in the pitch balance only"),
    effect!("uncatalogued-sloughing", "patch_drag", Zero, Up, 0.3..0.6,
        "CD x (1 + this x phase), phase rising from 0 to 1 in regrowth_s, then torn off at once"),
    effect!("uncatalogued-tide", "tidal_velocity_m_s", Zero, Up, 0.012..0.025,
        "vertical velocity of the water this x cos(2 pi t / 12.42 h + phase); it fades in the uppermost 10 m"),
    effect!("uncatalogued-warm-ballast-reading", "reading_per_K", Zero, Either, 0.010..0.020,
        "ballast volume read = true x (1 + this x (T - 10 degrees C)), T that of the water"),
    effect!("uncatalogued-layer", "layer_velocity_m_s", Zero, Either, 0.015..0.030,
        "vertical velocity of the water within a layer between layer_top_m and layer_bottom_m, + = down"),
    effect!("lift_asymmetry", "climb_dive_lift_ratio", One, Either, 0.20..0.40,
        "CL x this while the glider rises through the water; descents keep theirs"),
    effect!("hull_creep", "hull_creep_per_Pa", Zero, Up, 2.0e-10..4.0e-10,
        "V = V0 (1 - eps P - this x Q + ...), dQ/dt = (P - Q)/creep_time_s, Q = 0 at the start"),
    effect!("late_expansion", "late_expansion_per_K", Zero, Up, 2.5e-5..5.0e-5,
        "V = V0 (1 + ... + this x (T' - T)), dT'/dt = (T - T')/expansion_time_s, T' = T at the start; no vehicle's whole expansion is less"),
    effect!("carried_water", "carried_water_m3", Zero, Up, 0.010..0.025,
        "volume of water within the hull; its temperature and salinity follow those around as dT'/dt = (T - T')/exchange_time_s"),
    effect!("pump_leakback", "pump_leakback_cc_per_hour", Zero, Up, 15.0..35.0,
        "true ballast volume = volume read - this x time in hours since the engine last moved"),
    effect!("conductivity_drift", "salinity_drift_per_day", Zero, Either, 0.6..1.5,
        "salinity read = true - this x t in days; the density column follows from it"),
    effect!("thermal_lag", "thermal_lag_s", Zero, Either, 3.0..8.0,
        "salinity computed from conductivity at the temperature of this time ago (from now, where negative) and the temperature of now"),
    effect!("clock_offset", "clock_offset_s", Zero, Either, 10.0..40.0,
        "attitude, rudder, ballast and battery columns of a row are those of this time before the row, water and pressure those of the row"),
    effect!("pressure_hysteresis", "pressure_hysteresis", Zero, Either, 0.002..0.004,
        "pressure read on the way up = true + this x 4 P (1 - P/Pm), Pm the largest of the dive"),
    // Outside the catalogue of the diagnosis; the largest size is three times the smallest, which is about what is relevant.
    effect!("uncatalogued-wing-flex", "lift_loss_per_Pa", Zero, Up, 0.004..0.012,
        "CL x (1 - this x dynamic pressure): wings that twist under their load"),
    effect!("uncatalogued-bearing-friction", "friction_N", Zero, Up, 0.03..0.09,
        "drag + this force, whatever the speed: a propeller at rest in its bearings"),
    effect!("uncatalogued-tether", "line_drag_per_100m", Zero, Up, 0.03..0.09,
        "CD x (1 + this x depth / 100 m): a line that reaches to the surface"),
    effect!("uncatalogued-burped-air", "burped_air_cc", Zero, Up, 40.0..120.0,
        "volume + this x P0/(P0 + P) on descents alone: air that leaves when the nose goes up"),
    effect!("uncatalogued-engine-backlash", "engine_backlash_cc", Zero, Up, 10.0..30.0,
        "true ballast volume = volume read - half of this after a move outwards, + half of it after one inwards"),
    effect!("uncatalogued-weak-pump", "missing_cc_per_100dbar", Zero, Up, 3.0..9.0,
        "true ballast volume = volume read - this x (pressure at the last move outwards) / 100 dbar, until the next one inwards"),
    effect!("uncatalogued-foam-crush", "foam_cc", Zero, Up, 8.0..24.0,
        "volume - this x (1 - exp(-P / 0.5 MPa)): foam that is soft at first"),
    effect!("uncatalogued-bottom-mud", "mud_kg", Zero, Up, 0.02..0.06,
        "mass + this where a descent ends, washed off with a time constant of 600 s"),
    effect!("uncatalogued-wing-loss", "lift_lost", Zero, Up, 0.15..0.45,
        "CL x (1 - this) from t = lift_lost_from_s on"),
    effect!("uncatalogued-swarm", "swarm_drag", Zero, Up, 0.15..0.45,
        "CD x (1 + this) between swarm_top_m and swarm_bottom_m"),
    effect!("uncatalogued-internal-tide", "internal_tide_m_s", Zero, Up, 0.004..0.012,
        "vertical velocity of the water this x sin(pi z / 400 m) cos(2 pi t / 12.42 h + phase), the water column heaved with it"),
    effect!("uncatalogued-pressure-zero", "zero_dbar_per_K", Zero, Either, 0.05..0.15,
        "pressure read = true + this x (T' - 10 degrees C), T' the water's temperature 60 s late"),
    effect!("uncatalogued-slow-flushing", "flushing_s", Zero, Up, 10.0..30.0,
        "temperature and salinity of the water in the cell, both late with this time constant"),
    effect!("uncatalogued-pitch-rounding", "pitch_step_rad", Zero, Up, 0.02..0.06,
        "pitch read rounded to multiples of this"),
    effect!("uncatalogued-clock-jitter", "clock_jitter", Zero, Up, 0.1..0.3,
        "time of a row + this x the mean step x a uniform number in -1 .. 1"),
    effect!("uncatalogued-slow-speed", "speed_lag_s", Zero, Up, 60.0..180.0,
        "speed read follows the true one as d(read)/dt = (true - read)/this"),
    effect!("uncatalogued-warm-pitch", "pitch_rad_per_K", Zero, Either, 0.0007..0.0021,
        "pitch read = true + this x (T' - 10 degrees C), T' the water's temperature 1800 s late"),
    effect!("speed_scale", "speed_scale", One, Either, 0.03..0.09, "speed read = this x true speed"),
    // Effects that turn the glider; with one of them roll, sideslip and yaw follow from equations of motion.
    effect!("static_list", "static_list_rad", Zero, Either, 0.07..0.12,
        "roll at rest with the roll mass at 0, + = starboard down: the centre of gravity is off the plane of symmetry"),
    effect!("rudder_offset", "rudder_offset_rad", Zero, Either, 0.045..0.08, "true rudder angle = angle read + this"),
    effect!("roll_mass_offset", "roll_mass_offset_rad", Zero, Either, 0.15..0.25,
        "true angle of the roll mass = angle read + this"),
    effect!("yaw_asymmetry", "yaw_asymmetry_m3", Zero, Either, 4e-4..9e-4,
        "a pod on one side: yawing moment = dynamic pressure x this, + = on the starboard side; drag area = |this| / 0.15 m"),
    effect!("roll_offset", "roll_offset_rad", Zero, Either, 0.06..0.10, "roll read = true roll + this"),
    // Last, since the stream of random numbers of an effect is that of its place.
    effect!("net_mass_step", "net_mass_step_kg", Zero, Either, 0.02..0.06, "mass + this from t = net_mass_step_time_s on"),
];

/// An effect that someone asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Which.
    pub effect: &'static Effect,
    /// Its parameter's value, drawn from the seed where absent.
    pub size: Option<f64>,
}

/// An effect with its size.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Which.
    pub effect: &'static Effect,
    /// Parameter names and values; the first is the size.
    pub parameters: Vec<(&'static str, f64)>,
}

/// Why a text is not a list of effects.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RequestError {
    /// No such name.
    #[error("no effect `{0}`; run `virtual-sea --list` for the names, or `none`")]
    Unknown(String),
    /// The size is no number, or the effect takes none.
    #[error("`{0}`: {1}")]
    Size(String, &'static str),
    /// Named twice.
    #[error("effect `{0}` named twice")]
    Twice(String),
}

/// Reads `NAME[=SIZE],...`; `none` is the empty list.
///
/// # Errors
/// An unknown name, a size that is no number or out of place, a name given twice.
pub fn parse_requests(text: &str) -> Result<Vec<Request>, RequestError> {
    let mut requests: Vec<Request> = Vec::new();
    for item in text.split(',').map(str::trim).filter(|item| !item.is_empty() && *item != "none") {
        let (name, size) = match item.split_once('=') {
            Some((name, size)) => (name.trim(), Some(size.trim())),
            None => (item, None),
        };
        let effect = Effect::named(name).ok_or_else(|| RequestError::Unknown(name.to_owned()))?;
        let size = match size {
            Some(_) if effect.neutral == Neutral::Nothing => {
                return Err(RequestError::Size(item.to_owned(), "this effect has no size"));
            }
            Some(size) => match size.parse::<f64>() {
                Ok(size) if size.is_finite() => Some(size),
                _ => return Err(RequestError::Size(item.to_owned(), "the size is not a finite number")),
            },
            None => None,
        };
        if requests.iter().any(|request| request.effect.name == name) {
            return Err(RequestError::Twice(name.to_owned()));
        }
        requests.push(Request { effect, size });
    }
    Ok(requests)
}

/// [`TABLE`] as Markdown.
pub fn markdown() -> String {
    let mut out =
        String::from("| effect | parameter | definition | drawn departure from neutral |\n|---|---|---|---|\n");
    for effect in TABLE {
        let (low, high) = effect.drawn;
        let sign = if effect.signs == Signs::Either { "+-" } else { "" };
        let drawn =
            if effect.neutral == Neutral::Nothing { String::new() } else { format!("{sign}{low:?} .. {high:?}") };
        let _ = writeln!(
            out,
            "| {} | {} | {} | {drawn} |",
            effect.name,
            effect.parameter,
            effect.definition.replace('|', "\\|")
        );
    }
    out
}

/// Sizes the effects that were asked for. Each has its own stream, so its size does not depend on its company.
pub fn draw(requests: &[Request], vehicle: &Vehicle, seed: u64, hours: f64) -> Vec<Drawn> {
    requests.iter().map(|request| draw_one(request, vehicle, seed, hours)).collect()
}

fn draw_one(request: &Request, vehicle: &Vehicle, seed: u64, hours: f64) -> Drawn {
    let effect = request.effect;
    let place = TABLE.iter().position(|entry| entry.name == effect.name).unwrap_or(TABLE.len());
    let random = &mut stream(seed, Part::Effect(place));
    let direction = match effect.signs {
        Signs::Up => 1.0,
        Signs::Either => sign(random),
    };
    let departure = direction * between(random, effect.drawn.0, effect.drawn.1);
    let neutral = neutral_value(effect.neutral, vehicle);
    // No hull grows under pressure, and none shrinks when it is warmed.
    let is_of_material = matches!(effect.neutral, Neutral::Compressibility | Neutral::Expansion);
    let departure = if is_of_material && neutral + departure < 0.0 { departure.abs() } else { departure };
    let size = request.size.unwrap_or(neutral + departure);
    let mut parameters = Vec::new();
    if effect.neutral != Neutral::Nothing {
        parameters.push((effect.parameter, size));
    }
    parameters.extend(companions(effect.name, random, hours * 3600.0));
    Drawn { effect, parameters }
}

fn neutral_value(neutral: Neutral, vehicle: &Vehicle) -> f64 {
    match neutral {
        Neutral::Zero | Neutral::Nothing => 0.0,
        Neutral::One => 1.0,
        Neutral::Compressibility => vehicle.compressibility_per_pa,
        Neutral::Expansion => vehicle.thermal_expansion_per_k,
    }
}

/// Further parameters of an effect beside its size.
fn companions(name: &str, random: &mut Stream, duration_s: f64) -> Vec<(&'static str, f64)> {
    match name {
        "hull_creep" => vec![("creep_time_s", 3600.0 * between(random, 1.0, 8.0))],
        "late_expansion" => vec![("expansion_time_s", 60.0 * between(random, 5.0, 40.0))],
        "carried_water" => vec![("exchange_time_s", 60.0 * between(random, 10.0, 90.0))],
        "drag_step" => vec![("step_time_s", (duration_s * between(random, 0.3, 0.7)).round())],
        "net_mass_step" => vec![("net_mass_step_time_s", (duration_s * between(random, 0.3, 0.7)).round())],
        "uncatalogued-sloughing" => vec![("regrowth_s", duration_s * between(random, 0.20, 0.35))],
        "uncatalogued-tide" => vec![("tidal_phase_rad", between(random, 0.0, TAU))],
        "uncatalogued-wing-loss" => vec![("lift_lost_from_s", (duration_s * between(random, 0.3, 0.7)).round())],
        "uncatalogued-swarm" => {
            let top_m = between(random, 30.0, 80.0);
            vec![("swarm_top_m", top_m), ("swarm_bottom_m", top_m + between(random, 20.0, 50.0))]
        }
        "uncatalogued-internal-tide" => vec![("internal_tide_phase_rad", between(random, 0.0, TAU))],
        "uncatalogued-layer" => {
            let top_m = between(random, 50.0, 90.0);
            vec![("layer_top_m", top_m), ("layer_bottom_m", top_m + between(random, 30.0, 60.0))]
        }
        _ => Vec::new(),
    }
}
