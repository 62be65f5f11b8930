//! How a change of the drag divides between the legs of a vehicle whose polar differs from leg to leg.
//!
//! One `b` is fitted, that of descents. Where it is not the vehicle's, the ascents' follows in one of two ways: the hull is rougher or
//! was measured by another scale, and both legs have a share of their own; or something was added that has the same drag on both (a
//! pod, a fin at an angle), and the ratio of the legs falls. With the vehicle's `b0` and its ratio `r`, the added part being a share `s` of
//! the change,
//! ```text
//! b_ascent = r b + s (1 - r) (b - b0)            ratio = r + s (1 - r) (1 - b0 / b)
//! ```
//! The share is a parameter of the baseline, known to lie between 0 and 1. A ratio held would make of an added drag a drag that differs
//! between the legs; where `b` is the vehicle's, the share changes nothing, and such a difference shows as before. Knows no data.

use nalgebra::{DMatrix, DVector};

use super::SeaProblem;
use super::model::Directions;
use crate::diagnose::evidence::Point;
use crate::dynamics::{Parameters, parameter_index};

/// Its name in the baseline, and its unit.
pub(super) const COMMON_DRAG_SHARE: (&str, &str) = ("common_drag_share", "1");

/// Mean and standard deviation of what lies between 0 and 1, and nothing more is known of: `1 / sqrt(12)`.
const PRIOR: [f64; 2] = [0.5, 0.288_675_134_594_812_9];

/// The drag of a vehicle whose legs differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CommonDrag {
    b: f64,
    ratio: f64,
    /// The direction of the ratio.
    direction: usize,
}

impl CommonDrag {
    /// That of a vehicle; none where its legs have the same drag, or it has none.
    pub(super) fn new(vehicle: &Parameters<f64>, directions: &mut Directions) -> Option<CommonDrag> {
        let (b, ratio) = (vehicle.b, vehicle.ascent_b_ratio);
        let row = parameter_index("ascent_b_ratio")?;
        (ratio != 1.0 && b > 0.0).then(|| CommonDrag { b, ratio, direction: directions.index_of(row) })
    }

    /// The direction of the ratio among those of the model.
    pub(super) fn direction(self) -> usize {
        self.direction
    }

    /// The ratio of the legs at a share and a `b`.
    pub(super) fn ratio(self, share: f64, b: f64) -> f64 {
        self.ratio + share * (1.0 - self.ratio) * (1.0 - self.b / b)
    }

    /// The slopes of the ratio along the share and along `b`.
    fn slopes(self, share: f64, b: f64) -> [f64; 2] {
        [(1.0 - self.ratio) * (1.0 - self.b / b), share * (1.0 - self.ratio) * self.b / (b * b)]
    }
}

impl SeaProblem {
    /// Where the share stands in the baseline: behind the polar and the shear, where it is fitted.
    fn place_of_common_drag(&self) -> usize {
        self.baseline_index.len() + self.shear.len()
    }

    /// Where `b` stands.
    fn place_of_drag(&self) -> usize {
        let row = parameter_index("b");
        self.baseline_index.iter().position(|index| Some(*index) == row).expect("the drag is always fitted")
    }

    /// The share and `b` at a point, with the vehicle's drag; none where its legs have the same.
    fn common_drag_at(&self, point: &Point) -> Option<(CommonDrag, f64, f64)> {
        let drag = self.common_drag?;
        Some((drag, point.baseline[self.place_of_common_drag()], point.baseline[self.place_of_drag()]))
    }

    /// The share with which a fit starts.
    pub(super) fn start_of_common_drag(&self) -> Option<f64> {
        self.common_drag.map(|_| PRIOR[0])
    }

    /// What is believed of the share, as a residual and its standard deviation.
    pub(super) fn prior_of_common_drag(&self, point: &Point) -> Option<(f64, f64)> {
        self.common_drag_at(point).map(|(_, share, _)| (PRIOR[0] - share, PRIOR[1]))
    }

    /// Gives the parameters of a point the ratio of the legs.
    pub(super) fn put_common_drag(&self, parameters: &mut Parameters<f64>, point: &Point) {
        if let Some((drag, share, b)) = self.common_drag_at(point) {
            parameters.ascent_b_ratio = drag.ratio(share, b);
        }
    }

    /// The ratio of the legs at a point over the vehicle's; none where they have the same drag.
    pub(super) fn ratio_of_legs_over_vehicles(&self, point: &Point) -> Option<f64> {
        self.common_drag_at(point).map(|(drag, share, b)| drag.ratio(share, b) / drag.ratio)
    }

    /// Fills the columns of the share and of `b` in the baseline from the slopes of each row along the directions of the model.
    pub(super) fn add_common_drag(&self, baseline: &mut DMatrix<f64>, slopes: &DMatrix<f64>, point: &Point) {
        let Some((drag, share, b)) = self.common_drag_at(point) else { return };
        let along_ratio: DVector<f64> = slopes.column(drag.direction).into_owned();
        let [by_share, by_b] = drag.slopes(share, b);
        baseline.set_column(self.place_of_common_drag(), &(&along_ratio * by_share));
        baseline.column_mut(self.place_of_drag()).axpy(by_b, &along_ratio, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sea::{DiagnosisSettings, steady_log};
    use crate::diagnose::{Problem, engine};
    use crate::vehicle::Vehicle;

    /// A Slocum whose ascents have a fifth less drag.
    fn vehicle() -> Parameters<f64> {
        let slocum = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        Parameters { ascent_b_ratio: 0.8, ..slocum }
    }

    /// The same with this much more drag on both legs.
    fn with_pod(vehicle: &Parameters<f64>, more: f64) -> Parameters<f64> {
        let (b, ascent_b) = (vehicle.b + more, vehicle.b * vehicle.ascent_b_ratio + more);
        Parameters { b, ascent_b_ratio: ascent_b / b, ..*vehicle }
    }

    fn problem(log: &[crate::log::Observation]) -> SeaProblem {
        SeaProblem::new(log, &vehicle(), DiagnosisSettings::default()).expect("enough bins")
    }

    #[test]
    fn a_share_of_nothing_scales_the_legs_and_one_of_all_adds_to_both() {
        let drag = CommonDrag::new(&vehicle(), &mut Directions::new(&[])).expect("legs that differ");
        let more = 0.3 * vehicle().b;
        let pod = with_pod(&vehicle(), more);
        assert_eq!(drag.ratio(0.0, pod.b), 0.8);
        assert!((drag.ratio(1.0, pod.b) - pod.ascent_b_ratio).abs() < 1e-15);
        assert_eq!(drag.ratio(0.7, vehicle().b), 0.8);
        let alike = Parameters { ascent_b_ratio: 1.0, ..vehicle() };
        assert_eq!(CommonDrag::new(&alike, &mut Directions::new(&[])), None);
    }

    /// Steady glides with a pod: all of the added drag is in common, and nothing is left that differs between the legs.
    #[test]
    fn a_pod_on_legs_that_differ_is_found_in_common() {
        let problem = problem(&steady_log::log(&with_pod(&vehicle(), 0.3 * vehicle().b)));
        let found = engine::baseline(&problem).0;
        let share = found.point.baseline[problem.place_of_common_drag()];
        let rms = found.residual.norm() / (found.residual.len() as f64).sqrt();
        assert!((share - 1.0).abs() < 0.1 && rms < 1e-4, "{share}, {rms} m/s");
    }

    #[test]
    fn the_columns_are_the_changes_of_what_is_read() {
        let problem = problem(&steady_log::log(&with_pod(&vehicle(), 0.3 * vehicle().b)));
        let mut there = problem.start();
        there.baseline[problem.place_of_drag()] *= 1.2;
        let columns = problem.evidence(&there).baseline;
        for (place, step) in [(problem.place_of_common_drag(), 0.05), (problem.place_of_drag(), 0.01 * vehicle().b)] {
            let residual_at = |step: f64| {
                let mut point = there.clone();
                point.baseline[place] += step;
                problem.evidence(&point).residual
            };
            let change = (residual_at(-step) - residual_at(step)) / (2.0 * step);
            let (most, off) = (change.amax(), (&change - columns.column(place)).amax());
            assert!(most > 1e-4 && off < 0.03 * most, "{place}: {off} of {most} m/s");
        }
    }
}
