//! `glidepolar fmu`: where the packed FMU is; and the standards that there are archives for.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::CliError;

/// Print where the packed FMU of the default glider is
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    fmpy simulate \"$(glidepolar fmu)\" --stop-time 100\n  \
    glidepolar fmu --fmi 2\n\n\
    An FMU of your own vehicle: `glidepolar export-fmu`.")]
pub struct Arguments {
    /// Version of the standard
    #[arg(long, value_enum, default_value = "3")]
    fmi: Standard,
    /// The glider in six degrees of freedom
    #[arg(long = "3d")]
    space: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Standard {
    /// FMI 2.0
    #[value(name = "2")]
    Fmi2,
    /// FMI 3.0
    #[value(name = "3")]
    Fmi3,
}

impl Standard {
    /// The archive's name, as it is packed.
    pub fn file(self, space: bool) -> &'static str {
        match (self, space) {
            (Standard::Fmi2, false) => "UnderwaterGlider_fmi2.fmu",
            (Standard::Fmi3, false) => "UnderwaterGlider.fmu",
            (Standard::Fmi2, true) => "UnderwaterGlider3D_fmi2.fmu",
            (Standard::Fmi3, true) => "UnderwaterGlider3D.fmu",
        }
    }

    /// How its description names the standard.
    pub fn version(self) -> &'static str {
        match self {
            Standard::Fmi2 => "fmiVersion=\"2.0\"",
            Standard::Fmi3 => "fmiVersion=\"3.0\"",
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    println!("{}", packed(arguments.fmi, arguments.space)?.display());
    Ok(())
}

/// The packed archive of a standard, of the glider in the plane or in space: beside the installed program, or in a checkout's target folder.
///
/// # Errors
/// Where there is none; the message says where it was looked for.
pub(super) fn packed(standard: Standard, space: bool) -> Result<PathBuf, CliError> {
    let name = standard.file(space);
    let mut places: Vec<PathBuf> = Vec::new();
    if let Some(beside) = std::env::current_exe().ok().as_deref().and_then(Path::parent) {
        // target/release/glidepolar stands beside target/fmu, an installed program's folder beside its share.
        places.extend(["", "../fmu", "../share/glidepolar"].map(|folder| beside.join(folder).join(name)));
    }
    places.push(Path::new("target/fmu").join(name));
    let found = places.iter().find(|place| place.is_file());
    found.map(|place| std::fs::canonicalize(place).unwrap_or_else(|_| place.clone())).ok_or_else(|| {
        let looked: Vec<String> = places.iter().map(|place| place.display().to_string()).collect();
        CliError::Usage(format!(
            "no packed {name} found (looked for {}); install the wheel, pack one with `cargo xtask fmu`, or name one \
             with --template",
            looked.join(", ")
        ))
    })
}
