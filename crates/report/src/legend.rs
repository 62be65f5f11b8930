//! Which colour belongs to which label, and the legend above the panels.

use super::canvas::{Align, Canvas, Lettering, Pen};
use super::figure::{Dash, Figure, Layer, Panel, Shape};
use super::palette::{FAINT, INK, SHADE, Style, style};
use super::text::{clean, width};
use plotters::style::RGBColor;
use std::collections::{BTreeSet, HashMap};

const SIZE: f64 = 12.0;
/// Height of one row of entries.
pub(super) const ROW: f64 = 19.0;
const SAMPLE: f64 = 24.0;
/// Left of it nothing is drawn.
const EDGE: f64 = 6.0;
/// That is hardly ever wider.
const WIDTH_OF_A_LETTER: f64 = 6.8;

/// The place in the palette of every label in a figure.
pub(super) struct Styles<'a> {
    slots: HashMap<&'a str, usize>,
}

impl<'a> Styles<'a> {
    pub fn new(figure: &'a Figure) -> Self {
        let layers = || figure.panels.iter().flat_map(|p| &p.layers);
        let mut taken: BTreeSet<usize> = layers().filter_map(|l| l.slot).collect();
        let mut slots: HashMap<&str, usize> = layers().filter_map(|l| Some((l.label.as_deref()?, l.slot?))).collect();
        for layer in layers().filter(|l| l.slot.is_none() && is_series(&l.shape)) {
            let Some(label) = layer.label.as_deref() else { continue };
            slots.entry(label).or_insert_with(|| {
                let free = (0..).find(|i| !taken.contains(i)).unwrap_or(0);
                taken.insert(free);
                free
            });
        }
        Styles { slots }
    }

    /// Of a layer; nameless series are blue where nothing else is coloured, and black beside coloured ones.
    pub fn get(&self, layer: &Layer) -> Style {
        let named = layer.slot.or_else(|| self.slots.get(layer.label.as_deref()?).copied());
        match named {
            Some(slot) => style(slot),
            None if !is_series(&layer.shape) || !self.slots.is_empty() => Style { colour: INK, ..style(0) },
            None => style(0),
        }
    }

    /// A strip's colour and opacity: grey, or a tint where it has a slot.
    pub fn strip(&self, layer: &Layer) -> (RGBColor, f64) {
        layer.slot.map_or((SHADE, 1.0), |slot| (style(slot).colour, 0.14))
    }
}

fn is_series(shape: &Shape) -> bool {
    matches!(shape, Shape::Points { .. } | Shape::Line { .. } | Shape::Band { .. })
}

/// The entries of one panel, in rows.
pub(super) struct Legend<'a> {
    left: f64,
    rows: Vec<Vec<Entry<'a>>>,
}

struct Entry<'a> {
    text: String,
    layers: Vec<&'a Layer>,
    x: f64,
}

impl<'a> Legend<'a> {
    /// The labels of a panel that no panel above has shown, flowing into rows between the panel's edges; from the figure's
    /// own edge on where one is too long for that.
    pub fn new(panel: &'a Panel, shown: &mut BTreeSet<&'a str>, (left, right): (f64, f64)) -> Self {
        let mut entries: Vec<(&str, Vec<&Layer>)> = Vec::new();
        for layer in &panel.layers {
            let Some(label) = layer.label.as_deref().filter(|l| !shown.contains(l)) else { continue };
            match entries.iter_mut().find(|(known, _)| *known == label) {
                Some((_, layers)) => layers.push(layer),
                None => entries.push((label, vec![layer])),
            }
        }
        shown.extend(entries.iter().map(|(label, _)| *label));
        let longest = entries.iter().map(|(label, _)| width(&clean(label, 70), SIZE, false)).fold(0.0, f64::max);
        let left = if SAMPLE + 6.0 + longest > right - left { EDGE } else { left };
        let wide = right - left;
        let letters = (((wide - SAMPLE - 6.0) / WIDTH_OF_A_LETTER) as usize).min(70);
        let mut rows: Vec<Vec<Entry>> = Vec::new();
        let mut x = wide;
        for (label, layers) in entries {
            let text = clean(label, letters);
            let needs = SAMPLE + 6.0 + width(&text, SIZE, false);
            if x + needs > wide {
                rows.push(Vec::new());
                x = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push(Entry { text, layers, x });
            }
            x += needs + 18.0;
        }
        Legend { left, rows }
    }

    pub fn height(&self) -> f64 {
        self.rows.len() as f64 * ROW
    }

    pub fn draw(&self, canvas: &Canvas, styles: &Styles, top: f64) {
        let left = self.left;
        let lettering = Lettering { size: SIZE, colour: INK, bold: false, align: Align::Left };
        for (i, row) in self.rows.iter().enumerate() {
            let middle = top + (i as f64 + 0.5) * ROW;
            for entry in row {
                for layer in &entry.layers {
                    sample(canvas, styles, layer, left + entry.x, middle);
                }
                canvas.text(&entry.text, (left + entry.x + SAMPLE + 6.0, middle + 0.36 * SIZE), lettering);
            }
        }
    }
}

fn sample(canvas: &Canvas, styles: &Styles, layer: &Layer, left: f64, y: f64) {
    let style = styles.get(layer);
    let (middle, right) = (left + SAMPLE / 2.0, left + SAMPLE);
    let pen = Pen { colour: style.colour, width: 1.8, alpha: 1.0 };
    match &layer.shape {
        Shape::Points { y_interval, x_interval, .. } => {
            let thin = Pen { width: 1.1, ..pen };
            if y_interval.is_some() {
                canvas.line(&[(middle, y - 7.0), (middle, y + 7.0)], thin);
            }
            if x_interval.is_some() {
                canvas.line(&[(middle - 9.0, y), (middle + 9.0, y)], thin);
            }
            canvas.marker((middle, y), style.marker, 3.6, style.colour, 1.0);
        }
        Shape::Line { dash, .. } => stroke(canvas, &[(left, y), (right, y)], pen, *dash),
        Shape::Band { .. } => canvas.rectangle((left, y - 5.0), (right, y + 5.0), style.colour, BAND),
        Shape::ShadedX { .. } => {
            let (colour, alpha) = styles.strip(layer);
            canvas.rectangle((left, y - 5.5), (right, y + 5.5), colour, alpha);
            let edge = Pen { colour: FAINT, width: 0.5, alpha: 1.0 };
            let (a, b) = ((left, y - 5.5), (right, y + 5.5));
            canvas.line(&[a, (b.0, a.1), b, (a.0, b.1), a], edge);
        }
        Shape::AtX(_) => canvas.line(&[(middle, y - 7.0), (middle, y + 7.0)], Pen { width: 1.1, ..pen }),
        Shape::AtY(_) => canvas.line(&[(left, y), (right, y)], Pen { width: 1.1, ..pen }),
    }
}

/// Opacity of bands.
pub(super) const BAND: f64 = 0.2;

/// A line in one of the three ways.
pub(super) fn stroke(canvas: &Canvas, points: &[(f64, f64)], pen: Pen, dash: Dash) {
    match dash {
        Dash::Solid => canvas.line(points, pen),
        Dash::Dashed => canvas.broken_line(points, pen, 7.0, 4.0),
        Dash::Dotted => canvas.broken_line(points, pen, 2.0, 3.0),
    }
}
