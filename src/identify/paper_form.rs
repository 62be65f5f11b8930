//! The iterative scheme's result in the form of `identify --json`.
//!
//! The scheme has no errors of its own, and what it finds depends on where it starts. So a coefficient is given as the
//! mean over descents and ascents from the vehicle's own first guess, and its interval is the whole range over both legs
//! and over first guesses of half and double the lift slope.

use std::collections::BTreeMap;

use serde::Serialize;

use super::external_values::Pin;
use super::form::{CorrelationTable, FitQuality};
use super::paper::{Campaign, Coefficients, campaign, mean_glides};
use super::residuals::{ScoreSums, residuals};
use super::trim::Trim;
use crate::dynamics::Parameters;
use crate::hull_tests::Estimate;
use crate::log::Observation;
use crate::vehicle::Vehicle;

/// First guesses of the lift slope, against the vehicle's own; the first one counts.
const FIRST_GUESSES: [f64; 3] = [1.0, 0.5, 2.0];

/// The result.
#[derive(Debug, Clone, Serialize)]
pub struct IterativeReport {
    /// Name and version of the form.
    pub schema: &'static str,
    /// `iterative`.
    pub method: &'static str,
    /// Vehicle.
    pub vehicle: String,
    /// What the net weight is taken for.
    pub trim: Trim,
    /// The same in a sentence.
    pub trim_meaning: &'static str,
    /// Legs.
    pub n_glides: usize,
    /// Steady samples behind the means.
    pub n_samples: usize,
    /// a, b and c; the scheme knows no d and no ballast offset.
    pub parameters: BTreeMap<&'static str, Option<Estimate>>,
    /// None: the scheme has no errors.
    pub correlation: CorrelationTable,
    /// None.
    pub condition_number: Option<f64>,
    /// What the scheme can tell: b alone, given the rest.
    pub identifiable: BTreeMap<&'static str, bool>,
    /// Nothing is held on purpose.
    pub pinned: BTreeMap<String, Pin>,
    /// How the coefficients of both legs do on all steady samples.
    pub fit: FitQuality,
    /// Descents and ascents, from each first guess.
    pub campaigns: Vec<Campaign>,
    /// What a user has to know.
    pub warnings: Vec<String>,
    /// What was found in the log and done about it.
    pub notes: Vec<String>,
    /// The vehicle with the coefficients of both legs.
    #[serde(skip)]
    pub solved: Parameters<f64>,
}

/// Runs the scheme; nothing where it has no solution for any leg.
pub fn iterative(
    vehicle: &Vehicle,
    trim: Trim,
    observations: &[Observation],
    w_filter: String,
    notes: Vec<String>,
) -> Option<IterativeReport> {
    let baseline = trim.baseline(&vehicle.glide_parameters(), observations);
    let glides = mean_glides(&baseline, observations);
    let first = Coefficients { a: baseline.a_per_rad, b: baseline.b, c: baseline.c_per_rad2 };
    let mut campaigns = Vec::new();
    for factor in FIRST_GUESSES {
        for descends in [true, false] {
            let guess = Coefficients { a: first.a * factor, ..first };
            campaigns.extend(campaign(&glides, descends, baseline.frontal_area_m2, guess));
        }
    }
    let own: Vec<&Campaign> = campaigns.iter().filter(|found| found.first_guess == first).collect();
    let solved = with_both_legs(&baseline, own.first()?.coefficients(), own.last()?.coefficients());
    let quantity = |of: fn(Coefficients) -> f64, unit: &str| {
        let value = own.iter().map(|found| of(found.coefficients())).sum::<f64>() / own.len() as f64;
        let all: Vec<f64> = campaigns.iter().map(|found| of(found.coefficients())).collect();
        let (low, high) = all.iter().fold((value, value), |(low, high), &x| (low.min(x), high.max(x)));
        // Of a uniform distribution over the range.
        Estimate { value, se: (high - low) / 12f64.sqrt(), ci95: [low, high], unit: unit.to_owned() }
    };
    let parameters = BTreeMap::from([
        ("a", Some(quantity(|k| k.a, "1/rad"))),
        ("b", Some(quantity(|k| k.b, "1"))),
        ("c", Some(quantity(|k| k.c, "1/rad2"))),
        ("d", None),
        ("ballast_offset_kg", None),
    ]);
    let steady: Vec<Observation> = observations.iter().filter(|o| o.steady).copied().collect();
    let mut sums = ScoreSums::default();
    sums.add(&steady, &residuals(&solved, &steady));
    let score = sums.score();
    let unsolved: usize = own.iter().map(|found| found.unsolved).sum();
    let mut warnings = vec![
        "the result depends on the first guess: the intervals are the range over first guesses and legs, no statistical errors"
            .to_owned(),
    ];
    if unsolved > 0 {
        warnings.push(format!(
            "{unsolved} of {} glides have no solution: weight, pitch and sink rate contradict each other",
            glides.len()
        ));
    }
    if own.iter().any(|found| !found.converged) {
        warnings.push("the scheme did not come to rest within its rounds".into());
    }
    Some(IterativeReport {
        schema: "glidepolar.identify/1",
        method: "iterative",
        vehicle: vehicle.name.clone(),
        trim,
        trim_meaning: trim.sentence(),
        n_glides: glides.len(),
        n_samples: steady.len(),
        parameters,
        correlation: CorrelationTable { names: Vec::new(), matrix: Vec::new() },
        condition_number: None,
        identifiable: BTreeMap::from([("a", false), ("b", false), ("c", false), ("d", false)]),
        pinned: BTreeMap::new(),
        fit: FitQuality {
            w_rms_m_s: score.w_rms_m_s,
            w_rms_holdout_m_s: None,
            w_rms_9_point_m_s: score.w_rms_9_point_m_s,
            w_rms_9_point_holdout_m_s: None,
            speed_rms_m_s: score.speed_rms_m_s,
            speed_bias_m_s: score.speed_bias_m_s,
            speed_rms_holdout_m_s: None,
            speed_bias_holdout_m_s: None,
            pitch_rms_rad: None,
            w_filter,
            correlated_samples: 1.0,
        },
        campaigns,
        warnings,
        notes,
        solved,
    })
}

fn with_both_legs(baseline: &Parameters<f64>, descent: Coefficients, ascent: Coefficients) -> Parameters<f64> {
    Parameters {
        a_per_rad: descent.a,
        b: descent.b,
        c_per_rad2: descent.c,
        ascent_a_ratio: ascent.a / descent.a,
        ascent_b_ratio: ascent.b / descent.b,
        ascent_c_ratio: ascent.c / descent.c,
        ..*baseline
    }
}
