//! What can be hidden in a log: one table of names, definitions and realistic sizes, and the arithmetic of each.
//!
//! [`TABLE`] defines every effect; `virtual-sea --list` prints it. [`Hidden`] holds the effects of one log and is the
//! only place where they act, on the glider and the water or on what the instruments say.

use crate::ocean::Water;
use crate::random::{Part, Stream, between, sign, stream};
use crate::vehicle::{REFERENCE_DENSITY_KG_M3, Vehicle};
use std::f64::consts::TAU;
use std::fmt::Write;

/// The standard atmosphere, Pa.
const ATMOSPHERE_PA: f64 = 101_325.0;
/// Speed at which a drag exponent leaves b as it is, m/s.
const DRAG_REFERENCE_SPEED_M_S: f64 = 0.3;
/// Period of the principal lunar tide, s.
const TIDE_S: f64 = 12.4206 * 3600.0;

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
pub const TABLE: &[Effect] = &[
    effect!(
        "ballast_offset",
        "ballast_offset_kg",
        Zero,
        Either,
        0.04..0.10,
        "true mass = mass of the vehicle file + this; + = heavy"
    ),
    effect!(
        "hull_compressibility",
        "hull_compressibility_per_Pa",
        Compressibility,
        Either,
        1.2e-10..2.4e-10,
        "the hull's eps itself, in place of the vehicle file's: V = V0 (1 - eps P + tau (T - T_ref))"
    ),
    effect!(
        "thermal_expansion",
        "hull_thermal_expansion_per_K",
        Expansion,
        Either,
        2.5e-5..5.0e-5,
        "the hull's tau itself, in place of the vehicle file's"
    ),
    effect!("ballast_scale", "ballast_scale", One, Either, 0.10..0.25, "true ballast volume = this x volume read"),
    effect!(
        "pitch_offset",
        "pitch_offset_rad",
        Zero,
        Either,
        0.020..0.050,
        "true pitch = pitch_scale x pitch read + this"
    ),
    effect!("pitch_scale", "pitch_scale", One, Either, 0.11..0.18, "true pitch = this x pitch read + pitch_offset"),
    effect!("pressure_scale", "pressure_scale", One, Either, 0.06..0.12, "true pressure = this x pressure read"),
    effect!(
        "pressure_lag",
        "pressure_lag_s",
        Zero,
        Up,
        12.0..40.0,
        "pressure read follows the true one as d(read)/dt = (true - read)/this; other columns are not late"
    ),
    effect!("drag_growth", "drag_growth_per_day", Zero, Up, 0.3..0.8, "CD x (1 + this x t in days)"),
    effect!("drag_step", "drag_step", Zero, Either, 0.15..0.35, "CD x (1 + this) from t = step_time_s on"),
    effect!(
        "reynolds_drag",
        "drag_exponent",
        Zero,
        Either,
        0.15..0.35,
        "b x (q/q0)^this, c as it is; q0 = dynamic pressure at 0.3 m/s in water of the reference density"
    ),
    effect!(
        "nonlinear_lift",
        "nonlinear_lift_per_rad2",
        Zero,
        Up,
        80.0..160.0,
        "CL = a alpha + this x alpha |alpha|, CD as it is"
    ),
    effect!(
        "climb_dive_asymmetry",
        "climb_dive_drag_ratio",
        One,
        Either,
        0.15..0.35,
        "CD x this while the glider rises through the water; descents keep theirs"
    ),
    effect!("trapped_air", "trapped_air_cc", Zero, Up, 40.0..110.0, "volume + this x P0/(P0 + P), P0 = 101325 Pa"),
    effect!("leak", "leak_kg_per_hour", Zero, Up, 0.004..0.010, "mass + this x t in hours"),
    effect!(
        "vertical_current",
        "vertical_current_m_s",
        Zero,
        Either,
        0.012..0.030,
        "vertical velocity of the water, steady, + = down; it fades in the uppermost 10 m"
    ),
    effect!("roll_drag", "roll_drag_per_rad2", Zero, Up, 2.0..5.0, "CD x (1 + this x roll^2), roll in rad"),
    effect!("rudder_drag", "rudder_drag_per_rad2", Zero, Up, 1.5..4.0, "CD x (1 + this x rudder^2), rudder in rad"),
    effect!(
        "inertia",
        "",
        Nothing,
        Up,
        0.0..0.0,
        "unsteady flight with added mass: always there, whether named or not"
    ),
    effect!(
        "density_at_zero_pressure",
        "",
        Nothing,
        Up,
        0.0..0.0,
        "density column = rho(S, T, p = 0); temperature, salinity and pressure columns are right"
    ),
    effect!(
        "density_bias",
        "density_bias_kg_m3",
        Zero,
        Either,
        0.6..1.8,
        "true density = density read + this; temperature, salinity and pressure columns are right"
    ),
    effect!(
        "uncatalogued-wing-stall",
        "stall_angle_rad",
        Zero,
        Up,
        0.045..0.060,
        "beyond this angle of attack CL grows with 0.3 a instead of a, CD as it is"
    ),
    effect!(
        "uncatalogued-compass-pitch",
        "pitch_error_rad",
        Zero,
        Either,
        0.020..0.045,
        "pitch read = true pitch + this x sin(heading)"
    ),
    effect!(
        "uncatalogued-battery-hysteresis",
        "backlash_m",
        Zero,
        Up,
        0.002..0.005,
        "the moving mass lags its reading by half of this, against its last move; seen in the pitch balance only"
    ),
    effect!(
        "uncatalogued-sloughing",
        "patch_drag",
        Zero,
        Up,
        0.3..0.6,
        "CD x (1 + this x phase), phase rising from 0 to 1 in regrowth_s, then torn off at once"
    ),
    effect!(
        "uncatalogued-tide",
        "tidal_velocity_m_s",
        Zero,
        Up,
        0.012..0.025,
        "vertical velocity of the water this x cos(2 pi t / 12.42 h + phase); it fades in the uppermost 10 m"
    ),
    effect!(
        "uncatalogued-warm-ballast-reading",
        "reading_per_K",
        Zero,
        Either,
        0.010..0.020,
        "ballast volume read = true x (1 + this x (T - 10 degrees C)), T that of the water"
    ),
    effect!(
        "uncatalogued-layer",
        "layer_velocity_m_s",
        Zero,
        Either,
        0.015..0.030,
        "vertical velocity of the water within a layer between layer_top_m and layer_bottom_m, + = down"
    ),
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
    let size = request.size.unwrap_or(neutral_value(effect.neutral, vehicle) + departure);
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
        "drag_step" => vec![("step_time_s", (duration_s * between(random, 0.3, 0.7)).round())],
        "uncatalogued-sloughing" => vec![("regrowth_s", duration_s * between(random, 0.20, 0.35))],
        "uncatalogued-tide" => vec![("tidal_phase_rad", between(random, 0.0, TAU))],
        "uncatalogued-layer" => {
            let top_m = between(random, 50.0, 90.0);
            vec![("layer_top_m", top_m), ("layer_bottom_m", top_m + between(random, 30.0, 60.0))]
        }
        _ => Vec::new(),
    }
}

/// The effects of one log, every one that is absent at its neutral value.
#[derive(Debug, Clone, PartialEq)]
pub struct Hidden {
    ballast_offset_kg: f64,
    leak_kg_per_hour: f64,
    compressibility_per_pa: f64,
    thermal_expansion_per_k: f64,
    trapped_air_cc: f64,
    ballast_scale: f64,
    pitch_offset_rad: f64,
    pitch_scale: f64,
    pressure_scale: f64,
    pressure_lag_s: f64,
    drag_growth_per_day: f64,
    drag_step: f64,
    step_time_s: f64,
    drag_exponent: f64,
    nonlinear_lift_per_rad2: f64,
    climb_dive_drag_ratio: f64,
    roll_drag_per_rad2: f64,
    rudder_drag_per_rad2: f64,
    vertical_current_m_s: f64,
    density_bias_kg_m3: f64,
    density_at_zero_pressure: bool,
    stall_angle_rad: f64,
    compass_pitch_rad: f64,
    backlash_m: f64,
    patch_drag: f64,
    regrowth_s: f64,
    tidal_velocity_m_s: f64,
    tidal_phase_rad: f64,
    reading_per_k: f64,
    layer_velocity_m_s: f64,
    layer_top_m: f64,
    layer_bottom_m: f64,
}

/// How the glider meets the water, as far as drag and lift depend on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow {
    /// Time since the first row, s.
    pub time_s: f64,
    /// Angle of attack, rad.
    pub angle_rad: f64,
    /// Density of the water, kg/m3.
    pub density_kg_m3: f64,
    /// Dynamic pressure, Pa.
    pub dynamic_pressure_pa: f64,
    /// Whether the glider rises through the water.
    pub rising: bool,
    /// Roll, rad.
    pub roll_rad: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
}

impl Hidden {
    /// Nothing hidden: the vehicle is what its file says.
    pub fn nothing(vehicle: &Vehicle) -> Self {
        Self {
            ballast_offset_kg: 0.0,
            leak_kg_per_hour: 0.0,
            compressibility_per_pa: vehicle.compressibility_per_pa,
            thermal_expansion_per_k: vehicle.thermal_expansion_per_k,
            trapped_air_cc: 0.0,
            ballast_scale: 1.0,
            pitch_offset_rad: 0.0,
            pitch_scale: 1.0,
            pressure_scale: 1.0,
            pressure_lag_s: 0.0,
            drag_growth_per_day: 0.0,
            drag_step: 0.0,
            step_time_s: f64::INFINITY,
            drag_exponent: 0.0,
            nonlinear_lift_per_rad2: 0.0,
            climb_dive_drag_ratio: 1.0,
            roll_drag_per_rad2: 0.0,
            rudder_drag_per_rad2: 0.0,
            vertical_current_m_s: 0.0,
            density_bias_kg_m3: 0.0,
            density_at_zero_pressure: false,
            stall_angle_rad: f64::INFINITY,
            compass_pitch_rad: 0.0,
            backlash_m: 0.0,
            patch_drag: 0.0,
            regrowth_s: f64::INFINITY,
            tidal_velocity_m_s: 0.0,
            tidal_phase_rad: 0.0,
            reading_per_k: 0.0,
            layer_velocity_m_s: 0.0,
            layer_top_m: 0.0,
            layer_bottom_m: 0.0,
        }
    }

    /// The drawn effects on a vehicle.
    pub fn of(drawn: &[Drawn], vehicle: &Vehicle) -> Self {
        let mut hidden = Self::nothing(vehicle);
        for effect in drawn {
            hidden.density_at_zero_pressure |= effect.effect.name == "density_at_zero_pressure";
            for &(parameter, value) in &effect.parameters {
                if let Some(slot) = hidden.slot(parameter) {
                    *slot = value;
                }
            }
        }
        hidden
    }

    fn slot(&mut self, parameter: &str) -> Option<&mut f64> {
        Some(match parameter {
            "ballast_offset_kg" => &mut self.ballast_offset_kg,
            "leak_kg_per_hour" => &mut self.leak_kg_per_hour,
            "hull_compressibility_per_Pa" => &mut self.compressibility_per_pa,
            "hull_thermal_expansion_per_K" => &mut self.thermal_expansion_per_k,
            "trapped_air_cc" => &mut self.trapped_air_cc,
            "ballast_scale" => &mut self.ballast_scale,
            "pitch_offset_rad" => &mut self.pitch_offset_rad,
            "pitch_scale" => &mut self.pitch_scale,
            "pressure_scale" => &mut self.pressure_scale,
            "pressure_lag_s" => &mut self.pressure_lag_s,
            "drag_growth_per_day" => &mut self.drag_growth_per_day,
            "drag_step" => &mut self.drag_step,
            "step_time_s" => &mut self.step_time_s,
            "drag_exponent" => &mut self.drag_exponent,
            "nonlinear_lift_per_rad2" => &mut self.nonlinear_lift_per_rad2,
            "climb_dive_drag_ratio" => &mut self.climb_dive_drag_ratio,
            "roll_drag_per_rad2" => &mut self.roll_drag_per_rad2,
            "rudder_drag_per_rad2" => &mut self.rudder_drag_per_rad2,
            "vertical_current_m_s" => &mut self.vertical_current_m_s,
            "density_bias_kg_m3" => &mut self.density_bias_kg_m3,
            "stall_angle_rad" => &mut self.stall_angle_rad,
            "pitch_error_rad" => &mut self.compass_pitch_rad,
            "backlash_m" => &mut self.backlash_m,
            "patch_drag" => &mut self.patch_drag,
            "regrowth_s" => &mut self.regrowth_s,
            "tidal_velocity_m_s" => &mut self.tidal_velocity_m_s,
            "tidal_phase_rad" => &mut self.tidal_phase_rad,
            "reading_per_K" => &mut self.reading_per_k,
            "layer_velocity_m_s" => &mut self.layer_velocity_m_s,
            "layer_top_m" => &mut self.layer_top_m,
            "layer_bottom_m" => &mut self.layer_bottom_m,
            _ => return None,
        })
    }
}

/// On the glider.
impl Hidden {
    /// True mass, kg, of a vehicle whose file says `mass_kg`.
    pub fn mass_kg(&self, mass_kg: f64, time_s: f64) -> f64 {
        mass_kg + self.ballast_offset_kg + self.leak_kg_per_hour * time_s / 3600.0
    }

    /// True displaced volume, m3, with the engine reading `engine_cc`.
    pub fn volume_m3(&self, vehicle: &Vehicle, pressure_pa: f64, temperature_c: f64, engine_cc: f64) -> f64 {
        let hull = Vehicle {
            compressibility_per_pa: self.compressibility_per_pa,
            thermal_expansion_per_k: self.thermal_expansion_per_k,
            ..*vehicle
        };
        let air_cc = self.trapped_air_cc * ATMOSPHERE_PA / (ATMOSPHERE_PA + pressure_pa);
        hull.hull_volume_m3(pressure_pa, temperature_c) + 1e-6 * (self.ballast_scale * engine_cc + air_cc)
    }

    /// Lift coefficient of an attached flow.
    pub fn lift_coefficient(&self, vehicle: &Vehicle, angle_rad: f64) -> f64 {
        let stalled = (angle_rad.abs() - self.stall_angle_rad).max(0.0);
        vehicle.a_per_rad * (angle_rad - 0.7 * stalled.copysign(angle_rad))
            + self.nonlinear_lift_per_rad2 * angle_rad * angle_rad.abs()
    }

    /// Drag coefficient of an attached flow.
    pub fn drag_coefficient(&self, vehicle: &Vehicle, flow: &Flow) -> f64 {
        let reference_pa = 0.5 * REFERENCE_DENSITY_KG_M3 * DRAG_REFERENCE_SPEED_M_S * DRAG_REFERENCE_SPEED_M_S;
        let reynolds = match self.drag_exponent {
            0.0 => 1.0,
            s => (flow.dynamic_pressure_pa.max(0.5) / reference_pa).powf(s),
        };
        let growth = 1.0 + self.drag_growth_per_day * flow.time_s / 86_400.0;
        let step = if flow.time_s >= self.step_time_s { 1.0 + self.drag_step } else { 1.0 };
        let leg = if flow.rising { self.climb_dive_drag_ratio } else { 1.0 };
        let roll = 1.0 + self.roll_drag_per_rad2 * flow.roll_rad * flow.roll_rad;
        let rudder = 1.0 + self.rudder_drag_per_rad2 * flow.rudder_rad * flow.rudder_rad;
        let patch = 1.0 + self.patch_drag * (flow.time_s / self.regrowth_s).fract();
        let plain = vehicle.b * reynolds + vehicle.c_per_rad2 * flow.angle_rad * flow.angle_rad;
        plain * growth * step * leg * roll * rudder * patch
    }

    /// True position of the moving mass where it reads `reading_m` and last moved in direction `moved` (+1, -1).
    pub fn moving_mass_m(&self, reading_m: f64, moved: f64) -> f64 {
        reading_m - 0.5 * self.backlash_m * moved
    }

    /// Vertical velocity of the water beside its waves, m/s, + = down.
    pub fn sinking_water_m_s(&self, depth_m: f64, time_s: f64) -> f64 {
        let tide = self.tidal_velocity_m_s * (TAU * time_s / TIDE_S + self.tidal_phase_rad).cos();
        let inside =
            smooth_step((depth_m - self.layer_top_m) / 5.0) * smooth_step((self.layer_bottom_m - depth_m) / 5.0);
        (self.vertical_current_m_s + tide) * (depth_m / 5.0).tanh().max(0.0) + self.layer_velocity_m_s * inside
    }
}

/// On what the instruments say.
impl Hidden {
    /// Pitch that a perfect instrument would read, rad.
    pub fn pitch_reading(&self, pitch_rad: f64, heading_rad: f64) -> f64 {
        (pitch_rad - self.pitch_offset_rad) / self.pitch_scale + self.compass_pitch_rad * heading_rad.sin()
    }

    /// Ballast volume that the engine reads when its own count is `engine_cc`.
    pub fn ballast_reading_cc(&self, engine_cc: f64, temperature_c: f64) -> f64 {
        engine_cc * (1.0 + self.reading_per_k * (temperature_c - 10.0))
    }

    /// Pressure that a prompt instrument would read, dbar.
    pub fn pressure_reading_dbar(&self, pressure_dbar: f64) -> f64 {
        pressure_dbar / self.pressure_scale
    }

    /// Share of the way that the pressure reading goes towards its goal in a step.
    pub fn pressure_catch_up(&self, step_s: f64) -> f64 {
        if self.pressure_lag_s > 0.0 { 1.0 - (-step_s / self.pressure_lag_s).exp() } else { 1.0 }
    }

    /// Density column, kg/m3, from water and pressure as the instruments read them.
    pub fn density_reading(&self, read: &Water, pressure_read_dbar: f64) -> f64 {
        let pressure_dbar = if self.density_at_zero_pressure { 0.0 } else { pressure_read_dbar };
        crate::ocean::density_eos80(read.salinity_psu, read.temperature_c, pressure_dbar) - self.density_bias_kg_m3
    }
}

fn smooth_step(x: f64) -> f64 {
    0.5 * (1.0 + x.tanh())
}
