//! `glidepolar turn`: steady turns of a glider with rudder or roll mass, all that are found, and their stability.

use std::path::PathBuf;

use clap::Args;
use rayon::prelude::*;
use serde::Serialize;

use super::turn_page::Case;
use super::{Changes, CliError, Output, inputs, turn_page, vehicle_input, warn, water_density};
use crate::dynamics::Surroundings;
use crate::input::{nearest, printable};
use crate::spatial::Body;
use crate::spatial::turn::{Setting, Trim, Turn, find};
use crate::vehicle::Vehicle;

/// Steady turns: roll, pitch, speed, sideslip, turn rate, radius, stability
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar turn seawing --roll-mass-deg -45 --moving-mass-m 0.4216 --net-mass-kg 0.3\n  \
    glidepolar turn seaglider --roll-mass-deg 40 --pitch-deg -20\n  \
    glidepolar turn slocum-049 --rudder-deg 11 --net-mass-kg -0.2        on a climb\n  \
    glidepolar turn seaglider --sweep roll-mass-deg=-80..80 --json -     every turn over a range of roll mass angles\n  \
    glidepolar turn slocum-049 --rudder-deg 11 --out turn                the turn polar as a page with figures")]
pub struct Arguments {
    /// Vehicle file or name of a built-in vehicle
    vehicle: String,
    /// Rudder angle, positive turns the bow to starboard [deg]
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    rudder_deg: Option<f64>,
    /// Angle of the roll mass, positive to starboard [deg]
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    roll_mass_deg: Option<f64>,
    /// Net mass, positive when heavy [kg]; default: half of what the buoyancy engine gives
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    net_mass_kg: Option<f64>,
    /// Place of the moving mass [m]; the pitch follows
    #[arg(long, value_name = "R", allow_negative_numbers = true, conflicts_with = "pitch_deg")]
    moving_mass_m: Option<f64>,
    /// Pitch in the turn, nose-up positive [deg]; default: 26 deg down when heavy, up when light
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pitch_deg: Option<f64>,
    /// Vary one of the five options above: roll-mass-deg=-60..60, 41 values; with a number of values: rudder-deg=0..20:11
    #[arg(long, value_name = "NAME=FROM..TO", allow_hyphen_values = true)]
    sweep: Option<String>,
    /// In-situ water density [kg/m3]; default: the vehicle's reference
    #[arg(long, value_name = "RHO", allow_negative_numbers = true)]
    density: Option<f64>,
    /// Depth, for compressible hulls [m]
    #[arg(long, value_name = "Z", default_value_t = 0.0, allow_negative_numbers = true)]
    depth_m: f64,
    #[command(flatten)]
    changes: Changes,
    /// Write report.html and its figures to DIR
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// Pitch of a glider of which nothing else is said [deg].
const DEFAULT_PITCH_DEG: f64 = 26.0;

/// Values of a sweep that states no number.
const SWEEP_VALUES: usize = 41;

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let inputs = inputs([], Some(&arguments.vehicle));
    arguments.output.begin(&inputs, &[("--out", arguments.out.as_deref())])?;
    let vehicle = arguments.changes.load(&arguments.vehicle)?;
    let body = vehicle.body()?;
    let commands = Commands::new(arguments);
    let sweep = arguments.sweep.as_deref().map(Sweep::read).transpose()?;
    let water = water(arguments, &body)?;
    let every = match &sweep {
        None => vec![commands],
        Some(sweep) => sweep.values().map(|value| commands.with(sweep.name, value)).collect(),
    };
    let settings = every.iter().map(|c| c.setting(&body, &water)).collect::<Result<Vec<_>, _>>()?;
    let cases: Vec<Case> =
        settings.into_par_iter().map(|setting| Case { turns: find(&body, &setting), setting }).collect();
    if cases.iter().all(|case| case.turns.is_empty()) {
        return Err(CliError::Failed(no_turn(&cases[0].setting)));
    }
    let report = TurnReport::new(&vehicle, sweep.as_ref(), &cases);
    warn(warnings(&vehicle, &body, &cases));
    if arguments.output.shows_tables() {
        report.print();
    }
    if let Some(out) = &arguments.out {
        let page = turn_page::page(&vehicle, &body, &cases);
        page.input(vehicle_input(&arguments.vehicle)?).write(arguments.output.folder(out)?)?;
    }
    arguments.output.write_json(&report)
}

fn no_turn(setting: &Setting) -> String {
    format!(
        "no steady turn or glide with a net mass of {:.4} kg and this trim: the nose must point the way the glider is driven, \
         down when heavy and up when light, and steeply enough; `glidepolar glide` shows what can be flown",
        setting.net_mass_kg
    )
}

fn warnings(vehicle: &Vehicle, body: &Body<f64>, cases: &[Case]) -> Vec<String> {
    let mut warnings = Vec::new();
    let reach = body.plane.moving_mass_min_m..=body.plane.moving_mass_max_m;
    if let Some(turn) = cases.iter().flat_map(|case| &case.turns).find(|turn| !reach.contains(&turn.moving_mass_m)) {
        warnings.push(format!(
            "the moving mass would stand at {:.4} m and reaches {:.4} to {:.4} m",
            turn.moving_mass_m,
            reach.start(),
            reach.end()
        ));
    }
    if cases.iter().all(|case| case.turns.iter().all(|turn| !turn.stable)) {
        warnings.push("no turn is stable: a disturbance grows".to_owned());
    }
    warnings.extend(turn_page::sense(vehicle, body, &cases[0]).err());
    warnings
}

fn water(arguments: &Arguments, body: &Body<f64>) -> Result<Surroundings<f64>, CliError> {
    let p = &body.plane;
    let density_kg_m3 = water_density(arguments.density)?.unwrap_or(p.reference_density_kg_m3);
    if !(0.0..=12_000.0).contains(&arguments.depth_m) {
        return Err(CliError::Usage(format!("--depth-m {} is no depth: expected 0 to 12000 m", arguments.depth_m)));
    }
    Ok(Surroundings {
        density_kg_m3,
        pressure_Pa: p.true_density_kg_m3(density_kg_m3) * p.gravity_m_s2 * arguments.depth_m,
        temperature_C: p.reference_temperature_C,
        time_s: 0.0,
    })
}

/// What was asked for.
#[derive(Debug, Clone, Copy)]
struct Commands {
    rudder_deg: Option<f64>,
    roll_mass_deg: Option<f64>,
    net_mass_kg: Option<f64>,
    moving_mass_m: Option<f64>,
    pitch_deg: Option<f64>,
    depth_m: f64,
}

const NAMES: [&str; 5] = ["rudder-deg", "roll-mass-deg", "net-mass-kg", "moving-mass-m", "pitch-deg"];

impl Commands {
    fn new(arguments: &Arguments) -> Self {
        Commands {
            rudder_deg: arguments.rudder_deg,
            roll_mass_deg: arguments.roll_mass_deg,
            net_mass_kg: arguments.net_mass_kg,
            moving_mass_m: arguments.moving_mass_m,
            pitch_deg: arguments.pitch_deg,
            depth_m: arguments.depth_m,
        }
    }

    fn with(self, name: &str, value: f64) -> Self {
        let value = Some(value);
        match name {
            "rudder-deg" => Commands { rudder_deg: value, ..self },
            "roll-mass-deg" => Commands { roll_mass_deg: value, ..self },
            "net-mass-kg" => Commands { net_mass_kg: value, ..self },
            "moving-mass-m" => Commands { moving_mass_m: value, pitch_deg: None, ..self },
            _ => Commands { pitch_deg: value, moving_mass_m: None, ..self },
        }
    }

    fn setting(&self, body: &Body<f64>, water: &Surroundings<f64>) -> Result<Setting, CliError> {
        let (p, l) = (&body.plane, &body.lateral);
        let given = [self.rudder_deg, self.roll_mass_deg, self.net_mass_kg, self.moving_mass_m, self.pitch_deg];
        for (name, value) in NAMES.into_iter().zip(given) {
            if let Some(value) = value.filter(|value| !value.is_finite()) {
                return Err(CliError::Usage(format!("--{name} {value}: expected a finite number")));
            }
        }
        let angle = |name: &str, table: &str, deg: f64, is_there: bool, [low, high]: [f64; 2]| {
            if deg != 0.0 && !is_there {
                return Err(CliError::Usage(format!("--{name}: this vehicle has none; describe it under [{table}]")));
            }
            let rad = deg.to_radians();
            if rad != 0.0 && !(low - 1e-9..=high + 1e-9).contains(&rad) {
                return Err(CliError::Usage(format!(
                    "--{name} {deg} is beyond its limits: {table}.min_rad = {low}, {table}.max_rad = {high}"
                )));
            }
            Ok(rad)
        };
        let has_rudder = [l.rudder_CY_per_rad, l.rudder_CN_per_rad, l.rudder_Cl_per_rad].iter().any(|c| *c != 0.0);
        let rudder_rad = angle(
            "rudder-deg",
            "rudder",
            self.rudder_deg.unwrap_or(0.0),
            has_rudder,
            [l.rudder_min_rad, l.rudder_max_rad],
        )?;
        let has_roll_mass = l.roll_mass_kg * l.roll_mass_radius_m > 0.0;
        let roll_mass_rad = angle(
            "roll-mass-deg",
            "roll_mass",
            self.roll_mass_deg.unwrap_or(0.0),
            has_roll_mass,
            [l.roll_mass_min_rad, l.roll_mass_max_rad],
        )?;
        let net_mass_kg = self.net_mass_kg.unwrap_or_else(|| 0.5 * p.net_mass_kg(p.ballast_min_m3, water));
        if net_mass_kg == 0.0 {
            return Err(CliError::Usage("--net-mass-kg 0: a neutral glider does not move".to_owned()));
        }
        let pitch_deg = self.pitch_deg.unwrap_or(-DEFAULT_PITCH_DEG * net_mass_kg.signum());
        if pitch_deg.abs() >= 89.0 {
            return Err(CliError::Usage(format!("--pitch-deg {pitch_deg}: expected less than 89 deg up or down")));
        }
        let trim = match self.moving_mass_m {
            Some(place) => Trim::MovingMass(place),
            None => Trim::Pitch(pitch_deg.to_radians()),
        };
        let density_kg_m3 = water.density_kg_m3;
        Ok(Setting { net_mass_kg, trim, roll_mass_rad, rudder_rad, density_kg_m3, depth_m: self.depth_m })
    }
}

/// What is varied, between which values.
struct Sweep {
    name: &'static str,
    from: f64,
    to: f64,
    values: usize,
}

impl Sweep {
    fn read(text: &str) -> Result<Self, CliError> {
        let wrong = |what: String| CliError::Usage(format!("--sweep {}: {what}", printable(text)));
        let form = || wrong("expected NAME=FROM..TO or NAME=FROM..TO:VALUES, such as roll-mass-deg=-60..60".to_owned());
        let (name, range) = text.split_once('=').ok_or_else(form)?;
        let asked = name.trim().trim_start_matches("--").replace('_', "-");
        let name = NAMES.into_iter().find(|known| *known == asked).ok_or_else(|| {
            wrong(match nearest(&asked, NAMES) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("expected one of {}", NAMES.join(", ")),
            })
        })?;
        let (from, rest) = range.split_once("..").ok_or_else(form)?;
        let (to, values) = match rest.split_once(':') {
            Some((to, values)) => (to, values.trim().parse().map_err(|_| form())?),
            None => (rest, SWEEP_VALUES),
        };
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|n| n.is_finite()).ok_or_else(form);
        let sweep = Sweep { name, from: number(from)?, to: number(to)?, values };
        if !(2..=10_001).contains(&sweep.values) || sweep.from == sweep.to {
            return Err(wrong("expected two different ends and 2 to 10001 values".to_owned()));
        }
        Ok(sweep)
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let last = (self.values - 1) as f64;
        // Symmetric ends give symmetric values.
        (0..self.values).map(move |i| (self.from * (last - i as f64) + self.to * i as f64) / last)
    }
}

/// The result as JSON gives it.
#[derive(Debug, Serialize)]
struct TurnReport {
    schema: &'static str,
    vehicle: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    sweep: Option<SweepRow>,
    turns: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct SweepRow {
    name: &'static str,
    from: f64,
    to: f64,
    values: usize,
}

/// One steady turn with what was commanded.
#[derive(Debug, Serialize)]
struct Row {
    roll_rad: f64,
    pitch_rad: f64,
    speed_m_s: f64,
    angle_of_attack_rad: f64,
    sideslip_rad: f64,
    turn_rate_rad_s: f64,
    /// Null on a straight glide.
    radius_m: Option<f64>,
    vertical_velocity_m_s: f64,
    eigenvalues: Vec<[f64; 2]>,
    stable: bool,
    moving_mass_m: f64,
    net_mass_kg: f64,
    roll_mass_rad: f64,
    rudder_rad: f64,
}

impl TurnReport {
    fn new(vehicle: &Vehicle, sweep: Option<&Sweep>, cases: &[Case]) -> Self {
        let row = |setting: &Setting, turn: &Turn| Row {
            roll_rad: turn.roll_rad,
            pitch_rad: turn.pitch_rad,
            speed_m_s: turn.speed_m_s,
            angle_of_attack_rad: turn.angle_of_attack_rad,
            sideslip_rad: turn.sideslip_rad,
            turn_rate_rad_s: turn.turn_rate_rad_s,
            radius_m: (!turn.is_straight()).then_some(turn.radius_m),
            vertical_velocity_m_s: turn.vertical_velocity_m_s,
            eigenvalues: turn.eigenvalues.clone(),
            stable: turn.stable,
            moving_mass_m: turn.moving_mass_m,
            net_mass_kg: setting.net_mass_kg,
            roll_mass_rad: setting.roll_mass_rad,
            rudder_rad: setting.rudder_rad,
        };
        TurnReport {
            schema: "glidepolar.turn/1",
            vehicle: vehicle.name.clone(),
            sweep: sweep.map(|s| SweepRow { name: s.name, from: s.from, to: s.to, values: s.values }),
            turns: cases.iter().flat_map(|case| case.turns.iter().map(|turn| row(&case.setting, turn))).collect(),
        }
    }

    fn print(&self) {
        println!("{}", printable(&self.vehicle));
        println!("roll mass rudder net mass    roll   pitch   AOA   sideslip   speed     down   turn rate   radius");
        println!("   deg      deg      kg       deg     deg    deg     deg      m/s      m/s     deg/s        m");
        for row in &self.turns {
            println!(
                "{:7.1} {:7.1} {:9.4} {:8.3} {:7.2} {:6.2} {:8.3} {:8.4} {:8.4} {:10.5} {:>9}  {}",
                row.roll_mass_rad.to_degrees(),
                row.rudder_rad.to_degrees(),
                row.net_mass_kg,
                row.roll_rad.to_degrees(),
                row.pitch_rad.to_degrees(),
                row.angle_of_attack_rad.to_degrees(),
                row.sideslip_rad.to_degrees(),
                row.speed_m_s,
                row.vertical_velocity_m_s,
                row.turn_rate_rad_s.to_degrees(),
                row.radius_m.map_or("straight".to_owned(), |radius| format!("{radius:.1}")),
                if row.stable { "stable" } else { "unstable" }
            );
        }
    }
}
