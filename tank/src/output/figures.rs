//! The figures: coefficients against angle of attack for all hulls, residuals, trends, and each run's history.

use glidepolar_report::{Axis, Dash, Figure, Layer, Panel};

use crate::fits::SweepFit;
use crate::results::{HullResults, Results, RunResults};
use crate::trend::COEFFICIENTS;

/// Words and symbol of each coefficient, and the stem of its figure.
const COEFFICIENT_AXES: [(&str, &str, &str); 3] =
    [("lift", "Lift coefficient", "C_L"), ("drag", "Drag coefficient", "C_D"), ("moment", "Moment coefficient", "C_M")];
/// Half width of a 95 % interval of one point.
const TWO_SIDED: f64 = 1.96;

/// Lift, drag and moment coefficient against angle of attack, all hulls.
pub fn coefficients(results: &Results) -> Vec<Figure> {
    (0..3).map(|coefficient| against_angle(results, coefficient)).collect()
}

fn against_angle(results: &Results, coefficient: usize) -> Figure {
    let (stem, words, symbol) = COEFFICIENT_AXES[coefficient];
    let range = results.range_deg;
    let mut panel =
        Panel::new(Axis::new(words, symbol, "")).layer(Layer::shaded_x(-range, range).label("fitted range"));
    for (slot, hull) in results.hulls.iter().enumerate() {
        if hull.sweep.points.is_empty() {
            continue;
        }
        let xs: Vec<f64> = hull.sweep.points.iter().map(|p| p.yaw_deg).collect();
        let ys = hull.sweep.points.iter().map(|p| p.coefficients[coefficient]).collect();
        let mut points = Layer::points(xs.clone(), ys).label(&hull.hull.id).slot(slot);
        if hull.sweep.has_errors() {
            points = points.y_error(hull.sweep.points.iter().map(|p| TWO_SIDED * p.se[coefficient]).collect());
        }
        panel = panel.layer(points);
        if let Ok(fit) = &hull.fit {
            let widest = xs.iter().fold(range, |w, x| w.max(x.abs()));
            let model = |degrees: f64| model(fit, coefficient, degrees.to_radians());
            panel = panel.layer(Layer::curve(-range, range, model).label(&hull.hull.id).slot(slot));
            if widest > range {
                let beyond = |from, to| Layer::curve(from, to, model).slot(slot).dash(Dash::Dashed);
                panel = panel.layer(beyond(range, widest)).layer(beyond(-widest, -range));
            }
        }
    }
    let bars =
        if results.hulls.iter().any(|h| h.sweep.has_errors()) { " Bars: 95 % from within each run." } else { "" };
    Figure::new(stem, Axis::new("Angle of attack", "α", "deg")).panel(panel).caption(format!(
        "{words} against angle of attack about the centre of buoyancy, on the frontal area. Lines: fits within {range} deg, dashed beyond.{bars}"
    ))
}

fn model(fit: &SweepFit, coefficient: usize, alpha: f64) -> f64 {
    let e = &fit.estimates;
    match coefficient {
        0 => e.a.value * alpha,
        1 => e.b.value + e.c.value * alpha * alpha,
        _ => e.d.value * alpha,
    }
}

/// Measured less fitted against angle of attack, all points whether they entered the fit or not.
pub fn residuals(results: &Results) -> Figure {
    let range = results.range_deg;
    let mut figure = Figure::new("residuals", Axis::new("Angle of attack", "α", "deg")).caption(
        "Measured less fitted, all points; the shaded ones entered the fits. A bend is a model of the wrong kind, a step between the sides an asymmetry.",
    );
    for (coefficient, (_, _, symbol)) in COEFFICIENT_AXES.into_iter().enumerate() {
        let mut panel = Panel::new(Axis::new("residual", format!("Δ{symbol}"), ""))
            .layer(Layer::shaded_x(-range, range))
            .layer(Layer::at_y(0.0));
        for (slot, hull) in results.hulls.iter().enumerate() {
            let Ok(fit) = &hull.fit else { continue };
            let xs = hull.sweep.points.iter().map(|p| p.yaw_deg).collect();
            let left = |p: &crate::sweep::Point| p.coefficients[coefficient] - model(fit, coefficient, p.alpha_rad());
            let ys = hull.sweep.points.iter().map(left).collect();
            panel = panel.layer(Layer::points(xs, ys).label(&hull.hull.id).slot(slot));
        }
        figure = figure.panel(panel);
    }
    figure
}

/// a, b, c, d against length to diameter ratio.
pub fn trend(results: &Results) -> Option<Figure> {
    let fitted: Vec<(&HullResults, &SweepFit)> =
        results.hulls.iter().filter_map(|h| Some((h, h.fit.as_ref().ok()?))).collect();
    if fitted.len() < 2 {
        return None;
    }
    let ldrs: Vec<f64> = fitted.iter().map(|(hull, _)| hull.hull.ldr).collect();
    let (low, high) = ldrs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let mut figure = Figure::new("trend", Axis::new("Length to diameter ratio", "", "")).caption(
        "The coefficients against length to diameter ratio, with 95 % intervals, and the straight lines through them.",
    );
    for (i, (name, unit, fit, parameter)) in COEFFICIENTS.into_iter().enumerate() {
        let estimates: Vec<_> = fitted.iter().map(|(_, f)| f.fits[fit].estimate(parameter, unit)).collect();
        let mut panel = Panel::new(Axis::new(name, "", if unit == "1" { "" } else { unit })).layer(
            Layer::points(ldrs.clone(), estimates.iter().map(|e| e.value).collect())
                .y_interval(estimates.iter().map(|e| (e.ci95[0], e.ci95[1])).collect())
                .slot(0),
        );
        if let Some(lines) = &results.trend {
            let line = &lines.0[i];
            let at = |ldr: f64| line.middle + line.slope.value * (ldr - line.mean_ldr);
            panel = panel.layer(Layer::line(vec![low, high], vec![at(low), at(high)]).slot(0));
        }
        figure = figure.panel(panel);
    }
    Some(figure)
}

/// A run's history with its window.
pub fn run(run: &RunResults) -> Figure {
    let wide = |xs: &[f32]| xs.iter().map(|x| f64::from(*x)).collect::<Vec<f64>>();
    let time = wide(&run.trace.time_s);
    let (from, to) = run.trace.window_s;
    let mut readings = Panel::new(Axis::new("Reading", "", "N, N m")).layer(Layer::shaded_x(from, to));
    for (slot, (channel, name)) in run.trace.channels.iter().zip(["AF", "SF", "YM"]).enumerate() {
        readings = readings.layer(Layer::line(time.clone(), wide(channel)).label(name).slot(slot));
    }
    let speed = Panel::new(Axis::new("Speed", "U", "m/s"))
        .layer(Layer::shaded_x(from, to))
        .layer(Layer::line(time, wide(&run.trace.speed_m_s)).slot(3));
    Figure::new(format!("run-{}", run.run.id), Axis::new("Time", "t", "s"))
        .panel(speed)
        .panel(readings)
        .caption(format!("Run {}, {}: {}", run.run.id, run.run.kind.name(), what(run)))
}

fn what(run: &RunResults) -> String {
    use crate::campaign::Kind;
    let r = &run.run;
    let mut text = match r.kind {
        Kind::Zero => "at rest".to_owned(),
        Kind::Tare | Kind::Static => format!("{} m/s, {} deg", r.speed_m_s, r.yaw_deg),
        Kind::Sway | Kind::Yaw => {
            let amplitude = match (r.kind, r.sway_amplitude_m, r.yaw_amplitude_deg) {
                (Kind::Sway, Some(sway), _) => format!(", {sway} m"),
                (Kind::Yaw, _, Some(yaw)) => format!(", {yaw} deg"),
                _ => String::new(),
            };
            format!("{} m/s, {} Hz{amplitude}", r.speed_m_s, r.frequency_hz)
        }
        Kind::Arc => format!("{} m/s, radius {} m", r.speed_m_s, r.radius_m.unwrap_or(f64::NAN)),
    };
    if let Some((effective, duration)) = run.effective {
        text += &format!(
            "; window {duration:.1} s, effective samples {} {:.0}, {} {:.0}, {} {:.0}",
            "AF", effective[0], "SF", effective[1], "YM", effective[2]
        );
    }
    for notice in &run.notices {
        text += &format!("; {notice}");
    }
    text
}
