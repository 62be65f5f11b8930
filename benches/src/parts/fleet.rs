//! A hundred different gliders, a saw-tooth each, for a year: what the library needs for it on two cores.

use anyhow::{Result, ensure};
use glidepolar::dynamics::{Actuation, Glider, Integrator, Parameters};
use glidepolar::glide::start;
use rayon::prelude::*;

use super::Context;
use crate::arguments::Sized;
use crate::contest::{Contender, contest};
use crate::fmi::{LEG_S, LEGS_PER_DAY, TOLERANCE};
use crate::report::{Goal, Part, Row, Unit, figures};

const GLIDERS: usize = 100;
const YEAR_DAYS: f64 = 365.0;

/// Seconds that a fleet-year may take.
const GOAL_S: f64 = 60.0;

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "A fleet-year",
        "100 gliders that differ in drag, lift, mass and trim fly a saw-tooth of 375 s legs for 365 days at tolerance 1e-6, \
         in the library itself.",
    );
    let days = context.choice.size(Sized { quick: 0.02, standard: 1.0, full: YEAR_DAYS });
    let rounds = context.choice.size(Sized { quick: 0, standard: 3, full: 1 });
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let fleet: Vec<Parameters<f64>> = (0..GLIDERS).map(glider).collect();
    let legs = (days * LEGS_PER_DAY).round().max(2.0) as usize;
    let fly = |legs: usize| two.install(|| fleet.par_iter().try_for_each(|parameters| voyage(parameters, legs)));
    let [whole, half] = contest(
        rounds,
        [Contender::timed("fleet", 1, || fly(legs)), Contender::timed("half the time", 1, || fly(legs / 2))],
    );
    let year = YEAR_DAYS * LEGS_PER_DAY / legs as f64;
    let what =
        if context.choice.full { "a fleet-year".to_owned() } else { format!("a fleet-year, from {days} days of it") };
    part.row(
        Row::new(what, Unit::Seconds, whole.samples().map(|s| s.times(year)))
            .against(
                "the same from half as many days",
                half.samples().map(|s| s.times(year * legs as f64 / (legs / 2) as f64)),
            )
            .goal(Goal::AtMost(GOAL_S)),
    );
    if let Ok(samples) = whole.samples() {
        let seconds = samples.median() * year;
        let a_leg = 2.0 * samples.median() / (legs * GLIDERS) as f64;
        part.remark(format!(
            "{} of the goal; a leg takes {} µs of one core, and may take {}.",
            if seconds > GOAL_S {
                format!("{} times the time", figures(seconds / GOAL_S))
            } else {
                "Within".to_owned()
            },
            figures(a_leg * 1e6),
            figures(1e6 * GOAL_S * 2.0 / (GLIDERS as f64 * YEAR_DAYS * LEGS_PER_DAY)),
        ));
    }
    Ok(part)
}

/// The glider with this number: each another one.
fn glider(number: usize) -> Parameters<f64> {
    // Golden ratio steps: spread evenly, never the same twice.
    let spread = |k: f64| 2.0 * (number as f64 * 0.618_033_988_749_895 * k).fract() - 1.0;
    let p = Parameters::default();
    Parameters {
        a_per_rad: p.a_per_rad * (1.0 + 0.1 * spread(1.0)),
        b: p.b * (1.0 + 0.15 * spread(2.0)),
        c_per_rad2: p.c_per_rad2 * (1.0 + 0.1 * spread(3.0)),
        added_mass_3_kg: p.added_mass_3_kg * (1.0 + 0.1 * spread(5.0)),
        pitch_inertia_kg_m2: p.pitch_inertia_kg_m2 * (1.0 + 0.1 * spread(7.0)),
        hull_compressibility_per_Pa: 4e-10 * (1.0 + 0.2 * spread(11.0)),
        ..p
    }
}

fn voyage(parameters: &Parameters<f64>, legs: usize) -> Result<()> {
    let begin = start(parameters);
    let mut glider = Glider::new(*parameters, Actuation::Servo, begin.inputs);
    let (mut time, mut state, mut integrator) = (0.0, begin.state, Integrator::new(TOLERANCE));
    for leg in 1..=legs {
        glider.fly(&mut integrator, &mut time, &mut state, leg as f64 * LEG_S, |_, _, _| true)?;
        glider.inputs.ballast_command_m3 *= -1.0;
        glider.inputs.moving_mass_command_m *= -1.0;
    }
    // The slowest of the hundred, heavy and of high drag, makes some 0.15 m/s.
    ensure!(state.x_m > 0.1 * time, "a glider that stands still is no voyage: {} m in {time} s", state.x_m);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_gliders_differ_and_all_fly() {
        let fleet: Vec<_> = (0..GLIDERS).map(glider).collect();
        for (i, one) in fleet.iter().enumerate() {
            assert!(fleet[..i].iter().all(|other| other != one), "glider {i} twice");
            voyage(one, 4).unwrap();
        }
    }
}
