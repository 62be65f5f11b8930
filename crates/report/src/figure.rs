//! What a figure is: axes, panels and layers, as plain data. How it is drawn stands in `draw`.

/// One x axis and one or more panels, stacked above each other and sharing it.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// File stem and identifier, unique within a report: letters, digits, `-` and `_` (others become `-`).
    pub name: String,
    /// Drawn above the panels. Journals put the title into the caption, so most figures have none.
    pub title: Option<String>,
    /// One or two sentences below the figure: what is shown, and what bars and bands mean.
    pub caption: String,
    /// Shared by all panels, labelled below the last one.
    pub x: Axis,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// Whether a length along x is as long along y, as on a map; of a figure with one panel.
    pub is_map: bool,
}

/// One coordinate system of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// A few words above the panel, where stacked panels need telling apart.
    pub title: Option<String>,
    /// The panel's own y axis.
    pub y: Axis,
    /// Drawn in this order, shaded ranges and bands first in any case.
    pub layers: Vec<Layer>,
}

/// A quantity along one direction: what it is called, its symbol, its unit, and the range to show.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity in words, `Angle of attack`.
    pub label: String,
    /// Its symbol, set in italics; `_` lowers the following letter or `{...}` group: `C_L`, `V_z`, `r_{p1}`. May be empty.
    pub symbol: String,
    /// Its unit, `deg`, `m/s`; empty for a pure number.
    pub unit: String,
    /// From and to; without it, tightly around the finite data.
    pub range: Option<(f64, f64)>,
    /// Whether values grow downwards (y) or leftwards (x): depth.
    pub reversed: bool,
    /// Names instead of numbers, each at its value: the mechanisms of a comparison, the hulls of a campaign.
    pub names: Vec<(f64, String)>,
}

/// One thing drawn in a panel. Layers with the same label share one colour, one marker and one legend entry throughout
/// the figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// The text in the legend; without one the layer stays out of it.
    pub label: Option<String>,
    /// Place in the palette, where the colour must not follow from the label: layers of one hull share a slot. Slot 0
    /// is blue, 1 vermilion, 2 green, 3 purple, 4 orange, 5 sky blue; further slots repeat them with other markers.
    pub slot: Option<usize>,
    /// What it is.
    pub shape: Shape,
}

/// What a layer shows. All vectors of one shape are of equal length (a longer one is cut); values in the axes' units;
/// NaN and infinite values are left out, and interrupt lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Markers, with intervals as bars where given.
    Points {
        /// Along x.
        xs: Vec<f64>,
        /// Along y.
        ys: Vec<f64>,
        /// Low and high end of each bar along y.
        y_interval: Option<Vec<(f64, f64)>>,
        /// Low and high end of each bar along x.
        x_interval: Option<Vec<(f64, f64)>>,
    },
    /// A polyline.
    Line {
        /// Along x, in the order of drawing.
        xs: Vec<f64>,
        /// Along y.
        ys: Vec<f64>,
        /// How the stroke is broken.
        dash: Dash,
    },
    /// The area between two curves: a confidence band, the spread of a group.
    Band {
        /// Along x, increasing.
        xs: Vec<f64>,
        /// Lower edge.
        low: Vec<f64>,
        /// Upper edge.
        high: Vec<f64>,
    },
    /// A vertical strip over the whole height: the fitted range, the window of a run.
    ShadedX {
        /// One edge.
        from: f64,
        /// The other edge.
        to: f64,
    },
    /// A vertical line over the whole height.
    AtX(f64),
    /// A horizontal line over the whole width: zero, a limit, an expected value.
    AtY(f64),
}

/// How a line is broken, so that lines differ in print without colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dash {
    /// Unbroken.
    #[default]
    Solid,
    /// Long strokes: a model, a prediction.
    Dashed,
    /// Short strokes: theory, a reference.
    Dotted,
}

impl Figure {
    /// A figure without panels yet.
    pub fn new(name: impl Into<String>, x: Axis) -> Self {
        Figure { name: name.into(), title: None, caption: String::new(), x, panels: Vec::new(), is_map: false }
    }

    /// With a title above the panels.
    pub fn title(self, title: impl Into<String>) -> Self {
        Figure { title: Some(title.into()), ..self }
    }

    /// With a caption.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Figure { caption: caption.into(), ..self }
    }

    /// With axes of one scale, as on a map.
    pub fn map(self) -> Self {
        Figure { is_map: true, ..self }
    }

    /// With one more panel below the others.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }
}

impl Panel {
    /// A panel without layers yet.
    pub fn new(y: Axis) -> Self {
        Panel { title: None, y, layers: Vec::new() }
    }

    /// With a few words above it.
    pub fn title(self, title: impl Into<String>) -> Self {
        Panel { title: Some(title.into()), ..self }
    }

    /// With one more layer.
    pub fn layer(mut self, layer: Layer) -> Self {
        self.layers.push(layer);
        self
    }

    /// With more layers.
    pub fn layers(mut self, layers: impl IntoIterator<Item = Layer>) -> Self {
        self.layers.extend(layers);
        self
    }
}

impl Axis {
    /// An axis around its data: label, symbol (may be empty), unit (empty for a pure number).
    pub fn new(label: impl Into<String>, symbol: impl Into<String>, unit: impl Into<String>) -> Self {
        Axis {
            label: label.into(),
            symbol: symbol.into(),
            unit: unit.into(),
            range: None,
            reversed: false,
            names: Vec::new(),
        }
    }

    /// An axis of names, at 0, 1, 2, ... in this order (from the top where it is a y axis).
    pub fn of_names<S: Into<String>>(label: impl Into<String>, names: impl IntoIterator<Item = S>) -> Self {
        let names: Vec<_> = names.into_iter().enumerate().map(|(i, name)| (i as f64, name.into())).collect();
        let range = Some((-0.6, names.len().max(1) as f64 - 0.4));
        Axis { names, range, ..Axis::new(label, "", "") }
    }

    /// With a fixed range. Points outside are counted in the figure, never silently lost.
    pub fn range(self, from: f64, to: f64) -> Self {
        Axis { range: Some((from, to)), ..self }
    }

    /// With values growing downwards (y) or leftwards (x).
    pub fn reversed(self) -> Self {
        Axis { reversed: true, ..self }
    }
}

impl Layer {
    fn new(shape: Shape) -> Self {
        Layer { label: None, slot: None, shape }
    }

    /// Markers.
    pub fn points(xs: Vec<f64>, ys: Vec<f64>) -> Self {
        Layer::new(Shape::Points { xs, ys, y_interval: None, x_interval: None })
    }

    /// A line.
    pub fn line(xs: Vec<f64>, ys: Vec<f64>) -> Self {
        Layer::new(Shape::Line { xs, ys, dash: Dash::Solid })
    }

    /// The curve of a function over a range, at 201 abscissae.
    pub fn curve(from: f64, to: f64, function: impl Fn(f64) -> f64) -> Self {
        let xs: Vec<f64> = (0..=200).map(|i| from + (to - from) * f64::from(i) / 200.0).collect();
        let ys = xs.iter().map(|&x| function(x)).collect();
        Layer::line(xs, ys)
    }

    /// The area between two curves over increasing abscissae.
    pub fn band(xs: Vec<f64>, low: Vec<f64>, high: Vec<f64>) -> Self {
        Layer::new(Shape::Band { xs, low, high })
    }

    /// A vertical strip.
    pub fn shaded_x(from: f64, to: f64) -> Self {
        Layer::new(Shape::ShadedX { from, to })
    }

    /// A vertical line.
    pub fn at_x(x: f64) -> Self {
        Layer::new(Shape::AtX(x))
    }

    /// A horizontal line.
    pub fn at_y(y: f64) -> Self {
        Layer::new(Shape::AtY(y))
    }

    /// With an entry in the legend.
    pub fn label(self, label: impl Into<String>) -> Self {
        Layer { label: Some(label.into()), ..self }
    }

    /// With a fixed place in the palette.
    pub fn slot(self, slot: usize) -> Self {
        Layer { slot: Some(slot), ..self }
    }

    /// A line drawn dashed or dotted; no effect on other shapes.
    pub fn dash(mut self, broken: Dash) -> Self {
        if let Shape::Line { dash, .. } = &mut self.shape {
            *dash = broken;
        }
        self
    }

    /// Points with bars of the given half-length along y; no effect on other shapes.
    pub fn y_error(self, half: Vec<f64>) -> Self {
        let ends = match &self.shape {
            Shape::Points { ys, .. } => around(ys, &half),
            _ => Vec::new(),
        };
        self.y_interval(ends)
    }

    /// Points with bars of the given half-length along x; no effect on other shapes.
    pub fn x_error(self, half: Vec<f64>) -> Self {
        let ends = match &self.shape {
            Shape::Points { xs, .. } => around(xs, &half),
            _ => Vec::new(),
        };
        self.x_interval(ends)
    }

    /// Points with bars from the low to the high end along y; no effect on other shapes.
    pub fn y_interval(mut self, ends: Vec<(f64, f64)>) -> Self {
        if let Shape::Points { y_interval, .. } = &mut self.shape {
            *y_interval = Some(ends);
        }
        self
    }

    /// Points with bars from the low to the high end along x; no effect on other shapes.
    pub fn x_interval(mut self, ends: Vec<(f64, f64)>) -> Self {
        if let Shape::Points { x_interval, .. } = &mut self.shape {
            *x_interval = Some(ends);
        }
        self
    }
}

impl Layer {
    /// Everything that it shows along x, ends of bars included.
    pub(super) fn xs(&self) -> Vec<f64> {
        match &self.shape {
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

    /// Everything that it shows along y, ends of bars included.
    pub(super) fn ys(&self) -> Vec<f64> {
        match &self.shape {
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
}

fn around(centres: &[f64], half: &[f64]) -> Vec<(f64, f64)> {
    centres.iter().zip(half).map(|(c, h)| (c - h, c + h)).collect()
}
