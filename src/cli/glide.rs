//! `glidepolar glide`: the forward process, one glide or the whole polar.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{Changes, CliError, Output, glide_page, inputs, vehicle_input, water_density};
use crate::dynamics::{Parameters, Surroundings};
use crate::glide::{Attitude, GlideError, SteadyGlide, at_path, at_pitch, shallowest};
use crate::vehicle::Vehicle;

/// Steady glides: angle of attack, path, speed, ballast and trim
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar glide rogue --glide-angle-deg -30 --speed-m-s 0.30\n  \
    glidepolar glide slocum-049 --net-mass-kg 0.25 --pitch-deg -26\n  \
    glidepolar glide my-glider.toml --net-mass-kg 0.25        every pitch at this net mass: the polar\n  \
    glidepolar glide slocum-049 --out polar                   the polar as a page with figures\n  \
    glidepolar glide slocum-graver --set hydro.b=0.14 --json -  what a rougher hull would do")]
pub struct Arguments {
    /// Vehicle file or name of a built-in vehicle
    vehicle: String,
    /// Net mass, positive when heavy [kg]; alone: the polar at this net mass
    #[arg(long, value_name = "M", allow_negative_numbers = true, conflicts_with_all = ["glide_angle_deg", "speed_m_s"])]
    net_mass_kg: Option<f64>,
    /// Pitch, nose-up positive [deg]
    #[arg(long, value_name = "T", allow_negative_numbers = true, requires = "net_mass_kg")]
    pitch_deg: Option<f64>,
    /// Glide path angle, negative when descending [deg]
    #[arg(long, value_name = "X", allow_negative_numbers = true, requires = "speed_m_s")]
    glide_angle_deg: Option<f64>,
    /// Speed through the water [m/s]
    #[arg(long, value_name = "V", requires = "glide_angle_deg", allow_negative_numbers = true)]
    speed_m_s: Option<f64>,
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

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let inputs = inputs([], Some(&arguments.vehicle));
    arguments.output.begin(&inputs, &[("--out", arguments.out.as_deref())])?;
    let vehicle = arguments.changes.load(&arguments.vehicle)?;
    let parameters = vehicle.glide_parameters();
    let water = water(arguments, &parameters)?;
    for (name, value) in [
        ("--net-mass-kg", arguments.net_mass_kg),
        ("--pitch-deg", arguments.pitch_deg),
        ("--glide-angle-deg", arguments.glide_angle_deg),
        ("--speed-m-s", arguments.speed_m_s),
    ] {
        if let Some(value) = value.filter(|value| !value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a finite number")));
        }
    }
    let glides = match (arguments.glide_angle_deg, arguments.speed_m_s, arguments.net_mass_kg, arguments.pitch_deg) {
        (Some(angle), Some(speed), _, _) => vec![at_path(&parameters, &water, angle.to_radians(), speed)?],
        (_, _, Some(net_mass_kg), Some(pitch)) => {
            vec![at_pitch(&parameters, &water, Attitude { pitch_rad: pitch.to_radians(), net_mass_kg })?]
        }
        (_, _, net_mass_kg, _) => {
            polar(&parameters, &water, net_mass_kg.unwrap_or_else(|| default_net_mass_kg(&parameters, &water)))?
        }
    };
    let report = GlideReport::new(&vehicle, &parameters, &water, &glides);
    if arguments.output.shows_tables() {
        report.print();
    }
    if let Some(out) = &arguments.out {
        let page = glide_page::page(&vehicle, &parameters, &water, &glides);
        page.input(vehicle_input(&arguments.vehicle)?).write(arguments.output.folder(out)?)?;
    }
    arguments.output.write_json(&report)
}

fn water(arguments: &Arguments, parameters: &Parameters<f64>) -> Result<Surroundings<f64>, CliError> {
    let density_kg_m3 = water_density(arguments.density)?.unwrap_or(parameters.reference_density_kg_m3);
    if !(0.0..=12_000.0).contains(&arguments.depth_m) {
        return Err(CliError::Usage(format!("--depth-m {} is no depth: expected 0 to 12000 m", arguments.depth_m)));
    }
    Ok(Surroundings {
        density_kg_m3,
        pressure_Pa: density_kg_m3 * parameters.gravity_m_s2 * arguments.depth_m,
        temperature_C: parameters.reference_temperature_C,
        time_s: 0.0,
    })
}

/// Half of what the buoyancy engine can make it weigh.
fn default_net_mass_kg(parameters: &Parameters<f64>, water: &Surroundings<f64>) -> f64 {
    0.5 * parameters.net_mass_kg(parameters.ballast_min_m3, water)
}

/// Lines of a polar on the terminal at most.
const MOST_LINES: usize = 18;

/// Every whole degree of pitch at which this net mass glides within the laws of lift and drag.
fn polar(
    parameters: &Parameters<f64>,
    water: &Surroundings<f64>,
    net_mass_kg: f64,
) -> Result<Vec<SteadyGlide<f64>>, GlideError> {
    let nose = if net_mass_kg > 0.0 { -1.0 } else { 1.0 };
    let glide = |degrees: i32| {
        at_pitch(parameters, water, Attitude { pitch_rad: nose * f64::from(degrees).to_radians(), net_mass_kg })
    };
    let within =
        |g: &SteadyGlide<f64>| g.angle_of_attack_rad.to_degrees().abs() <= glide_page::WIDEST_ANGLE_OF_ATTACK_DEG;
    let glides: Vec<_> = (1..=70).filter_map(|degrees| glide(degrees).ok()).filter(within).collect();
    if glides.is_empty() { glide(45).map(|glide| vec![glide]) } else { Ok(glides) }
}

/// The result as JSON gives it. Angles in degrees and radians.
#[derive(Debug, Serialize)]
struct GlideReport {
    schema: &'static str,
    vehicle: String,
    water_density_kg_m3: f64,
    limits: Limits,
    #[serde(skip_serializing_if = "Option::is_none")]
    glide: Option<Row>,
    #[serde(skip_serializing_if = "Option::is_none")]
    polar: Option<Polar>,
}

/// The shallowest paths that can be flown.
#[derive(Debug, Serialize)]
struct Limits {
    shallowest_descent_deg: f64,
    shallowest_ascent_deg: f64,
}

/// All glides at one net mass.
#[derive(Debug, Serialize)]
struct Polar {
    net_mass_kg: f64,
    best_glide_ratio: Optimum,
    minimum_sink: Optimum,
    glides: Vec<Row>,
}

/// An optimum over pitch at one net mass.
#[derive(Debug, Clone, Serialize)]
struct Optimum {
    #[serde(flatten)]
    row: Row,
    /// Nothing better lies between the neighbours of this pitch. Else it is the edge of what was looked at, and no optimum:
    /// beyond it lie other laws of lift and drag, or pitches of another sign.
    is_within_range: bool,
}

/// Angle of attack up to which hulls are usually towed: beyond it the coefficients are extrapolated \[deg\].
pub(super) const USUALLY_TOWED_TO_DEG: f64 = 10.0;

impl Optimum {
    /// The least of a figure over the glides of a polar, between the whole degrees where it lies within them.
    fn new(
        size: fn(&SteadyGlide<f64>) -> f64,
        glides: &[SteadyGlide<f64>],
        parameters: &Parameters<f64>,
        water: &Surroundings<f64>,
    ) -> Option<Optimum> {
        let at = (0..glides.len()).min_by(|&i, &j| size(&glides[i]).total_cmp(&size(&glides[j])))?;
        let row = |glide: &SteadyGlide<f64>| Row::new(parameters, glide);
        if at == 0 || at + 1 == glides.len() {
            return Some(Optimum { row: row(&glides[at]), is_within_range: false });
        }
        // Golden section between the neighbours: a thousandth of a degree.
        let net_mass_kg = glides[at].net_mass_kg;
        let glide = |pitch_rad: f64| at_pitch(parameters, water, Attitude { pitch_rad, net_mass_kg }).ok();
        let of = |pitch_rad: f64| glide(pitch_rad).map_or(f64::INFINITY, |glide| size(&glide));
        let (mut low, mut high) = (glides[at - 1].pitch_rad, glides[at + 1].pitch_rad);
        const SHARE: f64 = 0.618_033_988_749_895;
        while (high - low).abs() > 2e-5 {
            let (a, b) = (high - SHARE * (high - low), low + SHARE * (high - low));
            if of(a) < of(b) { high = b } else { low = a }
        }
        let best = glide(0.5 * (low + high)).filter(|glide| size(glide) <= size(&glides[at])).unwrap_or(glides[at]);
        Some(Optimum { row: row(&best), is_within_range: true })
    }

    fn print(&self, name: &str) {
        let row = &self.row;
        let alpha_deg = row.angle_of_attack_deg.abs();
        println!(
            "{name}: {:.2} at pitch {:.1} deg, angle of attack {alpha_deg:.1} deg, {:.3} m/s along, {:.3} m/s {}{}",
            row.horizontal_velocity_m_s.abs() / row.vertical_velocity_m_s.abs(),
            row.pitch_deg,
            row.horizontal_velocity_m_s.abs(),
            row.vertical_velocity_m_s.abs(),
            if row.vertical_velocity_m_s > 0.0 { "down" } else { "up" },
            if self.is_within_range { "" } else { "; the edge of the range of pitch, not an optimum" },
        );
        if alpha_deg > USUALLY_TOWED_TO_DEG {
            println!(
                "  {alpha_deg:.1} deg is beyond the {USUALLY_TOWED_TO_DEG:.0} deg to which hulls are usually towed: lift and drag are extrapolated"
            );
        }
    }
}

/// One glide.
#[derive(Debug, Clone, Serialize)]
struct Row {
    glide_angle_deg: f64,
    glide_angle_rad: f64,
    angle_of_attack_deg: f64,
    angle_of_attack_rad: f64,
    pitch_deg: f64,
    pitch_rad: f64,
    speed_m_s: f64,
    horizontal_velocity_m_s: f64,
    vertical_velocity_m_s: f64,
    v1_m_s: f64,
    v3_m_s: f64,
    lift_N: f64,
    drag_N: f64,
    pitching_moment_N_m: f64,
    net_mass_kg: f64,
    ballast_mass_kg: f64,
    ballast_cc: f64,
    moving_mass_m: f64,
    cg_below_cb_m: f64,
    cg_forward_of_cb_m: f64,
}

impl Row {
    fn new(parameters: &Parameters<f64>, glide: &SteadyGlide<f64>) -> Self {
        let p = parameters;
        let first_moment = |moving: f64, offset: f64, ballast: f64| {
            (p.moving_mass_kg * moving + p.offset_mass_kg * offset + glide.ballast_mass_kg * ballast) / p.mass_kg()
        };
        Row {
            glide_angle_deg: glide.glide_angle_rad.to_degrees(),
            glide_angle_rad: glide.glide_angle_rad,
            angle_of_attack_deg: glide.angle_of_attack_rad.to_degrees(),
            angle_of_attack_rad: glide.angle_of_attack_rad,
            pitch_deg: glide.pitch_rad.to_degrees(),
            pitch_rad: glide.pitch_rad,
            speed_m_s: glide.speed_m_s,
            horizontal_velocity_m_s: glide.horizontal_velocity_m_s,
            vertical_velocity_m_s: glide.vertical_velocity_m_s,
            v1_m_s: glide.v1_m_s,
            v3_m_s: glide.v3_m_s,
            lift_N: glide.lift_N,
            drag_N: glide.drag_N,
            pitching_moment_N_m: glide.moment_N_m,
            net_mass_kg: glide.net_mass_kg,
            ballast_mass_kg: glide.ballast_mass_kg,
            ballast_cc: glide.ballast_m3 * 1e6,
            moving_mass_m: glide.moving_mass_m,
            cg_below_cb_m: first_moment(p.moving_mass_height_m, p.offset_mass_below_m, p.ballast_below_m),
            cg_forward_of_cb_m: first_moment(glide.moving_mass_m, p.offset_mass_forward_m, p.ballast_forward_m),
        }
    }
}

impl GlideReport {
    fn new(
        vehicle: &Vehicle,
        parameters: &Parameters<f64>,
        water: &Surroundings<f64>,
        glides: &[SteadyGlide<f64>],
    ) -> Self {
        let rows: Vec<Row> = glides.iter().map(|glide| Row::new(parameters, glide)).collect();
        let limits = shallowest(parameters, water, rows[0].speed_m_s);
        let least = |size| Optimum::new(size, glides, parameters, water);
        let polar = match (least(|glide| glide.glide_angle_rad.abs()), least(|glide| glide.vertical_velocity_m_s.abs()))
        {
            (Some(best_glide_ratio), Some(minimum_sink)) if rows.len() > 1 => {
                Some(Polar { net_mass_kg: rows[0].net_mass_kg, best_glide_ratio, minimum_sink, glides: rows.clone() })
            }
            _ => None,
        };
        GlideReport {
            schema: "glidepolar.glide/1",
            vehicle: vehicle.name.clone(),
            water_density_kg_m3: water.density_kg_m3,
            limits: Limits {
                shallowest_descent_deg: limits.descent_rad.to_degrees(),
                shallowest_ascent_deg: limits.ascent_rad.to_degrees(),
            },
            glide: if polar.is_none() { rows.into_iter().next() } else { None },
            polar,
        }
    }

    fn print(&self) {
        println!("{}, water {:.2} kg/m3", self.vehicle, self.water_density_kg_m3);
        println!(
            "paths shallower than {:.2} deg down and {:.2} deg up cannot be flown",
            self.limits.shallowest_descent_deg, self.limits.shallowest_ascent_deg
        );
        if let Some(row) = &self.glide {
            let line = |name: &str, value: String| println!("  {name:<28} {value}");
            line("glide path angle", format!("{:10.4} deg", row.glide_angle_deg));
            line("angle of attack", format!("{:10.4} deg", row.angle_of_attack_deg));
            line("pitch", format!("{:10.4} deg", row.pitch_deg));
            line("speed", format!("{:10.4} m/s", row.speed_m_s));
            line(
                "horizontal, vertical speed",
                format!("{:10.4} m/s, {:.4} m/s down", row.horizontal_velocity_m_s, row.vertical_velocity_m_s),
            );
            line("lift, drag", format!("{:10.4} N, {:.4} N", row.lift_N, row.drag_N));
            line("pitching moment", format!("{:10.4} N m about the centre of buoyancy", row.pitching_moment_N_m));
            line("net mass", format!("{:10.4} kg", row.net_mass_kg));
            line("ballast", format!("{:10.2} cc, {:.5} kg on board", row.ballast_cc, row.ballast_mass_kg));
            line("moving mass", format!("{:10.4} mm forward of the centre of buoyancy", row.moving_mass_m * 1e3));
        }
        if let Some(polar) = &self.polar {
            println!("net mass {:.4} kg", polar.net_mass_kg);
            polar.best_glide_ratio.print("Best glide ratio");
            polar.minimum_sink.print("Minimum sink, with a glide ratio of");
            println!();
            println!("  pitch   path   AOA    speed  horizontal  down    moving mass");
            println!("   deg     deg   deg    m/s       m/s      m/s         mm");
            // Every glide is in the JSON and on the page; a screen takes some.
            let every = polar.glides.len().div_ceil(MOST_LINES);
            for row in polar.glides.iter().step_by(every) {
                println!(
                    "{:7.1} {:7.2} {:5.2} {:8.4} {:9.4} {:9.4} {:11.2}",
                    row.pitch_deg,
                    row.glide_angle_deg,
                    row.angle_of_attack_deg,
                    row.speed_m_s,
                    row.horizontal_velocity_m_s,
                    row.vertical_velocity_m_s,
                    row.moving_mass_m * 1e3
                );
            }
        }
    }
}
