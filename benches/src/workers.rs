//! Jobs for a process of their own: one line of JSON at the end, with the seconds and the most memory they took.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use glidepolar::dynamics::{Actuation, Modes, Parameters, derivative};
use glidepolar::glide::start;
use glidepolar::identify::{Dive, JointFit, Question, by_dive, evaluate, fit};
use glidepolar_tank::{Options, reduce_campaign};
use serde_json::{Value, json};

use crate::arguments::{Job, Work};
use crate::child::{memory, peak_memory};
use crate::data;
use crate::fmi::{FmuGlider, Interface, Standard, TOLERANCE};

/// Does a job.
pub fn run(work: &Work) -> Result<()> {
    let mut answer = match work.job {
        Job::CsvParse => timed(|| csv_parse(on(work, 0)?))?,
        Job::TankReduce => timed(|| tank_reduce(on(work, 0)?))?,
        Job::Fit => fit_samples(on(work, 0)?, work.n)?,
        Job::Instances => instances(on(work, 0)?, on(work, 1)?, work.n)?,
        Job::Rates3 => rates(on(work, 0)?, on(work, 1)?, Standard::Fmi3, work.n)?,
        Job::Rates2 => rates(on(work, 0)?, on(work, 1)?, Standard::Fmi2, work.n)?,
        Job::Steps3 => steps(on(work, 0)?, on(work, 1)?, Standard::Fmi3, work.n)?,
        Job::Steps2 => steps(on(work, 0)?, on(work, 1)?, Standard::Fmi2, work.n)?,
        Job::RightHandSide => right_hand_side(work.n),
    };
    answer["peak_bytes"] = json!(peak_memory());
    println!("{answer}");
    Ok(())
}

fn on(work: &Work, place: usize) -> Result<&Path> {
    work.on.get(place).map(std::path::PathBuf::as_path).context("the job needs a further --on PATH")
}

fn timed(work: impl FnOnce() -> Result<Value>) -> Result<Value> {
    let begin = Instant::now();
    let mut answer = work()?;
    answer["seconds"] = json!(begin.elapsed().as_secs_f64());
    Ok(answer)
}

/// Every column of every run into f64, one record used again and again: what the csv crate's own guide advises. One core.
fn csv_parse(campaign: &Path) -> Result<Value> {
    let mut sum = 0.0;
    for entry in std::fs::read_dir(campaign.join("data"))? {
        let mut reader = csv::Reader::from_path(entry?.path())?;
        let mut record = csv::ByteRecord::new();
        let mut columns: [Vec<f64>; 7] = Default::default();
        while reader.read_byte_record(&mut record)? {
            for (column, cell) in columns.iter_mut().zip(&record) {
                column.push(std::str::from_utf8(cell)?.parse()?);
            }
        }
        sum += columns.iter().filter_map(|column| column.last()).sum::<f64>();
    }
    Ok(json!({ "sum": black_box(sum) }))
}

/// On as many threads as `RAYON_NUM_THREADS` says.
fn tank_reduce(campaign: &Path) -> Result<Value> {
    let results = reduce_campaign(campaign, &Options { range_deg: 10.0, strict: false }, &|_| ())?;
    let hulls = results.hulls.iter().filter_map(|hull| {
        let fit = &hull.fit.as_ref().ok()?.estimates;
        Some((hull.hull.id.clone(), json!({"a": fit.a.value, "b": fit.b.value, "c": fit.c.value, "d": fit.d.value})))
    });
    Ok(json!({ "hulls": hulls.collect::<serde_json::Map<_, _>>() }))
}

/// The joint fit of n samples, comet's again and again; reading does not count.
fn fit_samples(root: &Path, n: usize) -> Result<Value> {
    let observations = data::COMET.read(root)?;
    let question = Question::new(data::COMET.baseline(&observations)?, data::COMET.free())?;
    let mut dives = by_dive(&data::repeated(&observations, n));
    drop(observations);
    let before = memory();
    let begin = Instant::now();
    let found = fit(&question, &mut dives)?;
    let seconds = begin.elapsed().as_secs_f64();
    let mut pass = whole_pass(&found, &mut dives);
    let pass_seconds = (0..5).map(|_| pass()).fold(f64::INFINITY, f64::min);
    Ok(json!({
        "seconds": seconds,
        "pass_seconds": pass_seconds,
        "evaluations": found.evaluations,
        "samples_bytes": before,
    }))
}

/// One pass over all samples with the slopes of all free parameters, as a step of the fit makes it; its seconds.
pub fn whole_pass<'a>(found: &'a JointFit, dives: &'a mut [Dive]) -> impl FnMut() -> f64 + 'a {
    let mut grams = found.grams.clone();
    move || {
        let begin = Instant::now();
        black_box(evaluate(&found.parameters, &found.free, found.weights, dives, &mut grams, 1));
        begin.elapsed().as_secs_f64()
    }
}

/// n instances alive at once.
fn instances(root: &Path, library: &Path, n: usize) -> Result<Value> {
    let glider = FmuGlider::load(root, library, Standard::Fmi3)?;
    drop(glider.fmu.begin(Interface::CoSimulation, TOLERANCE)?);
    let before = memory();
    let mut alive = Vec::with_capacity(n);
    let begin = Instant::now();
    for _ in 0..n {
        alive.push(glider.fmu.begin(Interface::CoSimulation, TOLERANCE)?);
    }
    for instance in &alive {
        instance.do_step(0.0, 1.0)?;
    }
    let seconds = begin.elapsed().as_secs_f64();
    Ok(json!({ "seconds": seconds, "bytes": memory() - before }))
}

fn rates(root: &Path, library: &Path, standard: Standard, n: usize) -> Result<Value> {
    let glider = FmuGlider::load(root, library, standard)?;
    let instance = glider.fmu.begin(Interface::ModelExchange, TOLERANCE)?;
    let (mut states, mut rates) = (vec![0.0; glider.n_states], vec![0.0; glider.n_states]);
    instance.states(&mut states)?;
    for i in 0..n {
        instance.rates(1e-3 * i as f64, black_box(&mut states), &mut rates)?;
        black_box(&rates);
    }
    Ok(json!({}))
}

fn steps(root: &Path, library: &Path, standard: Standard, n: usize) -> Result<Value> {
    let glider = FmuGlider::load(root, library, standard)?;
    let instance = glider.fmu.begin(Interface::CoSimulation, TOLERANCE)?;
    for i in 0..n {
        instance.do_step(i as f64, 1.0)?;
    }
    let [x, depth] = instance.get([glider.x, glider.depth])?;
    ensure!(x.is_finite() && depth.is_finite(), "the glide is lost");
    Ok(json!({}))
}

fn right_hand_side(n: usize) -> Value {
    let parameters = Parameters::default();
    let begin = start(&parameters);
    for i in 0..n {
        let (p, s) = (black_box(&parameters), black_box(&begin.state));
        black_box(derivative(p, Actuation::Servo, Modes::default(), i as f64, s, &begin.inputs));
    }
    json!({})
}
