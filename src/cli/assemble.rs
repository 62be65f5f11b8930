//! `glidepolar assemble`: bare hull, wing, tail, fin and sensor become a vehicle.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{CliError, Output, inputs, warn};
use crate::assemble::{Buildup, Effect, Figure, Lateral, Look, Parts, Pod, Surface, Term, build_up, effect};
use crate::dynamics::{Parameters, Surroundings};
use crate::estimate::Estimate;
use crate::hull_tests::{ReducedHull, Reduction};
use crate::input::{nearest, printable};
use crate::output::{Replace, write_whole};
use crate::plan::{Ask, Dive, PlanError, Sensor, outlook};
use crate::simulate::mission::LegOrder;
use crate::vehicle::Vehicle;
use crate::water::TankWater;

/// A vehicle from a towed hull, a wing, a tail, a fin; and what one external sensor changes
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar assemble tank_out/fits.json --hull LDR8.5 --wing span_m=1.01,chord_m=0.12,sweep_deg=43,aft_m=0.95 \\\n      \
        --fin span_m=0.25,chord_m=0.12,sweep_deg=30,aft_m=1.75 -o vehicle.toml\n  \
    glidepolar assemble tank_out/fits.json --hull LDR8.5 --wing ... --fin ... \\\n      \
        --sensor drag_area_m2=0.002,drag_area_se_m2=0.0005,aft_m=1.0,starboard_m=-0.15,below_m=0.05,power_W=0.2\n\n\
    Surfaces: span_m, chord_m, aft_m (quarter chord aft of the nose); optional sweep_deg, thickness (over chord),\n\
    efficiency (Oswald). The fin's span is from the hull's axis to its tip. Sensor: drag_area_m2 or diameter_m with\n\
    drag_coefficient (default 0.4, a rounded body; on the sensor's frontal area), drag_area_se_m2 (default 30 %), aft_m,\n\
    starboard_m (negative to port), below_m, power_W. Masses, actuators and battery come from --base.")]
pub struct Arguments {
    /// Reduced hull tests, as `tank-reduce` writes them
    fits: PathBuf,
    /// Name of the hull in them
    #[arg(long, value_name = "ID")]
    hull: String,
    /// Wing, as KEY=VALUE,KEY=VALUE...
    #[arg(long, value_name = "KEYS")]
    wing: Option<String>,
    /// Horizontal tail, likewise
    #[arg(long, value_name = "KEYS")]
    tail: Option<String>,
    /// Vertical fin with the rudder, likewise
    #[arg(long, value_name = "KEYS")]
    fin: Option<String>,
    /// External sensor, likewise: answers before and after
    #[arg(long, value_name = "KEYS")]
    sensor: Option<String>,
    /// Vehicle that lends masses, actuators and battery
    #[arg(long, value_name = "VEHICLE", default_value = "slocum-049")]
    base: String,
    /// Write the vehicle to FILE
    #[arg(short = 'o', long = "out-file", value_name = "FILE")]
    out_file: Option<PathBuf>,
    /// Glide speed at which friction is taken [m/s]
    #[arg(long, value_name = "V", default_value_t = 0.35, allow_negative_numbers = true)]
    speed_m_s: f64,
    /// Speed at which the hull was towed: takes its drag to the glide speed [m/s]
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    tow_speed_m_s: Option<f64>,
    /// Water temperature [degC]
    #[arg(long, value_name = "T", default_value_t = 10.0, allow_negative_numbers = true)]
    temperature_c: f64,
    /// Chord of the rudder over chord of the fin
    #[arg(long, value_name = "R", default_value_t = 0.4, allow_negative_numbers = true)]
    rudder_chord: f64,
    /// Pitch of the glides before and after the sensor [deg]
    #[arg(long, value_name = "T", default_value_t = 25.0, allow_negative_numbers = true)]
    pitch_deg: f64,
    /// Net mass of the descent, and of the ascent with the other sign [kg]
    #[arg(long, value_name = "M", default_value_t = 0.22, allow_negative_numbers = true)]
    net_mass_kg: f64,
    /// Depth of the dives for the days of endurance [m]
    #[arg(long, value_name = "Z", default_value_t = 180.0, allow_negative_numbers = true)]
    depth_m: f64,
    /// Battery for the days of endurance; default: the base vehicle's [W.h]
    #[arg(long = "battery-Wh", value_name = "E", allow_negative_numbers = true)]
    battery_wh: Option<f64>,
    #[command(flatten)]
    output: Output,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let a = arguments;
    a.output.begin(&inputs([&a.fits], Some(&a.base)), &[("-o", a.out_file.as_deref())])?;
    for (name, value) in [
        ("--speed-m-s", a.speed_m_s),
        ("--tow-speed-m-s", a.tow_speed_m_s.unwrap_or(1.0)),
        ("--pitch-deg", a.pitch_deg),
        ("--net-mass-kg", a.net_mass_kg),
        ("--depth-m", a.depth_m),
        ("--rudder-chord", a.rudder_chord),
        ("--battery-Wh", a.battery_wh.unwrap_or(1.0)),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a number above zero")));
        }
    }
    let reduction = Reduction::load(&a.fits)?;
    let hull = reduction.hull(&a.hull).ok_or_else(|| unknown_hull(a, &reduction))?;
    let base = Vehicle::load(&a.base)?;
    let surface = |name: &str, keys: &Option<String>| -> Result<Option<Surface>, CliError> {
        keys.as_ref().map(|keys| read_surface(name, keys)).transpose()
    };
    let density_kg_m3 = base.get("mass.reference_density_kg_m3").unwrap_or(1025.0);
    let parts = Parts {
        hull,
        wing: surface("--wing", &a.wing)?,
        tail: surface("--tail", &a.tail)?,
        fin: surface("--fin", &a.fin)?,
        speed_m_s: a.speed_m_s,
        tow_speed_m_s: a.tow_speed_m_s,
        density_kg_m3,
        kinematic_viscosity_m2_s: TankWater::Sea.kinematic_viscosity_m2_s(a.temperature_c),
        volume_m3: hull.geometry.volume_m3.or(base.get("mass.displaced_volume_m3")).unwrap_or(0.0),
    };
    let build = build_up(&parts).map_err(|error| CliError::Failed(error.to_string()))?;
    let vehicle = vehicle(a, base, &parts, &build)?;
    if let Some(path) = &a.out_file {
        let replace = if a.output.force { Replace::Any } else { Replace::Never };
        write_whole(path, vehicle.to_toml().as_bytes(), replace)?;
    }
    let sensor = a.sensor.as_ref().map(|keys| answer(a, &vehicle, &parts, &read_pod(keys)?)).transpose()?;
    let (is_warning, pitch) = build.pitch.sentence(a.speed_m_s);
    if is_warning {
        warn([&pitch]);
    }
    let report = AssembleReport { schema: "glidepolar.assemble/1", vehicle: vehicle.name.clone(), build, sensor };
    if a.output.shows_tables() {
        report.print();
        if !is_warning {
            println!("  {pitch}");
        }
    }
    a.output.write_json(&report)
}

fn unknown_hull(a: &Arguments, reduction: &Reduction) -> CliError {
    let ids: Vec<&str> = reduction.hulls.iter().map(|hull: &ReducedHull| hull.id.as_str()).collect();
    let names = ids.iter().map(|id| printable(id)).collect::<Vec<_>>().join(", ");
    let near = nearest(&a.hull, ids.iter().copied()).map(|near| format!(" (did you mean {}?)", printable(near)));
    CliError::Usage(format!(
        "{} has no hull {}{}; its hulls are: {names}",
        a.fits.display(),
        printable(&a.hull),
        near.unwrap_or_default()
    ))
}

/// The base vehicle with the hydrodynamics of the build-up.
fn vehicle(a: &Arguments, base: Vehicle, parts: &Parts<'_>, build: &Buildup) -> Result<Vehicle, CliError> {
    let mut vehicle = base;
    let geometry = &parts.hull.geometry;
    let total = &build.total;
    let moving_kg = vehicle.get("mass.moving_mass_kg").unwrap_or(0.0);
    let fixed_kg = vehicle.get("mass.mass_kg").unwrap_or(0.0) - moving_kg;
    // A homogeneous spheroid: what is fixed fills the hull evenly.
    let own_inertia = fixed_kg * (geometry.loa_m.powi(2) + geometry.diameter_m.powi(2)) / 20.0;
    let inertia = total.added_pitch_inertia_kg_m2;
    let inertia = Figure { value: inertia.value + own_inertia, se: inertia.se.hypot(0.3 * own_inertia) };
    let exact = |value: f64| Figure { value, se: 0.0 };
    let mut figures = vec![
        ("geometry.frontal_area_m2", exact(geometry.frontal_area_m2())),
        ("geometry.length_m", exact(geometry.loa_m)),
        ("geometry.diameter_m", exact(geometry.diameter_m)),
        ("geometry.cb_aft_of_nose_m", exact(geometry.cb_m)),
        ("hydro.a_per_rad", total.a_per_rad),
        ("hydro.b", total.b),
        ("hydro.c_per_rad2", total.c_per_rad2),
        ("hydro.d_per_rad", total.d_per_rad),
        ("hydro.pitch_damping", exact(0.0)),
        ("hydro.pitch_damping_quadratic", total.pitch_damping_quadratic),
        ("hydro.pitch_damping_CMq", total.pitch_damping_CMq),
        ("added_mass.m1_kg", total.m1_kg),
        ("added_mass.m3_kg", total.m3_kg),
        ("added_mass.pitch_inertia_kg_m2", inertia),
    ];
    let crossflow = parts.hull.extended.as_ref().and_then(|extended| extended.nonlinear_lift_per_rad2.as_ref());
    figures.extend(crossflow.map(|k| ("mechanisms.nonlinear_lift_per_rad2", Figure { value: k.value, se: k.se })));
    figures.extend(parts.wing.map(|wing| ("geometry.wing_span_m", exact(wing.span_m))));
    // Legs that were measured apart belong to the base vehicle's own hull and wing.
    for leg in ["descent", "ascent"] {
        for name in ["a_per_rad", "b", "c_per_rad2", "d_per_rad"] {
            vehicle.clear(&format!("hydro.{leg}.{name}"));
        }
    }
    for (path, figure) in figures {
        // The comment there was about another figure.
        vehicle.clear(path);
        vehicle.set(path, figure.value)?;
        if figure.se > 0.0 {
            vehicle.set(&format!("uncertainty.{path}"), figure.se)?;
        }
    }
    let source = format!(
        "Assembled by glidepolar: hull {} of {}, {}; masses, actuators and battery of {}",
        parts.hull.id,
        a.fits.display(),
        build.terms.iter().map(|term| term.part).collect::<Vec<_>>().join(" + "),
        a.base
    );
    let name = format!("{} assembled", parts.hull.id);
    vehicle.describe(&name, &source);
    Ok(vehicle)
}

/// The paper's own question.
fn answer(a: &Arguments, vehicle: &Vehicle, parts: &Parts<'_>, pod: &Pod) -> Result<Answer, CliError> {
    let parameters = vehicle.parameters()?;
    let uncertain: Vec<Parameters<f64>> = vehicle
        .uncertainty
        .iter()
        .filter_map(|(path, se)| {
            let mut moved = vehicle.clone();
            moved.set(path, vehicle.get(path)? + se).ok()?;
            moved.parameters().ok()
        })
        .collect();
    let fit = parts.hull.fit.as_ref();
    let lateral = match (parts.fin, fit) {
        (Some(fin), Some(fit)) => Some(Lateral {
            hull_a_per_rad: Figure { value: fit.a.value, se: fit.a.se },
            hull_d_per_rad: Figure { value: fit.d.value, se: fit.d.se },
            fin,
            cb_aft_m: parts.hull.geometry.cb_m,
            rudder_chord: a.rudder_chord.min(1.0),
        }),
        _ => None,
    };
    let water = Surroundings {
        density_kg_m3: parameters.reference_density_kg_m3,
        pressure_Pa: 0.0,
        temperature_C: parameters.reference_temperature_C,
        time_s: 0.0,
    };
    // Ballast that gives the net mass asked for.
    let empty_kg = parameters.net_mass_kg(0.0, &water);
    let ballast_m3 = |net_kg: f64| (empty_kg - net_kg) / (water.density_kg_m3 * parameters.ballast_scale);
    let down = LegOrder { pitch_rad: -a.pitch_deg.to_radians(), ballast_m3: ballast_m3(a.net_mass_kg) };
    let up = LegOrder { pitch_rad: a.pitch_deg.to_radians(), ballast_m3: ballast_m3(-a.net_mass_kg) };
    let look = Look { pitch_rad: down.pitch_rad, ballast_m3: down.ballast_m3, water };
    let effect = effect(&parameters, &uncertain, pod, lateral.as_ref(), &look)?;
    let battery_Wh = a.battery_wh.or_else(|| vehicle.get("energy.battery_Wh"));
    let days = match battery_Wh {
        None => None,
        Some(battery_Wh) => {
            let ask = Ask {
                dive: Dive {
                    depth_m: a.depth_m,
                    descent: down,
                    ascent: up,
                    surface_ballast_m3: up.ballast_m3,
                    dives_per_surfacing: 7.0,
                    stay_s: 600.0,
                    pitch_moves: 4.0,
                    surface_density_kg_m3: water.density_kg_m3,
                },
                battery_J: battery_Wh * 3600.0,
                days: None,
                model_error: 0.05,
                sensor: Sensor::default(),
            };
            let drag_area_m2 = pod.drag_area_m2.value + effect.rudder_drag_area_m2;
            let with = Ask { sensor: Sensor { drag_area_m2, power_W: pod.power_W }, ..ask.clone() };
            match (outlook(vehicle, &ask), outlook(vehicle, &with)) {
                (Ok(before), Ok(after)) => Some(Endurance {
                    days: [before.days, after.days],
                    distance_km: [before.distance_km, after.distance_km],
                }),
                // A base vehicle that nothing is known to draw on has no days to lose.
                (Err(PlanError::NoConsumption), _) => None,
                (Err(error), _) | (_, Err(error)) => return Err(error.into()),
            }
        }
    };
    Ok(Answer { effect, endurance: days })
}

fn read_pod(keys: &str) -> Result<Pod, CliError> {
    let names = [
        "drag_area_m2",
        "drag_area_se_m2",
        "diameter_m",
        "drag_coefficient",
        "aft_m",
        "starboard_m",
        "below_m",
        "power_W",
    ];
    let given = key_values("--sensor", keys, &names)?;
    let get = |name: &str| given.iter().find(|(key, _)| *key == name).map(|(_, value)| *value);
    let area = match (get("drag_area_m2"), get("diameter_m")) {
        (Some(area), _) => area,
        (None, Some(diameter)) => {
            get("drag_coefficient").unwrap_or(0.4) * crate::coefficients::frontal_area_m2(diameter)
        }
        (None, None) => return Err(CliError::Usage("--sensor needs drag_area_m2=... or diameter_m=...".to_owned())),
    };
    Ok(Pod {
        drag_area_m2: Figure { value: area, se: get("drag_area_se_m2").unwrap_or(0.3 * area) },
        aft_m: get("aft_m").unwrap_or(0.0),
        starboard_m: get("starboard_m").unwrap_or(0.0),
        below_m: get("below_m").unwrap_or(0.0),
        power_W: get("power_W").unwrap_or(0.0),
    })
}

fn read_surface(option: &str, keys: &str) -> Result<Surface, CliError> {
    let given = key_values(option, keys, &["span_m", "chord_m", "aft_m", "sweep_deg", "thickness", "efficiency"])?;
    let get = |name: &str| given.iter().find(|(key, _)| *key == name).map(|(_, value)| *value);
    let needed = |name: &str| get(name).ok_or_else(|| CliError::Usage(format!("{option} needs {name}=...")));
    let surface = Surface {
        span_m: needed("span_m")?,
        chord_m: needed("chord_m")?,
        aft_m: needed("aft_m")?,
        sweep_rad: get("sweep_deg").unwrap_or(0.0).to_radians(),
        thickness: get("thickness").unwrap_or(0.03),
        efficiency: get("efficiency").unwrap_or(0.8),
    };
    let above_zero = [surface.span_m, surface.chord_m, surface.efficiency].iter().all(|value| *value > 0.0);
    if above_zero && surface.sweep_rad.abs() < 1.5 {
        Ok(surface)
    } else {
        let problem = "span_m, chord_m and efficiency must be above zero, sweep_deg below 85";
        Err(CliError::Usage(format!("{option} {}: {problem}", printable(keys))))
    }
}

fn key_values<'a>(option: &str, text: &'a str, known: &[&str]) -> Result<Vec<(&'a str, f64)>, CliError> {
    text.split(',')
        .map(|pair| {
            let complaint = |what: String| CliError::Usage(format!("{option} {}: {what}", printable(text)));
            let (key, value) = pair.split_once('=').ok_or_else(|| {
                complaint(format!("`{}` is no KEY=VALUE; the keys are {}", printable(pair), known.join(", ")))
            })?;
            if !known.contains(&key.trim()) {
                let near = nearest(key, known.iter().copied()).map(|near| format!(", did you mean {near}?"));
                let keys = near.unwrap_or_else(|| format!("; the keys are {}", known.join(", ")));
                return Err(complaint(format!("unknown key {}{keys}", printable(key))));
            }
            let number = value.trim().parse().ok().filter(|value: &f64| value.is_finite());
            let number = number.ok_or_else(|| complaint(format!("{} is no finite number", printable(value))))?;
            Ok((key.trim(), number))
        })
        .collect()
}

/// The result as JSON gives it.
#[derive(Debug, Serialize)]
struct AssembleReport {
    schema: &'static str,
    vehicle: String,
    build: Buildup,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensor: Option<Answer>,
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(flatten)]
    effect: Effect,
    #[serde(skip_serializing_if = "Option::is_none")]
    endurance: Option<Endurance>,
}

/// Before and after.
#[derive(Debug, Serialize)]
struct Endurance {
    days: [Estimate; 2],
    distance_km: [Estimate; 2],
}

impl AssembleReport {
    fn print(&self) {
        println!("{}: on frontal area and length, value +- standard error", self.vehicle);
        println!(
            "  {:<13} {:>15} {:>15} {:>15} {:>15} {:>15}",
            "part", "a [1/rad]", "b", "c [1/rad2]", "d [1/rad]", "CMq"
        );
        for term in self.build.terms.iter().chain([&self.build.total]) {
            let Term { a_per_rad, b, c_per_rad2, d_per_rad, pitch_damping_CMq, .. } = term;
            let cell = |figure: &Figure| format!("{:.3} +- {:.3}", figure.value, figure.se);
            println!(
                "  {:<13} {:>15} {:>15} {:>15} {:>15} {:>15}",
                term.part,
                cell(a_per_rad),
                cell(b),
                cell(c_per_rad2),
                cell(d_per_rad),
                cell(pitch_damping_CMq)
            );
        }
        let total = &self.build.total;
        println!(
            "  added mass {:.2} kg along, {:.1} kg across, {:.2} kg m2 in pitch",
            total.m1_kg.value, total.m3_kg.value, total.added_pitch_inertia_kg_m2.value
        );
        let sources: Vec<&str> = self.build.terms.iter().map(|term| term.source).collect();
        for (term, source) in self.build.terms.iter().zip(sources) {
            println!("  {}: {source}", term.part);
        }
        if let Some(answer) = &self.sensor {
            answer.print();
        }
    }
}

impl Answer {
    fn print(&self) {
        println!("the sensor, at the same pitch and ballast, descent; 95 % intervals");
        println!("  {:<33} {:>25} {:>25} {:>26}", "", "before", "after", "change");
        let row = |name: &str, estimates: &[Estimate], decimals: usize| {
            let cells: Vec<String> = estimates
                .iter()
                .map(|Estimate { value, ci95: [low, high], .. }| {
                    format!("{value:.decimals$} ({low:.decimals$} to {high:.decimals$})")
                })
                .collect();
            println!("  {name:<33} {}", cells.iter().map(|cell| format!("{cell:>25}")).collect::<Vec<_>>().join(" "));
        };
        let effect = &self.effect;
        row("(i) glide speed [m/s]", &effect.speed_m_s, 3);
        row("(ii) glide path angle [deg]", &effect.glide_angle_deg, 2);
        row("(iii) rate of descent [m/s]", &effect.vertical_velocity_m_s, 3);
        row("(iv) horizontal speed [m/s]", &effect.horizontal_velocity_m_s, 3);
        match &effect.rudder_deg {
            Some(rudder) => {
                let straight = Estimate::normal(0.0, 0.0, "deg");
                row("(v) rudder to fly straight [deg]", &[straight, rudder.clone()], 2);
            }
            None => println!("  (v) the rudder angle needs --fin"),
        }
        match &self.endurance {
            Some(endurance) => {
                row("endurance [d]", &endurance.days, 1);
                row("way through the water [km]", &endurance.distance_km, 0);
                let days = endurance.days[0].value - endurance.days[1].value;
                let way_km = endurance.distance_km[0].value - endurance.distance_km[1].value;
                // A slower glider pumps less often, which can keep it at sea for longer.
                let days =
                    if days >= 0.0 { format!("costs {days:.1} days") } else { format!("adds {:.1} days", -days) };
                println!(
                    "  the sensor {days} at sea and costs {way_km:.0} km of way; rudder positive: bow to starboard"
                );
            }
            None => println!("  the days of endurance need battery and consumers: [energy] of the base vehicle"),
        }
    }
}
