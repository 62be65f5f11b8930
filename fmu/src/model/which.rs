//! The models in the library: what each is called. A further model is a further item here, a table of variables and
//! a file of equations.

/// Which model an instance is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// The glider in the vertical plane.
    Plane,
    /// The glider in six degrees of freedom.
    Space,
}

impl Model {
    /// All of them.
    pub const ALL: [Model; 2] = [Model::Plane, Model::Space];

    /// Its name, and that of the binary in its archives.
    pub fn name(self) -> &'static str {
        match self {
            Model::Plane => "UnderwaterGlider",
            Model::Space => "UnderwaterGlider3D",
        }
    }

    /// What it is, in a line.
    pub fn description(self) -> &'static str {
        match self {
            Model::Plane => {
                "Underwater glider in the vertical plane: buoyancy engine, moving mass, glide polar from hull tests, and the mechanisms by which gliders at sea depart from them"
            }
            Model::Space => {
                "Underwater glider in six degrees of freedom: buoyancy engine, moving mass, roll mass and rudder, heading control, currents that accelerate and shear, and the mechanisms by which gliders at sea depart from hull tests"
            }
        }
    }

    /// The place of the depth among its states.
    pub fn depth(self) -> usize {
        match self {
            Model::Plane => 1,
            Model::Space => 2,
        }
    }
}
