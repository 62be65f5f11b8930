//! Fits on real logs, beside the package that the field uses and beside NumPy and SciPy on the very same model.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use glidepolar::dynamics::Parameters;
use glidepolar::dynamics::parameters::DRAG_REFERENCE_SPEED_M_S;
use glidepolar::identify::{Dive, Inside, JointFit, Question, by_dive, fit};
use glidepolar::log::{DBAR_PA, Observation};
use serde_json::{Value, json};

use super::Context;
use crate::arguments::Sized;
use crate::contest::{Contender, Samples, contest};
use crate::data::{COMET, Log, SG542};
use crate::peer::{Peer, number};
use crate::report::{Goal, Part, Row, Unit};

/// gliderflight's data, as `cargo xtask fetch-data` lays them down.
const PEER_DATA: &str = "data/gliderflight/gliderflight_data.npy";

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "Identification",
        "A fit uses the means of all steady samples, from several starts, with standard errors. It has a, b and a ballast offset on comet, b, c and the offset on \
         sg542, which has no speed. The whole command reads the log, fits, leaves dives out and fits again, profiles. SciPy gets the means, the same model with its inertia, baseline and weights, from one start, and must find \
         the same values. gliderflight calibrates drag and mass on its own data, the same flight as comet.",
    );
    for log in [COMET, SG542] {
        if let Err(error) = steady(context, &mut part, &log) {
            part.row(Row::new(format!("steady fit, {}", log.name), Unit::Seconds, Err(error)));
        }
    }
    if let Err(error) = beside_gliderflight(context, &mut part) {
        part.row(Row::new("comet, whole command", Unit::Seconds, Err(error)));
    }
    Ok(part)
}

fn steady(context: &Context<'_>, part: &mut Part, log: &Log) -> Result<()> {
    let observations = log.read(context.root())?;
    let dives = by_dive(&observations);
    let question = Question::new(log.baseline(&observations)?, log.free())?;
    let found = fit(&question, &mut dives.clone())?;
    let single = Question { several_starts: false, ..question.clone() };

    let bins = context.work(&format!("{}-bins.json", log.name));
    write_bins(&bins, &question, &dives, &found)?;
    let mut peer = Peer::start(context.python(), context.root(), "least_squares.py", &[&bins]);
    let mut first = None;
    let rounds = context.choice.size(Sized { quick: 0, standard: 7, full: 15 });
    let [ours, one_start, theirs] = contest(
        rounds,
        [
            Contender::timed("glidepolar", 1, || Ok(fit(&question, &mut by_dive(&observations)).map(drop)?)),
            Contender::timed("glidepolar, one start", 1, || Ok(fit(&single, &mut by_dive(&observations)).map(drop)?)),
            Contender::new("SciPy", || {
                let peer = peer.as_mut().map_err(|e| anyhow::anyhow!("{e:#}"))?;
                let answer = peer.ask(&json!({}))?;
                let seconds = number(&answer, "seconds")?;
                first = Some(answer);
                Ok(seconds)
            }),
        ],
    );
    let n: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    part.row(
        Row::new(format!("steady fit, {}, {n} samples", log.name), Unit::Seconds, ours.samples().cloned())
            .against("least_squares, one start, no standard errors", theirs.samples().cloned())
            .goal(Goal::AtMost(0.020)),
    );
    part.row(
        Row::new(format!("steady fit from one start, {}", log.name), Unit::Seconds, one_start.samples().cloned())
            .against("least_squares, one start, no standard errors", theirs.samples().cloned()),
    );
    if let Some(answer) = first {
        part.remark(format!("{}: {}", log.name, agreement(&found, log.free(), &answer)?));
    }
    Ok(())
}

/// Whether the peer found the same: the largest difference, in standard errors of this fit.
fn agreement(found: &JointFit, free: &[&str], answer: &Value) -> Result<String> {
    let theirs: BTreeMap<String, f64> = serde_json::from_value(answer["values"].clone())?;
    let mut worst = 0.0_f64;
    for name in free {
        let position = found.position(name).context("a free parameter")?;
        let value = found.value(found.free[position]);
        worst = worst.max((value - theirs.get(*name).context("a value of the peer")?).abs() / found.se(position));
    }
    let evaluations = number(answer, "evaluations")?;
    let verdict = if worst < 0.3 {
        format!("SciPy finds the same values within {worst:.1e} standard errors")
    } else {
        format!("SciPy ends {worst:.1} standard errors away: the ratio compares unlike fits")
    };
    Ok(format!(
        "{verdict}; it takes {evaluations:.0} steps, each with {} more evaluations for the slopes; the fit here takes {} with exact \
         slopes over all starts, most of them on part of the samples.",
        free.len(),
        found.evaluations
    ))
}

/// What SciPy needs to minimise the very same sum.
fn write_bins(file: &Path, question: &Question, dives: &[Dive], found: &JointFit) -> Result<()> {
    let baseline: &Parameters<f64> = &question.baseline;
    let bins: Vec<(&Observation, Inside, f64)> = dives
        .iter()
        .flat_map(|dive| {
            let inside = dive.inside(&found.parameters);
            let weighed = dive.bins.iter().zip(inside).zip(&dive.bin_root_weights);
            weighed.map(|((bin, inside), root)| (&bin.mean, inside, *root))
        })
        .collect();
    let column = |value: &dyn Fn(&Observation, &Inside) -> f64| -> Vec<Option<f64>> {
        bins.iter().map(|(o, inside, _)| Some(value(o, inside)).filter(|v| v.is_finite())).collect()
    };
    // Without the offset, which is fitted.
    let neutral = Parameters { ballast_offset_kg: 0.0, ..*baseline };
    let net_mass = |o: &Observation| {
        let celsius = if o.temperature_C.is_finite() { o.temperature_C } else { neutral.reference_temperature_C };
        let water = glidepolar::dynamics::Surroundings {
            density_kg_m3: o.density_kg_m3,
            pressure_Pa: neutral.pressure_scale * o.pressure_dbar * DBAR_PA,
            temperature_C: celsius,
            time_s: o.time_s,
        };
        neutral.net_mass_kg(o.ballast_m3, &water)
    };
    let q0 = 0.5 * baseline.reference_density_kg_m3 * DRAG_REFERENCE_SPEED_M_S * DRAG_REFERENCE_SPEED_M_S;
    let free: Vec<&str> = question.free.iter().map(|row| glidepolar::dynamics::PARAMETERS[*row].name).collect();
    let text = json!({
        "flown_pitch": column(&|o, _| o.pitch_rad),
        "pitch": bins.iter().map(|(o, inside, _)| o.pitch_rad + inside.inertia.pitch_rad).collect::<Vec<_>>(),
        "density": column(&|o, _| o.density_kg_m3),
        "net": bins.iter().map(|(o, inside, _)| net_mass(o) + inside.inertia.net_mass_kg).collect::<Vec<_>>(),
        "root_weight": bins.iter().map(|(.., root)| *root).collect::<Vec<_>>(),
        "sink": column(&|o, inside| o.sink_m_s - inside.sink_m_s),
        "speed": column(&|o, inside| o.speed_m_s - inside.speed_m_s),
        "sink_sd": found.weights.sink_m_s,
        "speed_sd": Some(found.weights.speed_m_s).filter(|sd| sd.is_finite()),
        "area": baseline.frontal_area_m2,
        "gravity": baseline.gravity_m_s2,
        "q0": q0,
        "exponent": baseline.drag_exponent,
        "free": free,
        "baseline": {
            "a_per_rad": baseline.a_per_rad,
            "b": baseline.b,
            "c_per_rad2": baseline.c_per_rad2,
            "ballast_offset_kg": baseline.ballast_offset_kg,
        },
    });
    Ok(std::fs::write(file, text.to_string())?)
}

fn beside_gliderflight(context: &Context<'_>, part: &mut Part) -> Result<()> {
    let data = context.root().join(PEER_DATA);
    let peer = if data.is_file() {
        Peer::start(context.python(), context.root(), "gliderflight_calibration.py", &[&data])
    } else {
        Err(anyhow::anyhow!("{PEER_DATA} is not there; fetch it by `cargo xtask fetch-data`"))
    };
    let mut peer = peer.map(|peer| peer.patience(1200));
    let rounds = context.choice.size(Sized { quick: 0, standard: 5, full: 9 });
    let [whole, theirs] = contest(
        rounds,
        [
            Contender::timed("glidepolar", 1, || command(context, &[])),
            Contender::new("gliderflight", || {
                let peer = peer.as_mut().map_err(|e| anyhow::anyhow!("{e:#}"))?;
                let answer = peer.ask(&json!({"model": "steady"}))?;
                ensure!(answer["finished"] == json!(true), "it did not finish");
                number(&answer, "seconds")
            }),
        ],
    );
    part.row(
        Row::new("comet, the whole command", Unit::Seconds, whole.samples().cloned())
            .against("gliderflight, steady, calibration of two parameters alone", theirs.samples().cloned()),
    );
    unsteady(context, part, peer.as_mut().ok());
    Ok(())
}

/// Dives flown through time. The peer's calibration takes minutes: stopped after a while unless all of it was asked for.
fn unsteady(context: &Context<'_>, part: &mut Part, peer: Option<&mut Peer>) {
    let rounds = context.choice.size(Sized { quick: 0, standard: 5, full: 9 });
    let [ours] = contest(rounds, [Contender::timed("glidepolar", 1, || command(context, &["--unsteady"]))]);
    let budget_s = context.choice.size(Sized { quick: 1.0, standard: 60.0, full: 1100.0 });
    let begin = Instant::now();
    let answer = peer.map(|peer| peer.ask(&json!({"model": "dynamic", "budget_s": budget_s})));
    let answer = answer.unwrap_or_else(|| Err(anyhow::anyhow!("gliderflight or its data are missing")));
    let name = match &answer {
        Ok(answer) if answer["finished"] == json!(false) => format!(
            "gliderflight, dynamic, stopped after {} evaluations: at least",
            answer["evaluations"].as_u64().unwrap_or(0)
        ),
        _ => "gliderflight, dynamic".to_owned(),
    };
    let theirs = answer.map(|_| Samples::one(begin.elapsed().as_secs_f64()));
    part.row(
        Row::new("comet, the whole command with --unsteady", Unit::Seconds, ours.samples().cloned())
            .against(name, theirs)
            .goal(Goal::AtMost(1.0)),
    );
}

/// `glidepolar identify` on comet, from the start of the program to its end.
fn command(context: &Context<'_>, further: &[&str]) -> Result<()> {
    let mut command = Command::new(context.command()?);
    command.arg("identify").arg(COMET.path(context.root())?).args(COMET.words()).args(further);
    let output = command.arg("--quiet").output()?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{}", complaint.lines().next().unwrap_or("the command failed without a word"));
    Ok(())
}
