//! The result as `identify --json` gives it.

use std::collections::BTreeMap;

use serde::Serialize;

use super::campaign::{Identification, LegsApart};
use super::external_values::Pin;
use super::identifiability::{ProfilePoint, is_identified};
use super::inflections::Comparison;
use super::joint::{IdentifyError, JointFit};
use super::names::{long_name, short_name};
use super::pitch_balance::{PitchBalance, PitchBalanceSummary};
use super::speeds::Rows;
use super::trim::Trim;
use crate::dynamics::{PARAMETERS, parameter_index};
use crate::hull_tests::Estimate;
use crate::vehicle::Vehicle;
use glidepolar_inference::covariance::{condition_number, correlation};
use glidepolar_turning::Turning;

/// The result in the form of `identify --json`.
#[derive(Debug, Clone, Serialize)]
pub struct IdentifyReport {
    /// Name and version of the form.
    pub schema: &'static str,
    /// `joint` or `iterative`.
    pub method: &'static str,
    /// Vehicle.
    pub vehicle: String,
    /// What the baseline takes for the net weight.
    pub trim: Trim,
    /// The same in a sentence.
    pub trim_meaning: &'static str,
    /// Legs with steady samples.
    pub n_glides: usize,
    /// Steady samples; in the unsteady mode all that are flown through.
    pub n_samples: usize,
    /// What there is of each quantity, and how many independent rows of the fit that is worth.
    pub rows: BTreeMap<&'static str, Rows>,
    /// Identified parameters; `d` is null where it was not.
    pub parameters: BTreeMap<String, Option<Estimate>>,
    /// Their correlations.
    pub correlation: CorrelationTable,
    /// Condition number of the Jacobian, columns scaled to one length.
    pub condition_number: f64,
    /// Whether the data tell a parameter.
    pub identifiable: BTreeMap<String, bool>,
    /// What was held, at which value, from where and why.
    pub pinned: BTreeMap<String, Pin>,
    /// How good the fit is.
    pub fit: FitQuality,
    /// Descents and ascents fitted apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legs_apart: Option<LegsApart>,
    /// What each half of the dives says by itself of each fitted parameter, by short name; none with fewer than four dives.
    pub halves: BTreeMap<String, Halves>,
    /// Steady and unsteady where the glider turns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unsteady: Option<Comparison>,
    /// How it turns, where the log has heading and roll or rudder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turning: Option<Turning>,
    /// The balance of pitching moments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_balance: Option<PitchBalanceSummary>,
    /// Profile of the lift slope.
    pub lift_slope_profile: Vec<ProfilePoint>,
    /// What a user has to know.
    pub warnings: Vec<String>,
    /// What was found in the log and done about it.
    pub notes: Vec<String>,
}

/// Correlations with the names of their rows.
#[derive(Debug, Clone, Serialize)]
pub struct CorrelationTable {
    /// Names.
    pub names: Vec<String>,
    /// Rows.
    pub matrix: Vec<Vec<f64>>,
}

/// How good a fit is.
#[derive(Debug, Clone, Serialize)]
pub struct FitQuality {
    /// Vertical velocity, root mean square \[m/s\].
    pub w_rms_m_s: f64,
    /// The same on dives that the fit did not see.
    pub w_rms_holdout_m_s: Option<f64>,
    /// After a running mean over nine samples.
    pub w_rms_9_point_m_s: Option<f64>,
    /// The same on dives that the fit did not see.
    pub w_rms_9_point_holdout_m_s: Option<f64>,
    /// Speed, root mean square \[m/s\].
    pub speed_rms_m_s: Option<f64>,
    /// Speed, mean of measured less predicted \[m/s\].
    pub speed_bias_m_s: Option<f64>,
    /// On dives that the fit did not see.
    pub speed_rms_holdout_m_s: Option<f64>,
    /// On dives that the fit did not see.
    pub speed_bias_holdout_m_s: Option<f64>,
    /// Pitch from the balance of moments, root mean square \[rad\].
    pub pitch_rms_rad: Option<f64>,
    /// How the vertical velocity is measured.
    pub w_filter: String,
    /// How many neighbouring samples say together what one independent sample would.
    pub correlated_samples: f64,
}

/// A parameter by every other dive and by those between.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Halves {
    /// By the first, third, ... dive, and by the second, fourth, ...
    pub values: [f64; 2],
    /// Standard error of their difference: twice that of the whole, by the scatter between dives.
    pub difference_se: f64,
}

/// Fewest dives of which a scatter is known.
const LEAST_DIVES: usize = 2;

impl Identification {
    /// Whether there are dives enough for an error of anything: of one dive none is known, so that nothing is identified.
    ///
    /// # Errors
    /// With fewer.
    pub fn has_enough_dives(&self) -> Result<(), IdentifyError> {
        match self.dives.len() {
            dives if dives >= LEAST_DIVES => Ok(()),
            found => {
                Err(IdentifyError::TooFewDives { found, needed: LEAST_DIVES, parameters: self.best_fit().free.len() })
            }
        }
    }

    fn halves(&self) -> BTreeMap<String, Halves> {
        let halves = self.held_out.iter().flat_map(|held_out| &held_out.halves);
        let of_row = |&(row, values): &(usize, [f64; 2])| {
            let position = self.fit.free.iter().position(|&free| free == row)?;
            let difference_se = 2.0 * self.fit.scatter_se(position);
            Some((short_name(PARAMETERS[row].name).to_owned(), Halves { values, difference_se }))
        };
        halves.filter_map(of_row).collect()
    }

    /// The fit that counts: the unsteady one where it was asked for.
    pub fn best_fit(&self) -> &JointFit {
        self.inflections.as_ref().map_or(&self.fit, |flown| &flown.fit)
    }

    /// In the form of `identify --json`; `w_filter` says how the vertical velocity was measured.
    pub fn report(&self, vehicle: &Vehicle, w_filter: String, notes: Vec<String>) -> IdentifyReport {
        let fit = self.best_fit();
        let n = fit.free.len();
        let mut pinned = self.pinned.clone();
        let mut parameters: BTreeMap<String, Option<Estimate>> = BTreeMap::from([("d".to_owned(), None)]);
        let mut identifiable = BTreeMap::from([("d".to_owned(), false)]);
        self.tell(fit, &mut parameters, &mut identifiable);
        if let Some(balance) = &self.pitch_balance {
            self.tell(&balance.fit, &mut parameters, &mut identifiable);
            for &row in &balance.fit.free {
                if let Some(is_identified) = identifiable.get_mut(short_name(PARAMETERS[row].name)) {
                    *is_identified &= balance.is_identified;
                }
            }
            pinned.extend(balance.pinned.iter().map(|(name, pin)| (short_name(name).to_owned(), pin.clone())));
            let (below, se) = balance.cg_below_cb_m();
            let freedom =
                balance.fit.position("offset_mass_below_m").map_or(1.0, |i| balance.fit.degrees_of_freedom(i));
            parameters.insert("cg_below_cb_m".to_owned(), Some(Estimate::student(below, se, freedom, "m")));
            identifiable.insert("cg_below_cb_m".to_owned(), balance.is_identified);
        }
        for (short, pin) in &pinned {
            let row = parameter_index(long_name(short)).expect("a pinned parameter is a row");
            let held = Estimate::normal(pin.value, pin.se.unwrap_or(0.0), PARAMETERS[row].unit);
            parameters.insert(short.clone(), Some(held));
            identifiable.insert(short.clone(), false);
        }
        let correlations = correlation(&fit.whole_covariance());
        let (score, held) = match &self.inflections {
            Some(flown) => (flown.score, flown.held_out),
            None => (self.score, self.held_out.as_ref().map(|held_out| held_out.score)),
        };
        let legs: std::collections::BTreeSet<u32> =
            self.dives.iter().flat_map(|dive| dive.observations.iter().map(|o| o.leg)).collect();
        IdentifyReport {
            schema: "glidepolar.identify/1",
            method: "joint",
            vehicle: vehicle.name.clone(),
            trim: self.trim,
            trim_meaning: self.trim.sentence(),
            n_glides: legs.len(),
            n_samples: score.n,
            rows: BTreeMap::from([
                ("vertical_velocity", Rows::of_sink(&self.dives).worth(&self.fit.tally.sink)),
                ("speed", Rows::of_speed(&self.dives).worth(&self.fit.tally.speed)),
            ]),
            parameters,
            correlation: CorrelationTable {
                names: fit.free.iter().map(|&row| short_name(PARAMETERS[row].name).to_owned()).collect(),
                matrix: (0..n).map(|i| (0..n).map(|j| correlations[(i, j)]).collect()).collect(),
            },
            condition_number: condition_number(&super::Gram::sum(n, &fit.grams).normal_matrix()),
            identifiable,
            pinned,
            fit: FitQuality {
                w_rms_m_s: score.w_rms_m_s,
                w_rms_holdout_m_s: held.map(|score| score.w_rms_m_s),
                w_rms_9_point_m_s: score.w_rms_9_point_m_s,
                w_rms_9_point_holdout_m_s: held.and_then(|score| score.w_rms_9_point_m_s),
                speed_rms_m_s: score.speed_rms_m_s,
                speed_bias_m_s: score.speed_bias_m_s,
                speed_rms_holdout_m_s: held.and_then(|score| score.speed_rms_m_s),
                speed_bias_holdout_m_s: held.and_then(|score| score.speed_bias_m_s),
                pitch_rms_rad: self.pitch_balance.as_ref().map(|balance| balance.pitch_rms_rad),
                w_filter,
                correlated_samples: fit.tally.sink.correlated_samples(),
            },
            halves: self.halves(),
            legs_apart: self.legs.clone(),
            unsteady: self.inflections.as_ref().map(|flown| flown.comparison),
            turning: None,
            pitch_balance: self.pitch_balance.as_ref().map(PitchBalance::summary),
            lift_slope_profile: self.profile.clone(),
            warnings: self.warnings.clone(),
            notes,
        }
    }

    fn tell(
        &self,
        fit: &JointFit,
        parameters: &mut BTreeMap<String, Option<Estimate>>,
        identifiable: &mut BTreeMap<String, bool>,
    ) {
        for (i, &row) in fit.free.iter().enumerate() {
            let name = short_name(PARAMETERS[row].name).to_owned();
            let quantity =
                Estimate::student(fit.value(row), fit.se(i), fit.degrees_of_freedom(i), PARAMETERS[row].unit);
            parameters.insert(name.clone(), Some(quantity));
            identifiable.insert(name, is_identified(fit, i));
        }
    }
}
