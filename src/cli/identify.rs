//! `glidepolar identify`: the inverse process, from a flight log to coefficients and trim.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::reading::Reading;
use super::{CliError, Output, identify_page, identify_write, inputs, log_vehicle, print_notes, vehicle_input, warn};
use crate::identify::{
    ExternalValue, Given, Identification, IdentifyError, IdentifyReport, Request, Trim, Unsteady, identify, paper_form,
};
use crate::log::Shorten;
use crate::output::OutputFolder;
use crate::reading::PreparedLog;
use crate::report::{InputFile, Report};
use crate::vehicle::Vehicle;
use glidepolar_turning::{ByLeg, Turning, turning};

/// Glide polar, ballast offset and more from flight logs, and what the data cannot identify
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar identify p5420*.nc --vehicle seaglider\n  \
    glidepolar identify flight.csv --vehicle slocum-graver --speed-column U_dvl_m_s\n  \
    glidepolar identify flight.csv --vehicle my-glider.toml --free hull_compressibility_per_Pa\n  \
    glidepolar identify flight.csv --vehicle my-glider.toml --write identified.toml\n\n\
    LOG is a CSV file, Seaglider basestation files of consecutive dives, a Slocum or OG1 NetCDF time series, or a table\n\
    with one row per descent or ascent.")]
pub struct Arguments {
    /// Flight logs; several files are one log, in this order
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Vehicle file, name of a built-in vehicle, or from-file: what the log's own files state (Seaglider)
    #[arg(long, value_name = "VEHICLE")]
    vehicle: String,
    #[command(flatten)]
    reading: Reading,
    /// joint: all samples at once, with errors; iterative: the tank paper's scheme, descents and ascents apart
    #[arg(long, value_enum, default_value_t = Method::Joint)]
    method: Method,
    /// What the baseline takes for the net weight; default: neutral for a built-in vehicle, vehicle for a file
    #[arg(long, value_enum)]
    trim: Option<TrimChoice>,
    /// Fit this parameter, too (repeat); a, b, c or ballast_offset_kg: fit it whatever the data say
    #[arg(long, value_name = "NAME")]
    free: Vec<String>,
    /// Hold this parameter (repeat); with a standard error, the others' errors take it in: a=21+-3
    #[arg(long, value_name = "NAME=VALUE[+-SE]", allow_hyphen_values = true)]
    pin: Vec<String>,
    /// Fly the dives through time, with added mass: turns and accelerating samples take part
    #[arg(long)]
    unsteady: bool,
    /// Write the identified vehicle, with the standard errors of what was fitted, to FILE
    #[arg(long, value_name = "OUT.toml", help_heading = "Output", conflicts_with = "unsteady")]
    write: Option<PathBuf>,
    /// Write report.html with its figures, and the tables as CSV, into this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// Pressure from which on samples of the unsteady mode count: below the waves [dbar].
const UNSTEADY_FROM_DBAR: f64 = 3.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    Joint,
    Iterative,
}

/// The choice of the baseline's net weight, as a user makes it.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum TrimChoice {
    /// From the vehicle's mass and displaced volume
    Vehicle,
    /// Neutral at ballast volume zero in the mean water of the log
    Neutral,
}

impl TrimChoice {
    /// What was chosen; by default a built-in vehicle, which is not the user's own glider, is taken as neutral.
    pub fn trim(choice: Option<TrimChoice>, vehicle: &Vehicle) -> Trim {
        match choice {
            Some(TrimChoice::Vehicle) => Trim::Vehicle,
            Some(TrimChoice::Neutral) => Trim::Neutral,
            None => Trim::for_vehicle(vehicle),
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let pin = pins(&arguments.pin)?;
    let inputs = inputs(&arguments.logs, Some(&arguments.vehicle));
    arguments.output.begin(&inputs, &[("--write", arguments.write.as_deref()), ("--out", arguments.out.as_deref())])?;
    let vehicle = log_vehicle::load(&arguments.vehicle, &arguments.logs)?;
    // A fit takes long: what cannot be written is refused before it.
    if let Some(path) = &arguments.write {
        arguments.output.check(path, vehicle.to_toml().as_bytes())?;
    }
    let how = if arguments.unsteady { Shorten::Dives } else { Shorten::Means };
    let mut log = arguments.reading.read_shortened(&arguments.logs, &vehicle, how)?;
    let vehicle = log.located(vehicle)?;
    let mut warnings = log.corrected(&vehicle)?;
    warnings.extend(log.calibration.iter().flat_map(|own| log_vehicle::contradictions(&vehicle, own)));
    let trim = TrimChoice::trim(arguments.trim, &vehicle);
    if arguments.method == Method::Iterative {
        return iterative(arguments, &vehicle, log, warnings, trim);
    }
    let unsteady = arguments
        .unsteady
        .then_some(Unsteady { from_dbar: UNSTEADY_FROM_DBAR, half_window_s: arguments.reading.half_window_s });
    if arguments.unsteady && vehicle.get("added_mass.m3_kg").is_none() {
        return Err(CliError::Usage(format!(
            "--unsteady needs the added masses of the vehicle `{}`: `added_mass.m1_kg` and `added_mass.m3_kg` of its file",
            vehicle.name
        )));
    }
    let request = Request { trim, free: arguments.free.clone(), pin, unsteady };
    let steady = log.steady_share();
    // What contradicts the vehicle may be why nothing can be fitted.
    let found = identify(&vehicle, &log.observations, &request).inspect_err(|_| warn(&warnings))?;
    let turning = turning(&log.for_turning());
    let mut report = found.report(&vehicle, log.w_filter, log.notes);
    warnings.append(&mut report.warnings);
    warnings.extend(other_lift_slope(&vehicle, &report));
    report.warnings = warnings;
    report.turning = turning;
    if let Some(turning) = &report.turning {
        report.warnings.extend(turning.warnings.iter().cloned());
    }
    let identified = match &arguments.write {
        Some(path) => Some((path, identify_write::identified(&vehicle, &found, &report)?)),
        None => None,
    };
    if arguments.output.shows_tables() {
        println!("{steady}");
        print(&report, &found);
        identify_write::print_for_seagliders(&vehicle, &found, &report, log.calibration.as_ref());
        print_notes(&report.notes);
    }
    warn(&report.warnings);
    if let Some(out) = &arguments.out {
        let mut folder = arguments.output.folder(out)?;
        let page = identify_page::of_joint(
            &vehicle,
            &found,
            &report,
            &log.observations,
            log.calibration.as_ref(),
            &mut folder,
        )?;
        write_page(arguments, page, folder)?;
    }
    if let Some((path, identified)) = &identified {
        arguments.output.write(path, identified.to_toml().as_bytes())?;
    }
    arguments.output.write_json(&report)?;
    // What one dive shows stands above; no error of it is known, so that nothing is identified.
    Ok(found.has_enough_dives()?)
}

/// Standard errors from which on the log contradicts the vehicle's own lift slope: by chance in 3 logs of 1000.
const CONTRADICTS_SE: f64 = 3.0;

/// Whether the lift slope that was fitted is another than the vehicle's own.
fn other_lift_slope(vehicle: &Vehicle, report: &IdentifyReport) -> Option<String> {
    let fitted = report.parameters.get("a")?.as_ref().filter(|_| !report.pinned.contains_key("a"))?;
    let keys = ["hydro.descent.a_per_rad", "hydro.a_per_rad"];
    let own = keys.iter().find_map(|key| vehicle.get(key))?;
    let own_se = keys.iter().find_map(|key| vehicle.uncertainty.get(*key)).copied().unwrap_or(0.0);
    let apart = (fitted.value - own).abs() / fitted.se.hypot(own_se);
    (apart > CONTRADICTS_SE).then(|| {
        format!(
            "the log contradicts the lift slope of `{}`: {} +- {} per rad fitted, {} in the vehicle, {apart:.0} standard errors apart; another glider, a changed hull, or a wrong speed or density",
            vehicle.name,
            figure(fitted.value),
            figure(fitted.se),
            figure(own)
        )
    })
}

/// The tank paper's scheme, from the vehicle's coefficients and from half and double its lift slope.
fn iterative(
    arguments: &Arguments,
    vehicle: &Vehicle,
    log: PreparedLog,
    warnings: Vec<String>,
    trim: Trim,
) -> Result<(), CliError> {
    let PreparedLog { observations, w_filter, notes, .. } = log;
    let Some(mut report) = paper_form::iterative(vehicle, trim, &observations, w_filter, notes) else {
        return Err(CliError::Failed("the scheme has no solution for any leg: weight, pitch and sink rate contradict each other; is the trim right?".into()));
    };
    report.warnings.extend(warnings);
    if arguments.output.shows_tables() {
        println!(
            "{:<9} {:>8} {:>8} {:>8}   {:>8} {:>8} {:>8} {:>7} {:>7}",
            "leg", "first a", "b", "c", "a", "b", "c", "glides", "rounds"
        );
        for campaign in &report.campaigns {
            let (from, to) = (campaign.first_guess, campaign.coefficients());
            println!(
                "{:<9} {:>8.3} {:>8.3} {:>8.3}   {:>8.3} {:>8.3} {:>8.3} {:>7} {:>7}",
                if campaign.descends { "descents" } else { "ascents" },
                from.a,
                from.b,
                from.c,
                to.a,
                to.b,
                to.c,
                campaign.glides.len(),
                campaign.history.len()
            );
        }
        println!("vertical velocity of all steady samples, rms {:.1} mm/s", report.fit.w_rms_m_s * 1e3);
    }
    warn(&report.warnings);
    if let Some(out) = &arguments.out {
        let mut folder = arguments.output.folder(out)?;
        let page = identify_page::of_iterative(vehicle, &report, &mut folder)?;
        write_page(arguments, page, folder)?;
    }
    arguments.output.write_json(&report)
}

/// The page with what was read.
fn write_page(arguments: &Arguments, page: Report, folder: OutputFolder) -> Result<(), CliError> {
    let mut page = page.input(vehicle_input(&arguments.vehicle)?);
    for log in &arguments.logs {
        page = page.input(InputFile::read(log)?);
    }
    Ok(page.write(folder)?)
}

/// What is to be held, refused before a log is read where no glider has such a value.
fn pins(texts: &[String]) -> Result<Vec<Given>, CliError> {
    texts
        .iter()
        .map(|text| {
            let given = pin(text).ok_or_else(|| {
                CliError::Usage(format!("--pin {text}: expected NAME=VALUE or NAME=VALUE+-SE with numbers"))
            })?;
            given.check()?;
            Ok(given)
        })
        .collect()
}

fn pin(text: &str) -> Option<Given> {
    let (name, figure) = text.split_once('=')?;
    Some(Given { name: name.to_owned(), known: ExternalValue::parse(figure)? })
}

impl From<IdentifyError> for CliError {
    fn from(error: IdentifyError) -> Self {
        match error {
            IdentifyError::NoSamples | IdentifyError::CannotFly { .. } | IdentifyError::TooFewDives { .. } => {
                CliError::Failed(error.to_string())
            }
            IdentifyError::UnknownParameter(name) => {
                let known = crate::dynamics::PARAMETERS.iter().map(|row| row.name);
                let hint = crate::input::nearest(&name, known).map(|near| format!("; did you mean `{near}`?"));
                CliError::Usage(format!(
                    "there is no parameter `{}`{}",
                    crate::input::printable(&name),
                    hint.unwrap_or_default()
                ))
            }
            other => CliError::Usage(other.to_string()),
        }
    }
}

fn print(report: &IdentifyReport, found: &Identification) {
    let kind = if report.unsteady.is_some() { "samples" } else { "steady samples" };
    let glides = number_of(report.n_glides, "glide");
    println!("{glides}, {} {kind}, {}", report.n_samples, number_of(found.dives.len(), "dive"));
    if let Some(speed) = report.rows.get("speed").filter(|rows| rows.rows > 0) {
        println!(
            "measured speed: {} values on {} stretches of {} dives, worth {:.0} independent ones",
            speed.values, speed.rows, speed.dives, speed.independent
        );
    }
    println!("baseline: {}", report.trim_meaning);
    println!();
    println!("{:<30} {:>12} {:>11}   {:>12} {:>12}  unit", "parameter", "value", "se", "95 % from", "to");
    for (name, quantity) in &report.parameters {
        let Some(q) = quantity else { continue };
        match report.pinned.get(name) {
            Some(pin) => {
                let se = pin.se.map_or_else(|| "-".to_owned(), figure);
                println!("{name:<30} {:>12} {se:>11}   held: {}", figure(q.value), pin.source);
            }
            None => println!(
                "{name:<30} {:>12} {:>11}   {:>12} {:>12}  {}",
                figure(q.value),
                figure(q.se),
                figure(q.ci95[0]),
                figure(q.ci95[1]),
                q.unit
            ),
        }
    }
    for (name, pin) in &report.pinned {
        println!("  {name} is held: {}", pin.reason);
        let moves: Vec<String> = pin.moves.iter().map(|(name, by)| format!("{name} by {}", signed(*by))).collect();
        if !moves.is_empty() {
            println!("    one standard error more of it moves {}", moves.join(", "));
        }
    }
    println!();
    let fit = &report.fit;
    let line = |what: &str, in_sample: Option<f64>, held: Option<f64>| {
        let mm = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{:.1}", v * 1e3));
        if in_sample.is_some() {
            println!("{what:<34} {:>8} {:>10}  mm/s", mm(in_sample), mm(held));
        }
    };
    println!("{:<34} {:>8} {:>10}", "", "fitted", "held out");
    line("vertical velocity, rms", Some(fit.w_rms_m_s), fit.w_rms_holdout_m_s);
    line("  after a 9-point mean", fit.w_rms_9_point_m_s, fit.w_rms_9_point_holdout_m_s);
    line("speed, rms", fit.speed_rms_m_s, fit.speed_rms_holdout_m_s);
    line("speed, mean of measured less model", fit.speed_bias_m_s, fit.speed_bias_holdout_m_s);
    for (name, halves) in &report.halves {
        let [one, other] = halves.values.map(figure);
        println!(
            "{name} by either half of the dives: {one} and {other}, {} standard errors apart",
            figure((halves.values[0] - halves.values[1]).abs() / halves.difference_se)
        );
    }
    if let Some(c) = &report.unsteady {
        println!();
        println!("all samples below {} dbar, inflections included{:>17} {:>10}", c.from_dbar, "rms", "9-point");
        for (what, score) in [
            ("unsteady", &c.unsteady),
            ("unsteady, where a steady glide exists", &c.unsteady_where_steady_exists),
            ("steady, where it exists", &c.steady),
        ] {
            let smooth = score.w_rms_9_point_m_s.map_or_else(|| "-".to_owned(), |v| format!("{:.1}", v * 1e3));
            println!("  {what:<40} {:>7} samples {:>8.1} {smooth:>10}  mm/s", score.n, score.w_rms_m_s * 1e3);
        }
        if let Some(score) = &c.unsteady_at_steady_samples_holdout {
            let smooth = score.w_rms_9_point_m_s.map_or_else(|| "-".to_owned(), |v| format!("{:.2}", v * 1e3));
            let what = "unsteady, steady samples, held out";
            println!("  {what:<40} {:>7} samples {:>8.1} {smooth:>10}  mm/s", score.n, score.w_rms_m_s * 1e3);
        }
    }
    if let Some(b) = &report.pitch_balance {
        println!();
        let degrees = |rms: Option<f64>| rms.map_or_else(|| "-".to_owned(), |rms| format!("{:.2}", rms.to_degrees()));
        println!(
            "balance of moments: pitch rms {:.2} deg ({} held out, {} without d); CG {:.2} mm below CB, by a moving mass of {} kg",
            b.pitch_rms_rad.to_degrees(),
            degrees(b.pitch_rms_holdout_rad),
            degrees(b.pitch_rms_without_d_rad),
            b.cg_below_cb_m * 1e3,
            figure(b.moving_mass_kg)
        );
    }
    if let Some(legs) = &report.legs_apart {
        println!();
        println!(
            "legs apart, trim as it is: b = {:.3} on descents, {:.3} on ascents (w rms {:.1} mm/s); together, with an offset of {:.0} g: b = {:.3} (w rms {:.1} mm/s)",
            legs.descent_b,
            legs.ascent_b,
            legs.w_rms_m_s * 1e3,
            legs.ballast_offset_kg * 1e3,
            legs.joint_b,
            legs.joint_w_rms_m_s * 1e3
        );
    }
    if let Some(turning) = &report.turning {
        print_turning(turning);
    }
}

fn print_turning(turning: &Turning) {
    let ByLeg { descent, ascent } = &turning.turn_rate_per_roll_1_s;
    println!();
    println!("turning, {} settled stretches of {} dives", turning.stretches, turning.dives);
    let centre = |of: fn(&ByLeg<Option<crate::estimate::Estimate>>) -> &Option<crate::estimate::Estimate>| {
        turning.roll_centre.as_ref().and_then(|centre| of(centre).clone())
    };
    for (name, quantity) in [
        ("turn rate per roll, descents", descent.clone()),
        ("turn rate per roll, ascents", ascent.clone()),
        ("turn rate per rudder", turning.turn_rate_per_rudder_1_s.clone()),
        ("static list", turning.static_list_rad.clone()),
        ("rudder offset", turning.rudder_offset_rad.clone()),
        ("roll per roll mass", turning.roll_per_roll_mass.clone()),
        ("roll centre, descents", centre(|c| &c.descent)),
        ("roll centre, ascents", centre(|c| &c.ascent)),
    ] {
        if let Some(q) = quantity {
            println!(
                "{name:<30} {:>12} {:>11}   {:>12} {:>12}  {}",
                figure(q.value),
                figure(q.se),
                figure(q.ci95[0]),
                figure(q.ci95[1]),
                q.unit
            );
        }
    }
    if let Some(held_out) = &turning.holdout_rms_rad_s {
        println!(
            "turn rate, rms held out of sd: descents {:.3} of {:.3}, ascents {:.3} of {:.3} deg/s",
            held_out.descent.to_degrees(),
            turning.sd_rad_s.descent.to_degrees(),
            held_out.ascent.to_degrees(),
            turning.sd_rad_s.ascent.to_degrees()
        );
    }
    if let Some(halves) = &turning.halves {
        let both = |of: fn(&ByLeg<Option<crate::estimate::Estimate>>) -> &Option<crate::estimate::Estimate>| {
            let [odd, even] = [&halves.odd, &halves.even].map(|half| of(&half.turn_rate_per_roll_1_s));
            odd.as_ref().zip(even.as_ref())
        };
        for (leg, both) in [("descents", both(|k| &k.descent)), ("ascents", both(|k| &k.ascent))] {
            if let Some((odd, even)) = both {
                println!(
                    "turn rate per roll, {leg}: odd dives {} +- {}, even dives {} +- {} 1/s",
                    figure(odd.value),
                    figure(odd.se),
                    figure(even.value),
                    figure(even.se)
                );
            }
        }
    }
}

fn signed(value: f64) -> String {
    format!("{}{}", if value < 0.0 { '-' } else { '+' }, figure(value.abs()))
}

/// Formats a count with its noun.
fn number_of(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}

/// Four significant digits, as short as they can be written.
fn figure(value: f64) -> String {
    if !value.is_finite() {
        return "unknown".to_owned();
    }
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let places = if value == 0.0 { 1 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 6) };
    format!("{value:.*}", places as usize)
}
