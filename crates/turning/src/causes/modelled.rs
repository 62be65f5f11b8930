//! What the model says of each stretch, before and after the causes that are named: for a figure.

use super::findings::{LateralCause, ModelledStretch, ROLL, TURN_RATE};
use super::fit::Fit;
use super::model::{Row, Term, predicted, term_of};
use super::terms::Terms;

/// Fits the model without and with the named causes; none where nothing is named.
pub(super) fn modelled(rows: &[Row], terms: &Terms, causes: &[LateralCause]) -> Vec<ModelledStretch> {
    let of = |quantity: &'static str| causes.iter().filter(move |cause| cause.quantity == quantity);
    let leans: Vec<Term> = of(ROLL).filter_map(|cause| term_of(cause.cause)).collect();
    let (yaws, is_leaned) = (of(TURN_RATE).next().is_some(), !leans.is_empty());
    let (mut before, after) =
        if is_leaned { (terms.with(&[]), terms.with(&leans)) } else { (terms.all(), terms.all()) };
    before.retain(|term| !yaws || *term != Term::Yaw);
    let fits = [Fit::new(rows, &before, None), Fit::new(rows, &after, None)];
    let ([Some(without), Some(with)], false) = (fits, causes.is_empty()) else { return Vec::new() };
    // A cause of the roll moves a stretch along the law of the turn rate: it is modelled at the roll that the model has.
    let place = |row: &Row, terms: &[Term], fit: &Fit| {
        let measured = row.stretch.roll_rad;
        let roll = if is_leaned { predicted(row, terms, &fit.values)[1] } else { measured };
        let mut rolled = *row;
        rolled.stretch.roll_rad = roll;
        [roll, predicted(&rolled, terms, &fit.values)[0]]
    };
    rows.iter()
        .map(|row| ModelledStretch {
            descends: row.stretch.descends,
            measured: [row.stretch.roll_rad, row.stretch.rate_rad_s],
            before: place(row, &before, &without),
            after: place(row, &after, &with),
        })
        .collect()
}
