//! The error of a parameter that is fixed, and what it does to a fit. Knows no data.

/// One standard error of something that is held: by how much it moves which rows of
/// [`PARAMETERS`](crate::dynamics::PARAMETERS). Different ones are independent.
#[derive(Debug, Clone, PartialEq)]
pub struct Considered {
    /// Short name of what is held.
    pub name: String,
    /// Rows and by how much they move.
    pub along: Vec<(usize, f64)>,
}

/// What one of them does to a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Propagated {
    /// What is held.
    pub considered: Considered,
    /// Moves of the free parameters, in the order of the fit.
    pub moves: Vec<f64>,
}

impl Propagated {
    /// The error with all that follows from it: what is fixed and what was fitted beside it move together.
    pub(super) fn whole(&self, free: &[usize]) -> Considered {
        let follows = free.iter().copied().zip(self.moves.iter().copied());
        Considered {
            name: self.considered.name.clone(),
            along: self.considered.along.iter().copied().chain(follows).collect(),
        }
    }
}
