//! Streams the files of a fleet as one log until so many bytes were read, and prints rate and peak memory:
//! `log_stream [--cache DIR] GIGABYTES FILE...`. The files are read again and again, their times moved on each time, so that
//! the log is as long as a real one of that size; every sample goes the whole way that it goes in a command.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use glidepolar_flightlog::{
    Channel, Columns, Condenser, LogFiles, MOST_OBSERVATIONS, Piece, Preparation, PreparationSettings, Shorten,
};

fn main() -> ExitCode {
    match stream() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn stream() -> Result<(), Box<dyn std::error::Error>> {
    let mut columns = Columns::default();
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.next_if(|argument| argument == "--cache").is_some() {
        columns.cache(arguments.next().ok_or("--cache DIR")?);
    }
    let wanted_bytes: f64 = 1e9 * arguments.next().ok_or("how many gigabytes?")?.parse::<f64>()?;
    let files: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    let round_bytes: u64 = files.iter().map(|file| std::fs::metadata(file).map_or(0, |meta| meta.len())).sum();
    if round_bytes == 0 {
        return Err("no file, or only empty ones".into());
    }
    let mut preparation =
        Preparation::new(PreparationSettings { density_kg_m3: Some(1027.0), ..PreparationSettings::default() });
    let mut condenser = Condenser::new(Shorten::Means, MOST_OBSERVATIONS);
    let mut batch = Vec::new();
    let (mut bytes, mut samples, mut shift_s, mut last_s) = (0.0, 0usize, 0.0, f64::NAN);
    let begin = Instant::now();
    while bytes < wanted_bytes {
        let mut log = LogFiles::open(&files, &columns)?;
        let mut first_s = f64::NAN;
        while let Some(piece) = log.next_piece(50_000)? {
            let Piece::Series(mut piece) = piece else { continue };
            if first_s.is_nan() && !piece.is_empty() {
                first_s = piece.at(Channel::Time, 0);
                // The next voyage begins an hour after the last has ended.
                shift_s = if last_s.is_nan() { 0.0 } else { last_s + 3600.0 - first_s };
            }
            piece.column_mut(Channel::Time).iter_mut().for_each(|time| *time += shift_s);
            samples += piece.len();
            if let Some(time) = piece.column(Channel::Time).last() {
                last_s = *time;
            }
            preparation.push(*piece, &mut batch);
            condenser.take(&mut batch);
        }
        bytes += round_bytes as f64;
    }
    preparation.finish(&mut batch);
    condenser.take(&mut batch);
    let (observations, shortened) = condenser.finish();
    let seconds = begin.elapsed().as_secs_f64();
    println!(
        "{:.2} GB of files, {samples} samples, {} observations kept: {seconds:.1} s, {:.0} MB/s, peak memory {:.0} MB",
        bytes / 1e9,
        observations.len(),
        bytes / 1e6 / seconds,
        peak_MB().unwrap_or(f64::NAN)
    );
    println!("{}", shortened.unwrap_or_else(|| "nothing was shortened".to_owned()));
    Ok(())
}

/// Largest resident memory of this process so far, where the system states it \[MB\].
#[allow(non_snake_case, reason = "a unit")]
fn peak_MB() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kB| kB * 1024.0 / 1e6)
}
