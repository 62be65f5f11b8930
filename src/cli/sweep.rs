//! `glidepolar simulate --sweep`: one vehicle in many variants, all flown through the same inputs on all cores; the last
//! moment of each. What is finished is kept beside the table, so that an interrupted sweep goes on with `--resume`.
//!
//! A variant starts where the vehicle itself does, as an FMU does whose parameters were set.

use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use csv::{ReaderBuilder, StringRecord};
use rayon::prelude::*;
use serde::Serialize;

use super::sweep_journal::Journal;
use super::{CliError, Output};
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use crate::glide::start;
use crate::input::lines::TextLines;
use crate::input::{InputError, Place, nearest, printable};
use crate::simulate::{COLUMNS, Row, Schedule, SimulationSettings, fly_from};
use glidepolar_progress::{Step, Watch};

/// A table of more numbers than this is no sweep for one machine.
const MOST_NUMBERS: usize = 50_000_000;

/// What a sweep is asked for.
pub(super) struct Request<'a> {
    pub vehicle: &'a str,
    pub parameters: &'a Parameters<f64>,
    /// The table of variants.
    pub file: &'a Path,
    pub schedule: &'a Schedule,
    pub settings: &'a SimulationSettings,
    /// Where the last moments go.
    pub csv: Option<&'a Path>,
    /// Whether to go on where an interrupted sweep stopped.
    pub resumes: bool,
}

/// Variants that are flown at once, and lost at most where a sweep is interrupted.
const BATCH: usize = 256;

pub(super) fn run(request: &Request, output: &Output) -> Result<(), CliError> {
    let variants = Variants::read(request.file)?;
    let question =
        format!("{:?} {:?} {:?} {variants:?}", request.parameters.as_array(), request.schedule, request.settings);
    if let Some(csv) = request.csv {
        output.check(csv, variants.header().as_bytes())?;
    }
    let mut journal = request.csv.map(|csv| Journal::open(csv, &question, request.resumes)).transpose()?;
    let width = variants.parameters.len();
    let all = variants.values.len() / width;
    let kept = journal.as_ref().map_or(0, Journal::len);
    let mut failed: Vec<usize> = Vec::new();
    failed.extend(
        journal
            .iter()
            .flat_map(|journal| (1..).zip(journal.rows().lines()))
            .filter_map(|(row, line)| line.ends_with(',').then_some(row)),
    );
    let begin = start(request.parameters);
    let (clock, watch, flown) = (Instant::now(), Watch::current(), AtomicUsize::new(kept));
    let last_moment = |values: &[f64]| {
        let mut changed = *request.parameters;
        for (column, value) in variants.parameters.iter().zip(values) {
            *changed.at(*column) = *value;
        }
        let mut last = None;
        let flight = fly_from(&begin.with(&changed), &changed, request.schedule, request.settings, |row| {
            last = Some(*row);
            true
        });
        let done = flown.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(watch) = &watch {
            watch.step(Step { what: "variants", done, total: all });
        }
        flight.ok().and(last)
    };
    let mut done = kept;
    for batch in variants.values[kept * width..].chunks(BATCH * width) {
        let ends: Vec<Option<Row>> = batch.par_chunks(width).map(last_moment).collect();
        failed.extend((done + 1..).zip(&ends).filter(|(_, end)| end.is_none()).map(|(row, _)| row));
        done += ends.len();
        if let Some(journal) = &mut journal {
            journal.push(&rows(batch, width, &ends))?;
        }
    }
    let seconds = clock.elapsed().as_secs_f64();
    if let (Some(path), Some(journal)) = (request.csv, journal) {
        output.write(path, (variants.header() + journal.rows()).as_bytes())?;
        journal.close();
    }
    let report = Summary {
        schema: "glidepolar.sweep/1",
        vehicle: request.vehicle,
        variants: all,
        failed: &failed,
        stop_s: request.settings.stop_s,
        seconds,
        variants_per_s: (all - kept) as f64 / seconds,
    };
    if output.shows_tables() {
        report.print();
    }
    output.write_json(&report)
}

/// What is varied, and how.
#[derive(Debug)]
struct Variants {
    /// Which parameter each column is.
    parameters: Vec<usize>,
    /// Row by row.
    values: Vec<f64>,
}

impl Variants {
    fn read(file: &Path) -> Result<Self, InputError> {
        let failed = |error: csv::Error| {
            let line = error.position().map(|position| position.line() as usize);
            let place = line.map_or(Place::file(file), |line| Place::line(file, line));
            InputError::new(place, printable(&error.to_string()))
                .help("a table of variants has a header of parameters and a number for each in every row")
        };
        let text = std::fs::read(file).map_err(|error| InputError::io(file, &error))?;
        let mut lines = TextLines::new(&text);
        let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_slice());
        let header = reader.headers().map_err(failed)?.clone();
        let line_of_names = lines.ending_at(reader.position().byte());
        let mut parameters = Vec::new();
        for (column, name) in header.iter().enumerate() {
            let place = || Place::line(file, line_of_names).column(column + 1);
            let index = parameter_index(name).ok_or_else(|| {
                let error = InputError::new(place(), format!("unknown parameter `{}`", printable(name)));
                match nearest(name, PARAMETERS.iter().map(|row| row.name)) {
                    Some(near) => error.help(format!("did you mean `{near}`?")),
                    None => error.help("the parameters are those of the FMU: `fmpy info \"$(glidepolar fmu)\"`"),
                }
            })?;
            if parameters.contains(&index) {
                return Err(InputError::new(place(), format!("`{name}` stands twice")).help("leave one column out"));
            }
            parameters.push(index);
        }
        let (mut values, mut record) = (Vec::new(), StringRecord::new());
        while reader.read_record(&mut record).map_err(failed)? {
            let line = lines.ending_at(reader.position().byte());
            for (column, (cell, index)) in record.iter().zip(&parameters).enumerate() {
                let known = &PARAMETERS[*index];
                let value = cell.parse().ok().filter(|value| (known.min..=known.max).contains(value));
                values.push(value.ok_or_else(|| {
                    let place = Place::line(file, line).column(column + 1);
                    let problem = format!("`{}` cannot be {}", known.name, printable(cell));
                    InputError::new(place, problem)
                        .help(format!("expected a number from {} to {} {}", known.min, known.max, known.unit))
                })?);
            }
            if values.len() > MOST_NUMBERS {
                let error = InputError::new(Place::line(file, line), "too many variants for one sweep");
                return Err(error.help("split the table"));
            }
        }
        if values.is_empty() {
            return Err(InputError::new(Place::file(file), "no variants: expected a row for each under the header"));
        }
        Ok(Variants { parameters, values })
    }

    /// The names of the table's columns.
    fn header(&self) -> String {
        let names: Vec<&str> = self.parameters.iter().map(|index| PARAMETERS[*index].name).chain(COLUMNS).collect();
        names.join(",") + "\n"
    }
}

/// The parameters as they were read and, beside them, where each variant ended; nothing where it cannot be flown.
fn rows(values: &[f64], width: usize, ends: &[Option<Row>]) -> String {
    let mut table = String::new();
    for (values, end) in values.chunks(width).zip(ends) {
        for (column, value) in values.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(table, "{}{value}", if column == 0 { "" } else { "," });
        }
        for column in 0..COLUMNS.len() {
            let _ = match end {
                Some(end) => write!(table, ",{}", end[column]),
                None => write!(table, ","),
            };
        }
        table.push('\n');
    }
    table
}

/// What was done, as JSON gives it.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    schema: &'static str,
    vehicle: &'a str,
    variants: usize,
    /// Rows of the table, from 1, whose equations give no finite rate of change.
    failed: &'a [usize],
    stop_s: f64,
    seconds: f64,
    variants_per_s: f64,
}

impl Summary<'_> {
    fn print(&self) {
        println!(
            "{}: {} variants of {:.0} s each in {:.2} s, {:.0} a second",
            printable(self.vehicle),
            self.variants,
            self.stop_s,
            self.seconds,
            self.variants_per_s
        );
        if !self.failed.is_empty() {
            let rows: Vec<String> = self.failed.iter().take(20).map(usize::to_string).collect();
            println!("{} cannot be flown, rows {}: their cells are empty", self.failed.len(), rows.join(", "));
        }
    }
}
