//! How the coefficients change with length to diameter ratio, hull by hull one point, errors that the hulls share (one
//! strut, one set of zeros) taken into account.

use glidepolar_hull::hull_tests::{Estimate, Slope};
use nalgebra::{DMatrix, DVector};

use crate::fits::SweepFit;
use crate::sweep::Sweep;
use glidepolar_inference::covariance::inverse_if_independent;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The straight line of one coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Slope per unit of length to diameter ratio.
    pub slope: Estimate,
    /// Value at the mean ratio.
    pub middle: f64,
    /// The mean ratio.
    pub mean_ldr: f64,
    /// Probability of so much scatter about the line if a line is right.
    pub p_value: f64,
}

/// The lines of a, b, c, d.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines(pub [Line; 4]);

/// Name, unit of the slope, index of the fit and of its parameter.
pub const COEFFICIENTS: [(&str, &str, usize, usize); 4] =
    [("a", "1/rad", 0, 0), ("b", "1", 1, 0), ("c", "1/rad^2", 1, 1), ("d", "1/rad", 2, 0)];

/// A line is doubted below this probability, and its interval then rests on the scatter about it.
const DOUBTED: f64 = 0.05;

/// The lines through three hulls or more of different ratios.
pub fn fit(hulls: &[(f64, &Sweep, &SweepFit)]) -> Option<Lines> {
    let lines: Option<Vec<Line>> =
        COEFFICIENTS.iter().map(|(_, unit, fit, parameter)| line(hulls, unit, *fit, *parameter)).collect();
    lines?.try_into().ok().map(Lines)
}

fn line(hulls: &[(f64, &Sweep, &SweepFit)], unit: &str, fit: usize, parameter: usize) -> Option<Line> {
    let n = hulls.len();
    if n < 3 {
        return None;
    }
    let mean_ldr = hulls.iter().map(|(ldr, ..)| ldr).sum::<f64>() / n as f64;
    let design = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { hulls[i].0 - mean_ldr });
    let observed = DVector::from_iterator(n, hulls.iter().map(|(_, _, f)| f.fits[fit].parameters[parameter]));
    let covariance = covariance(hulls, fit, parameter);
    let weight = inverse_if_independent(&covariance)?;
    let own = inverse_if_independent(&(design.transpose() * &weight * &design))?;
    let parameters = &own * design.transpose() * &weight * &observed;
    let residuals = &observed - &design * &parameters;
    let chi2 = (residuals.transpose() * &weight * &residuals)[(0, 0)];
    let dof = (n - 2) as f64;
    let p_value = ChiSquared::new(dof).map_or(1.0, |d| d.sf(chi2));
    let (variance, dof) = if p_value < DOUBTED {
        (own[(1, 1)] * chi2 / dof, dof)
    } else {
        // The hulls' own degrees of freedom together.
        (own[(1, 1)], hulls.iter().map(|(_, _, f)| f.fits[fit].parameter_dof[parameter]).sum())
    };
    Some(Line {
        slope: Estimate::student(parameters[1], variance.max(0.0).sqrt(), dof, unit),
        middle: parameters[0],
        mean_ldr,
        p_value,
    })
}

/// Covariance of one coefficient between hulls.
fn covariance(hulls: &[(f64, &Sweep, &SweepFit)], fit: usize, parameter: usize) -> DMatrix<f64> {
    let n = hulls.len();
    let mut total = DMatrix::zeros(n, n);
    let gains: Vec<DVector<f64>> = hulls.iter().map(|(_, _, f)| f.fits[fit].gain.row(parameter).transpose()).collect();
    let sweeps: Vec<&Sweep> = hulls.iter().map(|(_, sweep, _)| *sweep).collect();
    for i in 0..n {
        total[(i, i)] = hulls[i].2.fits[fit].own_covariance[(parameter, parameter)];
    }
    // Those that the campaign's hulls share stand first, in the same order for every hull.
    let felt =
        |i: usize, k: usize| Some((sweeps[i].shared.get(k)?.influence[fit].of_rows(&hulls[i].2.rows), &gains[i]));
    for i in 0..n {
        for (k, shared) in sweeps[i].shared.iter().enumerate() {
            for j in (0..n).filter(|j| *j == i || shared.is_common) {
                let Some(((one, gain), (other, other_gain))) = felt(i, k).zip(felt(j, k)) else { continue };
                total[(i, j)] += one.covariance(gain, &other, other_gain);
            }
        }
    }
    total
}

impl Lines {
    /// As `fits.json` has them.
    pub fn slopes(&self) -> [Slope; 4] {
        self.0.clone().map(|line| Slope { slope_per_ldr: line.slope })
    }
}
