//! Writes a log as it was read, for another program to compare: `log_values [--cache DIR] [--speed NAME] FILE...`.
//! A table goes to the output, warnings, notes and fixes to the standard error.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use glidepolar_flightlog::{CHANNELS, Channel, Columns, LogFiles, Piece};

fn main() -> ExitCode {
    match write() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn write() -> Result<(), Box<dyn std::error::Error>> {
    let (mut columns, mut files) = (Columns::default(), Vec::<PathBuf>::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or("an option without a value");
        match argument.as_str() {
            "--cache" => columns.cache(value()?),
            "--speed" => columns.choose(Channel::Speed, &value()?),
            "--column" => columns.choose_text(&value()?)?,
            "--unit" => columns.unit_text(&value()?)?,
            _ => files.push(argument.into()),
        }
    }
    let mut log = LogFiles::open(&files, &columns)?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let names: Vec<&str> = CHANNELS.iter().map(|info| info.name).collect();
    writeln!(out, "{}", names.join(","))?;
    while let Some(piece) = log.next_piece(100_000)? {
        let Piece::Series(piece) = piece else { continue };
        for row in 0..piece.len() {
            let cells = CHANNELS.iter().map(|info| piece.at(info.channel, row));
            let cells: Vec<String> = cells.map(|x| if x.is_finite() { x.to_string() } else { String::new() }).collect();
            writeln!(out, "{}", cells.join(","))?;
        }
    }
    out.flush()?;
    log.warnings().iter().for_each(|warning| eprintln!("warning: {warning}"));
    log.notes().iter().for_each(|note| eprintln!("note: {note}"));
    log.fixes().iter().for_each(|fix| eprintln!("fix: {} {} {}", fix.time_s, fix.lat_deg, fix.lon_deg));
    Ok(())
}
