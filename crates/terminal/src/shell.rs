//! What a shell and `man` need: completions and manual pages, made from the very definitions that parse the arguments.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;

use glidepolar_report::output::{Replace, write_whole};

use super::CliError;

/// Print completions for a shell
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar completions bash > ~/.local/share/bash-completion/completions/glidepolar\n  \
    glidepolar completions zsh > ~/.zfunc/_glidepolar\n  \
    glidepolar completions fish > ~/.config/fish/completions/glidepolar.fish")]
pub struct CompletionsArguments {
    /// The shell
    shell: Shell,
}

impl CompletionsArguments {
    /// Does what was asked.
    ///
    /// # Errors
    /// Where the result cannot be written.
    pub fn run(&self, command: Command) -> Result<(), CliError> {
        completions(command, self.shell)
    }
}

/// Write the manual pages
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar man ~/.local/share/man/man1 && man glidepolar-identify")]
pub struct ManArguments {
    /// Folder for the pages; made where it does not exist
    folder: PathBuf,
    /// Replace files, too, that this program did not write
    #[arg(long)]
    force: bool,
}

impl ManArguments {
    /// Does what was asked.
    ///
    /// # Errors
    /// Where the result cannot be written.
    pub fn run(&self, command: Command) -> Result<(), CliError> {
        man_pages(command, &self.folder, self.force)
    }
}

/// The same for a command line whose first argument is a path, where a further command could be taken for one.
#[derive(Debug, Args)]
pub struct Options {
    /// Print completions for a shell
    #[arg(long, value_name = "SHELL", exclusive = true, help_heading = "Shell")]
    completions: Option<Shell>,
    /// Write the manual page to DIR
    #[arg(long, value_name = "DIR", exclusive = true, help_heading = "Shell")]
    man: Option<PathBuf>,
}

impl Options {
    /// Whether any of them was given.
    pub fn is_asked_for(&self) -> bool {
        self.completions.is_some() || self.man.is_some()
    }

    /// Does what was asked.
    ///
    /// # Errors
    /// Where a page cannot be written.
    pub fn run(&self, command: Command) -> Result<(), CliError> {
        if let Some(shell) = self.completions {
            completions(command.clone(), shell)?;
        }
        self.man.as_ref().map_or(Ok(()), |folder| man_pages(command, folder, false))
    }
}

/// Prints the completions of a command line.
///
/// # Errors
/// Where standard output cannot be written to.
pub fn completions(mut command: Command, shell: Shell) -> Result<(), CliError> {
    let name = command.get_name().to_owned();
    // In one piece: the generator takes an output that closes early for a fault of its own.
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command, name, &mut text);
    std::io::stdout().write_all(&text).map_err(|error| CliError::Failed(error.to_string()))
}

/// Writes the manual page of a command line and of each of its commands: `NAME.1`, `NAME-COMMAND.1`.
///
/// # Errors
/// Where a page cannot be written, or there is a file that this program did not write and `force` is not set.
pub fn man_pages(command: Command, folder: &Path, force: bool) -> Result<(), CliError> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    write_pages(&command, folder, force)
}

fn write_pages(command: &Command, folder: &Path, force: bool) -> Result<(), CliError> {
    for below in command.get_subcommands().filter(|below| !below.is_hide_set()) {
        write_pages(below, folder, force)?;
    }
    let page = Man::new(command.clone());
    let mut text = Vec::new();
    page.render(&mut text).map_err(|error| CliError::Failed(error.to_string()))?;
    let replace = if force { Replace::Any } else { Replace::Own };
    Ok(write_whole(folder.join(page.get_filename()), &text, replace)?)
}
