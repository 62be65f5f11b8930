//! Is the three-parameter model of the right kind? Other forms on the same points, compared by how well each predicts a
//! point that it did not see (leave one out).

use crate::angle_regression::{Basis, problem, scatter};
use crate::sweep::Sweep;

/// The forms tried for CL, CD and CM, the model itself first.
pub type Adequacy = [Vec<Candidate>; 3];

/// One form of a model.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The form, `x` being the angle in radians.
    pub form: &'static str,
    /// Root mean square of the errors of prediction, each point left out in turn.
    pub left_out_rms: f64,
    /// Its parameters and their standard errors, in the order of the form.
    pub parameters: Vec<(f64, f64)>,
}

/// Every form, by coefficient. Crossflow puts `x|x|` into CL and CM and with it `|x|^3` into CD (Allen and Perkins 1951).
const FORMS: [&[(&str, Basis)]; 3] = [
    &[
        ("x", &[|x| x]),
        ("1 + x", &[|_| 1.0, |x| x]),
        ("x + x|x|", &[|x| x, |x| x * x.abs()]),
        ("1 + x + x|x|", &[|_| 1.0, |x| x, |x| x * x.abs()]),
        ("1 + x + x^3", &[|_| 1.0, |x| x, |x| x * x * x]),
    ],
    &[
        ("1 + x^2", &[|_| 1.0, |x| x * x]),
        ("1 + x + x^2", &[|_| 1.0, |x| x, |x| x * x]),
        ("1 + x^2 + |x|^3", &[|_| 1.0, |x| x * x, |x| x.abs().powi(3)]),
        ("1 + x^2 + |x|^3 + x^3", &[|_| 1.0, |x| x * x, |x| x.abs().powi(3), |x| x * x * x]),
    ],
    &[
        ("x", &[|x| x]),
        ("1 + x", &[|_| 1.0, |x| x]),
        ("x + x|x|", &[|x| x, |x| x * x.abs()]),
        ("1 + x + x|x|", &[|_| 1.0, |x| x, |x| x * x.abs()]),
        ("1 + x + x^3", &[|_| 1.0, |x| x, |x| x * x * x]),
    ],
];

/// Tries every form on some points of a sweep; forms with too many parameters for the points are left out.
pub fn test(sweep: &Sweep, rows: &[usize]) -> Adequacy {
    [0, 1, 2].map(|coefficient| {
        FORMS[coefficient]
            .iter()
            .filter_map(|(form, basis)| {
                let problem = problem(sweep, rows, coefficient, basis);
                let fit = problem.solve(scatter(sweep))?;
                Some(Candidate {
                    form,
                    left_out_rms: fit.left_out_rms(&problem.design)?,
                    parameters: (0..basis.len()).map(|j| (fit.parameters[j], fit.covariance[(j, j)].sqrt())).collect(),
                })
            })
            .collect()
    })
}
