//! `virtual-sea`: writes a glider's flight log with a hidden effect, its vehicle file, and the truth.

use clap::{Parser, ValueEnum};
use glidepolar_virtual_sea::ocean::Weather;
use glidepolar_virtual_sea::vehicle::Hull;
use glidepolar_virtual_sea::{Options, catalogue, generate, log, worlds};
use std::path::PathBuf;
use std::process::ExitCode;

/// Writes a glider's flight log with a hidden effect (log.csv), the vehicle file that its owner believes in
/// (vehicle.toml), and apart from them the truth (truth.json).
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Everything that is drawn follows from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// What to hide: NAME[=SIZE],... or `none`; sizes are drawn from the seed where absent
    #[arg(long, default_value = "none", value_name = "NAME[=SIZE],...")]
    effect: String,
    /// Whether the log has a measured speed through the water
    #[arg(long, default_value = "yes")]
    speed: YesNo,
    /// Kind of glider; drawn among the Slocums where absent
    #[arg(long)]
    hull: Option<HullName>,
    /// Duration of the log, hours
    #[arg(long, default_value_t = 12.0, value_parser = hours)]
    hours: f64,
    /// Dives to aim for
    #[arg(long, default_value_t = 14, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    dives: u32,
    /// A shelf in summer, its thermocline some metres thick; with `--dives 80` in 12 hours the dives end at some 60 m
    #[arg(long)]
    shelf: bool,
    /// Draw everything from the seed that a stranger's log may differ in: motion, water, glider, legs, instruments, duration
    #[arg(long, conflicts_with_all = ["hull", "shelf", "hours", "dives"])]
    world: bool,
    /// Roll, sideslip and yaw follow from equations of motion, as they do where an effect turns the glider
    #[arg(long, conflicts_with = "world")]
    lateral: bool,
    /// Folder for the files
    #[arg(long, required_unless_present = "list")]
    out: Option<PathBuf>,
    /// Print the table of effects as Markdown and stop
    #[arg(long)]
    list: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum YesNo {
    Yes,
    No,
}

#[derive(Clone, Copy, ValueEnum)]
enum HullName {
    Slocum200,
    SlocumDeep,
    Seaglider,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.list {
        print!("{}", catalogue::markdown());
        return ExitCode::SUCCESS;
    }
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("virtual-sea: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let folder = arguments.out.as_deref().ok_or("--out DIR is missing")?;
    let effects = catalogue::parse_requests(&arguments.effect).map_err(|error| error.to_string())?;
    let speed = matches!(arguments.speed, YesNo::Yes);
    if arguments.world {
        let world = worlds::generate_with(arguments.seed, speed, &effects);
        return log::write(&world.log, &world.vehicle_toml, &world.truth_json(), folder)
            .map_err(|error| error.to_string());
    }
    let options = Options {
        effects,
        speed,
        hours: arguments.hours,
        dives: arguments.dives,
        hull: arguments.hull.map(|name| match name {
            HullName::Slocum200 => Hull::Slocum200,
            HullName::SlocumDeep => Hull::SlocumDeep,
            HullName::Seaglider => Hull::Seaglider,
        }),
        weather: Weather { shelf: arguments.shelf, ..Weather::default() },
        lateral: arguments.lateral,
        ..Options::seeded(arguments.seed)
    };
    let sea = generate(&options);
    log::write(&sea.log, &sea.vehicle_toml, &sea.truth.to_json(), folder).map_err(|error| error.to_string())
}

fn hours(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(hours) if hours > 0.0 && hours <= 1000.0 => Ok(hours),
        _ => Err("a number of hours above 0, at most 1000".to_owned()),
    }
}
