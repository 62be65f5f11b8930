//! What the search for causes asks of a log: the residuals of a point and their slopes, what is believed of the polar, and from
//! where on a mechanism has a name. Knows no samples.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::common_drag::CommonDrag;
use super::flown::{AtRest, Flown};
use super::model::{self, Vehicle};
use super::path_share;
use super::pitch_reliability::{self, with_pitch_of_glider};
use super::{
    LEAST_KNOWN, LEAST_RELEVANT, Lift, SPEED, SeaProblem, Slopes, VERTICAL_VELOCITY, candidates, covariates,
    late_attitude, trim, unknown_temperature,
};
use crate::diagnose::evidence::{Candidate, Evidence, Point, Problem, Quantity, nuisance_prior};
use crate::dynamics::PARAMETERS;
use crate::identify::Bin;

/// Prior standard deviation of the logarithm of each coefficient of a vehicle's polar: the scatter of three published polars of one
/// design, the Slocum, on one area (see the test).
const PRIOR_SD_LN: [(&str, f64); 3] = [("a_per_rad", 0.80), ("b", 0.64), ("c_per_rad2", 1.51)];

/// Least width of the prior of a coefficient that the vehicle says is zero or below, on the frontal area.
const LEAST_PRIOR: f64 = 0.1;

/// Prior standard deviation of the share of the inertia about 1: masses that accelerate with the hull are known to a fifth, but a
/// log without inertia must be within reach.
const INERTIA_SHARE_SD: f64 = 1.0;

/// Share of what named mechanisms explain by which something unknown must explain more to take their place. Less is a part
/// that stays unexplained beside them: no sea is without.
const PART_UNEXPLAINED: f64 = 0.1;

/// Steps of the trim from which the baseline is fitted as well, to one prior standard deviation: a glider's net weight is 50 to 300 g,
/// and may be less on a slow leg.
const TRIM_STEP_KG: f64 = 0.02;
/// See [`TRIM_STEP_KG`].
const TRIM_STEPS: i32 = 10;

/// Probability by chance, corrected for the number of mechanisms, above which none is named: of logs with nothing hidden
/// one in a hundred may get a name.
const MOST_CHANCE: f64 = 0.01;

/// Largest number of mechanisms that are named together. If one log in ten has a given fault, which is an assumption, one in a thousand has
/// three. An effect outside the catalogue, which three together can imitate, is far more frequent.
const MAX_CAUSES: usize = 2;

/// Relative change of a size that is never one size: the square of what is left is 4 % of the effect.
const LARGE_CHANGE: f64 = 0.2;

impl Problem for SeaProblem {
    fn baseline(&self) -> &[(&'static str, &'static str)] {
        &self.baseline
    }

    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn start(&self) -> Point {
        let mut parameters = self.parameters;
        Point {
            baseline: self
                .baseline_index
                .iter()
                .map(|index| *parameters.at(*index))
                .chain((0..self.shear.len()).map(|_| 0.0))
                .chain(self.start_of_common_drag())
                .chain([1.0])
                .chain([1.0, path_share::START].into_iter().filter(|_| !self.is_quasi_steady()))
                .collect(),
            candidates: self.candidates.iter().map(|candidate| candidate.neutral.clone()).collect(),
        }
    }

    /// Where the trim was assumed the net weight may have another sign than it has.
    fn other_starts(&self) -> Vec<Point> {
        let start = self.start();
        let place = self.baseline.iter().position(|(name, _)| *name == trim::PARAMETER);
        let at = |step: i32| {
            let mut other = start.clone();
            other.baseline[place?] += f64::from(step) * TRIM_STEP_KG;
            Some(other)
        };
        (-TRIM_STEPS..=TRIM_STEPS).filter(|step| *step != 0).filter_map(at).collect()
    }

    fn is_strongly_nonlinear(&self) -> bool {
        true
    }

    /// Where a glider turns over, what it read half a minute ago is of another leg.
    fn is_strongly_nonlinear_in(&self, candidate: usize) -> bool {
        self.is_held_in_first_search(candidate)
    }

    /// Thermoclines and inertia inside the bins are nine tenths of a flight, and change what a bin reads by little.
    fn for_first_search(&self, about: &Point) -> Option<Self> {
        let within = || self.within_at(about, self.shifted(&self.parameters_at(about)).as_deref());
        self.within.is_none().then(|| SeaProblem { within: Some(within()), ..self.clone() })
    }

    /// Where a glider turns over, the pitch of another time changes most inside the bins, and what was read before a leg is where a late
    /// pressure begins it.
    fn is_held_in_first_search(&self, candidate: usize) -> bool {
        [late_attitude::MECHANISM, "pressure_lag"].contains(&self.candidates[candidate].name)
    }

    fn has_slow_slopes(&self, candidate: usize) -> bool {
        matches!(self.shapes[candidate].slopes, Slopes::LateAttitude)
    }

    fn has_regimes(&self) -> bool {
        true
    }

    fn has_record_over_time(&self) -> bool {
        true
    }

    fn level_of(&self, candidate: usize) -> Option<usize> {
        let has_level = candidates::WITH_A_LEVEL.contains(&self.candidates[candidate].name);
        has_level.then(|| self.candidates.iter().position(|other| other.name == "ballast_offset")).flatten()
    }

    fn is_level(&self, candidate: usize) -> bool {
        candidates::LEVELS.contains(&self.candidates[candidate].name)
    }

    fn is_mean_of_a_quantity(&self, candidate: usize) -> bool {
        self.candidates[candidate].name == "vertical_current"
    }

    fn part_unexplained(&self) -> f64 {
        PART_UNEXPLAINED
    }

    fn most_chance(&self) -> f64 {
        MOST_CHANCE
    }

    fn max_causes(&self) -> usize {
        MAX_CAUSES
    }

    fn needs_both_legs(&self) -> bool {
        true
    }

    fn baseline_takes_up_changes(&self) -> bool {
        true
    }

    fn large_change(&self, _candidate: usize) -> f64 {
        LARGE_CHANGE
    }

    fn least_known(&self, candidate: usize) -> f64 {
        if candidates::WITH_OWN_CHANNEL.contains(&self.candidates[candidate].name) { 0.0 } else { LEAST_KNOWN }
    }

    fn relevance(&self, quantity: &Quantity, scatter: f64) -> f64 {
        let floor = LEAST_RELEVANT.iter().find(|(name, _)| *name == quantity.name).map_or(0.0, |(_, floor)| *floor);
        self.relevance.limit(quantity.name, scatter, floor)
    }

    /// Lift and drag grow with the angle of attack, and drag is no thrust: a polar that begins so stays so.
    fn stepped(&self, place: usize, value: f64, step: f64) -> f64 {
        if self.is_positive(place) { value * (step / value).exp() } else { value + step }
    }

    fn admits(&self, point: &Point) -> bool {
        (0..self.baseline_index.len()).all(|place| !self.is_positive(place) || point.baseline[place].is_normal())
    }

    fn evidence(&self, point: &Point) -> Evidence {
        let all: Vec<usize> = (0..self.candidates.len()).collect();
        self.evidence_of(point, &all)
    }

    fn evidence_of(&self, point: &Point, included: &[usize]) -> Evidence {
        glidepolar_progress::one_more("flights of the model");
        let parameters = self.parameters_at(point);
        let (n_w, n_u) = (self.bins.len(), self.with_speed.len());
        let n = n_w + n_u;
        let (share, path_share) = (self.inertia_share(point), self.path_share(point));
        let shifted = self.shifted(&parameters);
        let mut past = self.effects(point, &parameters);
        let flown = self.within.is_none().then(|| self.within_with_past(point, shifted.as_deref(), past.as_ref()));
        if flown.is_some() || self.is_quasi_steady() {
            // What was flown through the parts of each bin is late already, and a glider without inertia never is.
            past.iter_mut().flatten().for_each(|effect| effect.late_net_mass_kg = effect.net_mass_kg);
        }
        let (inside, at_rest) = flown.as_ref().or(self.within.as_ref()).expect("one of the two");
        let bins = shifted.as_ref().map_or(&self.bins, |shifted| &shifted.bins);
        let pitch_rates = shifted.as_ref().map_or(&*self.pitch_rates, |shifted| &shifted.pitch_rates);
        let deviations_rad = pitch_reliability::deviations_rad(bins);
        let reliability = point.baseline[self.place_of_reliability()];
        let row_bins: Vec<&Bin> = bins.iter().chain(self.with_speed.iter().map(|i| &bins[*i])).collect();

        let mut residual = DVector::zeros(n);
        let mut slopes = DMatrix::zeros(n, self.directions.len());
        let mut speed_row = n_w;
        let vehicle = Vehicle::new(&parameters, &self.directions, &self.varied(included));
        // What the whole of the inertia changes in each row.
        let mut by_inertia = DVector::zeros(n);
        // What a force along the heading changes in each row [m/s per N].
        let mut by_force = DVector::zeros(n);
        let flown = |row: usize| {
            let mut bin = with_pitch_of_glider(&bins[row], deviations_rad[row], reliability);
            // A path that follows the pitch at once is ahead of the one that was read for it.
            bin.mean.pitch_rad += (1.0 - path_share) * self.follows_s[row] * pitch_rates[row];
            let inside_at_rest = share.zip(at_rest.as_ref().map(|at_rest| &at_rest[row]));
            let at_rest = inside_at_rest.map(|(share, inside)| AtRest { share, inside });
            let effect = past.as_ref().map(|effects| effects[row]).unwrap_or_default();
            Flown::new(&vehicle, self.pitch_direction, &bin, &inside[row], at_rest.as_ref(), &effect)
        };
        let flown: Vec<Flown> = (0..n_w).into_par_iter().map(flown).collect();
        for (row, (bin, flown)) in bins.iter().zip(&flown).enumerate() {
            residual[row] = bin.mean.sink_m_s - flown.sink.value;
            slopes.row_mut(row).copy_from_slice(&flown.sink.slopes);
            (by_inertia[row], by_force[row]) = (flown.by_inertia[0], flown.by_force[0]);
            if self.with_speed.get(speed_row - n_w) == Some(&row) {
                let scale = parameters.speed_scale;
                residual[speed_row] = bin.mean.speed_m_s - scale * flown.speed.value;
                slopes.row_mut(speed_row).copy_from_slice(&flown.speed.slopes);
                slopes.row_mut(speed_row).scale_mut(scale);
                (by_inertia[speed_row], by_force[speed_row]) = (scale * flown.by_inertia[1], scale * flown.by_force[1]);
                speed_row += 1;
            }
        }

        let nb = self.baseline_index.len();
        let bin_of = |row: usize| if row < n_w { row } else { self.with_speed[row - n_w] };
        let mut baseline = slopes.columns(0, nb).into_owned().resize_horizontally(self.baseline.len(), 0.0);
        let mass_kg = parameters.mass_kg();
        for j in 0..self.shear.len() {
            let of_row = |row: usize| by_force[row] * self.shear.unit_N(j, bin_of(row), mass_kg);
            baseline.set_column(nb + j, &DVector::from_fn(n, |row, _| of_row(row)));
        }
        self.add_common_drag(&mut baseline, &slopes, point);
        let by_reliability =
            |row: usize| parameters.pitch_scale * deviations_rad[bin_of(row)] * slopes[(row, self.pitch_direction)];
        baseline.set_column(self.place_of_reliability(), &DVector::from_fn(n, |row, _| by_reliability(row)));
        if share.is_some() {
            baseline.set_column(self.place_of_inertia(), &by_inertia);
            let of_log_odds = path_share::slope(point.baseline[self.place_of_path()]);
            let by_path = |row: usize| {
                let late_rad = self.follows_s[bin_of(row)] * pitch_rates[bin_of(row)];
                of_log_odds * (-parameters.pitch_scale * late_rad * slopes[(row, self.pitch_direction)])
            };
            baseline.set_column(self.place_of_path(), &DVector::from_fn(n, |row, _| by_path(row)));
        }
        // The share of a change of the net mass that the glider follows late.
        let follows_late = share.unwrap_or(if self.is_quasi_steady() { 0.0 } else { 1.0 });
        let candidates = self
            .shapes
            .iter()
            .zip(&self.candidates)
            .enumerate()
            .map(|(index, (shape, candidate))| match &shape.slopes {
                _ if !included.contains(&index) => DMatrix::zeros(n, 1),
                Slopes::Direction(direction) => {
                    let after =
                        |row: usize| candidate.version.is_none_or(|jump| row_bins[row].mean.time_s >= jump.value);
                    DMatrix::from_fn(n, 1, |row, _| if after(row) { slopes[(row, *direction)] } else { 0.0 })
                }
                Slopes::Compressed { held, .. } if self.within.is_some() => slopes.columns(*held, 1).into_owned(),
                Slopes::Compressed { columns: [at_rest, late], offset, .. } => {
                    let acts = |bin: usize| at_rest[bin] + follows_late * (late[bin] - at_rest[bin]);
                    DMatrix::from_fn(n, 1, |row, _| acts(bin_of(row)) * slopes[(row, *offset)])
                }
                Slopes::LateAttitude => self.by_late_attitude(point, index),
                Slopes::Speed => {
                    DMatrix::from_fn(n, 1, |row, _| if row < n_w { 0.0 } else { flown[bin_of(row)].speed.value })
                }
                Slopes::Past { columns: [at_rest, late], carrier: Some(direction) } => {
                    // Carried water has inertia, which takes part where the inertia is flown anew.
                    let mass_kg = parameters.mass_kg() + parameters.added_mass_1_kg;
                    let heavier = match candidate.name {
                        "carried_water" if self.within.is_none() => parameters.reference_density_kg_m3 / mass_kg,
                        _ => 0.0,
                    };
                    DMatrix::from_fn(n, 1, |row, _| {
                        let bin = bin_of(row);
                        (at_rest[bin] + follows_late * (late[bin] - at_rest[bin])) * slopes[(row, *direction)]
                            + follows_late * heavier * by_inertia[row]
                    })
                }
                Slopes::Past { columns: [at_rest, _], carrier: None } => {
                    DMatrix::from_fn(n, 1, |row, _| if row < n_w { at_rest[row] * flown[row].sink.value } else { 0.0 })
                }
            })
            .collect();
        let mut quantities =
            vec![Quantity { name: VERTICAL_VELOCITY, unit: "m/s", rows: 0..n_w, joined_s: self.joined_s }];
        if n_u > 0 {
            quantities.push(Quantity { name: SPEED, unit: "m/s", rows: n_w..n, joined_s: 0.0 });
        }
        let shared = match self.ballast_direction() {
            Some(direction) => model::WEIGHING_ERROR_KG * slopes.columns(direction, 1),
            None => DMatrix::zeros(n, 0),
        };
        Evidence {
            quantities,
            time_s: row_bins.iter().map(|bin| bin.mean.time_s).collect(),
            stated_sd: row_bins
                .iter()
                .enumerate()
                .map(|(row, bin)| if row < n_w { bin.sink_sd_m_s } else { bin.speed_sd_m_s })
                .collect(),
            block: row_bins.iter().map(|bin| bin.mean.leg as usize).collect(),
            leg: row_bins.iter().map(|bin| if bin.mean.descends() { 1.0 } else { -1.0 }).collect(),
            place: covariates::places(&row_bins),
            residual,
            baseline,
            baseline_without: None,
            prior: self.prior(point),
            candidates,
            shared,
            covariates: covariates::from_bins(&row_bins),
            decorrelation: None,
        }
    }
}

impl SeaProblem {
    /// The directions in which the slopes of the baseline, of what the rows share and of these candidates lie.
    fn varied(&self, included: &[usize]) -> Vec<usize> {
        let of_candidate = |member: &usize| match self.shapes[*member].slopes {
            Slopes::Compressed { held, .. } if self.within.is_some() => Some(held),
            Slopes::Direction(direction)
            | Slopes::Past { carrier: Some(direction), .. }
            | Slopes::Compressed { offset: direction, .. } => Some(direction),
            Slopes::Past { carrier: None, .. } | Slopes::LateAttitude | Slopes::Speed => None,
        };
        let mut varied: Vec<usize> = (0..self.baseline_index.len())
            .chain([self.pitch_direction])
            .chain(self.common_drag.map(CommonDrag::direction))
            .chain(self.ballast_direction())
            .chain(included.iter().filter_map(of_candidate))
            .collect();
        varied.sort_unstable();
        varied.dedup();
        varied
    }

    /// What a second by which the attitude is late changes in each row, as a difference quotient of whole flights: where a glider turns
    /// over, the pitch that is read some seconds later moves what happens inside a bin, and with it the inertia, as much as its mean.
    fn by_late_attitude(&self, point: &Point, candidate: usize) -> DMatrix<f64> {
        let residual_at = |step_s: f64| {
            let mut there = point.clone();
            there.candidates[candidate][0] += step_s;
            self.evidence_of(&there, &[]).residual
        };
        let (sooner, later) =
            rayon::join(|| residual_at(-late_attitude::STEP_S), || residual_at(late_attitude::STEP_S));
        let column = (sooner - later) / (2.0 * late_attitude::STEP_S);
        DMatrix::from_column_slice(column.len(), 1, column.as_slice())
    }

    /// The direction of an offset of the net mass, where it is a candidate.
    fn ballast_direction(&self) -> Option<usize> {
        let place = self.candidates.iter().position(|candidate| candidate.name == "ballast_offset")?;
        match self.shapes[place].slopes {
            Slopes::Direction(direction) => Some(direction),
            _ => None,
        }
    }

    /// The same problem with other standard errors of the vehicle's polar, over its values; none where nothing is stated.
    pub(super) fn with_polar_errors(&self, polar_se: [Option<f64>; 3]) -> SeaProblem {
        SeaProblem { polar_se, ..self.clone() }
    }

    /// What the vehicle's own polar says of the polar. It keeps a baseline that lacks the true cause from running off to a polar
    /// that no hull has. What is positive is believed by its logarithm, linearised at this point: `ln(v / v0) / sd` has the slope
    /// `1 / (v sd)`.
    fn prior(&self, point: &Point) -> Vec<(f64, f64)> {
        let mut believed = self.parameters;
        let values = self.baseline_index.iter().zip(&point.baseline).enumerate();
        values
            .map(|(place, (index, value))| {
                let belief = *believed.at(*index);
                let name = PARAMETERS[*index].name;
                let of_polar = PRIOR_SD_LN.iter().zip(self.polar_se).find(|((known, _), _)| *known == name);
                let sd_ln = of_polar.map_or(1.0, |((_, sd), stated)| stated.map_or(*sd, |stated| stated.min(*sd)));
                match (self.lift, name) {
                    (Lift::Known { se_per_rad }, "a_per_rad") => (belief - value, se_per_rad),
                    (_, unknown_temperature::PARAMETER) => {
                        let [share, sd] = unknown_temperature::SHARE;
                        (share * belief - value, sd * belief.abs())
                    }
                    (_, trim::PARAMETER) => (belief - value, trim::prior_sd_kg()),
                    _ if self.is_positive(place) => (-value * (value / belief).ln(), sd_ln * value),
                    _ => (belief - value, sd_ln * belief.abs().max(LEAST_PRIOR)),
                }
            })
            .chain(self.shear_coefficients(point).iter().map(|value| nuisance_prior(*value, 1.0)))
            .chain(self.prior_of_common_drag(point))
            .chain([pitch_reliability::prior(point.baseline[self.place_of_reliability()])])
            .chain(self.inertia_share(point).map(|share| (1.0 - share, INERTIA_SHARE_SD)))
            .chain(point.baseline.get(self.place_of_path()).map(|log_odds| path_share::prior(*log_odds)))
            .collect()
    }

    /// Whether this parameter of the baseline is a coefficient of the polar that the vehicle says is positive.
    fn is_positive(&self, place: usize) -> bool {
        let mut believed = self.parameters;
        self.baseline_index.get(place).is_some_and(|index| {
            matches!(PARAMETERS[*index].name, "a_per_rad" | "b" | "c_per_rad2") && *believed.at(*index) > 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    /// Three polars of the Slocum on the frontal area of its hull: Graver 2005 and vehicle 049, whose files come with the project, and
    /// Merckelbach et al. 2019: hull and wings 3.8 and 3.7 per rad, 0.15 and 10 per rad2 on 0.1 m2.
    #[test]
    fn published_polars_of_one_design_scatter_by_the_widths_of_the_prior() {
        let of = |name: &str| {
            let vehicle = crate::vehicle::Vehicle::load(name).expect("a built-in vehicle");
            ["a_per_rad", "b", "c_per_rad2"].map(|key| vehicle.get(&format!("hydro.{key}")).expect("a polar"))
        };
        let on_frontal_area = 0.1 / 0.03563;
        let polars = [of("slocum-graver"), of("slocum-049"), [7.5, 0.15, 10.0].map(|value| value * on_frontal_area)];
        let variance = |place: usize| {
            let logs = polars.map(|polar| polar[place].ln());
            let mean = logs.iter().sum::<f64>() / 3.0;
            logs.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 2.0
        };
        for (place, (name, sd)) in super::PRIOR_SD_LN.iter().enumerate() {
            assert!((variance(place).sqrt() - sd).abs() < 0.01, "{name}: {} against {sd}", variance(place).sqrt());
        }
    }
}
