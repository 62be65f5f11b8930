//! A curve that the reader moves: two sliders, the curve at the value of the first, the point on it at the value of the second
//! and what belongs to the point. For the screen alone: print and pages without scripts have the figures beside it.

use super::figure::Axis;
use super::mouse::{axis, plain};
use serde_json::{Value, json};

/// A family of curves by two parameters, computed beforehand at each pair of their values.
#[derive(Debug, Clone, PartialEq)]
pub struct Explorer {
    /// One or two sentences below it.
    pub caption: String,
    /// Which curve.
    pub curve: Slider,
    /// Which point of it.
    pub point: Slider,
    /// The quantity along x.
    pub x: Quantity,
    /// The quantity along y.
    pub y: Quantity,
    /// Further quantities of the point.
    pub further: Vec<Quantity>,
}

/// A parameter of the family.
#[derive(Debug, Clone, PartialEq)]
pub struct Slider {
    /// The parameter in words.
    pub label: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// The values that it takes, in the order of the slider.
    pub values: Vec<f64>,
    /// Which of them it has first.
    pub begins_at: usize,
}

/// A quantity at each pair of values.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// What it is; its range is that of the plot.
    pub axis: Axis,
    /// By the first slider, then by the second; NaN where there is no such point.
    pub values: Vec<Vec<f64>>,
}

impl Explorer {
    /// What the page's script takes.
    pub(super) fn numbers(&self) -> Value {
        let quantities: Vec<Value> = [&self.x, &self.y].into_iter().chain(&self.further).map(quantity).collect();
        json!({ "sliders": [slider(&self.curve), slider(&self.point)], "quantities": quantities })
    }
}

fn slider(slider: &Slider) -> Value {
    json!({ "label": slider.label, "unit": slider.unit, "values": plain(&slider.values), "start": slider.begins_at })
}

fn quantity(quantity: &Quantity) -> Value {
    let values: Vec<_> = quantity.values.iter().map(|row| plain(row)).collect();
    json!({ "axis": axis(&quantity.axis), "values": values })
}
