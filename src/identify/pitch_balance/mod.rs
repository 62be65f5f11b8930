//! The balance of pitching moments: d, the height of the centre of gravity and the arm of the ballast, from battery
//! position, ballast volume and pitch (the tank paper's future work).
//!
//! In a steady glide the moving mass must stand where the steady glide of that pitch and net mass puts it
//! ([`at_pitch`](crate::glide::at_pitch)'s `moving_mass_m`). Read backwards, battery and ballast say the pitch:
//! ```text
//! g (m_p r + m_b x_b + m_h x_h) cos pitch + g S3 sin pitch = q A LOA d alpha,      q, alpha of the glide at that pitch
//! ```
//! Fitted are `d`, `S3` (as the height of the hull's mass below the centre of buoyancy), `x_b` (how far forward of it the
//! ballast sits) and `x_h` (where the zero of the battery's reading is). All of them scale with the moving mass `m_p`:
//! it must be known. The polar is held as it was identified. `CM0` is held: it differs from `x_h` only by the change of
//! dynamic pressure.

mod failure;
mod first_guess;
mod not_identifiable;
mod samples;

use std::collections::BTreeMap;

use serde::Serialize;

use super::blocks::Blocks;
use super::consider_parameters::propagate;
use super::considered::Considered;
use super::data::Dive;
use super::evaluate::{Scatter, Weights};
use super::external_values::{Pin, from_outside};
use super::identifiability::subsampled;
use super::joint::{IdentifyError, JointFit, Question, refine};
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use crate::log::Observation;
use crate::vehicle::Vehicle;
use first_guess::{first_guess, start_for};
use glidepolar_inference::covariance::condition_number;
use glidepolar_inference::gram::Gram;
use not_identifiable::not_identifiable;
use samples::PitchSamples;

pub use samples::predicted_pitch_rad;

/// What is fitted, in this order: what the data cannot identify is held from the end.
pub const ROWS: [&str; 4] = ["offset_mass_forward_m", "offset_mass_below_m", "d_per_rad", "ballast_forward_m"];

/// Most samples that are used; pitch says the same for many seconds.
const MOST_SAMPLES: usize = 4000;

/// Least number of samples.
const LEAST_SAMPLES: usize = 8;

/// The balance as fitted.
#[derive(Debug, Clone)]
pub struct PitchBalance {
    /// The fit; its parameters hold the polar, too.
    pub fit: JointFit,
    /// Pitch, measured less predicted, root mean square \[rad\].
    pub pitch_rms_rad: f64,
    /// The same with d = 0, the rest fitted again; nothing where no pitch balances then \[rad\].
    pub pitch_rms_without_d_rad: Option<f64>,
    /// The same on dives that the fit did not see \[rad\].
    pub pitch_rms_holdout_rad: Option<f64>,
    /// Samples.
    pub n: usize,
    /// What was held, by the name of its row.
    pub pinned: BTreeMap<String, Pin>,
    /// Mass of the whole vehicle \[kg\].
    pub mass_kg: f64,
    /// Whether the fitted values are the glider's own: they are not where the arm of the ballast had to be held at a
    /// value that nobody measured.
    pub is_identified: bool,
    /// Why the fit says nothing of the glider at all; nothing where it does.
    pub failure: Option<String>,
}

/// What the report says of it besides the parameters.
#[derive(Debug, Clone, Serialize)]
pub struct PitchBalanceSummary {
    /// Pitch, measured less predicted, root mean square \[rad\].
    pub pitch_rms_rad: f64,
    /// With d = 0 \[rad\].
    pub pitch_rms_without_d_rad: Option<f64>,
    /// On dives that the fit did not see \[rad\].
    pub pitch_rms_holdout_rad: Option<f64>,
    /// Height of the centre of gravity below the centre of buoyancy, battery included \[m\].
    pub cg_below_cb_m: f64,
    /// Its standard error \[m\].
    pub cg_below_cb_se_m: f64,
    /// The moving mass on which all of this rests \[kg\].
    pub moving_mass_kg: f64,
    /// Condition number.
    pub condition_number: f64,
}

/// Fits the balance of moments on the steady samples that have a battery position; `doubts` are those about the polar and
/// about what is held here.
///
/// Nothing where the log has none, or where the battery never moves.
///
/// # Errors
/// As [`super::fit`].
pub fn pitch_balance(
    vehicle: &Vehicle,
    polar: &Parameters<f64>,
    dives: &[Dive],
    considered: &[Considered],
) -> Result<Option<PitchBalance>, IdentifyError> {
    let usable = |_: usize, o: &Observation| o.battery_forward_m.is_finite();
    let dives: Vec<Dive> = dives.iter().filter_map(|dive| dive.part(usable)).collect();
    let dives = subsampled(&dives, MOST_SAMPLES);
    let samples: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    if samples < LEAST_SAMPLES {
        return Ok(None);
    }
    let mut samples = PitchSamples(dives.clone());
    let starts = [first_guess(polar, &dives, true, true), first_guess(polar, &dives, false, false)];
    let tried = starts.into_iter().flatten().map(|start| {
        let question = Question { several_starts: false, use_speed: false, ..Question::new(start, &ROWS)? };
        Ok((refine(&question, &mut samples)?, question))
    });
    let tried: Vec<Result<(JointFit, Question), IdentifyError>> = tried.collect();
    if tried.is_empty() {
        return Ok(None);
    }
    let best = tried.into_iter().reduce(|a, b| match (&a, &b) {
        (Ok(x), Ok(y)) if y.0.tally.sink.rms() < x.0.tally.sink.rms() => b,
        (Err(_), Ok(_)) => b,
        _ => a,
    });
    let Some(Ok((mut fit, mut question))) = best else { return Ok(None) };
    let start = question.baseline;
    let mut pinned = BTreeMap::new();
    let source = format!("vehicle `{}`", vehicle.name);
    let stated = |name: &str| from_outside(vehicle, parameter_index(name)?).1;
    let scale = "all of the balance scales with it: the log holds ratios of moments only".to_owned();
    pinned.insert(
        "moving_mass_kg".into(),
        Pin::new(start.moving_mass_kg, stated("moving_mass_kg"), source.clone(), scale),
    );
    let same = "it differs from the zero of the battery's reading by changes of dynamic pressure alone".to_owned();
    pinned.insert("CM0".into(), Pin::new(start.CM0, stated("CM0"), source.clone(), same));

    while let Some((position, reason)) = not_identifiable(&fit) {
        let row = fit.free[position];
        let name = PARAMETERS[row].name;
        *question.baseline.at(row) = polar.as_array()[row];
        question.free.retain(|&free| free != row);
        let value = question.baseline.as_array()[row];
        pinned.insert(name.to_owned(), Pin::new(value, stated(name), source.clone(), reason));
        question.baseline = start_for(&question, polar, &dives, true);
        fit = refine(&question, &mut samples)?;
    }
    let without_d = {
        let row = parameter_index("d_per_rad").expect("a row of the table");
        let mut flat = question.clone();
        flat.free.retain(|&free| free != row);
        flat.baseline = start_for(&flat, polar, &dives, false);
        flat.baseline.d_per_rad = 0.0;
        refine(&flat, &mut samples).ok().map(|found| found.tally.sink.rms())
    };
    propagate(&mut fit, &mut samples, considered);
    let mut balance = PitchBalance {
        pitch_rms_rad: fit.tally.sink.rms(),
        pitch_rms_without_d_rad: without_d,
        pitch_rms_holdout_rad: held_out(&question, &fit.parameters, &dives)?,
        n: fit.tally.sink.n,
        mass_kg: fit.parameters.mass_kg(),
        is_identified: !pinned.contains_key("ballast_forward_m")
            || vehicle.get("ballast.forward_m").is_some_and(|x| x != 0.0),
        failure: None,
        pinned,
        fit,
    };
    balance.failure = failure::failure(&balance, &dives);
    Ok(Some(balance))
}

impl PitchBalance {
    /// Height of the centre of gravity of the whole vehicle below the centre of buoyancy, and its standard error \[m\].
    pub fn cg_below_cb_m(&self) -> (f64, f64) {
        let p = &self.fit.parameters;
        let moment = p.moving_mass_kg * p.moving_mass_height_m
            + p.offset_mass_kg * p.offset_mass_below_m
            + p.ballast_nominal_kg * p.ballast_below_m;
        let se = self.fit.position("offset_mass_below_m").map_or(0.0, |i| self.fit.se(i));
        (moment / self.mass_kg, se * p.offset_mass_kg / self.mass_kg)
    }

    /// For the report.
    pub fn summary(&self) -> PitchBalanceSummary {
        let (cg_below_cb_m, cg_below_cb_se_m) = self.cg_below_cb_m();
        PitchBalanceSummary {
            pitch_rms_rad: self.pitch_rms_rad,
            pitch_rms_without_d_rad: self.pitch_rms_without_d_rad,
            pitch_rms_holdout_rad: self.pitch_rms_holdout_rad,
            cg_below_cb_m,
            cg_below_cb_se_m,
            moving_mass_kg: self.fit.parameters.moving_mass_kg,
            condition_number: condition_number(&Gram::sum(self.fit.free.len(), &self.fit.grams).normal_matrix()),
        }
    }
}

fn held_out(question: &Question, best: &Parameters<f64>, dives: &[Dive]) -> Result<Option<f64>, IdentifyError> {
    if dives.len() < 4 {
        return Ok(None);
    }
    let mut sum = Scatter::default();
    for held in [0, 1] {
        let half = |side: usize| {
            PitchSamples(dives.iter().enumerate().filter(|(i, _)| i % 2 == side).map(|(_, d)| d.clone()).collect())
        };
        let found = refine(&Question { baseline: *best, ..question.clone() }, &mut half(1 - held))?;
        let judged = Question { baseline: found.parameters, free: Vec::new(), ..question.clone() };
        let mut trained = half(held);
        let mut grams = vec![Gram::new(0); trained.count()];
        let weights = Weights { sink_m_s: 1.0, speed_m_s: f64::INFINITY };
        sum = sum.merge(trained.evaluate(&judged.baseline, &[], weights, &mut grams, 1).sink);
    }
    Ok(Some(sum.rms()))
}
