//! An extension without a cause: where something is unexplained and a table of drag, lift or net mass against pressure, time or
//! temperature predicts held-out glides better, the extended vehicle carries that table.
//!
//! The columns of the table are the slopes along a relative drag, a relative lift and a ballast offset, each times the share with
//! which a point of the table enters in a bin. Nine tables are tried; their cost is that they must predict. Knows the problem
//! and the table of the equations of motion.

use nalgebra::{DMatrix, DVector};

use super::SeaProblem;
use crate::diagnose::findings::Empirical;
use crate::diagnose::{Offered, Outcome, Problem, best_unnamed, fitted_again, gains};
use crate::dynamics::empirical::{ActsOn, Against, POINTS, shares};
use crate::dynamics::{Parameters, Surroundings, parameter_index};
use crate::identify::surroundings;

/// Further steps of Gauss and Newton to the values.
const STEPS: usize = 3;

/// What is believed of a value beforehand, a standard deviation: a half of drag and lift; of the net mass what is believed of a
/// ballast offset \[kg\].
const PRIOR_SHARE: f64 = 0.5;
const PRIOR_KG: f64 = 0.2;

/// The problem with the table in its vehicle, where one predicts better; `outcome` is completed by it.
pub fn extend(problem: SeaProblem, outcome: &mut Outcome) -> SeaProblem {
    if outcome.diagnosis.unexplained.is_none() {
        return problem;
    }
    let point = outcome.after.point.clone();
    let evidence = problem.evidence(&point);
    let tables: Vec<(ActsOn, Against, [f64; POINTS])> = Against::ALL
        .into_iter()
        .filter_map(|against| Some((against, points(&problem, against)?)))
        .flat_map(|(against, at)| ActsOn::ALL.map(|acts| (acts, against, at)))
        .collect();
    let sd = |acts: ActsOn| if acts == ActsOn::NetMass { PRIOR_KG } else { PRIOR_SHARE };
    let offered: Vec<Offered> = tables
        .iter()
        .map(|(acts, against, at)| {
            let prior = vec![(0.0, sd(*acts)); POINTS];
            (columns(&problem, &problem.carrier(*acts, &evidence, &point), *against, *at), prior)
        })
        .collect();
    let found = best_unnamed(&problem, &point, &outcome.fitted, &offered, |place, step| {
        step.iter().all(|value| is_possible(tables[place].0, *value))
    });
    let Some(found) = found.filter(|found| found.advantage >= problem.least_advantage()) else { return problem };
    let (acts, against, at) = tables[found.place];
    let mut values: [f64; POINTS] = std::array::from_fn(|i| found.step[i]);
    let [without, mut with] = found.held_out;
    let mut extended = problem;
    put(&mut extended.parameters, acts, against, at, values);
    outcome.after = fitted_again(&extended, &point, &outcome.fitted, with.clone());
    // The speed is no linear function of the drag: the steps of Gauss and Newton go on from the table as it is.
    for _ in 0..STEPS {
        let point = outcome.after.point.clone();
        let evidence = extended.evidence(&point);
        let prior = values.iter().map(|value| (-value, sd(acts))).collect();
        let offered = [(columns(&extended, &extended.carrier(acts, &evidence, &point), against, at), prior)];
        let next = best_unnamed(&extended, &point, &outcome.fitted, &offered, |_, step| {
            values.iter().zip(step.iter()).all(|(value, step)| is_possible(acts, value + step))
        });
        let Some(next) = next else { break };
        // Only as long as it predicts better.
        if next.held_out[1].norm() >= with.norm() {
            break;
        }
        values.iter_mut().zip(next.step.iter()).for_each(|(value, step)| *value += step);
        with = next.held_out[1].clone();
        put(&mut extended.parameters, acts, against, at, values);
        outcome.after = fitted_again(&extended, &point, &outcome.fitted, with.clone());
    }
    let of_quantity = |gain: &crate::diagnose::Gain| gain.quantity == outcome.diagnosis.gain.quantity;
    let by_table = gains(&evidence, &without, &with);
    let best = by_table.iter().max_by(|a, b| a.reduction_percent.total_cmp(&b.reduction_percent));
    outcome.diagnosis.empirical = best.map(|gain| Empirical {
        acts_on: match acts {
            ActsOn::Drag => "drag",
            ActsOn::Lift => "lift",
            ActsOn::NetMass => "net_mass_kg",
        },
        against: match against {
            Against::Pressure => "pressure_dbar",
            Against::Time => "time_h",
            Against::Temperature => "temperature_degC",
        },
        at: at.to_vec(),
        values: values.to_vec(),
        gain: gain.clone(),
    });
    outcome.diagnosis.gains = gains(&evidence, &outcome.before.held_out, &with);
    if let Some(gain) = outcome.diagnosis.gains.iter().find(|gain| of_quantity(gain)) {
        outcome.diagnosis.gain = gain.clone();
    }
    extended
}

/// Whether a table may have this value: neither drag nor lift changes its sign with what a table goes by.
fn is_possible(acts: ActsOn, value: f64) -> bool {
    acts == ActsOn::NetMass || value > -1.0
}

/// The rows of the table of parameters, with their values in this problem; nothing where it has no table.
pub fn rows(parameters: &Parameters<f64>) -> impl Iterator<Item = (&'static str, f64)> {
    let mut parameters = *parameters;
    let has_table = parameters.empirical_acts_on != 0.0;
    crate::dynamics::empirical::PARAMETERS
        .into_iter()
        .filter(move |_| has_table)
        .filter_map(move |name| Some((name, *parameters.at(parameter_index(name)?))))
}

/// Points of equally many bins between them; none where the covariate does not vary.
fn points(problem: &SeaProblem, against: Against) -> Option<[f64; POINTS]> {
    let mut values: Vec<f64> = problem.bins.iter().map(|bin| against.value(&water(problem, bin))).collect();
    if values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    values.sort_by(f64::total_cmp);
    let at: [f64; POINTS] = std::array::from_fn(|i| values[(values.len() - 1) * i / (POINTS - 1)]);
    at.windows(2).all(|pair| pair[1] > pair[0]).then_some(at)
}

fn water(problem: &SeaProblem, bin: &crate::identify::Bin) -> Surroundings<f64> {
    surroundings(&problem.parameters, &bin.mean)
}

/// What a unit of each value of a table changes in every row.
fn columns(problem: &SeaProblem, carrier: &DVector<f64>, against: Against, at: [f64; POINTS]) -> DMatrix<f64> {
    let n_w = problem.bins.len();
    let bin = |row: usize| &problem.bins[if row < n_w { row } else { problem.with_speed[row - n_w] }];
    let mut columns = DMatrix::zeros(carrier.len(), POINTS);
    for row in 0..carrier.len() {
        let shares = shares(at, against.value(&water(problem, bin(row))));
        shares.iter().enumerate().for_each(|(i, share)| columns[(row, i)] = share * carrier[row]);
    }
    columns
}

fn put(parameters: &mut Parameters<f64>, acts: ActsOn, against: Against, at: [f64; POINTS], values: [f64; POINTS]) {
    let codes = [acts.code(), against.code()];
    let all = codes.into_iter().chain(at).chain(values);
    for (name, value) in crate::dynamics::empirical::PARAMETERS.into_iter().zip(all) {
        if let Some(index) = parameter_index(name) {
            *parameters.at(index) = value;
        }
    }
}
