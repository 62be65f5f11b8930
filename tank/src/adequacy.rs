//! Is the three-parameter model of the right kind? Other forms on the same points, compared by how well each predicts a
//! point that it did not see (leave one out).

use nalgebra::DMatrix;

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
                    left_out_rms: left_out_rms(&problem.design, &fit)?,
                    parameters: (0..basis.len()).map(|j| (fit.parameters[j], fit.covariance[(j, j)].sqrt())).collect(),
                })
            })
            .collect()
    })
}

/// Errors of prediction in closed form: `r_i / (1 - h_i)` with the leverage `h_i`.
fn left_out_rms(design: &DMatrix<f64>, fit: &crate::regression::Regression) -> Option<f64> {
    let n = design.nrows();
    let mut sum = 0.0;
    for i in 0..n {
        let leverage = (design.row(i) * fit.gain.column(i))[(0, 0)];
        // A point that alone decides a parameter cannot be predicted from the others.
        if leverage > 1.0 - 1e-9 {
            return None;
        }
        sum += (fit.residuals[i] / (1.0 - leverage)).powi(2);
    }
    Some((sum / n as f64).sqrt())
}
