//! The problem at a point of the fit: where each parameter of the baseline stands, the vehicle's parameters, and what happens inside each
//! bin there. Knows no residuals.

use std::borrow::Cow;
use std::sync::Arc;

use super::late_attitude::Shifted;
use super::{SeaProblem, Within, effects_of_past, path_share};
use crate::diagnose::evidence::{Candidate, Point};
use crate::dynamics::{Parameters, parameter_index};
use crate::identify::{Bin, Parts, make_heavier};

impl SeaProblem {
    /// The coefficients of the unknown shear at a point.
    pub(super) fn shear_coefficients<'a>(&self, point: &'a Point) -> &'a [f64] {
        &point.baseline[self.baseline_index.len()..][..self.shear.len()]
    }

    /// Where the reliability of the pitch stands in the baseline: behind the polar, the shear and the share of a drag in common.
    pub(super) fn place_of_reliability(&self) -> usize {
        self.baseline_index.len() + self.shear.len() + usize::from(self.common_drag.is_some())
    }

    /// Where the share of the inertia stands: behind that.
    pub(super) fn place_of_inertia(&self) -> usize {
        self.place_of_reliability() + 1
    }

    /// The share of its inertia with which the glider follows its forces at a point, where it is fitted.
    pub(super) fn inertia_share(&self, point: &Point) -> Option<f64> {
        point.baseline.get(self.place_of_inertia()).copied()
    }

    /// Where the log-odds of the share of the time stand by which the path follows the pitch: behind that.
    pub(super) fn place_of_path(&self) -> usize {
        self.place_of_inertia() + 1
    }

    /// The share of that time at a point; 0 in a problem without inertia.
    pub(super) fn path_share(&self, point: &Point) -> f64 {
        point.baseline.get(self.place_of_path()).map_or(0.0, |log_odds| path_share::share(*log_odds))
    }

    /// What the past and the unknown shear do to each bin at a point; nothing where both do nothing.
    pub(super) fn effects(&self, point: &Point, parameters: &Parameters<f64>) -> Option<Vec<effects_of_past::Effect>> {
        let effects = self.past.effects(&self.bins, parameters);
        let coefficients = self.shear_coefficients(point);
        if coefficients.iter().all(|value| *value == 0.0) {
            return effects;
        }
        let mut effects = effects.unwrap_or_else(|| vec![effects_of_past::Effect::default(); self.bins.len()]);
        for (bin, effect) in effects.iter_mut().enumerate() {
            effect.along_N += self.shear.along_N(coefficients, bin, parameters.mass_kg());
        }
        Some(effects)
    }

    /// The bins at these parameters, where the attitude has another clock; none where it has the same.
    pub(super) fn shifted(&self, parameters: &Parameters<f64>) -> Option<Arc<Shifted>> {
        let late_s = parameters.clock_offset_s;
        (late_s != 0.0).then(|| self.late_attitude.shifted(late_s))
    }

    /// The bins at a point in parts, whose pitch may be that of another time.
    pub(super) fn parts_of<'a>(&'a self, shifted: Option<&'a Shifted>) -> Cow<'a, Parts> {
        match shifted.map(Shifted::parts) {
            None => Cow::Borrowed(&self.parts),
            Some(parts) if self.is_quasi_steady() => Cow::Owned(parts.without_inertia()),
            Some(parts) => Cow::Borrowed(parts),
        }
    }

    /// What happens inside each bin at a point, whose pitch may be that of another time.
    pub(super) fn within_at(&self, point: &Point, shifted: Option<&Shifted>) -> Within {
        let bins = shifted.map_or(&self.bins, |shifted| &shifted.bins);
        self.within_of(point, &self.parameters_at(point), bins, &self.parts_of(shifted))
    }

    /// The same with the net mass that mechanisms of the past add in each part of the bins.
    pub(super) fn within_with_past(
        &self,
        point: &Point,
        shifted: Option<&Shifted>,
        past: Option<&Vec<effects_of_past::Effect>>,
    ) -> Within {
        let (bins, parts) = (shifted.map_or(&self.bins, |shifted| &shifted.bins), self.parts_of(shifted));
        let parameters = self.parameters_at(point);
        let added = past.and_then(|past| Some((past, self.past.added_kg(parts.means(), bins, &parameters)?)));
        let Some((past, added_kg)) = added else { return self.within_of(point, &parameters, bins, &parts) };
        let mut heavier = bins.clone();
        for (bin, effect) in heavier.iter_mut().zip(past) {
            make_heavier(&mut bin.mean, &parameters, effect.net_mass_kg);
        }
        self.within_of(point, &parameters, &heavier, &parts.heavier(&parameters, &added_kg))
    }

    fn within_of(&self, point: &Point, parameters: &Parameters<f64>, bins: &[Bin], parts: &Parts) -> Within {
        match self.inertia_share(point) {
            Some(_) => {
                let (inside, at_rest) = parts.inside_and_at_rest(parameters, bins);
                (inside, Some(at_rest))
            }
            None => (parts.inside(parameters, bins), None),
        }
    }

    /// The parameters at a point of the fit.
    pub fn parameters_at(&self, point: &Point) -> Parameters<f64> {
        let mut parameters = self.parameters;
        for (index, value) in self.baseline_index.iter().zip(&point.baseline) {
            *parameters.at(*index) = *value;
        }
        self.put_common_drag(&mut parameters, point);
        for ((candidate, values), shape) in self.candidates.iter().zip(&point.candidates).zip(&self.shapes) {
            if *values != candidate.neutral {
                *parameters.at(shape.row) = values[0];
                put_version(&mut parameters, candidate);
            }
        }
        parameters
    }
}

/// Gives the parameter that a candidate's version is chosen by its value.
pub(super) fn put_version(parameters: &mut Parameters<f64>, candidate: &Candidate) {
    let row = candidate.version.and_then(|version| Some((parameter_index(version.name)?, version.value)));
    if let Some((row, value)) = row {
        *parameters.at(row) = value;
    }
}
