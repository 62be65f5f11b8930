//! What dives that were not fitted say of a term.

use std::collections::BTreeSet;

use glidepolar_inference::estimate::Estimate;

use super::findings::ROLL;
use super::fit::Fit;
use super::model::{Row, Term, dives, predicted};
use crate::sd;

/// Most parts into which the dives are cut, each predicted from the others.
const FOLDS: usize = 10;

/// Errors of a quantity on dives that were not fitted, without and with a term.
pub(super) struct HeldOut {
    /// Sums of squares for each dive.
    by_dive: Vec<[f64; 2]>,
    rows: usize,
}

impl HeldOut {
    /// None where one of the models cannot be fitted without a part of the dives.
    pub(super) fn new(rows: &[Row], quantity: &str, without: &[Term], with: &[Term]) -> Option<HeldOut> {
        let dives = dives(rows);
        let mut by_dive = vec![[0.0; 2]; dives.len()];
        let folds = dives.len().min(FOLDS);
        for fold in 0..folds {
            let place = |row: &Row| dives.binary_search(&row.stretch.dive).unwrap_or(0);
            let (left, kept): (Vec<Row>, Vec<Row>) = rows.iter().partition(|row| place(row) % folds == fold);
            for (k, terms) in [without, with].into_iter().enumerate() {
                let fit = Fit::new(&kept, terms, None)?;
                for row in &left {
                    let [rate, roll] = predicted(row, terms, &fit.values);
                    let error =
                        if quantity == ROLL { row.stretch.roll_rad - roll } else { row.stretch.rate_rad_s - rate };
                    by_dive[place(row)][k] += error * error;
                }
            }
        }
        Some(HeldOut { by_dive, rows: rows.len() })
    }

    pub(super) fn rms(&self) -> [f64; 2] {
        [0, 1].map(|k| (self.by_dive.iter().map(|dive| dive[k]).sum::<f64>() / self.rows as f64).sqrt())
    }

    /// Whether the relative gain exceeds zero by a standard error, each dive being one.
    pub(super) fn gains_by_dives(&self) -> bool {
        let gains: Vec<f64> = self.by_dive.iter().map(|dive| 0.5 * (dive[0] / dive[1]).ln()).collect();
        let n = gains.len() as f64;
        gains.iter().sum::<f64>() / n > sd(&gains) / n.sqrt()
    }

    /// By how many per cent the error falls, with a 95 % interval by leaving out one dive at a time.
    pub(super) fn reduction_percent(&self) -> Estimate {
        let n = self.by_dive.len() as f64;
        let [before, after] = [0, 1].map(|k| self.by_dive.iter().map(|dive| dive[k]).sum::<f64>());
        let log = |before: f64, after: f64| 0.5 * (after / before).ln();
        let whole = log(before, after);
        let parts: Vec<f64> = self.by_dive.iter().map(|dive| log(before - dive[0], after - dive[1])).collect();
        let mean = parts.iter().sum::<f64>() / n;
        let se = ((n - 1.0) / n * parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>()).sqrt();
        let percent = |log: f64| 100.0 * (1.0 - log.exp());
        let [low, high] = Estimate::student(whole, se, n - 1.0, "").ci95;
        Estimate {
            value: percent(whole),
            se: 100.0 * whole.exp() * se,
            ci95: [percent(high), percent(low)],
            unit: "%".to_owned(),
        }
    }
}

/// Size and standard error on the first and the second half of the dives.
pub(super) fn halves(rows: &[Row], terms: &[Term], of: impl Fn(&Fit) -> Option<[f64; 2]>) -> Vec<(f64, f64)> {
    let dives = dives(rows);
    let middle = dives[dives.len() / 2];
    let half = |second: bool| {
        let part: Vec<Row> = rows.iter().filter(|row| (row.stretch.dive >= middle) == second).copied().collect();
        let [value, se] = Fit::new(&part, terms, None).as_ref().and_then(&of)?;
        Some((value, se))
    };
    [false, true].into_iter().map(half).collect::<Option<Vec<_>>>().unwrap_or_default()
}

pub(super) fn delta_bic(rows: &[Row], before: f64, after: f64) -> f64 {
    let legs: BTreeSet<(u32, bool)> = rows.iter().map(|row| (row.stretch.dive, row.stretch.descends)).collect();
    let n = legs.len() as f64;
    2.0 * n * (before / after).ln() - n.ln()
}
