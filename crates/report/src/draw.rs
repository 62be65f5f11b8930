//! From a figure's data to its picture: layout first, then panel by panel.

use super::brush::{Brush, CLOUD};
use super::canvas::{Align, Canvas, LABEL_SIZE, Lettering, Pen, UNITS};
use super::figure::{Axis, Figure, Layer, Panel, Shape};
use super::labels::{axis_label, label_lines};
use super::legend::{Legend, Styles};
use super::palette::{FAINT, GRID, INK};
use super::text::{clean, expand_markup, width, without_markup};
use super::thin::Frame;
use super::ticks::{Scale, extent};
use std::collections::BTreeSet;

/// Width of a figure \[px\].
pub(super) const WIDTH: f64 = 600.0;
/// The same on a phone, where letters of the usual width would be too small to read.
pub(super) const NARROW: f64 = 360.0;
const TICK_SIZE: f64 = 12.0;
const TICK: f64 = 5.0;
const LABEL_ROW: f64 = LABEL_SIZE + 4.0;

impl Figure {
    /// The figure as an SVG document: text as text, deterministic, no reference to anything outside.
    pub fn svg(&self) -> String {
        document(self, &self.stem(), WIDTH, true)
    }

    /// The name as a file stem and identifier.
    pub fn stem(&self) -> String {
        let kept = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
        let stem: String = self.name.chars().take(80).map(kept).collect();
        if stem.is_empty() { "figure".to_owned() } else { stem }
    }

    /// What the axes show, for readers who hear the figure.
    pub(super) fn description(&self) -> String {
        let quantity = |axis: &Axis| clean(&axis.label, 80);
        let ys: Vec<String> = self.panels.iter().map(|p| quantity(&p.y)).collect();
        format!("{} against {}", ys.join(", "), quantity(&self.x))
    }
}

/// The figure as SVG of that width, its identifiers made from `id`; `standalone` with the namespace that a file needs.
pub(super) fn document(figure: &Figure, id: &str, width: f64, standalone: bool) -> String {
    let layout = Layout::new(figure, width);
    let mut drawn = String::new();
    let canvas = Canvas::new(&mut drawn, width, layout.height);
    layout.draw(figure, &canvas);
    drop(canvas);
    let body = drawn.split_once('\n').map_or("", |(_, body)| body);
    // What every element repeats and SVG assumes anyway.
    let body = body.replace(" opacity=\"1\"", "").replace(" stroke=\"none\" stroke-width=\"0\"", "");
    let body = expand_markup(&fills_with_opacity(&body));
    let namespace = if standalone { " xmlns=\"http://www.w3.org/2000/svg\"" } else { "" };
    let escape = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let title = escape(&figure.title.as_deref().map_or_else(|| figure.description(), |t| clean(t, 200)));
    let caption = escape(&clean(&figure.caption, 2000));
    let (w, h) = (width * UNITS, layout.height * UNITS);
    format!(
        "<svg{namespace} viewBox=\"0 0 {w:.0} {h:.0}\" width=\"{width:.0}\" height=\"{:.0}\" role=\"img\" \
         aria-labelledby=\"{id}-title {id}-desc\">\n<title id=\"{id}-title\">{title}</title>\n\
         <desc id=\"{id}-desc\">{caption}</desc>\n{body}",
        layout.height
    )
}

/// Filled circles whose fill has the opacity: a printed page else holds each as a group of its own, twice as long.
fn fills_with_opacity(body: &str) -> String {
    let mut written = String::with_capacity(body.len());
    for line in body.split_inclusive('\n') {
        if line.starts_with("<circle") && line.contains(" fill=\"#") {
            written.push_str(&line.replace(" opacity=", " fill-opacity="));
        } else {
            written.push_str(line);
        }
    }
    written
}

struct Layout<'a> {
    width: f64,
    height: f64,
    x: Scale,
    /// In one line, or in two where the figure is too narrow for it.
    x_label: Vec<String>,
    /// Whether names along x run upwards because they do not fit side by side.
    upward: bool,
    panels: Vec<Place<'a>>,
    styles: Styles<'a>,
}

struct Place<'a> {
    /// Upper edge of the title and legend.
    top: f64,
    frame: Frame,
    y: Scale,
    legend: Legend<'a>,
    y_label: Vec<String>,
}

impl<'a> Layout<'a> {
    fn new(figure: &'a Figure, whole: f64) -> Self {
        let count = figure.panels.len();
        let heights: Vec<f64> = figure.panels.iter().map(|p| height_of(p, count)).collect();
        let all = || figure.panels.iter().flat_map(|p| &p.layers);
        let mut scales: Vec<Scale> = figure.panels.iter().zip(&heights).map(|(p, h)| y_scale(p, *h)).collect();
        let labels: Vec<Vec<String>> = figure
            .panels
            .iter()
            .zip(&scales)
            .zip(&heights)
            .map(|((p, s), h)| label_lines(&p.y, s, *h + 16.0))
            .collect();
        let lines = labels.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let left = 6.0 + lines * (LABEL_SIZE + 4.0) + 4.0 + widest(scales.iter()) + TICK + 4.0;

        let points = all().any(|l| matches!(l.shape, Shape::Points { .. }));
        let room = if points { 0.04 } else { 0.0 };
        let mut x = Scale::new(&figure.x, extent(all().flat_map(Layer::xs)), room, ((whole - left) / 66.0) as usize);
        let share = (whole - 12.0 - left) / x.ticks.len().max(1) as f64;
        let upward = !figure.x.names.is_empty() && widest([&x]) + 8.0 > share;
        let last = x.ticks.last().filter(|_| !upward).map_or(0.0, |(_, text)| width(text, TICK_SIZE, false) / 2.0);
        let right = whole - (last + 2.0).clamp(12.0, 60.0);

        if let (true, [y], [panel], [height]) = (figure.is_map, &mut scales[..], &figure.panels[..], &heights[..]) {
            let per_pixel = ((x.to - x.from) / (right - left)).max((y.to - y.from) / height);
            let about = |axis: &Axis, scale: &Scale, pixels: f64, ticks: usize| {
                let (middle, half) = (0.5 * (scale.from + scale.to), 0.5 * per_pixel * pixels);
                Scale::new(&axis.clone().range(middle - half, middle + half), (f64::NAN, f64::NAN), 0.0, ticks)
            };
            *y = about(&panel.y, y, *height, 8);
            x = about(&figure.x, &x, right - left, ((whole - left) / 66.0) as usize);
        }

        let mut shown = BTreeSet::new();
        let mut top = 8.0 + if figure.title.is_some() { 24.0 } else { 0.0 };
        let mut panels = Vec::new();
        for (((panel, y), y_label), height) in figure.panels.iter().zip(scales).zip(labels).zip(heights) {
            let legend = Legend::new(panel, &mut shown, (left, right));
            let heading = if panel.title.is_some() || outside(panel, figure, &y) > 0 { 19.0 } else { 0.0 };
            let upper = top + heading + legend.height() + 5.0;
            let frame = Frame { left, top: upper, right, bottom: upper + height };
            panels.push(Place { top, frame, y, legend, y_label });
            top = upper + height + 13.0;
        }
        let ticks = if upward { widest([&x]) + 4.0 } else { TICK_SIZE + 4.0 };
        let x_label = match axis_label(&figure.x, &x) {
            none if none.is_empty() => Vec::new(),
            _ => label_lines(&figure.x, &x, whole - 8.0),
        };
        let label = if x_label.is_empty() { 0.0 } else { LABEL_SIZE + 8.0 + (x_label.len() - 1) as f64 * LABEL_ROW };
        let height = (top - 13.0 + TICK + ticks + label + 9.0).ceil();
        Layout { width: whole, height, x, x_label, upward, panels, styles: Styles::new(figure) }
    }

    fn draw(&self, figure: &Figure, canvas: &Canvas) {
        if let Some(title) = &figure.title {
            let left = self.panels.first().map_or(10.0, |p| p.frame.left);
            canvas.text(
                &clean(title, self.longest_title(left)),
                (left, 22.0),
                Lettering { size: 14.0, colour: INK, bold: true, align: Align::Left },
            );
        }
        for (panel, place) in figure.panels.iter().zip(&self.panels) {
            self.draw_panel(figure, panel, place, canvas);
        }
        if let Some(place) = self.panels.last() {
            self.draw_x_axis(place, canvas);
        }
    }

    fn draw_panel(&self, figure: &Figure, panel: &Panel, place: &Place, canvas: &Canvas) {
        let frame = place.frame;
        let heading = Lettering { size: 12.5, colour: INK, bold: true, align: Align::Left };
        if let Some(title) = &panel.title {
            canvas.text(&clean(title, self.longest_title(frame.left)), (frame.left, place.top + 14.0), heading);
        }
        let lost = outside(panel, figure, &place.y);
        if lost > 0 {
            let points = if lost == 1 { "point" } else { "points" };
            let note = Lettering { size: 11.0, colour: FAINT, bold: false, align: Align::Right };
            canvas.text(&format!("{lost} {points} outside the axes"), (frame.right, place.top + 14.0), note);
        }
        place.legend.draw(canvas, &self.styles, frame.top - 5.0 - place.legend.height());

        let brush = Brush { canvas, styles: &self.styles, frame, x: &self.x, y: &place.y };
        for layer in panel.layers.iter().filter(|l| matches!(l.shape, Shape::ShadedX { .. })) {
            brush.strip(layer);
        }
        let grid = Pen { colour: GRID, width: 0.8, alpha: 1.0 };
        for at in self.x.ticks.iter().map(|(v, _)| brush.place(*v, 0.0).0) {
            canvas.line(&[(at, frame.top), (at, frame.bottom)], grid);
        }
        for at in place.y.ticks.iter().map(|(v, _)| brush.place(0.0, *v).1) {
            canvas.line(&[(frame.left, at), (frame.right, at)], grid);
        }
        for layer in panel.layers.iter().filter(|l| matches!(l.shape, Shape::Band { .. })) {
            brush.layer(layer);
        }
        // Clouds lie below lines, single points above them.
        let depth = |l: &Layer| match &l.shape {
            Shape::ShadedX { .. } | Shape::Band { .. } => 0,
            Shape::Points { xs, .. } if xs.len() >= CLOUD => 1,
            Shape::AtX(_) | Shape::AtY(_) => 2,
            Shape::Line { .. } => 3,
            Shape::Points { .. } => 4,
        };
        for level in 1..=4 {
            panel.layers.iter().filter(|l| depth(l) == level).for_each(|l| brush.layer(l));
        }
        if !panel.layers.iter().any(|l| l.ys().iter().any(|y| y.is_finite())) {
            let note = Lettering { size: 12.0, colour: FAINT, bold: false, align: Align::Centre };
            canvas.text("no data", ((frame.left + frame.right) / 2.0, (frame.top + frame.bottom) / 2.0), note);
        }
        let (a, b) = ((frame.left, frame.top), (frame.right, frame.bottom));
        canvas.line(&[a, (b.0, a.1), b, (a.0, b.1), a], Pen { colour: INK, width: 0.9, alpha: 1.0 });
        draw_y_axis(place, canvas);
    }

    fn draw_x_axis(&self, place: &Place, canvas: &Canvas) {
        let frame = place.frame;
        let letters = Lettering { size: TICK_SIZE, colour: INK, bold: false, align: Align::Centre };
        let mut free_from = f64::NEG_INFINITY;
        let mut below = frame.bottom + TICK + 4.0 + TICK_SIZE;
        let mut ticks: Vec<(f64, &str)> = self.x.ticks.iter().map(|(v, t)| (self.x.fraction(*v), t.as_str())).collect();
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (fraction, text) in ticks {
            let at = frame.left + fraction * (frame.right - frame.left);
            canvas.line(&[(at, frame.bottom), (at, frame.bottom + TICK)], Pen { colour: INK, width: 0.9, alpha: 1.0 });
            if self.upward {
                let y = frame.bottom + TICK + 3.0;
                canvas.upward_text(text, (at + 0.36 * TICK_SIZE, y), Lettering { align: Align::Right, ..letters });
                continue;
            }
            let half = width(text, TICK_SIZE, false) / 2.0;
            if at - half > free_from {
                canvas.text(text, (at, frame.bottom + TICK + 2.0 + TICK_SIZE), letters);
                free_from = at + half + 6.0;
            }
        }
        if self.upward {
            below = frame.bottom + TICK + 4.0 + widest([&self.x]);
        }
        for (i, line) in self.x_label.iter().enumerate() {
            // Below the middle of the panel, as far as the figure's edges leave it there.
            let half = width(&without_markup(line), LABEL_SIZE, false) / 2.0;
            let middle = ((frame.left + frame.right) / 2.0).min(self.width - 4.0 - half).max(4.0 + half);
            let at = (middle, below + 6.0 + LABEL_SIZE + i as f64 * LABEL_ROW);
            canvas.text(line, at, Lettering { size: LABEL_SIZE, ..letters });
        }
    }

    /// Letters of a title that begins there.
    fn longest_title(&self, left: f64) -> usize {
        if self.width < WIDTH { ((self.width - left) / 7.8) as usize } else { 90 }
    }
}

fn draw_y_axis(place: &Place, canvas: &Canvas) {
    let frame = place.frame;
    let letters = Lettering { size: TICK_SIZE, colour: INK, bold: false, align: Align::Right };
    for (value, text) in &place.y.ticks {
        let at = frame.bottom - place.y.fraction(*value) * (frame.bottom - frame.top);
        canvas.line(&[(frame.left - TICK, at), (frame.left, at)], Pen { colour: INK, width: 0.9, alpha: 1.0 });
        canvas.text(text, (frame.left - TICK - 3.0, at + 0.36 * TICK_SIZE), letters);
    }
    let middle = (frame.top + frame.bottom) / 2.0;
    let label = Lettering { size: LABEL_SIZE, align: Align::Centre, ..letters };
    let first = 6.0 + LABEL_SIZE - 2.0;
    for (i, line) in place.y_label.iter().enumerate() {
        canvas.upward_text(line, (first + i as f64 * (LABEL_SIZE + 4.0), middle), label);
    }
}

fn height_of(panel: &Panel, count: usize) -> f64 {
    if !panel.y.names.is_empty() {
        return (24.0 * panel.y.names.len() as f64 + 16.0).clamp(70.0, 1200.0);
    }
    match count {
        0 | 1 => 280.0,
        2 => 180.0,
        _ => 140.0,
    }
}

fn y_scale(panel: &Panel, height: f64) -> Scale {
    let data = extent(panel.layers.iter().flat_map(Layer::ys));
    let mut scale = Scale::new(&panel.y, data, 0.06, ((height / 28.0) as usize).min(8));
    if !panel.y.names.is_empty() {
        // Read from the top, as a list is.
        scale.reversed = !scale.reversed;
    }
    scale
}

fn widest<'s>(scales: impl IntoIterator<Item = &'s Scale>) -> f64 {
    let texts = scales.into_iter().flat_map(|s| &s.ticks).map(|(_, text)| width(text, TICK_SIZE, false));
    texts.fold(0.0, f64::max)
}

/// How many points a panel has that its axes' given ranges do not show.
fn outside(panel: &Panel, figure: &Figure, y: &Scale) -> usize {
    let x_range = figure.x.range.map(|(a, b)| (a.min(b), a.max(b)));
    let hidden = |xs: &[f64], ys: &[f64]| {
        let in_x = |v: f64| x_range.is_none_or(|(a, b)| v >= a && v <= b);
        let in_y = |v: f64| v >= y.from && v <= y.to;
        xs.iter().zip(ys).filter(|(x, y)| x.is_finite() && y.is_finite() && !(in_x(**x) && in_y(**y))).count()
    };
    let of_layer = |l: &Layer| match &l.shape {
        Shape::Points { xs, ys, .. } => hidden(xs, ys),
        _ => 0,
    };
    panel.layers.iter().map(of_layer).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a map a length along x is as long along y, however the data lie.
    #[test]
    fn a_map_has_axes_of_one_scale() {
        for (width_km, height_km) in [(10.0, 1.0), (1.0, 10.0), (3.0, 3.0)] {
            let layer = Layer::line(vec![0.0, width_km], vec![0.0, height_km]);
            let panel = Panel::new(Axis::new("North", "y", "km")).layer(layer);
            let figure = Figure::new("way", Axis::new("East", "x", "km")).panel(panel);
            let per_pixel = |figure: &Figure| {
                let layout = Layout::new(figure, WIDTH);
                let (x, place) = (&layout.x, &layout.panels[0]);
                let frame = &place.frame;
                let along_x = (x.to - x.from) / (frame.right - frame.left);
                (along_x, (place.y.to - place.y.from) / (frame.bottom - frame.top))
            };
            let (free_x, free_y) = per_pixel(&figure);
            let (x, y) = per_pixel(&figure.clone().map());
            assert!((x / y - 1.0).abs() < 1e-6, "{width_km} km by {height_km} km: {x} and {y} km per pixel");
            assert!(x >= free_x.max(free_y) * 0.999, "nothing is cut off");
        }
    }
}
