//! `tank-reduce demo`: writes a synthetic campaign. Terminal only; what is written is the virtual tank's affair.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use glidepolar_progress::{Step, Watch};
use glidepolar_tank::virtual_tank::{
    EffectRequest, Error, Options, Progress, Variety, catalogue_text, write_campaign_watched,
};

/// Write a synthetic campaign of the five Phoenix hulls, with stated truth, to try the reduction on.
#[derive(Debug, Args)]
#[command(after_help = after_help())]
pub struct DemoArgs {
    /// Folder to write: new, empty, or an earlier synthetic campaign (which is replaced)
    #[arg(default_value = "pmm_runs")]
    folder: PathBuf,
    /// The same seed gives the same campaign
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Hide an effect, its size drawn from the seed or given: NAME, NAME=SIZE, NAME,NAME; may be repeated
    #[arg(long, value_name = "NAME[=SIZE]")]
    effect: Vec<String>,
    /// Test only this hull (LDR8.5, LDR9.5, LDR10.5, LDR11.5, LDR12.5); may be repeated
    #[arg(long, value_name = "ID")]
    hull: Vec<String>,
    /// Scale of everything random: 1 a good tank, 0 none
    #[arg(long, default_value_t = 1.0)]
    noise: f64,
    /// Tow only the strut and the hulls at fixed angles, without oscillations and turns
    #[arg(long)]
    statics_only: bool,
    /// Draw the tank as well: sampling, lengths of runs and zeros, programme, kinds of noise
    #[arg(long)]
    vary: bool,
    /// Size to aim at in MB (10^6 bytes), by more runs and finer sampling
    #[arg(long, value_name = "MB")]
    size_mb: Option<f64>,
    /// Replace an earlier synthetic campaign even where its files were edited
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

/// Examples, then what can be hidden.
fn after_help() -> String {
    let examples = "Examples:\n  \
        tank-reduce demo pmm_runs                           five hulls, nothing wrong\n  \
        tank-reduce demo pmm_runs --effect crossflow        something hidden, its size drawn from the seed\n  \
        tank-reduce demo small --hull LDR8.5 --seed 7       one hull, another campaign\n\n";
    examples.to_owned() + &catalogue_text()
}

/// Runs the command.
///
/// # Errors
/// Those of writing a campaign.
pub fn run(args: DemoArgs) -> Result<(), Error> {
    let mut effects = Vec::new();
    for list in &args.effect {
        effects.extend(EffectRequest::parse_list(list)?);
    }
    let options = Options {
        seed: args.seed,
        effects,
        hulls: args.hull,
        noise: args.noise,
        statics_only: args.statics_only,
        force: args.force,
        variety: if args.vary { Variety::Drawn } else { Variety::Phoenix },
        size_mb: args.size_mb,
    };
    let begin = Instant::now();
    let watch = Watch::current();
    let watch = |progress: Progress| {
        if let Some(watch) = &watch {
            watch.step(Step { what: "runs written", done: progress.runs_done, total: progress.runs });
        }
    };
    let truth = write_campaign_watched(&args.folder, &options, &watch)?;
    if !args.quiet {
        let megabytes = truth.data_bytes as f64 / 1e6;
        let rate = megabytes / begin.elapsed().as_secs_f64();
        glidepolar_terminal::print_line(format_args!(
            "{}: synthetic campaign, {} hulls, {} runs, {megabytes:.1} MB ({rate:.0} MB/s); truth in truth.toml",
            args.folder.display(),
            truth.hulls.len(),
            truth.runs.len(),
        ));
    }
    Ok(())
}
