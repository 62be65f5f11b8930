//! `cargo xtask demo`: one pass from hull tests to the FMU in another program, on real and on synthetic data, with a
//! page that shows what came of each step and how to repeat it.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use glidepolar_archive::write_whole;

use crate::fmu;
use crate::python;
use crate::workspace::{Workspace, line, run as run_command};

const MISSION: &str = "tests/missions/sawtooth.csv";
/// The mission's end, s.
const STOP: &str = "2208";
/// Time between two rows and communication step, s.
const INTERVAL: &str = "8";

/// Runs the demonstration, leaves its page and says where.
pub fn run(workspace: &Workspace) -> Result<()> {
    let folder = workspace.target("demo");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    fs::create_dir_all(&folder)?;
    let python = python::ensure(workspace)?;
    let programs = ["--bin=glidepolar", "--bin=tank-reduce", "--bin=flight-report"];
    run_command(workspace.cargo_for_all("build").args(programs))?;
    let program = |name: &str| {
        let path = workspace.target("debug").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        workspace.command(path)
    };
    let fmus = fmu::run(workspace, &[], fmu::Scope::Host)?;
    let mut steps = Vec::new();

    let mut step = Step::new(workspace, "A measured hull", "suboff");
    step.text = "The bare hull of the DARPA SUBOFF, 24 drift angles (Roddy 1990): forces and moment as published, \
                 reduced to lift, drag and moment about the centre of buoyancy, with 95 % intervals.";
    let mut reduce = program("tank-reduce");
    reduce
        .args(["tank/data/suboff_roddy1990.csv", "--hull", "tank/data/suboff.toml", "--out"])
        .arg(folder.join("suboff"));
    step.run(&mut reduce)?;
    steps.push(step);

    let mut step = Step::new(workspace, "A campaign of raw runs", "campaign");
    step.text = "Five hulls in a virtual tank whose truth is known: every run a time history of the balance, with zero \
                 drift, noise, carriage vibration and the strut's own forces, all taken out again.";
    step.run(program("tank-reduce").arg("demo").arg(folder.join("pmm_runs")))?;
    step.run(program("tank-reduce").arg(folder.join("pmm_runs")).arg("--out").arg(folder.join("campaign")))?;
    steps.push(step);

    let mut step = Step::new(workspace, "The glider in other people's simulations", "flight");
    step.text = "A dive to 150 m and back: by the command line, and by FMPy from both FMUs, once with the FMU's own \
                 integration (Co-Simulation), once with FMPy's (Model Exchange). All five are the same flight.";
    let flights = folder.join("flights");
    fs::create_dir_all(&flights)?;
    let reference = flights.join("command_line.csv");
    let mut simulate = program("glidepolar");
    simulate.args(["simulate", "slocum-graver", "--inputs", MISSION, "--stop", STOP, "--interval", INTERVAL]);
    step.run(simulate.args(["--tolerance", "1e-12", "--csv"]).arg(&reference))?;
    let mut compare = program("flight-report");
    compare.arg(folder.join("flight")).arg(&reference);
    for (fmu, version) in [(&fmus.fmi3, "FMI_3"), (&fmus.fmi2, "FMI_2")] {
        step.run(workspace.command(python.interpreter()).args(["-m", "fmpy", "validate"]).arg(fmu))?;
        for interface in ["CoSimulation", "ModelExchange"] {
            let flown = flights.join(format!("FMPy_{version}_{interface}.csv"));
            let mut fly = workspace.command(python.interpreter());
            fly.args(["-m", "fmpy", "simulate"]).arg(fmu).args(["--interface-type", interface, "--stop-time", STOP]);
            fly.args(["--output-interval", INTERVAL, "--relative-tolerance", "1e-10", "--input-file", MISSION]);
            step.run(fly.arg("--output-file").arg(&flown))?;
            compare.arg(flown);
        }
    }
    step.run(&mut compare)?;
    steps.push(step);

    let page = folder.join("index.html");
    let html = page_of(&folder, &steps)?;
    write_whole(&page, |file| file.write_all(html.as_bytes()))?;
    println!("\nThe demonstration is in {}", page.display());
    Ok(())
}

/// A step of the demonstration: what is shown, and what was run for it.
struct Step<'w> {
    workspace: &'w Workspace,
    heading: &'static str,
    text: &'static str,
    /// Folder of its report, below the demonstration's.
    folder: &'static str,
    commands: Vec<String>,
}

impl<'w> Step<'w> {
    fn new(workspace: &'w Workspace, heading: &'static str, folder: &'static str) -> Self {
        Self { workspace, heading, text: "", folder, commands: Vec::new() }
    }

    fn run(&mut self, command: &mut Command) -> Result<()> {
        // As one would type it at the checkout's root, where it runs.
        let root = self.workspace.path("").display().to_string();
        self.commands.push(line(command).replace(&root, ""));
        run_command(command)
    }
}

/// The page: each step's figures as they stand in its own report, a link there, and its commands. The looks are those of
/// the reports.
fn page_of(folder: &Path, steps: &[Step<'_>]) -> Result<String> {
    let style = include_str!("../../crates/report/src/page.css");
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>glidepolar: from the hull to the FMU</title>\n<style>\n{style}img {{ width: 100%; background: #fff; }}\n\
         </style>\n</head>\n<body>\n<header>\n<p class=\"program\">glidepolar</p>\n<h1>From the hull to the FMU</h1>\n\
         <p class=\"subject\">what cargo xtask demo made</p>\n</header>\n<main>\n"
    );
    for step in steps {
        writeln!(html, "<section>\n<h2>{}</h2>\n<p>{}</p>", escape(step.heading), escape(step.text))?;
        for figure in figures(&folder.join(step.folder).join("figures"))? {
            let name = figure.file_stem().unwrap_or_default().to_string_lossy();
            let source = format!("{}/figures/{name}.svg", step.folder);
            writeln!(html, "<figure><img src=\"{}\" alt=\"{}\"></figure>", escape(&source), escape(&name))?;
        }
        writeln!(html, "<p><a href=\"{}/report.html\">The whole report</a></p>", escape(step.folder))?;
        writeln!(html, "<pre>{}</pre>\n</section>", escape(&step.commands.join("\n")))?;
    }
    html.push_str("</main>\n</body>\n</html>\n");
    Ok(html)
}

/// The SVG files of a folder, by name.
fn figures(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("there are no figures in {}", folder.display()))?;
    let mut figures = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    figures.retain(|path| path.extension().is_some_and(|extension| extension == "svg"));
    figures.sort();
    Ok(figures)
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_shows_every_figure_and_escapes_what_it_says() {
        let folder = tempfile::tempdir().unwrap();
        let workspace = Workspace::at(folder.path());
        let figures = folder.path().join("flight/figures");
        fs::create_dir_all(&figures).unwrap();
        for name in ["course.svg", "course.png", "a&b.svg"] {
            fs::write(figures.join(name), "").unwrap();
        }
        let mut step = Step::new(&workspace, "Depth < 150 m", "flight");
        step.commands.push("fmpy simulate 'my <glider>.fmu'".to_owned());
        let html = page_of(folder.path(), &[step]).unwrap();
        assert!(html.contains("flight/figures/course.svg") && html.contains("flight/figures/a&amp;b.svg"));
        assert!(!html.contains("course.png"));
        assert!(html.contains("Depth &lt; 150 m") && html.contains("my &lt;glider&gt;.fmu"));
        assert!(html.contains("href=\"flight/report.html\""));
    }

    #[test]
    fn a_step_without_figures_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let workspace = Workspace::at(folder.path());
        assert!(page_of(folder.path(), &[Step::new(&workspace, "Nothing", "nothing")]).is_err());
    }
}
