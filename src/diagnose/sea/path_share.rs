//! The share of the time by which the path follows the pitch late, as a parameter of the baseline.
//!
//! It is 1 by Newton's law, as far as the masses that turn with the hull are known: to a fifth. It is 0 in a log that was simulated with an
//! angle of attack that is in balance at every moment, with or without inertia along the path. A clock that is late does the same as a
//! path that is, so the share must stay within its range whatever the data ask for: the parameter is the logarithm of its odds there,
//! ```text
//! share = LEAST + (MOST - LEAST) / (1 + exp(-log_odds))
//! ```
//! Knows no data.

/// Its name in the baseline, and its unit.
pub(super) const PATH_LOG_ODDS: (&str, &str) = ("path_log_odds", "1");

/// The range of the share: a fifth beyond 0 and 1.
const LEAST: f64 = -0.2;
/// See [`LEAST`].
const MOST: f64 = 1.2;

/// Mean and standard deviation of the prior of the log-odds. At the mean, `ln 6`, the share is 1; there it has a standard deviation of 0.34,
/// and a share of 0, at `-ln 6`, is within two.
const PRIOR: [f64; 2] = [1.791_759_469_228_055, 2.0];

/// Where a fit starts.
pub(super) const START: f64 = PRIOR[0];

/// The share at these log-odds.
pub(super) fn share(log_odds: f64) -> f64 {
    LEAST + (MOST - LEAST) / (1.0 + (-log_odds).exp())
}

/// The slope of the share along its log-odds.
pub(super) fn slope(log_odds: f64) -> f64 {
    let share = share(log_odds);
    (share - LEAST) * (MOST - share) / (MOST - LEAST)
}

/// What is believed of the log-odds, as a residual and its standard deviation.
pub(super) fn prior(log_odds: f64) -> (f64, f64) {
    (PRIOR[0] - log_odds, PRIOR[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Problem;
    use crate::diagnose::sea::{DiagnosisSettings, SeaProblem, steady_log};
    use crate::vehicle::Vehicle;

    /// Of glides whose pitch hunts.
    #[test]
    fn its_column_is_the_slope_of_what_is_read() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = steady_log::log(&parameters);
        let problem = SeaProblem::new(&log, &parameters, DiagnosisSettings::default()).expect("enough bins");
        let at = |log_odds: f64| {
            let mut point = problem.start();
            point.baseline[problem.place_of_path()] = log_odds;
            problem.evidence(&point)
        };
        let by_difference = (at(0.3 - 1e-3).residual - at(0.3 + 1e-3).residual) / 2e-3;
        let slope = at(0.3).baseline.column(problem.place_of_path()).into_owned();
        assert!(slope.amax() > 1e-5 && (&slope - by_difference).amax() < 0.03 * slope.amax());
    }

    #[test]
    fn a_share_stays_within_its_range_and_is_1_where_a_fit_starts() {
        assert!((share(START) - 1.0).abs() < 1e-12 && share(-START).abs() < 1e-12);
        assert!([-800.0, -3.0, 0.0, 4.0, 800.0].iter().all(|at| (LEAST..=MOST).contains(&share(*at))));
        for at in [-2.0, 0.3, 1.7] {
            let by_difference = (share(at + 1e-5) - share(at - 1e-5)) / 2e-5;
            assert!((slope(at) - by_difference).abs() < 1e-9, "{at}");
        }
        // One standard deviation in the share, where it is 1.
        assert!((slope(START) * PRIOR[1] - 0.343).abs() < 1e-3);
    }
}
