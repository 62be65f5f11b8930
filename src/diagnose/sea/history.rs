//! Mechanisms that go by what the glider met before: columns made once from the whole log.
//!
//! A steady glide knows the water around it, not the water an hour ago. What a mechanism keeps of the past is one column: the
//! change of net mass or of the pressure's reading that a unit of its size makes in each bin. With `y` the lag
//! of a quantity `x`, `dy/dt = (x - y) / tau` (exact for straight lines between samples),
//! ```text
//! hull_creep             net mass   rho V lag(P, creep_time)                     standard linear solid, its late part
//! late_expansion         net mass   -rho V (lag(T, expansion_time) - T)          the slowest part of conduction into the hull
//! carried_water          net mass   lag(s, exchange_time) - s                    s = rho / (1 + kappa P), water brought to p = 0
//! pump_leakback          net mass   rho t_stopped                                since the ballast volume last changed
//! conductivity_drift     net mass   -V (d rho / d S) t
//! thermal_lag            net mass   V (d rho / d S) (d S / d T at one conductivity) dT/dt
//! pressure_hysteresis    reading    sink 4 (1 - 2 P / P_turn) on ascents         an error h 4 P (1 - P / P_turn), a parabola
//! shear                  weight     -m dU/dt met along the heading, beside m0 g       no size: by the log's own current
//! ```
//! The force of a shear turns the weight of the steady glide by `-atan(F / (m0 g))` and lengthens it; the glider follows it
//! late by `M V / (2 D)`, as any change of its speed.
//!
//! Net mass is linear in each, so a column times the slope along the ballast offset is the slope along the mechanism's size,
//! exactly. Time constants are not fitted: each one is a version of its mechanism. Knows observations and bins.

use std::sync::Arc;

use super::past::{Past, integral, lagged, lagged_by};
use crate::dynamics::Parameters;
use crate::dynamics::buoyancy::{ATMOSPHERE_PA, WATER_COMPRESSIBILITY_PER_PA};
use crate::identify::Bin;
use crate::log::{DensitySlopes, Observation, density_slopes};

/// Change of density with practical salinity \[kg/m3\]: 0.77 at 35 and 10 degC, 0.80 at 0 degC, 0.75 at 25 degC (EOS-80).
pub(super) const DENSITY_PER_SALINITY: f64 = 0.77;

/// Change of the salinity that is computed from one conductivity with the temperature that is taken for the cell's \[1/K\]:
/// -0.98 at 35 and 10 degC (PSS-78).
pub(super) const SALINITY_PER_KELVIN: f64 = 0.98;

/// Neighbours farther apart are not of one stretch \[s\], and what a mean alone lasts \[s\].
const LONGEST_SPAN_S: f64 = 120.0;
const LONE_SPAN_S: f64 = 5.0;

/// What a mechanism acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// The net mass \[kg\].
    NetMass,
    /// The reading of the vertical velocity, in its own share.
    Reading,
}

/// Mechanism, the row of its size, what it acts on.
const MECHANISMS: [(&str, &str, Acts); 7] = [
    ("hull_creep", "hull_creep_per_Pa", Acts::NetMass),
    ("late_expansion", "late_expansion_per_K", Acts::NetMass),
    ("carried_water", "carried_water_m3", Acts::NetMass),
    ("pump_leakback", "pump_leakback_cc_per_hour", Acts::NetMass),
    ("conductivity_drift", "salinity_drift_per_day", Acts::NetMass),
    ("thermal_lag", "thermal_lag_s", Acts::NetMass),
    ("pressure_hysteresis", "pressure_hysteresis", Acts::Reading),
];

/// What a mechanism of this name acts on, where it goes by the past.
pub fn acts(mechanism: &str) -> Option<Acts> {
    MECHANISMS.iter().find(|(name, ..)| *name == mechanism).map(|(.., acts)| *acts)
}

/// The past of every bin of a log.
#[derive(Debug, Clone)]
pub struct History {
    past: Arc<Past>,
    /// For each bin, which of the samples of the past are its own.
    of_bin: Vec<Vec<usize>>,
    /// Volume that the hull displaces at the surface \[m3\].
    volume_m3: f64,
}

impl History {
    /// The past of these bins, which are made of steady ones of these samples.
    pub fn new(bins: &[Bin], samples: &[Observation], parameters: &Parameters<f64>) -> History {
        let past = Past::new(samples);
        let of_bin = bins
            .iter()
            .map(|bin| {
                // A bin knows its mean time and its leg; its samples are those of the leg as far around as it has samples.
                let on_leg = |i: &usize| samples[*i].leg == bin.mean.leg && samples[*i].steady;
                let near = past.time_s.partition_point(|time| *time < bin.mean.time_s);
                let first = near.saturating_sub(bin.samples / 2);
                let own: Vec<usize> = (first..(first + bin.samples).min(samples.len())).filter(on_leg).collect();
                if own.is_empty() { vec![near.min(samples.len() - 1)] } else { own }
            })
            .collect();
        let volume_m3 = parameters.displaced_mass_kg / parameters.reference_density_kg_m3;
        History { past: Arc::new(past), of_bin, volume_m3 }
    }

    /// The column of a mechanism: what a unit of its size does to each bin, with the time constants of these parameters.
    pub fn column(&self, mechanism: &str, bins: &[Bin], parameters: &Parameters<f64>) -> Vec<f64> {
        match mechanism {
            "conductivity_drift" => {
                let per_day = |bin: &Bin| slopes_at(&bin.mean).per_salinity * bin.mean.time_s / 86_400.0;
                bins.iter().map(|bin| -self.volume_m3 * per_day(bin)).collect()
            }
            "thermal_lag" => {
                let rates = self.rates(&self.past.temperature_C).into_iter().zip(bins);
                rates.map(|(rate, bin)| self.per_thermal_rate(bin) * rate).collect()
            }
            "pressure_hysteresis" => {
                let past = &*self.past;
                let share = |i: usize| {
                    if past.descends[i] || past.turn_Pa[i] <= 0.0 {
                        0.0
                    } else {
                        4.0 * (1.0 - 2.0 * past.pressure_Pa[i] / past.turn_Pa[i])
                    }
                };
                self.means(&(0..past.time_s.len()).map(share).collect::<Vec<f64>>())
            }
            _ => self.net_masses_kg(mechanism, parameters).map_or(vec![0.0; bins.len()], |kg| self.means(&kg)),
        }
    }

    /// The same as a glider follows it that takes so long at each sample to change its speed \[s\].
    pub(super) fn late_column(
        &self,
        mechanism: &str,
        bins: &[Bin],
        parameters: &Parameters<f64>,
        slow_s: &[f64],
    ) -> Vec<f64> {
        if let Some(kg) = self.net_masses_kg(mechanism, parameters) {
            return self.late(&kg, slow_s);
        }
        if mechanism == "thermal_lag" {
            // The rate of what follows a quantity late is what it is behind, over the time.
            let now = &self.past.temperature_C;
            let late = lagged_by(&self.past.time_s, now, |i| slow_s[i]);
            let rate = |i: usize| if slow_s[i] > 0.0 { (now[i] - late[i]) / slow_s[i] } else { 0.0 };
            let rates = self.means(&(0..now.len()).map(rate).collect::<Vec<f64>>());
            return rates.iter().zip(bins).map(|(rate, bin)| self.per_thermal_rate(bin) * rate).collect();
        }
        self.column(mechanism, bins, parameters)
    }

    /// What a unit of a mechanism's size adds to the net mass at every sample \[kg\]; none where it goes by nothing that changes within
    /// a bin, or is no net mass.
    fn net_masses_kg(&self, mechanism: &str, parameters: &Parameters<f64>) -> Option<Vec<f64>> {
        let past = &*self.past;
        let density = &past.density_kg_m3;
        let found = match mechanism {
            "hull_creep" => {
                let late = lagged(&past.time_s, &past.pressure_Pa, parameters.creep_time_s);
                late.iter().zip(density).map(|(late, density)| density * self.volume_m3 * late).collect()
            }
            "late_expansion" => {
                let late = lagged(&past.time_s, &past.temperature_C, parameters.expansion_time_s);
                let warmer = late.iter().zip(&past.temperature_C).map(|(late, around)| late - around);
                warmer.zip(density).map(|(warmer, density)| -density * self.volume_m3 * warmer).collect()
            }
            "carried_water" => {
                let at_surface: Vec<f64> = density
                    .iter()
                    .zip(&past.pressure_Pa)
                    .map(|(density, pressure)| density / (1.0 + WATER_COMPRESSIBILITY_PER_PA * pressure))
                    .collect();
                let carried = lagged(&past.time_s, &at_surface, parameters.exchange_time_s);
                carried.iter().zip(&at_surface).map(|(carried, around)| carried - around).collect()
            }
            // The model compresses it at the mean of a bin and of each part; this is the mean of what acts, to first order.
            "trapped_air" => {
                let volume_m3 = |pressure: &f64| 1e-6 * ATMOSPHERE_PA / (pressure.max(0.0) + ATMOSPHERE_PA);
                past.pressure_Pa.iter().map(volume_m3).zip(density).map(|(volume, density)| -density * volume).collect()
            }
            "pump_leakback" => {
                past.stopped_s.iter().zip(density).map(|(stopped, density)| density * 1e-6 * stopped / 3600.0).collect()
            }
            _ => return None,
        };
        Some(found)
    }

    /// What all mechanisms of the past at these parameters add to the net mass in each of these means of some seconds of the log
    /// \[kg\]; nothing where they add nothing.
    pub fn added_kg(&self, means: &[Observation], bins: &[Bin], parameters: &Parameters<f64>) -> Option<Vec<f64>> {
        let mut added: Option<Vec<f64>> = None;
        let spans = spans_s(means);
        for (mechanism, size, _) in acting(parameters).filter(|(.., acts)| *acts == Acts::NetMass) {
            let of_unit = self.unit_in_means(mechanism, means, &spans, bins, parameters);
            let added = added.get_or_insert_with(|| vec![0.0; means.len()]);
            added.iter_mut().zip(of_unit).for_each(|(added, of_unit)| *added += size * of_unit);
        }
        added
    }

    /// What a unit of a mechanism's size adds to the net mass in each of these means, which last these spans of time.
    fn unit_in_means(
        &self,
        mechanism: &str,
        means: &[Observation],
        spans_s: &[[f64; 2]],
        bins: &[Bin],
        parameters: &Parameters<f64>,
    ) -> Vec<f64> {
        if let Some(kg) = self.net_masses_kg(mechanism, parameters) {
            let sum = integral(&self.past.time_s, &kg);
            return spans_s.iter().map(|span| self.past.slope_of(&sum, span)).collect();
        }
        let nearest = |mean: &Observation| {
            let next = bins.partition_point(|bin| bin.mean.time_s < mean.time_s);
            let apart = |i: &usize| (bins[*i].mean.time_s - mean.time_s).abs();
            let neighbours = next.saturating_sub(1)..(next + 1).min(bins.len());
            neighbours.min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("a log has bins")
        };
        if mechanism == "thermal_lag" {
            let rates = spans_s.iter().map(|span| self.past.slope_of(&self.past.temperature_C, span));
            return means
                .iter()
                .zip(rates)
                .map(|(mean, rate)| self.per_thermal_rate(&bins[nearest(mean)]) * rate)
                .collect();
        }
        let column = self.column(mechanism, bins, parameters);
        means.iter().map(|mean| column[nearest(mean)]).collect()
    }

    /// What a late thermometer adds to the net mass where the water warms by this much a second \[kg s/K\].
    fn per_thermal_rate(&self, bin: &Bin) -> f64 {
        self.volume_m3 * slopes_at(&bin.mean).per_cell_K
    }

    /// Mean over the samples of each bin.
    fn means(&self, values: &[f64]) -> Vec<f64> {
        self.of_bin.iter().map(|own| own.iter().map(|i| values[*i]).sum::<f64>() / own.len() as f64).collect()
    }

    /// What the glider meets of a shear in each bin, late by the time in which it follows; nothing where the log has no current.
    pub(super) fn met_m_s2(&self, bins: &[Bin], samples: &[Observation], slow_s: &[f64]) -> Option<Vec<f64>> {
        let met: Vec<f64> =
            samples.iter().map(|o| if o.water_met_m_s2.is_finite() { o.water_met_m_s2 } else { 0.0 }).collect();
        let is_known = met.iter().any(|met| *met != 0.0) && !bins.is_empty();
        is_known.then(|| self.late(&met, slow_s))
    }

    /// Mean over each bin of what the glider follows late.
    pub(super) fn late(&self, values: &[f64], slow_s: &[f64]) -> Vec<f64> {
        self.means(&lagged_by(&self.past.time_s, values, |i| slow_s[i]))
    }

    /// Mean rate of a quantity over the samples of each bin: that of a thermocline that is crossed within seconds is what it changes over
    /// the bin's time, wherever in the bin it lies. A least-squares slope would be half as large again in the middle.
    fn rates(&self, values: &[f64]) -> Vec<f64> {
        let time_s = &self.past.time_s;
        let rate = |own: &Vec<usize>| {
            let (first, last) = (own[0].saturating_sub(1), (own[own.len() - 1] + 1).min(values.len() - 1));
            // From half a step before the first sample to half a step behind the last.
            let middle = |of: &[f64], i: usize, j: usize| 0.5 * (of[i] + of[j]);
            let change = |of: &[f64]| middle(of, own[own.len() - 1], last) - middle(of, first, own[0]);
            let rate = change(values) / change(time_s);
            if rate.is_finite() { rate } else { 0.0 }
        };
        self.of_bin.iter().map(rate).collect()
    }
}

/// From when to when each of these means of some seconds lasts \[s\]: half way to its neighbours on the leg.
fn spans_s(means: &[Observation]) -> Vec<[f64; 2]> {
    let step = |i: usize, j: usize| {
        let (a, b) = (means.get(i)?, means.get(j)?);
        let step_s = b.time_s - a.time_s;
        (a.leg == b.leg && step_s > 0.0 && step_s <= LONGEST_SPAN_S).then_some(0.5 * step_s)
    };
    let of_one = |i: usize| {
        let (before, after) = (step(i.wrapping_sub(1), i), step(i, i + 1));
        let (before_s, after_s) = match (before, after) {
            (Some(before), Some(after)) => (before, after),
            (Some(alone), None) | (None, Some(alone)) => (alone, alone),
            (None, None) => (0.5 * LONE_SPAN_S, 0.5 * LONE_SPAN_S),
        };
        [means[i].time_s - before_s, means[i].time_s + after_s]
    };
    (0..means.len()).map(of_one).collect()
}

/// The mechanisms of the past that act at these parameters: name, size, what they act on.
pub(super) fn acting(parameters: &Parameters<f64>) -> impl Iterator<Item = (&'static str, f64, Acts)> {
    let mut sizes = *parameters;
    MECHANISMS.iter().filter_map(move |(mechanism, row, acts)| {
        let size = crate::dynamics::parameter_index(row).map_or(0.0, |index| *sizes.at(index));
        (size != 0.0).then_some((*mechanism, size, *acts))
    })
}

/// How the density goes with what the CTD measures there; as in usual water where the log's own density and temperature are of no sea water.
fn slopes_at(mean: &Observation) -> DensitySlopes {
    density_slopes(mean.density_kg_m3, mean.temperature_C, mean.pressure_dbar).unwrap_or(DensitySlopes {
        per_salinity: DENSITY_PER_SALINITY,
        per_cell_K: -DENSITY_PER_SALINITY * SALINITY_PER_KELVIN,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::diagnose::Problem;
    use crate::diagnose::sea::steady_log::log;
    use crate::diagnose::sea::time_constants::versions;
    use crate::diagnose::sea::{DiagnosisSettings, SeaProblem};
    use crate::vehicle::Vehicle;

    /// The column of a candidate is how the residuals change with its size, with what happens inside the bins held.
    #[test]
    fn every_column_is_the_change_of_what_is_read_with_the_size() {
        let mut parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        parameters.hull_thermal_expansion_per_K = 7e-5;
        let flown = SeaProblem::new(&log(&parameters), &parameters, DiagnosisSettings::default()).expect("enough bins");
        let start = flown.start();
        let problem = flown.for_first_search(&start).expect("not held yet");
        let before = problem.evidence(&start);
        let sizes = [1e-11, 1e-6, 3e-4, 0.5, 0.02, 0.1, 1e-3];
        for ((name, ..), size) in MECHANISMS.iter().zip(sizes) {
            let of_name = (0..problem.candidates().len()).filter(|c| problem.candidates()[*c].name == *name);
            let of_name: Vec<usize> = of_name.collect();
            assert_eq!(of_name.len(), versions(name, None).len(), "{name}");
            for c in of_name {
                let mut point = start.clone();
                point.candidates[c][0] += size;
                let after = problem.evidence(&point);
                let column = before.candidates[c].column(0);
                let most = column.amax() * size;
                let off = (&before.residual - &after.residual - column * size).amax();
                assert!(most > 1e-5 && off < 0.03 * most, "{name}: {off} of {most} m/s");
            }
        }
    }

    /// Trapped air is compressed much within a bin near the surface. The column is what whole flights change by; the slope at the means of
    /// the bins is not.
    #[test]
    fn the_column_of_trapped_air_is_what_flights_change_by() {
        let mut parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        parameters.hull_thermal_expansion_per_K = 7e-5;
        let problem =
            SeaProblem::new(&log(&parameters), &parameters, DiagnosisSettings::default()).expect("enough bins");
        let air =
            problem.candidates().iter().position(|candidate| candidate.name == "trapped_air").expect("a candidate");
        let start = problem.start();
        let mut point = start.clone();
        point.candidates[air][0] += 2.0;
        let before = problem.evidence(&start);
        let change = (&before.residual - problem.evidence(&point).residual) / 2.0;
        let off = |column: &DMatrix<f64>| (&change - column.column(0)).norm() / change.norm();
        let held = problem.for_first_search(&start).expect("not held yet").evidence(&start);
        let [of_column, at_means] = [&before, &held].map(|evidence| off(&evidence.candidates[air]));
        assert!(of_column < 0.05 && of_column < 0.5 * at_means, "{of_column} beside {at_means}");
    }

    /// What is flown through the parts of a bin is on average what acts on the bin, and follows a change as late as the column says, to a
    /// quarter: the column has one time for a leg.
    #[test]
    fn what_the_past_adds_is_flown_through_the_parts_of_each_bin() {
        let mut vehicle = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        vehicle.hull_thermal_expansion_per_K = 7e-5;
        let problem = SeaProblem::new(&log(&vehicle), &vehicle, DiagnosisSettings::default()).expect("enough bins");
        let start = problem.start();
        let before = problem.evidence(&start);
        for (name, row, size) in
            [("late_expansion", "late_expansion_per_K", 1e-6), ("carried_water", "carried_water_m3", 3e-4)]
        {
            let mut parameters = vehicle;
            *parameters.at(crate::dynamics::parameter_index(row).expect("a row")) = size;
            (parameters.expansion_time_s, parameters.exchange_time_s) = (1200.0, 1200.0);
            let added = problem.past.added_kg(problem.parts.means(), &problem.bins, &parameters).expect("it acts");
            let column = problem.past.history.column(name, &problem.bins, &parameters);
            let most = size * column.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            for (parts, value) in problem.parts.of_bins().zip(&column) {
                let mean = parts.iter().map(|(part, share)| share * added[*part]).sum::<f64>();
                assert!((mean - size * value).abs() < 0.01 * most, "{name}: {mean} and {} kg", size * value);
            }

            let is_version = |c: &usize| {
                let candidate = &problem.candidates()[*c];
                candidate.name == name && candidate.version.is_some_and(|version| version.value == 1200.0)
            };
            let c = (0..problem.candidates().len()).find(is_version).expect("a version");
            let mut point = start.clone();
            point.candidates[c][0] = size;
            let change = &before.residual - problem.evidence(&point).residual;
            let mut at_rest = start.clone();
            at_rest.baseline[problem.place_of_inertia()] = 0.0;
            let of_rest = problem.evidence(&at_rest).candidates[c].column(0) * size;
            let late = before.candidates[c].column(0) * size;
            let (behind, off) = ((&late - of_rest).amax(), (&late - change).amax());
            assert!(behind > 3e-5 && off < 0.25 * behind, "{name}: {off} of {behind} m/s");
        }
    }

    /// A thermocline that is crossed between two samples: over the bins of a leg the rate of the temperature adds up to what it
    /// changes, wherever in a bin it lies.
    #[test]
    fn the_rate_of_a_sharp_thermocline_is_its_change_over_the_time() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        for thermocline_dbar in [88.0, 92.0, 96.0, 100.0] {
            let mut log = log(&parameters);
            log.iter_mut().for_each(|o| o.temperature_C = if o.pressure_dbar < thermocline_dbar { 12.0 } else { 8.0 });
            let problem = SeaProblem::new(&log, &parameters, DiagnosisSettings::default()).expect("enough bins");
            let rates = problem.past.history.rates(&problem.past.history.past.temperature_C);
            let of_leg = |leg: u32| {
                let bins = problem.bins.iter().zip(&rates).filter(|(bin, _)| bin.mean.leg == leg);
                bins.map(|(bin, rate)| 15.0 * bin.samples as f64 * rate).sum::<f64>()
            };
            assert!((of_leg(0) + 4.0).abs() < 1e-9 && (of_leg(1) - 4.0).abs() < 1e-9, "{} {}", of_leg(0), of_leg(1));
        }
    }

    /// So is that of each coefficient of an unknown shear.
    #[test]
    fn every_column_of_the_shear_is_the_change_of_what_is_read_with_its_coefficient() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let problem =
            SeaProblem::new(&log(&parameters), &parameters, DiagnosisSettings::default()).expect("enough bins");
        let start = problem.start();
        let before = problem.evidence(&start);
        let is_shear = |place: &usize| problem.baseline()[*place].0.starts_with("shear");
        let places: Vec<usize> = (0..problem.baseline().len()).filter(is_shear).collect();
        // One heading, due north: the coefficients of the east change nothing and are left out.
        assert!(places.len() >= 4 && problem.baseline()[places[0]].0 == "shear_north_0", "{:?}", problem.baseline());
        for place in places {
            let mut point = start.clone();
            point.baseline[place] += 0.2;
            let change = &before.residual - problem.evidence(&point).residual;
            let column = before.baseline.column(place) * 0.2;
            let (most, off) = (column.amax(), (&change - &column).amax());
            assert!(most > 1e-5 && off < 0.03 * most, "{}: {off} of {most} m/s", problem.baseline()[place].0);
        }
    }

    #[test]
    fn a_lag_is_the_closed_form_of_a_ramp_and_a_step() {
        let time: Vec<f64> = (0..2000).map(|i| 3.0 * f64::from(i)).collect();
        let ramp: Vec<f64> = time.iter().map(|t| 5.0 + 0.2 * t).collect();
        for (t, late) in time.iter().zip(lagged(&time, &ramp, 400.0)) {
            let expected = 5.0 + 0.2 * (t - 400.0 * (1.0 - (-t / 400.0).exp()));
            assert!((late - expected).abs() < 1e-9 * expected, "{t} s: {late} against {expected}");
        }
        assert_eq!(lagged(&time, &ramp, 0.0), ramp);
        // Long after a change of some seconds nothing is left but the tail of a step.
        let step: Vec<f64> = time.iter().map(|t| if *t < 300.0 { 0.0 } else { 1.0 }).collect();
        let late = lagged(&time, &step, 400.0);
        let expected = 1.0 - (-(1500.0 - 298.5) / 400.0f64).exp();
        assert!((late[500] - expected).abs() < 1e-5, "{} against {expected}", late[500]);
    }
}
