//! What a call of the FMU costs, beside an FMU in which nothing happens, beside the same glider in Python, and beside the
//! arithmetic alone.

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail, ensure};
use glidepolar::dynamics::{Actuation, Modes, PARAMETERS, Parameters, derivative};
use glidepolar::glide::start;
use glidepolar::vehicle::Vehicle;
use serde_json::json;

use super::{Context, floor};
use crate::arguments::Sized;
use crate::child;
use crate::contest::{Contender, Samples, contest};
use crate::fmi::{Fmu, FmuGlider, Interface, LEG_S, LEGS_PER_DAY, Standard, TOLERANCE};
use crate::peer::{Peer, number};
use crate::report::{Goal, Part, Row, Unit, figures};

const STANDARDS: [(Standard, &str); 2] = [(Standard::Fmi3, "FMI 3"), (Standard::Fmi2, "FMI 2")];

/// Days of the tank paper's voyage.
const VOYAGE_DAYS: f64 = 21.0;

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "The FMU",
        "All calls are made from one Rust program through the library's C functions, the glider's and those of a \
         two-state van der Pol oscillator in C alike. A right-hand side is what a solver asks for in Model Exchange: \
         time, states, derivatives. The voyage is a saw-tooth of 375 s legs, tolerance 1e-6, Co-Simulation.",
    );
    let oscillator = compile_oscillator(context);
    for (standard, name) in STANDARDS {
        let glider = context.glider(standard)?;
        let oscillator = oscillator.as_ref().map_err(|e| anyhow::anyhow!("{e:#}"));
        let oscillator = oscillator.and_then(|library| Fmu::load(library, standard, "any"));
        calls(context, &mut part, name, &glider, oscillator.as_ref().ok())?;
        let (space, space_states) = context.in_space(standard)?;
        space_beside_plane(context, &mut part, name, &glider, (&space, space_states))?;
        if let Err(error) = oscillator {
            part.remark(format!("The van der Pol FMU is missing: {error:#}"));
        }
    }
    right_hand_side(context, &mut part);
    voyages(context, &mut part)?;
    if let Err(error) = beside_python(context, &mut part) {
        part.row(Row::new("a leg of the voyage in FMPy", Unit::Seconds, Err(error)));
    }
    instructions(context, &mut part);
    Ok(part)
}

fn compile_oscillator(context: &Context<'_>) -> Result<PathBuf> {
    let library = context.work("van_der_pol.so");
    let source = context.root().join("benches/peers/van_der_pol.c");
    let mut compiler = Command::new("cc");
    compiler.args(["-O2", "-shared", "-fPIC", "-o"]).arg(&library).arg(source);
    ensure!(compiler.status().context("cc does not run")?.success(), "cc could not compile the van der Pol FMU");
    Ok(library)
}

/// One call, one right-hand side, one instance: beside the oscillator.
fn calls(
    context: &Context<'_>,
    part: &mut Part,
    name: &str,
    glider: &FmuGlider,
    oscillator: Option<&Fmu>,
) -> Result<()> {
    let n = context.choice.size(Sized { quick: 2_000, standard: 50_000, full: 200_000 });
    let rounds = context.choice.rounds();
    let absent = || anyhow::anyhow!("the van der Pol FMU is missing");
    let exchange = glider.fmu.begin(Interface::ModelExchange, TOLERANCE)?;
    let mut states = vec![0.0; glider.n_states];
    exchange.states(&mut states)?;
    let simple = oscillator.map(|fmu| fmu.begin(Interface::ModelExchange, TOLERANCE)).transpose()?;
    let [ours, theirs] = contest(
        rounds,
        [
            Contender::timed("glider", n, || {
                let mut rates = vec![0.0; glider.n_states];
                for i in 0..n {
                    exchange.rates(1e-3 * i as f64, black_box(&mut states), &mut rates)?;
                    black_box(&rates);
                }
                Ok(())
            }),
            Contender::timed("van der Pol", n, || {
                let (mut states, mut rates) = ([2.0, 0.1], [0.0; 2]);
                let simple = simple.as_ref().ok_or_else(absent)?;
                for i in 0..n {
                    simple.rates(1e-3 * i as f64, black_box(&mut states), &mut rates)?;
                    black_box(&rates);
                }
                Ok(())
            }),
        ],
    );
    part.row(
        Row::new(format!("right-hand side, Model Exchange, {name}"), Unit::Seconds, ours.samples().cloned())
            .against("van der Pol FMU in C", theirs.samples().cloned())
            .goal(Goal::AtMost(250e-9)),
    );

    let [ours, theirs] = contest(
        rounds,
        [
            Contender::new("glider", || {
                // A steady glide, as most of a voyage is.
                let instance = glider.fmu.begin(Interface::CoSimulation, TOLERANCE)?;
                let n = n / 50;
                let begin = std::time::Instant::now();
                for i in 0..n {
                    instance.do_step(i as f64, 1.0)?;
                }
                Ok(begin.elapsed().as_secs_f64() / n as f64)
            }),
            Contender::new("van der Pol", || {
                let instance = oscillator.ok_or_else(absent)?.begin(Interface::CoSimulation, TOLERANCE)?;
                let begin = std::time::Instant::now();
                for i in 0..n {
                    instance.do_step(1e-2 * i as f64, 1e-2)?;
                }
                Ok(begin.elapsed().as_secs_f64() / n as f64)
            }),
        ],
    );
    part.row(
        Row::new(format!("doStep of 1 s in a steady glide, {name}"), Unit::Seconds, ours.samples().cloned())
            .against("doStep of one Euler step, van der Pol FMU in C", theirs.samples().cloned()),
    );

    for (interface, kind) in [(Interface::CoSimulation, "CS"), (Interface::ModelExchange, "ME")] {
        let n = n / 100;
        let [ours, theirs] = contest(
            rounds,
            [
                Contender::timed("glider", n, || {
                    (0..n).try_for_each(|_| glider.fmu.begin(interface, TOLERANCE).map(drop))
                }),
                Contender::timed("van der Pol", n, || {
                    let fmu = oscillator.ok_or_else(absent)?;
                    (0..n).try_for_each(|_| fmu.begin(interface, TOLERANCE).map(drop))
                }),
            ],
        );
        part.row(
            Row::new(format!("instantiate, initialise, free, {kind}, {name}"), Unit::Seconds, ours.samples().cloned())
                .against("van der Pol FMU in C", theirs.samples().cloned()),
        );
    }
    Ok(())
}

/// A right-hand side of the glider in space, beside that in the plane.
fn space_beside_plane(
    context: &Context<'_>,
    part: &mut Part,
    name: &str,
    plane: &FmuGlider,
    (space, space_states): (&Fmu, usize),
) -> Result<()> {
    let n = context.choice.size(Sized { quick: 2_000, standard: 50_000, full: 200_000 });
    let instances = [&plane.fmu, space]
        .map(|fmu| fmu.begin(Interface::ModelExchange, TOLERANCE))
        .into_iter()
        .collect::<Result<Vec<_>>>()?;
    let [ours, theirs] = contest(
        context.choice.rounds(),
        [("space", &instances[1], space_states), ("plane", &instances[0], plane.n_states)].map(
            |(what, instance, n_states)| {
                Contender::timed(what, n, move || {
                    let (mut states, mut rates) = (vec![0.0; n_states], vec![0.0; n_states]);
                    instance.states(&mut states)?;
                    for i in 0..n {
                        instance.rates(1e-3 * i as f64, black_box(&mut states), &mut rates)?;
                        black_box(&rates);
                    }
                    Ok(())
                })
            },
        ),
    );
    part.row(
        Row::new(
            format!("right-hand side in six degrees of freedom, Model Exchange, {name}"),
            Unit::Seconds,
            ours.samples().cloned(),
        )
        .against("the same in the plane", theirs.samples().cloned())
        .goal(Goal::Within(3.0)),
    );
    Ok(())
}

/// The equations alone, in plain numbers, beside the arithmetic that they consist of.
fn right_hand_side(context: &Context<'_>, part: &mut Part) {
    let n = context.choice.size(Sized { quick: 2_000, standard: 100_000, full: 400_000 });
    for (what, parameters) in [("plain", Parameters::default()), ("every mechanism at work", floor::every_mechanism())]
    {
        let begin = start(&parameters);
        let counted = floor::count(&parameters);
        let costs = floor::costs();
        let bound = floor::seconds(&counted, &costs);
        let [ours] = contest(
            context.choice.rounds(),
            [Contender::timed("glider", n, || {
                for i in 0..n {
                    let (p, s) = (black_box(&parameters), black_box(&begin.state));
                    black_box(derivative(p, Actuation::Servo, Modes::default(), i as f64, s, &begin.inputs));
                }
                Ok(())
            })],
        );
        part.row(
            Row::new(format!("right-hand side in the library, {what}"), Unit::Seconds, ours.samples().cloned())
                .against("its arithmetic alone, at the core's measured throughput", Ok(bound))
                .goal(Goal::Within(3.0)),
        );
        part.remark(format!("Counted in one right-hand side, {what}: {}.", floor::words(&counted)));
        if what == "plain" {
            for cost in floor::cost_words(&costs) {
                part.remark(format!("Measured throughput of this core: {cost}."));
            }
        }
    }
}

fn voyages(context: &Context<'_>, part: &mut Part) -> Result<()> {
    let days = context.choice.size(Sized { quick: 0.25, standard: VOYAGE_DAYS, full: VOYAGE_DAYS });
    let legs = (days * LEGS_PER_DAY).floor() as usize;
    let rounds = context.choice.size(Sized { quick: 0, standard: 3, full: 7 });
    let (three, two) = (context.glider(Standard::Fmi3)?, context.glider(Standard::Fmi2)?);
    let fly = |glider: &FmuGlider, step_s: f64| -> Result<()> {
        let instance = glider.fmu.begin(Interface::CoSimulation, TOLERANCE)?;
        glider.fly(&instance, legs, step_s)
    };
    let outcomes = contest(
        rounds,
        [
            Contender::timed("FMI 3, one step a leg", 1, || fly(&three, LEG_S)),
            Contender::timed("FMI 2, one step a leg", 1, || fly(&two, LEG_S)),
            Contender::timed("FMI 3, steps of 15 s", 1, || fly(&three, 15.0)),
            Contender::timed("FMI 3, steps of 1 s", 1, || fly(&three, 1.0)),
        ],
    );
    for outcome in &outcomes {
        let samples = outcome.samples().map(|samples| samples.times(VOYAGE_DAYS / days));
        part.row(Row::new(format!("21-day voyage, {}", outcome.name), Unit::Seconds, samples).goal(Goal::AtMost(1.0)));
    }
    if let Ok(samples) = outcomes[0].samples() {
        part.remark(format!(
            "{} simulated days in a second, one step a leg, one core.",
            figures(days / samples.median())
        ));
    }
    Ok(())
}

/// The same legs in FMPy: this FMU, and the glider as a PythonFMU3 slave.
fn beside_python(context: &Context<'_>, part: &mut Part) -> Result<()> {
    let folder = context.work("slave");
    write_parameters(&folder)?;
    let entries =
        [context.fmu(Standard::Fmi3)?, Path::new("slave:RK45"), Path::new("slave:LSODA"), context.fmu(Standard::Fmi2)?];
    let mut arguments: Vec<&Path> = vec![&folder];
    arguments.extend(entries);
    let peer = std::cell::RefCell::new(Peer::start(context.python(), context.root(), "fmpy_flight.py", &arguments)?);
    let ask = |fmu: usize, legs: usize, step_s: f64| {
        peer.borrow_mut()
            .ask(&json!({"fmu": fmu, "legs": legs, "leg_s": LEG_S, "step_s": step_s, "tolerance": TOLERANCE}))
    };
    let seconds = |fmu, legs, step_s| number(&ask(fmu, legs, step_s)?, "seconds");
    let (ours_legs, their_legs) = context.choice.size(Sized { quick: (4, 2), standard: (200, 4), full: (1000, 10) });
    let rounds = context.choice.size(Sized { quick: 0, standard: 5, full: 9 });

    // A ratio of things that are not the same would mean nothing.
    let reference = states(&ask(0, 2, LEG_S)?)?;
    for (slave, method) in [(1, "RK45"), (2, "LSODA")] {
        let answer = ask(slave, 2, LEG_S);
        let apart = answer.and_then(|answer| distance(&reference, &states(&answer)?));
        match apart {
            Ok(apart) if apart < 1e-2 => part.remark(format!(
                "After two legs the slave with {method} is within {apart:.0e} of the FMU, in units of the nominal sizes."
            )),
            Ok(apart) => bail!("the slave with {method} flies another way than the FMU: {apart:.1e} nominal sizes apart"),
            Err(error) => part.remark(format!("The slave with {method} does not fly: {error:#}")),
        }
    }
    for (step_s, steps) in [(LEG_S, "one step a leg"), (15.0, "steps of 15 s"), (1.0, "steps of 1 s")] {
        let [three, rk45, lsoda, two] = contest(
            rounds,
            [
                Contender::new("FMI 3", || seconds(0, ours_legs, step_s)),
                Contender::new("RK45", || seconds(1, their_legs, step_s)),
                Contender::new("LSODA", || seconds(2, their_legs, step_s)),
                Contender::new("FMI 2", || seconds(3, ours_legs, step_s)),
            ],
        );
        part.row(
            Row::new(format!("a leg of the voyage in FMPy, {steps}"), Unit::Seconds, three.samples().cloned())
                .against("PythonFMU3 slave, solve_ivp as it comes (RK45)", rk45.samples().cloned())
                .goal(Goal::Quicker(1000.0)),
        );
        part.row(
            Row::new(format!("a leg of the voyage in FMPy, {steps}"), Unit::Seconds, three.samples().cloned())
                .against("PythonFMU3 slave, SciPy's quickest here (LSODA)", lsoda.samples().cloned()),
        );
        part.row(
            Row::new(format!("a leg of the voyage in FMPy, {steps}"), Unit::Seconds, three.samples().cloned())
                .against("the same FMU as FMI 2", two.samples().cloned()),
        );
    }
    Ok(())
}

/// What the slave starts from: the vehicle that the FMU has, and its start.
fn write_parameters(folder: &Path) -> Result<()> {
    let parameters = Vehicle::load("slocum-graver")?.glide_parameters();
    let begin = start(&parameters);
    let rows = PARAMETERS.iter().zip(parameters.as_array()).map(|(row, value)| (row.name.to_owned(), json!(value)));
    let s = &begin.state;
    let text = json!({
        "parameters": rows.collect::<serde_json::Map<_, _>>(),
        "tolerance": TOLERANCE,
        "start": {
            "x_m": s.x_m, "depth_m": s.depth_m, "pitch_rad": s.pitch_rad, "pitch_rate_rad_s": s.pitch_rate_rad_s,
            "v1_m_s": s.v1_m_s, "v3_m_s": s.v3_m_s, "moving_mass_position_m": s.moving_mass_1_m,
            "moving_mass_position_3_m": s.moving_mass_3_m, "PP1_kg_m_s": s.momentum_1_kg_m_s,
            "PP3_kg_m_s": s.momentum_3_kg_m_s, "ballast_mass_kg": s.ballast_mass_kg, "energy_J": s.energy_J,
            "ballast_command_m3": begin.inputs.ballast_command_m3,
            "moving_mass_command_m": begin.inputs.moving_mass_command_m,
        },
    });
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("parameters.json"), text.to_string())?;
    Ok(())
}

type Flown = (Vec<f64>, Vec<f64>);

/// States and their nominal sizes.
fn states(answer: &serde_json::Value) -> Result<Flown> {
    let list = |key: &str| -> Result<Vec<f64>> {
        let values = answer.get(key).and_then(|v| v.as_array()).with_context(|| format!("no `{key}`"))?;
        Ok(values.iter().filter_map(serde_json::Value::as_f64).collect())
    };
    Ok((list("states")?, list("nominals")?))
}

/// In the states that the slave has: those of water that is carried and of a hull that creeps are the FMU's alone, and rest.
fn distance(reference: &Flown, found: &Flown) -> Result<f64> {
    let n = reference.1.len();
    ensure!(n > 0 && reference.0.len() == n && found.0.len() == n, "not all states were reported");
    let scaled = reference.0.iter().zip(&found.0).zip(&reference.1).map(|((a, b), nominal)| (a - b).abs() / nominal);
    Ok(scaled.fold(0.0, f64::max))
}

/// Counted by callgrind: the same however busy the machine is.
fn instructions(context: &Context<'_>, part: &mut Part) {
    let jobs = [
        ("right-hand side in the library, instructions", "right-hand-side"),
        ("right-hand side, Model Exchange, FMI 3, instructions", "rates3"),
        ("right-hand side, Model Exchange, FMI 2, instructions", "rates2"),
        ("doStep of 1 s in a steady glide, FMI 3, instructions", "steps3"),
        ("doStep of 1 s in a steady glide, FMI 2, instructions", "steps2"),
    ];
    for (what, job) in jobs {
        let counted = context.library().and_then(|library| child::instructions(job, &[context.root(), library]));
        let gone = counted.is_err();
        part.row(Row::new(what, Unit::Instructions, counted.map(Samples::one)));
        if gone {
            return;
        }
    }
}
