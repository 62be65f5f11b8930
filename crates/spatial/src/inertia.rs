//! The symmetric inertia of all six degrees of freedom: masses anywhere, rigid bodies, added mass with its couplings.

use glidepolar_number::Number;

use super::vector::{Vector, cross, dot};

/// `(P, Pi) = M (v, Om)` about the centre of buoyancy. Along the axes it is diagonal, masses and added mass alike: what couples
/// them goes by the rotation.
#[derive(Debug, Clone, Copy)]
pub struct Inertia<T> {
    /// Momentum along each axis per velocity along it.
    along: Vector<T>,
    /// Momentum along each axis, by rows, per rate about each; its transpose is angular momentum per velocity.
    coupling: [Vector<T>; 3],
    /// Angular momentum per rate, symmetric.
    about: [Vector<T>; 3],
}

impl<T: Number> Inertia<T> {
    /// Of nothing.
    pub fn zero() -> Self {
        let zero = T::constant(0.0);
        Inertia { along: [zero; 3], coupling: [[zero; 3]; 3], about: [[zero; 3]; 3] }
    }

    /// Adds mass, rigid or added, that moves along one axis.
    pub fn add_along(&mut self, axis: usize, value: T) {
        self.along[axis] += value;
    }

    /// Adds momentum along one axis per rate about another.
    pub fn add_coupling(&mut self, along: usize, about: usize, value: T) {
        self.coupling[along][about] += value;
    }

    /// Adds a moment or product of inertia, and its mirror image.
    pub fn add_about(&mut self, row: usize, column: usize, value: T) {
        self.about[row][column] += value;
        if row != column {
            self.about[column][row] += value;
        }
    }

    /// Adds a point mass at a place in the hull.
    pub fn add_mass(&mut self, mass: T, [x, y, z]: Vector<T>) {
        for axis in 0..3 {
            self.add_along(axis, mass);
        }
        // P = m (v + Om x r): the momentum along axis 1 per pitch rate is m z, and so on.
        self.add_coupling(0, 1, mass * z);
        self.add_coupling(0, 2, -mass * y);
        self.add_coupling(1, 0, -mass * z);
        self.add_coupling(1, 2, mass * x);
        self.add_coupling(2, 0, mass * y);
        self.add_coupling(2, 1, -mass * x);
        self.add_about(0, 0, mass * (y * y + z * z));
        self.add_about(1, 1, mass * (x * x + z * z));
        self.add_about(2, 2, mass * (x * x + y * y));
        self.add_about(0, 1, -mass * x * y);
        self.add_about(0, 2, -mass * x * z);
        self.add_about(1, 2, -mass * y * z);
    }

    /// Momentum and angular momentum of a motion.
    pub fn times(&self, v: Vector<T>, rates: Vector<T>) -> (Vector<T>, Vector<T>) {
        let momentum = std::array::from_fn(|i| self.along[i] * v[i] + dot(self.coupling[i], rates));
        let angular = std::array::from_fn(|j| dot(self.coupling.map(|row| row[j]), v) + dot(self.about[j], rates));
        (momentum, angular)
    }

    /// The accelerations that a force and a moment give: those along the axes are eliminated first, those about them follow by
    /// `L D L'`. Every true inertia is positive definite.
    pub fn solve(&self, force: Vector<T>, moment: Vector<T>) -> (Vector<T>, Vector<T>) {
        let one = T::constant(1.0);
        let per_mass = self.along.map(|mass| one / mass);
        // The acceleration along the axes that a rate of turn about another would undo, and that of the force alone.
        let undone: [Vector<T>; 3] = std::array::from_fn(|i| self.coupling[i].map(|value| value * per_mass[i]));
        let free: Vector<T> = std::array::from_fn(|i| force[i] * per_mass[i]);
        let column = |j: usize| self.coupling.map(|row| row[j]);
        let left = |row: usize, col: usize| self.about[row][col] - dot(column(row), undone.map(|line| line[col]));
        let [m0, m1, m2] = std::array::from_fn(|j| moment[j] - dot(column(j), free));

        let (d0, a01, a02) = (left(0, 0), left(0, 1), left(0, 2));
        let (a11, a12, a22) = (left(1, 1), left(1, 2), left(2, 2));
        let per_d0 = one / d0;
        let (l1, l2) = (a01 * per_d0, a02 * per_d0);
        let (d1, b12) = (a11 - l1 * a01, a12 - l1 * a02);
        let per_d1 = one / d1;
        let l12 = b12 * per_d1;
        let d2 = a22 - l2 * a02 - l12 * b12;
        let (x1, x2) = (m1 - l1 * m0, m2 - l2 * m0);
        let w2 = (x2 - l12 * x1) / d2;
        let w1 = x1 * per_d1 - l12 * w2;
        let w0 = m0 * per_d0 - l1 * w1 - l2 * w2;
        let turning = [w0, w1, w2];
        (std::array::from_fn(|i| free[i] - dot(undone[i], turning)), turning)
    }
}

/// The mass that moves: its place, its speed in the hull, its turning about axis 1 and its own inertia.
#[derive(Debug, Clone, Copy)]
pub struct Mover<T> {
    pub mass: T,
    pub place: Vector<T>,
    pub speed: Vector<T>,
    /// Rate of turning relative to the hull.
    pub turning: Vector<T>,
    pub own: [[T; 3]; 3],
}

impl<T: Number> Mover<T> {
    fn own_times(&self, a: Vector<T>) -> Vector<T> {
        self.own.map(|row| row[0] * a[0] + row[1] * a[1] + row[2] * a[2])
    }

    /// Adds it, where it is, to the inertia of the hull.
    pub fn join(&self, inertia: &mut Inertia<T>) {
        inertia.add_mass(self.mass, self.place);
        for i in 0..3 {
            for j in i..3 {
                inertia.add_about(i, j, self.own[i][j]);
            }
        }
    }

    /// Momentum and angular momentum that it has by moving relative to the hull.
    pub fn relative(&self) -> (Vector<T>, Vector<T>) {
        let momentum = self.speed.map(|s| s * self.mass);
        let (turning, own) = (cross(self.place, momentum), self.own_times(self.turning));
        (momentum, [turning[0] + own[0], turning[1] + own[1], turning[2] + own[2]])
    }

    /// Rate of change of momentum and angular momentum in body axes at constant motion of the hull, for an acceleration
    /// of the mass relative to the hull and of its turning.
    pub fn rate(
        &self,
        v: Vector<T>,
        rates: Vector<T>,
        acceleration: Vector<T>,
        turning_acceleration: Vector<T>,
    ) -> (Vector<T>, Vector<T>) {
        let momentum_rate: Vector<T> =
            std::array::from_fn(|i| self.mass * (cross(rates, self.speed)[i] + acceleration[i]));
        // d/dt of m r x (v + Om x r + r') at constant v, Om; then of the own inertia, which turns with the mass:
        // I' = [w]I - I[w], so (I (Om + w))' = w x I(Om + w) - I (w x (Om + w)) + I w'.
        let whole: Vector<T> =
            std::array::from_fn(|i| self.mass * (v[i] + cross(rates, self.place)[i] + self.speed[i]));
        let orbit = cross(self.speed, whole);
        let carried = cross(self.place, momentum_rate);
        let spin: Vector<T> = std::array::from_fn(|i| rates[i] + self.turning[i]);
        let turned = cross(self.turning, self.own_times(spin));
        let lagged = self.own_times(cross(self.turning, spin));
        let driven = self.own_times(turning_acceleration);
        (momentum_rate, std::array::from_fn(|i| orbit[i] + carried[i] + turned[i] - lagged[i] + driven[i]))
    }
}
