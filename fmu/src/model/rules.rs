//! What a glider is at one time and what its equations go by between two events, whichever model it is of. Knows no
//! equations.

use std::sync::Arc;

use glidepolar_dynamics::steps::N_STEPS;
use glidepolar_dynamics::{Actuation, Modes, Parameters};
use glidepolar_environment::{WaterAt, WaterColumn};
use glidepolar_number::Number;
use glidepolar_spatial::{RateLaw, Steering};

use super::values::{Values, head};
use super::which::Model;

/// So far beyond surface or seabed the glider must be to have met it, and back to have left it \[m\]: right after an event
/// no indicator is zero, and each has the sign of its side.
pub(super) const PAST_BOUNDARY_M: f64 = 1e-9;

/// The same of a corner of a servo, in units of its band.
const PAST_CORNER: f64 = 1e-9;

/// Whether a boundary or corner is passed, `excess` beyond it; `past` is the shift of the indicators. An importer finds the
/// zero of an indicator from either side: half of the shift counts as passed.
pub(super) fn is_beyond(excess: f64, was_beyond: bool, past: f64) -> bool {
    if was_beyond { excess > -0.5 * past } else { excess >= 0.5 * past }
}

/// Beyond which corners of the servos the set-points lie, a bit for each: their indicators are shifted by it, so that none is
/// zero right after an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Corners(pub u8);

impl Corners {
    /// The sides of these corners, where nearer than the shift as before.
    pub(super) fn brought_to(self, corners: &[f64]) -> Self {
        let bit = |(i, corner): (usize, &f64)| u8::from(is_beyond(-corner, self.has(i), PAST_CORNER)) << i;
        Corners(corners.iter().enumerate().map(bit).sum())
    }

    /// Moves the corners away from zero, each on its side.
    pub(super) fn shift<T: Number>(self, corners: &mut [T]) {
        for (i, corner) in corners.iter_mut().enumerate() {
            *corner += if self.has(i) { -PAST_CORNER } else { PAST_CORNER };
        }
    }

    fn has(self, i: usize) -> bool {
        self.0 >> i & 1 != 0
    }
}

/// Everything that the glider is at one time: cloned to save and restored to go back, without allocation.
#[derive(Debug, Clone, PartialEq)]
pub struct Glider {
    /// Which model it is of.
    pub model: Model,
    /// What does not follow from anything else.
    pub values: Values<f64>,
    /// Who moves the moving mass and the ballast: in the plane. In space, servos do.
    pub actuation: Actuation,
    /// Who gives rudder and roll mass their set-points: in space.
    pub steering: Steering,
    /// How lateral rates work on the hull of this vehicle: in space.
    pub rate_law: RateLaw,
    /// What changes at events only.
    pub discrete: DiscreteState,
    /// On which side of the servos' corners the set-points lie. Nothing but the indicators goes by it.
    pub corners: Corners,
    /// The water that travels with the glider's archive, if any does.
    pub column: Option<Arc<WaterColumn>>,
    /// Whether density and temperature come from that column and not from the inputs.
    pub uses_column: bool,
    /// Whether the start is the glide of the parameters that were set.
    pub starts_in_trim: bool,
}

/// What changes at events only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DiscreteState {
    /// Where ballast and moving mass stand.
    pub modes: Modes,
    /// Whether each of the mechanisms that come at one time lies behind, in the order of
    /// [`STEPS`](glidepolar_dynamics::steps::STEPS).
    pub has_stepped: [bool; N_STEPS],
    /// Whether the hull breaks the surface.
    pub at_surface: bool,
    /// Whether the hull touches the seabed.
    pub on_seabed: bool,
}

impl Glider {
    /// What the equations go by until the next event.
    pub fn rules(&self) -> Rules<'_> {
        let column = self.column.as_deref().filter(|_| self.uses_column);
        let Glider { model, actuation, steering, rate_law, discrete, corners, .. } = *self;
        Rules { model, actuation, steering, rate_law, discrete, corners, column }
    }

    /// Those of its parameters that every model has.
    pub fn parameters(&self) -> Parameters<f64> {
        Parameters::from_array(head(&self.values.parameters))
    }

    /// Depth \[m\].
    pub fn depth_m(&self) -> f64 {
        self.values.state[self.model.depth()]
    }
}

/// What the equations go by between two events, whatever the kind of number.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// Which equations.
    pub model: Model,
    pub(super) actuation: Actuation,
    pub(super) steering: Steering,
    pub(super) rate_law: RateLaw,
    pub(super) discrete: DiscreteState,
    pub(super) corners: Corners,
    column: Option<&'a WaterColumn>,
}

impl Rules<'_> {
    /// The parameters as the equations must see them until the next event: whether the step of drag or of net mass lies
    /// behind is a mode, not a question of the time, so that no integrator meets it inside a step.
    pub(super) fn active<T: Number>(&self, parameters: &Parameters<T>) -> Parameters<T> {
        let mut active = *parameters;
        for ((size, at_s), has_stepped) in active.steps_mut().into_iter().zip(self.discrete.has_stepped) {
            if has_stepped {
                *at_s = T::constant(f64::NEG_INFINITY);
            } else {
                *size = T::constant(0.0);
            }
        }
        active
    }

    /// The water of the column at a depth, where there is one.
    pub(super) fn water<T: Number>(&self, depth_m: T) -> Option<WaterAt<T>> {
        self.column.map(|column| column.at(depth_m))
    }

    /// The indicators of surface and seabed, shifted by which side the glider is on.
    pub(super) fn past_boundaries<T: Number>(&self, indicators: &mut [T]) {
        for (z, is_beyond) in indicators.iter_mut().zip([self.discrete.at_surface, self.discrete.on_seabed]) {
            *z += if is_beyond { -PAST_BOUNDARY_M } else { PAST_BOUNDARY_M };
        }
    }
}
