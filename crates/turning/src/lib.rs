//! How a glider turns, from heading, roll and rudder of its log: turn rate per roll on each leg, per rudder, static list,
//! offset of the rudder, centre of the roll mass.
//!
//! ```text
//! turn rate = a_leg + k_leg roll + k_rudder rudder          one value for each stretch between control moves
//! ```
//! Least squares over all stretches; standard errors are robust to whatever the stretches of one dive have in common (cluster
//! sandwich by dives, Student's t with dives less one). A stretch begins 20 s after a move of motor, rudder or roll
//! mass or the turn of a leg, 25 s where moves are seen in the readings alone. What did not vary is not fitted. Knows no equations of motion: under an autopilot roll and
//! rudder answer the heading, and what the autopilot suppresses is not in these figures.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod causes;
mod stretches;

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use glidepolar_flightlog::Observation;
use glidepolar_inference::estimate::Estimate;
use glidepolar_inference::regression::{Problem, Scatter};

use stretches::{Stretch, stretches};

/// A control that varies by less than this does not identify its effect: roll, rudder, roll mass \[rad\].
const VARIES_RAD: [f64; 3] = [0.035, 0.015, 0.05];
/// A ratio is stated where its denominator is so many standard errors from zero.
const SURE: f64 = 4.0;
/// Fewer stretches or dives than this say nothing.
const LEAST_STRETCHES: usize = 8;
const LEAST_DIVES: usize = 3;
/// A rudder held at one angle of at least this size gives a turn rate per rudder through zero \[rad\].
const HELD_RUDDER_RAD: f64 = 0.05;
/// Layers into which each leg is cut.
const LAYERS: usize = 3;

/// The block `turning` of `identify --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Turning {
    /// Stretches between control moves.
    pub stretches: usize,
    /// Dives that they come from.
    pub dives: usize,
    /// Turn rate per roll \[1/s\].
    pub turn_rate_per_roll_1_s: ByLeg<Option<Estimate>>,
    /// Turn rate per rudder angle, both legs together \[1/s\].
    pub turn_rate_per_rudder_1_s: Option<Estimate>,
    /// Roll without any deflection of the roll mass \[rad\].
    pub static_list_rad: Option<Estimate>,
    /// Reading of the rudder at which a glider without roll goes straight, the other sign \[rad\].
    pub rudder_offset_rad: Option<Estimate>,
    /// Roll per angle of the roll mass.
    pub roll_per_roll_mass: Option<Estimate>,
    /// Angle of the roll mass at which it goes straight \[rad\].
    pub roll_centre: Option<ByLeg<Option<Estimate>>>,
    /// Lateral coefficients, where a log identifies one; turn rates alone identify none.
    pub coefficients: std::collections::BTreeMap<String, Estimate>,
    /// Error of the turn rate on dives that the fit did not use \[rad/s\].
    pub holdout_rms_rad_s: Option<ByLeg<f64>>,
    /// Standard deviation of the turn rate itself \[rad/s\].
    pub sd_rad_s: ByLeg<f64>,
    /// Every other dive from the first on, and from the second on: each fitted by itself and predicted from the other half.
    pub halves: Option<Halves>,
    /// Mean turn rates by depth.
    pub layers: Vec<Layer>,
    /// What to read the figures with.
    pub warnings: Vec<String>,
}

/// One figure a leg.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ByLeg<T> {
    /// On descents.
    pub descent: T,
    /// On ascents.
    pub ascent: T,
}

/// The dives of a log, every other one in each half.
#[derive(Debug, Clone, Serialize)]
pub struct Halves {
    /// The first, third, fifth, ... dive.
    pub odd: Half,
    /// The second, fourth, sixth, ... dive.
    pub even: Half,
}

/// Every other dive.
#[derive(Debug, Clone, Serialize)]
pub struct Half {
    /// Dives.
    pub dives: usize,
    /// Stretches.
    pub stretches: ByLeg<usize>,
    /// Turn rate per roll of these dives alone \[1/s\].
    pub turn_rate_per_roll_1_s: ByLeg<Option<Estimate>>,
    /// Error of the turn rate of these dives where the fit used the other half \[rad/s\].
    pub predicted_rms_rad_s: ByLeg<f64>,
    /// Standard deviation of the turn rate of these dives \[rad/s\].
    pub sd_rad_s: ByLeg<f64>,
}

/// Mean turn rate in a range of pressure.
#[derive(Debug, Clone, Serialize)]
pub struct Layer {
    /// `descent` or `ascent`.
    pub leg: &'static str,
    /// Shallow end \[dbar\].
    pub from_dbar: f64,
    /// Deep end \[dbar\].
    pub to_dbar: f64,
    /// Turn rate \[rad/s\].
    pub turn_rate_rad_s: Estimate,
    /// Stretches.
    pub stretches: usize,
}

/// What the log says of turning; nothing where it has no heading, neither roll nor rudder, or too few steady stretches.
pub fn turning(observations: &[Observation]) -> Option<Turning> {
    let all = stretches(observations);
    let dives: BTreeSet<u32> = all.iter().map(|s| s.dive).collect();
    if all.len() < LEAST_STRETCHES || dives.len() < LEAST_DIVES {
        return None;
    }
    let leg = |descends: bool| all.iter().filter(move |s| s.descends == descends);
    let mut warnings = Vec::new();
    let model = Model::new(&all);
    let fit = RateFit::new(&model.design(&all), &rates(&all), &clusters(&all));
    let of_column = |column: Column, unit: &str| {
        let at = model.columns.iter().position(|known| *known == column)?;
        fit.as_ref().map(|fit| fit.estimate(at, unit))
    };
    let held = held_rudder(&all, &model);
    if let Some(warning) = held.as_ref().and_then(|_| legs_differ(&all)) {
        warnings.push(warning);
    }
    let layers = layers(&all);
    warnings.extend(depth_matters(&layers));
    let centre = |descends: bool| {
        let of_leg: Vec<Stretch> = leg(descends).copied().collect();
        zero_of(&of_leg, |s| s.roll_mass_rad, VARIES_RAD[2], "rad")
    };
    let roll_mass = line(&all, |s| s.roll_mass_rad, |s| s.roll_rad, VARIES_RAD[2]);
    let rolls: Vec<f64> = all.iter().map(|s| s.roll_rad).collect();
    let static_list_rad = match &roll_mass {
        Some(fit) => Some(fit.estimate(0, "rad")),
        None if all.iter().all(|s| !s.roll_mass_rad.is_finite()) && sd(&rolls) < 1.5 * VARIES_RAD[0] => {
            mean(&all, |s| s.roll_rad, "rad")
        }
        None => None,
    };
    let halves = halves(&all, &model);
    let centres = ByLeg { descent: centre(true), ascent: centre(false) };
    Some(Turning {
        stretches: all.len(),
        dives: dives.len(),
        turn_rate_per_roll_1_s: ByLeg {
            descent: of_column(Column::Roll(true), "1/s"),
            ascent: of_column(Column::Roll(false), "1/s"),
        },
        turn_rate_per_rudder_1_s: of_column(Column::Rudder, "1/s").or(held),
        static_list_rad,
        rudder_offset_rad: fit.as_ref().and_then(|fit| rudder_offset(fit, &model)),
        roll_per_roll_mass: roll_mass.map(|fit| fit.estimate(1, "1")),
        roll_centre: (centres.descent.is_some() || centres.ascent.is_some()).then_some(centres),
        coefficients: std::collections::BTreeMap::new(),
        holdout_rms_rad_s: halves.as_ref().map(holdout),
        sd_rad_s: ByLeg {
            descent: sd(&leg(true).map(|s| s.rate_rad_s).collect::<Vec<_>>()),
            ascent: sd(&leg(false).map(|s| s.rate_rad_s).collect::<Vec<_>>()),
        },
        halves,
        layers,
        warnings,
    })
}

/// What a column of the regression stands for; legs by whether they descend.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Constant(bool),
    Roll(bool),
    Rudder,
}

/// Which effects a log can be asked for.
struct Model {
    columns: Vec<Column>,
}

impl Model {
    fn new(all: &[Stretch]) -> Self {
        let mut columns = Vec::new();
        for descends in [true, false] {
            let of_leg: Vec<&Stretch> = all.iter().filter(|s| s.descends == descends).collect();
            if of_leg.is_empty() {
                continue;
            }
            columns.push(Column::Constant(descends));
            let rolls: Vec<f64> = of_leg.iter().map(|s| s.roll_rad).collect();
            if of_leg.len() >= LEAST_STRETCHES / 2 && sd(&rolls) > VARIES_RAD[0] {
                columns.push(Column::Roll(descends));
            }
        }
        let rudders: Vec<f64> = all.iter().map(|s| s.rudder_rad).collect();
        if sd(&rudders) > VARIES_RAD[1] {
            columns.push(Column::Rudder);
        }
        Model { columns }
    }

    /// Whether half of a log shows each effect: as many stretches of a leg as half of a log needs, and a roll that varies on them.
    /// A line through two stretches has no error and predicts nothing.
    fn is_shown_by(&self, half: &[Stretch]) -> bool {
        self.columns.iter().all(|column| match column {
            Column::Roll(descends) => {
                let rolls: Vec<f64> = half.iter().filter(|s| s.descends == *descends).map(|s| s.roll_rad).collect();
                rolls.len() >= LEAST_STRETCHES / 4 && sd(&rolls) > VARIES_RAD[0]
            }
            _ => true,
        })
    }

    fn row(&self, s: &Stretch) -> Vec<f64> {
        let on = |leg: bool, value: f64| if s.descends == leg { value } else { 0.0 };
        let value = |column: &Column| match *column {
            Column::Constant(leg) => on(leg, 1.0),
            Column::Roll(leg) => on(leg, s.roll_rad),
            Column::Rudder => s.rudder_rad,
        };
        self.columns.iter().map(value).collect()
    }

    fn design(&self, all: &[Stretch]) -> DMatrix<f64> {
        DMatrix::from_row_iterator(all.len(), self.columns.len(), all.iter().flat_map(|s| self.row(s)))
    }
}

/// Least squares with standard errors by clusters.
struct RateFit {
    values: DVector<f64>,
    covariance: DMatrix<f64>,
    clusters: usize,
}

impl RateFit {
    /// None where the columns depend on each other, or there are too few clusters.
    fn new(design: &DMatrix<f64>, measured: &DVector<f64>, clusters: &[u32]) -> Option<Self> {
        Self::of_few(design, measured, clusters).filter(|fit| fit.clusters >= LEAST_DIVES)
    }

    /// The same with any number of clusters: with two, Student's t has one degree of freedom; with one there is no error.
    fn of_few(design: &DMatrix<f64>, measured: &DVector<f64>, clusters: &[u32]) -> Option<Self> {
        let names: BTreeSet<u32> = clusters.iter().copied().collect();
        let fit = Problem::plain(design.clone(), measured.clone()).solve(Scatter::Equal)?;
        Some(RateFit { covariance: fit.cluster_covariance(clusters), values: fit.parameters, clusters: names.len() })
    }

    fn se(&self, at: usize) -> f64 {
        self.covariance[(at, at)].max(0.0).sqrt()
    }

    fn student(&self, value: f64, se: f64, unit: &str) -> Estimate {
        Estimate::student(value, se, self.clusters as f64 - 1.0, unit)
    }

    fn estimate(&self, at: usize, unit: &str) -> Estimate {
        self.student(self.values[at], self.se(at), unit)
    }

    /// `weights . values / values[below]`, by first-order propagation; none where the denominator may be zero.
    fn ratio(&self, weights: &DVector<f64>, below: usize, unit: &str) -> Option<Estimate> {
        let slope = self.values[below];
        if slope.abs() < SURE * self.se(below) {
            return None;
        }
        let value = weights.dot(&self.values) / slope;
        let mut gradient = weights / slope;
        gradient[below] -= value / slope;
        let variance = (gradient.transpose() * &self.covariance * &gradient)[(0, 0)];
        Some(self.student(value, variance.max(0.0).sqrt(), unit))
    }
}

fn rates(all: &[Stretch]) -> DVector<f64> {
    DVector::from_iterator(all.len(), all.iter().map(|s| s.rate_rad_s))
}

fn clusters(all: &[Stretch]) -> Vec<u32> {
    all.iter().map(|s| s.dive).collect()
}

/// A straight line of one quantity over another, both legs together; none where the other one hardly varies.
fn line(all: &[Stretch], over: impl Fn(&Stretch) -> f64, of: impl Fn(&Stretch) -> f64, varies: f64) -> Option<RateFit> {
    let known: Vec<&Stretch> = all.iter().filter(|s| over(s).is_finite() && of(s).is_finite()).collect();
    let xs: Vec<f64> = known.iter().map(|s| over(s)).collect();
    if known.len() < LEAST_STRETCHES / 2 || sd(&xs) < varies {
        return None;
    }
    let design = DMatrix::from_fn(known.len(), 2, |i, j| if j == 0 { 1.0 } else { xs[i] });
    let measured = DVector::from_iterator(known.len(), known.iter().map(|s| of(s)));
    let clusters: Vec<u32> = known.iter().map(|s| s.dive).collect();
    RateFit::new(&design, &measured, &clusters)
}

/// Where the turn rate is zero along a control.
fn zero_of(all: &[Stretch], control: impl Fn(&Stretch) -> f64, varies: f64, unit: &str) -> Option<Estimate> {
    let fit = line(all, control, |s| s.rate_rad_s, varies)?;
    fit.ratio(&DVector::from_vec(vec![-1.0, 0.0]), 1, unit)
}

/// True rudder less the reading: the mean of the legs' turn rates without rudder and roll, over the rate per rudder.
fn rudder_offset(fit: &RateFit, model: &Model) -> Option<Estimate> {
    let below = model.columns.iter().position(|column| *column == Column::Rudder)?;
    let constants: Vec<usize> =
        (0..model.columns.len()).filter(|i| matches!(model.columns[*i], Column::Constant(_))).collect();
    let mut weights = DVector::zeros(model.columns.len());
    constants.iter().for_each(|i| weights[*i] = 1.0 / constants.len() as f64);
    fit.ratio(&weights, below, "rad")
}

/// Turn rate per rudder where the rudder stands at one angle for the whole log: as if without it the glider went straight.
fn held_rudder(all: &[Stretch], model: &Model) -> Option<Estimate> {
    let rudders: Vec<f64> = all.iter().map(|s| s.rudder_rad).collect();
    let middle = rudders.iter().sum::<f64>() / rudders.len() as f64;
    if model.columns.contains(&Column::Rudder) || middle.is_nan() || middle.abs() < HELD_RUDDER_RAD {
        return None;
    }
    let design = DMatrix::from_iterator(all.len(), 1, rudders);
    Some(RateFit::new(&design, &rates(all), &clusters(all))?.estimate(0, "1/s"))
}

/// The mean of a quantity, by dives.
fn mean(all: &[Stretch], of: impl Fn(&Stretch) -> f64, unit: &str) -> Option<Estimate> {
    let known: Vec<&Stretch> = all.iter().filter(|s| of(s).is_finite()).collect();
    let clusters: Vec<u32> = known.iter().map(|s| s.dive).collect();
    let design = DMatrix::from_element(known.len(), 1, 1.0);
    let measured = DVector::from_iterator(known.len(), known.iter().map(|s| of(s)));
    Some(RateFit::new(&design, &measured, &clusters)?.estimate(0, unit))
}

fn legs_differ(all: &[Stretch]) -> Option<String> {
    let rate = |descends: bool| {
        let of_leg: Vec<Stretch> = all.iter().filter(|s| s.descends == descends).copied().collect();
        mean(&of_leg, |s| s.rate_rad_s, "rad/s")
    };
    let (down, up) = (rate(true)?, rate(false)?);
    let apart = (down.value - up.value).abs() / down.se.hypot(up.se);
    (apart > 3.0).then(|| {
        format!(
            "the rudder stands at one angle, and descents turn at {:.4} +- {:.4} rad/s, ascents at {:.4} +- {:.4}: the turn rate \
             per rudder is the mean of two legs that differ, and what makes them differ is not identified",
            down.value, down.se, up.value, up.se
        )
    })
}

/// Mean turn rates by depth, each leg in layers of as many stretches.
fn layers(all: &[Stretch]) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (descends, leg) in [(true, "descent"), (false, "ascent")] {
        let mut of_leg: Vec<Stretch> = all.iter().filter(|s| s.descends == descends).copied().collect();
        of_leg.sort_by(|a, b| a.pressure_dbar.total_cmp(&b.pressure_dbar));
        if of_leg.len() < LAYERS * LEAST_STRETCHES / 2 {
            continue;
        }
        for part in of_leg.chunks(of_leg.len().div_ceil(LAYERS)) {
            let Some(turn_rate_rad_s) = mean(part, |s| s.rate_rad_s, "rad/s") else { continue };
            layers.push(Layer {
                leg,
                from_dbar: part[0].pressure_dbar,
                to_dbar: part[part.len() - 1].pressure_dbar,
                turn_rate_rad_s,
                stretches: part.len(),
            });
        }
    }
    layers
}

fn depth_matters(layers: &[Layer]) -> Vec<String> {
    let mut warnings = Vec::new();
    for leg in ["descent", "ascent"] {
        let of_leg: Vec<&Layer> = layers.iter().filter(|layer| layer.leg == leg).collect();
        let (Some(top), Some(bottom)) = (of_leg.first(), of_leg.last()) else { continue };
        let (above, below) = (&top.turn_rate_rad_s, &bottom.turn_rate_rad_s);
        if (above.value - below.value).abs() > 4.0 * above.se.hypot(below.se) {
            warnings.push(format!(
                "on {leg}s the turn rate changes with depth, from {:.4} +- {:.4} rad/s above {:.0} dbar to {:.4} +- {:.4} below \
                 {:.0} dbar: shear, stratification, speed or the compass; averages over whole legs measure no list",
                above.value, above.se, top.to_dbar, below.value, below.se, bottom.from_dbar
            ));
        }
    }
    warnings
}

/// Each half of the dives, predicted from the other half.
fn halves(all: &[Stretch], model: &Model) -> Option<Halves> {
    let dives: Vec<u32> = all.iter().map(|s| s.dive).collect::<BTreeSet<_>>().into_iter().collect();
    let is_even = |s: &Stretch| dives.binary_search(&s.dive).is_ok_and(|place| place % 2 == 1);
    let (even, odd): (Vec<Stretch>, Vec<Stretch>) = all.iter().partition(|s| is_even(s));
    if !(model.is_shown_by(&odd) && model.is_shown_by(&even)) {
        return None;
    }
    let fit = |half: &[Stretch]| RateFit::of_few(&model.design(half), &rates(half), &clusters(half));
    let (of_odd, of_even) = (fit(&odd)?, fit(&even)?);
    Some(Halves { odd: half(&odd, model, &of_odd, &of_even), even: half(&even, model, &of_even, &of_odd) })
}

/// A half of the dives, fitted by itself and predicted by the fit to the other half.
fn half(half: &[Stretch], model: &Model, own: &RateFit, other: &RateFit) -> Half {
    let predicted = model.design(half) * &other.values;
    let errors = |descends: bool| -> Vec<f64> {
        let of_leg = half.iter().zip(predicted.iter()).filter(|(s, _)| s.descends == descends);
        of_leg.map(|(s, predicted)| s.rate_rad_s - predicted).collect()
    };
    let rates =
        |descends: bool| -> Vec<f64> { half.iter().filter(|s| s.descends == descends).map(|s| s.rate_rad_s).collect() };
    let per_roll = |descends: bool| {
        let at = model.columns.iter().position(|known| *known == Column::Roll(descends))?;
        (own.clusters > 1).then(|| own.estimate(at, "1/s"))
    };
    Half {
        dives: own.clusters,
        stretches: ByLeg { descent: rates(true).len(), ascent: rates(false).len() },
        turn_rate_per_roll_1_s: ByLeg { descent: per_roll(true), ascent: per_roll(false) },
        predicted_rms_rad_s: ByLeg { descent: rms(&errors(true)), ascent: rms(&errors(false)) },
        sd_rad_s: ByLeg { descent: sd(&rates(true)), ascent: sd(&rates(false)) },
    }
}

/// Both halves together.
fn holdout(Halves { odd, even }: &Halves) -> ByLeg<f64> {
    let both = |of: fn(&Half) -> (f64, usize)| {
        let [(a, n), (b, m)] = [of(odd), of(even)];
        ((a * a * n as f64 + b * b * m as f64) / (n + m).max(1) as f64).sqrt()
    };
    ByLeg {
        descent: both(|half| (half.predicted_rms_rad_s.descent, half.stretches.descent)),
        ascent: both(|half| (half.predicted_rms_rad_s.ascent, half.stretches.ascent)),
    }
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

/// Standard deviation; NaN where a value is missing.
fn sd(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt()
}

#[cfg(test)]
mod tests;
