//! The reduction from end to end, in the order in which a tank engineer does it.

use std::collections::BTreeMap;
use std::path::Path;

use glidepolar_input::{InputError, Place, printable};
use rayon::prelude::*;

use crate::campaign::{Campaign, Kind, Rejected, Run};
use crate::derivatives::{self, Derivatives};
use crate::diagnose::Tared;
use crate::harmonics::Harmonics;
use crate::history::History;
use crate::hull::Hull;
use crate::readings::{self, Readings, Useful};
use crate::results::{BalanceSummary, HullResults, Results, RunResults};
use crate::series::{Mean3, median};
use crate::shared::Common;
use crate::statics;
use crate::steady_run::SteadyRun;
use crate::sweep::Sweep;
use crate::tare::{Tare, TareRun};
use crate::zeros::Zeros;
use crate::{checks, diagnose, fits, points, spectrum, theory, trend};

/// Length of a strut, where no hull tells how far the flow must develop \[m\].
const STRUT_M: f64 = 0.5;

/// How to reduce.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Angles up to this magnitude enter the fits \[deg\].
    pub range_deg: f64,
    /// Whether one unusable run is an error rather than a warning.
    pub strict: bool,
}

/// How far the reading has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Runs in all.
    pub runs: usize,
}

/// Reduces a table of points of one hull.
///
/// # Errors
/// Where either file cannot be used.
pub fn reduce_points(points: &Path, hull: &Path, range_deg: f64) -> Result<Results, InputError> {
    let read = points::read(points, hull)?;
    let fit = fits::fit(&read.sweep, range_deg);
    let steady = diagnose::Data::of_points(&read.hull, &read.sweep, read.water);
    let mut warnings = read.notices;
    let mut hull = hull_results(read.hull, read.sweep, fit, None);
    hull.n_runs = hull.sweep.points.len();
    hull.water = read.water;
    warnings.extend(hull_warnings(&hull));
    Ok(Results {
        name: points.display().to_string(),
        source: read.source,
        range_deg,
        hulls: vec![hull],
        trend: None,
        runs: Vec::new(),
        rejected: Vec::new(),
        balance: None,
        warnings,
        steady,
        diagnoses: None,
    })
}

/// Reduces a campaign's folder. `watch` is called after every run, from several threads.
///
/// # Errors
/// Where the campaign as a whole cannot be used; with `strict`, where any run cannot.
pub fn reduce_campaign(
    folder: &Path,
    options: &Options,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Results, InputError> {
    let mut campaign = Campaign::read(folder)?;
    let all = read_runs(&campaign, watch);
    let mut readings: Vec<Option<Readings>> = Vec::with_capacity(all.len());
    for (run, result) in campaign.runs.iter().zip(all) {
        match result {
            Ok(read) => readings.push(Some(read)),
            Err(error) => {
                campaign.rejected.push(Rejected { run_id: run.id.clone(), error });
                readings.push(None);
            }
        }
    }
    share_noise(&mut readings);
    if options.strict
        && let Some(rejected) = campaign.rejected.first()
    {
        return Err(rejected.error.clone());
    }
    Reduction::new(&campaign, &readings).results(options)
}

/// Records at rest have one shape of noise, steady runs under way another.
fn share_noise(readings: &mut [Option<Readings>]) {
    let mut at_rest: Vec<&mut Mean3> = Vec::new();
    let mut under_way: Vec<&mut Mean3> = Vec::new();
    for read in readings.iter_mut().flatten() {
        at_rest.extend(read.rest.as_mut().map(|rest| &mut rest.readings));
        if let Useful::Steady(steady) = &mut read.useful {
            under_way.push(&mut steady.readings);
        }
    }
    spectrum::share(&mut at_rest);
    spectrum::share(&mut under_way);
}

fn read_runs(campaign: &Campaign, watch: &(dyn Fn(Progress) + Sync)) -> Vec<Result<Readings, InputError>> {
    let length = |run: &Run| run.hull.map_or(STRUT_M, |hull| campaign.hulls[hull].geometry.loa_m);
    let runs = campaign.runs.len();
    campaign
        .runs
        .par_iter()
        .map_init(History::default, |history, run| {
            let result = readings::read(run, length(run), history);
            watch(Progress { runs });
            result
        })
        .collect()
}

/// A campaign whose runs have been read.
struct Reduction<'a> {
    campaign: &'a Campaign,
    readings: &'a [Option<Readings>],
    zeros: Zeros,
    warnings: Vec<String>,
}

impl<'a> Reduction<'a> {
    fn new(campaign: &'a Campaign, readings: &'a [Option<Readings>]) -> Self {
        let mut reduction = Reduction { campaign, readings, zeros: Zeros::default(), warnings: Vec::new() };
        reduction.warnings.extend(campaign.notices.iter().cloned());
        let mut unused: BTreeMap<&str, usize> = BTreeMap::new();
        for column in reduction.usable().flat_map(|(_, readings)| &readings.unused) {
            *unused.entry(column).or_default() += 1;
        }
        for (column, runs) in unused {
            reduction.warnings.push(format!("column {} of {runs} runs is not used", printable(column)));
        }
        let zeros = Zeros::new(reduction.usable());
        reduction.zeros = zeros;
        if reduction.zeros.zeros.is_empty() {
            reduction.warnings.push(
                "no zero runs: every run's own rest before the run-up serves as its zero; drift during a run is not removed"
                    .to_owned(),
            );
        }
        reduction
    }

    fn results(mut self, options: &Options) -> Result<Results, InputError> {
        let balance = &self.campaign.balance;
        let zeros = std::mem::take(&mut self.zeros);
        let mut steady =
            diagnose::Data { is_raw: !zeros.zeros.is_empty(), in_time: zeros.in_time, ..diagnose::Data::default() };
        let tare = {
            let common = Common { balance, zeros: &zeros, tare: None };
            let of_strut = self.steady(&common, Kind::Tare, None);
            steady.tare_zeros = of_strut.iter().map(|run| diagnose::zero_times(&common, run)).collect();
            let runs: Vec<TareRun> = of_strut.iter().map(|run| run.tare_run(&common)).collect();
            if runs.is_empty() {
                self.warnings.push("no tare runs: the strut's force is still in all coefficients".to_owned());
            }
            let tare = Tare::fit(&runs, zeros.dof);
            if tare.is_none() && !runs.is_empty() {
                self.warnings.push(format!(
                    "no tare can be made of the {} tare runs: the strut's force is still in all coefficients",
                    runs.len()
                ));
            }
            tare
        };
        steady.tared =
            tare.as_ref().map_or(Tared::Never, |tare| if tare.is_ahead_alone { Tared::Ahead } else { Tared::AtAngles });
        steady.zero_runs = zeros
            .zeros
            .iter()
            .map(|zero| diagnose::ZeroRun {
                when_s: zero.when,
                hull: zero.hull,
                reading: zero.reading,
                variance: (zeros.root * zeros.root.transpose()).diagonal(),
            })
            .collect();
        let common = Common { balance, zeros: &zeros, tare: tare.as_ref() };
        self.check_tare_range(tare.as_ref());
        let mut run_results = self.run_results();
        let mut hulls = Vec::new();
        for (index, hull) in self.campaign.hulls.iter().enumerate() {
            let reduced = self.hull(&common, index, hull, options, &mut run_results, &mut steady);
            self.warnings.extend(hull_warnings(&reduced));
            hulls.push(reduced);
        }
        if hulls.iter().all(|hull| hull.n_runs == 0) {
            let place = Place::file(self.campaign.folder.join("runs.csv"));
            return Err(match self.campaign.rejected.first() {
                Some(rejected) => rejected.error.clone(),
                None => InputError::new(place, "no run with a model under way: nothing to reduce"),
            });
        }
        let lines = trend::fit(
            &hulls.iter().filter_map(|h| Some((h.hull.ldr, &h.sweep, h.fit.as_ref().ok()?))).collect::<Vec<_>>(),
        );
        self.warnings.extend(lines.iter().flat_map(checks::trend));
        self.warnings.extend(checks::runs(&run_results));
        self.warnings.extend(checks::rejected(&self.campaign.rejected));
        Ok(Results {
            name: self.campaign.name.clone(),
            source: self.campaign.facility.clone(),
            range_deg: options.range_deg,
            hulls,
            trend: lines,
            runs: run_results,
            rejected: self.campaign.rejected.clone(),
            balance: Some(summary(&common)),
            warnings: self.warnings,
            steady,
            diagnoses: None,
        })
    }

    fn usable(&self) -> impl Iterator<Item = (&'a Run, &'a Readings)> + Clone + use<'a> {
        self.campaign.runs.iter().zip(self.readings).filter_map(|(run, readings)| Some((run, readings.as_ref()?)))
    }

    /// The steady runs of one kind, of one hull or of none.
    fn steady(&self, common: &Common, kind: Kind, hull: Option<usize>) -> Vec<SteadyRun<'a>> {
        self.usable()
            .filter(|(run, _)| run.kind == kind && run.hull == hull)
            .filter_map(|(run, readings)| match &readings.useful {
                Useful::Steady(steady) => {
                    common.steady(run, readings, steady, hull.map(|hull| &self.campaign.hulls[hull]))
                }
                _ => None,
            })
            .collect()
    }

    fn oscillations(&self, hull: usize) -> Vec<(&'a Run, &'a Harmonics)> {
        self.usable()
            .filter(|(run, _)| run.hull == Some(hull))
            .filter_map(|(run, readings)| match &readings.useful {
                Useful::Periodic(harmonics) => Some((run, harmonics.as_ref())),
                _ => None,
            })
            .collect()
    }

    fn hull(
        &mut self,
        common: &Common,
        index: usize,
        hull: &Hull,
        options: &Options,
        run_results: &mut [RunResults],
        steady: &mut diagnose::Data,
    ) -> HullResults {
        let statics = self.steady(common, Kind::Static, Some(index));
        let mut turns = self.steady(common, Kind::Arc, Some(index));
        statics::share_noise(&mut turns, &statics);
        let oscillations = self.oscillations(index);
        for run in statics.iter().chain(&turns) {
            note_steps(run, run_results);
        }
        let sweep = statics::sweep(common, &statics, hull);
        steady.add(common, hull, &statics, &sweep);
        let fit = fits::fit(&sweep, options.range_deg);
        let moving = !oscillations.is_empty() || !turns.is_empty();
        let dynamic = if moving && hull.live.is_none() {
            self.warnings.push(format!(
                "{}: oscillations and turns are left out: their inertia needs live_mass_kg, xg_m and izz_kg_m2 in campaign.toml",
                hull.id
            ));
            None
        } else {
            derivatives::fit(common, hull, &oscillations, &turns, fit.as_ref().ok())
        };
        if moving && hull.live.is_some() && dynamic.is_none() {
            self.warnings.push(format!(
                "{}: no derivatives: they need sway runs, or a steady sweep beside yaw runs or turns",
                hull.id
            ));
        }
        let mut reduced = hull_results(hull.clone(), sweep, fit, dynamic);
        reduced.n_runs = statics.len() + turns.len() + oscillations.len();
        reduced.water = Some(self.campaign.water);
        reduced.blockage = self.campaign.cross_section_m.map(|(w, d)| hull.frontal_area_m2() / (w * d));
        reduced
    }

    fn run_results(&self) -> Vec<RunResults> {
        let zeros = |run: &Run, readings: &Readings| -> Option<[f64; 3]> {
            if run.kind == Kind::Zero || self.zeros.zeros.is_empty() {
                return None;
            }
            let rest = readings.rest?;
            Some((rest.readings.mean - self.zeros.at(run, readings, rest.middle_s)?.reading).into())
        };
        self.usable()
            .map(|(run, readings)| RunResults {
                run: run.clone(),
                trace: readings.trace.clone(),
                steps: None,
                effective: match &readings.useful {
                    Useful::Steady(s) => Some(([0, 1, 2].map(|i| s.readings.effective_samples(i)), s.duration_s)),
                    _ => None,
                },
                rest_less_zero: zeros(run, readings),
                notices: readings.notices.clone(),
            })
            .collect()
    }

    fn check_tare_range(&mut self, tare: Option<&Tare>) {
        let Some(tare) = tare else { return };
        self.warnings.extend(tare.warnings.iter().map(|warning| (*warning).to_owned()));
        let yaw_deg = || self.usable().filter(|(run, _)| run.kind == Kind::Static).map(|(run, _)| run.yaw_deg);
        let (lowest, highest) = (yaw_deg().fold(f64::INFINITY, f64::min), yaw_deg().fold(f64::NEG_INFINITY, f64::max));
        let [from_deg, to_deg] = tare.between_deg;
        if lowest < from_deg - 1.0 || highest > to_deg + 1.0 {
            self.warnings.push(format!(
                "the strut was tared from {from_deg:.1} to {to_deg:.1} deg only, static runs go from {lowest:.1} to {highest:.1} deg: the tare is extrapolated there",
            ));
        }
    }
}

fn note_steps(run: &SteadyRun, results: &mut [RunResults]) {
    if let Some(result) = results.iter_mut().find(|result| result.run.order == run.run.order) {
        result.steps = Some(run.steps);
    }
}

fn hull_results(
    hull: Hull,
    sweep: Sweep,
    fit: Result<fits::SweepFit, fits::NoFit>,
    dynamic: Option<Derivatives>,
) -> HullResults {
    let estimates = fit.as_ref().ok().map(|fit| &fit.estimates);
    let reynolds: Vec<f64> = sweep.points.iter().filter_map(|point| point.reynolds).collect();
    let reynolds = (!reynolds.is_empty()).then(|| median(&reynolds));
    let derivatives = dynamic.as_ref().map(|d| &d.estimates);
    let comparisons = match (&fit, dynamic.as_ref()) {
        (Ok(fit), Some(found)) if !found.slopes_from_sweep => derivatives::compare_sweep(&hull, fit, &found.estimates),
        _ => Vec::new(),
    };
    HullResults {
        theory: theory::predict(&hull, reynolds, estimates, derivatives),
        comparisons,
        n_runs: 0,
        water: None,
        blockage: None,
        hull,
        sweep,
        fit,
        dynamic,
    }
}

fn hull_warnings(hull: &HullResults) -> Vec<String> {
    let id = &hull.hull.id;
    let mut warnings = Vec::new();
    match &hull.fit {
        Ok(fit) => {
            warnings.extend(checks::signs(id, &fit.estimates));
            warnings.extend(fits::warnings(id, fit));
        }
        Err(few) if hull.sweep.points.is_empty() && hull.dynamic.is_some() => {
            warnings.push(format!("{id}: no static runs, so no fit ({few})"));
        }
        Err(few) => warnings.push(format!("{id}: no fit: {few}")),
    }
    warnings.extend(checks::drag(hull));
    warnings.extend(checks::dynamic(hull));
    warnings.extend(checks::blockage(hull));
    warnings
}

fn summary(common: &Common) -> BalanceSummary {
    let at_angle = |degrees: f64| {
        let motion = crate::motion::Motion::straight(2.0, degrees.to_radians(), 0.0);
        common.tare.map(|tare| tare.force(&motion, 1000.0).into())
    };
    BalanceSummary {
        zeros: common.zeros.zeros.len(),
        in_time: common.zeros.in_time,
        largest_drift: common.zeros.largest_drift().into(),
        interaction: std::array::from_fn(|i| std::array::from_fn(|j| common.balance.interaction[(i, j)])),
        tare_runs: common.tare.map_or(0, |tare| tare.runs),
        tare_at_2_m_s: at_angle(0.0).zip(at_angle(10.0)).map(|(a, b)| [a, b]),
    }
}
