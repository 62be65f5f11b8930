//! The figures of an identification: the tank paper's Figures 11 to 14, residuals, profiles, balance of moments.

use crate::dynamics::Parameters;
use crate::identify::identifiability::ProfilePoint;
use crate::identify::polar_points::PolarPoint;
use crate::identify::{Dive, Residual};
use crate::report::{Axis, Dash, Figure, Layer, Panel, Section};

/// Points of a cloud that are drawn at most.
const MOST_POINTS: usize = 4000;

/// A model's coefficients on one leg, for its curve.
pub(super) struct Leg {
    pub name: &'static str,
    pub descends: bool,
    pub a: f64,
    pub b: f64,
    pub c: f64,
}

/// The two legs of these parameters.
pub(super) fn legs(p: &Parameters<f64>) -> [Leg; 2] {
    [
        Leg { name: "descents", descends: true, a: p.a_per_rad, b: p.b, c: p.c_per_rad2 },
        Leg {
            name: "ascents",
            descends: false,
            a: p.a_per_rad * p.ascent_a_ratio,
            b: p.b * p.ascent_b_ratio * p.climb_dive_drag_ratio,
            c: p.c_per_rad2 * p.ascent_c_ratio * p.climb_dive_drag_ratio,
        },
    ]
}

/// Depth, pitch and vertical velocity against time, measured and by the fitted glide.
pub(super) fn time_series(parameters: &Parameters<f64>, dives: &[Dive]) -> Figure {
    let samples: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    let every = samples.div_ceil(MOST_POINTS).max(1);
    let first_s = dives.iter().flat_map(|dive| &dive.observations).map(|o| o.time_s).fold(f64::INFINITY, f64::min);
    let (mut time, mut depth, mut pitch, mut measured, mut modelled) = (vec![], vec![], vec![], vec![], vec![]);
    for dive in dives {
        for (o, r) in dive.observations.iter().zip(dive.residuals(parameters)).step_by(every) {
            time.push((o.time_s - first_s) / 3600.0);
            depth.push(o.pressure_dbar);
            pitch.push(o.pitch_rad.to_degrees());
            measured.push(-o.sink_m_s);
            modelled.push(r.sink_m_s - o.sink_m_s);
        }
    }
    let points = |ys: Vec<f64>, label: &str| Layer::points(time.clone(), ys).label(label);
    Figure::new("time-series", Axis::new("Time", "t", "h"))
        .panel(Panel::new(Axis::new("Pressure", "p", "dbar").reversed()).layer(points(depth, "measured")))
        .panel(Panel::new(Axis::new("Pitch", "θ", "deg")).layer(points(pitch, "measured")))
        .panel(
            Panel::new(Axis::new("Upwards", "w", "m/s"))
                .layer(points(measured, "measured"))
                .layer(points(modelled, "modelled")),
        )
        .caption(if every == 1 {
            "Samples on legs against time from the first of them; the vertical velocity of the fitted glide beside the measured one.".to_owned()
        } else {
            format!("Every {every}th sample on legs against time from the first of them; the vertical velocity of the fitted glide beside the measured one.")
        })
}

/// Figures 11 and 12: path angle and speed against pitch.
pub(super) fn path_and_speed(points: &[PolarPoint]) -> Figure {
    let of = |descends: bool, value: fn(&PolarPoint) -> f64, label: &str| {
        let legs: Vec<&PolarPoint> = points.iter().filter(|p| p.descends() == descends).collect();
        let pitch = legs.iter().map(|p| p.glide.pitch_rad.to_degrees()).collect();
        Layer::points(pitch, legs.iter().map(|p| value(p)).collect()).label(label)
    };
    let both = |value: fn(&PolarPoint) -> f64| [of(true, value, "descents"), of(false, value, "ascents")];
    let measured = points.iter().any(|p| p.measured_speed_m_s.is_finite());
    let mut speed = Panel::new(Axis::new("Speed", "V", "m/s")).layers(both(|p| p.speed_m_s));
    if measured {
        speed = speed.layer(of(true, |p| p.measured_speed_m_s, "measured speed"));
    }
    Figure::new("glide-path-and-speed", Axis::new("Pitch", "θ", "deg"))
        .panel(
            Panel::new(Axis::new("Glide path angle", "ξ", "deg")).layers(both(|p| p.glide_angle_rad.to_degrees())),
        )
        .panel(speed)
        .caption("The means of each glide: path angle and speed through the water against pitch (the tank paper's Figures 11 and 12).")
}

/// Figures 13 and 14: drag and lift coefficient against the angle of attack, with the fitted curves.
pub(super) fn coefficients(points: &[PolarPoint], parameters: &Parameters<f64>) -> Figure {
    let widest = points.iter().map(|p| p.angle_of_attack_rad.to_degrees().abs()).fold(2.0, f64::max) * 1.1;
    let cloud = |leg: &Leg, value: &dyn Fn(&PolarPoint) -> f64| {
        let legs: Vec<&PolarPoint> = points.iter().filter(|p| p.descends() == leg.descends).collect();
        let alpha = legs.iter().map(|p| p.angle_of_attack_rad.abs().to_degrees()).collect();
        Layer::points(alpha, legs.iter().map(|p| value(p)).collect()).label(leg.name)
    };
    let mut drag = Panel::new(Axis::new("Drag coefficient", "C_D", ""));
    let mut lift = Panel::new(Axis::new("Lift coefficient, size", "C_L", ""));
    for leg in legs(parameters) {
        let (a, b, c) = (leg.a, leg.b, leg.c);
        let curve = Layer::curve(0.0, widest, |x| b + c * x.to_radians().powi(2));
        drag = drag.layer(cloud(&leg, &|p| p.drag_coefficient)).layer(curve.label(leg.name));
        let line = Layer::curve(0.0, widest, |x| a * x.to_radians());
        lift = lift.layer(cloud(&leg, &|p| p.lift_coefficient.abs())).layer(line.label(leg.name));
    }
    Figure::new("coefficients", Axis::new("Angle of attack, size", "α", "deg").range(0.0, widest))
        .panel(drag)
        .panel(lift)
        .caption("Drag and lift coefficient of each glide on the frontal area, from its own balance of forces with the model's angle of attack, and the fitted b + cα² and aα at the reference speed (the tank paper's Figures 13 and 14).")
}

/// Dives that are drawn at most.
const MOST_DIVES: usize = 8;

/// Longest time between two samples over which the modelled depth is carried on \[s\]; beyond it begins anew.
const LONGEST_STEP_S: f64 = 120.0;

/// Depth and vertical velocity, measured and modelled, over the time of each dive: the first dives, the last, and others
/// evenly between.
pub(super) fn dives_over_time(parameters: &Parameters<f64>, dives: &[Dive]) -> Option<Section> {
    let flown: Vec<&Dive> = dives.iter().filter(|dive| dive.observations.len() > 2).collect();
    let shown = flown.len().min(MOST_DIVES);
    let last = flown.len().checked_sub(1)?;
    let indices = (0..shown).map(|i| if shown > 1 { i * last / (shown - 1) } else { 0 });
    let title = if shown < flown.len() {
        format!("Measured and modelled, {shown} of {} dives", flown.len())
    } else {
        "Measured and modelled, dive by dive".to_owned()
    };
    let section = Section::new(title).text(
        "The modelled depth is the sum of the modelled velocities from where each leg's steady samples begin. What it misses at the leg's end is the mean error of its vertical velocity times its duration.",
    );
    Some(indices.fold(section, |section, index| section.figure(dive_over_time(parameters, flown[index], index))))
}

fn dive_over_time(parameters: &Parameters<f64>, dive: &Dive, index: usize) -> Figure {
    let found = dive.residuals(parameters);
    let begin_s = dive.observations[0].time_s;
    let every = dive.observations.len().div_ceil(MOST_POINTS / 4).max(1);
    // Time, depth measured and modelled, downward velocity measured and modelled.
    let mut columns: [Vec<f64>; 5] = Default::default();
    let mut before: Option<(f64, u32, f64)> = None;
    let mut depth = f64::NAN;
    for (i, (o, residual)) in dive.observations.iter().zip(&found).enumerate() {
        let modelled_m_s = o.sink_m_s - residual.sink_m_s;
        let step = before.filter(|(time_s, leg, _)| *leg == o.leg && o.time_s - time_s < LONGEST_STEP_S);
        depth = match step {
            Some((time_s, _, velocity)) if modelled_m_s.is_finite() => {
                depth + 0.5 * (velocity + modelled_m_s) * (o.time_s - time_s) * DBAR_PER_M
            }
            _ => o.pressure_dbar,
        };
        before = modelled_m_s.is_finite().then_some((o.time_s, o.leg, modelled_m_s));
        if i % every == 0 {
            let row = [(o.time_s - begin_s) / 60.0, o.pressure_dbar, depth, o.sink_m_s * 100.0, modelled_m_s * 100.0];
            columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        }
    }
    let [time, measured, modelled, sink, sink_modelled] = columns;
    let both = |measured: Vec<f64>, modelled: Vec<f64>| {
        [
            Layer::points(time.clone(), measured).label("measured"),
            Layer::points(time.clone(), modelled).label("modelled"),
        ]
    };
    Figure::new(format!("dive-{}", index + 1), Axis::new("Time since the first steady sample", "t", "min"))
        .panel(Panel::new(Axis::new("Pressure", "p", "dbar").reversed()).layers(both(measured, modelled)))
        .panel(Panel::new(Axis::new("Downward velocity", "w", "cm/s")).layers(both(sink, sink_modelled)))
        .caption(format!("Dive {} of the log, steady samples.", index + 1))
}

/// 1 m of sea water of 1025 kg/m3 \[dbar/m\].
const DBAR_PER_M: f64 = 1.0055;

/// Residuals of the vertical velocity against time and against pressure.
pub(super) fn residual_clouds(parameters: &Parameters<f64>, dives: &[Dive]) -> Vec<Figure> {
    let samples: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    let every = samples.div_ceil(MOST_POINTS).max(1);
    let mut at: [[Vec<f64>; 3]; 2] = Default::default();
    for dive in dives {
        let found: Vec<Residual> = dive.residuals(parameters);
        for (o, residual) in dive.observations.iter().zip(&found).step_by(every) {
            let side = &mut at[usize::from(!o.descends())];
            side[0].push(o.time_s / 3600.0);
            side[1].push(o.pressure_dbar);
            side[2].push(residual.sink_m_s * 1e3);
        }
    }
    let cloud = |x: usize| {
        let layers = at.iter().zip(["descents", "ascents"]);
        Panel::new(Axis::new("Measured less model", "w", "mm/s"))
            .layer(Layer::at_y(0.0))
            .layers(layers.map(|(side, label)| Layer::points(side[x].clone(), side[2].clone()).label(label)))
    };
    let which = if every > 1 { format!("every {every}th sample") } else { "all samples".to_owned() };
    vec![
        Figure::new("residuals-time", Axis::new("Time", "t", "h"))
            .panel(cloud(0))
            .caption(format!("Residuals of the vertical velocity against time, {which}. Slow waves are the water's own motion.")),
        Figure::new("residuals-pressure", Axis::new("Pressure", "p", "dbar"))
            .panel(cloud(1))
            .caption(format!("The same against pressure, {which}: what bends here is a hull's compressibility, its expansion, or a density.")),
    ]
}

/// The profile of the lift slope: what vertical velocity sees of it, and what speed would.
pub(super) fn lift_slope_profile(profile: &[ProfilePoint]) -> Figure {
    let xs = |of: fn(&ProfilePoint) -> f64| -> (Vec<f64>, Vec<f64>) {
        profile.iter().map(|point| (point.value, of(point))).unzip()
    };
    let line = |of: fn(&ProfilePoint) -> f64| {
        let (x, y) = xs(of);
        [Layer::points(x.clone(), y.clone()).label("profile"), Layer::line(x, y).dash(Dash::Dotted).label("profile")]
    };
    Figure::new("profile-lift-slope", Axis::new("Lift slope held", "a", "1/rad"))
        .panel(Panel::new(Axis::new("Vertical velocity, rms", "w", "mm/s")).layers(line(|p| p.w_rms_m_s * 1e3)))
        .panel(Panel::new(Axis::new("Mean speed of the model", "V", "m/s")).layers(line(|p| p.mean_speed_m_s)))
        .panel(
            Panel::new(Axis::new("Deviance", "", ""))
                .layers(line(|p| p.deviance))
                .layer(Layer::at_y(CHI2_95)),
        )
        .caption("The lift slope held, all else fitted again. Where the w error stays flat while the speed moves, these data do not identify the lift slope. Horizontal line: 95 % point of the deviance.")
}

/// 95 % point of chi squared with one degree of freedom.
pub(super) const CHI2_95: f64 = 3.841;

/// The profile of any other parameter.
pub(super) fn profile(name: &str, unit: &str, points: &[ProfilePoint]) -> Figure {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.value, p.deviance)).unzip();
    Figure::new(format!("profile-{name}"), Axis::new(name, "", unit))
        .panel(
            Panel::new(Axis::new("Deviance", "", ""))
                .layer(Layer::points(x.clone(), y.clone()).label("profile"))
                .layer(Layer::line(x, y).dash(Dash::Dotted).label("profile"))
                .layer(Layer::at_y(CHI2_95)),
        )
        .caption(format!("Profile likelihood of {name}: held, all else fitted again. Horizontal line: 95 % point."))
}

/// Pitch as read against pitch from the balance of moments.
pub(super) fn pitch(read_deg: [Vec<f64>; 2], predicted_deg: [Vec<f64>; 2]) -> Figure {
    let layers = read_deg.into_iter().zip(predicted_deg).zip(["descents", "ascents"]);
    let layers: Vec<Layer> = layers
        .map(|((read, predicted), label)| {
            let error = read.iter().zip(&predicted).map(|(r, p)| r - p).collect();
            Layer::points(read, error).label(label)
        })
        .collect();
    Figure::new("pitch-balance", Axis::new("Pitch as read", "θ", "deg"))
        .panel(Panel::new(Axis::new("Read less predicted", "θ", "deg")).layer(Layer::at_y(0.0)).layers(layers))
        .caption(
            "Pitch that battery position and ballast give by the balance of moments, against the pitch that was read.",
        )
}
