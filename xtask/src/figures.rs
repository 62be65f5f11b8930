//! `cargo xtask figures`: the figures in docs/figures/, drawn anew by the commands that the pages name. The tests run it
//! with `--check`, which holds those that are there to what the commands draw today.

use std::fs;

use anyhow::{Context, Result, bail};

use crate::wheel;
use crate::workspace::{Workspace, run as run_command};

/// A command that writes a report, and which of its figures are kept.
struct Drawing {
    arguments: &'static [&'static str],
    /// Name in the report, name in docs/figures/.
    figures: &'static [(&'static str, &'static str)],
}

const DRAWINGS: [Drawing; 6] = [
    Drawing { arguments: &["glide", "slocum-049"], figures: &[("polar", "glide-polar")] },
    Drawing {
        arguments: &["simulate", "slocum-049", "--mission", "missions/rising-seabed.toml"],
        figures: &[("depth", "rising-seabed"), ("record", "rising-seabed-record")],
    },
    Drawing {
        arguments: &["simulate", "slocum-049", "--mission", "missions/voyage-215.toml"],
        figures: &[("way", "voyage-215")],
    },
    Drawing {
        arguments: &["turn", "seaglider", "--roll-mass-deg", "40", "--net-mass-kg", "0.19", "--pitch-deg", "-22.5"],
        figures: &[("polar-roll-mass", "turn-polar")],
    },
    Drawing {
        arguments: &["simulate", "slocum-049", "--3d", "--inputs", "tests/missions/turning.csv", "--stop", "1104"],
        figures: &[("map", "spiral")],
    },
    Drawing {
        arguments: &["simulate", "slocum-049", "--3d", "--mission", "missions/lawn-mower.toml"],
        figures: &[("map", "lawn-mower")],
    },
];

/// Draws them all; where they are only to be checked, nothing is written and the first that differs is an error.
pub fn run(workspace: &Workspace, check: bool) -> Result<()> {
    wheel::build_programs(workspace)?;
    for (number, Drawing { arguments, figures }) in DRAWINGS.iter().enumerate() {
        let folder = workspace.target(format!("figures/{number}"));
        let mut command = wheel::program(workspace, "glidepolar");
        run_command(command.args(*arguments).arg("--quiet").arg("--out").arg(&folder))?;
        for (drawn, kept) in *figures {
            let from = folder.join(format!("figures/{drawn}.svg"));
            let to = workspace.path(format!("docs/figures/{kept}.svg"));
            let figure = fs::read(&from).with_context(|| format!("the report has no figure {}", from.display()))?;
            if !check {
                fs::write(&to, figure).with_context(|| format!("cannot write {}", to.display()))?;
                eprintln!("drew {}", workspace.shown(&to));
            } else if fs::read(&to).ok() != Some(figure) {
                bail!("{} is stale: draw it anew by `cargo xtask figures`", workspace.shown(&to));
            }
        }
    }
    Ok(())
}
