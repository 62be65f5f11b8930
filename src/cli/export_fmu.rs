//! `glidepolar export-fmu`: a vehicle as a ready FMU, without a compiler.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glidepolar_archive::{Archive, Limits};

use super::CliError;
use crate::fmu_archive::{PackError, Water, pack};
use crate::input::InputError;
use crate::output::{Replace, write_whole};
use crate::vehicle::Vehicle;
use crate::water::WaterColumn;

/// Pack a vehicle as an FMU: the built library goes in as it is, start values and resources follow the vehicle
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar export-fmu rogue -o Rogue.fmu\n  \
    glidepolar export-fmu my-glider.toml -o MyGlider.fmu --fmi 2 --water-column summer.csv")]
pub struct Arguments {
    /// Vehicle file, or the name of a built-in vehicle
    vehicle: String,
    /// The archive to write; an earlier one of this program is replaced
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Version of the standard
    #[arg(long, value_enum, default_value = "3")]
    fmi: Standard,
    /// Table of density and temperature against depth that travels along (depth_m,density_kg_m3,temperature_C)
    #[arg(long, value_name = "FILE")]
    water_column: Option<PathBuf>,
    /// Packed FMU to take the library from; else it is looked for beside this program and in target/fmu
    #[arg(long, value_name = "FMU")]
    template: Option<PathBuf>,
    /// Replace the file, too, where this program did not write it
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Standard {
    /// FMI 2.0
    #[value(name = "2")]
    Fmi2,
    /// FMI 3.0
    #[value(name = "3")]
    Fmi3,
}

impl Standard {
    fn file(self) -> &'static str {
        match self {
            Standard::Fmi2 => "UnderwaterGlider_fmi2.fmu",
            Standard::Fmi3 => "UnderwaterGlider.fmu",
        }
    }

    fn version(self) -> &'static str {
        match self {
            Standard::Fmi2 => "fmiVersion=\"2.0\"",
            Standard::Fmi3 => "fmiVersion=\"3.0\"",
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let vehicle = Vehicle::load(&arguments.vehicle)?;
    let water = match &arguments.water_column {
        None => None,
        Some(path) => {
            let text = std::fs::read_to_string(path).map_err(|error| InputError::io(path, &error))?;
            Some((WaterColumn::parse(&text, path)?, text))
        }
    };
    let path = template(arguments)?;
    let template = Archive::read(&path, &Limits::default()).map_err(|error| CliError::Usage(error.to_string()))?;
    let description = String::from_utf8_lossy(template.get("modelDescription.xml").unwrap_or_default()).into_owned();
    if !description.contains(arguments.fmi.version()) {
        return Err(CliError::Usage(format!(
            "{} is no FMU of this version ({} expected); choose another --template or --fmi",
            path.display(),
            arguments.fmi.version()
        )));
    }
    let water = water.as_ref().map(|(column, text)| Water { column, text });
    let packed = pack(&template, &vehicle, water).map_err(|error| match error {
        PackError::MissingKeys(missing) => CliError::MissingKeys(missing),
        other => CliError::Usage(other.to_string()),
    })?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    packed.write_to(&mut bytes).map_err(|error| CliError::Failed(error.to_string()))?;
    let replace = if arguments.force || is_own(&arguments.output) { Replace::Any } else { Replace::Own };
    write_whole(&arguments.output, bytes.get_ref(), replace)?;
    println!("{}: {}, {}", arguments.output.display(), vehicle.name, arguments.fmi.version().replace('"', ""));
    Ok(())
}

/// Whether there is an FMU of this program already.
fn is_own(path: &Path) -> bool {
    let description = |archive: Archive| archive.get("modelDescription.xml").map(<[u8]>::to_vec);
    let found = Archive::read(path, &Limits::default()).ok().and_then(description);
    found.is_some_and(|text| String::from_utf8_lossy(&text).contains("generationTool=\"glidepolar\""))
}

/// Where the built library is.
fn template(arguments: &Arguments) -> Result<PathBuf, CliError> {
    if let Some(path) = &arguments.template {
        return Ok(path.clone());
    }
    let name = arguments.fmi.file();
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent).map(Path::to_owned);
    let mut places: Vec<PathBuf> = Vec::new();
    if let Some(beside) = beside {
        // target/release/glidepolar stands beside target/fmu, an installed program beside its share.
        places.extend([
            beside.join(name),
            beside.join("../fmu").join(name),
            beside.join("../share/glidepolar").join(name),
        ]);
    }
    places.push(Path::new("target/fmu").join(name));
    places.iter().find(|place| place.is_file()).cloned().ok_or_else(|| {
        let looked: Vec<String> = places.iter().map(|place| place.display().to_string()).collect();
        CliError::Usage(format!(
            "no packed {name} found (looked for {}); pack one with `cargo xtask fmu`, or name one with --template",
            looked.join(", ")
        ))
    })
}
