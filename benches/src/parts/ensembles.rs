//! Many missions of the FMU: one and two cores, beside ideal scaling and beside FMPy with Dask.

use anyhow::Result;
use rayon::prelude::*;
use serde_json::json;

use super::Context;
use crate::arguments::Sized;
use crate::contest::{Contender, contest};
use crate::fmi::{FmuGlider, Interface, LEG_S, Standard, TOLERANCE};
use crate::peer::Peer;
use crate::report::{Goal, Part, Row, Unit};

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "Ensembles",
        "A mission is an instance of the FMU with a ballast error of its own, initialised, flown for one leg of 375 s at \
         tolerance 1e-6, read and freed. The time is that of one mission: on two cores the ideal is half of it.",
    );
    let glider = context.glider(Standard::Fmi3)?;
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (one, two) = (pool(1)?, pool(2)?);
    let sizes: &[usize] = context.choice.size(Sized {
        quick: &[100],
        standard: &[100, 1_000, 10_000],
        full: &[100, 1_000, 10_000, 100_000],
    });
    for &missions in sizes {
        let rounds =
            if missions >= 100_000 { 2 } else { context.choice.size(Sized { quick: 0, standard: 5, full: 7 }) };
        let fly_all = || (0..missions).into_par_iter().try_for_each(|mission| fly(&glider, mission));
        let [alone, both] = contest(
            rounds,
            [
                Contender::timed("one core", missions, || one.install(fly_all)),
                Contender::timed("two cores", missions, || two.install(fly_all)),
            ],
        );
        part.row(
            Row::new(format!("{missions} missions, two cores"), Unit::Seconds, both.samples().cloned())
                .against("half of one core's", alone.samples().map(|samples| samples.times(0.5)))
                .goal(Goal::Within(1.5)),
        );
    }
    if let Err(error) = beside_dask(context, &mut part, &glider) {
        part.row(Row::new("missions beside FMPy and Dask", Unit::Seconds, Err(error)));
    }
    Ok(part)
}

fn fly(glider: &FmuGlider, mission: usize) -> Result<()> {
    let instance = glider.fmu.instantiate(Interface::CoSimulation)?;
    instance.set([glider.ballast_offset], [1e-3 * (mission % 7) as f64])?;
    instance.begin(TOLERANCE)?;
    instance.do_step(0.0, LEG_S)?;
    std::hint::black_box(instance.get([glider.x, glider.depth])?);
    Ok(())
}

fn beside_dask(context: &Context<'_>, part: &mut Part, glider: &FmuGlider) -> Result<()> {
    let missions = context.choice.size(Sized { quick: 20, standard: 400, full: 2_000 });
    let mut peer = Peer::start(context.python(), context.root(), "fmpy_ensemble.py", &[context.fmu(Standard::Fmi3)?])?;
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let rounds = context.choice.size(Sized { quick: 0, standard: 5, full: 7 });
    let [ours, theirs] = contest(
        rounds,
        [
            Contender::timed("glidepolar", missions, || {
                two.install(|| (0..missions).into_par_iter().try_for_each(|mission| fly(glider, mission)))
            }),
            Contender::new("FMPy and Dask", || {
                let question = json!({"workers": 2, "missions": missions, "stop_s": LEG_S, "tolerance": TOLERANCE});
                peer.seconds(&question)
            }),
        ],
    );
    part.row(
        Row::new(format!("{missions} missions called from Rust, two cores"), Unit::Seconds, ours.samples().cloned())
            .against("the same FMU in FMPy under Dask, two processes", theirs.samples().cloned()),
    );
    Ok(())
}
