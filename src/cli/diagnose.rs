//! `glidepolar diagnose`: what the steady glide gets wrong in a log, why, the extension, the gain.

use std::path::PathBuf;

use clap::Args;

use super::diagnose_words::{
    checked, is_explained_by_trim, left_over, less, shown_in, shown_shear, size, table_without_cause, verdict, words,
};
use super::identify::TrimChoice;
use super::reading::Reading;
use super::{CliError, Output, diagnose_page, housekeeping, inputs, log_vehicle, print_notes, vehicle_input, warn};
use crate::diagnose::sea::{
    LEAST_RELEVANT, LiftSlope, Request, SeaError, SeaProblem, VehicleLogError, diagnose_vehicle, extended,
};
use crate::diagnose::{Checked, Diagnosis, Relevance};
use crate::identify::ExternalValue;
use crate::input::printable;
use crate::output::{Replace, check, write_whole};
use crate::reading::noted;
use crate::report::{InputFile, Report as Page};

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
    let inputs = inputs(&arguments.logs, Some(&arguments.vehicle));
    arguments
        .output
        .begin(&inputs, &[("--extended", arguments.extended.as_deref()), ("--out", arguments.out.as_deref())])?;
    let vehicle = log_vehicle::load(&arguments.vehicle, &arguments.logs)?;
    let replace = if arguments.output.force { Replace::Any } else { Replace::Never };
    // A diagnosis takes long: what cannot be written is refused before it.
    if let Some(path) = &arguments.extended {
        check(path, vehicle.to_toml().as_bytes(), replace)?;
    }
    let mut log = arguments.reading.read(&arguments.logs, &vehicle)?;
    let vehicle = log.located(vehicle)?;
    let trim = TrimChoice::trim(arguments.trim, &vehicle);
    let lift_slope = arguments.pin_lift.as_ref().map(|text| lift_slope(text.as_deref())).transpose()?;
    let quantities = LEAST_RELEVANT.map(|(name, _)| name);
    let relevance = Relevance::parse(&arguments.relevant, &quantities, "vertical_velocity=0.002")
        .map_err(|error| CliError::Usage(format!("--relevant: {error}")))?;
    let request = Request { trim: Some(trim), lift_slope, relevance };
    let contradictions = log.contradictions(&vehicle);
    // What contradicts the vehicle may be why there is no diagnosis.
    let (vehicle, mut found) = diagnose_vehicle(&vehicle, &log.observations, &request)
        .inspect_err(|_| warn(&contradictions))
        .map_err(|error| match error {
            VehicleLogError::Vehicle(error) => error.into(),
            VehicleLogError::Log(SeaError::Inconsistent(checks)) => log.inconsistent(checks).into(),
            // What was taken out in the reading may be what is missing.
            VehicleLogError::Log(error) => CliError::Failed(format!("{error}{}", noted(&log.notes))),
        })?;
    found.outcome.diagnosis.warnings.splice(0..0, log.left_out.iter().cloned().chain(contradictions));

    let extended = arguments.extended.as_ref().map(|path| Ok::<_, CliError>((path, extended(&vehicle, &found)?)));
    let extended = extended.transpose()?;
    if let Some((path, _)) = &extended {
        found.outcome.diagnosis.extended = Some(path.display().to_string());
    }
    if let Some(out) = &arguments.out {
        let mut page = diagnose_page::page(&vehicle.name, &found, trim.sentence());
        for log in &arguments.logs {
            page = page.input(InputFile::read(log)?);
        }
        page = housekeeping(&log.notes).into_iter().fold(page, Page::section);
        page.input(vehicle_input(&arguments.vehicle)?).write(arguments.output.folder(out)?)?;
    }
    if let Some((path, extended)) = &extended {
        write_whole(path, extended.to_toml().as_bytes(), replace)?;
    }
    if arguments.output.shows_tables() {
        println!("{}", log.steady_share());
        print(&found.outcome.diagnosis, &found.problem, trim.sentence());
        print_notes(&log.notes);
    }
    warn(&found.outcome.diagnosis.warnings);
    found.outcome.diagnosis.warnings.extend(log.notes);
    arguments.output.write_json(&found.outcome.diagnosis)
}

/// The lift slope that was asked for.
fn lift_slope(text: Option<&str>) -> Result<LiftSlope, CliError> {
    let Some(text) = text else { return Ok(LiftSlope::OfVehicle) };
    let wrong = || {
        let shown = printable(text);
        CliError::Usage(format!("--pin-lift={shown} is no lift slope: expected A or A+-SE, positive numbers per rad"))
    };
    let known = ExternalValue::parse(text).filter(|known| known.value > 0.0 && known.value < 1e3);
    known.map(LiftSlope::External).ok_or_else(wrong)
}

fn print(found: &Diagnosis, problem: &SeaProblem, trim: &str) {
    println!("{} stretches of steady glide; baseline: {trim}", problem.n_bins());
    if let Some(text) = problem.without_speed() {
        println!("{text}");
    }
    for check in found.consistency.iter().filter(|check| check.outcome != Checked::Consistent) {
        println!("{}", checked(check));
    }
    println!("WRONG");
    for wrong in &found.wrong {
        let (factor, unit) = shown_in(&wrong.quantity);
        println!(
            "  {} depends on {} by {:.2} {unit} rms: misfit {:.2} {unit}, the measurement explains {:.2} {unit} ({})",
            words(&wrong.quantity),
            wrong.regime,
            wrong.size * factor,
            wrong.rms * factor,
            wrong.expected_rms * factor,
            crate::report::probability(wrong.p_value)
        );
    }
    if is_explained_by_trim(found) {
        println!("  the trim explains it, which a neutral baseline does not know");
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
        let (factor, unit) = shown_in(&cause.quantity);
        println!(
            "  {}: {sizes}; held-out rms {:.2} -> {:.2} {unit}",
            words(&cause.cause),
            cause.holdout_rms_before * factor,
            cause.holdout_rms_after * factor
        );
        if !cause.indistinguishable_from.is_empty() {
            let alike: Vec<String> = cause.indistinguishable_from.iter().map(|name| words(name)).collect();
            println!("    these data cannot separate it from: {}", alike.join(", "));
        }
    }
    for set in &found.alternatives {
        let sizes: Vec<String> =
            set.iter().flat_map(|other| &other.parameters).map(|(name, estimate)| size(name, estimate)).collect();
        let place = if set.len() == 1 { "its place" } else { "the place of all these" };
        println!("  in {place} there may be: {}", sizes.join(" with "));
    }
    if let Some(unexplained) = &found.unexplained {
        println!("  unexplained: what is left depends on {}", unexplained.depends_on.join(", "));
    }
    if let Some(table) = &found.empirical {
        println!("  {}", table_without_cause(table));
    }
    if let Some(trim) = &found.trim {
        println!("  trim against the neutral baseline: {}", size("ballast_offset_kg", trim));
    }
    for left in &found.left {
        println!("  left: {}", left_over(left));
    }
    if let Some(share) = &found.shear_share {
        println!("  {}", shown_shear(share));
    }
    if let Some(path) = &found.extended {
        println!("EXTENSION: {path}");
    }
    println!("GAIN on data held out of the fit");
    for gain in &found.gains {
        let (factor, unit) = shown_in(&gain.quantity);
        println!(
            "  {}: {:.2} -> {:.2} {unit}, {} (95 %: {:.0} to {:.0} % less)",
            words(&gain.quantity),
            gain.holdout_rms_before * factor,
            gain.holdout_rms_after * factor,
            less(gain.reduction_percent),
            gain.ci95[0],
            gain.ci95[1]
        );
    }
}
