//! Already reduced points: `points.csv` in one of three forms, with a `hull.toml` that says what they refer to.
//!
//! The forms, distinguished by their columns:
//! - `yaw_deg, CL, CD, CM`: coefficients on frontal area (moment also on overall length) about the centre of buoyancy;
//! - `yaw_deg, AF_N, SF_N, YM_N_m, speed_m_s`: forces about the moment centre, zero, interaction and tare already out;
//! - `yaw_deg, X', Y', N'`: SNAME primes on `reference_length_m` about the moment centre.
//!
//! Optional columns: `run_id`, `speed_m_s`, `water_temperature_c`, `CL_se`, `CD_se`, `CM_se`; others are ignored with a
//! notice. A `hull.toml`:
//!
//! ```toml
//! source = "Roddy 1990, DTRC/SHD-1298-08"   # optional
//! reference_length_m = 4.2609                # for primes: their length; default the overall length
//! speed_m_s = 3.34                           # optional: for the Reynolds number where no column says it
//!
//! [hull]                                     # as in a campaign's manifest
//! id = "SUBOFF"
//! ldr = 8.575
//! diameter_m = 0.508
//! loa_m = 4.356
//! mc_m = 2.013
//! cb_m = 2.0086
//!
//! [water]                                    # for forces and the Reynolds number
//! kind = "fresh"                             # or "sea"
//! temperature_c = 15.0
//! ```

use std::path::Path;

use glidepolar_hull::coefficients::{BalanceForce, HullCoefficients, PrimeForce};
use glidepolar_input::{InputError, Place, printable};
use serde::Deserialize;
use toml::Spanned;

use crate::hull::{Hull, HullKeys};
use crate::sweep::{Point, Sweep};
use crate::table::{Cells, Table, missing_column};
use crate::toml_file::Source;
use crate::water::{Water, WaterKeys};

/// A hull with its points.
#[derive(Debug, Clone)]
pub struct ReducedPoints {
    /// The hull.
    pub hull: Hull,
    /// The water, where stated.
    pub water: Option<Water>,
    /// Where the figures come from.
    pub source: String,
    /// The points.
    pub sweep: Sweep,
    /// What was ignored or assumed.
    pub notices: Vec<String>,
}

/// Reads both files.
///
/// # Errors
/// Where either cannot be used; with file, line and column.
pub fn read(points: &Path, hull: &Path) -> Result<ReducedPoints, InputError> {
    let description = Description::read(hull)?;
    let table = Table::read(points)?;
    let form = Form::read(&table)?;
    let mut notices = Vec::new();
    for column in table.header() {
        if !form.columns().contains(&column.as_str()) && !OPTIONAL.contains(&column.as_str()) {
            notices.push(format!("{}: column {} is not used", points.display(), printable(column)));
        }
    }
    let mut sweep = Sweep::default();
    for (order, row) in table.rows().enumerate() {
        sweep.points.push(point(&row, order, form, &description, hull)?);
    }
    if sweep.points.is_empty() {
        return Err(InputError::new(table.place(), "no points below the header"));
    }
    Ok(ReducedPoints { hull: description.hull, water: description.water, source: description.source, sweep, notices })
}

const OPTIONAL: [&str; 6] = ["run_id", "speed_m_s", "water_temperature_c", "CL_se", "CD_se", "CM_se"];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Coefficients,
    Forces,
    Primes,
}

impl Form {
    fn columns(self) -> &'static [&'static str] {
        match self {
            Form::Coefficients => &["yaw_deg", "CL", "CD", "CM"],
            Form::Forces => &["yaw_deg", "AF_N", "SF_N", "YM_N_m", "speed_m_s"],
            Form::Primes => &["yaw_deg", "X'", "Y'", "N'"],
        }
    }

    /// The form of which most columns are there; complains of the rest.
    fn read(table: &Table) -> Result<Form, InputError> {
        let present = |form: Form| form.columns()[1..].iter().filter(|c| table.has(c)).count();
        let forms = [Form::Coefficients, Form::Forces, Form::Primes];
        let form = forms.into_iter().max_by_key(|form| present(*form)).unwrap_or(Form::Coefficients);
        if present(form) == 0 {
            let error = missing_column(table.place(), "CL (or AF_N, or X')", table.header());
            return Err(error.help(
                "expected the columns yaw_deg, CL, CD, CM or yaw_deg, AF_N, SF_N, YM_N_m, speed_m_s or yaw_deg, X', Y', N'",
            ));
        }
        table.require(form.columns())?;
        Ok(form)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DescriptionKeys {
    #[serde(default)]
    source: String,
    reference_length_m: Option<Spanned<f64>>,
    speed_m_s: Option<Spanned<f64>>,
    hull: HullKeys,
    water: Option<WaterKeys>,
}

struct Description {
    hull: Hull,
    water: Option<Water>,
    source: String,
    reference_length_m: f64,
    speed_m_s: Option<f64>,
}

impl Description {
    fn read(file: &Path) -> Result<Self, InputError> {
        let source = Source::read(file)?;
        let keys: DescriptionKeys = source.parse()?;
        let hull = keys.hull.hull(&source)?;
        let positive =
            |name: &str, key: &Option<Spanned<f64>>| key.as_ref().map(|value| source.positive(name, value)).transpose();
        Ok(Description {
            reference_length_m: positive("reference_length_m", &keys.reference_length_m)?
                .unwrap_or(hull.geometry.loa_m),
            speed_m_s: positive("speed_m_s", &keys.speed_m_s)?,
            water: keys.water.map(|water| water.water(&source)).transpose()?,
            source: keys.source,
            hull,
        })
    }
}

fn point(row: &Cells, order: usize, form: Form, about: &Description, hull_file: &Path) -> Result<Point, InputError> {
    let yaw_deg = row.number("yaw_deg")?;
    if yaw_deg.abs() > 90.0 {
        let problem = format!("yaw_deg is {yaw_deg}, expected -90 to 90");
        return Err(InputError::new(row.place("yaw_deg"), problem));
    }
    let speed_m_s = match row.optional_number("speed_m_s")? {
        Some(speed) if speed <= 0.0 => {
            let problem = format!("speed_m_s is {speed}, expected a speed above zero");
            return Err(InputError::new(row.place("speed_m_s"), problem));
        }
        Some(speed) => Some(speed),
        None => about.speed_m_s,
    };
    let temperature_C = row.optional_number("water_temperature_c")?;
    let water = match (about.water, temperature_C) {
        (Some(water), Some(t)) => Some(water.at(t)),
        (water, _) => water,
    };
    let hull = &about.hull;
    let coefficients = match form {
        Form::Coefficients => {
            HullCoefficients { lift: row.number("CL")?, drag: row.number("CD")?, moment: row.number("CM")? }
        }
        Form::Forces => {
            let speed = row.number("speed_m_s")?;
            let water = water.ok_or_else(|| {
                InputError::new(Place::file(hull_file), "section [water] is missing: forces need the water's density")
                    .help("add [water] with kind = \"fresh\" or \"sea\" and temperature_c")
            })?;
            let force = BalanceForce {
                axial_N: row.number("AF_N")?,
                side_N: row.number("SF_N")?,
                yaw_N_m: row.number("YM_N_m")?,
            };
            about_cb(force, hull, yaw_deg, 0.5 * water.density_kg_m3 * speed * speed)
        }
        Form::Primes => {
            let force = PrimeForce { x: row.number("X'")?, y: row.number("Y'")?, n: row.number("N'")? };
            about_cb(force.at_unit_pressure(about.reference_length_m), hull, yaw_deg, 1.0)
        }
    };
    let se = |column: &str| -> Result<f64, InputError> {
        match row.optional_number(column)? {
            Some(se) if se < 0.0 => {
                Err(InputError::new(row.place(column), format!("{column} is {se}, expected zero or more")))
            }
            se => Ok(se.unwrap_or(0.0)),
        }
    };
    let run_id = row.text("run_id");
    Ok(Point {
        run_id: if run_id.is_empty() { format!("{}", order + 1) } else { run_id.to_owned() },
        order,
        start_time_s: None,
        yaw_deg,
        nominal_yaw_deg: yaw_deg,
        speed_m_s,
        nominal_speed_m_s: speed_m_s,
        dynamic_pressure_Pa: water.zip(speed_m_s).map(|(w, u)| 0.5 * w.density_kg_m3 * u * u),
        reynolds: water.zip(speed_m_s).map(|(w, u)| u * hull.geometry.loa_m / w.kinematic_viscosity_m2_s),
        temperature_C: temperature_C.or(water.map(|w| w.temperature_C)),
        coefficients: [coefficients.lift, coefficients.drag, coefficients.moment],
        se: [se("CL_se")?, se("CD_se")?, se("CM_se")?],
    })
}

fn about_cb(force: BalanceForce<f64>, hull: &Hull, yaw_deg: f64, pressure_Pa: f64) -> HullCoefficients<f64> {
    force.moved(hull.mc_m, hull.geometry.cb_m).in_wind_axes(yaw_deg.to_radians()).coefficients(
        pressure_Pa,
        hull.frontal_area_m2(),
        hull.geometry.loa_m,
    )
}
