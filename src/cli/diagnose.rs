//! `glidepolar diagnose`: what the steady glide gets wrong in a log, why, the extension, the gain.

use std::path::PathBuf;

use clap::Args;

use super::identify::{TrimChoice, with_error};
use super::reading::{Reading, noted, refused};
use super::{CliError, Output, diagnose_page, vehicle_input, warn};
use crate::diagnose::sea::{LEAST_RELEVANT, Lift, SeaDiagnosis, SeaError, SeaProblem, Settings, diagnose_log};
use crate::diagnose::{Check, Checked, Diagnosis, Left, Point, Problem, Relevance, Verdict};
use crate::dynamics::{Parameters, parameter_index};
use crate::estimate::Estimate;
use crate::identify::external_values::built_up_lift_slope;
use crate::input::printable;
use crate::output::{Replace, check, write_whole};
use crate::report::InputFile;
use crate::vehicle::Vehicle;

/// What is wrong in a log against a vehicle, why, the extended vehicle, the measured gain
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar diagnose flight.csv --vehicle my-glider.toml --extended better.toml\n  \
    glidepolar diagnose p5420*.nc --vehicle seaglider\n  \
    glidepolar diagnose flight.csv --vehicle my-glider.toml --speed-column U_dvl_m_s --json -\n\n\
    A mechanism is named only where held-out data confirm it; what these data cannot separate from it is\n\
    named beside it. `none` and `unexplained` are answers, too.")]
pub struct Arguments {
    /// Flight logs; several files are one log, in this order
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Vehicle file or name of a built-in vehicle
    #[arg(long, value_name = "VEHICLE")]
    vehicle: String,
    #[command(flatten)]
    reading: Reading,
    /// What the baseline takes for the net weight; default: neutral for a built-in vehicle, vehicle for a file
    #[arg(long, value_enum)]
    trim: Option<TrimChoice>,
    /// Hold the lift slope at the vehicle's value, or at A [1/rad, on the frontal area], known with the standard error SE
    #[arg(long, value_name = "A[+-SE]", num_args = 0..=1, require_equals = true)]
    pin_lift: Option<Option<String>>,
    /// Size above which a misfit is worth acting on, as vertical_velocity=0.002 or speed_through_water=0.005 [m/s]; default:
    /// the largest of a tenth of the measurement's own scatter and 0.001 m/s (0.003 m/s in speed)
    #[arg(long, value_name = "QUANTITY=VALUE")]
    relevant: Vec<String>,
    /// Write the vehicle with the named mechanisms in it to FILE
    #[arg(long, value_name = "OUT.toml")]
    extended: Option<PathBuf>,
    /// Write a page with figures (report.html) into DIR
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let mut vehicle = Vehicle::load(&arguments.vehicle)?;
    let log = arguments.reading.read(&arguments.logs, &vehicle)?;
    let trim = TrimChoice::of(arguments.trim, &vehicle);
    let pinned = arguments.pin_lift.as_ref().map(|text| pinned_lift(text.as_deref())).transpose()?;
    if let Some((Some(lift), _)) = pinned {
        hold_lift(&mut vehicle, lift)?;
    }
    // Without speed nothing tells the lift slope: a built-in Slocum is held where `identify` holds it.
    let has_speed = log.observations.iter().any(|o| o.speed_m_s.is_finite());
    let built_up = if has_speed || pinned.is_some() { None } else { built_up_lift_slope(&vehicle) };
    if let Some((lift, _)) = built_up {
        hold_lift(&mut vehicle, lift.value)?;
    }
    let lift = match (pinned, &built_up) {
        (Some((_, lift)), _) => lift,
        (None, Some(_)) => Lift::Held,
        (None, None) => Lift::Fitted,
    };
    let quantities = LEAST_RELEVANT.map(|(name, _)| name);
    let relevance = Relevance::parse(&arguments.relevant, &quantities, "vertical_velocity=0.002")
        .map_err(|error| CliError::Usage(format!("--relevant: {error}")))?;
    let settings = Settings { lift, relevance, ..Settings::default() };
    let parameters = vehicle.glide_parameters();
    let mut found = diagnose_log(&parameters, trim, &log.observations, settings).map_err(|error| match error {
        SeaError::Inconsistent(checks) => refused(checks, &log.notes),
        // What was taken out in the reading may be what is missing.
        SeaError::TooFew { .. } => CliError::Failed(format!("{error}{}", noted(&log.notes))),
    })?;
    if let Some((lift, source)) = built_up {
        let held = format!("no measured speed: the lift slope is held at {:.1} per rad: {source}", lift.value);
        found.told.diagnosis.warnings.push(held);
    }
    found.told.diagnosis.warnings.extend(log.notes.iter().cloned());

    let replace = if arguments.output.force { Replace::Any } else { Replace::Never };
    if let Some(path) = &arguments.extended {
        // What the trim took for the mass belongs to the extended vehicle as well, or it would fly at another weight.
        let trimmed_kg = found.baseline.hull_mass_kg - parameters.hull_mass_kg;
        extend(&mut vehicle, &found, &parameters, trimmed_kg)?;
        check(path, vehicle.to_toml().as_bytes(), replace)?;
        found.told.diagnosis.extended = Some(path.display().to_string());
    }
    if let Some(out) = &arguments.out {
        let mut page = diagnose_page::page(&vehicle.name, &found, trim.sentence());
        for log in &arguments.logs {
            page = page.input(InputFile::read(log)?);
        }
        page.input(vehicle_input(&arguments.vehicle)?).write(arguments.output.folder(out)?)?;
    }
    if let Some(path) = &arguments.extended {
        write_whole(path, vehicle.to_toml().as_bytes(), replace)?;
    }
    if arguments.output.shows_tables() {
        print(&found.told.diagnosis, &found.problem, trim.sentence());
    }
    warn(&found.told.diagnosis.warnings);
    arguments.output.write_json(&found.told.diagnosis)
}

/// The lift slope that was asked for, none for the vehicle's own, and what is done about it.
fn pinned_lift(text: Option<&str>) -> Result<(Option<f64>, Lift), CliError> {
    let Some(text) = text else { return Ok((None, Lift::Held)) };
    let wrong = || {
        let shown = printable(text);
        CliError::Usage(format!("--pin-lift={shown} is no lift slope: expected A or A+-SE, positive numbers per rad"))
    };
    let (lift, se) = with_error(text).filter(|(lift, _)| *lift > 0.0 && *lift < 1e3).ok_or_else(wrong)?;
    Ok((Some(lift), se.map_or(Lift::Held, |se_per_rad| Lift::Known { se_per_rad })))
}

/// Sets the lift slope, that of the legs as well where they were measured apart.
fn hold_lift(vehicle: &mut Vehicle, lift_per_rad: f64) -> Result<(), CliError> {
    vehicle.set("hydro.a_per_rad", lift_per_rad)?;
    for leg in ["hydro.descent.a_per_rad", "hydro.ascent.a_per_rad"] {
        if vehicle.get(leg).is_some() {
            vehicle.set(leg, lift_per_rad)?;
        }
    }
    Ok(())
}

/// Writes the polar that was fitted and the mechanisms that were named into a vehicle.
fn extend(
    vehicle: &mut Vehicle,
    found: &SeaDiagnosis,
    parameters: &Parameters<f64>,
    trimmed_kg: f64,
) -> Result<(), CliError> {
    let polar: &Point = &found.told.after.point;
    for ((name, _), value) in found.problem.baseline().iter().zip(&polar.baseline) {
        // One polar is fitted, that of descents; where the legs were measured apart each keeps its ratio.
        let before = parameter_index(name).map_or(0.0, |index| *parameters.clone().at(index));
        let ratio = if before == 0.0 { f64::NAN } else { value / before };
        for key in ["hydro.", "hydro.descent.", "hydro.ascent."].map(|table| format!("{table}{name}")) {
            if let Some(known) = vehicle.get(&key) {
                vehicle.set(&key, if ratio.is_finite() { known * ratio } else { *value })?;
            }
        }
    }
    if trimmed_kg != 0.0 {
        let mass = vehicle.get("mass.mass_kg").unwrap_or(0.0) + trimmed_kg;
        vehicle.set("mass.mass_kg", mass)?;
    }
    let trim_name = "ballast_offset_kg".to_owned();
    let trim = found.told.diagnosis.trim.as_ref().map(|trim| (&trim_name, trim));
    for (name, estimate) in found.told.diagnosis.causes.iter().flat_map(|cause| &cause.parameters).chain(trim) {
        if parameter_index(name).is_some() {
            vehicle.set(&format!("mechanisms.{name}"), estimate.value)?;
            if estimate.se > 0.0 {
                vehicle.set(&format!("uncertainty.mechanisms.{name}"), estimate.se)?;
            }
        }
    }
    Ok(())
}

fn print(found: &Diagnosis, problem: &SeaProblem, trim: &str) {
    println!("{} stretches of steady glide; baseline: {trim}", problem.n_bins());
    if !problem.has_speed() {
        println!(
            "no measured speed: the lift slope is held at the vehicle's value or near it, and some causes look alike"
        );
    }
    for check in found.consistency.iter().filter(|check| check.outcome != Checked::Consistent) {
        println!("{}", checked(check));
    }
    println!("WRONG");
    for wrong in &found.wrong {
        println!(
            "  {} depends on {} by {:.2} mm/s rms: misfit {:.2} mm/s, the measurement explains {:.2} mm/s ({})",
            words(&wrong.quantity),
            wrong.regime,
            wrong.size * 1e3,
            wrong.rms * 1e3,
            wrong.expected_rms * 1e3,
            crate::report::probability(wrong.p_value)
        );
    }
    if found.wrong.is_empty() {
        println!(
            "  {}",
            if found.causes.is_empty() {
                "nothing beyond what the measurement explains"
            } else {
                "the misfit is alike everywhere: it depends on no covariate"
            }
        );
    }
    println!("CAUSE: {}", verdict(found.verdict));
    for cause in &found.causes {
        let sizes: Vec<String> = cause.parameters.iter().map(|(name, estimate)| size(name, estimate)).collect();
        let sizes = if sizes.is_empty() { "exact".to_owned() } else { sizes.join(", ") };
        println!(
            "  {}: {sizes}; held-out rms {:.2} -> {:.2} mm/s",
            words(&cause.cause),
            cause.holdout_rms_before * 1e3,
            cause.holdout_rms_after * 1e3
        );
        if !cause.indistinguishable_from.is_empty() {
            let alike: Vec<String> = cause.indistinguishable_from.iter().map(|name| words(name)).collect();
            println!("    these data cannot separate it from: {}", alike.join(", "));
        }
    }
    for set in &found.alternatives {
        let sizes: Vec<String> =
            set.iter().flat_map(|other| &other.parameters).map(|(name, estimate)| size(name, estimate)).collect();
        println!("  these data cannot separate all of that from: {}", sizes.join(", "));
    }
    if let Some(unexplained) = &found.unexplained {
        println!("  unexplained: what is left depends on {}", unexplained.depends_on.join(", "));
    }
    if let Some(trim) = &found.trim {
        println!("  trim against the neutral baseline: {}", size("ballast_offset_kg", trim));
    }
    for left in &found.left {
        println!("  left: {}", left_over(left));
    }
    if let Some(path) = &found.extended {
        println!("EXTENSION: {path}");
    }
    println!("GAIN on data held out of the fit");
    for gain in &found.gains {
        println!(
            "  {}: {:.2} -> {:.2} mm/s, {} (95 %: {:.0} to {:.0} % less)",
            words(&gain.quantity),
            gain.holdout_rms_before * 1e3,
            gain.holdout_rms_after * 1e3,
            less(gain.reduction_percent),
            gain.ci95[0],
            gain.ci95[1]
        );
    }
}

/// What is left of a quantity, relevant or not.
pub(super) fn left_over(left: &Left) -> String {
    let Left { size, relevant_above, p_value, .. } = left;
    let judged = if size > relevant_above { "relevant" } else { "not relevant" };
    format!(
        "{} depends on {} by {:.2} mm/s rms at most ({}), {judged} with a limit of {:.2} mm/s",
        words(&left.quantity),
        left.depends_on,
        size * 1e3,
        crate::report::probability(*p_value),
        relevant_above * 1e3
    )
}

/// By how much an error became less, or more.
pub(super) fn less(percent: f64) -> String {
    format!("{:.0} % {}", percent.abs(), if percent < 0.0 { "more" } else { "less" })
}

/// A check in a line.
pub(super) fn checked(check: &Check) -> String {
    let outcome = match check.outcome {
        Checked::Consistent => "consistent",
        Checked::Mended => "wrong, corrected",
        Checked::Wrong => "wrong",
        Checked::NotChecked => "not checked",
    };
    format!("{}: {outcome}: {}", check.check, check.says)
}

pub(super) fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::None => "none",
        Verdict::Explained => "explained",
        Verdict::PartlyExplained => "explained in part",
        Verdict::Unexplained => "unexplained: something is wrong, and no known mechanism fits",
    }
}

/// A parameter with its standard error.
pub(super) fn size(name: &str, estimate: &Estimate) -> String {
    format!("{name} = {}{}", crate::report::estimate(estimate.value, estimate.se), unit(estimate))
}

/// The unit after a number; nothing after one that has none.
pub(super) fn unit(estimate: &Estimate) -> String {
    if matches!(estimate.unit.as_str(), "" | "1") { String::new() } else { format!(" {}", estimate.unit) }
}

pub(super) fn words(name: &str) -> String {
    name.replace('_', " ")
}
