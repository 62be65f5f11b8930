//! Figures with logarithmic axes: exponents are drawn, powers of ten are written beside them.

use glidepolar::report::{Axis, Dash, Figure, Layer, Panel};

/// One curve: what it is, sizes, values.
pub struct Curve {
    pub label: String,
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// The slope on logarithmic axes by least squares over the larger half of the sizes, where fixed costs no longer count.
    pub fn slope(&self) -> f64 {
        let half = self.points.len() / 2;
        let tail = if self.points.len() - half >= 2 { &self.points[half..] } else { &self.points[..] };
        let logs: Vec<(f64, f64)> = tail.iter().map(|(x, y)| (x.log10(), y.log10())).collect();
        let n = logs.len() as f64;
        let (mean_x, mean_y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
        let above: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
        above / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
    }
}

/// Panels of curves over one size, each with a dotted line of slope 1 through its first curve's last point.
pub fn growth(name: &str, size: &str, panels: Vec<(&str, &str, Vec<Curve>)>, caption: &str) -> Figure {
    let xs = panels.iter().flat_map(|(_, _, curves)| curves.iter().flat_map(|c| c.points.iter().map(|p| p.0)));
    let mut figure = Figure::new(name, logarithmic(size, "", xs.collect())).caption(caption);
    for (label, unit, curves) in panels {
        let ys = curves.iter().flat_map(|c| c.points.iter().map(|p| p.1)).collect();
        let mut panel = Panel::new(Axis { reversed: true, ..logarithmic(label, unit, ys) });
        if let Some((x, y)) = curves.first().and_then(|curve| curve.points.last().copied()) {
            let from = curves[0].points[0].0;
            let line = Layer::line(vec![from.log10(), x.log10()], vec![(y * from / x).log10(), y.log10()]);
            panel = panel.layer(line.dash(Dash::Dotted).label("slope 1"));
        }
        for curve in &curves {
            let (xs, ys): (Vec<f64>, Vec<f64>) = curve.points.iter().map(|(x, y)| (x.log10(), y.log10())).unzip();
            panel = panel
                .layer(Layer::points(xs.clone(), ys.clone()).label(&curve.label))
                .layer(Layer::line(xs, ys).label(&curve.label));
        }
        figure = figure.panel(panel);
    }
    figure
}

fn logarithmic(label: &str, unit: &str, values: Vec<f64>) -> Axis {
    let logs = values.iter().filter(|v| **v > 0.0).map(|v| v.log10());
    let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = if low <= high { (low.floor(), high.ceil().max(low.floor() + 1.0)) } else { (0.0, 1.0) };
    let names = (low as i32..=high as i32).map(|power| (f64::from(power), power_of_ten(power))).collect();
    Axis { names, range: Some((low - 0.1, high + 0.1)), ..Axis::new(label, "", unit) }
}

fn power_of_ten(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match power {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        2 => "100".to_owned(),
        _ => {
            let digits = power.unsigned_abs().to_string();
            let raised = digits.bytes().map(|digit| DIGITS[usize::from(digit - b'0')]);
            let sign = if power < 0 { "⁻" } else { "" };
            format!("10{sign}{}", raised.collect::<String>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let points = (1..=6).map(|i| 10f64.powi(i)).map(|x| (x, 3.0 * x.powf(1.5))).collect();
        let curve = Curve { label: "x to the 3/2".to_owned(), points };
        assert!((curve.slope() - 1.5).abs() < 1e-12);
    }

    #[test]
    fn powers_are_written_as_powers() {
        assert_eq!([0, 2, 6, -3, 12].map(power_of_ten), ["1", "100", "10⁶", "10⁻³", "10¹²"]);
    }
}
