//! Compares flights: `flight-report FOLDER REFERENCE.csv FLOWN.csv...` draws the flights of several programs over each
//! other, with their differences from the first, and fails if one of them is not the same flight.

use std::path::PathBuf;
use std::process::ExitCode;

use glidepolar::output::OutputFolder;
use glidepolar::report::{Axis, Cell, Dash, Figure, InputFile, Layer, Panel, Report, Section, Table};
use glidepolar_tests::Trajectory;

/// What counts as the same: the largest difference, relative to the largest magnitude.
const SAME: f64 = 1e-6;
const COMPARED: [&str; 6] = ["depth_m", "x_m", "pitch_rad", "speed_m_s", "glide_angle_rad", "lift_N"];

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(folder), Some(reference)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: flight-report FOLDER REFERENCE.csv FLOWN.csv...");
        return ExitCode::from(2);
    };
    match compare(folder, reference, arguments.collect()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            eprintln!("the flights differ by more than {SAME:e} relative");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn compare(folder: PathBuf, reference: PathBuf, flown: Vec<PathBuf>) -> Result<bool, Box<dyn std::error::Error>> {
    let name = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().replace('_', " ");
    let flights: Vec<(String, Trajectory)> = flown.iter().map(|path| (name(path), Trajectory::read(path))).collect();
    let against = Trajectory::read(&reference);

    let mut table = Table::new(
        format!(
            "Largest difference from \"{}\", relative to the largest magnitude of each quantity.",
            name(&reference)
        ),
        std::iter::once("flight").chain(COMPARED),
    );
    let mut worst = 0.0_f64;
    for (title, flight) in &flights {
        let deviations = COMPARED.map(|quantity| flight.deviation(&against, quantity));
        worst = deviations.iter().fold(worst, |worst, deviation| worst.max(*deviation));
        table.push(
            std::iter::once(Cell::from(title.as_str())).chain(deviations.map(|d| format!("{d:.1e}").as_str().into())),
        );
    }

    let mut report = Report::new("Flights", "one mission, flown by several programs")
        .finding(format!(
            "{} flights and \"{}\" agree within {worst:.1e} of each quantity's largest magnitude.",
            flights.len(),
            name(&reference)
        ))
        .section(Section::new("Course").figure(course(&name(&reference), &against, &flights)).table(table));
    for path in std::iter::once(&reference).chain(&flown) {
        report = report.input(InputFile::read(path)?);
    }
    report.write(OutputFolder::open(folder, false)?)?;
    Ok(worst <= SAME)
}

fn course(name: &str, reference: &Trajectory, flights: &[(String, Trajectory)]) -> Figure {
    let panel = |label, symbol, unit, quantity: &str, scale: f64, reversed: bool| {
        let axis = Axis::new(label, symbol, unit);
        let axis = if reversed { axis.reversed() } else { axis };
        let line = |title: &str, flight: &Trajectory, dash| {
            let values = flight.column(quantity).iter().map(|value| value * scale).collect();
            Layer::line(flight.time_s.clone(), values).dash(dash).label(title)
        };
        let others = flights.iter().map(|(title, flight)| line(title, flight, Dash::Dashed));
        Panel::new(axis).layer(line(name, reference, Dash::Solid)).layers(others)
    };
    let degrees = 1f64.to_degrees();
    Figure::new("course", Axis::new("Time", "t", "s"))
        .panel(panel("Depth", "z", "m", "depth_m", 1.0, true))
        .panel(panel("Pitch", "θ", "deg", "pitch_rad", degrees, false))
        .panel(panel("Speed", "V", "m/s", "speed_m_s", 1.0, false))
        .caption("The flights lie on one another: dashed the FMU in its importers, solid the command line.")
}
