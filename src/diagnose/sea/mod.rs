//! The diagnosis at sea: what a flight log says against the steady glide of a vehicle.
//!
//! Samples of a steady glide are averaged over [bins](crate::identify::bins()) of one leg. In each bin the model flies the
//! pitch, ballast and water that were read, and its vertical velocity and speed stand against those measured. Candidates
//! are the mechanisms of [`crate::mechanisms`] whose parameters are rows of the table of parameters, differentiated by dual
//! numbers through the very equations of the simulation.
//!
//! Knows the engine, the steady glide and observations; no files.

mod at_point;
mod attitude;
mod candidates;
mod common_drag;
pub mod consistency;
mod covariates;
mod density_report;
mod effects_of_past;
mod empirical;
mod fit_warnings;
mod flown;
mod grid_refinement;
mod history;
mod jumps;
mod known_shear;
mod late_attitude;
mod leg_rates;
mod level_shift;
mod lift_slope;
mod log_diagnosis;
mod model;
mod not_assessed;
mod past;
mod path_share;
mod pitch_reliability;
mod problem;
mod salinity;
mod settings;
mod shear;
mod stated_polar;
#[cfg(test)]
mod steady_log;
mod time_constants;
mod trim;
mod turns;
mod unknown_temperature;
mod vehicle_log;
mod with_inertia;

use std::sync::Arc;

use crate::dynamics::empirical::ActsOn;
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use crate::identify::{Bin, Inside, Parts, bins, median_step_s};
use crate::log::Observation;

use super::evidence::{Candidate, Evidence, Point};
use super::relevance::Relevance;
use at_point::put_version;
use attitude::Smoother;
use candidates::Tried;
use common_drag::{COMMON_DRAG_SHARE, CommonDrag};
use jumps::Jump;
use late_attitude::LateAttitude;
use leg_rates::LegRates;
pub use log_diagnosis::{SeaDiagnosis, diagnose_log};
use model::Directions;
use nalgebra::DVector;
use pitch_reliability::PITCH_RELIABILITY;
pub use settings::{DiagnosisSettings, Lift, SeaError};
use shear::UnknownShear;
pub use turns::known_turning;
pub use vehicle_log::{LiftSlope, Request, VehicleLogError, diagnose_vehicle, extended};

/// The share of its inertia with which the glider follows its forces, and its unit: 1 by the vehicle's masses, 0 in a log that
/// was simulated from steady glides.
const INERTIA_SHARE: (&str, &str) = ("inertia_share", "1");

/// Prior standard deviations that a mechanism's size may lie from neutral: what needs more than three standard deviations of what is believed
/// resembles it only, unless nothing bounds the size and nothing else explains the log.
const MOST_USUAL: f64 = 3.0;

/// Standard errors by which a size must be known. Another law whose effect on the rows has a correlation of 0.87 with the named
/// one's differs from it by half of the effect, which must be found by three standard errors. No other law resembles
/// a mechanism with a channel of its own: chance alone decides.
const LEAST_KNOWN: f64 = 6.0;

/// The quantities with the least misfit that is worth acting on \[m/s\]: 1 mm/s in vertical velocity is a tenth of the slow
/// vertical motion of the water itself, 3 mm/s in speed a hundredth of a glider's speed, as good as speed is measured.
pub const LEAST_RELEVANT: [(&str, f64); 2] = [(VERTICAL_VELOCITY, 1e-3), (SPEED, 3e-3)];

const VERTICAL_VELOCITY: &str = "vertical_velocity";
const SPEED: &str = "speed_through_water";

/// Samples that a bin must hold at least.
const MIN_SAMPLES: usize = 3;

/// Fewest bins of a quantity from which a diagnosis is tried.
const MIN_BINS: usize = 12;

/// Bins whose middles are no more than this many usual steps apart follow each other.
const JOINED_STEPS: f64 = 1.25;

/// A log against a vehicle.
#[derive(Clone)]
pub struct SeaProblem {
    bins: Vec<Bin>,
    /// The same in parts.
    parts: Parts,
    /// What happens inside each bin, where that is not flown anew at every point.
    within: Option<Within>,
    /// Bins no farther apart than this share the reading of the pressure between them \[s\].
    joined_s: f64,
    /// Rows of the speed, as indices into the bins.
    with_speed: Vec<usize>,
    parameters: Parameters<f64>,
    lift: Lift,
    polar_se: [Option<f64>; 3],
    relevance: Relevance,
    baseline: Vec<(&'static str, &'static str)>,
    baseline_index: Vec<usize>,
    candidates: Vec<Candidate>,
    tried: Tried,
    /// For each candidate how its size changes what is read.
    shapes: Vec<Shape>,
    directions: Directions,
    /// The direction of a pitch offset, along which the force of a shear acts.
    pitch_direction: usize,
    /// The readings of the attitude, for clocks that differ.
    late_attitude: Arc<LateAttitude>,
    /// Rate of the pitch in each bin \[rad/s\].
    pitch_rates: Arc<Vec<f64>>,
    /// Time by which the path follows the pitch in each bin \[s\], by which the pitch of the bin is late.
    follows_s: Arc<Vec<f64>>,
    /// What the mechanisms of the past go by.
    past: effects_of_past::Columns,
    /// The shear of a current that the log does not have.
    shear: UnknownShear,
    /// The drag of a vehicle whose legs differ.
    common_drag: Option<CommonDrag>,
    /// What other channels of the log show.
    channels: candidates::Channels,
    /// Whether the scale of the speed is a candidate, beside that of the pressure.
    asks_speed_scale: bool,
}

/// What happens inside each bin: with inertia as it is, and where the share of the inertia is fitted without any.
type Within = (Vec<Inside>, Option<Vec<Inside>>);

/// How the size of a candidate changes what is read.
#[derive(Debug, Clone)]
struct Shape {
    /// The row of its size in the table of parameters.
    row: usize,
    slopes: Slopes,
}

/// Where the slopes along a size come from.
#[derive(Debug, Clone)]
enum Slopes {
    /// A direction of the model itself.
    Direction(usize),
    /// For trapped air, which is compressed much within a bin near the surface: a direction of the model where the inside of the bins is
    /// held, and otherwise what a unit does to each bin, at once and late, times the slopes along the offset.
    Compressed { held: usize, columns: [Vec<f64>; 2], offset: usize },
    /// For a mechanism of the past: what a unit of it does to each bin, times the slopes along a direction of the model.
    Past {
        /// What a unit does to each bin: where forces balance at every moment, and as the glider follows it.
        columns: [Vec<f64>; 2],
        /// The direction, where it is one.
        carrier: Option<usize>,
    },
    /// For the clock of the attitude: whole flights with the pitch of another time.
    LateAttitude,
    /// For the scale of the measured speed: the speed itself.
    Speed,
}

impl SeaProblem {
    /// A problem from the samples of a log and the parameters of the baseline (trim decided).
    ///
    /// # Errors
    /// Where too few bins of steady glide remain.
    pub fn new(
        observations: &[Observation],
        parameters: &Parameters<f64>,
        settings: DiagnosisSettings,
    ) -> Result<SeaProblem, SeaError> {
        // What the vehicle says of the ratio of its legs stays as it is: one polar is fitted, and each leg has its share of it.
        let mut usable: Vec<Observation> = observations.iter().copied().filter(is_usable).collect();
        let smoother = Smoother::new(&usable);
        let follows_s = model::path_follows_s(parameters, &usable);
        let pitch_variance = match smoother {
            Some(smoother) => smoother.smooth(&mut usable, &follows_s),
            None => vec![0.0; usable.len()],
        };
        let read_variance = smoother.map_or(0.0, |smoother| smoother.read_variance);
        let mut bins = bins(&usable, settings.max_bins, MIN_SAMPLES);
        if bins.len() < MIN_BINS {
            return Err(SeaError::TooShort { found: bins.len(), steady: usable.len(), samples: observations.len() });
        }
        let is_steady = model::steady(parameters, &bins, &usable);
        let mut keep = is_steady.into_iter();
        bins.retain(|bin| keep.next().unwrap_or(false) && model::flies(parameters, bin));
        for bin in &mut bins {
            let smoothed = &pitch_variance[bin.first..bin.first + bin.samples];
            model::add_pitch_error(bin, attitude::variance_of_mean(smoothed, read_variance).sqrt());
            let with_neighbours = around(&usable, bin);
            let sampling_kg = model::sampling_error_kg(parameters, &usable[with_neighbours]);
            model::add_mass_error(parameters, bin, model::WEIGHING_ERROR_KG.hypot(sampling_kg));
        }
        if bins.len() < MIN_BINS {
            return Err(SeaError::TooFew { found: bins.len() });
        }
        let leg_rates = LegRates::new(parameters, &bins);
        usable.iter_mut().chain(bins.iter_mut().map(|bin| &mut bin.mean)).for_each(|o| leg_rates.put_into(o));
        let with_speed: Vec<usize> = if settings.use_speed {
            (0..bins.len()).filter(|i| bins[*i].mean.speed_m_s.is_finite()).collect()
        } else {
            Vec::new()
        };
        let with_speed = if with_speed.len() < MIN_BINS { Vec::new() } else { with_speed };

        let past = effects_of_past::Columns::new(&bins, observations, parameters);
        let names: &[&str] =
            if settings.lift == Lift::Held { &["b", "c_per_rad2"] } else { &["a_per_rad", "b", "c_per_rad2"] };
        let names = names
            .iter()
            .chain(settings.trim_is_assumed.then_some(&trim::PARAMETER))
            .chain(settings.temperature_is_suggested.then_some(&unknown_temperature::PARAMETER));
        let baseline_index: Vec<usize> = names.filter_map(|name| parameter_index(name)).collect();
        let mut baseline: Vec<_> = baseline_index.iter().map(|i| (PARAMETERS[*i].name, PARAMETERS[*i].unit)).collect();
        let shear = if past.knows_shear() {
            UnknownShear::default()
        } else {
            UnknownShear::new(&bins, observations, &leg_rates, |met| past.late(met))
        };
        baseline.extend(shear.names());
        let mut directions = Directions::new(&baseline_index);
        let common_drag = CommonDrag::new(parameters, &mut directions);
        baseline.extend(common_drag.map(|_| COMMON_DRAG_SHARE));
        baseline.extend([PITCH_RELIABILITY, INERTIA_SHARE, path_share::PATH_LOG_ODDS]);

        let pitch_direction = directions.index_of(parameter_index("pitch_offset_rad").expect("a row of the table"));
        let of_bin = |bin: &Bin| follows_s[bin.first..bin.first + bin.samples].iter().sum::<f64>() / bin.samples as f64;
        let follows_in_bins_s = Arc::new(bins.iter().map(of_bin).collect());
        let late_attitude = LateAttitude::new(observations, &bins, smoother, follows_s, leg_rates);
        let pitch_rates = Arc::new(late_attitude.pitch_rates());
        let joined_s = JOINED_STEPS * median_step_s(bins.iter().map(|bin| &bin.mean));
        let mut problem = SeaProblem {
            directions,
            pitch_direction,
            parts: Parts::new(&bins, &usable, observations),
            bins,
            within: None,
            joined_s,
            with_speed,
            parameters: *parameters,
            lift: settings.lift,
            polar_se: settings.polar_se,
            relevance: settings.relevance,
            baseline,
            baseline_index,
            candidates: Vec::new(),
            tried: Tried::default(),
            shapes: Vec::new(),
            pitch_rates,
            follows_s: follows_in_bins_s,
            late_attitude: Arc::new(late_attitude),
            past,
            shear,
            common_drag,
            channels: candidates::Channels::new(observations),
            asks_speed_scale: false,
        };
        problem.look_for(Tried { jumps: Jump::between_legs(&problem.bins), ..Tried::default() });
        Ok(problem)
    }

    /// The same problem with versions that are closer about some that were found: a step between any two bins, a time
    /// constant between those that are tried. None where no candidate has versions, or the bins no jump between them.
    pub fn with_versions_about(&self, candidates: &[usize]) -> Option<SeaProblem> {
        let mut tried = self.tried.clone();
        let mut is_closer = false;
        for candidate in candidates.iter().map(|candidate| &self.candidates[*candidate]) {
            let Some(version) = candidate.version else { continue };
            if jumps::MECHANISMS.contains(&candidate.name) {
                tried.jumps = Jump::between_bins(&self.bins, &tried.jumps, version.value);
                is_closer |= tried.jumps.len() != self.tried.jumps.len();
            } else {
                tried.closer.insert(candidate.name, time_constants::Closer::about(&version));
                is_closer = true;
            }
        }
        if !is_closer {
            return None;
        }
        let mut finer = self.clone();
        finer.look_for(tried);
        Some(finer)
    }

    /// The same problem with the scale of the speed among the candidates; none where no speed was measured.
    ///
    /// Beside a polar that is fitted it does nearly what a scale of the pressure does, and stands in the group of that. In deep water the
    /// two differ: one changes the pressure that compresses the hull, the other does not.
    pub(super) fn with_speed_scale(&self) -> Option<SeaProblem> {
        let mut asking = SeaProblem { asks_speed_scale: self.has_speed(), ..self.clone() };
        asking.look_for(self.tried.clone());
        self.has_speed().then_some(asking)
    }

    /// Whether the baseline has no inertia.
    pub fn is_quasi_steady(&self) -> bool {
        self.parts.is_quasi_steady()
    }

    fn fits_expansion(&self) -> bool {
        self.baseline.iter().any(|(name, _)| *name == unknown_temperature::PARAMETER)
    }

    /// Takes what these data could show for candidates, in these versions.
    fn look_for(&mut self, tried: Tried) {
        (self.candidates, self.shapes) = (Vec::new(), Vec::new());
        let listed = candidates::list(&self.bins, &self.channels, &tried, &self.parameters);
        self.tried = tried;
        let offset_row = parameter_index("ballast_offset_kg").expect("a row of the table");
        for (candidate, index) in listed {
            // Whoever knows the lift slope holds the law of lift: a bend of it would let the slope go again.
            if self.lift != Lift::Fitted && candidate.name == "nonlinear_lift" {
                continue;
            }
            // Vertical velocity alone cannot tell a scale of the pitch from the polar: what it would be called is something
            // else.
            if !self.has_speed() && candidate.name == "pitch_scale" {
                continue;
            }
            // What an assumed trim is fitted for, another density does as well.
            if self.fits_trim() && trim::OFFSETS.contains(&candidate.name) {
                continue;
            }
            // A temperature that the density suggests has no errors of its own.
            if self.fits_expansion() && ["thermal_expansion", "thermal_lag"].contains(&candidate.name) {
                continue;
            }
            if candidate.name == "speed_scale" && !self.asks_speed_scale {
                continue;
            }
            let slopes = match history::acts(candidate.name) {
                None if candidate.name == late_attitude::MECHANISM => Slopes::LateAttitude,
                None if candidate.name == "speed_scale" => Slopes::Speed,
                None if candidate.name == "trapped_air" => Slopes::Compressed {
                    held: self.directions.index_of(index),
                    columns: self.past.effect(candidate.name, &self.bins, &self.parameters),
                    offset: self.directions.index_of(offset_row),
                },
                // The model's slope along a step is zero before it. Behind any other time it is the slope along the offset.
                None if candidate.name == "net_mass_step" => Slopes::Direction(self.directions.index_of(offset_row)),
                None => Slopes::Direction(self.directions.index_of(index)),
                Some(acts) => {
                    let mut parameters = self.parameters;
                    put_version(&mut parameters, &candidate);
                    let columns = self.past.effect(candidate.name, &self.bins, &parameters);
                    // A mechanism that never acts in this log has nothing to show.
                    if columns[0].iter().all(|value| value.abs() < f64::MIN_POSITIVE) {
                        continue;
                    }
                    let carrier = match acts {
                        history::Acts::NetMass => Some(self.directions.index_of(offset_row)),
                        history::Acts::Reading => None,
                    };
                    Slopes::Past { columns, carrier }
                }
            };
            self.candidates.push(candidate);
            self.shapes.push(Shape { row: index, slopes });
        }
    }

    /// What a unit of relative drag, of relative lift or of net mass changes in every row, at a point of the fit.
    fn carrier(&self, acts: ActsOn, evidence: &Evidence, point: &Point) -> DVector<f64> {
        let none = || DVector::zeros(evidence.residual.len());
        // A share of a coefficient is its value times its slope; one that is held has no share.
        let share = |name: &str| {
            let place = self.baseline.iter().position(|(known, _)| *known == name)?;
            Some(evidence.baseline.column(place) * point.baseline[place])
        };
        match acts {
            ActsOn::Drag => share("b").zip(share("c_per_rad2")).map_or_else(none, |(b, c)| b + c),
            ActsOn::Lift => share("a_per_rad").unwrap_or_else(none),
            ActsOn::NetMass => {
                let place = self.candidates.iter().position(|candidate| candidate.name == "ballast_offset");
                place.map_or_else(none, |place| evidence.candidates[place].column(0).into_owned())
            }
        }
    }

    /// Whether measured speed has a vote.
    pub fn has_speed(&self) -> bool {
        !self.with_speed.is_empty()
    }

    /// What the lift slope rests on where no speed was measured; none where one was.
    pub fn without_speed(&self) -> Option<&'static str> {
        let text = match self.lift {
            Lift::Held => "no measured speed: the lift slope is held, and some causes look alike",
            Lift::Known { .. } => {
                "no measured speed: the lift slope is the stated one within its error, and some causes look alike"
            }
            Lift::Fitted => {
                "no measured speed: the lift slope is the vehicle's within what polars of one design scatter by, and some causes look alike"
            }
        };
        (!self.has_speed()).then_some(text)
    }

    /// Whether the log's own current gives the force of its shear.
    pub fn knows_shear(&self) -> bool {
        self.past.knows_shear()
    }

    /// How many bins the log was reduced to.
    pub fn n_bins(&self) -> usize {
        self.bins.len()
    }
}

/// The samples of a bin, and the one before and after of the same leg.
fn around(samples: &[Observation], bin: &Bin) -> std::ops::Range<usize> {
    let end = bin.first + bin.samples;
    let is_alike = |i: usize| samples.get(i).is_some_and(|o| o.leg == bin.mean.leg);
    let first = if bin.first > 0 && is_alike(bin.first - 1) { bin.first - 1 } else { bin.first };
    first..if is_alike(end) { end + 1 } else { end }
}

fn is_usable(o: &Observation) -> bool {
    o.steady
        && [o.time_s, o.pressure_dbar, o.density_kg_m3, o.pitch_rad, o.ballast_m3, o.sink_m_s]
            .iter()
            .all(|value| value.is_finite())
}
