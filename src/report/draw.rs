//! From a figure's data to its picture: layout first, then panel by panel.

use super::canvas::{Align, Canvas, Lettering, Pen, UNITS};
use super::figure::{Axis, Figure, Layer, Panel, Shape};
use super::legend::{BAND, Legend, Styles, stroke};
use super::palette::{FAINT, GRID, INK, Marker};
use super::text::{clean, expand_markup, symbol, width, without_markup};
use super::thin::{Frame, Pixel, markers, polylines};
use super::ticks::{Scale, extent, superscript};
use std::collections::BTreeSet;

const WIDTH: f64 = 600.0;
const TICK_SIZE: f64 = 12.0;
const LABEL_SIZE: f64 = 13.0;
const TICK: f64 = 5.0;
const MOST_MARKERS: usize = 4000;
/// From so many points on, a layer is a cloud rather than single measurements.
const CLOUD: usize = 300;

impl Figure {
    /// The figure as an SVG document: text as text, deterministic, no reference to anything outside.
    pub fn svg(&self) -> String {
        document(self, &self.stem(), true)
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

/// The figure as SVG, its identifiers made from `id`; `standalone` with the namespace that a file needs.
pub(super) fn document(figure: &Figure, id: &str, standalone: bool) -> String {
    let layout = Layout::of(figure);
    let mut drawn = String::new();
    let canvas = Canvas::new(&mut drawn, WIDTH, layout.height);
    layout.draw(figure, &canvas);
    drop(canvas);
    let body = drawn.split_once('\n').map_or("", |(_, body)| body);
    // What every element repeats and SVG assumes anyway.
    let body = body.replace(" opacity=\"1\"", "").replace(" stroke=\"none\" stroke-width=\"0\"", "");
    let body = expand_markup(&body);
    let namespace = if standalone { " xmlns=\"http://www.w3.org/2000/svg\"" } else { "" };
    let escape = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let title = escape(&figure.title.as_deref().map_or_else(|| figure.description(), |t| clean(t, 200)));
    let caption = escape(&clean(&figure.caption, 2000));
    let (w, h) = (WIDTH * UNITS, layout.height * UNITS);
    format!(
        "<svg{namespace} viewBox=\"0 0 {w:.0} {h:.0}\" width=\"{WIDTH:.0}\" height=\"{:.0}\" role=\"img\" \
         aria-labelledby=\"{id}-title {id}-desc\">\n<title id=\"{id}-title\">{title}</title>\n\
         <desc id=\"{id}-desc\">{caption}</desc>\n{body}",
        layout.height
    )
}

struct Layout<'a> {
    height: f64,
    x: Scale,
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
    fn of(figure: &'a Figure) -> Self {
        let count = figure.panels.len();
        let heights: Vec<f64> = figure.panels.iter().map(|p| height_of(p, count)).collect();
        let all = || figure.panels.iter().flat_map(|p| &p.layers);
        let scales: Vec<Scale> = figure.panels.iter().zip(&heights).map(|(p, h)| y_scale(p, *h)).collect();
        let labels: Vec<Vec<String>> =
            figure.panels.iter().zip(&scales).zip(&heights).map(|((p, s), h)| y_label(&p.y, s, *h)).collect();
        let lines = labels.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let left = 6.0 + lines * (LABEL_SIZE + 4.0) + 4.0 + widest(scales.iter()) + TICK + 4.0;

        let points = all().any(|l| matches!(l.shape, Shape::Points { .. }));
        let room = if points { 0.04 } else { 0.0 };
        let x = Scale::new(&figure.x, extent(all().flat_map(xs)), room, ((WIDTH - left) / 66.0) as usize);
        let share = (WIDTH - 12.0 - left) / x.ticks.len().max(1) as f64;
        let upward = !figure.x.names.is_empty() && widest([&x]) + 8.0 > share;
        let last = x.ticks.last().filter(|_| !upward).map_or(0.0, |(_, text)| width(text, TICK_SIZE, false) / 2.0);
        let right = WIDTH - (last + 2.0).clamp(12.0, 60.0);

        let mut shown = BTreeSet::new();
        let mut top = 8.0 + if figure.title.is_some() { 24.0 } else { 0.0 };
        let mut panels = Vec::new();
        for (((panel, y), y_label), height) in figure.panels.iter().zip(scales).zip(labels).zip(heights) {
            let legend = Legend::of(panel, &mut shown, right - left);
            let heading = if panel.title.is_some() || outside(panel, figure, &y) > 0 { 19.0 } else { 0.0 };
            let upper = top + heading + legend.height() + 5.0;
            let frame = Frame { left, top: upper, right, bottom: upper + height };
            panels.push(Place { top, frame, y, legend, y_label });
            top = upper + height + 13.0;
        }
        let ticks = if upward { widest([&x]) + 4.0 } else { TICK_SIZE + 4.0 };
        let label = if axis_label(&figure.x, &x).is_empty() { 0.0 } else { LABEL_SIZE + 8.0 };
        let height = (top - 13.0 + TICK + ticks + label + 9.0).ceil();
        Layout { height, x, upward, panels, styles: Styles::of(figure) }
    }

    fn draw(&self, figure: &Figure, canvas: &Canvas) {
        if let Some(title) = &figure.title {
            let left = self.panels.first().map_or(10.0, |p| p.frame.left);
            canvas.text(
                &clean(title, 90),
                (left, 22.0),
                Lettering { size: 14.0, colour: INK, bold: true, align: Align::Left },
            );
        }
        for (panel, place) in figure.panels.iter().zip(&self.panels) {
            self.draw_panel(figure, panel, place, canvas);
        }
        if let Some(place) = self.panels.last() {
            self.draw_x_axis(figure, place, canvas);
        }
    }

    fn draw_panel(&self, figure: &Figure, panel: &Panel, place: &Place, canvas: &Canvas) {
        let frame = place.frame;
        let heading = Lettering { size: 12.5, colour: INK, bold: true, align: Align::Left };
        if let Some(title) = &panel.title {
            canvas.text(&clean(title, 90), (frame.left, place.top + 14.0), heading);
        }
        let lost = outside(panel, figure, &place.y);
        if lost > 0 {
            let points = if lost == 1 { "point" } else { "points" };
            let note = Lettering { size: 11.0, colour: FAINT, bold: false, align: Align::Right };
            canvas.text(&format!("{lost} {points} outside the axes"), (frame.right, place.top + 14.0), note);
        }
        place.legend.draw(canvas, &self.styles, frame.left, frame.top - 5.0 - place.legend.height());

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
        if !panel.layers.iter().any(|l| ys(l).iter().any(|y| y.is_finite())) {
            let note = Lettering { size: 12.0, colour: FAINT, bold: false, align: Align::Centre };
            canvas.text("no data", ((frame.left + frame.right) / 2.0, (frame.top + frame.bottom) / 2.0), note);
        }
        let (a, b) = ((frame.left, frame.top), (frame.right, frame.bottom));
        canvas.line(&[a, (b.0, a.1), b, (a.0, b.1), a], Pen { colour: INK, width: 0.9, alpha: 1.0 });
        draw_y_axis(place, canvas);
    }

    fn draw_x_axis(&self, figure: &Figure, place: &Place, canvas: &Canvas) {
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
        let middle = (frame.left + frame.right) / 2.0;
        canvas.text(
            &axis_label(&figure.x, &self.x),
            (middle, below + 6.0 + LABEL_SIZE),
            Lettering { size: LABEL_SIZE, ..letters },
        );
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

/// Draws layers into one panel.
struct Brush<'a, 'c> {
    canvas: &'a Canvas<'c>,
    styles: &'a Styles<'a>,
    frame: Frame,
    x: &'a Scale,
    y: &'a Scale,
}

impl Brush<'_, '_> {
    fn place(&self, x: f64, y: f64) -> Pixel {
        let f = self.frame;
        // Far outside is outside enough: pixels stay representable.
        let px = f.left + self.x.fraction(x) * (f.right - f.left);
        let py = f.bottom - self.y.fraction(y) * (f.bottom - f.top);
        (bounded(px), bounded(py))
    }

    fn strip(&self, layer: &Layer) {
        let Shape::ShadedX { from, to } = layer.shape else { return };
        let (a, b) = (self.place(from, 0.0).0, self.place(to, 0.0).0);
        let (a, b) = (a.min(b).max(self.frame.left), a.max(b).min(self.frame.right));
        if b > a {
            let (colour, alpha) = self.styles.strip(layer);
            self.canvas.rectangle((a, self.frame.top), (b, self.frame.bottom), colour, alpha);
        }
    }

    fn layer(&self, layer: &Layer) {
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
    let data = extent(panel.layers.iter().flat_map(ys));
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

/// `Angle of attack  α [deg]`, with the factor that tick labels leave out.
fn axis_label(axis: &Axis, scale: &Scale) -> String {
    let parts = [clean(&axis.label, 80), quantity(axis, scale)];
    parts.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join("\u{A0} ")
}

/// Symbol and unit: `α [deg]`, `w [10⁻³ m/s]`, `t − 1469600000 [s]`.
fn quantity(axis: &Axis, scale: &Scale) -> String {
    let mut text = symbol(&axis.symbol);
    if scale.offset != 0.0 {
        text += &format!(" − {}", scale.offset);
    }
    let unit = [scale.factor.clone(), powers(&clean(&axis.unit, 24))]
        .into_iter()
        .filter(|p| !p.is_empty())
        .collect::<Vec<_>>()
        .join(" ");
    match (text.is_empty(), unit.is_empty()) {
        (_, true) => text,
        (true, false) => format!("[{unit}]"),
        (false, false) => format!("{text} [{unit}]"),
    }
}

/// Powers in a unit raised: `1/rad^2` becomes `1/rad²`.
fn powers(unit: &str) -> String {
    let mut parts = unit.split('^');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |out, part| {
        let digits = part.find(|c: char| !c.is_ascii_digit() && c != '-').unwrap_or(part.len());
        match part[..digits].parse() {
            Ok(power) => out + &superscript(power) + &part[digits..],
            Err(_) => out + "^" + part,
        }
    })
}

/// On one line where it fits beside the panel, otherwise on two.
fn y_label(axis: &Axis, scale: &Scale, height: f64) -> Vec<String> {
    let whole = axis_label(axis, scale);
    if width(&without_markup(&whole), LABEL_SIZE, false) <= height + 16.0 {
        return vec![whole];
    }
    [clean(&axis.label, 80), quantity(axis, scale)].into_iter().filter(|p| !p.is_empty()).collect()
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

fn xs(layer: &Layer) -> Vec<f64> {
    match &layer.shape {
        Shape::Points { xs, x_interval, .. } => {
            let ends = x_interval.iter().flatten().flat_map(|&(a, b)| [a, b]);
            xs.iter().copied().chain(ends).collect()
        }
        Shape::Line { xs, .. } | Shape::Band { xs, .. } => xs.clone(),
        Shape::ShadedX { from, to } => vec![*from, *to],
        Shape::AtX(x) => vec![*x],
        Shape::AtY(_) => Vec::new(),
    }
}

fn ys(layer: &Layer) -> Vec<f64> {
    match &layer.shape {
        Shape::Points { ys, y_interval, .. } => {
            let ends = y_interval.iter().flatten().flat_map(|&(a, b)| [a, b]);
            ys.iter().copied().chain(ends).collect()
        }
        Shape::Line { ys, .. } => ys.clone(),
        Shape::Band { low, high, .. } => low.iter().chain(high).copied().collect(),
        Shape::AtY(y) => vec![*y],
        Shape::ShadedX { .. } | Shape::AtX(_) => Vec::new(),
    }
}
