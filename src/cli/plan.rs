//! `glidepolar plan`: energy, dives, days and distance on one battery; and its constants from battery counters.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::glide::USUALLY_TOWED_TO_DEG;
use super::plan_page::{self, Calibrated, Planned};
use super::plan_tables::{read_dives, read_strokes};
use super::table::incomplete;
use super::{Changes, CliError, Output, inputs, vehicle_input, warn, water_density};
use crate::dynamics::{Parameters, Surroundings};
use crate::estimate::Estimate;
use crate::glide::{Attitude, at_pitch};
use crate::plan::calibrate::{DiveFit, PumpFit, Stroke, fit_dives, fit_pump};
use crate::plan::plausible::contradictions;
use crate::plan::{Ask, Dive, Outlook, PlanError, Sensor, UNSTATED_SPEED_ERROR, outlook, states_polar_errors};
use crate::report::InputFile;
use crate::simulate::mission::LegOrder;
use crate::vehicle::Vehicle;

/// Plans: energy per dive, dives, days, distance, what is left, and what one more sensor costs
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar plan seaglider --battery-Wh 2700 --depth-m 1000 --pitch-deg 20\n  \
    glidepolar plan my-glider.toml --battery-Ah 120 --battery-V 15 --depth-m 180 --days 21 --dives-per-surfacing 7\n  \
    glidepolar plan my-glider.toml --depth-m 180 --sensor-W 0.5 --sensor-drag-m2 0.0015      with and without\n  \
    glidepolar plan seaglider --moves motor_moves.csv --dives dives.csv --write calibrated.toml\n  \
    glidepolar plan seaglider --battery-Wh 2700 --depth-m 1000 --out plan/                       as a page\n\n\
    Distances are through the water: currents come on top. Intervals (95 %) hold the [uncertainty] of the vehicle file\n\
    and the model error. --moves and --dives calibrate pump, hotel and surfacing from battery counters: tables with the\n\
    columns dive, depth_m, vbd_ad_start, vbd_ad_end, vbd_secs, vbd_A, vbd_V and dive, duration_s, VBD_CNV_cc_per_count,\n\
    ah24_cum_Ah, ah24_min_V, ah10_cum_Ah, ah10_min_V, as Seaglider's dive files have them.")]
pub struct Arguments {
    /// Vehicle file or name of a built-in vehicle
    vehicle: String,
    /// Charge of the battery; needs a voltage [A.h]
    #[arg(long = "battery-Ah", value_name = "Q", conflicts_with = "battery_wh", allow_negative_numbers = true)]
    battery_ah: Option<f64>,
    /// Energy of the battery; default: the vehicle's [W.h]
    #[arg(long = "battery-Wh", value_name = "E", allow_negative_numbers = true)]
    battery_wh: Option<f64>,
    /// Voltage of the battery; default: the vehicle's [V]
    #[arg(long = "battery-V", value_name = "U", allow_negative_numbers = true)]
    battery_v: Option<f64>,
    /// Depth of the dives [m]
    #[arg(long, value_name = "Z", required_unless_present = "moves", allow_negative_numbers = true)]
    depth_m: Option<f64>,
    /// End of the voyage; default: when the battery is empty [d]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    days: Option<f64>,
    /// Pitch of both legs, down and up [deg]
    #[arg(long, value_name = "T", default_value_t = 25.0, allow_negative_numbers = true)]
    pitch_deg: f64,
    /// Ballast volume on descents; default: half of the smallest, as pilots fly to save energy [cm3]
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    ballast_down_cc: Option<f64>,
    /// Ballast volume on ascents; default: half of the largest [cm3]
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    ballast_up_cc: Option<f64>,
    /// Ballast volume at the surface; default: as on ascents [cm3]
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    surface_ballast_cc: Option<f64>,
    /// Dives from one surfacing to the next
    #[arg(long, value_name = "N", default_value_t = 1.0, allow_negative_numbers = true)]
    dives_per_surfacing: f64,
    /// Stay at the surface [min]
    #[arg(long, value_name = "T", default_value_t = 10.0, allow_negative_numbers = true)]
    stay_min: f64,
    /// Moves of the moving mass in one dive
    #[arg(long, value_name = "N", default_value_t = 4.0, allow_negative_numbers = true)]
    pitch_moves: f64,
    /// Water density at the surface; default: the vehicle's reference [kg/m3]
    #[arg(long, value_name = "RHO", allow_negative_numbers = true)]
    density: Option<f64>,
    /// Standard error that the energy account itself makes, per cent of a dive's energy
    #[arg(long, value_name = "P", default_value_t = 5.0, allow_negative_numbers = true)]
    model_error_percent: f64,
    /// One more sensor: its power [W]
    #[arg(long = "sensor-W", value_name = "W", default_value_t = 0.0, allow_negative_numbers = true)]
    sensor_w: f64,
    /// One more sensor: its drag area, drag coefficient times area [m2]
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true)]
    sensor_drag_m2: f64,
    /// Calibrate: strokes of the pump (CSV)
    #[arg(long, value_name = "FILE", requires = "dives")]
    moves: Option<PathBuf>,
    /// Calibrate: battery counters dive by dive (CSV)
    #[arg(long, value_name = "FILE", requires = "moves")]
    dives: Option<PathBuf>,
    /// Calibrate: write the vehicle with its new constants to FILE
    #[arg(long, value_name = "FILE", requires = "moves")]
    write: Option<PathBuf>,
    /// Write report.html and its figures to DIR
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    changes: Changes,
    #[command(flatten)]
    output: Output,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let inputs = inputs(arguments.moves.iter().chain(&arguments.dives), Some(&arguments.vehicle));
    arguments.output.begin(&inputs, &[("--write", arguments.write.as_deref()), ("--out", arguments.out.as_deref())])?;
    let mut vehicle = arguments.changes.load(&arguments.vehicle)?;
    let calibration = calibrate(arguments, &mut vehicle)?;
    let plan = match arguments.depth_m {
        None => None,
        Some(depth_m) => Some(plan(arguments, &vehicle, depth_m)?),
    };
    if let Some(out) = &arguments.out {
        let planned = plan.as_ref().map(|plan| Planned {
            ask: &plan.ask,
            without: &plan.outlook,
            with_sensor: plan.with_sensor.as_ref(),
        });
        let calibrated =
            calibration.as_ref().map(|c| Calibrated { pump: &c.pump, dives: &c.dives, strokes: &c.strokes });
        let mut page = plan_page::page(&vehicle, planned.as_ref(), calibrated.as_ref());
        page = all_warnings(calibration.as_ref(), plan.as_ref()).fold(page, |page, text| page.warning(text.clone()));
        page = page.input(vehicle_input(&arguments.vehicle)?);
        for file in arguments.moves.iter().chain(&arguments.dives) {
            page = page.input(InputFile::read(file)?);
        }
        page.write(arguments.output.folder(out)?)?;
    }
    let report = PlanReport { schema: "glidepolar.plan/1", vehicle: vehicle.name.clone(), calibration, plan };
    if arguments.output.shows_tables() {
        report.print();
    }
    warn(all_warnings(report.calibration.as_ref(), report.plan.as_ref()));
    arguments.output.write_json(&report)
}

/// Warnings about the calibration, then about the plan.
fn all_warnings<'a>(calibration: Option<&'a Calibration>, plan: Option<&'a Plan>) -> impl Iterator<Item = &'a String> {
    let of_plan = plan.into_iter().flat_map(|plan| &plan.warnings);
    calibration.into_iter().flat_map(|calibration| &calibration.warnings).chain(of_plan)
}

fn calibrate(arguments: &Arguments, vehicle: &mut Vehicle) -> Result<Option<Calibration>, CliError> {
    let (Some(moves), Some(dives)) = (&arguments.moves, &arguments.dives) else {
        return Ok(None);
    };
    let table = read_dives(dives)?;
    let (strokes, without) = read_strokes(moves, table.cc_per_count)?;
    warn(incomplete(dives, table.incomplete).into_iter().chain(incomplete(moves, without)));
    let failed = |error: crate::plan::calibrate::CalibrationError| CliError::Failed(error.to_string());
    let pump = fit_pump(&strokes).map_err(failed)?;
    let dives = fit_dives(&strokes, &table.dives).map_err(failed)?;
    let warnings = contradictions(vehicle, &pump, &dives);
    let factor = dives.pump_factor.value;
    for (path, estimate, factor) in [
        ("energy.pump_J_per_dbar_cc", &pump.pump_J_per_dbar_cc, factor),
        ("energy.pump_J_per_cc", &pump.pump_J_per_cc, factor),
        ("energy.hotel_W", &dives.hotel_W, 1.0),
        ("energy.surfacing_J", &dives.surfacing_J, 1.0),
    ] {
        vehicle.set(path, estimate.value * factor)?;
        vehicle.set(&format!("uncertainty.{path}"), estimate.se * factor)?;
    }
    if let Some(path) = &arguments.write {
        arguments.output.write(path, vehicle.to_toml().as_bytes())?;
    }
    Ok(Some(Calibration { pump, dives, strokes, warnings }))
}

/// Share of the ballast engine that a dive uses where nothing else is said. A pump costs as the volume, speed comes as its
/// root: nobody flies a long voyage on the whole engine, which is there for dense water and emergencies.
const USUAL_STROKE: f64 = 0.5;

fn plan(arguments: &Arguments, vehicle: &Vehicle, depth_m: f64) -> Result<Plan, CliError> {
    let a = arguments;
    let above_zero = [
        ("--depth-m", depth_m),
        ("--pitch-deg", a.pitch_deg),
        ("--dives-per-surfacing", a.dives_per_surfacing),
        ("--days", a.days.unwrap_or(1.0)),
    ];
    if let Some((name, value)) = above_zero.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
        return Err(CliError::Usage(format!("{name} {value}: expected a number above zero")));
    }
    let not_below = [
        ("--sensor-W", a.sensor_w),
        ("--sensor-drag-m2", a.sensor_drag_m2),
        ("--stay-min", a.stay_min),
        ("--pitch-moves", a.pitch_moves),
        ("--model-error-percent", a.model_error_percent),
    ];
    if let Some((name, value)) = not_below.iter().find(|(_, value)| !(*value >= 0.0 && value.is_finite())) {
        return Err(CliError::Usage(format!("{name} {value}: expected a number not below zero")));
    }
    let battery_J = battery_J(a, vehicle)?;
    let parameters = vehicle.parameters()?;
    let down_m3 = a.ballast_down_cc.map_or(USUAL_STROKE * parameters.ballast_min_m3, |cc| cc * 1e-6);
    let up_m3 = a.ballast_up_cc.map_or(USUAL_STROKE * parameters.ballast_max_m3, |cc| cc * 1e-6);
    let surface_m3 = a.surface_ballast_cc.map_or(up_m3, |cc| cc * 1e-6);
    let engine_m3 = parameters.ballast_min_m3..=parameters.ballast_max_m3;
    // Of what the engine cannot hold a plan would say nothing: the model stops at its limits.
    let orders = [("--ballast-down-cc", down_m3), ("--ballast-up-cc", up_m3), ("--surface-ballast-cc", surface_m3)];
    if let Some((name, m3)) = orders.iter().find(|(_, m3)| !engine_m3.contains(m3)) {
        return Err(CliError::Usage(format!(
            "{name} {:.1}: the ballast engine of {} goes from {:.0} to {:.0} cc",
            m3 * 1e6,
            vehicle.name,
            engine_m3.start() * 1e6,
            engine_m3.end() * 1e6
        )));
    }
    let pitch_rad = a.pitch_deg.to_radians();
    let ask = Ask {
        dive: Dive {
            depth_m,
            descent: LegOrder { pitch_rad: -pitch_rad, ballast_m3: down_m3 },
            ascent: LegOrder { pitch_rad, ballast_m3: up_m3 },
            surface_ballast_m3: surface_m3,
            dives_per_surfacing: a.dives_per_surfacing.max(1.0),
            stay_s: a.stay_min * 60.0,
            pitch_moves: a.pitch_moves,
            surface_density_kg_m3: water_density(a.density)?.unwrap_or(parameters.reference_density_kg_m3),
        },
        battery_J,
        days: a.days,
        model_error: a.model_error_percent / 100.0,
        sensor: Sensor::default(),
    };
    let sensor = Sensor { drag_area_m2: a.sensor_drag_m2, power_W: a.sensor_w };
    let with_sensor =
        if sensor == Sensor::default() { None } else { Some(outlook(vehicle, &Ask { sensor, ..ask.clone() })?) };
    let without = outlook(vehicle, &ask)?;
    let sensor_costs_days = with_sensor.as_ref().map(|with| without.days.value - with.days.value);
    let ask = Ask { sensor, ..ask };
    let mut warnings = Vec::new();
    if let Some(days) = a.days.filter(|days| without.days.value < days - 1e-6) {
        warnings.push(format!(
            "the battery is empty after {:.1} of the {days} days that were asked for",
            without.days.value
        ));
    }
    if !states_polar_errors(vehicle) {
        warnings.push(format!(
            "{} states no errors of its polar: {:.0} % of the speed are taken for one standard error",
            vehicle.name,
            100.0 * UNSTATED_SPEED_ERROR
        ));
    }
    warnings.extend(shallow(&parameters, &ask.dive));
    Ok(Plan { ask, battery_Wh: battery_J / 3600.0, outlook: without, with_sensor, sensor_costs_days, warnings })
}

/// What to say of a glide whose angle of attack is larger than its pitch, or than hulls are towed at: no log of a glider shows
/// one, and the coefficients are extrapolated.
fn shallow(p: &Parameters<f64>, dive: &Dive) -> Option<String> {
    let water = Surroundings {
        density_kg_m3: dive.surface_density_kg_m3,
        pressure_Pa: 0.0,
        temperature_C: p.reference_temperature_C,
        time_s: 0.0,
    };
    let order = dive.descent;
    let attitude = Attitude { pitch_rad: order.pitch_rad, net_mass_kg: p.net_mass_kg(order.ballast_m3, &water) };
    let alpha_deg = at_pitch(p, &water, attitude).ok()?.angle_of_attack_rad.to_degrees().abs();
    let pitch_deg = order.pitch_rad.to_degrees().abs();
    (alpha_deg > pitch_deg.min(USUALLY_TOWED_TO_DEG)).then(|| {
        format!(
            "at a pitch of {pitch_deg:.1} deg the angle of attack is {alpha_deg:.1} deg, {}: no measured glide is as flat, lift and drag are extrapolated, and the glider may stall; gliders fly 12 to 50 deg",
            if alpha_deg > pitch_deg { "more than the pitch" } else { "more than hulls are towed at" }
        )
    })
}

fn battery_J(a: &Arguments, vehicle: &Vehicle) -> Result<f64, CliError> {
    let given = [("--battery-Ah", a.battery_ah), ("--battery-Wh", a.battery_wh), ("--battery-V", a.battery_v)];
    for (name, value) in given.into_iter().filter_map(|(name, value)| Some((name, value?))) {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a number above zero")));
        }
    }
    let volts = a.battery_v.or_else(|| vehicle.get("energy.battery_V"));
    let watt_hours = match (a.battery_ah, volts) {
        (Some(_), None) => {
            let problem = "--battery-Ah needs the voltage: add --battery-V or `energy.battery_V` in the vehicle file";
            return Err(CliError::Usage(problem.to_owned()));
        }
        (Some(charge), Some(volts)) => Some(charge * volts),
        (None, _) => a.battery_wh.or_else(|| vehicle.get("energy.battery_Wh")),
    };
    watt_hours.filter(|energy| *energy > 0.0 && energy.is_finite()).map(|energy| energy * 3600.0).ok_or_else(|| {
        CliError::Usage(
            "no battery: add --battery-Wh, --battery-Ah or `energy.battery_Wh` in the vehicle file".to_owned(),
        )
    })
}

impl From<PlanError> for CliError {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::MissingKeys(error) => error.into(),
            PlanError::Glide(_) | PlanError::NoConsumption => CliError::Failed(error.to_string()),
        }
    }
}

/// The result as JSON gives it.
#[derive(Debug, Serialize)]
struct PlanReport {
    schema: &'static str,
    vehicle: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    calibration: Option<Calibration>,
    #[serde(skip_serializing_if = "Option::is_none")]
    plan: Option<Plan>,
}

#[derive(Debug, Serialize)]
struct Calibration {
    pump: PumpFit,
    dives: DiveFit,
    #[serde(skip)]
    strokes: Vec<Stroke>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Plan {
    #[serde(skip)]
    ask: Ask,
    battery_Wh: f64,
    #[serde(flatten)]
    outlook: Outlook,
    #[serde(skip_serializing_if = "Option::is_none")]
    with_sensor: Option<Outlook>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensor_costs_days: Option<f64>,
    warnings: Vec<String>,
}

impl PlanReport {
    fn print(&self) {
        if let Some(Calibration { pump, dives, .. }) = &self.calibration {
            println!("{}: {} strokes of the pump, {} dives", self.vehicle, pump.strokes, dives.dives);
            line("pump, per pressure", &pump.pump_J_per_dbar_cc, 5);
            line("pump, per volume", &pump.pump_J_per_cc, 2);
            println!(
                "  {:<24} {:>10.1} % of the mean stroke; efficiency {:.0} %",
                "residual of a stroke",
                100.0 * pump.relative_rms,
                100.0 * pump.efficiency
            );
            line("battery over pump", &dives.pump_factor, 3);
            line("hotel", &dives.hotel_W, 3);
            line("each dive besides", &dives.surfacing_J, 0);
            println!(
                "  {:<24} {:>10.1} % (the mean of the other dives: {:.1} %)",
                "charge, dive left out",
                100.0 * dives.charge_error_left_out,
                100.0 * dives.charge_error_of_the_mean
            );
        }
        if let Some(plan) = &self.plan {
            println!("{}, {:.0} Wh (values with 95 % intervals)", self.vehicle, plan.battery_Wh);
            let dive = &plan.ask.dive;
            println!(
                "dives to {:.0} m, pitch {:.1} deg down and {:.1} deg up, ballast {:.0} cc down and {:.0} cc up",
                dive.depth_m,
                dive.descent.pitch_rad.to_degrees(),
                dive.ascent.pitch_rad.to_degrees(),
                dive.descent.ballast_m3 * 1e6,
                dive.ascent.ballast_m3 * 1e6
            );
            let Outlook { dive_duration_h, dive_distance_km, dive_energy_kJ, .. } = &plan.outlook;
            line("a dive lasts", dive_duration_h, 2);
            line("takes the glider", dive_distance_km, 2);
            line("and draws", dive_energy_kJ, 2);
            println!(
                "  {:<24} {:>10.2} kJ pump, {:.2} hotel, {:.2} steering, {:.2} surfacing",
                "of which",
                plan.outlook.dive_pump_kJ.value,
                plan.outlook.dive_hotel_kJ.value,
                plan.outlook.dive_steering_kJ.value,
                plan.outlook.dive_surfacing_kJ.value
            );
            voyage(&plan.outlook);
            if let (Some(with), Some(days)) = (&plan.with_sensor, plan.sensor_costs_days) {
                println!("with the sensor ({days:.1} days less)");
                voyage(with);
            }
        }
    }
}

fn voyage(outlook: &Outlook) {
    line("days", &outlook.days, 1);
    line("dives", &outlook.dives, 0);
    line("pumpings", &outlook.pumpings, 0);
    line("distance", &outlook.distance_km, 0);
    line("battery left", &outlook.battery_left_percent, 0);
}

fn line(name: &str, estimate: &Estimate, decimals: usize) {
    let [low, high] = estimate.ci95;
    let unit = if estimate.unit == "1" { "" } else { &estimate.unit };
    // What follows from what was asked for, as the days of a voyage, has no error: only rounding.
    if high - low <= 1e-9 * estimate.value.abs() {
        println!("  {name:<24} {:>10.decimals$} {unit}", estimate.value);
        return;
    }
    println!("  {name:<24} {:>10.decimals$} {unit} ({low:.decimals$} to {high:.decimals$})", estimate.value);
}
