//! `glidepolar export-fmu`: a vehicle as a ready FMU, without a compiler.

use std::path::PathBuf;

use clap::Args;
use glidepolar_archive::{Archive, Limits};

use super::fmu::{Standard, packed};
use super::{Changes, CliError, inputs, own_places, warn};
use crate::fmu_archive::{PackError, Water, pack, starts_at_rest};
use crate::input::printable;
use crate::log::{Dates, plain_table};
use crate::output::{Replace, write_whole};
use crate::water::WaterColumn;

/// Pack a vehicle as an FMU: the built library goes in as it is, start values and resources follow the vehicle
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar export-fmu rogue -o Rogue.fmu\n  \
    glidepolar export-fmu my-glider.toml -o MyGlider.fmu --fmi 2 --water-column summer.csv\n  \
    glidepolar export-fmu seaglider --3d -o Seaglider3D.fmu\n  \
    glidepolar export-fmu slocum-049 --set mechanisms.drag_growth_per_day=0.01 -o Fouled.fmu")]
pub struct Arguments {
    /// Vehicle file, or the name of a built-in vehicle
    vehicle: String,
    /// The archive to write; one that this program wrote and nobody changed is replaced
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Version of the standard
    #[arg(long, value_enum, default_value = "3")]
    fmi: Standard,
    /// The glider in six degrees of freedom: the vehicle file needs [lateral]
    #[arg(long = "3d")]
    space: bool,
    /// Table of density and temperature against depth that travels along (depth_m,density_kg_m3,temperature_C)
    #[arg(long, value_name = "FILE")]
    water_column: Option<PathBuf>,
    /// Packed FMU to take the library from; else it is looked for beside this program and in target/fmu
    #[arg(long, value_name = "FMU")]
    template: Option<PathBuf>,
    #[command(flatten)]
    changes: Changes,
    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
    /// Replace the file, too, where this program did not write it
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let inputs = inputs(arguments.water_column.iter().chain(&arguments.template), Some(&arguments.vehicle));
    own_places(&inputs, &[("-o", Some(&arguments.output))])?;
    let vehicle = arguments.changes.load(&arguments.vehicle)?;
    let water = match &arguments.water_column {
        None => None,
        Some(path) => {
            let text = plain_table(path, Dates::Since1970)?;
            Some((WaterColumn::parse(&text, path)?, text))
        }
    };
    let path = match &arguments.template {
        Some(path) => path.clone(),
        None => packed(arguments.fmi, arguments.space)?,
    };
    let template = Archive::read(&path, &Limits::default()).map_err(|error| CliError::Usage(error.to_string()))?;
    let description = String::from_utf8_lossy(template.get("modelDescription.xml").unwrap_or_default()).into_owned();
    let is_space = description.contains("modelName=\"UnderwaterGlider3D\"");
    if is_space != arguments.space {
        let (is, advice) = match is_space {
            true => ("six degrees of freedom", "add --3d"),
            false => ("the vertical plane", "leave --3d out"),
        };
        let path = path.display();
        return Err(CliError::Usage(format!("{path} is the FMU of {is}; {advice}, or choose another --template")));
    }
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
    if starts_at_rest(&vehicle, water)? {
        let name = printable(&vehicle.name);
        warn([format!("{name} has no steady glide down within its limits: the FMU starts level and at rest")]);
    }
    let mut bytes = std::io::Cursor::new(Vec::new());
    packed.write_to(&mut bytes).map_err(|error| CliError::Failed(error.to_string()))?;
    let replace = if arguments.force { Replace::Any } else { Replace::Own };
    write_whole(&arguments.output, bytes.get_ref(), replace)?;
    if !arguments.quiet {
        let (file, version) = (arguments.output.display(), arguments.fmi.version().replace('"', ""));
        println!("{file}: {}, {version}", printable(&vehicle.name));
    }
    Ok(())
}
