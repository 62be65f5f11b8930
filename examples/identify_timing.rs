//! How long an identification takes: the steady fit and the unsteady one, the log already read.
//!
//!     cargo run --release --example identify_timing -- LOG.csv VEHICLE [SPEED_COLUMN [PITCH_COLUMN]]

use std::time::Instant;

use glidepolar::identify::inflections::inflections;
use glidepolar::identify::{Question, Trim, Unsteady, by_dive, fit};
use glidepolar::log::{Channel, Columns, Opened, Preparation, PreparationSettings, open};
use glidepolar::vehicle::Vehicle;

/// Times of one task are the least of so many runs: what the machine does besides only adds.
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, vehicle, columns @ ..] = &arguments[..] else { return Err("expected LOG.csv VEHICLE".into()) };
    let mut chosen = Columns::default();
    for (column, channel) in columns.iter().zip([Channel::Speed, Channel::Pitch]) {
        chosen.choose(channel, column);
    }
    let vehicle = Vehicle::load(vehicle)?;
    let start = Instant::now();
    let Opened::Series(mut series) = open(log, &chosen)? else { return Err("expected a time series".into()) };
    let mut preparation = Preparation::new(PreparationSettings::default());
    let mut observations = Vec::new();
    while let Some(piece) = series.next_piece(200_000)? {
        preparation.push(piece, &mut observations);
    }
    preparation.finish(&mut observations);
    println!("reading       {:8.1} ms, {} samples", start.elapsed().as_secs_f64() * 1e3, observations.len());

    let mut baseline = Trim::Neutral.baseline(&vehicle.glide_parameters(), &observations);
    let has_speed = !columns.is_empty();
    if !has_speed {
        baseline.a_per_rad = 21.0;
    }
    let free: &[&str] = if has_speed { &["a_per_rad", "b", "ballast_offset_kg"] } else { &["b", "ballast_offset_kg"] };
    let question = Question::new(baseline, free)?;
    let mut found = fit(&question, &mut by_dive(&observations))?;
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        let mut dives = by_dive(&observations);
        found = fit(&question, &mut dives)?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!(
        "steady fit    {:8.1} ms, {} evaluations, w rms {:.2} mm/s over a minute",
        best * 1e3,
        found.evaluations,
        found.tally.sink.rms() * 1e3
    );

    let unsteady = Unsteady { from_dbar: 3.0, half_window_s: 4.0 };
    let mut best = f64::INFINITY;
    let mut flown = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        flown = Some(inflections(&question, &found.parameters, &observations, &unsteady)?);
        best = best.min(start.elapsed().as_secs_f64());
    }
    if let Some(flown) = flown {
        println!(
            "unsteady fit  {:8.1} ms, its hold-out and scores included, {} evaluations, w rms {:.2} mm/s",
            best * 1e3,
            flown.fit.evaluations,
            flown.score.w_rms_m_s * 1e3
        );
    }
    Ok(())
}
