//! What a reduction leaves behind: tables, figures, a page. Each knows the results and nothing of how they came about.

mod console;
mod diagnosis;
mod figures;
mod page;
mod tables;

use std::path::PathBuf;

use glidepolar::input::InputError;
use glidepolar::output::OutputFolder;

use crate::results::Results;

pub use console::print;

/// Writes everything into a folder: `fits.json`, tables, figures, `report.html`. `inputs` are the files that describe what
/// was reduced.
///
/// # Errors
/// Where a file cannot be written, or stands there from somebody else.
pub fn write(results: &Results, inputs: &[PathBuf], folder: &OutputFolder) -> Result<(), InputError> {
    // Plain numbers and strings: always writable as JSON.
    let mut json = serde_json::to_string_pretty(&results.reduction()).unwrap_or_default();
    json.push('\n');
    folder.write("fits.json", json.as_bytes())?;
    folder.write("coefficients.csv", &tables::coefficients_csv(results))?;
    if !results.runs.is_empty() {
        folder.write("steps.csv", &tables::steps_csv(results))?;
    }
    if results.hulls.iter().any(|hull| hull.dynamic.is_some()) {
        folder.write("derivatives.csv", &tables::derivatives_csv(results))?;
    }
    page::report(results, inputs)?.write(folder)
}
