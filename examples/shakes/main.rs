//! The figures and figures' numbers of `docs/theory/shakes.md`: `cargo run --release --example shakes -- FOLDER`.

mod run;

use glidepolar::dynamics::{Actuation, IntegrationError, Parameters};
use glidepolar::output::{Replace, write_whole};
use glidepolar::report::{Axis, Dash, Figure, Layer, Panel};
use glidepolar::vehicle::Vehicle;
use run::{Kept, Run};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "shakes".to_owned());
    let parameters = Vehicle::load("adelaide")?.parameters().expect("a built-in vehicle is complete");
    let runs = [Actuation::RawAlongAxis1, Actuation::Servo].map(|who| run::run(&parameters, who));
    let (Ok(figures), [Ok(forces), Ok(servo)]) = (figures(&parameters, &runs), &runs) else {
        panic!("the equations of a built-in vehicle have finite rates");
    };
    let folder = std::path::Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    for figure in figures {
        write_whole(folder.join(figure.stem()).with_extension("svg"), figure.svg().as_bytes(), Replace::Any)?;
    }
    eigenvalues(&parameters);
    for (name, run) in [("u1 = 0", forces), ("servo", servo)] {
        println!("{name}: {}", summary(run));
    }
    Ok(())
}

fn eigenvalues(parameters: &Parameters<f64>) {
    for angle in [run::GLIDE.0, -run::GLIDE.0] {
        for kept in [Kept::Locked, Kept::ForceAlongAxis1, Kept::Forces] {
            let found = run::eigenvalues(parameters, angle, kept);
            let found: Vec<String> = found.iter().map(|e| format!("{:.4}{:+.4}i", e.0, e.1)).collect();
            println!("{angle:+} deg, {kept:?}: {}", found.join("  "));
        }
    }
}

fn summary(run: &Run) -> String {
    let range = |index: usize, scale: f64| {
        let values = run.rows.iter().map(|row| row[index] * scale);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        format!("{low:.3} to {high:.3}")
    };
    let stopped = run.stopped_s.map_or("never".to_owned(), |time| format!("{time:.1} s"));
    format!(
        "net mass {} kg, pitch {} deg, depth {} m, moving mass at a stop after {stopped}",
        range(11, 1.0),
        range(3, 1f64.to_degrees()),
        range(1, 1.0),
    )
}

fn figures(
    parameters: &Parameters<f64>,
    runs: &[Result<Run, IntegrationError>; 2],
) -> Result<[Figure; 2], IntegrationError> {
    let [forces, servo] = runs.each_ref().map(|run| run.as_ref().map_err(|error| *error));
    let runs = [("u_1 = 0", forces?), ("mass placed by its servo", servo?)];
    Ok([the_run(&runs), the_onset(parameters)?])
}

/// The paper's Figures 5 to 8, one above the other.
fn the_run(runs: &[(&str, &Run); 2]) -> Figure {
    let panel = |axis: Axis, of: &dyn Fn(&Run, usize) -> f64| {
        runs.iter().enumerate().rev().fold(Panel::new(axis), |panel, (slot, (name, run))| {
            let times = run.rows.iter().map(|row| row[0]).collect();
            let values = (0..run.rows.len()).map(|i| of(run, i)).collect();
            panel.layer(Layer::line(times, values).label(*name).slot(1 - slot))
        })
    };
    Figure::new("shakes-run", Axis::new("Time", "t", "s"))
        .panel(panel(Axis::new("Ballast rate", "u_4", "g/s"), &|run, i| 1e3 * run.rates_kg_s[i]))
        .panel(panel(Axis::new("Net mass", "m_0", "g"), &|run, i| 1e3 * run.rows[i][11]))
        .panel(panel(Axis::new("Pitch", "θ", "deg"), &|run, i| run.rows[i][3].to_degrees()))
        .panel(panel(Axis::new("Depth", "z", "m").reversed(), &|run, i| run.rows[i][1]))
        .caption("Pulses of ballast rate, net mass, pitch and depth.")
}

/// How fast a disturbance of a microradian grows, against the eigenvalues.
fn the_onset(parameters: &Parameters<f64>) -> Result<Figure, IntegrationError> {
    const DISTURBANCE_RAD: f64 = 1e-6;
    let mut figure = Figure::new("shakes-onset", Axis::new("Time", "t", "s"))
        .caption("Departure of pitch from the steady glide after a disturbance of a microradian, u_1 = 0.");
    for (name, angle, stop_s) in [("Descent", run::GLIDE.0, 180.0), ("Ascent", -run::GLIDE.0, 60.0)] {
        let departures = run::onset(parameters, angle, DISTURBANCE_RAD, stop_s)?;
        let growth = run::eigenvalues(parameters, angle, Kept::ForceAlongAxis1)[0].0;
        let (times, sizes): (Vec<f64>, Vec<f64>) = departures.iter().map(|(t, d)| (*t, d.abs().log10())).unzip();
        let lines = times.iter().map(|t| DISTURBANCE_RAD.log10() + growth * t / 10f64.ln()).collect();
        let axis = Axis::new(format!("{name}: departure of pitch"), "log_{10}|δθ|", "rad");
        figure = figure.panel(
            Panel::new(axis)
                .layer(Layer::line(times.clone(), sizes).label("flown").slot(0))
                .layer(Layer::line(times, lines).label("eigenvalue").slot(1).dash(Dash::Dotted)),
        );
    }
    Ok(figure)
}
