//! The diagnosis in words and figures: what is wrong, why, the extension, the gain.

use glidepolar_inference::estimate::Estimate;
use glidepolar_inference::{Cause, Diagnosis, Verdict};
use glidepolar_report::{Axis, Cell, Figure, Layer, Panel, Section, Table, probability};

use crate::diagnose::CHANNEL;
use crate::diagnose::mechanisms::in_tank;
use crate::diagnose::{Diagnoses, RunLeft};
use crate::results::Results;
use crate::sweep::NAMES;

/// Residuals that are channel to be beyond the noise are so many of its standard deviations off, for the band in figures.
const TWO_SIDED: f64 = 1.96;

/// One sentence for each of the four answers.
pub fn sentences(diagnosis: &Diagnosis) -> Vec<String> {
    let mut sentences = vec![wrong(diagnosis)];
    sentences.extend(diagnosis.causes.iter().map(cause));
    for set in &diagnosis.alternatives {
        let sizes: Vec<String> =
            set.iter().flat_map(|other| &other.parameters).map(|(name, size)| shown(name, size)).collect();
        sentences.push(format!("These runs cannot separate all of that from {} together.", sizes.join(", ")));
    }
    if diagnosis.causes.is_empty() && diagnosis.verdict == Verdict::Unexplained {
        sentences.push("No known mechanism explains it.".to_owned());
    }
    if let Some(left) = &diagnosis.unexplained {
        sentences.push(format!(
            "Unexplained: what is left ({} rms {:.2e}) depends on {}.",
            left.quantity,
            left.rms,
            left.depends_on.join(", ")
        ));
    }
    if !diagnosis.causes.is_empty() && diagnosis.gain.holdout_rms_before > 0.0 {
        let gain = &diagnosis.gain;
        sentences.push(format!(
            "On runs held out of the fit the error of {} falls from {:.2e} to {:.2e}, by {:.0} % (95 %: {:.0} to {:.0} %).",
            gain.quantity,
            gain.holdout_rms_before,
            gain.holdout_rms_after,
            gain.reduction_percent,
            gain.ci95[0],
            gain.ci95[1]
        ));
    }
    sentences
}

/// The verdict, for the summary at the top.
pub fn in_a_sentence(diagnosis: &Diagnosis) -> String {
    let causes: Vec<String> = diagnosis.causes.iter().map(|cause| words(&cause.cause)).collect();
    let causes = causes.join(", ");
    match diagnosis.verdict {
        Verdict::None => "Diagnosis: nothing beyond the noise.".to_owned(),
        Verdict::Explained => format!("Diagnosis: {causes}."),
        Verdict::PartlyExplained => format!("Diagnosis: {causes}; a part stays unexplained."),
        Verdict::Unexplained => "Diagnosis: something is wrong, and no known mechanism explains it.".to_owned(),
    }
}

fn wrong(diagnosis: &Diagnosis) -> String {
    match diagnosis.wrong.first() {
        // The test of one quantity against one condition is weaker than that of a cause, which counts all of them at once.
        None if !diagnosis.causes.is_empty() => {
            "No quantity alone departs from CL = a α, CD = b + c α², CM = d α by more than \
             noise; the cause is found in all of them together."
                .to_owned()
        }
        None => "The steady runs depart from CL = a α, CD = b + c α², CM = d α by no more than their noise.".to_owned(),
        Some(wrong) => {
            let also: Vec<String> = diagnosis.wrong[1..]
                .iter()
                .take(3)
                .map(|other| format!("{} with {}", other.quantity, other.regime))
                .collect();
            let also = if also.is_empty() { String::new() } else { format!("; also {}", also.join(", ")) };
            format!(
                "{} departs from its law with {} by {:.2e} rms, of a misfit of {:.2e} ({}){also}.",
                wrong.quantity,
                wrong.regime,
                wrong.size,
                wrong.rms,
                probability(wrong.p_value)
            )
        }
    }
}

fn cause(cause: &Cause) -> String {
    let sizes: Vec<String> = cause.parameters.iter().map(|(name, size)| shown(name, size)).collect();
    let physics = in_tank(&cause.cause).map_or(String::new(), |m| format!(" {} ({}).", m.physics, m.source));
    let alike = if cause.indistinguishable_from.is_empty() {
        String::new()
    } else {
        let names: Vec<String> = cause.indistinguishable_from.iter().map(|name| words(name)).collect();
        let shown_by = in_tank(&cause.indistinguishable_from[0]).map_or(String::new(), |m| format!(": {}", m.shown_by));
        format!(" These runs cannot separate it from {}{shown_by} would.", names.join(", "))
    };
    format!("Cause: {}, {}.{physics}{alike}", words(&cause.cause), sizes.join(", "))
}

fn shown(name: &str, size: &Estimate) -> String {
    if let Some(channel) = channel(name, size) {
        format!("{name} = {channel}")
    } else if size.se > 0.0 {
        format!("{name} = {}", glidepolar_report::estimate(size.value, size.se))
    } else {
        format!("{name} = {}", size.value)
    }
}

/// The name of the channel that drifts, which stands as a number among the sizes.
fn channel(name: &str, size: &Estimate) -> Option<&'static str> {
    (name == CHANNEL).then(|| ["AF", "SF", "YM"].get((size.value as usize).wrapping_sub(1)).copied())?
}

fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// The section of the page; none where nothing was asked.
pub fn section(results: &Results) -> Option<Section> {
    let diagnoses = results.diagnoses.as_ref()?;
    let overall = diagnoses.overall()?;
    let mut section = Section::new("Diagnosis");
    for sentence in sentences(overall) {
        section = section.text(sentence);
    }
    if !diagnoses.runs.is_empty() {
        let names: Vec<&str> = results.hulls.iter().map(|hull| hull.hull.id.as_str()).collect();
        section = section.figure(wrong_figure(diagnoses, &names));
        if !overall.causes.is_empty() {
            let channel = NAMES.iter().position(|name| *name == overall.gain.quantity).unwrap_or(0);
            section = section
                .figure(cause_figure(diagnoses, &names, overall))
                .figure(extension_figure(diagnoses, &names, channel))
                .figure(gain_figure(diagnoses, channel));
        }
    }
    if !overall.causes.is_empty() {
        section = section.table(causes_table(overall));
    }
    if results.hulls.len() > 1 && !overall.causes.is_empty() {
        section = section.table(hulls_table(results, diagnoses));
    }
    Some(section.table(rejected_table(overall)))
}

/// The symbol of a departure, the coefficient written as the other figures write it: `CL` as `ΔC_L`.
fn residual_of(name: &str) -> String {
    name.strip_prefix('C').map_or_else(|| format!("Δ{name}"), |of| format!("ΔC_{of}"))
}

/// WRONG: what the baseline leaves, against angle.
fn wrong_figure(diagnoses: &Diagnoses, names: &[&str]) -> Figure {
    let mut figure = angle_figure("diagnosis-wrong").caption(
        "Wrong: measured less CL = a α, CD = b + c α², CM = d α, fitted to all steady runs; the band is what noise explains (95 %).",
    );
    for (k, name) in NAMES.into_iter().enumerate() {
        let sd = diagnoses.runs.iter().map(|run| run.sd[k]).sum::<f64>() / diagnoses.runs.len() as f64;
        let (low, high) = angles(diagnoses);
        let band = TWO_SIDED * sd;
        let panel = Panel::new(Axis::new("residual", residual_of(name), ""))
            .layer(Layer::band(vec![low, high], vec![-band; 2], vec![band; 2]))
            .layer(Layer::at_y(0.0));
        figure = figure.panel(by_hull(panel, diagnoses, names, |run| run.before[k]));
    }
    figure
}

/// CAUSE: what the named mechanisms add to the baseline.
fn cause_figure(diagnoses: &Diagnoses, names: &[&str], overall: &Diagnosis) -> Figure {
    let causes: Vec<String> = overall.causes.iter().map(|cause| words(&cause.cause)).collect();
    let mut figure = angle_figure("diagnosis-cause")
        .caption(format!("Cause: what {} changes in the model of every run.", causes.join(" with ")));
    for (k, name) in NAMES.into_iter().enumerate() {
        let panel = Panel::new(Axis::new("explained", residual_of(name), "")).layer(Layer::at_y(0.0));
        figure = figure.panel(by_hull(panel, diagnoses, names, |run| run.before[k] - run.after[k]));
    }
    figure
}

/// EXTENSION: the extended model through the measured points.
fn extension_figure(diagnoses: &Diagnoses, names: &[&str], channel: usize) -> Figure {
    let name = NAMES[channel];
    let mut panel = Panel::new(Axis::new("Coefficient", name, ""));
    for (slot, hull) in names.iter().enumerate() {
        let mut runs: Vec<&RunLeft> = at_main_speed(diagnoses, slot);
        runs.sort_by(|a, b| a.yaw_deg.total_cmp(&b.yaw_deg));
        let xs: Vec<f64> = runs.iter().map(|run| run.yaw_deg).collect();
        let modelled = runs.iter().map(|run| run.measured[channel] - run.after[channel]).collect();
        panel = panel
            .layer(
                Layer::points(xs.clone(), runs.iter().map(|run| run.measured[channel]).collect())
                    .label(*hull)
                    .slot(slot),
            )
            .layer(Layer::line(xs, modelled).label(*hull).slot(slot));
    }
    angle_figure("diagnosis-extension").panel(panel).caption(format!(
        "Extension: {name} as measured and, as lines, by the extended model, at the speed most towed at."
    ))
}

/// GAIN: errors on runs that no fit saw, without and with the causes.
fn gain_figure(diagnoses: &Diagnoses, channel: usize) -> Figure {
    let name = NAMES[channel];
    let mut panel = Panel::new(Axis::new("held-out error", residual_of(name), "")).layer(Layer::at_y(0.0));
    for (slot, label) in ["without the causes", "with them"].into_iter().enumerate() {
        let xs = diagnoses.runs.iter().map(|run| run.yaw_deg).collect();
        let ys = diagnoses.runs.iter().map(|run| run.held_out[slot][channel]).collect();
        panel = panel.layer(Layer::points(xs, ys).label(label).slot(slot));
    }
    angle_figure("diagnosis-gain").panel(panel).caption(format!(
        "Gain: error of predicting {name} of runs that were held out of the fit, a quarter of them at a time."
    ))
}

fn angle_figure(name: &str) -> Figure {
    Figure::new(name, Axis::new("Angle of attack", "α", "deg"))
}

fn angles(diagnoses: &Diagnoses) -> (f64, f64) {
    diagnoses
        .runs
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), run| (low.min(run.yaw_deg), high.max(run.yaw_deg)))
}

fn by_hull(mut panel: Panel, diagnoses: &Diagnoses, names: &[&str], value: impl Fn(&RunLeft) -> f64) -> Panel {
    for (slot, name) in names.iter().enumerate() {
        let runs = || diagnoses.runs.iter().filter(|run| run.hull == slot);
        let xs = runs().map(|run| run.yaw_deg).collect();
        panel = panel.layer(Layer::points(xs, runs().map(&value).collect()).label(*name).slot(slot));
    }
    panel
}

/// A hull's runs at the speed at which most were made.
fn at_main_speed(diagnoses: &Diagnoses, hull: usize) -> Vec<&RunLeft> {
    let runs: Vec<&RunLeft> = diagnoses.runs.iter().filter(|run| run.hull == hull).collect();
    let speeds: Vec<f64> = runs.iter().filter_map(|run| run.speed_m_s).collect();
    let main = crate::series::median(&speeds);
    runs.into_iter().filter(|run| run.speed_m_s.is_none_or(|speed| (speed / main - 1.0).abs() < 0.05)).collect()
}

fn causes_table(overall: &Diagnosis) -> Table {
    let mut table = Table::new(
        "Causes, strongest first: size with standard error, probability of such a gain by chance (corrected for the number of mechanisms), error on held-out runs without and with it.",
        ["Cause", "size", "", "probability", "quantity", "without", "with", "cannot be distinguished from"],
    );
    for cause in &overall.causes {
        for (i, (name, size)) in cause.parameters.iter().enumerate() {
            let first = i == 0;
            let text = |value: String| Cell::from(if first { value } else { String::new() });
            let number = |value: f64| if first { Cell::number(value, 3) } else { Cell::from("") };
            table.push([
                text(words(&cause.cause)),
                Cell::from(match channel(name, size) {
                    Some(_) => name.clone(),
                    None => format!("{name} [{}]", size.unit),
                }),
                match channel(name, size) {
                    Some(channel) => Cell::from(channel),
                    None if size.se > 0.0 => Cell::estimate(size.value, size.se),
                    None => Cell::number(size.value, 6),
                },
                number(cause.p_value),
                text(cause.quantity.clone()),
                number(cause.holdout_rms_before),
                number(cause.holdout_rms_after),
                text(cause.indistinguishable_from.join(", ")),
            ]);
        }
    }
    table
}

fn hulls_table(results: &Results, diagnoses: &Diagnoses) -> Table {
    let mut table = Table::new(
        "Hull by hull: coefficients beside the causes, and the error on held-out runs without and with them.",
        ["Hull", "a [1/rad]", "b", "c [1/rad²]", "d [1/rad]", "quantity", "without", "with"],
    );
    for (hull, found) in results.hulls.iter().zip(&diagnoses.hulls) {
        let Some(found) = found else { continue };
        let mut row = vec![Cell::from(hull.hull.id.as_str())];
        match &found.extended {
            Some(extended) => {
                let fit = &extended.fit;
                row.extend([&fit.a, &fit.b, &fit.c, &fit.d].map(|q| Cell::estimate(q.value, q.se)));
            }
            None => row.extend([0; 4].map(|_| Cell::from("-"))),
        }
        let gain = &found.diagnosis.gain;
        row.extend([
            Cell::from(gain.quantity.as_str()),
            Cell::number(gain.holdout_rms_before, 3),
            Cell::number(gain.holdout_rms_after, 3),
        ]);
        table.push(row);
    }
    table
}

fn rejected_table(overall: &Diagnosis) -> Table {
    let mut table = Table::new("Mechanisms that were weighed and not named.", ["Mechanism", "why not"]);
    for rejected in &overall.rejected {
        table.push([Cell::from(words(&rejected.cause)), Cell::from(rejected.remark.as_str())]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_told_by_its_name() {
        let size = |value: f64| Estimate::normal(value, 0.0, "1 AF, 2 SF, 3 YM");
        assert_eq!(shown("channel", &size(3.0)), "channel = YM");
        assert_eq!(shown("day", &size(3.0)), "day = 3");
    }
}
