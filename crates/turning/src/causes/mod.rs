//! What makes a glider turn or lean that should not: list, rudder or roll mass off their zeros, drag on one side, an attitude
//! sensor that is mounted askew.
//!
//! Each steady stretch gives two readings, its turn rate and its roll:
//!
//! ```text
//! turn rate = V (c + k_delta delta + k_leg cot|theta| (roll - e))
//! roll      = e + atan((g sin(gamma + gamma0) + tan list) / (1 + g (cos(gamma + gamma0) - 1))) + k_roll delta V^2 + k_p V r tan theta / cos theta
//! ```
//!
//! `V` is the leg's median speed by depth rate and pitch. The side component of the net weight turns a rolled glider: it is
//! proportional to `cot theta` times the drag and changes its sign with the leg. So the parity in leg and roll separates causes.
//! A rudder's offset or drag on one side (`c`) turns both legs alike. A list (`gamma0` or `list`) turns them apart and is read as
//! roll. A sensor that is askew (`e`) is read as roll and turns nothing. What has the same signs in both is one group: offset of
//! the rudder and drag on one side, and, but for the cosine of large angles, offset of the roll mass and list.
//!
//! A size must be more than chance explains ([`MOST_CHANCE`]) with all other sizes fitted beside it, exceed a limit of relevance by
//! a standard error, and predict held-out dives better by one. Rivals are refitted in its place; those that are not worse
//! for certain are its group.

mod findings;
mod fit;
mod held_out;
mod model;
mod questions;

use glidepolar_flightlog::Observation;

use super::{LEAST_DIVES, LEAST_STRETCHES};
pub use findings::{
    LateralCause, LateralDiagnosis, LateralRejected, MOST_CHANCE, RELEVANT_ROLL_RAD, RELEVANT_YAW_RAD_M, ROLL,
    TURN_RATE,
};
use fit::Fit;
use model::{Row, Term, dives, rows};
use questions::Terms;

/// The causes; nothing where [`turning`](super::turning) has too few steady stretches, or the log has no roll.
pub fn causes(observations: &[Observation]) -> Option<LateralDiagnosis> {
    let rows: Vec<Row> = rows(observations);
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
        sizes: [Some(full.sum(&[(Term::List, 1.0), (Term::Zero, 1.0)])), full.size(Term::Yaw)],
        rudder_per_roll: full.rudder_per_roll(),
    };
    terms.lean(&rows, &full, &mut found);
    terms.yaw(&rows, &full, &mut found);
    found.causes.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    Some(found)
}
