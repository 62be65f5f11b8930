//! `cargo xtask figures`: the figures in docs/figures/, drawn anew by the commands that the pages name. A test holds the
//! quick ones to what the commands draw today.

use std::fs;

use anyhow::{Context, Result};

use crate::wheel;
use crate::workspace::{Workspace, run as run_command};

/// A command that writes a report, and which of its figures are kept.
struct Drawing {
    arguments: &'static [&'static str],
    /// Name in the report, name in docs/figures/.
    figures: &'static [(&'static str, &'static str)],
}

const DRAWINGS: [Drawing; 3] = [
    Drawing { arguments: &["glide", "slocum-049"], figures: &[("polar", "glide-polar")] },
    Drawing {
        arguments: &["simulate", "slocum-049", "--mission", "missions/rising-seabed.toml"],
        figures: &[("depth", "rising-seabed"), ("record", "rising-seabed-record")],
    },
    Drawing {
        arguments: &["simulate", "slocum-049", "--mission", "missions/voyage-215.toml"],
        figures: &[("way", "voyage-215")],
    },
];

/// Draws them all.
pub fn run(workspace: &Workspace) -> Result<()> {
    wheel::build_programs(workspace)?;
    for (number, Drawing { arguments, figures }) in DRAWINGS.iter().enumerate() {
        let folder = workspace.target(format!("figures/{number}"));
        let mut command = wheel::program(workspace, "glidepolar");
        run_command(command.args(*arguments).arg("--quiet").arg("--out").arg(&folder))?;
        for (drawn, kept) in *figures {
            let from = folder.join(format!("figures/{drawn}.svg"));
            let to = workspace.path(format!("docs/figures/{kept}.svg"));
            fs::copy(&from, &to).with_context(|| format!("the report has no figure {}", from.display()))?;
            eprintln!("drew {}", workspace.shown(&to));
        }
    }
    Ok(())
}
