//! A diagnosis as a page: for each of the four answers one figure and one sentence.

use super::diagnose_words::{
    checked, is_explained_by_trim, left_over, less, shown_in, shown_shear, size, table_without_cause, unit, verdict,
    words,
};
use crate::diagnose::sea::SeaDiagnosis;
use crate::diagnose::{Checked, Diagnosis};
use crate::report::{Axis, Cell, Figure, Layer, Panel, Report, Section, Table, probability, with_interval};
use crate::turning::causes::ModelledStretch;

/// The page of a log's diagnosis.
pub(super) fn page(vehicle: &str, found: &SeaDiagnosis, trim: &str) -> Report {
    let diagnosis = &found.outcome.diagnosis;
    let subject = format!("{vehicle}, {} stretches of steady glide", found.problem.n_bins());
    let mut report = Report::new("Diagnosis", subject).finding(format!("Baseline: {trim}."));
    if let Some(text) = found.problem.without_speed() {
        report = report.warning(format!("{}.", capital(text)));
    }
    for check in diagnosis.consistency.iter().filter(|check| check.outcome != Checked::Consistent) {
        report = report.warning(format!("{}.", capital(&checked(check))));
    }
    for warning in &diagnosis.warnings {
        report = report.warning(format!("{}.", capital(warning)));
    }
    let sentences = [wrong(diagnosis), cause(diagnosis), extension(diagnosis), gain(diagnosis)];
    for sentence in &sentences {
        report = report.finding(sentence.clone());
    }
    let [wrong, cause, extension, gain] = sentences;
    report
        .section(Section::new("Wrong").text(wrong).figure(misfit(found)))
        .section(named(found, cause))
        .section(Section::new("Extension").text(extension).figure(flown(found)))
        .section(Section::new("Gain").text(gain).figure(gained(diagnosis)).table(gains(diagnosis)))
        .section(Section::new("Rejected").folded().table(rejected(diagnosis)))
        .section(
            Section::new("Consistency of the log")
                .folded()
                .block(crate::report::Block::List(diagnosis.consistency.iter().map(checked).collect())),
        )
}

fn named(found: &SeaDiagnosis, sentence: String) -> Section {
    let diagnosis = &found.outcome.diagnosis;
    let mut section = Section::new("Cause").text(sentence).figure(weighed(diagnosis));
    if !found.turns.is_empty() {
        section = section.figure(turned(&found.turns));
    }
    if diagnosis.causes.is_empty() { section } else { section.table(causes(diagnosis)) }
}

fn wrong(found: &Diagnosis) -> String {
    let Some(worst) = found.wrong.first() else {
        return if found.causes.is_empty() {
            "The baseline misses the data by no more than measurement and moving water explain.".to_owned()
        } else {
            // A constant misfit, as that of a ballast offset: no covariate shows it.
            "The baseline misses the data alike everywhere: the misfit depends on no covariate.".to_owned()
        };
    };
    let mut others: Vec<&str> = Vec::new();
    let mut of_turning = String::new();
    for wrong in &found.wrong[1..] {
        let (factor, unit) = shown_in(&wrong.quantity);
        if unit != shown_in(&worst.quantity).1 {
            let (quantity, size) = (words(&wrong.quantity), wrong.size * factor);
            of_turning += &format!(" The {quantity} depends on {} by {size:.2} {unit} rms.", wrong.regime);
        } else if wrong.regime != worst.regime && !others.contains(&wrong.regime.as_str()) {
            // Two quantities may go with one regime: it is said once.
            others.push(&wrong.regime);
        }
    }
    let others = if others.is_empty() { String::new() } else { format!(", and on {}", others.join(", ")) };
    let by_trim =
        if is_explained_by_trim(found) { " The trim explains it, which a neutral baseline does not know." } else { "" };
    let (factor, unit) = shown_in(&worst.quantity);
    format!(
        "The baseline misses the {} by {:.1} {unit} rms where measurement and moving water explain {:.1} {unit}; the misfit depends on {} ({}){others}.{of_turning}{by_trim}",
        words(&worst.quantity),
        worst.rms * factor,
        worst.expected_rms * factor,
        worst.regime,
        probability(worst.p_value)
    )
}

fn cause(found: &Diagnosis) -> String {
    let mut sentences: Vec<String> = found
        .causes
        .iter()
        .map(|cause| {
            let sizes: Vec<String> = cause
                .parameters
                .iter()
                .map(|(name, e)| {
                    let [low, high] = e.ci95;
                    // The only parameter needs no name beside that of its cause.
                    let name = if cause.parameters.len() == 1 { String::new() } else { format!("{} = ", words(name)) };
                    format!("{name}{}{}", with_interval(e.value, low, high), unit(e))
                })
                .collect();
            let sizes =
                if sizes.is_empty() { "known exactly from the log's own columns".to_owned() } else { sizes.join(", ") };
            let alike: Vec<String> = cause.indistinguishable_from.iter().map(|name| words(name)).collect();
            let alike = if alike.is_empty() {
                String::new()
            } else {
                format!("; these data cannot separate it from {}", alike.join(" or "))
            };
            format!("{}: {sizes}{alike}.", capital(&words(&cause.cause)))
        })
        .collect();
    if found.causes.iter().any(|cause| !cause.parameters.is_empty()) {
        sentences.push("In brackets: 95 % intervals.".to_owned());
    }
    for set in &found.alternatives {
        let sizes: Vec<String> =
            set.iter().flat_map(|other| &other.parameters).map(|(name, e)| size(name, e)).collect();
        let sizes = sizes.join(" with ");
        sentences.push(match set.as_slice() {
            [_] => format!("In its place there may be {sizes}."),
            _ => format!("In the place of all these there may be {sizes}."),
        });
    }
    if let Some(left) = &found.unexplained {
        sentences.push(format!(
            "What is left depends on {}, and no known mechanism explains it.",
            left.depends_on.join(", ")
        ));
    }
    if let Some(table) = &found.empirical {
        let table = table_without_cause(table);
        sentences.push(format!("The extension carries it as an {table}."));
    }
    if let Some(trim) = &found.trim {
        sentences.push(format!("Trim against the neutral baseline: {}.", size("ballast_offset_kg", trim)));
    }
    for left in &found.left {
        sentences.push(format!("Left: {}.", left_over(left)));
    }
    if let Some(share) = &found.shear_share {
        sentences.push(format!("{}.", capital(&shown_shear(share))));
    }
    if found.causes.is_empty() && found.unexplained.is_none() {
        sentences.insert(0, "No mechanism is called for.".to_owned());
    }
    format!("Verdict: {}. {}", verdict(found.verdict), sentences.join(" "))
}

fn extension(found: &Diagnosis) -> String {
    let what = if found.causes.is_empty() {
        "The extension is the baseline with its fitted polar"
    } else {
        "The extension is the baseline with its fitted polar and the mechanisms above"
    };
    match &found.extended {
        Some(path) => format!("{what}, written to {path}; the FMU flies it as it is."),
        None => format!("{what}; the option --extended writes it as a vehicle that the FMU flies."),
    }
}

fn gain(found: &Diagnosis) -> String {
    let gains: Vec<String> = found
        .gains
        .iter()
        .map(|gain| {
            let (factor, unit) = shown_in(&gain.quantity);
            format!(
                "of the {} from {:.2} to {:.2} {unit}, {} (95 %: {:.0} to {:.0} % less)",
                words(&gain.quantity),
                gain.holdout_rms_before * factor,
                gain.holdout_rms_after * factor,
                less(gain.reduction_percent),
                gain.ci95[0],
                gain.ci95[1]
            )
        })
        .collect();
    format!("On whole glides that the fit did not see the rms error goes: {}.", gains.join("; "))
}

/// What the residuals are of, for captions: spelt out, the names of the axes would run into each other.
const QUANTITIES: &str = "w: vertical velocity, v: speed through the water";

fn residual(quantity: &str) -> Axis {
    let symbol = if quantity == "vertical_velocity" { "Δw" } else { "Δv" };
    Axis::new("residual", symbol, "mm/s")
}

/// The baseline's residuals along the covariate with which they go most clearly, and what the extension leaves of them.
fn misfit(found: &SeaDiagnosis) -> Figure {
    let evidence = &found.evidence;
    let worst = found.outcome.diagnosis.wrong.first().map_or("depth", |wrong| wrong.regime.as_str());
    let covariates = &evidence.covariates;
    let covariate = covariates.iter().find(|c| c.name == worst).or_else(|| covariates.first());
    let (name, values) = covariate.map_or(("time", &evidence.time_s), |c| (c.name, &c.values));
    let mut figure = Figure::new("wrong", axis(name));
    for quantity in &evidence.quantities {
        let mut panel = Panel::new(residual(quantity.name)).layer(Layer::at_y(0.0));
        for (leg, label) in [(1.0, "descents, baseline"), (-1.0, "ascents, baseline")] {
            let rows: Vec<usize> = quantity.rows.clone().filter(|row| evidence.leg[*row] == leg).collect();
            let xs = rows.iter().map(|row| shown(name, values[*row])).collect();
            let ys = rows.iter().map(|row| found.outcome.before.residual[*row] * 1e3).collect();
            panel = panel.layer(Layer::points(xs, ys).label(label));
        }
        figure = figure.panel(panel);
    }
    figure.caption(format!(
        "Measured less modelled ({QUANTITIES}), the baseline fitted to all glides, against {name}. A point is about a minute of steady glide."
    ))
}

/// Places on the scale of evidence that have a number.
const EVIDENCE: [f64; 8] = [0.0, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];

/// Mechanisms in the figure at most; the table has all that were rejected.
const MOST_WEIGHED: usize = 12;

/// Where some evidence stands: on a logarithmic scale from 0 on, so that the second best is seen beside the best.
fn place(evidence: f64) -> f64 {
    evidence.max(0.0).ln_1p()
}

/// How much each mechanism explains.
fn weighed(found: &Diagnosis) -> Figure {
    let evidence = |p: f64| -p.max(1e-300).log10();
    let mut rows: Vec<(String, f64)> = found
        .causes
        .iter()
        .map(|cause| (format!("{} (named)", words(&cause.cause)), evidence(cause.p_value)))
        .collect();
    rows.extend(found.rejected.iter().filter_map(|r| Some((words(&r.cause), evidence(r.p_value?)))));
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    rows.truncate(MOST_WEIGHED.max(found.causes.len()));
    let names: Vec<String> = rows.iter().map(|row| row.0.clone()).collect();
    let (places, lines): (Vec<f64>, Vec<f64>) =
        rows.iter().zip(0..).map(|(row, i)| (place(row.1), f64::from(i))).unzip();
    let most = rows.first().map_or(1.0, |row| row.1.max(1.0));
    let x = Axis {
        names: EVIDENCE.iter().filter(|e| **e <= 1.5 * most).map(|e| (place(*e), format!("{e}"))).collect(),
        ..Axis::new("Evidence, -log10 of the probability by chance", "", "").range(-0.1, place(1.3 * most))
    };
    let bars = lines.iter().zip(&places).map(|(line, place)| Layer::line(vec![0.0, *place], vec![*line; 2]).slot(0));
    let panel =
        Panel::new(Axis::of_names("", names)).layers(bars).layer(Layer::points(places.clone(), lines.clone()).slot(0));
    Figure::new("cause", x).panel(panel).caption(
        "What each mechanism explains, the strongest first, on a logarithmic scale from 0 on: the named ones beside the others that are named, \
         the others beside all that are.",
    )
}

/// Turn rate against roll of every steady stretch, beside the model without and with the named causes of turning.
fn turned(stretches: &[ModelledStretch]) -> Figure {
    // Both panels have the same axes, whichever stretches a panel's model moves.
    let around = |place: usize| {
        let values =
            stretches.iter().flat_map(|s| [s.measured, s.before, s.after]).map(|pair| pair[place].to_degrees());
        let (low, high) = values.fold((0.0, 0.0), |(low, high), value| (f64::min(low, value), f64::max(high, value)));
        let margin = 0.05 * (high - low);
        (low - margin, high + margin)
    };
    let [(left, right), (low, high)] = [0, 1].map(around);
    let y = Axis::new("Turn rate", "r", "deg/s").range(low, high);
    let panel = |title: &str, model: fn(&ModelledStretch) -> [f64; 2]| {
        let mut panel = Panel::new(y.clone()).title(title).layer(Layer::at_y(0.0)).layer(Layer::at_x(0.0));
        let measured: fn(&ModelledStretch) -> [f64; 2] = |s| s.measured;
        for (slot, label, descends, of) in [
            (0, "descents, measured", true, measured),
            (1, "ascents, measured", false, measured),
            (2, "descents, modelled", true, model),
            (3, "ascents, modelled", false, model),
        ] {
            let of_leg = stretches.iter().filter(|s| s.descends == descends);
            let (rolls, rates) = of_leg.map(|s| of(s).map(f64::to_degrees)).map(|[roll, rate]| (roll, rate)).unzip();
            panel = panel.layer(Layer::points(rolls, rates).label(label).slot(slot));
        }
        panel
    };
    Figure::new("turning", Axis::new("Roll, to starboard", "φ", "deg").range(left, right))
        .panel(panel("Without the causes of turning", |s| s.before))
        .panel(panel("With the causes of turning", |s| s.after))
        .caption(
            "Turn rate against roll. A point is a steady stretch between moves of the controls; the model is fitted twice, without and with \
             the named causes.",
        )
}

/// Residuals before and after in the order of time.
fn flown(found: &SeaDiagnosis) -> Figure {
    let evidence = &found.evidence;
    let mut figure = Figure::new("extension", Axis::new("Time", "t", "h"));
    for quantity in &evidence.quantities {
        let hours: Vec<f64> = quantity.rows.clone().map(|row| evidence.time_s[row] / 3600.0).collect();
        let of = |residual: &nalgebra::DVector<f64>| quantity.rows.clone().map(|row| residual[row] * 1e3).collect();
        figure = figure.panel(
            Panel::new(residual(quantity.name))
                .layer(Layer::at_y(0.0))
                .layer(Layer::points(hours.clone(), of(&found.outcome.before.held_out)).label("baseline"))
                .layer(Layer::points(hours.clone(), of(&found.outcome.after.held_out)).label("extension")),
        );
    }
    figure.caption(format!(
        "Measured less predicted ({QUANTITIES}), each glide predicted by a fit to the others, against time."
    ))
}

fn gained(found: &Diagnosis) -> Figure {
    let names: Vec<String> = found.gains.iter().map(|gain| words(&gain.quantity)).collect();
    let at: Vec<f64> = (0..names.len()).map(|i| i as f64).collect();
    let layer = Layer::points(found.gains.iter().map(|gain| gain.reduction_percent).collect(), at)
        .x_interval(found.gains.iter().map(|gain| (gain.ci95[0], gain.ci95[1])).collect());
    Figure::new("gain", Axis::new("Fall of the rms error on held-out glides", "", "%"))
        .panel(Panel::new(Axis::of_names("", names)).layer(Layer::at_x(0.0)).layer(layer))
        .caption("Bars are 95 % intervals by resampling whole glides.")
}

fn causes(found: &Diagnosis) -> Table {
    let columns = ["Cause", "Parameter", "Value", "95 % interval", "Unit", "Cannot be distinguished from"];
    let mut table = Table::new("What is named, strongest first.", columns);
    for cause in &found.causes {
        let alike: Vec<String> = cause.indistinguishable_from.iter().map(|name| words(name)).collect();
        for (name, e) in &cause.parameters {
            table = table.row([
                Cell::Text(words(&cause.cause)),
                Cell::Text(name.clone()),
                Cell::number(e.value, 4),
                Cell::Interval { low: e.ci95[0], high: e.ci95[1] },
                Cell::Text(e.unit.clone()),
                Cell::Text(alike.join(", ")),
            ]);
        }
    }
    table
}

fn gains(found: &Diagnosis) -> Table {
    let mut table =
        Table::new("Root mean square on held-out glides.", ["Quantity", "Unit", "Before", "After", "Less [%]"]);
    for gain in &found.gains {
        let (factor, unit) = shown_in(&gain.quantity);
        table = table.row([
            Cell::Text(words(&gain.quantity)),
            Cell::Text(unit.to_owned()),
            Cell::number(gain.holdout_rms_before * factor, 3),
            Cell::number(gain.holdout_rms_after * factor, 3),
            Cell::WithInterval { value: gain.reduction_percent, low: gain.ci95[0], high: gain.ci95[1] },
        ]);
    }
    table
}

fn rejected(found: &Diagnosis) -> Table {
    let mut table = Table::new("What was weighed and not named.", ["Mechanism", "Why"]);
    for one in &found.rejected {
        table = table.row([Cell::Text(words(&one.cause)), Cell::Text(one.remark.clone())]);
    }
    table
}

/// A covariate as an axis, in the unit in which it is shown.
fn axis(name: &str) -> Axis {
    match name {
        "depth" => Axis::new("Pressure", "p", "dbar"),
        "time" => Axis::new("Time", "t", "h"),
        "pitch" => Axis::new("Pitch angle, either way", "|θ|", "deg"),
        "ballast" => Axis::new("Ballast volume", "V_b", "cc"),
        "temperature" => Axis::new("Temperature", "T", "°C"),
        "tide" => Axis::new("Phase of the tide", "", "deg"),
        other => Axis::new(capital(other), "", "deg"),
    }
}

fn shown(name: &str, value: f64) -> f64 {
    match name {
        "depth" | "temperature" => value,
        "time" => value / 3600.0,
        "ballast" => value * 1e6,
        "tide" => value.rem_euclid(std::f64::consts::TAU).to_degrees(),
        _ => value.to_degrees(),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}
