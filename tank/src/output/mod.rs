//! What a reduction leaves behind: tables, figures, a page. Each knows the results and nothing of how they came about.

mod console;
mod tables;

pub use console::print;
pub use tables::coefficients_csv;
