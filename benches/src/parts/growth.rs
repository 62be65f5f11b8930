//! Time and memory against samples, mechanisms, runs and instances.

use anyhow::Result;
use glidepolar::identify::{Gram, Question, by_dive, fit};

use super::{Context, tank};
use crate::arguments::Sized;
use crate::child::{time_and_memory, work};
use crate::contest::Samples;
use crate::data::COMET;
use crate::figure::{Curve, growth};
use crate::peer::number;
use crate::report::{Part, Row, Unit, figures, quantity};
use crate::workers::whole_pass;

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "Growth",
        "Time and memory against size; the slope is that of the logarithms over the larger half of the sizes, 1 where \
         twice as much costs twice as much.",
    );
    type Study = fn(&Context<'_>, &mut Part) -> Result<()>;
    let studies: [(&str, Study); 4] =
        [("samples", samples), ("mechanisms", mechanisms), ("runs", runs), ("instances", instances)];
    for (name, study) in studies {
        if let Err(error) = study(context, &mut part) {
            part.row(Row::new(format!("slope against {name}"), Unit::Count, Err(error)));
        }
    }
    Ok(part)
}

/// A joint fit of comet's samples, again and again.
fn samples(context: &Context<'_>, part: &mut Part) -> Result<()> {
    let sizes: &[usize] = context.choice.size(Sized {
        quick: &[1_000, 4_000],
        standard: &[3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000],
        full: &[3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000],
    });
    let mut points = (Vec::new(), Vec::new());
    let (mut passes, mut evaluations) = (Vec::new(), Vec::new());
    for &n in sizes {
        let (mut seconds, mut bytes, mut pass) = (Samples::default(), Samples::default(), Samples::default());
        for _ in 0..context.choice.size(Sized { quick: 1, standard: 3, full: 3 }) {
            let answer = work("fit", n, &[context.root()])?;
            let (s, b) = time_and_memory(&answer)?;
            seconds.push(s);
            bytes.push(b);
            pass.push(number(&answer, "pass_seconds")?);
            evaluations.push((n, number(&answer, "evaluations")?));
        }
        points.0.push((n as f64, seconds.median()));
        points.1.push((n as f64, bytes.median() / 1e6));
        passes.push((n as f64, pass.median()));
    }
    let passes = Curve { label: "one pass with slopes".to_owned(), points: passes };
    let slope =
        Row::new("slope of the time of one pass against samples", Unit::Count, Ok(Samples::one(passes.slope())));
    part.row(slope);
    let in_passes: Vec<f64> = points.0.iter().zip(&passes.points).map(|((_, fit), (_, pass))| fit / pass).collect();
    report(part, "samples", "joint fit of three parameters, two cores", "Steady samples", points, vec![passes]);
    evaluations.dedup();
    let listed: Vec<String> = sizes
        .iter()
        .zip(&in_passes)
        .map(|(n, passes)| {
            let count = evaluations.iter().find(|(of, _)| of == n).map_or(f64::NAN, |(_, count)| *count);
            format!("{n} samples {} passes in {count:.0} evaluations", figures(*passes))
        })
        .collect();
    for size in listed {
        part.remark(format!(
            "Time of a fit in passes over all its samples (most evaluations use some of them): {size}."
        ));
    }
    Ok(())
}

/// More and more of the model's parameters free.
fn mechanisms(context: &Context<'_>, part: &mut Part) -> Result<()> {
    const ORDER: [&str; 8] = [
        "b",
        "ballast_offset_kg",
        "c_per_rad2",
        "a_per_rad",
        "drag_exponent",
        "climb_dive_drag_ratio",
        "hull_compressibility_per_Pa",
        "pitch_offset_rad",
    ];
    let observations = COMET.read(context.root())?;
    let mut dives = by_dive(&observations);
    let whole = fit(&Question::new(COMET.baseline(&observations)?, &ORDER)?, &mut dives)?;
    let mut points = Vec::new();
    for n in 1..=ORDER.len() {
        // All at one and the same place: how hard the glides are to solve is the place's, not the number's.
        let mut found = whole.clone();
        found.free.truncate(n);
        found.grams = vec![Gram::new(n); dives.len()];
        let mut pass = whole_pass(&found, &mut dives);
        let mut seconds = Samples::default();
        for _ in 0..context.choice.size(Sized { quick: 3, standard: 25, full: 101 }) {
            seconds.push(pass());
        }
        points.push((n as f64, seconds.median()));
    }
    let listed: Vec<String> = points.iter().map(|(n, s)| format!("{n} {}", quantity(Unit::Seconds, *s))).collect();
    part.remark(format!("One pass over {} samples by free parameters: {}.", observations.len(), listed.join(", ")));
    let curve = Curve { label: "one pass with slopes".to_owned(), points };
    part.row(Row::new("slope of time against free parameters", Unit::Count, Ok(Samples::one(curve.slope()))));
    let panels = vec![("Time", "s", vec![curve])];
    part.figures.push(growth(
        "growth-mechanisms",
        "Free parameters",
        panels,
        "One pass over comet's samples with exact slopes, by the number of free parameters.",
    ));
    Ok(())
}

/// Campaigns of more and more runs.
fn runs(context: &Context<'_>, part: &mut Part) -> Result<()> {
    let sizes: &[f64] = context.choice.size(Sized {
        quick: &[3.0, 6.0],
        standard: &[10.0, 30.0, 100.0, 300.0],
        full: &[10.0, 30.0, 100.0, 300.0, 1000.0],
    });
    let mut points = (Vec::new(), Vec::new());
    for &megabytes in sizes {
        let folder = tank::campaign(context, megabytes)?;
        let runs = folder.path().join("pmm_runs");
        let (seconds, bytes) = time_and_memory(&work("tank-reduce", 1, &[&runs])?)?;
        points.0.push((megabytes, seconds));
        points.1.push((megabytes, bytes / 1e6));
    }
    report(part, "runs", "reduction of a campaign, two cores", "Size of the campaign [MB]", points, vec![]);
    Ok(())
}

/// More and more instances of the FMU alive at once.
fn instances(context: &Context<'_>, part: &mut Part) -> Result<()> {
    let sizes: &[usize] = context.choice.size(Sized {
        quick: &[100, 1_000],
        standard: &[100, 300, 1_000, 3_000, 10_000, 30_000],
        full: &[100, 300, 1_000, 3_000, 10_000, 30_000, 100_000],
    });
    let mut points = (Vec::new(), Vec::new());
    for &n in sizes {
        let answer = work("instances", n, &[context.root(), context.library()?])?;
        points.0.push((n as f64, number(&answer, "seconds")?));
        points.1.push((n as f64, number(&answer, "bytes")? / 1e6));
    }
    if let Some((n, megabytes)) = points.1.last() {
        part.row(Row::new("memory of an FMU instance", Unit::Bytes, Ok(Samples::one(megabytes * 1e6 / n))));
    }
    report(part, "instances", "instantiate, initialise, one step of 1 s", "Instances alive at once", points, vec![]);
    Ok(())
}

type Points = Vec<(f64, f64)>;

/// Two slopes and one figure, with `more` curves of time.
fn report(part: &mut Part, name: &str, label: &str, axis: &str, (time, memory): (Points, Points), more: Vec<Curve>) {
    let curve = |points| Curve { label: label.to_owned(), points };
    let (time, memory) = (curve(time), curve(memory));
    for (what, curve) in [("time", &time), ("memory", &memory)] {
        part.row(Row::new(format!("slope of {what} against {name}"), Unit::Count, Ok(Samples::one(curve.slope()))));
    }
    let caption = format!("Time and peak memory: {label}.");
    let times = std::iter::once(time).chain(more).collect();
    let panels = vec![("Time", "s", times), ("Memory", "MB", vec![memory])];
    part.figures.push(growth(&format!("growth-{name}"), axis, panels, &caption));
}
