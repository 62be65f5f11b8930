//! The command line `tank-reduce`: arguments in, files and a short table out. The library does the work.

#![allow(rustdoc::broken_intra_doc_links, reason = "the arguments' documentation is their help: units in brackets")]

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::{Args, CommandFactory, Parser, Subcommand};
use glidepolar_input::InputError;
use glidepolar_report::InputFile;
use glidepolar_terminal::{CliError, Output, shell, warn};

use crate::demo_cli;
use glidepolar_inference::relevance::Relevance;
use glidepolar_progress::{Step, Watch};
use glidepolar_tank::sweep::NAMES;
use glidepolar_tank::virtual_tank::Error;
use glidepolar_tank::{Options, Progress, output, reduce_campaign, reduce_points};

/// Hull tests in a towing tank: raw balance runs to lift, drag and moment coefficients
#[derive(Debug, Parser)]
#[command(name = "tank-reduce", version, max_term_width = 110)]
#[command(args_conflicts_with_subcommands = true, arg_required_else_help = true)]
#[command(after_help = "Examples:\n  \
    tank-reduce demo pmm_runs                          write a synthetic campaign\n  \
    tank-reduce pmm_runs                               reduce a campaign; results in tank_out\n  \
    tank-reduce pmm_runs --diagnose                    and say what is wrong in it, and why\n  \
    tank-reduce points.csv --hull hull.toml --json -   reduce a table of points\n\
    Exit code: 0 done, 1 no usable result or it could not be written, 2 the input cannot be used.")]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    reduce: Reduce,
    #[command(flatten)]
    shell: shell::Options,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo_cli::DemoArgs),
}

#[derive(Debug, Args)]
struct Reduce {
    /// A campaign's folder (campaign.toml, runs.csv, data/), or a table of points
    #[arg(value_name = "PMM_RUNS | POINTS.CSV")]
    input: Option<PathBuf>,
    /// The hull of a table of points
    #[arg(long, value_name = "HULL.TOML")]
    hull: Option<PathBuf>,
    /// Fit the points up to this angle [deg]
    #[arg(long, value_name = "DEG", default_value_t = 10.0, allow_negative_numbers = true)]
    range_deg: f64,
    /// Say what the steady runs depart from, why, by how much it helps to know
    #[arg(long)]
    diagnose: bool,
    /// Misfit above which a coefficient (CL, CD, CM) is called wrong; else a hundredth of its largest value and a tenth of its
    /// scatter
    #[arg(long, value_name = "QUANTITY=VALUE", requires = "diagnose")]
    relevant: Vec<String>,
    /// Take one unusable run for an error instead of leaving it out
    #[arg(long)]
    strict: bool,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "tank_out", help_heading = "Output")]
    out: PathBuf,
    #[command(flatten)]
    output: Output,
}

impl Cli {
    /// Does what was asked.
    ///
    /// # Errors
    /// Where the input cannot be used or the results cannot be written.
    pub fn run(self) -> Result<(), CliError> {
        match self.command {
            Some(Command::Demo(arguments)) => demo_cli::run(arguments).map_err(|error| match error {
                Error::FolderInUse { .. } | Error::Io { .. } => CliError::Failed(error.to_string()),
                _ => CliError::Usage(error.to_string()),
            }),
            None if self.shell.is_asked_for() => self.shell.run(Cli::command()),
            None => self.reduce.run(),
        }
    }
}

impl Reduce {
    fn run(&self) -> Result<(), CliError> {
        let Some(input) = &self.input else {
            return Err(CliError::Usage("name a campaign's folder or a table of points".to_owned()));
        };
        if !(self.range_deg > 0.0 && self.range_deg <= 90.0) {
            return Err(CliError::Usage(format!(
                "--range-deg {}: expected an angle above 0, up to 90",
                self.range_deg
            )));
        }
        self.has_own_places(input)?;
        let relevance = Relevance::parse(&self.relevant, &NAMES, "CL=0.005")
            .map_err(|error| CliError::Usage(format!("--relevant: {error}")))?;
        let mut results = match &self.hull {
            Some(hull) if input.is_dir() => {
                let (campaign, hull) = (input.display(), hull.display());
                let problem = format!(
                    "--hull {hull}: is the file of a hull for a table of points; the hulls of a campaign stand in {campaign}/campaign.toml"
                );
                return Err(CliError::Usage(problem));
            }
            Some(hull) if !hull.exists() => {
                let hull = hull.display();
                let problem = format!(
                    "--hull {hull}: there is no such file; name the TOML file that has the hull's length and frontal area"
                );
                return Err(CliError::Usage(problem));
            }
            Some(hull) => reduce_points(input, hull, self.range_deg)?,
            None if input.is_file() => {
                let problem = format!("{}: a table of points needs --hull hull.toml", input.display());
                return Err(CliError::Usage(problem));
            }
            None => self.reduce_campaign(input)?,
        };
        if self.diagnose {
            results.diagnose(&relevance);
            if let Some(diagnoses) = &mut results.diagnoses {
                diagnoses.extended_in(&self.out.join("fits.json").display().to_string());
            }
        }
        output::write(&results, self.inputs(input)?, self.output.folder(&self.out)?)?;
        if self.output.shows_tables() {
            output::print(&results);
        }
        warn(&results.warnings);
        self.output.write_json(&results.reduction())?;
        if !results.is_usable() {
            return Err(CliError::Failed("no usable result: no hull has a fit; the warnings say why".to_owned()));
        }
        Ok(())
    }

    /// Refuses results in the place of what is reduced: a table, or the files of a campaign.
    fn has_own_places(&self, input: &Path) -> Result<(), CliError> {
        let files = match input.is_dir() {
            true => ["campaign.toml", "runs.csv", "data"].map(|name| input.join(name)).to_vec(),
            false => vec![input.to_owned()],
        };
        let inputs: Vec<PathBuf> = self.hull.iter().cloned().chain(files).collect();
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        self.output.begin(&inputs, &[("--out", Some(&self.out))])
    }

    fn reduce_campaign(&self, folder: &Path) -> Result<glidepolar_tank::Results, CliError> {
        let (watch, done) = (Watch::current(), AtomicUsize::new(0));
        let watch = |progress: Progress| {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Some(watch) = &watch {
                watch.step(Step { what: "runs read", done, total: progress.runs });
            }
        };
        let options = Options { range_deg: self.range_deg, strict: self.strict };
        Ok(reduce_campaign(folder, &options, &watch)?)
    }

    /// The files that describe what is reduced.
    fn inputs(&self, input: &Path) -> Result<Vec<InputFile>, InputError> {
        let files = match &self.hull {
            Some(hull) => [input.to_owned(), hull.clone()],
            None => [input.join("campaign.toml"), input.join("runs.csv")],
        };
        files.iter().map(InputFile::read).collect()
    }
}
