//! What a reduction leaves behind: tables, figures, a page. Each knows the results and nothing of how they came about.

mod console;
mod diagnosis;
mod figures;
mod page;
mod particulars;
mod tables;

use glidepolar_report::InputFile;
use glidepolar_report::output::{OutputError, OutputFolder};

use crate::results::Results;

pub use console::print;

/// Writes everything into a folder: `fits.json`, tables, figures, `report.html`. `inputs` are the files that describe what
/// was reduced.
///
/// # Errors
/// Where a file cannot be written, or stands there from somebody else.
pub fn write(results: &Results, inputs: Vec<InputFile>, mut folder: OutputFolder) -> Result<(), OutputError> {
    // Plain numbers and strings: always writable as JSON.
    let mut json = serde_json::to_string_pretty(&results.reduction()).unwrap_or_default();
    json.push('\n');
    folder.add("fits.json", json)?;
    folder.add("coefficients.csv", tables::coefficients_csv(results))?;
    if !results.runs.is_empty() {
        folder.add("steps.csv", tables::steps_csv(results))?;
    }
    if results.hulls.iter().any(|hull| hull.dynamic.is_some()) {
        folder.add("derivatives.csv", tables::derivatives_csv(results))?;
    }
    page::report(results, inputs).write(folder)
}
