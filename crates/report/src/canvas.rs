//! A sheet to draw on: lines, areas, markers and text in pixels, on the drawing library's SVG backend. The backend knows
//! whole coordinates only, so it is given tenths of a pixel.

use super::palette::{Marker, PAPER};
use super::text::FAMILY;
use super::thin::Pixel;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Backend units in a pixel.
pub(super) const UNITS: f64 = 10.0;

pub(super) const LABEL_SIZE: f64 = 13.0;

/// A stroke.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub colour: RGBColor,
    pub width: f64,
    pub alpha: f64,
}

/// Which point of a text its position means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// How text looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lettering {
    pub size: f64,
    pub colour: RGBColor,
    pub bold: bool,
    pub align: Align,
}

// Drawing writes into a string, which cannot fail; the library's results are dropped for that reason.
pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

impl<'a> Canvas<'a> {
    /// A blank sheet; the document is complete in `svg` once the canvas is dropped.
    pub fn new(svg: &'a mut String, width: f64, height: f64) -> Self {
        let size = ((width * UNITS) as u32, (height * UNITS) as u32);
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        let _ = area.fill(&PAPER);
        Canvas { area }
    }

    pub fn line(&self, points: &[Pixel], pen: Pen) {
        if points.len() > 1 {
            let path = PathElement::new(points.iter().map(|&p| units(p)).collect::<Vec<_>>(), stroke(pen));
            let _ = self.area.draw(&path);
        }
    }

    /// Strokes of `on` pixels with gaps of `off`, measured along the line. A line that goes to and fro so densely that
    /// its strokes would merge is drawn unbroken.
    pub fn broken_line(&self, points: &[Pixel], pen: Pen, on: f64, off: f64) {
        const MOST_STROKES: f64 = 2000.0;
        let length: f64 = points.windows(2).map(|e| (e[1].0 - e[0].0).hypot(e[1].1 - e[0].1)).sum();
        if length / (on + off) > MOST_STROKES {
            return self.line(points, pen);
        }
        let mut drawn = 0.0;
        let mut stroke = points.first().map(|&p| vec![p]).unwrap_or_default();
        for ends in points.windows(2) {
            let length = (ends[1].0 - ends[0].0).hypot(ends[1].1 - ends[0].1);
            let mut done = 0.0;
            while done < length {
                let phase = drawn % (on + off);
                let inked = phase < on;
                let rest = if inked { on - phase } else { on + off - phase };
                // A step too small to change the phase would never end.
                let step = rest.max(1e-3).min(length - done);
                done += step;
                drawn += step;
                let t = done / length;
                let at = (ends[0].0 + t * (ends[1].0 - ends[0].0), ends[0].1 + t * (ends[1].1 - ends[0].1));
                if inked {
                    stroke.push(at);
                }
                if drawn % (on + off) >= on || !inked {
                    self.line(&stroke, pen);
                    stroke = vec![at];
                }
            }
        }
        self.line(&stroke, pen);
    }

    pub fn area(&self, corners: &[Pixel], colour: RGBColor, alpha: f64) {
        let style = ShapeStyle { color: colour.mix(alpha), filled: true, stroke_width: 0 };
        let _ = self.area.draw(&Polygon::new(corners.iter().map(|&p| units(p)).collect::<Vec<_>>(), style));
    }

    pub fn rectangle(&self, from: Pixel, to: Pixel, colour: RGBColor, alpha: f64) {
        let style = ShapeStyle { color: colour.mix(alpha), filled: true, stroke_width: 0 };
        let _ = self.area.draw(&Rectangle::new([units(from), units(to)], style));
    }

    pub fn marker(&self, (x, y): Pixel, marker: Marker, r: f64, colour: RGBColor, alpha: f64) {
        // Of equal area, so that none weighs more than another.
        let (s, t, d) = (r * 0.89, r * 1.28, r * 1.25);
        match marker {
            Marker::Circle => {
                let style = ShapeStyle { color: colour.mix(alpha), filled: true, stroke_width: 0 };
                let _ = self.area.draw(&Circle::new(units((x, y)), (r * UNITS) as i32, style));
            }
            Marker::Square => self.rectangle((x - s, y - s), (x + s, y + s), colour, alpha),
            Marker::Triangle => {
                self.area(&[(x, y - t), (x + t, y + 0.75 * t), (x - t, y + 0.75 * t)], colour, alpha);
            }
            Marker::TriangleDown => {
                self.area(&[(x, y + t), (x + t, y - 0.75 * t), (x - t, y - 0.75 * t)], colour, alpha);
            }
            Marker::Diamond => self.area(&[(x, y - d), (x + d, y), (x, y + d), (x - d, y)], colour, alpha),
            Marker::Cross => {
                let pen = Pen { colour, width: r * 0.6, alpha };
                self.line(&[(x - r, y - r), (x + r, y + r)], pen);
                self.line(&[(x - r, y + r), (x + r, y - r)], pen);
            }
        }
    }

    /// Text on a baseline.
    pub fn text(&self, text: &str, (x, baseline): Pixel, lettering: Lettering) {
        let style = style(lettering, FontTransform::None);
        let _ = self.area.draw(&Text::new(text, units((x, baseline - ASCENT * lettering.size)), style));
    }

    /// Text running upwards, its baseline on a vertical.
    pub fn upward_text(&self, text: &str, (baseline, y): Pixel, lettering: Lettering) {
        let style = style(lettering, FontTransform::Rotate270);
        let _ = self.area.draw(&Text::new(text, units((baseline - ASCENT * lettering.size, y)), style));
    }
}

/// Where the backend puts the baseline of top-anchored text, in font sizes.
const ASCENT: f64 = 0.76;

fn units((x, y): Pixel) -> (i32, i32) {
    ((x * UNITS).round() as i32, (y * UNITS).round() as i32)
}

fn stroke(pen: Pen) -> ShapeStyle {
    let stroke_width = (pen.width * UNITS).round().max(1.0) as u32;
    ShapeStyle { color: pen.colour.mix(pen.alpha), filled: false, stroke_width }
}

fn style(lettering: Lettering, transform: FontTransform) -> TextStyle<'static> {
    let h = match lettering.align {
        Align::Left => HPos::Left,
        Align::Centre => HPos::Center,
        Align::Right => HPos::Right,
    };
    let weight = if lettering.bold { FontStyle::Bold } else { FontStyle::Normal };
    // The backend writes a size of 1.24 as 1.
    let font = (FAMILY, lettering.size * UNITS * 1.24, weight).into_font().transform(transform);
    font.color(&lettering.colour).pos(Pos::new(h, VPos::Top))
}
