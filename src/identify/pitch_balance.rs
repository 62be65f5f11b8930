//! The balance of pitching moments: d, the height of the centre of gravity and the arm of the ballast, from battery
//! position, ballast volume and pitch (the tank paper's future work).
//!
//! In a steady glide the moving mass must stand where the steady glide of that pitch and net mass puts it
//! ([`at_pitch`]'s `moving_mass_m`). Read backwards, battery and ballast say the pitch:
//! ```text
//! g (m_p r + m_b x_b + m_h x_h) cos pitch + g S3 sin pitch = q A LOA d alpha,      q, alpha of the glide at that pitch
//! ```
//! Fitted are `d`, `S3` (as the height of the hull's mass below the centre of buoyancy), `x_b` (how far forward of it the
//! ballast sits) and `x_h` (where the zero of the battery's reading is). All of them scale with the moving mass `m_p`:
//! it must be known. The polar is held as it was identified. `CM0` is held: it differs from `x_h` only by the change of
//! dynamic pressure.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use num_dual::{Dual64, DualSVec64};
use rayon::prelude::*;
use serde::Serialize;

use super::blocks::Blocks;
use super::data::Dive;
use super::evaluate::{Rows, Scatter, Tally, Weights, with_derivatives};
use super::gram::Gram;
use super::identifiability::{Pin, thinned};
use super::joint::{Fit, IdentifyError, Question, refine};
use super::model::{predict, surroundings, true_pitch_rad};
use super::uncertainty::{condition_number, inverse_symmetric, solve_symmetric};
use crate::Number;
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use crate::glide::{Attitude, Glider, at_pitch};
use crate::log::Observation;
use crate::vehicle::Vehicle;

/// What is fitted, in this order: what cannot be told is held from the end.
pub const ROWS: [&str; 4] = ["offset_mass_forward_m", "offset_mass_below_m", "d_per_rad", "ballast_forward_m"];

/// Largest share of a parameter's effect, by variance, that the others may have as well: with less than two per cent of its
/// size to itself, an error of the model would pass for the parameter.
const INSEPARABLE: f64 = 0.9995;

/// Most samples that are used; pitch says the same for many seconds.
const MOST_SAMPLES: usize = 4000;

/// Least number of samples.
const LEAST_SAMPLES: usize = 8;

/// The balance as fitted.
#[derive(Debug, Clone)]
pub struct PitchBalance {
    /// The fit; its parameters hold the polar, too.
    pub fit: Fit,
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
    pub told: bool,
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

/// Fits the balance of moments on the steady samples that have a battery position.
///
/// Nothing where the log has none, or where the battery never moves.
///
/// # Errors
/// As [`super::fit`].
pub fn pitch_balance(
    vehicle: &Vehicle,
    polar: &Parameters<f64>,
    dives: &[Dive],
) -> Result<Option<PitchBalance>, IdentifyError> {
    let usable = |_: usize, o: &Observation| o.battery_forward_m.is_finite();
    let dives: Vec<Dive> = dives.iter().filter_map(|dive| dive.part(usable)).collect();
    let dives = thinned(&dives, MOST_SAMPLES);
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
    let tried: Vec<Result<(Fit, Question), IdentifyError>> = tried.collect();
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
    let scale = "all of the balance scales with it: the log holds ratios of moments only".to_owned();
    pinned.insert("moving_mass_kg".into(), Pin { value: start.moving_mass_kg, source: source.clone(), reason: scale });
    let same = "it differs from the zero of the battery's reading by changes of dynamic pressure alone".to_owned();
    pinned.insert("CM0".into(), Pin { value: start.CM0, source: source.clone(), reason: same });

    while let Some((position, reason)) = untold(&fit) {
        let row = fit.free[position];
        let name = PARAMETERS[row].name;
        *question.baseline.at(row) = polar.as_array()[row];
        question.free.retain(|&free| free != row);
        let value = question.baseline.as_array()[row];
        pinned.insert(name.to_owned(), Pin { value, source: source.clone(), reason });
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
    Ok(Some(PitchBalance {
        pitch_rms_rad: fit.tally.sink.rms(),
        pitch_rms_without_d_rad: without_d,
        pitch_rms_holdout_rad: held_out(&question, &fit.parameters, &dives)?,
        n: fit.tally.sink.n,
        mass_kg: fit.parameters.mass_kg(),
        told: !pinned.contains_key("ballast_forward_m") || vehicle.get("ballast.forward_m").is_some_and(|x| x != 0.0),
        pinned,
        fit,
    }))
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

/// The pitch that battery and ballast give, as the instrument reads it; `near_rad` is where the search begins.
pub fn predicted_pitch_rad<T: Number>(
    parameters: &Parameters<T>,
    with_slope: &Parameters<Dual64>,
    observed: &Observation,
    near_rad: f64,
) -> Option<T> {
    const TOLERANCE_RAD: f64 = 1e-7;
    let water = surroundings(with_slope, observed);
    let net_mass_kg = with_slope.net_mass_kg(Dual64::from(observed.ballast_m3), &water);
    let mut pitch = near_rad;
    let mut slope = f64::NAN;
    let mut converged = false;
    for _ in 0..30 {
        let attitude = Attitude { pitch_rad: Dual64::from(pitch).derivative(), net_mass_kg };
        let needed = at_pitch(with_slope, &water, attitude).ok()?.moving_mass_m;
        slope = needed.eps;
        let step = (needed.re - observed.battery_forward_m) / slope;
        if !step.is_finite() {
            return None;
        }
        pitch -= step.clamp(-0.1, 0.1);
        if step.abs() < TOLERANCE_RAD {
            converged = true;
            break;
        }
    }
    if !converged {
        return None;
    }
    let mut solution = T::constant(pitch);
    if T::HAS_DERIVATIVES {
        let water = surroundings(parameters, observed);
        let net_mass_kg = parameters.net_mass_kg(T::constant(observed.ballast_m3), &water);
        let needed = at_pitch(parameters, &water, Attitude { pitch_rad: solution, net_mass_kg }).ok()?.moving_mass_m;
        // The value is at the solution already: only the slopes are taken.
        let slopes = needed - needed.value();
        solution -= slopes / slope;
    }
    Some((solution - parameters.pitch_offset_rad) / parameters.pitch_scale)
}

/// Linear regression of tan pitch on the position of the battery, with the ballast and the hydrodynamic moment where
/// asked for; `S3 = -m_p / slope`.
fn first_guess(polar: &Parameters<f64>, dives: &[Dive], ballast: bool, moment: bool) -> Option<Parameters<f64>> {
    let mut gram = Gram::new(4);
    let glider = Glider::new(*polar);
    for o in dives.iter().flat_map(|dive| &dive.observations) {
        let pitch: f64 = true_pitch_rad(polar, o.pitch_rad);
        let Some(flown) = predict(&glider, o, None).filter(|_| pitch.cos() > 0.1) else { continue };
        let force = 0.5 * o.density_kg_m3 * flown.speed_m_s.powi(2) * polar.frontal_area_m2 * polar.length_m;
        let moment_kg_m = force * flown.angle_of_attack_rad / (polar.gravity_m_s2 * pitch.cos());
        let ballast_kg = if ballast { polar.ballast_mass_kg(o.ballast_m3) } else { 0.0 };
        let moment_kg_m = if moment { moment_kg_m } else { 0.0 };
        gram.add_row(&[1.0, o.battery_forward_m, ballast_kg, moment_kg_m, pitch.tan()]);
    }
    let found = solve_symmetric(&gram.normal_matrix(), &gram.gradient());
    // A battery that never moves, or one that lifts the nose when it goes forward, says nothing.
    if !(found[1] < 0.0 && found.iter().all(|value| value.is_finite())) {
        return None;
    }
    let mut start = *polar;
    let moment_3 = -start.moving_mass_kg / found[1];
    start.offset_mass_kg = start.hull_mass_kg;
    let rest = start.moving_mass_kg * start.moving_mass_height_m + start.ballast_nominal_kg * start.ballast_below_m;
    start.offset_mass_below_m = (moment_3 - rest) / start.offset_mass_kg;
    if ballast {
        start.ballast_forward_m = -found[2] * moment_3;
    }
    let ballast_kg_m = if ballast { 0.0 } else { start.ballast_nominal_kg * start.ballast_forward_m };
    start.offset_mass_forward_m = (-found[0] * moment_3 - ballast_kg_m) / start.offset_mass_kg;
    start.d_per_rad = found[3] * moment_3;
    start.ascent_d_ratio = 1.0;
    Some(start)
}

/// Where the fit of this question may begin: the regression with what is free in it.
fn start_for(question: &Question, polar: &Parameters<f64>, dives: &[Dive], moment: bool) -> Parameters<f64> {
    let is_free = |name: &str| parameter_index(name).is_some_and(|row| question.free.contains(&row));
    first_guess(polar, dives, is_free("ballast_forward_m"), moment && is_free("d_per_rad")).unwrap_or(question.baseline)
}

/// A parameter that the data do not tell, and why; the last of [`ROWS`] first.
fn untold(fit: &Fit) -> Option<(usize, String)> {
    let normal = Gram::sum(fit.free.len(), &fit.grams).normal_matrix();
    for name in ["ballast_forward_m", "d_per_rad"] {
        let Some(position) = fit.position(name) else { continue };
        let explained = explained_by_others(&normal, fit.position("offset_mass_forward_m"), position);
        if explained > INSEPARABLE {
            let reason = format!(
                "battery, ballast and speed change together in these data: {:.2} % of what it does, the others do as well",
                100.0 * explained
            );
            return Some((position, reason));
        }
        let (value, se) = (fit.value(fit.free[position]), fit.se(position));
        if se.is_nan() || 2.0 * se > value.abs().max(usual(name)) {
            return Some((
                position,
                format!("these data leave it open: fitted freely it would be {value:.3} +- {se:.3}"),
            ));
        }
    }
    None
}

/// Share of the variance of one column of the Jacobian that the others explain, the constant set aside.
fn explained_by_others(normal: &DMatrix<f64>, constant: Option<usize>, position: usize) -> f64 {
    let own = match constant.filter(|&c| c != position && normal[(c, c)] > 0.0) {
        Some(c) => normal[(position, position)] - normal[(position, c)].powi(2) / normal[(c, c)],
        None => normal[(position, position)],
    };
    1.0 - 1.0 / (own * inverse_symmetric(normal)[(position, position)]).max(1.0)
}

/// Half a 95 % interval that still says something where the value itself is about zero.
fn usual(name: &str) -> f64 {
    if name == "d_per_rad" { 0.5 } else { 0.1 }
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
        let mut seen = half(held);
        let mut grams = vec![Gram::new(0); seen.count()];
        let weights = Weights { sink_m_s: 1.0, speed_m_s: f64::INFINITY };
        sum = sum.merge(seen.evaluate(&judged.baseline, &[], weights, &mut grams, 1).sink);
    }
    Ok(Some(sum.rms()))
}

/// Dives of which the pitch is what is predicted; the tally's first quantity is the pitch \[rad\].
struct PitchSamples(Vec<Dive>);

impl Blocks for PitchSamples {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn samples(&self) -> usize {
        self.0.iter().map(|dive| dive.observations.len()).sum()
    }

    fn has_speed(&self) -> bool {
        false
    }

    fn evaluate(
        &mut self,
        parameters: &Parameters<f64>,
        free: &[usize],
        weights: Weights,
        grams: &mut [Gram],
        every: usize,
    ) -> Tally {
        let lifted = with_derivatives::<4>(parameters, free);
        let work = |(dive, gram): (&mut Dive, &mut Gram)| rows(&lifted, free.len(), weights, dive, gram, every);
        self.0.par_iter_mut().zip(grams.par_iter_mut()).map(work).reduce(Tally::default, Tally::merge)
    }
}

fn rows(
    lifted: &Parameters<DualSVec64<4>>,
    n: usize,
    weights: Weights,
    dive: &mut Dive,
    gram: &mut Gram,
    every: usize,
) -> Tally {
    let with_slope = lifted.map(|value| Dual64::from(value.re));
    let mut rows = Rows::new(gram, n, weights);
    for (observed, _, root_weight) in dive.every(every) {
        let near = true_pitch_rad(lifted, observed.pitch_rad).re;
        // Where no pitch balances, level flight is what is predicted: nothing is gained by being unable to fly.
        let predicted = predicted_pitch_rad(lifted, &with_slope, observed, near);
        rows.first(observed.leg, observed.pitch_rad, predicted, root_weight);
    }
    rows.close()
}
