//! Which variables each model has, and how many of each kind.

use super::variable::Table;
use super::which::Model;
use super::{plane, space, table};

impl Model {
    /// The model whose token a text begins with, and what stands behind the token.
    pub fn of_token(text: &str) -> Option<(Model, &str)> {
        Self::ALL.into_iter().find_map(|model| Some((model, text.strip_prefix(model.table().token)?)))
    }

    /// Its variables.
    pub fn table(self) -> Table {
        match self {
            Model::Plane => table::plane(),
            Model::Space => space::table::space(),
        }
    }

    /// How many continuous states it has.
    pub fn n_states(self) -> usize {
        self.nominals().len()
    }

    /// How many inputs it has.
    pub fn n_inputs(self) -> usize {
        match self {
            Model::Plane => glidepolar_dynamics::state::N_INPUTS,
            Model::Space => glidepolar_spatial::N_INPUTS,
        }
    }

    /// How many event indicators it has.
    pub fn n_events(self) -> usize {
        match self {
            Model::Plane => glidepolar_dynamics::limits::N_EVENTS,
            Model::Space => space::N_EVENTS,
        }
    }

    /// The usual sizes of its states.
    pub fn nominals(self) -> &'static [f64] {
        match self {
            Model::Plane => &plane::NOMINALS,
            Model::Space => &glidepolar_spatial::glider::NOMINAL_VALUES,
        }
    }

    /// The place of the energy among its states.
    pub fn energy(self) -> usize {
        self.n_states() - 1
    }
}
