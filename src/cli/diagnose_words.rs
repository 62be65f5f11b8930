//! The words of a diagnosis, the same in the table and on the page.

use crate::diagnose::score::CLEARLY_WRONG;
use crate::diagnose::{Check, Checked, Diagnosis, Empirical, Judged, Left, Verdict};
use crate::estimate::Estimate;

/// The table that the extension carries for what is unexplained.
pub(super) fn table_without_cause(table: &Empirical) -> String {
    let of = |values: &[f64]| values.iter().map(|value| format!("{value:.3}")).collect::<Vec<_>>().join(", ");
    format!(
        "empirical table, no cause: {} {} at {} {}; held-out {} {:.2} -> {:.2} mm/s",
        words(table.acts_on),
        of(&table.values),
        words(table.against),
        of(&table.at),
        words(&table.gain.quantity),
        table.gain.holdout_rms_before * 1e3,
        table.gain.holdout_rms_after * 1e3
    )
}

/// Probability above which a dependence is said to be one that chance brings: the usual 5 %.
const ORDINARY_CHANCE: f64 = 0.05;

/// What is left of a quantity, relevant or not.
pub(super) fn left_over(left: &Left) -> String {
    let limit = format!("with a limit of {:.2} mm/s", left.relevant_above * 1e3);
    let judged = match left.judged {
        Judged::NotRelevant => format!("not relevant {limit}"),
        Judged::ByChance if left.p_value > ORDINARY_CHANCE => "which chance explains".to_owned(),
        Judged::ByChance => {
            let clear = crate::report::probability(CLEARLY_WRONG);
            format!("less clear than what counts, {clear}: logs with nothing wrong show as much now and then")
        }
        Judged::SizeUncertain => format!("relevant {limit} or not: the interval of its size holds the limit"),
        Judged::PredictsNoBetter => "which predicts held-out data no better".to_owned(),
        Judged::Relevant => format!("relevant {limit}"),
    };
    format!(
        "{} depends on {} by {:.2} mm/s rms at most ({}), {judged}",
        words(&left.quantity),
        left.depends_on,
        left.size * 1e3,
        crate::report::probability(left.p_value)
    )
}

/// How much of the effect of its own shear a log shows, in a clause.
pub(super) fn shown_shear(share: &Estimate) -> String {
    let [low, high] = share.ci95;
    let Estimate { value, se, .. } = share;
    format!(
        "the readings show {value:.2} ± {se:.2} of the effect of the log's own shear (95 %: {low:.2} to {high:.2}), 1 by Newton's law"
    )
}

/// Whether a neutral baseline is wrong for nothing but the glider's trim.
pub(super) fn is_explained_by_trim(found: &Diagnosis) -> bool {
    found.verdict == Verdict::None && found.trim.is_some() && !found.wrong.is_empty()
}

/// Factor and unit in which a quantity is shown.
pub(super) fn shown_in(quantity: &str) -> (f64, &'static str) {
    match quantity {
        "turn_rate" => (1f64.to_degrees(), "deg/s"),
        "roll" => (1f64.to_degrees(), "deg"),
        _ => (1e3, "mm/s"),
    }
}

/// By how much an error became less, or more.
pub(super) fn less(percent: f64) -> String {
    format!("{:.0} % {}", percent.abs(), if percent < 0.0 { "more" } else { "less" })
}

/// A check in a line.
pub(super) fn checked(check: &Check) -> String {
    let outcome = match check.outcome {
        Checked::Consistent => "consistent",
        Checked::Corrected => "wrong, corrected",
        Checked::Wrong => "wrong",
        Checked::NotChecked => "not checked",
    };
    format!("{}: {outcome}: {}", check.check, check.says)
}

pub(super) fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::None => "none",
        Verdict::Explained => "explained",
        Verdict::PartlyExplained => "explained in part",
        Verdict::Unexplained => "unexplained: something is wrong, and no known mechanism fits",
    }
}

/// A parameter with its standard error.
pub(super) fn size(name: &str, estimate: &Estimate) -> String {
    format!("{name} = {}{}", crate::report::estimate(estimate.value, estimate.se), unit(estimate))
}

/// The unit after a number; nothing after one that has none.
pub(super) fn unit(estimate: &Estimate) -> String {
    if matches!(estimate.unit.as_str(), "" | "1") { String::new() } else { format!(" {}", estimate.unit) }
}

pub(super) fn words(name: &str) -> String {
    name.replace('_', " ")
}
