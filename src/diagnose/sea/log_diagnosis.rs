//! The diagnosis of a whole log: consistency first, then mechanisms in what is left.

use std::borrow::Cow;

use super::{DiagnosisSettings, SeaError, SeaProblem};
use super::{
    consistency, density_report, empirical, grid_refinement, known_shear, level_shift, lift_slope, not_assessed,
    stated_polar, trim, unknown_temperature,
};
use crate::diagnose::engine;
use crate::diagnose::findings::{Checked, Verdict};
use crate::diagnose::{Evidence, Outcome, Problem};
use crate::dynamics::Parameters;
use crate::identify::Trim;
use crate::log::Observation;
use crate::turning::causes::ModelledStretch;

/// A log's diagnosis.
pub struct SeaDiagnosis {
    /// The four answers, and what is left row by row.
    pub outcome: Outcome,
    /// The data, at the extended model.
    pub evidence: Evidence,
    /// The log against the vehicle, corrected where it had to be.
    pub problem: SeaProblem,
    /// The baseline: the vehicle, with its trim decided.
    pub baseline: Parameters<f64>,
    /// Roll and turn rate of steady stretches before and after the named causes of turning; empty without such a cause.
    pub turns: Vec<ModelledStretch>,
}

/// What is said of a log in which inertia does not show.
const QUASI_STEADY: &str = "the log follows a glide without inertia better than one with it: the baseline is taken without, as a simulated log may be";

/// Diagnoses a log against a vehicle.
///
/// # Errors
/// Where the log contradicts itself beyond mending, or too little of it can be used.
pub fn diagnose_log(
    vehicle: &Parameters<f64>,
    trim: Trim,
    observations: &[Observation],
    settings: DiagnosisSettings,
) -> Result<SeaDiagnosis, SeaError> {
    // A vehicle that carries a bias of the density has its density corrected by the model: what is corrected here comes on top.
    let carried_kg_m3 = vehicle.density_bias_kg_m3;
    let (checks, error) = consistency::checks(observations, carried_kg_m3);
    if checks.iter().any(|check| check.outcome == Checked::Wrong) {
        return Err(SeaError::Inconsistent(checks));
    }
    let temperature_is_suggested = unknown_temperature::is_unknown(vehicle, observations);
    let as_read = |observations: &[Observation], trim_is_assumed: bool| {
        let baseline = trim.baseline(vehicle, observations);
        let settings = DiagnosisSettings { trim_is_assumed, temperature_is_suggested, ..settings.clone() };
        SeaProblem::new(observations, &baseline, settings).map(|problem| (problem, baseline))
    };
    let assumed = trim == Trim::Neutral || temperature_is_suggested;
    let used = match error {
        None => Cow::Borrowed(observations),
        Some(error) => Cow::Owned(consistency::corrected(observations, error, carried_kg_m3)),
    };
    let used = if temperature_is_suggested { Cow::Owned(unknown_temperature::suggested(vehicle, &used)) } else { used };
    let (problem, baseline) = as_read(&used, assumed)?;
    // The larger of the two: each is a bound, not a standard error.
    let by_ballasting = if trim == Trim::Neutral { trim::ballasting_kg(&baseline) } else { 0.0 };
    let by_temperature = if temperature_is_suggested { unknown_temperature::most_kg(&baseline) } else { 0.0 };
    let most_trim_kg = by_ballasting.max(by_temperature);
    let decided = |problem: SeaProblem| {
        let (problem, outcome) = grid_refinement::diagnose(problem);
        problem.with_trim_as_cause(outcome, most_trim_kg)
    };
    let as_asked = problem.clone();
    let (problem, outcome, uses_stated_polar) = with_stated_polar(problem, settings.polar_se, decided);
    let polar_se = if uses_stated_polar { settings.polar_se } else { [None; 3] };
    let held = || decided(as_asked.with_lift_held().with_polar_errors(polar_se));
    let (problem, outcome, of_the_slope) = lift_slope::decide(problem, outcome, held);
    let (problem, mut outcome) = with_speed_scale_if_it_explains(problem, outcome, most_trim_kg);
    match error {
        Some(error) => {
            let raw = as_read(observations, false).ok().map(|(raw, _)| raw);
            density_report::add_cause(&mut outcome, &problem, raw.as_ref(), error, carried_kg_m3);
        }
        None => density_report::add_uncheckable(&mut outcome, &problem, &checks),
    }
    if problem.has_speed() {
        not_assessed::add_speed_scale(&mut outcome);
    }
    if assumed {
        trim::report(&mut outcome, most_trim_kg);
    }
    outcome.diagnosis.warnings.extend(of_the_slope.map(str::to_owned));
    if !uses_stated_polar {
        outcome.diagnosis.warnings.push(stated_polar::WARNING.to_owned());
    }
    outcome.diagnosis.shear_share = known_shear::share(&problem, &outcome);
    if temperature_is_suggested {
        outcome.diagnosis.warnings.push(unknown_temperature::WARNING.to_owned());
    }
    outcome.diagnosis.rejected.extend(not_assessed::rejections(&checks, &outcome, &problem));
    outcome.diagnosis.consistency = checks;
    if problem.is_quasi_steady() {
        outcome.diagnosis.warnings.push(QUASI_STEADY.to_owned());
    }
    outcome.diagnosis.warnings.extend(problem.warnings(&outcome.before.point, &outcome.after.point));
    level_shift::add(&mut outcome, &problem);
    let problem = empirical::extend(problem, &mut outcome);
    let evidence = problem.evidence(&outcome.after.point);
    Ok(SeaDiagnosis { outcome, evidence, problem, baseline, turns: Vec::new() })
}

/// Diagnoses a problem with the errors that the vehicle states of its polar; returns whether they are used.
///
/// A log may contradict them because the polar is another, or because of what is wrong. Where all is well with a plausible polar of its
/// own, or the stated one leaves something unexplained or does not stay within its errors, it is another.
fn with_stated_polar(
    problem: SeaProblem,
    stated: [Option<f64>; 3],
    decided: impl Fn(SeaProblem) -> (SeaProblem, Outcome),
) -> (SeaProblem, Outcome, bool) {
    let free = problem.with_polar_errors([None; 3]);
    if stated == [None; 3] || !stated_polar::is_contradicted(&free, &problem, stated) {
        let (problem, outcome) = decided(problem);
        return (problem, outcome, true);
    }
    let (free, of_free) = decided(free);
    let is_well =
        of_free.diagnosis.verdict == Verdict::None && !stated_polar::is_implausible(&free, &of_free.after.point);
    if !is_well {
        let (problem, outcome) = decided(problem);
        let stays = stated_polar::stays_within(&problem, &outcome.after.point, stated);
        if outcome.diagnosis.verdict == Verdict::Explained && stays {
            return (problem, outcome, true);
        }
    }
    (free, of_free, false)
}

/// Returns a diagnosis, or where it leaves something unexplained one with a scale of the speed among the candidates, if that explains all.
/// The search with one more candidate follows another path, and may explain all without that scale.
fn with_speed_scale_if_it_explains(problem: SeaProblem, outcome: Outcome, most_trim_kg: f64) -> (SeaProblem, Outcome) {
    let is_left = outcome.diagnosis.verdict == Verdict::Unexplained;
    let Some(asking) = is_left.then(|| problem.with_speed_scale()).flatten() else { return (problem, outcome) };
    let of_asking = engine::diagnose_in_full(&asking);
    let (asking, of_asking) = asking.with_trim_as_cause(of_asking, most_trim_kg);
    if of_asking.diagnosis.verdict == Verdict::Explained { (asking, of_asking) } else { (problem, outcome) }
}

#[cfg(test)]
mod tests {
    use super::consistency::DensityError;
    use super::*;
    use crate::diagnose::sea::steady_log::SAMPLE;
    use crate::dynamics::Surroundings;
    use crate::glide::{Attitude, at_pitch};
    use crate::log::DBAR_PA;
    use crate::vehicle::Vehicle;

    /// Forty legs of steady glides whose density was read too low by `bias_kg_m3`.
    fn flight(p: &Parameters<f64>, bias_kg_m3: f64) -> Vec<Observation> {
        flight_in(p, bias_kg_m3, |_| p.reference_temperature_C)
    }

    /// The same in water of a temperature by its pressure \[dbar\].
    fn flight_in(p: &Parameters<f64>, bias_kg_m3: f64, temperature: impl Fn(f64) -> f64) -> Vec<Observation> {
        let mut observations = Vec::new();
        for i in 0..1600u32 {
            let (leg, within) = (i / 40, f64::from(i % 40));
            let descends = leg % 2 == 0;
            let pressure_dbar = 10.0 + 4.0 * if descends { within } else { 40.0 - within };
            let temperature_C = temperature(pressure_dbar);
            let density_kg_m3 = 1025.0 + 4.5e-3 * pressure_dbar - 0.15 * (temperature_C - p.reference_temperature_C);
            let (pressure_Pa, time_s) = (pressure_dbar * DBAR_PA, 15.0 * f64::from(i));
            let water = Surroundings { density_kg_m3, pressure_Pa, temperature_C, time_s };
            let sign = if descends { -1.0 } else { 1.0 };
            let pitch_rad = sign * (20.0 + f64::from(leg % 5) * 3.0).to_radians();
            let ballast_m3 = sign * 2e-4;
            let net_mass_kg = p.net_mass_kg(ballast_m3, &water);
            let glide = at_pitch(p, &water, Attitude { pitch_rad, net_mass_kg }).expect("a glide");
            // Waves, with no more of a pattern than the sine of a large number has.
            let noise = |seed: f64| (f64::from(i) * 78.233 + seed).sin() * 43_758.545 % 1.0;
            observations.push(Observation {
                time_s,
                pressure_dbar,
                temperature_C,
                density_kg_m3: density_kg_m3 - bias_kg_m3,
                teos10_density_kg_m3: density_kg_m3,
                teos10_surface_density_kg_m3: 1025.0,
                pitch_rad,
                heading_rad: f64::from(leg),
                ballast_m3,
                sink_m_s: glide.vertical_velocity_m_s + 0.03 * noise(0.0),
                speed_m_s: glide.speed_m_s + 0.02 * noise(1.0),
                leg,
                dive: leg / 2,
                ..SAMPLE
            });
        }
        observations
    }

    /// 8 K above the reference at the surface, 4 K below it at 170 dbar: 7e-5 1/K are 42 g of buoyancy, of which the log says nothing.
    #[test]
    fn a_log_without_temperature_names_no_offset_that_its_temperature_makes() {
        let slocum = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        let truth = Parameters { hull_thermal_expansion_per_K: 7e-5, ..slocum };
        let warm = |pressure_dbar: f64| truth.reference_temperature_C + 8.0 - 12.0 * pressure_dbar / 170.0;
        let log = flight_in(&truth, 0.0, warm);
        let diagnose = |vehicle: &Parameters<f64>, log: &[Observation]| {
            let found = diagnose_log(vehicle, Trim::Vehicle, log, DiagnosisSettings::default());
            found.expect("a diagnosis").outcome.diagnosis
        };
        let without: Vec<Observation> =
            log.iter().map(|o| Observation { temperature_C: f64::NAN, teos10_density_kg_m3: f64::NAN, ..*o }).collect();
        let found = diagnose(&truth, &without);
        assert_eq!(found.verdict, Verdict::None, "{:?}", found.causes);
        assert!(found.warnings.iter().any(|warning| warning == unknown_temperature::WARNING));
        // A vehicle that is not known to expand has its fault named: the log does not fit it.
        assert_ne!(diagnose(&slocum, &without).verdict, Verdict::None);
    }

    /// Half the lift on ascents is twice the lift on descents.
    #[test]
    fn a_ratio_has_the_same_limit_either_way() {
        let slocum = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        let found = diagnose_log(&slocum, Trim::Vehicle, &flight(&slocum, 0.0), DiagnosisSettings::default());
        let problem = found.expect("a diagnosis").problem;
        for name in ["lift_asymmetry", "climb_dive_asymmetry", "ballast_scale", "pressure_scale"] {
            let of_name = problem.candidates().iter().find(|candidate| candidate.name == name);
            let [least, most] = of_name.expect("a candidate").possible;
            let neutral = of_name.expect("a candidate").neutral[0];
            assert!(((least / neutral) * (1.0 + most - neutral) - 1.0).abs() < 1e-12, "{name}: {least} to {most}");
        }
    }

    /// A gauge that reads 1.5 % more on the way up is broken: what resembles that is another law.
    #[test]
    fn a_hysteresis_has_a_limit() {
        let slocum = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        let found = diagnose_log(&slocum, Trim::Vehicle, &flight(&slocum, 0.0), DiagnosisSettings::default());
        let problem = found.expect("a diagnosis").problem;
        let of_name = problem.candidates().iter().find(|candidate| candidate.name == "pressure_hysteresis");
        let hysteresis = of_name.expect("a candidate");
        assert!(hysteresis.is_impossible(-0.015) && !hysteresis.is_impossible(0.008));
        assert!(hysteresis.is_unusual(0.008), "named only where nothing else explains the log");
    }

    /// Four times the drag in a day, four prior standard deviations: seldom seen, and what the log shows.
    #[test]
    fn a_size_that_is_seldom_seen_is_named_with_a_warning() {
        let slocum = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        // A vehicle that still glides at 20 degrees with twice its drag.
        let slocum = Parameters { b: 0.5 * slocum.b, c_per_rad2: 0.5 * slocum.c_per_rad2, ..slocum };
        let truth = Parameters { drag_growth_per_day: 4.0, ..slocum };
        let found = diagnose_log(&slocum, Trim::Vehicle, &flight(&truth, 0.0), DiagnosisSettings::default());
        let found = found.expect("a diagnosis").outcome.diagnosis;
        let [cause] = found.causes.as_slice() else { panic!("{:?}", found.causes) };
        assert_eq!(cause.cause, "drag_growth");
        let [low, high] = cause.parameters["drag_growth_per_day"].ci95;
        assert!(low < 4.0 && 4.0 < high, "{low} to {high}");
        let seldom = |warning: &&String| warning.contains("seldom seen (usually 0 to 3.00)");
        assert_eq!(found.warnings.iter().filter(seldom).count(), 1, "{:?}", found.warnings);
    }

    /// Vertical velocity alone: the lift slope is known to what the vehicle states of it, unless the log shows another polar.
    #[test]
    fn errors_that_the_vehicle_states_of_its_polar_are_used_unless_the_log_contradicts_them() {
        let truth = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        let log = flight(&truth, 0.0);
        let stated = 0.01;
        let diagnose = |vehicle: &Parameters<f64>, polar_se: [Option<f64>; 3]| {
            let settings = DiagnosisSettings { use_speed: false, polar_se, ..DiagnosisSettings::default() };
            diagnose_log(vehicle, Trim::Vehicle, &log, settings).expect("a diagnosis")
        };
        let contradicts = |found: &SeaDiagnosis| {
            found.outcome.diagnosis.warnings.iter().any(|warning| warning == stated_polar::WARNING)
        };
        let se_of_a = |found: &SeaDiagnosis| {
            let before = &found.outcome.before;
            before.covariance[(0, 0)].sqrt() / before.point.baseline[0]
        };
        let (free, used) = (diagnose(&truth, [None; 3]), diagnose(&truth, [Some(stated); 3]));
        assert!(!contradicts(&free) && !contradicts(&used));
        assert!(
            se_of_a(&used) < 1.01 * stated && se_of_a(&free) > 3.0 * stated,
            "{} {}",
            se_of_a(&used),
            se_of_a(&free)
        );
        assert_eq!(used.outcome.diagnosis.verdict, Verdict::None);
        // Twice the drag, stated to 1 %.
        let other = Parameters { b: 2.0 * truth.b, ..truth };
        let refuted = diagnose(&other, [Some(stated); 3]);
        assert!(contradicts(&refuted));
        assert_eq!(refuted.outcome.before.point, diagnose(&other, [None; 3]).outcome.before.point);
    }

    /// A lift slope of three times the vehicle's, or a third, may hide a cause where something is left and no speed shows it.
    #[test]
    fn a_lift_slope_far_from_the_vehicles_is_asked_whether_it_hides_a_cause() {
        let truth = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        let log = flight(&truth, 0.0);
        let hides = |use_speed: bool, verdict: Verdict, ratio: f64| {
            let settings = DiagnosisSettings { use_speed, ..DiagnosisSettings::default() };
            let SeaDiagnosis { problem, mut outcome, .. } =
                diagnose_log(&truth, Trim::Vehicle, &log, settings).expect("a diagnosis");
            outcome.diagnosis.verdict = verdict;
            outcome.after.point.baseline[0] = ratio * truth.a_per_rad;
            problem.is_hidden_by_a_far_slope(&outcome)
        };
        for ratio in [0.3, 3.5] {
            assert!(hides(false, Verdict::Unexplained, ratio) && hides(false, Verdict::PartlyExplained, ratio));
            assert!(!hides(false, Verdict::None, ratio) && !hides(false, Verdict::Explained, ratio));
            assert!(!hides(true, Verdict::Unexplained, ratio));
        }
        assert!(!hides(false, Verdict::Unexplained, 2.5));
    }

    #[test]
    fn a_bias_that_the_vehicle_carries_is_not_corrected_again() {
        let truth = Vehicle::load("slocum-049").expect("a vehicle").glide_parameters();
        let log = flight(&truth, 0.8);
        let diagnose = |carried: f64, log: &[Observation]| {
            let vehicle = Parameters { density_bias_kg_m3: carried, ..truth };
            diagnose_log(&vehicle, Trim::Vehicle, log, DiagnosisSettings::default())
                .expect("a diagnosis")
                .outcome
                .diagnosis
        };
        let others = |diagnosis: &crate::diagnose::Diagnosis| -> Vec<String> {
            let causes = diagnosis.causes.iter().map(|cause| cause.cause.clone());
            causes.filter(|cause| cause != "density_bias").collect()
        };
        let unbiased = others(&diagnose(0.0, &flight(&truth, 0.0)));
        // What the vehicle carries of it, and whether more is to be named.
        for (carried, is_named) in [(0.0, true), (0.3, true), (0.8, false), (1.2, true)] {
            let found = diagnose(carried, &log);
            assert_eq!(others(&found), unbiased, "{carried} kg/m3 carried");
            // The size is that of the extended vehicle: all of the bias.
            let bias = found.causes.iter().find_map(|cause| cause.parameters.get("density_bias_kg_m3"));
            assert_eq!(bias.is_some(), is_named, "{carried} kg/m3 carried");
            assert!(bias.is_none_or(|bias| (bias.value - 0.8).abs() < 0.01), "{carried} kg/m3 carried: {bias:?}");
        }
        // The same for a density at p = 0: no part of the carried bias stays in what is corrected.
        let at_surface: Vec<Observation> =
            log.iter().map(|o| Observation { density_kg_m3: o.teos10_surface_density_kg_m3 - 0.8, ..*o }).collect();
        let (_, error) = consistency::checks(&at_surface, 0.8);
        assert_eq!(error, Some(DensityError::AtZeroPressure));
        for (o, corrected) in
            at_surface.iter().zip(consistency::corrected(&at_surface, DensityError::AtZeroPressure, 0.8))
        {
            assert!((corrected.density_kg_m3 + 0.8 - o.teos10_density_kg_m3).abs() < 1e-9);
        }
    }
}
