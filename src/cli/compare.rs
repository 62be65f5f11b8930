//! `glidepolar compare`: vehicles and logs side by side, polars, speeds and what a dive costs.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::reading::Reading;
use super::{CliError, Output, inputs, log_vehicle, vehicle_input, warn};
use crate::dynamics::{Parameters, Surroundings};
use crate::estimate::Estimate;
use crate::glide::{Attitude, at_pitch};
use crate::identify::{Request, Trim, identify};
use crate::plan::{Dive, per_dive};
use crate::report::{Axis, Cell, Figure, InputFile, Layer, Panel, Report, Section, Table};
use crate::simulate::mission::LegOrder;
use crate::vehicle::{Vehicle, builtin};

/// Vehicles or logs side by side: polars, speeds at the same ballast and pitch, energy of a dive
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar compare slocum-049 seaglider seaexplorer\n  \
    glidepolar compare before.toml after.toml --net-mass-kg 0.2 --out compared\n  \
    glidepolar compare spring.csv summer.csv --vehicle my-glider.toml\n\n\
    Each of A, B, ... is a vehicle file, a built-in vehicle or a log. A log is identified first, with the vehicle of\n\
    --vehicle. All glide with the same net mass at the same pitch, in water of one density.")]
pub struct Arguments {
    /// Vehicle files, names of built-in vehicles, or flight logs; two at least
    #[arg(required = true, num_args = 2.., value_name = "A")]
    what: Vec<String>,
    /// Vehicle of the logs, file or name of a built-in one
    #[arg(long, value_name = "VEHICLE")]
    vehicle: Option<String>,
    /// Net mass at which all glide; default: half of what the smallest ballast engine of them gives [kg]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    net_mass_kg: Option<f64>,
    /// Depth of the dive whose cost is compared [m]
    #[arg(long, value_name = "Z", default_value_t = 200.0, allow_negative_numbers = true)]
    depth_m: f64,
    #[command(flatten)]
    reading: Reading,
    /// Write report.html and its figures to DIR
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// Pitches at which speeds are compared \[deg\].
const PITCHES_DEG: [f64; 4] = [15.0, 20.0, 25.0, 35.0];

/// Density of the water in which all glide \[kg/m3\]: net masses are set, so that it scales speeds and no more.
const DENSITY_KG_M3: f64 = 1027.0;

pub(super) fn run(a: &Arguments) -> Result<(), CliError> {
    let vehicles = a.what.iter().chain(&a.vehicle);
    let files: Vec<&Path> = vehicles.flat_map(|name| inputs([], Some(name))).collect();
    a.output.begin(&files, &[("--out", a.out.as_deref())])?;
    for (name, value) in [("--net-mass-kg", a.net_mass_kg.unwrap_or(1.0)), ("--depth-m", a.depth_m)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a number above zero")));
        }
    }
    let mut warnings = Vec::new();
    let gliders: Vec<(String, Vehicle)> = a
        .what
        .iter()
        .map(|what| Ok((what.clone(), glider(a, what, &mut warnings)?)))
        .collect::<Result<_, CliError>>()?;
    let engine = |vehicle: &Vehicle| {
        let p = vehicle.glide_parameters();
        0.5 * -p.ballast_min_m3 * DENSITY_KG_M3
    };
    let smallest = gliders.iter().map(|(_, vehicle)| engine(vehicle)).fold(f64::INFINITY, f64::min);
    let net_mass_kg = a.net_mass_kg.unwrap_or(smallest);
    let compared = gliders.iter().map(|(name, vehicle)| Compared::new(name, vehicle, net_mass_kg, a.depth_m)).collect();
    let report = CompareReport {
        schema: "glidepolar.compare/1",
        net_mass_kg,
        density_kg_m3: DENSITY_KG_M3,
        gliders: compared,
        warnings,
    };
    if a.output.shows_tables() {
        report.print();
    }
    warn(&report.warnings);
    if let Some(out) = &a.out {
        let mut page = report.page(&gliders);
        for what in &a.what {
            let is_vehicle = is_vehicle(what);
            page = page.input(if is_vehicle { vehicle_input(what)? } else { InputFile::read(Path::new(what))? });
        }
        page.write(a.output.folder(out)?)?;
    }
    a.output.write_json(&report)
}

fn is_vehicle(what: &str) -> bool {
    builtin::text(what).is_some() || what.ends_with(".toml") || !Path::new(what).exists()
}

/// A vehicle, or the one that was identified from a log.
fn glider(a: &Arguments, what: &str, warnings: &mut Vec<String>) -> Result<Vehicle, CliError> {
    if is_vehicle(what) {
        return Ok(Vehicle::load(what)?);
    }
    let Some(vehicle) = &a.vehicle else {
        return Err(CliError::Usage(format!("{what} is a log: add --vehicle, the glider that flew it")));
    };
    let vehicle = log_vehicle::load(vehicle, &[PathBuf::from(what)])?;
    let mut log = a.reading.read(&[PathBuf::from(what)], &vehicle)?;
    let vehicle = log.located(vehicle)?;
    warnings.extend(log.corrected(&vehicle)?.into_iter().map(|warning| format!("{what}: {warning}")));
    let trim = if vehicle.is_builtin { Trim::Neutral } else { Trim::Vehicle };
    let request = Request { trim, free: Vec::new(), pin: Vec::new(), unsteady: None };
    let found = identify(&vehicle, &log.observations, &request)?;
    found.has_enough_dives()?;
    let report = found.report(&vehicle, log.w_filter, log.notes);
    warnings.extend(report.warnings.iter().map(|warning| format!("{what}: {warning}")));
    super::identify_write::identified(&vehicle, &found, &report)
}

/// One glider of a comparison.
#[derive(Debug, Serialize)]
struct Compared {
    what: String,
    vehicle: String,
    a_per_rad: Estimate,
    b: Estimate,
    c_per_rad2: Estimate,
    frontal_area_m2: f64,
    /// Area of the drag at no lift: `b` on the frontal area, which differ from glider to glider \[m2\].
    drag_area_m2: f64,
    best_glide_ratio: Option<f64>,
    best_glide_pitch_deg: Option<f64>,
    descents: Vec<AtPitch>,
    /// A dive at 25 deg with this net mass both ways; nothing where it cannot be flown or figures are missing.
    dive_duration_h: Option<f64>,
    dive_distance_km: Option<f64>,
    dive_energy_kJ: Option<f64>,
    energy_per_km_kJ: Option<f64>,
}

#[derive(Debug, Serialize)]
struct AtPitch {
    pitch_deg: f64,
    speed_m_s: Option<f64>,
    horizontal_m_s: Option<f64>,
    down_m_s: Option<f64>,
}

fn water(p: &Parameters<f64>) -> Surroundings<f64> {
    Surroundings {
        density_kg_m3: DENSITY_KG_M3,
        pressure_Pa: 0.0,
        temperature_C: p.reference_temperature_C,
        time_s: 0.0,
    }
}

/// The pitch down at which a glider of this net mass flies furthest over its depth \[deg\], and its glide ratio there.
pub(super) fn best_glide(p: &Parameters<f64>, net_mass_kg: f64) -> Option<(f64, f64)> {
    (10..=600)
        .filter_map(|tenths| {
            let pitch_deg = f64::from(tenths) / 10.0;
            let attitude = Attitude { pitch_rad: -pitch_deg.to_radians(), net_mass_kg };
            let glide = at_pitch(p, &water(p), attitude).ok()?;
            Some((pitch_deg, 1.0 / glide.glide_angle_rad.abs().tan()))
        })
        .max_by(|x, y| x.1.total_cmp(&y.1))
        // The first pitch of all is an edge, and no optimum.
        .filter(|(pitch_deg, _)| *pitch_deg > 1.0)
}

impl Compared {
    fn new(what: &str, vehicle: &Vehicle, net_mass_kg: f64, depth_m: f64) -> Compared {
        let p = vehicle.glide_parameters();
        let coefficient = |name: &str, value: f64, unit: &str| {
            let keys = [format!("hydro.descent.{name}"), format!("hydro.{name}")];
            let se = keys.iter().find_map(|key| vehicle.uncertainty.get(key)).copied().unwrap_or(0.0);
            Estimate::normal(value, se, unit)
        };
        let glide = |pitch_deg: f64| {
            at_pitch(&p, &water(&p), Attitude { pitch_rad: -pitch_deg.to_radians(), net_mass_kg }).ok()
        };
        let best = best_glide(&p, net_mass_kg);
        let dive = dive(&p, net_mass_kg, depth_m);
        let has_energy = vehicle.get("energy.hotel_W").is_some_and(|hotel| hotel > 0.0);
        let energy_kJ = dive.filter(|_| has_energy).map(|dive| dive.energy.total_J() / 1e3);
        Compared {
            what: what.to_owned(),
            vehicle: vehicle.name.clone(),
            a_per_rad: coefficient("a_per_rad", p.a_per_rad, "1/rad"),
            b: coefficient("b", p.b, "1"),
            c_per_rad2: coefficient("c_per_rad2", p.c_per_rad2, "1/rad2"),
            frontal_area_m2: p.frontal_area_m2,
            drag_area_m2: p.b * p.frontal_area_m2,
            best_glide_ratio: best.map(|(_, ratio)| ratio),
            best_glide_pitch_deg: best.map(|(pitch_deg, _)| pitch_deg),
            descents: PITCHES_DEG
                .map(|pitch_deg| {
                    let glide = glide(pitch_deg);
                    AtPitch {
                        pitch_deg,
                        speed_m_s: glide.as_ref().map(|glide| glide.speed_m_s),
                        horizontal_m_s: glide.as_ref().map(|glide| glide.horizontal_velocity_m_s),
                        down_m_s: glide.as_ref().map(|glide| glide.vertical_velocity_m_s),
                    }
                })
                .into(),
            dive_duration_h: dive.map(|dive| dive.duration_s / 3600.0),
            dive_distance_km: dive.map(|dive| dive.distance_m / 1e3),
            dive_energy_kJ: energy_kJ,
            energy_per_km_kJ: energy_kJ.zip(dive).map(|(energy, dive)| energy / (dive.distance_m / 1e3)),
        }
    }
}

/// A dive at 25 deg, with this net mass on the way down and the opposite on the way up.
fn dive(p: &Parameters<f64>, net_mass_kg: f64, depth_m: f64) -> Option<crate::plan::PerDive> {
    let ballast_m3 = net_mass_kg / DENSITY_KG_M3;
    let neutral_m3 = p.net_mass_kg(0.0, &water(p)) / DENSITY_KG_M3;
    let pitch_rad = 25f64.to_radians();
    let dive = Dive {
        depth_m,
        descent: LegOrder { pitch_rad: -pitch_rad, ballast_m3: neutral_m3 - ballast_m3 },
        ascent: LegOrder { pitch_rad, ballast_m3: neutral_m3 + ballast_m3 },
        surface_ballast_m3: neutral_m3 + ballast_m3,
        dives_per_surfacing: 1.0,
        stay_s: 600.0,
        pitch_moves: 4.0,
        surface_density_kg_m3: DENSITY_KG_M3,
    };
    per_dive(p, &dive).ok()
}

/// The comparison as JSON gives it.
#[derive(Debug, Serialize)]
struct CompareReport {
    schema: &'static str,
    net_mass_kg: f64,
    density_kg_m3: f64,
    gliders: Vec<Compared>,
    warnings: Vec<String>,
}

/// A figure with so many decimals, a dash for none.
fn or_dash(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

impl CompareReport {
    /// What is compared, line by line: a name with its unit, and a text for each glider.
    fn lines(&self) -> Vec<(String, Vec<String>)> {
        let line =
            |name: &str, of: &dyn Fn(&Compared) -> String| (name.to_owned(), self.gliders.iter().map(of).collect());
        let estimate = |e: &Estimate| {
            if e.se > 0.0 { crate::report::estimate(e.value, e.se) } else { format!("{:.4}", e.value) }
        };
        let mut lines = vec![
            line("lift slope a [1/rad]", &|g| estimate(&g.a_per_rad)),
            line("drag b", &|g| estimate(&g.b)),
            line("drag c [1/rad2]", &|g| estimate(&g.c_per_rad2)),
            line("frontal area [m2]", &|g| format!("{:.4}", g.frontal_area_m2)),
            line("drag area b A [m2]", &|g| format!("{:.4}", g.drag_area_m2)),
            line("best glide ratio", &|g| or_dash(g.best_glide_ratio, 2)),
            line("  at pitch [deg]", &|g| or_dash(g.best_glide_pitch_deg.map(|pitch| -pitch), 1)),
        ];
        for (i, pitch_deg) in PITCHES_DEG.iter().enumerate() {
            lines.push(line(&format!("speed at -{pitch_deg:.0} deg [m/s]"), &|g| or_dash(g.descents[i].speed_m_s, 3)));
            lines.push(line("  along [m/s]", &|g| or_dash(g.descents[i].horizontal_m_s, 3)));
            lines.push(line("  down [m/s]", &|g| or_dash(g.descents[i].down_m_s, 3)));
        }
        lines.push(line("a dive at 25 deg lasts [h]", &|g| or_dash(g.dive_duration_h, 2)));
        lines.push(line("  takes it [km]", &|g| or_dash(g.dive_distance_km, 2)));
        lines.push(line("  draws [kJ]", &|g| or_dash(g.dive_energy_kJ, 1)));
        lines.push(line("  per kilometre [kJ]", &|g| or_dash(g.energy_per_km_kJ, 1)));
        lines
    }

    fn print(&self) {
        println!("net mass {:.3} kg, water of {:.0} kg/m3", self.net_mass_kg, self.density_kg_m3);
        let width = self.gliders.iter().map(|glider| glider.what.chars().count()).max().unwrap_or(0).clamp(16, 32);
        let row = |name: &str, cells: Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| format!("{cell:>width$}")).collect();
            println!("{name:<28} {}", cells.join(" "));
        };
        row("", self.gliders.iter().map(|glider| glider.what.clone()).collect());
        for (name, cells) in self.lines() {
            row(&name, cells);
        }
    }

    /// What differs, as sentences: who glides furthest, who is fastest, who draws least.
    fn findings(&self) -> Vec<String> {
        let ranked = |of: &dyn Fn(&Compared) -> Option<f64>, smallest: bool| {
            let mut known: Vec<(f64, &str)> =
                self.gliders.iter().filter_map(|g| Some((of(g)?, g.what.as_str()))).collect();
            known.sort_by(|x, y| if smallest { x.0.total_cmp(&y.0) } else { y.0.total_cmp(&x.0) });
            (known.len() > 1).then(|| (known[0], known[known.len() - 1]))
        };
        let mut found = Vec::new();
        if let Some(((best, first), (least, last))) = ranked(&|g| g.best_glide_ratio, false) {
            found.push(format!("Best glide: {first} goes {best:.2} along for 1 down, {last} {least:.2}."));
        }
        let at_25_deg = |g: &Compared| g.descents.iter().find(|at| at.pitch_deg == 25.0).and_then(|at| at.speed_m_s);
        if let Some(((fast, first), (slow, last))) = ranked(&at_25_deg, false) {
            found.push(format!(
                "Speed at 25 deg and a net mass of {:.3} kg: {first} {fast:.3} m/s, {last} {slow:.3} m/s.",
                self.net_mass_kg
            ));
        }
        if let Some(((little, first), (much, last))) = ranked(&|g| g.energy_per_km_kJ, true) {
            found.push(format!("Energy per kilometre: {first} {little:.1} kJ, {last} {much:.1} kJ."));
        }
        found
    }

    fn page(&self, gliders: &[(String, Vehicle)]) -> Report {
        let names: Vec<&str> = self.gliders.iter().map(|glider| glider.what.as_str()).collect();
        let mut columns = vec!["Figure".to_owned()];
        columns.extend(names.iter().map(|name| (*name).to_owned()));
        let caption = "Coefficients on each glider's own frontal area; speeds at the same net mass.";
        let table = self.lines().into_iter().fold(Table::new(caption, columns), |table, (name, cells)| {
            table
                .row(std::iter::once(Cell::from(name.trim())).chain(cells.iter().map(|cell| Cell::from(cell.as_str()))))
        });
        let mut panel = Panel::new(Axis::new("Down", "w", "m/s").reversed());
        for (name, vehicle) in gliders {
            let p = vehicle.glide_parameters();
            let (along, down) = (5..=60)
                .filter_map(|degrees| {
                    let pitch_rad = -f64::from(degrees).to_radians();
                    let attitude = Attitude { pitch_rad, net_mass_kg: self.net_mass_kg };
                    at_pitch(&p, &water(&p), attitude).ok()
                })
                .map(|glide| (glide.horizontal_velocity_m_s, glide.vertical_velocity_m_s))
                .unzip();
            panel = panel.layer(Layer::line(along, down).label(name.clone()));
        }
        let figure = Figure::new("polars", Axis::new("Along", "u", "m/s")).panel(panel).caption(format!(
            "Descents at a net mass of {:.3} kg, pitch 5 to 60 deg. A line from the origin is a glide path.",
            self.net_mass_kg
        ));
        let mut page = Report::new("Gliders side by side", names.join(", "));
        for finding in self.findings() {
            page = page.finding(finding);
        }
        for warning in &self.warnings {
            page = page.warning(warning.clone());
        }
        page.section(Section::new("Polars").figure(figure)).section(Section::new("Figures").table(table))
    }
}
