//! What is said of a fit: causes with their stand-ins, what was rejected and why, where the baseline misses the data.

use nalgebra::DVector;
use rayon::prelude::*;

use super::alternatives::alternatives;
use super::baseline::Baseline;
use super::change_point;
use super::evidence::{Headline, Problem, Quantity, names};
use super::findings::{Cause, Diagnosis, Judged, Left, Rejected, Unexplained, Verdict, Why, Wrong};
use super::fitted::Fitted;
use super::holdout;
use super::iteration::Iteration;
use super::marginal_likelihood::twice_log_bayes_factor;
use super::outcome::{Outcome, Stage, gains};
use super::replacements::{Replacement, replacements};
use super::score::{CLEARLY_WRONG, SIGNIFICANT, chance};
use super::subset_search::SubsetSearch;

/// Share of a mechanism's trace beside the baseline's parameters below which it hardly shows.
const HARDLY_SHOWN: f64 = 0.1;

/// Most covariates that are reported of what nothing explains.
const MOST_REPORTED: usize = 3;

pub(super) fn report(
    problem: &impl Problem,
    baseline: &Baseline,
    extended: &Fitted,
    curve: Option<String>,
    dropped: &[(usize, Why)],
    nuisance: Option<usize>,
) -> Outcome {
    let candidates = problem.candidates();
    let before = baseline.held_out();
    let after = if extended.included.is_empty() { before.clone() } else { extended.held_out() };
    let gains = gains(&baseline.evidence, &before, &after);

    let iteration = Iteration::new(candidates, extended);
    let search = iteration.search();
    let n_names = names(candidates).len() as f64;
    let after_stage = extended.stage(after.clone());
    let mut named: Vec<Named> = (0..extended.included.len())
        .into_par_iter()
        .map(|place| cause(problem, (baseline, extended), &iteration, &search, place, n_names, &after_stage))
        .collect();
    named.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let causes: Vec<Cause> = named.iter().map(|named| named.cause.clone()).collect();

    let mut wrong = wrong(problem, baseline);
    if wrong.is_empty() {
        let first = named.iter().find(|named| Some(named.candidate) != nuisance);
        let missed = |named: &Named| {
            extended.missed(&iteration, named.candidate, [&extended.evidence.column_as_read(&after), &named.without])
        };
        wrong.extend(first.map(|named| wrong_by_cause(problem, baseline, named, &missed(named))));
    }
    let mut depends_on: Vec<String> = curve.into_iter().collect();
    if depends_on.is_empty() && causes.is_empty() {
        // Nothing deserved a name, a curve neither: what is wrong is unexplained all the same.
        for misfit in wrong.iter().filter(|misfit| misfit.quantity == wrong[0].quantity).take(MOST_REPORTED) {
            depends_on.push(misfit.regime.clone());
        }
    }
    let left = left(problem, extended, &iteration);
    if depends_on.is_empty() {
        let relevant = left.iter().filter(|left| left.judged == Judged::Relevant);
        depends_on.extend(relevant.take(1).map(|left| left.depends_on.clone()));
    }
    let unexplained = (!depends_on.is_empty()).then(|| left_over(extended, &left, depends_on));
    let verdict = Verdict::new(!causes.is_empty(), unexplained.is_some());
    let groups: Vec<&[Replacement]> = named.iter().map(|named| named.group.as_slice()).collect();
    let diagnosis = Diagnosis {
        schema: "glidepolar.diagnosis/1",
        verdict,
        consistency: Vec::new(),
        warnings: Vec::new(),
        wrong,
        alternatives: alternatives(problem, extended, &iteration, &groups),
        trim: None,
        shear_share: None,
        empirical: None,
        left,
        rejected: rejected(problem, extended, &iteration, &search, &causes, dropped),
        causes,
        unexplained,
        gain: gains[headline(problem, baseline, &before, &after)].clone(),
        gains,
        extended: None,
    };
    Outcome {
        diagnosis,
        before: baseline.stage(before),
        after: after_stage,
        fitted: extended.included.clone(),
        named: named.iter().map(|named| named.candidate).collect(),
        groups: named.iter().map(|named| named.group.iter().map(|rival| rival.candidate).collect()).collect(),
        gains: named.iter().map(|named| named.gain).collect(),
        refused: dropped.iter().map(|(member, _)| *member).collect(),
        without: named.into_iter().map(|named| named.without).collect(),
    }
}

/// What is left, of the quantity of which most is left in units of its noise; of those in which it is relevant where there are any.
fn left_over(extended: &Fitted, left: &[Left], depends_on: Vec<String>) -> Unexplained {
    let evidence = &extended.evidence;
    let is_relevant = |quantity: usize| {
        left.iter().any(|left| left.judged == Judged::Relevant && left.quantity == evidence.quantities[quantity].name)
    };
    let is_any = (0..evidence.quantities.len()).any(is_relevant);
    let excess = |quantity: usize| -> f64 {
        let sd = |row: usize| extended.noises[quantity].sd(evidence.stated_sd[row]);
        let rows = evidence.quantities[quantity].rows.clone();
        let n = rows.len().max(1) as f64;
        rows.map(|row| (evidence.residual[row] / sd(row)).powi(2)).sum::<f64>() / n
    };
    let asked = (0..evidence.quantities.len()).filter(|quantity| !is_any || is_relevant(*quantity));
    let most = asked.max_by(|a, b| excess(*a).total_cmp(&excess(*b))).unwrap_or(0);
    let quantity = &evidence.quantities[most];
    let rms = holdout::rms(&evidence.column_as_read(&evidence.residual), quantity.rows.clone());
    Unexplained { quantity: quantity.name.to_owned(), rms, depends_on }
}

/// The quantity of which a gain is reported.
pub(super) fn headline(problem: &impl Problem, fitted: &Fitted, before: &DVector<f64>, after: &DVector<f64>) -> usize {
    if problem.headline() == Headline::First {
        return 0;
    }
    let evidence = &fitted.evidence;
    let fall = |quantity: usize| -> f64 {
        let sd = |row: usize| fitted.noises[quantity].sd(evidence.stated_sd[row]);
        let rows = evidence.quantities[quantity].rows.clone();
        rows.map(|row| (before[row].powi(2) - after[row].powi(2)) / sd(row).powi(2)).sum()
    };
    (0..evidence.quantities.len()).max_by(|a, b| fall(*a).total_cmp(&fall(*b))).unwrap_or(0)
}

/// A cause with the figures that it rests on.
pub(super) struct Named {
    pub(super) cause: Cause,
    pub(super) candidate: usize,
    pub(super) group: Vec<Replacement>,
    pub(super) gain: f64,
    pub(super) without: DVector<f64>,
}

pub(super) fn cause(
    problem: &impl Problem,
    (baseline, extended): (&Baseline, &Fitted),
    iteration: &Iteration<'_>,
    search: &SubsetSearch<'_>,
    place: usize,
    n_names: f64,
    stage: &Stage,
) -> Named {
    let candidates = problem.candidates();
    let member = extended.included[place];
    let candidate = &candidates[member];
    let gain = search.gain_of(&extended.included, place);
    let df = iteration.regressors[member].columns.len();
    let parameters = change_point::with_scatter(problem, extended, iteration, place, stage);

    // Fitted anew: where the model bends, slopes taken at this size say little of what is left without it.
    let (before, after) = (extended.without(problem, baseline, place).held_out(), extended.held_out());
    let quantity = &extended.evidence.quantities[headline(problem, extended, &before, &after)];
    let as_read = |left: &DVector<f64>| extended.evidence.column_as_read(left);
    let group = replacements(problem, (baseline, extended), iteration, place, &before, gain);
    let log_likelihood_ratio = |rival: &Replacement| {
        let name = candidates[rival.candidate].name.to_owned();
        (name, -0.5 * twice_log_bayes_factor(iteration, place, (&rival.fitted, rival.candidate)))
    };
    let cause = Cause {
        cause: candidate.name.to_owned(),
        parameters,
        p_value: (n_names * chance(gain, df)).min(1.0),
        delta_bic: gain - df as f64 * iteration.score.effective_rows.ln(),
        quantity: quantity.name.to_owned(),
        holdout_rms_before: holdout::rms(&as_read(&before), quantity.rows.clone()),
        holdout_rms_after: holdout::rms(&as_read(&after), quantity.rows.clone()),
        stability: extended.halves(problem, place),
        indistinguishable_from: group.iter().map(|rival| candidates[rival.candidate].name.to_owned()).collect(),
        log_likelihood_ratio: group.iter().map(log_likelihood_ratio).collect(),
    };
    Named { cause, candidate: member, group, gain, without: as_read(&before) }
}

pub(super) fn rejected(
    problem: &impl Problem,
    extended: &Fitted,
    iteration: &Iteration<'_>,
    search: &SubsetSearch<'_>,
    causes: &[Cause],
    dropped: &[(usize, Why)],
) -> Vec<Rejected> {
    let candidates = problem.candidates();
    let here =
        if extended.included.is_empty() { 0.0 } else { iteration.score.fit(&search.columns(&extended.included)).gain };
    names(candidates)
        .into_iter()
        .filter(|name| !causes.iter().any(|cause| cause.cause == *name))
        .map(|name| {
            let versions = (0..candidates.len()).filter(|i| candidates[*i].name == name);
            let best = versions
                .filter(|i| {
                    iteration.regressors[*i].columns.iter().any(|column| iteration.score.is_identifiable(*column))
                })
                .map(|i| {
                    let mut set = extended.included.clone();
                    set.push(i);
                    let gain = iteration.score.fit(&search.columns(&set)).gain - here;
                    (chance(gain, iteration.regressors[i].columns.len()), i)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((p_value, index)) = best else {
                return Rejected {
                    cause: name.to_owned(),
                    p_value: None,
                    holdout_rms_after: None,
                    why: Why::Equivalent,
                    remark: "these data cannot show it: the baseline's own parameters absorb it".to_owned(),
                };
            };
            let mut with = extended.clone();
            with.included.push(index);
            with.evidence.prior.extend(candidates[index].prior());
            let rows = extended.evidence.quantities[0].rows.clone();
            let stands_in: Vec<&str> = causes
                .iter()
                .filter(|cause| cause.indistinguishable_from.iter().any(|other| other == name))
                .map(|cause| cause.cause.as_str())
                .collect();
            let shown =
                iteration.regressors[index].columns.first().map_or(0.0, |column| iteration.score.remaining(*column));
            let held_out = with.held_out();
            let predicts = holdout::advantage(&extended.evidence, &extended.noises, &extended.held_out(), &held_out)
                >= problem.least_advantage();
            let step = iteration.point_of(&with.included, problem).candidates[index][0];
            let was_dropped = dropped.iter().rev().find(|(member, _)| candidates[*member].name == name);
            let why = match was_dropped {
                _ if !stands_in.is_empty() => Why::Equivalent,
                Some((_, why)) => *why,
                None if p_value >= SIGNIFICANT => Why::ByChance,
                None if candidates[index].cannot_be(step) => Why::SizeImpossible,
                None if !predicts => Why::PredictsNoBetter,
                // It predicts, and something else predicts as much of the same.
                None => Why::Equivalent,
            };
            let mut remark = if !stands_in.is_empty() {
                format!("cannot be distinguished from {} in these data", stands_in.join(", "))
            } else if why == Why::ByChance && p_value >= SIGNIFICANT {
                format!("explains no more than chance would beside what is named (p = {p_value:.2})")
            } else {
                format!("explains a part (p = {p_value:.1e}), but {}", reason(why))
            };
            if shown < HARDLY_SHOWN {
                remark += &format!("; beside the baseline's own parameters {:.1} % of its trace shows", 100.0 * shown);
            }
            Rejected {
                cause: name.to_owned(),
                p_value: Some(p_value),
                holdout_rms_after: Some(holdout::rms(&extended.evidence.column_as_read(&held_out), rows)),
                why,
                remark,
            }
        })
        .collect()
}

/// Why a mechanism that explains a part was not named.
fn reason(why: Why) -> &'static str {
    match why {
        Why::PredictsNoBetter => "predicts held-out data no better",
        Why::SizeVaries => "needs another size in another regime",
        Why::SizeImpossible => "needs a size that nature does not have",
        Why::SpoilsQuantity => "makes another quantity worse on held-out data",
        Why::ByChance => "by the scatter between legs or runs, or among so many, no more than chance would",
        Why::Equivalent => "others explain the same part",
        Why::HardlyKnown => "its size is known to so few standard errors that a law that resembles it might do as well",
    }
}

/// Where the baseline alone misses the data: along which covariate, in which quantity.
pub(super) fn wrong(problem: &impl Problem, baseline: &Fitted) -> Vec<Wrong> {
    let iteration = Iteration::new(problem.candidates(), baseline);
    let limits = baseline.limits(problem);
    let evidence = &baseline.evidence;
    let tests = iteration.curves.len().max(1) as f64;
    let (misfits, expected) = misfits_and_noise(baseline);
    let mut found: Vec<Wrong> = Vec::new();
    for curve in &iteration.curves {
        // What quantities share is reported for each.
        let Some(quantity_index) = curve.quantity else { continue };
        if iteration.least_sizes(&[], &[curve.regressor])[quantity_index] <= limits[quantity_index] {
            continue;
        }
        let size = iteration.sizes(&[], &[curve.regressor])[quantity_index];
        let p_value = (tests * iteration.chance(&[], &[curve.regressor])).min(1.0);
        if p_value > CLEARLY_WRONG {
            continue;
        }
        let quantity = &evidence.quantities[quantity_index];
        match found.iter_mut().find(|known| known.regime == curve.covariate && known.quantity == quantity.name) {
            Some(known) if known.p_value <= p_value => {}
            Some(known) => (known.p_value, known.size) = (p_value, size),
            None => found.push(Wrong {
                size,
                relevant_above: limits[quantity_index],
                quantity: quantity.name.to_owned(),
                regime: curve.covariate.to_owned(),
                rms: holdout::rms(&misfits, quantity.rows.clone()),
                expected_rms: holdout::rms(&expected, quantity.rows.clone()),
                p_value,
            }),
        }
    }
    found.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    found
}

/// Where the baseline misses the data as a named mechanism says: its effect finds what a curve along one covariate does not. Its size is
/// the one by which it was kept: what it changes by the slopes, or what held-out readings are missed by without it.
fn wrong_by_cause(problem: &impl Problem, baseline: &Fitted, named: &Named, missed: &[f64]) -> Wrong {
    let evidence = &baseline.evidence;
    let (misfits, expected) = misfits_and_noise(baseline);
    let sizes = if problem.judges_largest() {
        Iteration::new(problem.candidates(), baseline).size_where_it_acts(&[], named.candidate)
    } else {
        missed.to_vec()
    };
    let limits = baseline.limits(problem);
    let worth = |quantity: &usize| sizes[*quantity] / limits[*quantity];
    let most = (0..limits.len()).max_by(|a, b| worth(a).total_cmp(&worth(b))).unwrap_or(0);
    let quantity = &evidence.quantities[most];
    Wrong {
        quantity: quantity.name.to_owned(),
        regime: Wrong::regime_of(&named.cause.cause),
        rms: holdout::rms(&misfits, quantity.rows.clone()),
        expected_rms: holdout::rms(&expected, quantity.rows.clone()),
        size: sizes[most],
        relevant_above: limits[most],
        p_value: named.cause.p_value,
    }
}

/// Measured less modelled in each reading, and the standard deviation of its noise.
fn misfits_and_noise(fitted: &Fitted) -> (DVector<f64>, DVector<f64>) {
    let evidence = &fitted.evidence;
    (evidence.column_as_read(&evidence.residual), DVector::from_vec(evidence.sd_as_read(fitted.sd())))
}

/// For each quantity the clearest dependence that is left beside what is included, relevant or not.
fn left(problem: &impl Problem, extended: &Fitted, iteration: &Iteration<'_>) -> Vec<Left> {
    let limits = extended.limits(problem);
    let tests = iteration.curves.len().max(1) as f64;
    let of = |(index, quantity): (usize, &Quantity)| {
        let curves = iteration.curves.iter().filter(|curve| curve.quantity == Some(index));
        let (p_value, curve) = curves
            .map(|curve| (iteration.chance(&extended.included, &[curve.regressor]), curve))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let size = iteration.sizes(&extended.included, &[curve.regressor])[index];
        let p_value = (tests * p_value).min(1.0);
        let least = || iteration.least_sizes(&extended.included, &[curve.regressor])[index];
        let with = || extended.included.iter().copied().chain([curve.regressor]).collect::<Vec<usize>>();
        let judged = if size <= limits[index] {
            Judged::NotRelevant
        } else if p_value > CLEARLY_WRONG {
            Judged::ByChance
        } else if least() <= limits[index] {
            Judged::SizeUncertain
        } else if !iteration.predicts_better(&with(), &extended.included) {
            Judged::PredictsNoBetter
        } else {
            Judged::Relevant
        };
        Some(Left {
            quantity: quantity.name.to_owned(),
            depends_on: curve.covariate.to_owned(),
            size,
            relevant_above: limits[index],
            p_value,
            judged,
        })
    };
    extended.evidence.quantities.iter().enumerate().filter_map(of).collect()
}
