//! Figures and pages: one look for hull tests, identification, diagnosis, plans and FMU runs.
//!
//! A [`Figure`] is data: an x axis, stacked [`Panel`]s, each a y axis and [`Layer`]s. It is written as SVG
//! ([`Figure::svg`]) or PNG ([`Figure::png`]). A [`Report`] is data too: what was read, what was found, figures, tables,
//! warnings; [`Report::html`] makes one self-contained page of it and [`Report::write`] puts page and figures into an
//! output folder. Nothing here knows what a hull, a log or a vehicle is; every text is taken for untrusted.
//!
//! ```
//! use glidepolar_report::{Axis, Block, Cell, Figure, Layer, Panel, Report, Section, Table};
//!
//! let angle = vec![-10.0, -5.0, 0.0, 5.0, 10.0];
//! let lift = vec![-0.19, -0.06, 0.0, 0.06, 0.20];
//! let figure = Figure::new("lift", Axis::new("Angle of attack", "α", "deg"))
//!     .panel(
//!         Panel::new(Axis::new("Lift coefficient", "C_L", ""))
//!             .layer(Layer::shaded_x(-10.0, 10.0).label("fitted range"))
//!             .layer(Layer::points(angle.clone(), lift.clone()).y_error(vec![0.01; 5]).label("LDR 8.5"))
//!             .layer(Layer::line(angle, lift).label("LDR 8.5")),
//!     )
//!     .caption("Lift against angle of attack; bars are 95 % intervals.");
//! let svg = figure.svg();
//! assert!(svg.contains("Angle of attack"));
//!
//! let page = Report::new("Hull tests", "LDR 8.5")
//!     .section(Section::new("Lift").text("The slope is within its interval.").figure(figure).table(
//!         Table::new("Fits", ["Hull", "a [1/rad]"]).row([Cell::from("LDR 8.5"), Cell::estimate(1.5432, 0.021)]),
//!     ))
//!     .html();
//! assert!(page.contains("1.543 ± 0.021"));
//! ```

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

mod brush;
mod canvas;
mod draw;
mod explorer;
mod figure;
mod labels;
mod legend;
mod mouse;
mod number;
pub mod output;
mod page;
mod palette;
mod png;
mod table;
mod text;
mod thin;
mod ticks;

#[cfg(test)]
mod tests;

pub use explorer::{Explorer, Quantity, Slider};
pub use figure::{Axis, Dash, Figure, Layer, Panel, Shape};
pub use number::{estimate, interval, probability, significant, with_interval};
pub use page::{Block, InputFile, Report, Section, as_command};
pub use table::{Cell, Table};
pub use text::paragraph;
