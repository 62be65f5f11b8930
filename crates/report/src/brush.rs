//! Layers drawn into one panel: points with their bars, lines, bands, strips. Knows pixels and no layout.

use super::canvas::{Canvas, Pen};
use super::figure::{Layer, Shape};
use super::legend::{BAND, Styles, stroke};
use super::palette::Marker;
use super::thin::{Frame, Pixel, markers, polylines};
use super::ticks::Scale;

/// From so many points on, a layer is a cloud rather than single measurements.
pub(super) const CLOUD: usize = 300;

const MOST_MARKERS: usize = 4000;

/// Draws layers into one panel.
pub(super) struct Brush<'a, 'c> {
    pub canvas: &'a Canvas<'c>,
    pub styles: &'a Styles<'a>,
    pub frame: Frame,
    pub x: &'a Scale,
    pub y: &'a Scale,
}

impl Brush<'_, '_> {
    pub(super) fn place(&self, x: f64, y: f64) -> Pixel {
        let f = self.frame;
        // Far outside is outside enough: pixels stay representable.
        let px = f.left + self.x.fraction(x) * (f.right - f.left);
        let py = f.bottom - self.y.fraction(y) * (f.bottom - f.top);
        (bounded(px), bounded(py))
    }

    pub(super) fn strip(&self, layer: &Layer) {
        let Shape::ShadedX { from, to } = layer.shape else { return };
        let (a, b) = (self.place(from, 0.0).0, self.place(to, 0.0).0);
        let (a, b) = (a.min(b).max(self.frame.left), a.max(b).min(self.frame.right));
        if b > a {
            let (colour, alpha) = self.styles.strip(layer);
            self.canvas.rectangle((a, self.frame.top), (b, self.frame.bottom), colour, alpha);
        }
    }

    pub(super) fn layer(&self, layer: &Layer) {
        let style = self.styles.get(layer);
        let pen = Pen { colour: style.colour, width: 1.8, alpha: 1.0 };
        // An unnamed line is a mere reference, and drawn finer.
        let thin = Pen { width: if layer.label.is_some() { 1.3 } else { 0.8 }, ..pen };
        let f = self.frame;
        match &layer.shape {
            Shape::Points { xs, ys, y_interval, x_interval } => {
                self.points(xs, ys, y_interval.as_deref(), x_interval.as_deref(), pen, style.marker);
            }
            Shape::Line { xs, ys, dash } => {
                let dense = xs.len() > 3000;
                let pen = Pen { width: if dense { 1.1 } else { 1.8 }, ..pen };
                for part in polylines(xs.iter().zip(ys).map(|(x, y)| self.place(*x, *y)), f) {
                    stroke(self.canvas, &part, pen, *dash);
                }
            }
            Shape::Band { xs, low, high } => {
                let inside = |(x, y): Pixel| (x, y.clamp(f.top, f.bottom));
                let edge = |ys: &[f64]| polylines(xs.iter().zip(ys).map(|(x, y)| inside(self.place(*x, *y))), f);
                // A gap in one edge is a gap in the other where both come from one fit; then the pieces pair up.
                for (mut below, mut above) in edge(low).into_iter().zip(edge(high)) {
                    above.reverse();
                    below.append(&mut above);
                    self.canvas.area(&below, style.colour, BAND);
                }
            }
            Shape::AtX(x) => {
                let at = self.place(*x, 0.0).0;
                if f.contains((at, f.top)) {
                    self.canvas.line(&[(at, f.top), (at, f.bottom)], thin);
                }
            }
            Shape::AtY(y) => {
                let at = self.place(0.0, *y).1;
                if f.contains((f.left, at)) {
                    self.canvas.line(&[(f.left, at), (f.right, at)], thin);
                }
            }
            Shape::ShadedX { .. } => {}
        }
    }

    fn points(
        &self,
        xs: &[f64],
        ys: &[f64],
        y_bars: Option<&[(f64, f64)]>,
        x_bars: Option<&[(f64, f64)]>,
        pen: Pen,
        marker: Marker,
    ) {
        let all: Vec<(usize, Pixel)> = (0..xs.len().min(ys.len()))
            .map(|i| (i, self.place(xs[i], ys[i])))
            .filter(|(_, p)| p.0.is_finite() && p.1.is_finite() && self.frame.contains(*p))
            .collect();
        let places: Vec<Pixel> = all.iter().map(|(_, p)| *p).collect();
        let chosen = markers(&places, MOST_MARKERS);
        let (size, alpha) = match all.len() {
            0..60 => (3.6, 1.0),
            60..CLOUD => (2.9, 0.9),
            CLOUD..1500 => (2.1, 0.75),
            _ => (1.5, 0.6),
        };
        let bar = Pen { width: 1.1, ..pen };
        for &k in &chosen {
            let (i, (px, py)) = all[k];
            if let Some((low, high)) = y_bars.and_then(|b| b.get(i)).filter(|b| b.0.is_finite() && b.1.is_finite()) {
                let (a, b) = (self.place(xs[i], *low).1, self.place(xs[i], *high).1);
                self.bar(&[(px, a), (px, b)], (3.0, 0.0), bar);
            }
            if let Some((low, high)) = x_bars.and_then(|b| b.get(i)).filter(|b| b.0.is_finite() && b.1.is_finite()) {
                let (a, b) = (self.place(*low, ys[i]).0, self.place(*high, ys[i]).0);
                self.bar(&[(a, py), (b, py)], (0.0, 3.0), bar);
            }
        }
        for &k in &chosen {
            self.canvas.marker(all[k].1, marker, size, pen.colour, alpha);
        }
    }

    /// An error bar with caps where its ends are inside.
    fn bar(&self, ends: &[Pixel; 2], cap: Pixel, pen: Pen) {
        for part in polylines(ends.iter().copied(), self.frame) {
            self.canvas.line(&part, pen);
        }
        for &(x, y) in ends.iter().filter(|e| self.frame.contains(**e)) {
            self.canvas.line(&[(x - cap.0, y - cap.1), (x + cap.0, y + cap.1)], pen);
        }
    }
}

fn bounded(pixel: f64) -> f64 {
    if pixel.is_nan() { pixel } else { pixel.clamp(-1e7, 1e7) }
}
