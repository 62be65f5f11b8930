//! The short table on the terminal.

use glidepolar_hull::hull_tests::Estimate;

use crate::results::Results;

/// Ends the program with a message where nothing more can be printed.
macro_rules! println {
    ($($line:tt)*) => { glidepolar_terminal::print_line(format_args!($($line)*)) };
}

/// Prints the fits hull by hull.
pub fn print(results: &Results) {
    let width = results.hulls.iter().map(|h| h.hull.id.len()).max().unwrap_or(0).max(4);
    println!("{BOLD}{:<width$}  {:>4}  {}{BOLD:#}", "hull", "runs", heading());
    for hull in &results.hulls {
        let id = glidepolar_input::printable(&hull.hull.id);
        match &hull.fit {
            Ok(fit) => {
                let e = &fit.estimates;
                println!(
                    "{id:<width$}  {:>4}  {}  {}  {}  {}",
                    hull.n_runs,
                    shown(&e.a, 3),
                    shown(&e.b, 4),
                    shown(&e.c, 3),
                    shown(&e.d, 3)
                );
            }
            Err(few) => println!("{id:<width$}  {:>4}  {few}", hull.n_runs),
        }
    }
    println!(
        "CL = a alpha, CD = b + c alpha^2, CM = d alpha about the centre of buoyancy, |alpha| <= {} deg; 95 % intervals",
        results.range_deg
    );
    print_diagnosis(results);
}

/// Prints what was found wrong, in few lines.
fn print_diagnosis(results: &Results) {
    let Some(diagnosis) = results.diagnoses.as_ref().and_then(|diagnoses| diagnoses.overall()) else { return };
    println!("{BOLD}diagnosis{BOLD:#}");
    for sentence in super::diagnosis::sentences(diagnosis) {
        println!("  {sentence}");
    }
}

/// Widths as [`shown`] prints.
fn heading() -> String {
    ["a [1/rad]", "b", "c [1/rad^2]", "d [1/rad]"].map(|name| format!("{name:<24}")).join("  ").trim_end().to_owned()
}

fn shown(q: &Estimate, places: usize) -> String {
    format!("{:<24}", format!("{:.places$} ({:.places$} to {:.places$})", q.value, q.ci95[0], q.ci95[1]))
}

const BOLD: anstyle::Style = anstyle::Style::new().bold();
