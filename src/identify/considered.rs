//! The error of a parameter that is fixed, and what it does to a fit. Knows no data.

/// One standard error of something that is held: by how much it moves which rows of
/// [`PARAMETERS`](crate::dynamics::PARAMETERS). Different ones are independent.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt {
    /// Short name of what is held.
    pub name: String,
    /// Rows and by how much they move.
    pub along: Vec<(usize, f64)>,
}

/// What one of them does to a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Carried {
    /// What is held.
    pub doubt: Doubt,
    /// Moves of the free parameters, in the order of the fit.
    pub moves: Vec<f64>,
}

impl Carried {
    /// The doubt with all that follows from it: what is held and what was fitted beside it move together.
    pub(super) fn whole(&self, free: &[usize]) -> Doubt {
        let follows = free.iter().copied().zip(self.moves.iter().copied());
        Doubt { name: self.doubt.name.clone(), along: self.doubt.along.iter().copied().chain(follows).collect() }
    }
}
