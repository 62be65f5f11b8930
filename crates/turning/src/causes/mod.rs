//! What makes a glider turn or lean that should not: list, rudder or roll mass off their zeros, drag on one side, an attitude
//! sensor that is mounted askew.
//!
//! Each steady stretch gives its turn rate and its roll, and with a roll mass and a battery that is read its pitch:
//!
//! ```text
//! turn rate = V (c + k_delta delta + (k_leg + b_leg sin^2 phi + h_leg L) L sin phi),      phi = roll - e
//! roll      = e + atan((g sin(gamma + gamma0) + tan list + k_p V r tan theta / cos phi) / (1 + g (cos(gamma + gamma0) - 1)))
//!               + k_roll delta V^2
//! path      = |theta| + kappa / tan |theta|,   V = depth rate / sin(path),   L = cos(theta) / sin(path)
//! ln tan |theta| = mean of the leg + k x + s ln cos phi - ln(1 + g (cos(gamma + gamma0) - 1)) + e3 phi / (sin theta cos theta)
//! ```
//!
//! `V` is the stretch's own speed: at the turn of a leg a glider is slow, and there its control leans it. The side component of the net
//! weight turns a rolled glider: it is proportional to `L` times the drag and changes its sign with the leg. So the parity in leg and
//! roll separates causes. A rudder's offset or drag on one side (`c`) turns both legs alike. A list (`list`) or an offset of the roll
//! mass (`gamma0`) turns them apart and is read as roll. A sensor that is askew (`e`) is read as roll and turns nothing. Offset of the
//! rudder and drag on one side are one group. List and offset of the roll mass differ in the second order of the angle of the roll
//! mass, and at `g` = 1/2 not even there; in the pitch they differ in the first.
//!
//! A size must be more than chance explains ([`MOST_CHANCE`]) with all other sizes fitted beside it, exceed a limit of relevance by
//! a standard error, and predict held-out dives better by one. What turns both legs alike must be alike on both. Of list
//! and offset of the roll mass the list is named, unless the other is more probable by a factor of the square root of ten; what a factor
//! of twenty does not exclude is its group.

mod findings;
mod fit;
mod held_out;
mod lean;
mod model;
mod modelled;
mod terms;
mod yaw;

use glidepolar_flightlog::Observation;

use super::{LEAST_DIVES, LEAST_STRETCHES};
pub use findings::{
    LateralCause, LateralDiagnosis, LateralRejected, MOST_CHANCE, ModelledStretch, RELEVANT_ROLL_RAD,
    RELEVANT_YAW_RAD_M, ROLL, TURN_RATE,
};
use fit::Fit;
use model::{Row, Term, dives, rows};
use terms::Terms;

/// What the vehicle's file says, for what stands still in a log.
#[derive(Debug, Clone, Copy, Default)]
pub struct KnownTurning {
    /// Roll per roll mass at small angles.
    pub roll_per_roll_mass: Option<f64>,
    /// Curvature per rudder \[1/m\].
    pub curvature_per_rudder: Option<f64>,
}

/// The causes; nothing where [`turning`](super::turning) has too few steady stretches, or the log has no roll.
pub fn causes(observations: &[Observation], known: KnownTurning) -> Option<LateralDiagnosis> {
    let mut rows: Vec<Row> = rows(observations);
    for row in &mut rows {
        row.roll_per_roll_mass = known.roll_per_roll_mass.unwrap_or(0.0);
        row.curvature_per_rudder = known.curvature_per_rudder.unwrap_or(0.0);
    }
    let dives = dives(&rows);
    if rows.len() < LEAST_STRETCHES || dives.len() < LEAST_DIVES {
        return None;
    }
    let terms = Terms::of(&rows);
    let full = Fit::new(&rows, &terms.all(), None)?;
    let mut found = LateralDiagnosis {
        stretches: rows.len(),
        causes: Vec::new(),
        rejected: Vec::new(),
        sizes: [Some(full.sum(&[(Term::List, 1.0), (Term::Zero, 1.0)])), terms.curvature(&rows)],
        rudder_per_roll: full.rudder_per_roll(),
        modelled: Vec::new(),
    };
    terms.lean(&rows, &full, &mut found);
    terms.yaw(&rows, &full, &mut found);
    found.causes.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    found.modelled = modelled::modelled(&rows, &terms, &found.causes);
    Some(found)
}
