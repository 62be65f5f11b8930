//! A figure's numbers for the page's script: hover, zoom, linked axes. Without scripts, and in print, the drawing stays.
//!
//! The script is uPlot's (MIT, in `uplot/`) with some lines of our own, `mouse.js`, inline in the page.

use super::figure::{Axis, Dash, Figure, Layer, Panel, Shape};
use super::legend::Styles;
use plotters::style::RGBColor;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// uPlot's style and the licence that travels with its code.
pub(super) const STYLE: &str = include_str!("uplot/uPlot.min.css");
const LICENCE: &str = include_str!("uplot/LICENSE");
const UPLOT: &str = include_str!("uplot/uPlot.iife.min.js");
const OWN: &str = include_str!("mouse.js");
const EXPLORER: &str = include_str!("explorer.js");

/// The whole script of a page.
pub(super) fn script() -> String {
    format!("/* uPlot\n{LICENCE}*/\n{UPLOT}\n{OWN}\n{EXPLORER}")
}

/// What allows this script, and no other, to run in a page.
pub(super) fn allowance(script: &str) -> String {
    format!("'sha256-{}'", base64(&Sha256::digest(script.as_bytes())))
}

/// Abscissae of a figure at most: beyond, a page would be too long for a browser and has the drawing alone.
const MOST_NUMBERS: usize = 40_000;

/// The numbers of a figure; nothing where it is a map, a chart of names or has a curve that turns back along x.
pub(super) fn numbers(figure: &Figure) -> Option<Value> {
    let is_plain = |axis: &Axis| axis.names.is_empty();
    let layers = || figure.panels.iter().flat_map(|panel| &panel.layers);
    let has_series =
        layers().any(|layer| matches!(&layer.shape, Shape::Line { xs, .. } | Shape::Points { xs, .. } if xs.len() > 1));
    let goes_on = layers().all(|layer| match &layer.shape {
        Shape::Line { xs, .. } | Shape::Band { xs, .. } => {
            let finite: Vec<f64> = xs.iter().copied().filter(|x| x.is_finite()).collect();
            finite.is_sorted() || finite.is_sorted_by(|a, b| a >= b)
        }
        _ => true,
    });
    let axes_are_plain = is_plain(&figure.x) && figure.panels.iter().all(|panel| is_plain(&panel.y));
    let size: usize = layers().map(|layer| layer.xs().len()).sum();
    if size > MOST_NUMBERS || figure.is_map || figure.x.reversed || !(has_series && goes_on && axes_are_plain) {
        return None;
    }
    let styles = Styles::new(figure);
    let panels: Vec<Value> = figure.panels.iter().map(|panel| panel_of(panel, &styles)).collect();
    Some(json!({ "x": axis(&figure.x), "panels": panels }))
}

fn panel_of(panel: &Panel, styles: &Styles) -> Value {
    let layers: Vec<Value> = panel.layers.iter().map(|layer| layer_of(layer, styles)).collect();
    json!({ "title": panel.title, "y": axis(&panel.y), "layers": layers })
}

fn layer_of(layer: &Layer, styles: &Styles) -> Value {
    let RGBColor(red, green, blue) = styles.get(layer).colour;
    let colour = format!("#{red:02X}{green:02X}{blue:02X}");
    let label = layer.label.as_deref();
    match &layer.shape {
        Shape::Line { xs, ys, dash } => {
            let dash: &[u8] = match dash {
                Dash::Solid => &[],
                Dash::Dashed => &[8, 5],
                Dash::Dotted => &[2, 3],
            };
            json!({ "kind": "line", "label": label, "colour": colour, "dash": dash, "x": plain(xs), "y": plain(ys) })
        }
        Shape::Points { xs, ys, y_interval, .. } => {
            let bars =
                y_interval.as_ref().map(|ends| ends.iter().map(|&(low, high)| plain(&[low, high])).collect::<Vec<_>>());
            json!({ "kind": "points", "label": label, "colour": colour, "x": plain(xs), "y": plain(ys), "bars": bars })
        }
        Shape::Band { xs, low, high } => {
            json!({ "kind": "band", "label": label, "colour": colour, "x": plain(xs), "low": plain(low), "high": plain(high) })
        }
        Shape::ShadedX { from, to } => json!({ "kind": "strip", "from": from, "to": to }),
        Shape::AtX(x) => json!({ "kind": "at_x", "at": x }),
        Shape::AtY(y) => json!({ "kind": "at_y", "at": y }),
    }
}

pub(super) fn axis(axis: &Axis) -> Value {
    let finite = |&(a, b): &(f64, f64)| a.is_finite() && b.is_finite();
    let range = axis.range.filter(finite).map(|(from, to)| [from, to]);
    // Subscripts are letters of the same size here.
    let symbol = axis.symbol.replace(['_', '{', '}'], "");
    json!({ "label": axis.label, "symbol": symbol, "unit": axis.unit, "range": range, "reversed": axis.reversed })
}

/// Numbers as a drawing needs them, six digits; missing ones as null.
pub(super) fn plain(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().map(|v| v.is_finite().then(|| format!("{v:.5e}").parse().unwrap_or(*v))).collect()
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bytes
        .chunks(3)
        .flat_map(|chunk| {
            let three = chunk.iter().fold(0u32, |sum, byte| sum << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
            (0..4).map(move |i| {
                let digit = DIGITS[(three >> (18 - 6 * i) & 63) as usize];
                if i <= chunk.len() { char::from(digit) } else { '=' }
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{allowance, base64, numbers};
    use crate::{Axis, Figure, Layer, Panel};

    #[test]
    fn bytes_become_the_letters_of_rfc_4648() {
        let known = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        known.iter().for_each(|(bytes, letters)| assert_eq!(base64(bytes.as_bytes()), *letters));
        // SHA-256 of nothing, as the standard's test vectors have it.
        assert_eq!(allowance(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
    }

    #[test]
    fn a_figure_with_curves_along_x_has_numbers_and_a_map_has_none() {
        let figure = |layer| {
            let panel = Panel::new(Axis::new("Depth", "z", "m").reversed()).layer(layer);
            Figure::new("one", Axis::new("Time", "t", "s")).panel(panel)
        };
        let line = figure(Layer::line(vec![0.0, 1.0, 2.0], vec![1.0, f64::NAN, 3.0]).label("measured"));
        let found = numbers(&line).expect("a line");
        assert_eq!(found["panels"][0]["layers"][0]["y"], serde_json::json!([1.0, null, 3.0]));
        assert_eq!(found["panels"][0]["y"]["reversed"], true);
        assert!(numbers(&figure(Layer::line(vec![0.0, 2.0, 1.0], vec![1.0; 3]))).is_none());
        assert!(numbers(&line.map()).is_none());
    }
}
